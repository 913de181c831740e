#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/excitation/excitation.hpp>
#include <stribeck/ident/methods/jog/jog.hpp>
#include <stribeck/ident/methods/test_jogs.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/test_drive.hpp>

namespace stribeck::ident::methods::jog_test {
namespace {

using test::ideal;
using test::kPeriod;
using test::kTable;
using test::printed;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

double parameter(const Result& r, const std::string& name) {
  for (const Parameter& p : r.parameters) {
    if (p.name == name) return p.value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// Closed form: the parameters of (2.9) come back. Noise of 0.01 N, so that no candidate wins by rounding; its means
// err by 0.0005 N.
TEST(Jog, ReturnsTheParametersOfAPrintedTable) {
  const log::Record r = ideal(
      excitation::jog_speeds(9e-3), [](double v, double) { return printed(v, 10.0); }, 0.01);
  for (const Solver solver : {Solver::kDerivatives, Solver::kSimplex}) {
    JogOptions options;
    options.solver = solver;
    options.gaussians = false;
    const Jog jog = identify_jog({r}, options);
    EXPECT_EQ(jog.runs.size(), 46u);
    EXPECT_EQ(jog.result.model, "conventional");
    EXPECT_NEAR(parameter(jog.result, "alpha0"), 20.0, 3e-3);
    EXPECT_NEAR(parameter(jog.result, "alpha1"), 35.0, 3e-3);
    EXPECT_NEAR(parameter(jog.result, "alpha2"), 5000.0, 1.0);
    EXPECT_NEAR(parameter(jog.result, "v0"), 0.6e-3, 3e-7);
    EXPECT_NEAR(jog.result.load, 10.0, 2e-3);
    EXPECT_TRUE(std::isnan(jog.result.mass));
    EXPECT_THAT(jog.result.cannot_tell, Contains(HasSubstr("mass")));
  }
}

// Limit: without a rise none is given, and without a load none.
TEST(Jog, GivesNoTermThatIsNotThere) {
  int plain = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    JogOptions options;
    options.gaussians = seed == 1;  // they take most of the time
    const auto plain_law = [](double v, double) { return (v > 0 ? 20.0 : -20.0) + 5000.0 * v; };
    const Jog jog = identify_jog({ideal(excitation::jog_speeds(9e-3), plain_law, 2.0, seed)}, options);
    const auto* map = std::get_if<friction::Conventional<double>>(&jog.result.friction.steady);
    plain += map != nullptr && !map->stribeck;
    EXPECT_NEAR(jog.result.load, 0.0, 0.1);
    EXPECT_FALSE(jog.result.friction.eccentric.size() > 0);
  }
  EXPECT_GE(plain, 3);
}

// Invariance: the mirrored log gives the mirrored friction.
TEST(Jog, MirroredMotionSwapsTheDirections) {
  const auto uneven = [](double v, double) { return v > 0 ? 30.0 + 4000.0 * v : -20.0 + 7000.0 * v; };
  log::Record r = ideal(excitation::jog_speeds(9e-3), uneven, 0.5, 4);
  JogOptions options;
  options.gaussians = false;
  const Jog a = identify_jog({r}, options);
  for (auto* column : {&r.x, &r.r, &r.f}) {
    for (double& y : *column) y = -y;
  }
  const Jog b = identify_jog({r}, options);
  for (const double v : {0.1e-3, 1e-3, 8e-3}) {
    const auto total = [](const Result& result, double at) {
      return friction::steady_force(result.friction, at) + result.load;
    };
    EXPECT_NEAR(total(a.result, v), -total(b.result, -v), 1e-6) << v;
    EXPECT_NEAR(total(a.result, v), uneven(v, 0.0), 0.3) << v;
  }
}

// A term of the screw is no whole number of periods long at any speed; it is found and taken off.
TEST(Jog, TakesOffATermPeriodicInPosition) {
  JogOptions options;
  options.gaussians = false;
  const Jog jog = identify_jog(
      {ideal(
          excitation::jog_speeds(9e-3),
          [](double v, double x) { return printed(v, 0.0) + 4.2 * std::sin(2 * kPi * x / 2e-3 - 0.28); },
          0.5)},
      options);
  ASSERT_EQ(jog.result.friction.eccentric.size(), 1u);
  const auto& e = jog.result.friction.eccentric[0];
  EXPECT_NEAR(e.amplitude, 4.2, 0.1);
  EXPECT_NEAR(e.period, 2e-3, 1e-5);
  EXPECT_NEAR(e.phase, 0.28, 0.05);
  EXPECT_EQ(e.form, friction::EccentricForm::kAdditive);
  EXPECT_NEAR(parameter(jog.result, "alpha1"), 35.0, 0.5);
}

// Independent reference: the virtual drive with Table 2.3; its curves within 2 % from 0.5 to 9 mm/s, and the mass from
// a sine among the logs.
TEST(Jog, ReadsTable23OffTheVirtualDrive) {
  test::Drive drive;
  drive.friction = test::table_2_3('x');
  excitation::JogDesign design;
  const log::Record r = test::run_closed(drive, 55e3, excitation::design_jog(kTable, kPeriod, design).r, 1);
  const log::Record sine = test::run_closed(drive, 55e3, test::sine_reference(kPeriod, 0.02, 0.475, 4), 2);
  const Jog jog = identify_jog({r, sine});
  for (double speed = 0.5e-3; speed <= 9e-3; speed += 0.25e-3) {
    for (const double v : {speed, -speed}) {
      EXPECT_NEAR(friction::steady_force(jog.result.friction, v) / drive.steady(v), 1.0, 0.02) << v;
    }
  }
  EXPECT_NEAR(jog.result.mass / drive.mass, 1.0,
              0.015);  // four periods of a slow sine: standard deviation 0.55 %
  // σ0·δ = g: 3.1 to 3.9 um.
  EXPECT_NEAR(jog.result.break_away_distance, 3.5e-6, 1.0e-6);
}

// A step between two speeds in both directions is another day, a Stribeck rise is not.
TEST(Jog, SaysThatTwoDaysAreMixed) {
  const std::vector<double> speeds{0.1e-3, 0.2e-3, 0.3e-3, 0.4e-3, 0.5e-3, 0.7e-3, 1e-3, 2e-3, 4e-3, 8e-3};
  const auto day = [](double v, double) {
    const double level = (std::abs(v) < 0.45e-3 ? 1.25 : 1.0) * 20.0;
    return (v > 0 ? level : -level) + 100.0 * v;
  };
  const Jog jog = identify_jog({ideal(speeds, day, 0.2)});
  ASSERT_FALSE(jog.result.warnings.empty());
  EXPECT_THAT(jog.result.warnings.front(), HasSubstr("two measuring days"));
  ASSERT_EQ(jog.groups.size(), 1u);
  EXPECT_NEAR(friction::steady_force(jog.result.friction, 1e-3) + jog.result.load, 20.1, 0.3);
  EXPECT_NEAR(friction::steady_force(jog.groups[0].friction, 0.3e-3) + jog.groups[0].load, 25.0, 0.3);
  const Jog one = identify_jog({ideal(
      speeds, [](double v, double) { return printed(v, 0.0); }, 0.2)});
  EXPECT_TRUE(one.groups.empty());
}

// Velocity alone, one record per run, in any order, as drives log it.
TEST(Jog, TakesRecordsOfVelocityAlone) {
  std::vector<log::Record> records;
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  for (const double v : {5e-3, -1e-3, 1e-3, -5e-3, 2e-3, -2e-3, 8e-3, -8e-3, 3e-3, -3e-3}) {
    log::Record r;
    r.source = std::to_string(v);
    r.sample_time = 0.01;
    r.force_unit = "%";
    for (int k = 0; k < 400; ++k) {
      r.t.push_back(0.01 * k);
      r.v.push_back(v + 0.05e-3 * normal(engine));
      r.f.push_back((v > 0 ? 12.0 : -12.0) + 800.0 * v + 0.5 * normal(engine));
    }
    records.push_back(std::move(r));
  }
  const Jog jog = identify_jog(records);
  EXPECT_EQ(jog.runs.size(), 10u);
  EXPECT_EQ(jog.result.force_unit, "%");
  EXPECT_NEAR(parameter(jog.result, "alpha0"), 12.0, 0.1);
  EXPECT_NEAR(parameter(jog.result, "alpha2"), 800.0, 20.0);
}

TEST(Jog, RefusesALogWithoutConstantSpeeds) {
  test::Drive drive;
  drive.friction = test::table_2_3('x');
  const log::Record sine = test::run_closed(drive, 55e3, test::sine_reference(kPeriod, 0.02, 0.475, 1), 2);
  EXPECT_THAT([&] { identify_jog({sine}); },
              ThrowsMessage<Refused>(HasSubstr("no stretch of constant speed")));
  EXPECT_THROW(identify_jog({}), Refused);
  EXPECT_THAT([&] { identify_jog({ideal({1e-3}, [](double v, double) { return printed(v, 0.0); })}); },
              ThrowsMessage<Refused>(HasSubstr("expected at least 3")));
}

// Table 2.3 has a term of 0.475 mm/s width at −9.3 mm/s, y: steps of 0.5 mm/s see it at one speed. With noise of 120 N
// most logs leave it open; a speed between them tells it.
TEST(Jog, SaysWhereASpeedIsMissing) {
  test::Drive drive;
  drive.friction = test::table_2_3('y');
  const auto logs_that_ask = [&](const std::vector<double>& speeds) {
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const log::Record r = ideal(
          speeds, [&](double v, double) { return drive.steady(v); }, 120.0, seed);
      for (const std::string& words : identify_jog({r}).result.cannot_tell)
        count +=
            words.find(
                "negative direction: the curve may bend more than these speeds show; jog at 8.75 mm/s") !=
            std::string::npos;
    }
    return count;
  };
  std::vector<double> speeds = excitation::jog_speeds(9e-3);
  EXPECT_GE(logs_that_ask(speeds), 3);
  speeds.push_back(8.75e-3);
  EXPECT_EQ(logs_that_ask(speeds), 0);
}

}  // namespace
}  // namespace stribeck::ident::methods::jog_test
