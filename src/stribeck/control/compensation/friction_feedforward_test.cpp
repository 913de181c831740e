#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stribeck/control/compensation/friction_feedforward.hpp>
#include <utility>
#include <vector>

namespace stribeck::control::friction_feedforward_test {
namespace {

constexpr double kPeriod = 5e-3;

friction::Model constant_level(double level, double sigma0, double sigma1 = 0.0) {
  friction::Model m;
  m.steady = friction::Conventional<double>{level, 0.0, {}};
  m.dynamics = friction::LuGre<double>{sigma0, sigma1, {}};
  return m;
}

/// The motion of constant acceleration that turns at t = 0, from the sample at t on.
MotionAhead turning(double acceleration, double t) {
  return {0.5 * acceleration * t * t, acceleration * t, acceleration, 0.0};
}

/// Forces of the bristle around a turn, from 60 periods before it on.
std::vector<double> around_a_turn(const friction::Model& model, const FrictionScales& scales,
                                  double acceleration, double shift = 0.0) {
  const FrictionFeedforward law(model, kPeriod);
  FrictionFeedforward::State s;
  std::vector<double> all;
  for (int k = -60; k < 40; ++k) {
    const MotionAhead r = turning(acceleration, k * kPeriod + shift);
    all.push_back(law.step(s, r, 0.0, scales).bristle);
  }
  return all;
}

TEST(FrictionFeedforward, BuildsUpOverDistanceAsTheClosedForm) {
  // From full deflection against it, LuGre at constant level turns as g·(1 − 2·exp(−σ0·s/g)) over the distance s.
  constexpr double kLevel = 1000.0;
  constexpr double kSigma = 3e8;
  constexpr double kAcceleration = 9e-3;
  const auto got = around_a_turn(constant_level(kLevel, kSigma), {}, kAcceleration);
  for (int k = -60; k < 40; ++k) {
    double mean = 0.0;
    constexpr int kParts = 1000;
    for (int i = 0; i < kParts; ++i) {
      const double t = (k + (i + 0.5) / kParts) * kPeriod;
      const double s = 0.5 * kAcceleration * t * t;
      mean += (t < 0.0 ? -kLevel : kLevel * (1.0 - 2.0 * std::exp(-kSigma * s / kLevel))) / kParts;
    }
    // Two sub-steps for each hold leave 0.3 % of the level where the force changes by 15 % in a period.
    EXPECT_NEAR(got[static_cast<std::size_t>(k + 60)], mean, 4.0) << k;
  }
}

TEST(FrictionFeedforward, AgreesWithTheFrictionModelInSmallSteps) {
  // Another integration: LuGre's own step, 200 to a period, with a map that is no constant and damping that fades.
  friction::Model m;
  m.steady = friction::Conventional<double>{800.0, 1e5, friction::Stribeck<double>{1200.0, 1e-3, 2.0}};
  const friction::LuGre<double> lugre{3e8, 6e5, 0.05e-3};
  m.dynamics = lugre;
  const FrictionFeedforward law(m, kPeriod);
  FrictionFeedforward::State s;
  friction::LuGre<double>::State exact;
  const auto& map = std::get<friction::Conventional<double>>(m.steady);
  for (int k = 0; k < 400; ++k) {
    // 2 mm at 0.5 Hz: 6 mm/s, and through two reversals
    const auto at = [](double t) { return 2e-3 * std::sin(kPi * t); };
    const auto rate = [](double t) { return 2e-3 * kPi * std::cos(kPi * t); };
    const double t = k * kPeriod;
    const MotionAhead r{at(t), rate(t), -kPi * kPi * at(t), -kPi * kPi * rate(t)};
    if (k == 0) exact.z = map.parts(rate(0.0), 0.0).level / lugre.sigma0;
    double mean = 0.0;
    for (int i = 0; i < 200; ++i)
      mean += lugre.step(map, exact, rate(t + (i + 0.5) * kPeriod / 200), 0.0, kPeriod / 200) / 200;
    EXPECT_NEAR(law.step(s, r).sum(), mean, 15.0) << k;  // 1.2 % of the level at rest
  }
}

TEST(FrictionFeedforward, StaticModelGivesTheMeanOfAHoldThatReverses) {
  friction::Model m;
  m.steady = friction::Conventional<double>{1000.0, 2e5, {}};
  const FrictionFeedforward law(m, kPeriod);
  FrictionFeedforward::State s;
  EXPECT_EQ(law.step(s, {0.0, 3e-3, 0.0, 0.0}).sum(), 1000.0 + 2e5 * 3e-3);
  // Turns in the middle of the hold.
  const double a = 0.04;
  const auto f = law.step(s, {0.0, -0.5 * a * kPeriod, a, 0.0});
  EXPECT_EQ(f.bristle, 0.0);
  EXPECT_NEAR(f.viscous, 0.0, 1e-12);
}

TEST(FrictionFeedforward, MirroredMotionGivesMirroredForce) {
  const auto m = constant_level(1000.0, 3e8, 6e5);
  const auto up = around_a_turn(m, {}, 9e-3);
  const auto down = around_a_turn(m, {}, -9e-3);
  for (std::size_t k = 0; k < up.size(); ++k) EXPECT_EQ(up[k], -down[k]);
}

TEST(FrictionFeedforward, ScalesAreAnotherModel) {
  // ρ times the stiffness and ψ times the level are a LuGre, and a GMS, with those parameters.
  const auto scaled = around_a_turn(constant_level(1000.0, 3e8), {1.25, 1.25, 1.0, 0.6}, 9e-3);
  const auto other = around_a_turn(constant_level(1250.0, 1.8e8), {}, 9e-3);
  for (std::size_t k = 0; k < scaled.size(); ++k) EXPECT_NEAR(scaled[k], other[k], 1e-6);

  const auto gms = [](double level, double stiffness) {
    friction::Model m;
    m.steady = friction::Conventional<double>{level, 0.0, {}};
    friction::Gms<double> law;
    law.attraction = 1e6;
    for (int i = 0; i < 4; ++i) law.elements.push_back({stiffness / (1 << i), 0.25});
    m.dynamics = law;
    return m;
  };
  const auto scaled_gms = around_a_turn(gms(1000.0, 2e8), {1.0, 1.0, 1.0, 0.6}, 9e-3);
  const auto other_gms = around_a_turn(gms(1000.0, 1.2e8), {}, 9e-3);
  for (std::size_t k = 0; k < scaled_gms.size(); ++k) EXPECT_NEAR(scaled_gms[k], other_gms[k], 1e-6);
}

TEST(FrictionFeedforward, HoldsInDwellAndGoesOnAfterIt) {
  const auto m = constant_level(1000.0, 3e8);
  const FrictionFeedforward law(m, kPeriod);
  FrictionFeedforward::State s;
  // 1 µm forward from rest, then dwell: the bristle keeps what it has got.
  const double v = 1e-6 / (10 * kPeriod);
  double force = law.step(s, {}).sum();
  for (int k = 0; k < 10; ++k) force = law.step(s, {k * v * kPeriod, v, 0.0, 0.0}).sum();
  EXPECT_NEAR(force, 1000.0 * (1.0 - std::exp(-3e8 * 0.95e-6 / 1000.0)), 1.0);
  const double end = 1000.0 * (1.0 - std::exp(-0.3));
  for (int k = 0; k < 100; ++k) EXPECT_NEAR(law.step(s, {1e-6, 0.0, 0.0, 0.0}).sum(), end, 1e-6);
  // A partial reversal of half a micrometre: Masing's rule.
  for (int k = 0; k < 10; ++k) force = law.step(s, {1e-6 - 0.5 * k * v * kPeriod, -0.5 * v, 0.0, 0.0}).sum();
  const double back = 3e8 * 0.475e-6 / 1000.0;
  EXPECT_NEAR(force, end * std::exp(-back) - 1000.0 * (1.0 - std::exp(-back)), 1.0);
}

TEST(FrictionFeedforward, StepsOfAccelerationLeaveNoTrace) {
  // 2 µm in four periods at ±0.5 m/s², as a trapezoidal planner moves: no hold foresees the step that ends it. At rest the bristle
  // is bent by exactly that distance, and after the return along the other branch by nothing that depends on the steps.
  constexpr double kFast = 1e-3;
  constexpr double kAcceleration = 0.5;
  constexpr double kLevel = 1000.0;
  constexpr double kSigma = 3e8;
  const FrictionFeedforward law(constant_level(kLevel, kSigma), kFast);
  for (const double delay : {0.0, 0.4e-3, 1e-3, 2.5e-3}) {
    SCOPED_TRACE(delay);
    FrictionFeedforward::State s;
    double x = 0.0;
    double v = 0.0;
    double last = 0.0;
    double force = 0.0;
    const auto move = [&](double a) {
      force = law.step(s, {x, v, a, (a - last) / kFast}, delay).sum();
      last = a;
      x += kFast * (v + 0.5 * kFast * a);
      v += kFast * a;
    };
    const auto there = [&](double direction) {
      for (const double share : {0.0, 1.0, 1.0, -1.0, -1.0}) move(direction * share * kAcceleration);
      v = 0.0;  // exactly
      for (int k = 0; k < 4; ++k) move(0.0);
    };
    there(1.0);
    const double bent = kLevel * (1.0 - std::exp(-kSigma * 2e-6 / kLevel));
    EXPECT_NEAR(force, bent, 1e-6);
    there(-1.0);
    const double back = std::exp(-kSigma * 2e-6 / kLevel);
    EXPECT_NEAR(force, bent * back - kLevel * (1.0 - back), 1e-6);
  }
}

TEST(FrictionFeedforward, BeginsDeflectedInMotion) {
  const FrictionFeedforward law(constant_level(1000.0, 3e8), kPeriod);
  FrictionFeedforward::State moving;
  EXPECT_NEAR(law.step(moving, {0.0, -4e-3, 0.0, 0.0}).sum(), -1000.0, 1e-9);
  FrictionFeedforward::State resting;
  EXPECT_LT(law.step(resting, {0.0, 0.0, 4e-3, 0.0}).sum(), 100.0);
}

TEST(FrictionFeedforward, EachSetOfScalesHasItsOwnForce) {
  friction::Model model;
  model.steady = friction::Conventional<double>{100.0, 500.0, {}};
  model.dynamics = friction::LuGre<double>{1e7, 0.0, {}};
  const FrictionFeedforward law(model, 1e-3);
  std::array<FrictionFeedforward::Bristle, 4> bristles;
  std::array<FrictionScales, 4> scales;
  scales[1].viscous = 2.0;
  scales[2].positive = 1.5;
  scales[3].negative = 1.5;
  bool started = false;
  std::array<FrictionFeedforward::Force, 4> f;
  for (int k = 0; k < 300; ++k)
    f = law.follow(bristles.data(), scales.data(), 4, started, 20e-6, 20e-3, 20e-6 * k);
  EXPECT_NEAR(f[0].sum(), 100.0 + 10.0, 1e-9);
  EXPECT_NEAR(f[1].sum(), 100.0 + 20.0, 1e-9);
  EXPECT_NEAR(f[2].sum(), 150.0 + 10.0, 1e-9);
  EXPECT_NEAR(f[3].sum(), 100.0 + 10.0, 1e-9);
}

}  // namespace
}  // namespace stribeck::control::friction_feedforward_test
