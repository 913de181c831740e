#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/control/laws/cascade.hpp>
#include <stribeck/control/laws/pid.hpp>
#include <stribeck/control/laws/test_laws.hpp>
#include <stribeck/core/test_fields.hpp>
#include <utility>

namespace stribeck::control::cascade_test {
namespace {

/// Runs a mass along 10 sin 2t mm and returns the errors.
template <class Params>
std::array<double, 400> sine_errors(const Params& params, double period) {
  using Law = typename Params::template Controller<1>;
  const Law law(params, test::masses<1>(period));
  typename Law::State s;
  test::Mass mass{0.0, 18e-3};  // 2 mm/s slower than the reference
  std::array<double, 400> errors{};
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const double t = static_cast<double>(k) * period;
    path::PathPoint<1> r;
    r.position = {{10e-3 * std::sin(2 * t)}};
    r.velocity = {{20e-3 * std::cos(2 * t)}};
    r.acceleration = {{-40e-3 * std::sin(2 * t)}};
    errors[k] = mass.x - r.position[0];
    mass.move(law.step(s, r, {{mass.x}})[0], period);
  }
  return errors;
}

TEST(Cascade, WithFullFeedforwardItIsThePidOfItsHeader) {
  CascadeParams c;
  PidParams p;
  p.kp = {80.0 * (20.0 + 10.0)};
  p.ki = {80.0 * 20.0 * 10.0};
  p.kv = {80.0};
  const auto a = sine_errors(c, 5e-3);
  const auto b = sine_errors(p, 5e-3);
  // Its integral holds e itself where the PID has the difference: the same but for rounding.
  for (std::size_t k = 0; k < a.size(); ++k) ASSERT_NEAR(a[k], b[k], 1e-13) << k;
}

TEST(Cascade, WithoutVelocityFeedforwardItStaysSpeedOverKvBehind) {
  CascadeParams c;
  c.velocity_feedforward = 0.0;
  constexpr double kPeriod = 1e-3;
  const Cascade<1> law(c, test::masses<1>(kPeriod));
  Cascade<1>::State s;
  test::Mass mass;
  path::PathPoint<1> r;
  r.velocity = {{9.5e-3}};
  for (int k = 0; k < 3000; ++k) {
    mass.move(law.step(s, r, {{mass.x}})[0], kPeriod);
    r.position[0] += kPeriod * r.velocity[0];
  }
  EXPECT_NEAR(mass.x - r.position[0], -9.5e-3 / 20.0, 1e-9);
}

// The velocity of the observer takes the place of the measured one, however much of the reference's velocity is fed forward.
TEST(Cascade, ObservedItUsesTheVelocityOfTheObserver) {
  constexpr double kPeriod = 1e-3;
  for (const double share : {0.0, 0.5, 1.0}) {
    CascadeParams c;
    c.velocity_feedforward = share;
    c.error_rate = ErrorRate::kObserved;
    auto setup = test::masses<1>(kPeriod);
    setup.compensation[0].observer = Observer::kKalman;
    const Cascade<1> law(c, setup);
    Cascade<1>::State s;
    test::Mass mass;
    path::PathPoint<1> r;
    r.velocity = {{9.5e-3}};
    for (int k = 0; k < 200; ++k) {
      mass.move(law.step(s, r, {{mass.x}})[0], kPeriod);
      r.position[0] += kPeriod * r.velocity[0];
    }
    // The next sample lies 1 um ahead: the difference says 1 mm/s more, the observer a part of it.
    law.step(s, r, {{mass.x + 1e-6}});
    const double observed = s.compensation[0].kalman.estimate[1];
    const double commanded = share * 9.5e-3 - 20.0 * (mass.x + 1e-6 - r.position[0]);
    EXPECT_NEAR(s.velocity_error[0], commanded - observed, 1e-12) << share;
    EXPECT_GT(std::abs(s.error[0].velocity - observed), 1e-4);
  }
}

TEST(Cascade, AnswersADisturbanceAsItsPolesSay) {
  // s³ + 60 s² + 960 s + 3600; the step answer 1/((s − s1)(s − s2)(s − s3)) by partial fractions.
  CascadeParams c;
  c.position_gain = {10.0};
  c.velocity_gain = {60.0};
  c.integral_time = {1.0 / 6.0};
  // Roots of the cubic, from numpy.roots([1, 60, 960, 3600]).
  constexpr std::array<double, 3> kRoots{-36.2662472, -18.31334066, -5.42041214};
  constexpr double kPeriod = 1e-5;
  test::Disturbed<CascadeParams> loop(c, kPeriod, 100.0);
  for (int k = 1; k <= 40; ++k) {
    const double t = 0.01 * k;
    double answer = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      double product = 1.0;
      for (std::size_t j = 0; j < 3; ++j) product *= i == j ? 1.0 : kRoots[i] - kRoots[j];
      answer += std::exp(kRoots[i] * t) / product;
    }
    EXPECT_NEAR(loop.error_after(1000), -100.0 / test::kMass * answer, 2e-6) << t;
  }
}

TEST(Cascade, RouthNamesTheBorderAndTheSampledOneLiesWithin) {
  CascadeParams c;
  c.position_gain = {200.0};
  c.integral_time = {0.02};
  c.velocity_gain = {200.0 / (1.0 + 200.0 * 0.02) * 1.01};
  EXPECT_TRUE(c.stable());
  EXPECT_FALSE(c.stable(1e-3));
  EXPECT_FALSE(test::dies_out(c, 1e-3));
  c.velocity_gain = {200.0 / (1.0 + 200.0 * 0.02) * 0.99};
  EXPECT_FALSE(c.stable());
  c.velocity_gain = {200.0};
  EXPECT_TRUE(c.stable(1e-3));
  EXPECT_TRUE(test::dies_out(c, 1e-3));
}

TEST(Cascade, StabilityIsWhereTheSampledLoopDiesOut) {
  for (const double period : {1e-3, 5e-3}) {
    CascadeParams c;
    c.integral_time = {0.03};
    double below = 20.0;
    double above = 4.0 / period;
    for (int k = 0; k < 40; ++k) {
      c.velocity_gain = {0.5 * (below + above)};
      (c.stable(period) ? below : above) = c.velocity_gain[0];
    }
    c.velocity_gain = {0.99 * below};
    EXPECT_TRUE(test::dies_out(c, period)) << period;
    c.velocity_gain = {1.01 * below};
    EXPECT_FALSE(test::dies_out(c, period)) << period;
  }
}

TEST(Cascade, WhetherItIsStableDoesNotDependOnTheUnitOfTime) {
  // The same loop in seconds, in milliseconds and in hours; just inside and just outside of Routh's border.
  for (const double second : {1.0, 1e3, 1.0 / 3600.0}) {
    for (const double share : {0.99, 1.01}) {
      CascadeParams c;
      c.position_gain = {200.0 / second};
      c.integral_time = {0.02 * second};
      c.velocity_gain = {share * 200.0 / 5.0 / second};
      EXPECT_EQ(c.stable(), share > 1.0) << second << ", " << share;
      EXPECT_EQ(c.stable(1e-5 * second), share > 1.0) << second << ", " << share;
    }
  }
}

TEST(Cascade, EachSettingOfEachAxisCanMakeItUnstable) {
  for (const double wrong : {0.0, -1e-3, -1e3, std::nan("")}) {
    for (const auto setting :
         {&CascadeParams::position_gain, &CascadeParams::velocity_gain, &CascadeParams::integral_time}) {
      for (const std::size_t axis : {0, 2}) {
        CascadeParams c;
        const double good = (c.*setting)[0];
        c.*setting = {good, good, good};
        ASSERT_TRUE(c.stable() && c.stable(1e-3));
        (c.*setting)[axis] = wrong;
        EXPECT_FALSE(c.stable()) << wrong << " on axis " << axis;
        // Without a gain of position the sampled loop still holds the axis, by the integral of its velocity.
        const bool held = setting == &CascadeParams::position_gain && wrong == 0.0;
        EXPECT_EQ(c.stable(1e-3), held) << wrong << " on axis " << axis;
      }
    }
  }
}

TEST(Cascade, SaysWhichGainMakesItUnstable) {
  using Keys = std::set<std::string>;
  EXPECT_EQ(stribeck::test::complaints(CascadeParams{}), Keys{});
  CascadeParams c;
  c.velocity_gain = {1.0};
  EXPECT_EQ(stribeck::test::complaints(c), Keys{"velocity_gain"});
}

TEST(Cascade, WithoutIntegralTimesItHasNoIntegral) {
  // A constant force stays as an error of F/(m·K_p·K_v).
  CascadeParams c;
  c.integral_time = {};
  test::Disturbed<CascadeParams> loop(c, 1e-3, 50.0);
  EXPECT_NEAR(loop.error_after(3000), -50.0 / (test::kMass * 80.0 * 20.0), 1e-9);
}

TEST(Cascade, DefaultsAreStableOnTheVirtualMachines) {
  EXPECT_TRUE(CascadeParams{}.stable());
  for (const double period : {1e-3, 5e-3}) EXPECT_TRUE(CascadeParams{}.stable(period));
}

TEST(Cascade, ItsIntegralStaysWithinTheForceLimit) {
  test::Disturbed<CascadeParams> loop({}, 1e-3, 150.0, 100.0);
  loop.error_after(300);
  EXPECT_LE(std::abs(loop.state.integral[0]) * 800.0 * test::kMass, 100.0 * (1.0 + 1e-12));
}

TEST(Cascade, TheIntegralStandsStillOnlyWhileItWouldDriveALimitedForceFurther) {
  // On each of two axes by itself: the other one is not at its limit.
  for (std::size_t axis = 0; axis < 2; ++axis) {
    auto setup = test::masses<2>(1e-3);
    setup.force_limit = {{100.0, 100.0}};
    const Cascade<2> law({}, setup);
    path::PathPoint<2> up;
    up.acceleration[axis] = 1000.0;
    path::PathPoint<2> down;
    down.acceleration[axis] = -1000.0;
    Cascade<2>::State s;
    for (const double side : {1e-6, -1e-6}) {
      s = {};
      law.step(s, {}, {{side, side}});
      const auto before = s.integral;
      const double step = 1e-3 * -20.0 * side;              // T·K_v·e, towards the reference
      law.step(s, side > 0.0 ? down : up, {{side, side}});  // limited, and the error asks for more of it
      EXPECT_EQ(s.integral[axis], before[axis]);
      EXPECT_NEAR(s.integral[1 - axis], before[1 - axis] + step, 1e-18);
      law.step(s, side > 0.0 ? up : down, {{side, side}});  // limited, and the error asks for less
      EXPECT_NEAR(s.integral[axis], before[axis] + step, 1e-18);
    }
  }
}

TEST(Cascade, DoesNotWindUpWhileSupervisionHoldsTheForceBack) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const Cascade<2> law({}, test::masses<2>(1e-3));
    Cascade<2>::State s;
    law.step(s, {}, {{-1e-3, -1e-3}});
    const auto begun = s.integral;
    s.cut[axis] = true;
    for (int k = 0; k < 100; ++k) law.step(s, {}, {{-1e-3, -1e-3}});
    EXPECT_EQ(s.integral[axis], begun[axis]);
    EXPECT_NEAR(s.integral[1 - axis], 101.0 * begun[1 - axis], 1e-12);
  }
}

TEST(Cascade, TheIntegralOfEachAxisGivesNoMoreThanItsLimit) {
  // The references ask for braking, so that the whole force stays within the limits while the integral grows.
  for (const bool swapped : {false, true}) {
    CascadeParams c;
    c.position_gain = {20.0, 20.0};
    c.velocity_gain = {80.0, 80.0};
    c.integral_time = {0.1, 0.3};
    auto setup = test::masses<2>(1e-3);
    setup.force_limit = {{100.0, 60.0}};
    setup.compensation[1].model.mass = 20.0;
    if (swapped) {
      std::swap(c.integral_time[0], c.integral_time[1]);
      std::swap(setup.force_limit[0], setup.force_limit[1]);
      std::swap(setup.compensation[0], setup.compensation[1]);
    }
    const Cascade<2> law(c, setup);
    Cascade<2>::State s;
    path::PathPoint<2> r;
    r.acceleration = {{-1.0, -1.0}};
    for (int k = 0; k < 30000; ++k) law.step(s, r, {{-0.1e-3, -0.1e-3}});
    for (std::size_t i = 0; i < 2; ++i) {
      const double mass = setup.compensation[i].model.mass;
      EXPECT_NEAR(mass * 80.0 / c.integral_time[i] * s.integral[i], setup.force_limit[i], 1e-9) << i;
    }
  }
}

TEST(Cascade, KeepsWhatEveryLawKeeps) {
  test::expect_nan_answered(CascadeParams{});
  test::expect_limits_kept(CascadeParams{});
  test::expect_mirrored(CascadeParams{});
  for (const double period : {1e-3, 5e-3})
    EXPECT_LT(test::worst_error_under_known_friction(CascadeParams{}, period), 1e-12);
}

}  // namespace
}  // namespace stribeck::control::cascade_test
