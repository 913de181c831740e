#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/excitation/worst_case.hpp>

namespace stribeck::ident::excitation::worst_case_test {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// A belt axis of 45 kg with 40 N of friction.
constexpr Limits kBelt{-0.6, 0.6, 0.5, 2.0, 377.0};
constexpr RoughDrive kRough{45.0, 40.0, 0.0};
constexpr double kPeriod = 1e-3;

Doubt factor_three() { return {15.0, 135.0, 40.0 / 3.0, 120.0, 0.0}; }
Doubt certain(double mass, double friction) { return {mass, mass, friction, friction, 0.0, 1.0}; }

// F = 2·f: a mass of 10 kg under 20 N against 10 N gains 1 m/s in a second and stops 0.5 m later after another.
TEST(WorstCase, IsTheClosedFormWhereNothingIsUnknown) {
  std::vector<double> force(1000, 20.0);
  const Limits wide{-10.0, 10.0, 10.0, 0.0, 0.0};
  const Reach r = reach_of(force, kPeriod, 0.0, certain(10.0, 10.0), wide);
  EXPECT_NEAR(r.speed, 1.0, 1e-9);
  EXPECT_NEAR(r.highest, 1.0, 2e-3);  // one step of the simulation at full speed is 0.25 mm
  EXPECT_EQ(r.lowest, 0.0);
  EXPECT_EQ(beyond(r, wide), "");
  EXPECT_THAT(beyond(r, {-10.0, 0.9, 10.0, 0.0, 0.0}), HasSubstr("the travel is -1e+04 to 900 mm"));
  EXPECT_THAT(beyond(r, {-10.0, 10.0, 0.9, 0.0, 0.0}), HasSubstr("the limit of speed is 900 mm/s"));
}

TEST(WorstCase, IsMirroredWithForceAndLoad) {
  std::vector<double> up;
  for (int k = 0; k < 800; ++k) up.push_back(k < 300 ? 150.0 : k < 600 ? -90.0 : 60.0);
  std::vector<double> down;
  for (const double f : up) down.push_back(-f);
  Doubt doubt = factor_three();
  doubt.load = 8.0;
  Doubt mirrored = doubt;
  mirrored.load = -8.0;
  const Reach a = reach_of(up, kPeriod, 0.0, doubt, kBelt);
  const Reach b = reach_of(down, kPeriod, 0.0, mirrored, kBelt);
  EXPECT_DOUBLE_EQ(a.highest, -b.lowest);
  EXPECT_DOUBLE_EQ(a.lowest, -b.highest);
  EXPECT_DOUBLE_EQ(a.speed, b.speed);
}

// Any axis between the bounds, moved by another simulation with finer steps, stays inside.
TEST(WorstCase, SafePulsesKeepEveryAxisInside) {
  const SafeExcitation safe = design_safe_pulses(kBelt, kRough, factor_three(), kPeriod, {});
  EXPECT_LE(safe.reach.speed, kBelt.speed);
  EXPECT_GE(safe.reach.lowest, kBelt.travel_min);
  EXPECT_LE(safe.reach.highest, kBelt.travel_max);
  EXPECT_THAT(safe.excitation.says, HasSubstr("Worst case"));
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> third(-1.0, 1.0);
  for (int i = 0; i < 100; ++i) {
    const double mass = kRough.mass * std::pow(3.0, third(random));
    const double friction = kRough.coulomb * std::pow(3.0, third(random));
    double x = 0.0;
    double v = 0.0;
    constexpr int kParts = 20;
    for (const double f : safe.excitation.force) {
      for (int k = 0; k < kParts; ++k) {
        const double dt = kPeriod / kParts;
        const double drive = f - (v > 0.0   ? friction
                                  : v < 0.0 ? -friction
                                            : std::clamp(f, -friction, friction));
        const double next = v + dt * drive / mass;
        v = next * v < 0.0 ? 0.0 : next;
        x += dt * v;
      }
      ASSERT_LE(std::abs(x), 0.6) << "mass " << mass << " kg, friction " << friction << " N";
      ASSERT_LE(std::abs(v), 0.5 * 1.001) << "mass " << mass << " kg, friction " << friction << " N";
    }
  }
}

TEST(WorstCase, PulsesOfTheThesisStayWhereTheyAreSafe) {
  const Excitation as_ever = design_pulses(kBelt, kRough, kPeriod);
  const Doubt little{45.0, 45.0, 0.85 * 40.0, 40.0 / 0.85, 0.0, 1.0};
  EXPECT_EQ(design_safe_pulses(kBelt, kRough, little, kPeriod, {}).excitation.force, as_ever.force);
  EXPECT_NE(design_safe_pulses(kBelt, kRough, factor_three(), kPeriod, {}).excitation.force, as_ever.force);
}

TEST(WorstCase, NoForcesInOpenLoopOnAnAxisThatMayFall) {
  Doubt vertical = factor_three();
  vertical.load = 176.0;
  EXPECT_TRUE(vertical.may_fall(kBelt));
  EXPECT_THAT([&] { design_safe_pulses(kBelt, kRough, vertical, kPeriod, {}); },
              ThrowsMessage<Refused>(HasSubstr("the axis may fall: its load of 176 N")));
  EXPECT_THAT([&] { design_safe_ramp(kBelt, kRough, vertical, kPeriod, {}); },
              ThrowsMessage<Refused>(HasSubstr("choose jog and sine")));
  vertical.load = 10.0;  // below a third of the friction
  EXPECT_FALSE(vertical.may_fall(kBelt));
}

TEST(WorstCase, ARangeOfTheLoadIsPlayedFromEndToEnd) {
  Doubt doubt = certain(10.0, 10.0);
  doubt.load = 8.0;
  EXPECT_FALSE(doubt.may_fall(kBelt));
  doubt.load_spread = 4.0;
  EXPECT_DOUBLE_EQ(doubt.weight(-1.0, 1.0), 12.0);
  EXPECT_TRUE(doubt.may_fall(kBelt));
  // Without force the heaviest load moves the axis down, the middle of the range does not.
  const std::vector<double> nothing(200, 0.0);
  EXPECT_LT(reach_of(nothing, kPeriod, 0.0, doubt, kBelt).lowest, -1e-3);
  EXPECT_DOUBLE_EQ(force_needed({0.0, 0.0, 0.0}, kPeriod, doubt), 22.0);
}

// A ramp ends above the expected friction; with a third of it the axis is long under way.
TEST(WorstCase, RampsNeedARange) {
  EXPECT_THAT([&] { design_safe_ramp(kBelt, kRough, factor_three(), kPeriod, {}); },
              ThrowsMessage<Refused>(HasSubstr("write a range for friction")));
}

TEST(WorstCase, ForceOfAClosedLoopIsMassTimesAccelerationAndFriction) {
  std::vector<double> r;
  for (int k = 0; k < 100; ++k) r.push_back(0.5 * 2.0 * k * k * kPeriod * kPeriod);
  Doubt d = factor_three();
  d.load = -30.0;
  EXPECT_NEAR(force_needed(r, kPeriod, d), 135.0 * 2.0 + 120.0 + 30.0, 1e-6);
}

// Released level with the axis, the heavy side falls a quarter turn: J·v²/2 = M − F·π/2.
TEST(WorstCase, AnUnbalancedTableFallsAsItsEnergySays) {
  constexpr double kTorque = 110.0, kFriction = 20.0, kInertia = 10.0;
  Limits turn{-4.0, 4.0, 10.0, 0.0, 0.0, true};
  Doubt doubt = certain(kInertia, kFriction);
  doubt.unbalance = kTorque;
  doubt.hangs_at = 0.0;
  const std::vector<double> nothing(3000, 0.0);
  const Reach r = reach_of(nothing, kPeriod, 0.5 * kPi, doubt, turn);
  // Fastest a little before the bottom, where the torque is that of friction.
  const double there = std::asin(kFriction / kTorque);
  const double square = 2.0 * (kTorque * std::cos(there) - kFriction * (0.5 * kPi - there)) / kInertia;
  EXPECT_NEAR(r.speed, std::sqrt(square), 0.01 * std::sqrt(square));  // a step of 0.25 ms
  EXPECT_LT(r.lowest, 0.0);
  EXPECT_THAT(r.farthest, HasSubstr("10.0 kg m2 with 20.0 N m of friction"));
  // At the bottom it rests.
  EXPECT_EQ(reach_of(nothing, kPeriod, 0.0, doubt, turn).speed, 0.0);
}

TEST(WorstCase, AnUnbalanceCountsWhereTheTravelReachesIt) {
  Doubt doubt = certain(10.0, 20.0);
  doubt.unbalance = 110.0;
  const Limits near_bottom{-0.1, 0.1, 1.0, 0.0, 0.0, true}, wide{-1.0, 1.0, 1.0, 0.0, 0.0, true};
  EXPECT_TRUE(doubt.may_fall(near_bottom));  // it may hang anywhere
  doubt.hangs_at = 0.0;
  EXPECT_FALSE(doubt.may_fall(near_bottom));
  EXPECT_NEAR(doubt.weight(-0.1, 0.1), 110.0 * std::sin(0.1), 1e-9);
  EXPECT_TRUE(doubt.may_fall(wide));
  EXPECT_THAT(
      [&] {
        design_safe_pulses(wide, {10.0, 20.0, 0.0}, doubt, kPeriod, {});
      },
      ThrowsMessage<Refused>(HasSubstr("load with the unbalance of 92.56 N m")));
}

}  // namespace
}  // namespace stribeck::ident::excitation::worst_case_test
