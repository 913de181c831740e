#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/control/laws/pid.hpp>
#include <stribeck/control/laws/test_laws.hpp>
#include <stribeck/core/test_fields.hpp>
#include <utility>

namespace stribeck::control::pid_test {
namespace {

TEST(Pid, AnswersADisturbanceAsItsTriplePoleSays) {
  // e(s) = −(d/m)/s · s/(s + w)³:  e(t) = −(d/m)·t²/2·exp(−w t). A period of 10 us is off by 0.1 % of the peak.
  constexpr double kPeriod = 1e-5;
  constexpr double kForce = 100.0;
  constexpr double kOmega = 30.0;
  test::Disturbed<PidParams> loop(PidParams::triple(kOmega), kPeriod, kForce);
  const double peak = kForce / test::kMass * 2.0 / (kOmega * kOmega) * std::exp(-2.0);
  for (int k = 1; k <= 40; ++k) {
    const double t = 0.01 * k;
    const double e = loop.error_after(1000);
    EXPECT_NEAR(e, -kForce / test::kMass * 0.5 * t * t * std::exp(-kOmega * t), 1e-3 * peak) << t;
  }
}

TEST(Pid, LeavesNoErrorUnderAConstantDisturbanceWherePdDoes) {
  PidParams pd;
  pd.ki = {0.0};
  EXPECT_NEAR(test::Disturbed<PidParams>(pd, 1e-3, 100.0).error_after(2000), -100.0 / test::kMass / 2700.0,
              1e-12);
  EXPECT_NEAR(test::Disturbed<PidParams>({}, 1e-3, 100.0).error_after(2000), 0.0, 1e-12);
}

TEST(Pid, StabilityIsWhereTheSampledLoopDiesOut) {
  // Near Routh's border k_i = k_p k_v = 243000 for a short period, elsewhere for a long one.
  for (const double period : {1e-4, 1e-3, 5e-3, 10e-3}) {
    PidParams p;
    double below = 0.0;
    double above = 2e6;
    for (int k = 0; k < 40; ++k) {
      p.ki = {0.5 * (below + above)};
      (p.stable(period) ? below : above) = p.ki[0];
    }
    p.ki = {0.97 * below};
    EXPECT_TRUE(test::dies_out(p, period)) << period;
    p.ki = {1.03 * below};
    EXPECT_FALSE(test::dies_out(p, period)) << period;
    if (period == 1e-4) {
      EXPECT_NEAR(below, 243e3, 0.01 * 243e3);
    }
  }
}

TEST(Pid, RouthNamesTheBorder) {
  PidParams p;
  p.ki = {2700.0 * 90.0 * 0.999};
  EXPECT_TRUE(p.stable());
  p.ki = {2700.0 * 90.0 * 1.001};
  EXPECT_FALSE(p.stable());
  p.ki = {27000.0, 300e3};  // the second axis
  EXPECT_FALSE(p.stable());
}

TEST(Pid, DefaultsAreStableOnTheVirtualMachines) {
  for (const double period : {1e-3, 5e-3}) EXPECT_TRUE(PidParams{}.stable(period));
  EXPECT_FALSE(PidParams::triple(60.0).stable(20e-3));
}

TEST(Pid, DoesNotWindUp) {
  // Pushed by more than the drive can give for half a second, then let go: without the limits of the integral it would
  // overshoot by centimetres. The mass comes back from where it was pushed and overshoots by less than a quarter of that.
  constexpr double kPeriod = 1e-3;
  auto setup = test::masses<1>(kPeriod);
  setup.force_limit = {{100.0}};
  const Pid<1> law({}, setup);
  Pid<1>::State s;
  test::Mass mass;
  double lowest = 0.0;
  double highest = 0.0;
  for (int k = 0; k < 5000; ++k) {
    const double force = law.step(s, {}, {{mass.x}})[0];
    mass.move(force - (k < 200 ? 150.0 : 0.0), kPeriod);
    lowest = std::min(lowest, mass.x);
    highest = std::max(highest, mass.x);
    ASSERT_LE(2700.0 * 10.0 * std::abs(s.integral[0]) * test::kMass, 100.0 * (1.0 + 1e-12));
  }
  EXPECT_LT(lowest, -10e-3);
  EXPECT_LT(highest, 0.5 * -lowest);
  EXPECT_NEAR(mass.x, 0.0, 1e-6);
}

TEST(Pid, TheIntegralStandsStillOnlyWhileItWouldDriveALimitedForceFurther) {
  auto setup = test::masses<1>(1e-3);
  setup.force_limit = {{100.0}};
  const Pid<1> law({}, setup);
  path::PathPoint<1> up;
  up.acceleration = {{1000.0}};
  path::PathPoint<1> down;
  down.acceleration = {{-1000.0}};
  Pid<1>::State s;
  for (const double side : {1e-6, -1e-6}) {
    const double before = s.integral[0];
    law.step(s, side > 0.0 ? down : up, {{side}});  // limited, and the error asks for more of it
    EXPECT_EQ(s.integral[0], before);
    law.step(s, side > 0.0 ? up : down, {{side}});  // limited, and the error asks for less
    EXPECT_NEAR(s.integral[0], before + 1e-3 * side, 1e-20);
  }
}

// Supervision holds the force back until an axis has moved as the force says; behind a closed brake that takes seconds.
TEST(Pid, DoesNotWindUpWhileSupervisionHoldsTheForceBack) {
  const Pid<1> law({}, test::masses<1>(1e-3));
  Pid<1>::State s;
  law.step(s, {}, {{-1e-3}});
  const double begun = s.integral[0];
  s.cut[0] = true;
  for (int k = 0; k < 1000; ++k) law.step(s, {}, {{-1e-3}});
  EXPECT_EQ(s.integral[0], begun);
  s.cut[0] = false;
  law.step(s, {}, {{-1e-3}});
  EXPECT_NE(s.integral[0], begun);
}

TEST(Pid, WhetherItIsStableDoesNotDependOnTheUnitOfTime) {
  // The same loop in seconds, in milliseconds and in hours; just inside and just outside of k_i = k_p·k_v.
  for (const double second : {1.0, 1e3, 1.0 / 3600.0}) {
    for (const double share : {0.0, 0.99, 1.01}) {
      PidParams p;
      p.kp = {900.0 / (second * second)};
      p.kv = {60.0 / second};
      p.ki = {share * 900.0 * 60.0 / (second * second * second)};
      EXPECT_EQ(p.stable(), share < 1.0) << second << ", " << share;
      EXPECT_EQ(p.stable(1e-4 * second), share < 1.0) << second << ", " << share;
    }
  }
}

TEST(Pid, EachGainOfEachAxisCanMakeItUnstable) {
  const PidParams sound = PidParams::triple(30.0);
  for (const double wrong : {0.0, -1e-3, -1e3, std::nan("")}) {
    for (const auto gain : {&PidParams::kp, &PidParams::kv, &PidParams::ki}) {
      for (const std::size_t axis : {0, 2}) {
        PidParams p = sound;
        p.*gain = {(sound.*gain)[0], (sound.*gain)[0], (sound.*gain)[0]};
        (p.*gain)[axis] = wrong;
        // Without an integral the loop is still one.
        const bool none = gain == &PidParams::ki && wrong == 0.0;
        EXPECT_EQ(p.stable(), none) << wrong << " on axis " << axis;
        EXPECT_EQ(p.stable(1e-3), none) << wrong << " on axis " << axis;
      }
    }
  }
}

TEST(Pid, SaysWhichGainMakesItUnstable) {
  using Keys = std::set<std::string>;
  EXPECT_EQ(stribeck::test::complaints(PidParams{}), Keys{});
  PidParams p;
  p.ki = {1e9};
  EXPECT_EQ(stribeck::test::complaints(p), Keys{"ki"});
}

TEST(Pid, WithoutGainsThereIsNoFeedback) {
  test::expect_no_feedback([] {
    PidParams p;
    p.kp = p.ki = p.kv = {};
    return p;
  }());
}

TEST(Pid, TheIntegralOfEachAxisGivesNoMoreThanItsLimit) {
  // The references ask for braking, so that the whole force stays within the limits while the integral grows.
  for (const bool swapped : {false, true}) {
    PidParams p;
    p.ki = {27000.0, 9000.0};
    auto setup = test::masses<2>(1e-3);
    setup.force_limit = {{100.0, 60.0}};
    setup.compensation[1].model.mass = 20.0;
    if (swapped) {
      std::swap(p.ki[0], p.ki[1]);
      std::swap(setup.force_limit[0], setup.force_limit[1]);
      std::swap(setup.compensation[0], setup.compensation[1]);
    }
    const Pid<2> law(p, setup);
    Pid<2>::State s;
    path::PathPoint<2> r;
    r.acceleration = {{-1.0, -1.0}};
    for (int k = 0; k < 30000; ++k) law.step(s, r, {{-0.1e-3, -0.1e-3}});
    for (std::size_t i = 0; i < 2; ++i) {
      const double mass = setup.compensation[i].model.mass;
      EXPECT_NEAR(mass * p.ki[i] * s.integral[i], -setup.force_limit[i], 1e-9) << i;
    }
  }
}

TEST(Pid, OnlyTheIntegralOfTheAxisThatIsHeldBackRests) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const Pid<2> law({}, test::masses<2>(1e-3));
    Pid<2>::State s;
    s.cut[axis] = true;
    for (int k = 0; k < 10; ++k) law.step(s, {}, {{-1e-3, -1e-3}});
    EXPECT_EQ(s.integral[axis], 0.0);
    EXPECT_NEAR(s.integral[1 - axis], -10.0 * 1e-6, 1e-15);
  }
}

TEST(Pid, KeepsWhatEveryLawKeeps) {
  test::expect_nan_answered(PidParams{});
  test::expect_limits_kept(PidParams{});
  test::expect_mirrored(PidParams{});
  for (const double period : {1e-3, 5e-3})
    EXPECT_LT(test::worst_error_under_known_friction(PidParams{}, period), 1e-12);
}

}  // namespace
}  // namespace stribeck::control::pid_test
