#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <set>
#include <stribeck/control/compensation/test_followed.hpp>
#include <stribeck/core/test_fields.hpp>
#include <string>

namespace stribeck::control::compensation_test {
namespace {

using namespace test;

constexpr double kPeriod = kFollowPeriod;

TEST(Compensation, AJerkGoesOnAndAStepOfAccelerationDoesNot) {
  // The force that accelerates: over the coming period the mean of m·r̈, which is m·(a + j·T/2) for a jerk that lasts, and m·a after
  // a step.
  CompensationParams p;
  p.model.mass = 250.0;
  p.model.friction.steady = friction::Conventional<double>{1000.0, 0.0, {}};
  p.model.friction.dynamics = friction::LuGre<double>{3e8, 0.0, {}};
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

// An axis that the controller takes over while it moves, without friction and on its reference: the observers began at rest, and m·v
// became a force of 700 to 2600 N.
TEST(Compensation, BegunInMotionTheObserversAddNothing) {
  for (const Observer observer : {Observer::kDisturbance, Observer::kKalman, Observer::kAdaptive}) {
    CompensationParams p;
    p.model.mass = 1000.0;
    p.observer = observer;
    p.observer_pole = 50.0;
    p.adaptive_gain = 20.0;
    const Compensation law(p, kPeriod);
    Compensation::State s;
    StatusCounter status;
    double most = 0.0;
    constexpr double kSpeed = 0.1;
    for (int k = 0; k < 500; ++k) {
      const double x = kSpeed * kPeriod * k;
      law.observe(s, x, k > 0 ? kSpeed : 0.0);  // differenced
      const double force = law.step(s, x, kSpeed, 0.0, status);
      law.applied(s, force, false, status);
      most = std::max(most, std::abs(force));
    }
    EXPECT_LT(most, 1e-6) << static_cast<int>(observer);
  }
}

// A period without a step: the force and what was fed forward in it stay, the reference goes on, and nothing of it comes from adaptation.
TEST(Compensation, OverAPeriodThatPassesTheForceStaysAndTheReferenceGoesOn) {
  CompensationParams p = whole(1000.0, 3e8);
  p.adaptation.enabled = true;
  p.model.delay = 2.0 * kPeriod;
  const Compensation law(p, kPeriod);
  Compensation::State s;
  StatusCounter status;
  law.observe(s, 0.0, 0.0);
  law.applied(s, law.step(s, 0.0, 0.0, 0.0, status), false, status);
  law.observe(s, 0.0, 0.0);
  law.step(s, 0.0, 0.0, 0.0, status);
  law.applied(s, 700.0, false, status);
  s.friction = 300.0;
  s.last_velocity = 0.1;
  s.last_acceleration = 0.25 / kPeriod;
  s.last_jerk = 5.0;
  law.applied(s, 800.0, false, status);
  s.change_by_theta_history[0] = 7.0;
  law.pass(s);
  EXPECT_EQ(s.force[0], 800.0);
  EXPECT_EQ(s.force[1], 800.0);
  EXPECT_EQ(s.force[2], 700.0);
  EXPECT_EQ(s.feedforward_history[0], 300.0);
  EXPECT_EQ(s.feedforward_history[1], 300.0);
  EXPECT_EQ(s.change_by_theta_history[0], 0.0);
  EXPECT_EQ(s.change_by_theta_history[1], 7.0);
  EXPECT_NEAR(s.last_velocity, 0.35, 1e-12);
  EXPECT_EQ(s.last_jerk, 0.0);
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
  p.model.delay = kPeriod;
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

/// Commands a force that swings at 10 Hz, until the guard has found `oscillations`.
void swing(const Compensation& c, Compensation::State& s, std::uint32_t oscillations, StatusCounter& status) {
  for (int k = 0; k < 10000 && s.guard.found < oscillations; ++k) {
    c.observe(s, 0.0, 0.0);
    const double friction = c.step(s, 0.0, 1e-3, 0.0, status);
    c.applied(s, friction + 800.0 * std::sin(2.0 * kPi * 10.0 * kPeriod * k), false, status);
  }
}

TEST(DynamicCompensation, AnOscillationTakesTheKalmanObserverFirstAndItsEstimateLater) {
  CompensationParams params = whole(1000.0, 3e8);
  params.observer = Observer::kKalman;
  params.observer_pole = 60.0;
  params.guarded = true;
  params.adaptation.enabled = true;
  const Compensation c(params, kPeriod);
  Compensation::State s;
  StatusCounter status;
  EXPECT_TRUE(c.observes_velocity(s));
  s.adaptation.theta[FrictionRls::kPositive] = 0.3;
  swing(c, s, 1, status);
  ASSERT_EQ(s.guard.found, 1U);
  EXPECT_TRUE(s.slower);
  EXPECT_FALSE(c.observes_velocity(s));
  EXPECT_EQ(s.guard.trust, 1.0);
  EXPECT_EQ(s.adaptation.theta[FrictionRls::kPositive], 0.0);
  c.observe(s, 0.0, 0.0);
  EXPECT_EQ(s.estimate, s.disturbance.disturbance);
  // It may ring for half a second; what swings after that is no remainder.
  swing(c, s, 2, status);
  ASSERT_EQ(s.guard.found, 2U);
  EXPECT_EQ(s.guard.trust, 0.5);
}

TEST(DynamicCompensation, WhatAStepOfACoarseEncoderMakesIsNoOscillation) {
  // 100 kg: a step of the encoder in 1 ms is 1 N with 10 nm and 100 N with 1 um. A force that swings by 20 N at 10 Hz says something
  // with the fine encoder alone.
  for (const double resolution : {10e-9, 1e-6}) {
    CompensationParams params;
    params.model.mass = 100.0;
    params.encoder_resolution = resolution;
    params.guarded = true;
    const Compensation c(params, 1e-3);
    Compensation::State s;
    StatusCounter status;
    for (int k = 0; k < 2000; ++k) {
      const double friction = c.step(s, 0.0, 1e-3, 0.0, status);
      c.applied(s, friction + 10.0 * std::sin(2.0 * kPi * 10.0 * 1e-3 * k), false, status);
    }
    EXPECT_EQ(s.guard.found > 0, resolution < 1e-7) << resolution;
  }
}

TEST(DynamicCompensation, WhatTheModelExplainsIsNoOscillation) {
  // Viscous friction and inertia of a motion that swings at 10 Hz without a reversal: 0.5 m/s of 1 m/s, 1000 N and more.
  CompensationParams params = whole(100.0, 3e8);
  params.model.mass = 50.0;
  params.model.friction.steady = friction::Conventional<double>{100.0, 2000.0, {}};
  params.guarded = true;
  for (const double unexplained : {0.0, 300.0}) {
    const Compensation c(params, kPeriod);
    Compensation::State s;
    StatusCounter status;
    constexpr double kOmega = 2.0 * kPi * 10.0;
    for (int k = 0; k < 400; ++k) {
      const double t = kPeriod * k;
      const double v = 1.0 + 0.5 * std::sin(kOmega * t);
      const double a = 0.5 * kOmega * std::cos(kOmega * t);
      const double x = t - 0.5 / kOmega * std::cos(kOmega * t);
      const double added = c.step(s, x, v, a, status);
      c.applied(s, added + 50.0 * a + unexplained * std::sin(kOmega * t), false, status);
    }
    EXPECT_EQ(s.guard.found > 0, unexplained > 0.0) << unexplained;
  }
}

TEST(Compensation, ADelayFitsUpToEightPeriodsOfAnyLength) {
  for (const double period : {62.5e-6, 1e-3, 5e-3}) {
    EXPECT_TRUE(delay_fits(0.0, period));
    EXPECT_TRUE(delay_fits(8.0 * period, period));
    EXPECT_FALSE(delay_fits(8.1 * period, period));
  }
}

TEST(Compensation, AStepOfTheEncoderAtTheSecondSampleIsNoMotion) {
  for (const double steps : {1.0, 50.0}) {
    CompensationParams p;
    p.model.mass = 1000.0;
    p.observer = Observer::kDisturbance;
    p.observer_pole = 50.0;
    p.encoder_resolution = 1e-7;
    const Compensation law(p, kPeriod);
    Compensation::State s;
    StatusCounter status;
    const double velocity = steps * 1e-7 / kPeriod;
    law.observe(s, 0.0, 0.0);
    law.applied(s, law.step(s, 0.0, 0.0, 0.0, status), false, status);
    law.observe(s, steps * 1e-7, velocity);
    // In motion the observer begins with it; otherwise it has not yet followed the step.
    EXPECT_EQ(s.disturbance.velocity == velocity, steps > 2.0) << steps;
    EXPECT_EQ(s.estimate == 0.0, steps > 2.0) << steps;
  }
}

TEST(DynamicCompensation, OnlyAnObserverOfDisturbancesHandsOverToTheBristle) {
  for (const Observer observer :
       {Observer::kNone, Observer::kAdaptive, Observer::kDisturbance, Observer::kKalman}) {
    CompensationParams params = whole(1000.0, 3e8);
    params.observer = observer;
    const Compensation c(params, kPeriod);
    Compensation::State s;
    StatusCounter status;
    c.applied(s, c.step(s, 0.0, 0.0, 0.0, status), false, status);
    s.estimate = 600.0;
    c.step(s, 0.0, 0.0, 0.0, status);
    EXPECT_EQ(s.friction != 0.0, observer == Observer::kDisturbance || observer == Observer::kKalman);
  }
}

TEST(CompensationSettings, SaysWhichSettingsHaveAnEffect) {
  using Keys = std::set<std::string>;
  const auto unused = [](Observer observer, bool density, Feedforward feedforward) {
    CompensationSettings<double> s;
    s.observer = observer;
    s.feedforward = feedforward;
    if (density) s.disturbance_density = 1.0;
    return stribeck::test::without_effect(s);
  };
  const std::string pole = "observer_pole", density = "disturbance_density", gain = "adaptive_gain";
  EXPECT_EQ(unused(Observer::kNone, false, Feedforward::kNone), (Keys{pole, density, gain, "reversal"}));
  EXPECT_EQ(unused(Observer::kDisturbance, false, Feedforward::kSteady), (Keys{density, gain, "reversal"}));
  EXPECT_EQ(unused(Observer::kDisturbance, true, Feedforward::kReversal), (Keys{density, gain}));
  EXPECT_EQ(unused(Observer::kKalman, false, Feedforward::kDynamic), (Keys{gain, "reversal"}));
  EXPECT_EQ(unused(Observer::kKalman, true, Feedforward::kReversal), (Keys{pole, gain}));
  EXPECT_EQ(unused(Observer::kAdaptive, true, Feedforward::kReversal), (Keys{pole, density}));
}

TEST(CompensationSettings, AdaptationNeedsAFeedForwardThatLooksAhead) {
  using Keys = std::set<std::string>;
  for (const Feedforward f :
       {Feedforward::kNone, Feedforward::kSteady, Feedforward::kDynamic, Feedforward::kReversal}) {
    CompensationSettings<double> s;
    s.feedforward = f;
    EXPECT_EQ(stribeck::test::complaints(s), Keys{});
    s.adaptation.enabled = true;
    const bool ahead = f == Feedforward::kDynamic || f == Feedforward::kReversal;
    EXPECT_EQ(stribeck::test::complaints(s), ahead ? Keys{} : Keys{"adaptation"});
  }
  EXPECT_TRUE(rate_is_known(ErrorRate::kLate, Observer::kNone));
  EXPECT_TRUE(rate_is_known(ErrorRate::kObserved, Observer::kKalman));
  EXPECT_FALSE(rate_is_known(ErrorRate::kObserved, Observer::kDisturbance));
}

TEST(ReversalParams, SaysWhatIsWrongWithABuildUp) {
  using Keys = std::set<std::string>;
  const auto of = [](std::initializer_list<BuildUpPoint> points) {
    ReversalParams p;
    for (const BuildUpPoint& point : points) p.build_up.push_back(point);
    return stribeck::test::complaints(p);
  };
  EXPECT_EQ(of({}), Keys{});
  EXPECT_EQ(of({{0.0, 0.4}, {20e-6, 1.0}}), Keys{});
  EXPECT_EQ(of({{20e-6, 0.4}, {20e-6, 1.0}}), Keys{"build_up"});
  EXPECT_EQ(of({{20e-6, 0.4}, {10e-6, 1.0}}), Keys{"build_up"});
  EXPECT_EQ(of({{10e-6, 0.4}, {20e-6, 0.9}}), Keys{"build_up"});
  ReversalParams both;
  both.distance = 3e-6;
  EXPECT_EQ(stribeck::test::complaints(both), Keys{});
  both.build_up.push_back({3e-6, 1.0});
  EXPECT_EQ(stribeck::test::complaints(both), Keys{"distance"});
}

/// A model of the axis that knows its level and mass, and nothing of its pre-sliding.
CompensationParams by_distance(double level, bool adaptive) {
  CompensationParams p = adapting(level, 3e8);
  p.model.friction.dynamics = friction::Static{};
  p.feedforward = Feedforward::kReversal;
  p.adaptation.enabled = adaptive;
  return p;
}

// The axis needs 3.3 um for a reversal, 4 um are assumed. A model that switches at the turn misses twice the level there.
TEST(ReversalCompensation, WithoutBristlesABuildUpIsNotTakenForALowerLevel) {
  using A = FrictionRls;
  const Followed fixed = follow(by_distance(1000.0, false), 1000.0, 3e8, 5e4, 0, 40.0);
  const Followed adapted = follow(by_distance(1000.0, true), 1000.0, 3e8, 5e4, 0, 40.0);
  EXPECT_LT(adapted.worst, 1.1 * fixed.worst);
  const auto& theta = adapted.state.adaptation.theta;
  for (const auto i : {A::kPositive, A::kNegative}) EXPECT_NEAR(theta[i], 0.0, 0.02);
  EXPECT_NEAR(theta[A::kMass], 0.0, 0.03);
  // Not evident, so it is not used.
  EXPECT_LT(std::abs(theta[A::kDelay]), adapted.state.adaptation.deviation[A::kDelay]);
}

TEST(ReversalCompensation, WithoutBristlesAWrongLevelIsStillFound) {
  const Followed fixed = follow(by_distance(1300.0, false), 1000.0, 3e8, 5e4, 0, 40.0);
  const Followed adapted = follow(by_distance(1300.0, true), 1000.0, 3e8, 5e4, 0, 40.0);
  EXPECT_LT(adapted.worst, 0.3 * fixed.worst);
  EXPECT_NEAR(adapted.state.adaptation.theta[FrictionRls::kPositive], 1.0 / 1.3 - 1.0, 0.02);
}

// Half the distance of the axis is assumed; adaptation finds the rest.
TEST(ReversalCompensation, WithoutBristlesTheDistanceIsLearned) {
  CompensationParams params = by_distance(1000.0, true);
  params.reversal.distance = 1.67e-6;
  const Followed adapted = follow(params, 1000.0, 3e8, 5e4, 0, 80.0);
  params.adaptation.enabled = false;
  const Followed fixed = follow(params, 1000.0, 3e8, 5e4, 0, 80.0);
  EXPECT_LT(adapted.worst, 0.6 * fixed.worst);
  EXPECT_NEAR(adapted.state.adaptation.theta[FrictionRls::kStiffness], -0.5, 0.15);
}

TEST(ReversalCompensation, ADistanceStandsForATable) {
  ReversalParams p;
  EXPECT_EQ(p.mean_distance(), 4e-6);
  p.distance = 2e-6;
  EXPECT_EQ(p.mean_distance(), 2e-6);
  // Linear over 6 um; 0.4 at once and the rest from 20 to 40 um.
  p.build_up.push_back({6e-6, 1.0});
  EXPECT_NEAR(p.mean_distance(), 3e-6, 1e-18);
  p.build_up = {};
  for (const BuildUpPoint& point :
       {BuildUpPoint{0.0, 0.4}, BuildUpPoint{20e-6, 0.4}, BuildUpPoint{40e-6, 1.0}})
    p.build_up.push_back(point);
  EXPECT_NEAR(p.mean_distance(), 18e-6, 1e-18);
}

}  // namespace
}  // namespace stribeck::control::compensation_test
