#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/methods/equal_speed.hpp>
#include <stribeck/ident/methods/test_jogs.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/test_drive.hpp>

namespace stribeck::ident::methods::equal_speed_test {
namespace {

using test::ideal;
using test::kPeriod;
using test::kTable;
using test::printed;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

map::SteadyRun steady(double speed, double force, double error = 0.1) {
  map::SteadyRun run;
  run.speed = speed;
  run.force = force;
  run.error = error;
  return run;
}

// By hand: F(±v) = 5 ± (20 + 1000·v).
TEST(LoadOf, IsHalfTheSumAndFrictionHalfTheDifference) {
  const LoadEstimate e =
      load_of({steady(2e-3, 27.0), steady(-2e-3, -17.0), steady(5e-3, 30.0), steady(-5e-3, -20.0)});
  ASSERT_EQ(e.pairs.size(), 2U);
  EXPECT_NEAR(e.value, 5.0, 1e-12);
  EXPECT_NEAR(e.pairs[0].friction, 22.0, 1e-12);
  EXPECT_NEAR(e.pairs[1].friction, 25.0, 1e-12);
  EXPECT_NEAR(e.pairs[1].speed, 5e-3, 1e-15);
  // Two means of error 0.1: half of √2·0.1.
  EXPECT_NEAR(e.pairs[0].error, 0.05 * std::sqrt(2.0), 1e-12);
  EXPECT_TRUE(e.constant);
}

// 2 N of difference at errors of 0.07 N: that is no load of its own.
TEST(LoadOf, IsNotConstantWhereTheDirectionsDiffer) {
  const LoadEstimate e =
      load_of({steady(2e-3, 27.0), steady(-2e-3, -17.0), steady(5e-3, 34.0), steady(-5e-3, -20.0)});
  EXPECT_NEAR(e.value, 6.0, 1e-12);
  EXPECT_FALSE(e.constant);
}

TEST(LoadOf, NeedsASpeedInBothDirections) {
  const LoadEstimate e = load_of({steady(2e-3, 27.0), steady(-3e-3, -17.0)});
  EXPECT_TRUE(e.pairs.empty());
  EXPECT_TRUE(std::isnan(e.value));
}

TEST(Gravity, IsHalfTheSumOfBothDirections) {
  const auto weighed = [](double v, double) { return printed(v, 10.0); };
  const Result r = identify_gravity({ideal({1e-3, 4e-3, 8e-3}, weighed, 0.5)});
  EXPECT_NEAR(r.load, 10.0, 0.1);
  EXPECT_LE(r.parameters[0].ci_low, 10.0);
  EXPECT_GE(r.parameters[0].ci_high, 10.0);
  ASSERT_EQ(r.curve.size(), 6u);
  EXPECT_NEAR(r.curve.back().friction, printed(8e-3, 0.0), 0.3);
}

// Independent reference: triangles of speed on the virtual drive. 95 % intervals over 20 seeds.
TEST(ConstantAcceleration, GivesTheMassWhateverTheFriction) {
  test::Drive drive;
  drive.friction = test::table_2_3('y');
  const excitation::Excitation e = excitation::design_constant_acceleration(kTable, kPeriod);
  int covered = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Result r = identify_constant_acceleration({test::run_closed(drive, 50e3, e.r, seed)});
    EXPECT_NEAR(r.mass / drive.mass, 1.0, 0.015);
    covered += r.mass_interval.low <= drive.mass && drive.mass <= r.mass_interval.high;
  }
  EXPECT_GE(covered, 16);
}

TEST(Gravity, RefusesOneDirection) {
  std::vector<double> speeds{1e-3, 2e-3};
  log::Record r = ideal(speeds, [](double v, double) { return printed(v, 0.0); });
  // Only the forward rows: the first half of each jog is kept, the return is cut off.
  std::size_t turn = 0;
  while (turn + 1 < r.r.size() && r.r[turn + 1] >= r.r[turn]) ++turn;
  for (auto* column : {&r.t, &r.r, &r.x, &r.f}) column->resize(turn);
  EXPECT_THAT([&] { identify_gravity({r}); },
              ThrowsMessage<Refused>(HasSubstr("none of the speeds in both directions")));
}

TEST(ConstantAcceleration, RefusesAMotionWithoutAcceleration) {
  const log::Record r = ideal(
      {1e-3, 2e-3}, [](double v, double) { return printed(v, 0.0); }, 0.5);
  EXPECT_THAT([&] { identify_constant_acceleration({r}); },
              ThrowsMessage<Refused>(HasSubstr("no mass comes out of")));
}

/// Sine of position, f = m·a + friction(v) + periodic(x); each force is held over the row after its position.
log::Record sine(double mass, double wave, double length) {
  const double T = 0.001, amplitude = 0.02, w = 6.0;
  log::Record r;
  r.source = "sine";
  r.sample_time = T;
  for (int k = 0; k < 6000; ++k) {
    const double t = T * k, middle = t + 0.5 * T;
    const auto x = [&](double s) { return amplitude * std::sin(w * s); };
    const double v = amplitude * w * std::cos(w * middle);
    r.t.push_back(t);
    r.x.push_back(x(t));
    r.r.push_back(x(t));
    r.f.push_back(-mass * amplitude * w * w * std::sin(w * middle) + (v > 0.0 ? 20.0 : -20.0) + 300.0 * v +
                  wave * std::sin(2.0 * kPi * x(middle) / length));
  }
  return r;
}

// A periodic force that acts like a spring has the phase of the acceleration: if its period is not given, it counts as inertia.
// Friction of one bin of speed varies by 300·0.12/60 = 0.6 N, against inertia of ±36 N, and equally while the axis
// accelerates and brakes: 0.5 % is far beyond it.
TEST(MassAtEqualSpeed, FindsTheMassBesideAPeriodicForceOfKnownPeriod) {
  EqualSpeedOptions options;
  options.exclude = 1e-3;
  EXPECT_NEAR(mass_at_equal_speed({sine(50.0, 0.0, 1.0)}, options).value, 50.0, 0.25);
  const std::vector<log::Record> waved{sine(50.0, 8.0, 0.03)};
  EXPECT_GT(std::abs(mass_at_equal_speed(waved, options).value - 50.0), 1.0) << "the wave does not disturb";
  options.periods = {0.03};
  EXPECT_NEAR(mass_at_equal_speed(waved, options).value, 50.0, 0.25);
}

// Invariance: mirrored positions and forces are the same machine; forces in kN give a mass in t.
TEST(MassAtEqualSpeed, MirrorAndUnitOfForce) {
  EqualSpeedOptions options;
  options.exclude = 1e-3;
  const log::Record r = sine(50.0, 0.0, 1.0);
  log::Record mirrored = r, scaled = r;
  for (auto* column : {&mirrored.x, &mirrored.r, &mirrored.f}) {
    for (double& value : *column) value = -value;
  }
  for (double& f : scaled.f) f *= 1e-3;
  const double mass = mass_at_equal_speed({r}, options).value;
  EXPECT_NEAR(mass_at_equal_speed({mirrored}, options).value, mass, 1e-9 * mass);
  EXPECT_NEAR(mass_at_equal_speed({scaled}, options).value, 1e-3 * mass, 1e-12 * mass);
}

// Bristles that settle over 1 mrad: 50 um, which is usual of a linear axis, would be 50 urad.
TEST(MassAtEqualSpeed, LeavesMoreOutOfAnAngle) {
  const double T = 0.001, amplitude = 1.5, w = 2.0, bristle = 2e-4;
  log::Record r;
  r.source = "table";
  r.sample_time = T;
  r.rotary = true;
  for (int k = 0; k < 20000; ++k) {
    const double t = T * k, middle = t + 0.5 * T, v = amplitude * w * std::cos(w * middle);
    const double since = amplitude * (1.0 - std::abs(std::sin(w * middle)));
    const double settling = v * std::sin(w * middle) < 0.0 ? 1.0 - 2.0 * std::exp(-since / bristle) : 1.0;
    r.t.push_back(t);
    r.x.push_back(amplitude * std::sin(w * t));
    r.r.push_back(r.x.back());
    r.f.push_back(-2.0 * amplitude * w * w * std::sin(w * middle) + (v > 0.0 ? 10.0 : -10.0) * settling +
                  0.5 * v);
  }
  EqualSpeedOptions usual;
  usual.exclude = 50e-6;
  const double by_usual = std::abs(mass_at_equal_speed({r}, usual).value - 2.0);
  const double by_own = std::abs(mass_at_equal_speed({r}).value - 2.0);
  EXPECT_LT(by_own, 0.004);
  EXPECT_GT(by_usual, 2.0 * by_own);
}

// The force of a third of the log was frozen: its rows are marked.
TEST(MassAtEqualSpeed, RowsThatAreNotFittedDoNotCount) {
  log::Record r = sine(50.0, 0.0, 1.0);
  r.skip.assign(r.f.size(), 0);
  for (std::size_t k = 2000; k < 4000; ++k) {
    if (k >= 2050 && k < 3950) r.f[k] = 5.0;
    r.skip[k] = 1;
  }
  EXPECT_NEAR(mass_at_equal_speed({r}).value, 50.0, 0.5);
}

}  // namespace
}  // namespace stribeck::ident::methods::equal_speed_test
