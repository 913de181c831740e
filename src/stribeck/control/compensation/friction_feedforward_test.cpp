#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/control/test_axes.hpp>
#include <utility>
#include <vector>

namespace stribeck::control {
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
  // is bent by exactly that distance, and after the way back along the other branch by nothing that depends on the steps.
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

TEST(Compensation, AJerkGoesOnAndAStepOfAccelerationDoesNot) {
  // The force that accelerates: over the coming period the mean of m·r̈, which is m·(a + j·T/2) for a jerk that lasts, and m·a after
  // a step.
  CompensationParams p;
  p.model.mass = 250.0;
  p.model.friction = constant_level(1000.0, 3e8);
  p.feedforward = Feedforward::kDynamic;
  const Compensation law(p, kPeriod);
  StatusCounter status;
  struct Sample {
    double velocity, acceleration;
  };
  const auto of = [&](std::initializer_list<Sample> samples) {
    Compensation::State s;
    for (const Sample& r : samples) law.step(s, 0.0, r.velocity, r.acceleration, status);
    return s.inertia_force;
  };
  constexpr double kStep = 2.0 * kPeriod;  // of velocity, under 2 m/s²
  EXPECT_DOUBLE_EQ(of({{0.0, 0.0}, {0.0, 0.0}, {0.0, 2.0}}), 500.0);
  EXPECT_NEAR(of({{0.0, 0.0}, {0.0, 2.0}, {kStep, 2.0}}), 500.0, 1e-9);
  EXPECT_NEAR(of({{0.0, 2.0}, {kStep, -2.0}}), -500.0, 1e-9);
  EXPECT_NEAR(of({{0.0, 0.0}, {0.5 * kStep, 2.0}}), 250.0 * 3.0, 1e-9);
  EXPECT_NEAR(of({{0.0, 2.0}, {0.75 * kStep, 1.0}}), 250.0 * 0.5, 1e-9);
  // Velocities that do not fit ask for nothing beyond the change of the acceleration.
  EXPECT_NEAR(of({{0.0, 0.0}, {1.0, 2.0}}), 250.0 * 3.0, 1e-9);
  EXPECT_NEAR(of({{0.0, 0.0}, {-1.0, 2.0}}), 500.0, 1e-9);
}

TEST(FrictionFeedforward, BeginsDeflectedInMotion) {
  const FrictionFeedforward law(constant_level(1000.0, 3e8), kPeriod);
  FrictionFeedforward::State moving;
  EXPECT_NEAR(law.step(moving, {0.0, -4e-3, 0.0, 0.0}).sum(), -1000.0, 1e-9);
  FrictionFeedforward::State resting;
  EXPECT_LT(law.step(resting, {0.0, 0.0, 4e-3, 0.0}).sum(), 100.0);
}

/// A mass with LuGre friction under PD at rest or in motion, as exact as small steps make it.
class Axis {
 public:
  Axis(double level, double sigma0, double mass) : mass_(mass) {
    map_ = friction::Conventional<double>{level, 2e4, {}};
    law_ = friction::LuGre<double>{sigma0, std::sqrt(sigma0 * mass), 1e-4};
  }
  void move(double force) {
    constexpr int kParts = 50;
    const double dt = kPeriod / kParts;
    for (int i = 0; i < kParts; ++i) {
      const double f = law_.step(map_, bristle_, v, x, dt);
      v += dt * (force - f) / mass_;
      x += dt * v;
    }
  }
  double x = 0.0;
  double v = 0.0;

 private:
  double mass_;
  friction::Conventional<double> map_;
  friction::LuGre<double> law_;
  friction::LuGre<double>::State bristle_;
};

CompensationParams whole(double level, double sigma0) {
  CompensationParams p;
  p.model.mass = 5e4;
  p.model.friction.steady = friction::Conventional<double>{level, 2e4, {}};
  p.model.friction.dynamics = friction::LuGre<double>{sigma0, std::sqrt(sigma0 * 5e4), 1e-4};
  p.feedforward = Feedforward::kDynamic;
  p.observer = Observer::kDisturbance;
  p.encoder_resolution = 1e-9;
  return p;
}

struct Followed {
  double worst = 0.0;  ///< tracking error of the last quarter [m]
  Compensation::State state;
};

/// 10 mm at 1 rad/s for so many seconds, PD at 40 rad/s. The mass, level and stiffness are the axis's; noise acts on it [N].
Followed follow(
    const CompensationParams& params, double level, double sigma0, double mass, int late, double seconds,
    const std::function<double()>& noise = [] { return 0.0; }) {
  Setup<1> setup;
  setup.period = kPeriod;
  setup.compensation[0] = params;
  const Contouring<1> law(ContouringParams::critical(40.0, 40.0), setup);
  Contouring<1>::State s;
  Axis axis(level, sigma0, mass);
  std::vector<double> commanded(static_cast<std::size_t>(late) + 1, 0.0);
  Followed result;
  const int steps = static_cast<int>(seconds / kPeriod);
  for (int k = 0; k < steps; ++k) {
    // Starts at rest with no jump in velocity or acceleration worth speaking of.
    const double t = k * kPeriod;
    path::PathPoint<1> r;
    const double ramp = t < 1.0 ? 0.5 - 0.5 * std::cos(kPi * t) : 1.0;
    const double ramp1 = t < 1.0 ? 0.5 * kPi * std::sin(kPi * t) : 0.0;
    const double ramp2 = t < 1.0 ? 0.5 * kPi * kPi * std::cos(kPi * t) : 0.0;
    r.position = {{1e-2 * ramp * std::sin(t)}};
    r.velocity = {{1e-2 * (ramp1 * std::sin(t) + ramp * std::cos(t))}};
    r.acceleration = {{1e-2 * (ramp2 * std::sin(t) + 2.0 * ramp1 * std::cos(t) - ramp * std::sin(t))}};
    if (k > 3 * steps / 4) result.worst = std::max(result.worst, std::abs(axis.x - r.position[0]));
    commanded.insert(commanded.begin(), law.step(s, r, {{axis.x}})[0]);
    commanded.pop_back();
    axis.move(commanded.back() + noise());
  }
  result.state = s.compensation[0];
  return result;
}

TEST(DynamicCompensation, LeavesAHundredthOfWhatTheSteadyMapLeaves) {
  const CompensationParams dynamic = whole(1000.0, 3e8);
  CompensationParams steady = dynamic;
  steady.feedforward = Feedforward::kSteady;
  const double with_map = follow(steady, 1000.0, 3e8, 5e4, 0, 10.0).worst;
  EXPECT_GT(with_map, 3e-6);
  EXPECT_LT(follow(dynamic, 1000.0, 3e8, 5e4, 0, 10.0).worst, 0.01 * with_map);
}

TEST(DynamicCompensation, AKnownDelayCostsLittle) {
  CompensationParams p = whole(1000.0, 3e8);
  const double unknown = follow(p, 1000.0, 3e8, 5e4, 1, 10.0).worst;
  p.delay = kPeriod;
  const double known = follow(p, 1000.0, 3e8, 5e4, 1, 10.0).worst;
  EXPECT_GT(unknown, 0.5e-6);
  EXPECT_LT(known, 0.1 * unknown);
}

TEST(DynamicCompensation, AtRestTheObserverHandsOverToTheBristle) {
  const Compensation c(whole(1000.0, 3e8), kPeriod);
  Compensation::State s;
  StatusCounter status;
  c.observe(s, 0.0, 0.0);
  double sum = c.step(s, 0.0, 0.0, 0.0, status);
  c.applied(s, sum, false, status);
  s.disturbance.disturbance = 600.0;
  s.estimate = 600.0;
  // What is added does not jump, and after a while all of it is in the bristle. The axis stands and holds the force.
  const auto& d = s.disturbance.disturbance;
  for (int k = 0; k < 400; ++k) {
    sum = c.step(s, 0.0, 0.0, 0.0, status);
    EXPECT_NEAR(sum, 600.0, 1e-6);
    c.applied(s, sum, false, status);
  }
  EXPECT_NEAR(s.friction, 600.0, 0.1);
  EXPECT_NEAR(d, 0.0, 0.1);
  // Never beyond the level of friction.
  s.estimate = s.disturbance.disturbance = 900.0;
  for (int k = 0; k < 400; ++k) c.step(s, 0.0, 0.0, 0.0, status);
  EXPECT_NEAR(s.friction, 1000.0, 1e-6);
}

TEST(DynamicCompensation, WhatTheGuardTookDoesNotComeBackThroughTheBristle) {
  const Compensation c(whole(1000.0, 3e8), kPeriod);
  Compensation::State s;
  StatusCounter status;
  c.applied(s, c.step(s, 0.0, 0.0, 0.0, status), false, status);
  s.guard.trust = 0.0;
  for (int k = 0; k < 2000; ++k) {
    s.estimate = s.disturbance.disturbance = 600.0;
    const double force = c.step(s, 0.0, 0.0, 0.0, status);
    ASSERT_EQ(force, 0.0);
    c.applied(s, force, false, status);
  }
}

CompensationParams adapting(double level, double sigma0) {
  CompensationParams p = whole(level, sigma0);
  p.adaptation.enabled = true;
  p.guarded = true;
  return p;
}

TEST(FrictionRls, FindsWhatTheModelIsOff) {
  using A = FrictionRls;
  // Level 30 % high, stiffness half, mass 20 % high, one period late, each of the axis.
  const auto level = follow(adapting(1000.0, 3e8), 1300.0, 3e8, 5e4, 0, 40.0).state.adaptation;
  EXPECT_NEAR(level.theta[A::kPositive], 0.3, 0.02);
  EXPECT_NEAR(level.theta[A::kNegative], 0.3, 0.02);
  EXPECT_NEAR(level.theta[A::kStiffness], 0.0, 0.1);
  const auto soft = follow(adapting(1000.0, 3e8), 1000.0, 1.5e8, 5e4, 0, 40.0).state.adaptation;
  EXPECT_NEAR(soft.theta[A::kPositive], 0.0, 0.02);
  EXPECT_NEAR(soft.theta[A::kStiffness], -0.5, 0.1);
  const auto heavy = follow(adapting(1000.0, 3e8), 1000.0, 3e8, 6e4, 0, 40.0).state.adaptation;
  EXPECT_NEAR(heavy.theta[A::kMass], 0.2, 0.03);
  const auto late = follow(adapting(1000.0, 3e8), 1000.0, 3e8, 5e4, 1, 40.0).state.adaptation;
  EXPECT_NEAR(late.theta[A::kDelay], 1.0, 0.2);
  EXPECT_NEAR(late.theta[A::kPositive], 0.0, 0.02);
}

TEST(FrictionRls, LeavesATrueModelAlone) {
  const auto s = follow(adapting(1000.0, 3e8), 1000.0, 3e8, 5e4, 0, 40.0).state.adaptation;
  for (std::size_t i = 0; i < FrictionRls::kCount; ++i)
    EXPECT_NEAR(s.theta[i], 0.0, std::max(0.03, s.deviation[i] / 3.0)) << i;
}

TEST(FrictionRls, AModelHalfAgainTooHighIsTakenDownAndNothingOscillates) {
  const double known = follow(whole(1000.0, 3e8), 1000.0, 3e8, 5e4, 0, 40.0).worst;
  const double fixed = follow(whole(1500.0, 3e8), 1000.0, 3e8, 5e4, 0, 40.0).worst;
  const auto adapted = follow(adapting(1500.0, 3e8), 1000.0, 3e8, 5e4, 0, 40.0);
  EXPECT_GT(fixed, 100.0 * known);
  EXPECT_LT(adapted.worst, 0.1 * fixed);
  EXPECT_EQ(adapted.state.guard.found, 0U);
  EXPECT_NEAR(adapted.state.adaptation.theta[FrictionRls::kPositive], -1.0 / 3.0, 0.02);
}

/// The same axis under noise of this standard deviation [N] and correlation time [s]; the model is the axis's.
FrictionRls::State disturbed(double noise, double correlation, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double a = correlation > 0.0 ? std::exp(-kPeriod / correlation) : 0.0;
  double n = noise * normal(random);
  return follow(adapting(1000.0, 3e8), 1000.0, 3e8, 5e4, 0, 20.0,
                [&] {
                  n = a * n + noise * std::sqrt(1.0 - a * a) * normal(random);
                  return n;
                })
      .state.adaptation;
}

TEST(FrictionRls, TakesNoNoiseForADelay) {
  // White from period to period, 19 % of the level. With the steps of θ left in what was fed forward it finds 1.0 to 1.5 periods.
  for (const unsigned seed : {1U, 2U, 3U}) {
    const auto s = disturbed(190.0, 0.0, seed);
    EXPECT_LT(std::abs(s.theta[FrictionRls::kDelay]), 0.6) << seed;
  }
}

TEST(FrictionRls, ItsBoundCoversTheTruthUnderAnyNoise) {
  // Level, viscous friction, stiffness and mass in five runs each: the root mean square over the bound is 1 for an honest bound;
  // with r as assumed it is 1.65 in the last.
  for (const auto& [noise, correlation] :
       {std::pair{20.0, 0.047}, std::pair{190.0, 0.0}, std::pair{190.0, 0.047}}) {
    double sum = 0.0;
    double bound = 0.0;
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const auto s = disturbed(noise, correlation, seed);
      for (std::size_t i = 0; i <= FrictionRls::kMass; ++i) sum += std::pow(s.theta[i] / s.deviation[i], 2);
      bound += s.deviation[FrictionRls::kPositive];
    }
    EXPECT_LT(std::sqrt(sum / 25.0), 1.2) << noise << ' ' << correlation;
    EXPECT_LT(bound / 5.0, 0.2) << noise << ' ' << correlation;
  }
}

TEST(FrictionRls, IsFrozenAtRestAndStaysWithinBounds) {
  const FrictionRls law(adapting(1000.0, 3e8).adaptation, adapting(1000.0, 3e8).model, 1e-9, 0.0, kPeriod);
  FrictionRls::State s;
  // Pushed at rest with more than friction would ever need: nothing is learned.
  for (int k = 0; k < 1000; ++k) law.step(s, 700.0, 0.0, 0.0, 0.0, 0.0, true);
  for (std::size_t i = 0; i < FrictionRls::kCount; ++i) EXPECT_EQ(s.theta[i], 0.0);
  // In motion with a force that no friction explains, estimates end at their bounds and stay finite.
  for (int k = 0; k < 20000; ++k) law.step(s, 1e5, 0.0, 4e-3 * kPeriod * k, 4e-3, 0.0, true);
  EXPECT_LE(s.theta[FrictionRls::kPositive], 1.0);
  EXPECT_GE(s.theta[FrictionRls::kPositive], 0.5);
  for (std::size_t i = 0; i < FrictionRls::kCount; ++i) {
    EXPECT_TRUE(std::isfinite(s.theta[i]));
    EXPECT_GE(s.deviation[i], 0.0);
    EXPECT_LE(s.deviation[i], 0.51);
  }
}

TEST(FrictionRls, AStartFromABentBristleTeachesNothing) {
  // The axis has come to rest from the other side: the bristle is bent against the motion that follows, by three quarters of the
  // level. The model is the axis's, but for knowing that.
  constexpr double kMass = 5e4;
  Axis axis(1000.0, 3e8, kMass);
  control::Setup<1> setup;
  setup.period = kPeriod;
  setup.compensation[0] = adapting(1000.0, 3e8);
  const Contouring<1> law(ContouringParams::critical(40.0, 40.0), setup);
  Contouring<1>::State s;
  for (int k = 0; k < 20; ++k) axis.move(-750.0);
  path::PathPoint<1> r;
  r.position[0] = axis.x;
  const double begin = axis.x;
  double worst = 0.0;
  double error = 0.0;
  for (int k = 0; k < 600; ++k) {
    const double t = (k - 300) * kPeriod;
    if (t > 0.0) {
      r.position[0] = begin + 0.5e-2 * t * t;
      r.velocity[0] = 1e-2 * t;
      r.acceleration[0] = 1e-2;
    }
    if (t > 0.0) error = std::max(error, std::abs(axis.x - r.position[0]));
    axis.move(law.step(s, r, {{axis.x}})[0]);
    for (std::size_t i = 0; i < FrictionRls::kCount; ++i)
      worst = std::max(worst, std::abs(s.compensation[0].adaptation.theta[i]));
  }
  EXPECT_LT(worst, 0.05);
  EXPECT_LT(error, 1e-6);
}

TEST(KalmanObserver, AnswerIsItsOwnLag) {
  const double mass = 50.0;
  const KalmanObserver o(KalmanObserver::density(60.0, 1e-7, mass), 1e-14 / 12.0, mass, 1e-3);
  KalmanObserver::State s;
  test::Mass axis;
  Vec<double, 3> error{};
  o.step(s, 0.0, 0.0);
  for (int k = 0; k < 300; ++k) {
    const double d = 10.0 * std::sin(0.03 * k);
    axis.move(-d, 1e-3, mass);
    EXPECT_NEAR(o.step(s, 0.0, axis.x), o.answer(error, d), 1e-9);
  }
  // Two thirds of a step are reached within half to three times 1/ω.
  error = {};
  int k = 0;
  while (o.answer(error, 1.0) < 0.63) ++k;
  EXPECT_GT(k, 1000 * 0.5 / 60.0);
  EXPECT_LT(k, 1000 * 3.0 / 60.0);
}

/// Steps a guard with amplitude·sin(2π·frequency·t) for so many seconds; how often it found something.
std::uint32_t found(double amplitude, double frequency, double seconds, double reversal_every = 0.0) {
  const OscillationGuard guard(100.0, 1e-3);
  OscillationGuard::State s;
  for (int k = 0; k < seconds * 1e3; ++k) {
    const double t = k * 1e-3;
    const double v =
        reversal_every > 0.0 && std::fmod(t, 2.0 * reversal_every) >= reversal_every ? -1e-3 : 1e-3;
    guard.step(s, amplitude * std::sin(2.0 * kPi * frequency * t), v);
  }
  return s.found;
}

TEST(DriftMonitor, SaysWhatChangedOnceItIsSure) {
  using A = FrictionRls;
  const auto verdict = [](std::initializer_list<std::pair<std::size_t, double>> theta, double deviation) {
    A::State a;
    a.informed = true;
    for (const auto& [i, value] : theta) a.theta[i] = value;
    for (std::size_t i = 0; i < A::kCount; ++i) {
      a.deviation[i] = deviation;
      a.p[i][i] = deviation * deviation;
    }
    return DriftMonitor::report({}, a, kPeriod).verdict;
  };
  EXPECT_EQ(verdict({}, 0.03), DriftVerdict::kAsCommissioned);
  EXPECT_EQ(verdict({{A::kPositive, 0.3}, {A::kNegative, 0.3}}, 0.2), DriftVerdict::kNotYet);
  EXPECT_EQ(verdict({{A::kPositive, 0.3}, {A::kNegative, 0.3}}, 0.03), DriftVerdict::kMuchMore);
  EXPECT_EQ(verdict({{A::kPositive, 0.3}, {A::kNegative, -0.1}}, 0.03), DriftVerdict::kAsCommissioned);
  EXPECT_EQ(verdict({{A::kPositive, -0.2}, {A::kNegative, -0.1}}, 0.03), DriftVerdict::kLess);
  // Within two standard deviations of the level, 0.11/√2 each, nothing has changed.
  EXPECT_EQ(verdict({{A::kPositive, -0.13}, {A::kNegative, -0.13}}, 0.11), DriftVerdict::kAsCommissioned);
  EXPECT_EQ(verdict({{A::kPositive, -0.17}, {A::kNegative, -0.17}}, 0.11), DriftVerdict::kLess);
  EXPECT_EQ(verdict({{A::kPositive, 0.13}, {A::kNegative, 0.13}}, 0.11), DriftVerdict::kAsCommissioned);
  EXPECT_EQ(verdict({{A::kViscous, 0.3}}, 0.03), DriftVerdict::kMoreViscous);
  EXPECT_EQ(verdict({{A::kViscous, -0.3}}, 0.03), DriftVerdict::kLessViscous);
  EXPECT_EQ(verdict({{A::kViscous, -0.3}}, 0.11), DriftVerdict::kAsCommissioned);
  EXPECT_EQ(verdict({{A::kMass, 0.2}}, 0.03), DriftVerdict::kAnotherMass);
  EXPECT_EQ(verdict({{A::kDelay, 1.5}, {A::kMass, 0.2}}, 0.03), DriftVerdict::kAnotherDelay);
  EXPECT_EQ(verdict({{A::kDelay, 0.9}}, 0.03), DriftVerdict::kAsCommissioned);
  // The level goes first: what is wrong there is in all of it.
  EXPECT_EQ(verdict({{A::kViscous, 0.3}, {A::kPositive, 0.12}, {A::kNegative, 0.12}}, 0.03),
            DriftVerdict::kMore);
}

TEST(OscillationGuard, CountsSwings) {
  // Nine turns at 10 Hz take half a second.
  EXPECT_EQ(found(100.0, 10.0, 0.40), 0U);
  EXPECT_EQ(found(100.0, 10.0, 0.60), 1U);
  EXPECT_EQ(found(40.0, 10.0, 10.0), 0U);       // swings of 80 N are below the threshold
  EXPECT_EQ(found(100.0, 0.5, 60.0), 0U);       // too slow
  EXPECT_EQ(found(100.0, 500.0, 10.0), 0U);     // the encoder's rattle
  EXPECT_EQ(found(100.0, 2.0, 60.0, 0.5), 0U);  // swings that reversals make
}

TEST(OscillationGuard, HalvesTrustAndKeepsItDown) {
  const OscillationGuard guard(100.0, 1e-3);
  OscillationGuard::State s;
  std::vector<double> trust;
  for (int k = 0; k < 6000; ++k) {
    if (guard.step(s, 200.0 * std::sin(2.0 * kPi * 10.0 * k * 1e-3), 1e-3)) trust.push_back(s.trust);
  }
  ASSERT_GE(trust.size(), 5U);
  EXPECT_EQ((std::vector<double>{trust.begin(), trust.begin() + 5}),
            (std::vector<double>{0.5, 0.25, 0.125, 0.0, 0.0}));
  for (int k = 0; k < 10000; ++k) guard.step(s, 0.0, 1e-3);
  EXPECT_EQ(s.trust, 0.0);
}

}  // namespace
}  // namespace stribeck::control
