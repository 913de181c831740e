#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stribeck/ident/methods/idim_ls.hpp>
#include <stribeck/ident/methods/velocity_map.hpp>
#include <stribeck/ident/test_drive.hpp>

namespace stribeck::ident::methods::idim_ls_test {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kForcePerVolt = 35.15065188248547;

std::filesystem::path emps_file() {
  const char* given = std::getenv("STRIBECK_DATA_DIR");
  const std::filesystem::path root =
      given != nullptr ? given : std::filesystem::path(STRIBECK_SOURCE_DIR) / "../shared/data";
  return root / "emps" / "emps.csv";
}

log::Record emps() {
  std::ifstream in(emps_file());
  log::Record rec;
  rec.source = "emps.csv";
  rec.sample_time = 0.001;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    double t = 0, r = 0, x = 0, u = 0;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &t, &r, &x, &u) != 4) continue;
    rec.t.push_back(t);
    rec.r.push_back(r);
    rec.x.push_back(x);
    rec.f.push_back(kForcePerVolt * u);
  }
  return rec;
}

/// Printed to four decimals: half a unit of the last one.
constexpr double kLastDigit = 0.5e-4;

void expect_printed(const std::vector<double>& got, const std::vector<double>& printed) {
  ASSERT_EQ(got.size(), printed.size());
  for (std::size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(got[i], printed[i], kLastDigit) << i;
}

// Janot, Gautier, Brunot 2019: the tables of the benchmark.
TEST(IdimLs, ReproducesThePublishedResultOfEmpsToTheLastDigit) {
  if (!std::filesystem::exists(emps_file())) GTEST_SKIP() << "no " << emps_file();
  const log::Record rec = emps();
  ASSERT_EQ(rec.x.size(), 24841u);
  const auto both = identify_idim_ls(rec).published;
  expect_printed(both.value, {95.1089, 203.5034, 20.3935, -3.1648});
  expect_printed(both.deviation, {0.1085, 1.1460, 0.1012, 0.0444});
  expect_printed({both.error_norm, 100.0 * both.relative_error, both.error_deviation, both.condition},
                 {108.7569, 4.0834, 2.1843, 25.9883});
  IdimOptions options;
  options.by_direction = true;
  const auto each = identify_idim_ls(rec, options).published;
  expect_printed(each.value, {95.1540, 166.7061, 20.1440, 240.4236, 20.6277});
  expect_printed(each.deviation, {0.0827, 1.2326, 0.1088, 1.2346, 0.1091});
  expect_printed({each.error_norm, 100.0 * each.relative_error, each.error_deviation, each.condition},
                 {82.8778, 3.1117, 1.6646, 26.0197});
}

// Two methods that share no code beyond the record: instruments and bins here, filters and regressors there.
TEST(IdimLs, AgreesWithTheVelocityMapOnEmps) {
  if (!std::filesystem::exists(emps_file())) GTEST_SKIP() << "no " << emps_file();
  const log::Record rec = emps();
  const Result map = identify_velocity_map({rec});
  EXPECT_NEAR(map.mass, 95.1089, 0.5);
  EXPECT_LT(map.mass_interval.low, 95.1089);
  EXPECT_GT(map.mass_interval.high, 95.1089);
  EXPECT_LT(map.held_out_rms,
            1.6646);  // the map must explain held-out cycles better than a straight line does its own
}

log::Record straight_drive(double scale_length, double scale_force) {
  // m·a = f − Fv·v − Fc·sgn v − offset, force and position analytic; v never crosses zero within a half
  // period.
  log::Record rec;
  rec.source = "analytic";
  rec.sample_time = 0.001;
  for (int k = 0; k < 12000; ++k) {
    const double t = 0.001 * k;
    const double w = 1.5;
    const double v = 0.1 * w * std::cos(w * t) + 0.03 * 4 * w * std::cos(4 * w * t);
    const double a = -0.1 * w * w * std::sin(w * t) - 0.03 * 16 * w * w * std::sin(4 * w * t);
    rec.t.push_back(t);
    rec.x.push_back(scale_length * (0.1 * std::sin(w * t) + 0.03 * std::sin(4 * w * t)));
    rec.f.push_back(scale_force * (50.0 * a + 120.0 * v + 15.0 * (v > 0 ? 1 : -1) - 2.0));
  }
  return rec;
}

TEST(IdimLs, RecoversAStraightLineDrive) {
  const auto p = identify_idim_ls(straight_drive(1.0, 1.0)).published;
  // Steps of sgn v are smoothed by the decimation, differently in force and regressor only where v is off by
  // the filter: a few 1e-3 of the Coulomb force.
  EXPECT_NEAR(p.value[0], 50.0, 0.02);
  EXPECT_NEAR(p.value[1], 120.0, 0.5);
  EXPECT_NEAR(p.value[2], 15.0, 0.05);
  EXPECT_NEAR(p.value[3], -2.0, 0.02);
}

TEST(IdimLs, ScalesWithTheUnitsOfLengthAndForce) {
  const auto a = identify_idim_ls(straight_drive(1.0, 1.0)).published;
  const auto b = identify_idim_ls(straight_drive(8.0, 2.0)).published;
  EXPECT_NEAR(b.value[0], a.value[0] * 2.0 / 8.0, 1e-9 * a.value[0]);
  EXPECT_NEAR(b.value[1], a.value[1] * 2.0 / 8.0, 1e-9 * a.value[1]);
  EXPECT_NEAR(b.value[2], a.value[2] * 2.0, 1e-9 * a.value[2]);
  EXPECT_NEAR(b.relative_error, a.relative_error, 1e-9);
}

TEST(IdimLs, MirroredMotionMirrorsTheDirections) {
  log::Record rec = straight_drive(1.0, 1.0);
  IdimOptions options;
  options.by_direction = true;
  const auto a = identify_idim_ls(rec, options).published;
  for (double& x : rec.x) x = -x;
  for (double& f : rec.f) f = -f;
  const auto b = identify_idim_ls(rec, options).published;
  EXPECT_NEAR(a.value[0], b.value[0], 1e-8);
  EXPECT_NEAR(a.value[1], b.value[3], 1e-7);
  EXPECT_NEAR(a.value[2], b.value[4], 1e-7);
}

TEST(IdimLs, RefusesACutOffBeyondHalfTheRate) {
  IdimOptions options;
  options.cut_off = 600.0;
  EXPECT_THAT([&] { identify_idim_ls(straight_drive(1.0, 1.0), options); },
              ThrowsMessage<Refused>(HasSubstr("half the sampling frequency of the log")));
}

// A log in amperes gave an axis file with its amperes as newtons.
TEST(IdimLs, KeepsTheUnitsOfTheLog) {
  log::Record rec = straight_drive(1.0, 1.0);
  rec.force_unit = "A", rec.position_unit = "rad";
  const Result r = identify_idim_ls(rec).result;
  EXPECT_EQ(r.force_unit, "A");
  EXPECT_EQ(r.position_unit, "rad");
}

}  // namespace
}  // namespace stribeck::ident::methods::idim_ls_test
