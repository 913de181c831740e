#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/control/laws/test_laws.hpp>
#include <stribeck/control/laws/zpetc.hpp>

namespace stribeck::control::zpetc_test {
namespace {

/// Transfer from r to x at w [rad/s]: the mass follows sin wt until only that is left, then over whole periods of it.
/// Samples per period of the sine must be a whole number.
template <class Params>
std::complex<double> transfer(const Params& params, int per_period, double period, int late) {
  using Law = typename Params::template Controller<1>;
  const Law law(params, test::masses<1>(period));
  typename Law::State s;
  const double step = 2.0 * kPi / per_period;
  const double w = step / period;
  test::Mass mass;
  std::complex<double> x{};
  std::complex<double> r{};
  const int settle = per_period * (1 + static_cast<int>(2.0 / period) / per_period);
  for (int k = 0; k < settle + 4 * per_period; ++k) {
    // The angle from the place in the period, so that it loses no digits.
    const double angle = step * (k % per_period);
    path::PathPoint<1> p;
    p.position = {{1e-3 * std::sin(angle)}};
    p.velocity = {{1e-3 * w * std::cos(angle)}};
    p.acceleration = {{-1e-3 * w * w * std::sin(angle)}};
    if (k >= settle) {
      const std::complex<double> turn(std::cos(angle), -std::sin(angle));
      x += mass.x * turn;
      r += 1e-3 * std::sin(angle - step * late) * turn;
    }
    mass.move(law.step(s, p, {{mass.x}})[0], period);
  }
  return x / r;
}

TEST(Zpetc, HasNoPhaseAndTheGainOfItsHeaderAtEveryFrequency) {
  ZpetcParams p;
  p.preview = Preview::kDelayed;
  for (const int per_period : {3, 4, 5, 8, 16, 50, 200, 1000}) {
    const auto g = transfer(p, per_period, 5e-3, 2);
    const double half = kPi / per_period;  // wT/2
    EXPECT_NEAR(std::arg(g), 0.0, 1e-9) << per_period;
    EXPECT_NEAR(std::abs(g), std::cos(half) * std::cos(half), 1e-9) << per_period;
    if (per_period >= 50) {
      EXPECT_NEAR((1.0 - std::abs(g)) / (half * half), 1.0, 2e-3) << "second order";
    }
  }
}

TEST(Zpetc, ExtrapolatedItIsOffByThePowerOfItsHeader) {
  // (wT)² w²/k_p, times 3/8 for the extrapolation.
  for (const int per_period : {250, 500, 1000}) {
    const auto g = transfer(ZpetcParams{}, per_period, 5e-3, 0);
    const double step = 2.0 * kPi / per_period;
    const double w = step / 5e-3;
    const double bound = step * step * w * w / 1600.0;
    EXPECT_LT(std::abs(g - std::pow(std::cos(0.5 * step), 2)), bound) << per_period;
    EXPECT_GT(std::abs(g - std::pow(std::cos(0.5 * step), 2)), 0.1 * bound) << per_period;
  }
}

// Everything that is fed forward belongs to the same place of the delayed motion.
TEST(Zpetc, DelayedTheFrictionBeginsWithTheMotion) {
  constexpr double kPeriod = 1e-3;
  ZpetcParams params;
  params.preview = Preview::kDelayed;
  auto setup = test::masses<1>(kPeriod);
  setup.compensation[0].feedforward = Feedforward::kDynamic;
  setup.compensation[0].model.friction.steady = friction::Conventional<double>{50.0, 0.0, {}};
  setup.compensation[0].model.friction.dynamics = friction::LuGre<double>{1e9, 0.0, {}};
  const Zpetc<1> law(params, setup);
  Zpetc<1>::State s;
  path::PathPoint<1> r;
  for (int k = 0; k < 6; ++k) {
    const double t = k > 2 ? (k - 2) * kPeriod : 0.0;
    r.acceleration = {{k >= 2 ? 1.0 : 0.0}};
    r.velocity = {{t}};
    r.position = {{0.5 * t * t}};
    law.step(s, r, {{0.0}});
    if (k < 4) {
      EXPECT_EQ(s.compensation[0].friction, 0.0) << k;
    }
  }
  EXPECT_GT(s.compensation[0].friction, 10.0);
}

TEST(Zpetc, TakesAwayThePhaseThatFeedforwardOfTheAccelerationLeaves) {
  // r'' held over the sample is half a sample late: phase (wT/2)·w²/k_p, here 0.4 mrad at 6.3 rad/s.
  const auto plain = transfer(ContouringParams::critical(40.0, 40.0), 200, 5e-3, 0);
  const auto zero = transfer(ZpetcParams::critical(40.0), 200, 5e-3, 0);
  EXPECT_NEAR(std::abs(std::arg(plain)), 0.4e-3, 0.05e-3);
  EXPECT_LT(std::abs(std::arg(zero)), 0.05 * std::abs(std::arg(plain)));
}

TEST(Zpetc, AnswersADisturbanceAsItsDoublePoleSays) {
  constexpr double kPeriod = 1e-5;
  test::Disturbed<ZpetcParams> loop(ZpetcParams::critical(40.0), kPeriod, 100.0);
  for (int k = 1; k <= 30; ++k) {
    const double t = 0.01 * k;
    const double e = 100.0 / test::kMass / 1600.0 * (1.0 - (1.0 + 40.0 * t) * std::exp(-40.0 * t));
    EXPECT_NEAR(loop.error_after(1000), -e, 1e-3 * 100.0 / test::kMass / 1600.0) << t;
  }
}

TEST(Zpetc, BeginsAsIfTheMotionHadAlwaysHadItsFirstAcceleration) {
  for (const auto preview : {Preview::kExtrapolated, Preview::kDelayed}) {
    ZpetcParams p;
    p.preview = preview;
    const Zpetc<1> law(p, test::masses<1>(1e-3));
    Zpetc<1>::State long_ago;
    Zpetc<1>::State now;
    for (int k = -9; k < 3; ++k) {
      const double t = 1e-3 * k;
      path::PathPoint<1> r;
      r.position = {{0.1 + 0.02 * t + 0.5 * 3.0 * t * t}};
      r.velocity = {{0.02 + 3.0 * t}};
      r.acceleration = {{3.0}};
      // The axis is where the law wants it, so that no error of the sample before is missed: two periods behind where the law waits
      // for the samples to come, and in both cases a quarter of aT² ahead, by the mean over neighbours.
      const double behind = preview == Preview::kDelayed ? 2e-3 * (0.02 + 3.0 * t) - 6e-6 : 0.0;
      const Vec<double, 1> x{{r.position[0] - behind + 0.75e-6}};
      const double force = law.step(long_ago, r, x)[0];
      if (k < 0) continue;
      // Sums of 0.1 m over squares of 1 ms
      EXPECT_NEAR(law.step(now, r, x)[0], force, 1e-6) << k;
    }
  }
}

TEST(Zpetc, StandsStillWhereThePathDoes) {
  for (const auto preview : {Preview::kExtrapolated, Preview::kDelayed}) {
    ZpetcParams p;
    p.preview = preview;
    const Zpetc<1> law(p, test::masses<1>(1e-3));
    Zpetc<1>::State s;
    path::PathPoint<1> r;
    r.position = {{0.123}};
    for (int k = 0; k < 5; ++k) EXPECT_EQ(law.step(s, r, r.position)[0], 0.0);
  }
}

TEST(Zpetc, StabilityIsThatOfItsHeaderAndOfTheLoop) {
  // k_p T < 2k_v(2 − k_v T)/(2 + k_v T); for a double pole w T < (√41 − 5)/2.
  const double border = 0.5 * (std::sqrt(41.0) - 5.0) / 5e-3;
  EXPECT_TRUE(ZpetcParams::critical(0.999 * border).stable(5e-3));
  EXPECT_FALSE(ZpetcParams::critical(1.001 * border).stable(5e-3));
  EXPECT_TRUE(test::dies_out(ZpetcParams::critical(0.99 * border), 5e-3));
  EXPECT_FALSE(test::dies_out(ZpetcParams::critical(1.01 * border), 5e-3));
  for (const double period : {1e-3, 5e-3}) EXPECT_TRUE(ZpetcParams{}.stable(period));
  EXPECT_TRUE(ZpetcParams::critical(0.5).stable(1e-3)) << "no integral part that a slow loop could not bear";
}

TEST(Zpetc, KeepsWhatEveryLawKeeps) {
  ZpetcParams delayed;
  delayed.preview = Preview::kDelayed;
  for (const auto& p : {ZpetcParams{}, delayed}) {
    test::expect_nan_answered(p);
    test::expect_limits_kept(p);
    test::expect_mirrored(p);
  }
  for (const double period : {1e-3, 5e-3})
    EXPECT_LT(test::worst_error_under_known_friction(ZpetcParams{}, period), 1e-12);
}

TEST(Zpetc, WhetherItIsStableDoesNotDependOnTheUnitOfTime) {
  for (const double second : {1.0, 1e3, 1.0 / 3600.0}) {
    for (const double share : {0.999, 1.001}) {
      // A double pole is stable up to ω·T = 0.7 (sampled_loop.hpp): the border itself is searched in seconds.
      double below = 100.0;
      double above = 200.0;
      for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (below + above);
        (ZpetcParams::critical(middle).stable(5e-3) ? below : above) = middle;
      }
      EXPECT_EQ(ZpetcParams::critical(share * below / second).stable(5e-3 * second), share < 1.0) << second;
    }
  }
  for (const std::size_t axis : {0, 2}) {
    ZpetcParams p;
    p.kp = {1600.0, 1600.0, 1600.0};
    p.kp[axis] = -1.0;
    EXPECT_FALSE(p.stable(1e-3)) << axis;
    p = {};
    p.kv = {80.0, 80.0, 80.0};
    p.kv[axis] = 0.0;
    EXPECT_FALSE(p.stable(1e-3)) << axis;
  }
}

}  // namespace
}  // namespace stribeck::control::zpetc_test
