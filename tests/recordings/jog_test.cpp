#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/methods/break_away.hpp>
#include <stribeck/ident/methods/jog/jog.hpp>
#include <tests/recordings/recording.hpp>

namespace stribeck::test::jog_test {
namespace {

using Table = std::vector<std::vector<std::string>>;

/// Rows of a file with one header line.
Table read(const std::string& path) {
  std::ifstream file(path);
  Table rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<std::string> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
    rows.push_back(std::move(cells));
  }
  return rows;
}

double number(const std::string& text) { return std::stod(text); }

ident::log::Record empty_record(const std::string& source, double period, const char* force_unit) {
  ident::log::Record r;
  r.source = source;
  r.sample_time = period;
  r.force_unit = force_unit;
  r.position_unit = "rad";
  return r;
}

/// One record per run of the steady test of one drive: speed in rad/s, torque in % of nominal.
std::vector<ident::log::Record> steady_runs(const std::string& path, const std::string& drive) {
  std::map<double, std::vector<std::array<double, 3>>> runs;
  for (const auto& row : read(path)) {
    if (row[0] == drive && row[1] == "steady") {
      runs[number(row[2])].push_back({number(row[3]), number(row[4]), number(row[5])});
    }
  }
  std::vector<ident::log::Record> records;
  for (const auto& [speed, rows] : runs) {
    const double period = rows.back()[0] / static_cast<double>(rows.size() - 1);
    records.push_back(empty_record("drive " + drive + " at " + std::to_string(speed), period, "%"));
    for (std::size_t k = 0; k < rows.size(); ++k) {
      records.back().t.push_back(period * static_cast<double>(k));
      records.back().v.push_back(rows[k][1] * 2.0 * kPi / 60.0);
      records.back().f.push_back(rows[k][2]);
    }
  }
  return records;
}

// README of the recordings: run means, direction-dependent Coulomb-viscous against Stribeck: 1.295 -> 0.417,
// 0.877 -> 0.817, 0.895 -> 0.225 %.
TEST(Jog, GivesTheScrewDrivesTheTermsTheyNeedAndNoMore) {
  STRIBECK_RECORDING(path, "screw_drives/screw_drives.csv");
  const auto fit = [&](const char* drive) { return ident::methods::identify_jog(steady_runs(path, drive)); };
  const ident::methods::Jog one = fit("1");
  EXPECT_EQ(one.runs.size(), 16u);
  EXPECT_LE(one.residual_rms, 0.45);
  EXPECT_GE(one.residual_rms, 0.1);  // the errors of the means: less would be fitted noise
  const ident::methods::Jog two = fit("2");
  EXPECT_EQ(two.result.model, "conventional");
  EXPECT_FALSE(std::get<friction::Conventional<double>>(two.result.friction.steady).stribeck.has_value());
  EXPECT_NEAR(two.residual_rms, 0.9, 0.1);
  const ident::methods::Jog three = fit("3");
  EXPECT_LE(three.residual_rms, 0.25);
  EXPECT_GE(three.residual_rms, 0.1);
  for (const ident::methods::Jog& j : {one, two, three}) {
    EXPECT_TRUE(std::isnan(j.result.mass));
    EXPECT_EQ(j.result.force_unit, "%");
  }
}

constexpr double kDegree = kPi / 180.0;

/// Constant speeds of one joint of the arm, gravity as in the README taken off.
std::vector<ident::log::Record> arm_runs(const std::string& path, int joint) {
  constexpr double kPeriod = 0.015;
  std::vector<ident::log::Record> records;
  for (const auto& row : read(path)) {
    if (records.empty() || records.back().source != row[0]) {
      records.push_back(empty_record(row[0], kPeriod, "N m"));
    }
    ident::log::Record& r = records.back();
    const double q1 = number(row[3]) * kDegree;
    const double q2 = number(row[6]) * kDegree;
    const double g2 = 9.81 * 0.186 * std::sin(q1 + q2);
    r.t.push_back(kPeriod * static_cast<double>(r.t.size()));
    r.x.push_back(joint == 1 ? q1 : q2);
    r.f.push_back(joint == 1 ? number(row[5]) - 9.81 * 3.921 * std::sin(q1) - g2 : number(row[8]) - g2);
  }
  return records;
}

// README: friction of joint 1 jumps from 15.2 to 11.7 N m between 0.4 and 0.5 deg/s, two days.
TEST(Jog, DoesNotMixTheTwoDaysOfTheArm) {
  STRIBECK_RECORDING(path, "dd_arm/const_velocity.csv");
  for (const int joint : {1, 2}) {
    const ident::methods::Jog jog = ident::methods::identify_jog(arm_runs(path, joint));
    ASSERT_FALSE(jog.result.warnings.empty());
    EXPECT_NE(jog.result.warnings.front().find("two measuring days"), std::string::npos)
        << jog.result.warnings.front();
    ASSERT_EQ(jog.groups.size(), 1u);
    double slowest = 1e9, fastest_of_slow = 0.0;
    for (const auto& p : jog.result.map) slowest = std::min(slowest, std::abs(p.velocity));
    for (const auto& p : jog.groups[0].map) fastest_of_slow = std::max(fastest_of_slow, std::abs(p.velocity));
    EXPECT_NEAR(slowest / kDegree, 0.45, 0.1);  // one of the runs at 0.5 deg/s begins slower
    EXPECT_NEAR(fastest_of_slow / kDegree, 0.4, 0.05);
  }
}

// The authors read +10.75/-12.00 N m (joint 1) and +1.49/-1.45 N m (joint 2) off the same ramps; their rule is not
// printed. Measured here: +9.91 +- 0.90, -11.87 +- 0.28, +1.63 +- 0.13, -1.485 +- 0.10.
TEST(BreakAway, AgreesWithTheAuthorsOfTheArm) {
  STRIBECK_RECORDING(path, "dd_arm/breakaway_ramp.csv");
  constexpr double kPeriod = 0.015;
  const double printed[2][2] = {{10.75, -12.00}, {1.49, -1.45}};
  for (const int joint : {1, 2}) {
    std::vector<ident::log::Record> records;
    for (const auto& row : read(path)) {
      if (row[1] != std::to_string(joint)) continue;
      if (records.empty() || records.back().source != row[0]) {
        records.push_back(empty_record(row[0], kPeriod, "N m"));
      }
      records.back().t.push_back(kPeriod * static_cast<double>(records.back().t.size()));
      records.back().x.push_back(number(row[3]) * kDegree);
      records.back().f.push_back(number(row[5]));
    }
    const ident::methods::BreakAway b = ident::methods::identify_break_away(records);
    for (const int side : {0, 1}) {
      SCOPED_TRACE("joint " + std::to_string(joint) + (side == 0 ? " forward" : " backward"));
      const double authors = printed[joint - 1][side];
      EXPECT_NEAR(b.force[side] / authors, 1.0, 0.13);
      EXPECT_LT(b.interval[side].high - b.interval[side].low, 0.3 * std::abs(authors));
    }
  }
}

}  // namespace
}  // namespace stribeck::test::jog_test
