#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stribeck/control/compensation/compensation.hpp>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/control/observers/adaptive_friction.hpp>
#include <stribeck/control/test_axes.hpp>

namespace stribeck::control::adaptive_friction_test {
namespace {

constexpr double kGain = 20.0;
constexpr double kPeriod = 1e-3;

TEST(AdaptiveFriction, AnswersAStepAsAFirstOrderFilter) {
  // dβ̂/dt = K_c (β − β̂): β̂ = β (1 − exp(−K_c t)), exactly at the samples.
  const AdaptiveFriction filter(kGain, test::kMass, kPeriod);
  AdaptiveFriction::State s;
  for (int k = 1; k <= 300; ++k)
    EXPECT_NEAR(filter.step(s, 7.0, 0.0), 7.0 * (1.0 - std::exp(-kGain * kPeriod * k)), 1e-12);
}

TEST(AdaptiveFriction, SeesNothingWhereTheForceIsWhatTheMassNeeds) {
  // f − f_nom = m q̈: accelerating, without friction that the model misses.
  const AdaptiveFriction filter(kGain, test::kMass, kPeriod);
  AdaptiveFriction::State s;
  for (int k = 1; k <= 100; ++k)
    EXPECT_NEAR(filter.step(s, test::kMass * 0.3, 0.3 * kPeriod * k), 0.0, 1e-12);
}

/// Force less the nominal friction, held over each period, and the velocity of a mass under it and under β(t).
struct Drive {
  double beta = 0.0;
  test::Mass mass;

  double step(int k, double period) {
    const double t = period * k;
    const double force = 12.0 * std::sin(3.0 * t) + 5.0 * std::cos(11.0 * t);
    beta = 4.0 * std::sin(2.0 * t) + 1.0;
    mass.move(force - beta, period);
    return force;
  }
};

/// Largest difference from (4.23), corrected, in small explicit steps over the same forces and velocities.
double difference_from_print(double period) {
  constexpr int kFine = 1000;
  const AdaptiveFriction filter(kGain, test::kMass, period);
  AdaptiveFriction::State s;
  Drive drive;
  double beta_e = 0.0;
  double worst = 0.0;
  for (int k = 0; k < static_cast<int>(std::lround(1.0 / period)); ++k) {
    const double before = drive.mass.v;
    const double force = drive.step(k, period);
    const double h = period / kFine;
    for (int i = 0; i < kFine; ++i) {
      const double v = before + (drive.mass.v - before) * (i + 0.5) / kFine;
      beta_e += h * kGain * (force - beta_e + kGain * test::kMass * v);
    }
    const double printed = beta_e - kGain * test::kMass * drive.mass.v;
    worst = std::max(worst, std::abs(filter.step(s, force, drive.mass.v) - printed));
  }
  return worst;
}

TEST(AdaptiveFriction, IsThePrintedLawInUnitsOfForce) {
  // Within one period the mass accelerates evenly, so that both are the same; explicit steps are off by K_c h/2 of 12 N.
  EXPECT_LT(difference_from_print(1e-3), 1e-3);
  EXPECT_LT(difference_from_print(5e-3), 5e-3);
}

TEST(AdaptiveFriction, FollowsWhatChangesOneTimeConstantLate) {
  // Limit: β = 4 sin 2t + 1 through a pole at K_c: 4 sin(2t − atan(2/K_c))/√(1 + (2/K_c)²) + 1.
  const AdaptiveFriction filter(kGain, test::kMass, kPeriod);
  AdaptiveFriction::State s;
  Drive drive;
  for (int k = 0; k < 4000; ++k) {
    const double force = drive.step(k, kPeriod);
    const double got = filter.step(s, force, drive.mass.v);
    if (k < 1000) continue;
    const double expected =
        1.0 + 4.0 * std::sin(2.0 * kPeriod * (k + 1) - std::atan(2.0 / kGain)) / std::hypot(1.0, 2.0 / kGain);
    // β of the plant is held over a period: half a sample late.
    EXPECT_NEAR(got, expected, 0.51 * kPeriod * 4.0 * 2.0) << k;
  }
}

TEST(AdaptiveFriction, IsTheSameInTheMirror) {
  const AdaptiveFriction filter(kGain, test::kMass, kPeriod);
  AdaptiveFriction::State s, t;
  for (int k = 0; k < 100; ++k) {
    const double f = 10.0 * std::sin(0.1 * k);
    const double v = 1e-3 * std::cos(0.3 * k);
    EXPECT_EQ(filter.step(s, f, v), -filter.step(t, -f, -v));
  }
}

TEST(AdaptiveFriction, IsStableForAnyGainAndForgetsItsStart) {
  for (const double gain : {1e-3, 20.0, 1e3, 1e6}) {
    const AdaptiveFriction filter(gain, test::kMass, kPeriod);
    AdaptiveFriction::State s;
    s.beta = 1e3;
    double last = s.beta;
    for (int k = 0; k < 100; ++k) {
      const double now = filter.step(s, 0.0, 0.0);
      EXPECT_LE(now, last);
      EXPECT_GE(now, 0.0);
      last = now;
    }
  }
}

// ---- in the loop

/// Contouring of masses on a path in space whose nominal friction is `nominal` and whose true one is `truth` [N], Coulomb; the
/// true mass is kMass, the model's `mass`. β̂ of each axis and the largest error of the last half second.
struct Ridden {
  Vec<double, 3> beta;
  double error = 0.0;
};

Ridden ride(Observer observer, double load, double mass) {
  auto setup = test::masses<3>(kPeriod);
  for (auto& c : setup.compensation) {
    c.model.mass = mass;
    c.model.friction.steady = friction::Conventional<double>{1.0, 100.0, {}};
    c.feedforward = control::Feedforward::kSteady;
    c.observer = observer;
    c.adaptive_gain = kGain;
  }
  const Contouring<3> law(ContouringParams::critical(40.0, 40.0), setup);
  path::Reference<path::Fourier<3>> reference(test::saddle(), {9.5e-3, 0.5, 1.0});
  Contouring<3>::State state;
  std::array<test::Mass, 3> axis;
  for (std::size_t i = 0; i < 3; ++i) axis[i].x = reference.point().position[i];
  Ridden r;
  for (int k = 0; k < 3000; ++k) {
    const auto p = reference.point();
    Vec<double, 3> x;
    for (std::size_t i = 0; i < 3; ++i) x[i] = axis[i].x;
    const auto f = law.step(state, p, x);
    for (std::size_t i = 0; i < 3; ++i) {
      // The model's friction at the reference, and a constant force that the observer does not know.
      const double nominal = sign(p.velocity[i]) * 1.0 + 100.0 * p.velocity[i];
      axis[i].move(f[i] - nominal - load, kPeriod);
      if (k >= 2500) r.error = std::max(r.error, std::abs(x[i] - p.position[i]));
    }
    reference.advance(kPeriod);
  }
  for (std::size_t i = 0; i < 3; ++i) r.beta[i] = state.compensation[i].estimate;
  return r;
}

TEST(AdaptiveFriction, FindsAConstantMissAndTakesItsErrorOut) {
  // Without it the loop stands m ω² e = d away: 3 N/(50 kg·1600) = 37.5 µm, a tenth more where the frame turns under it.
  EXPECT_NEAR(ride(Observer::kNone, 3.0, test::kMass).error, 37.5e-6, 4e-6);
  const Ridden r = ride(Observer::kAdaptive, 3.0, test::kMass);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(r.beta[i], 3.0, 1e-3);
  EXPECT_LT(r.error, 0.05e-6);
}

TEST(AdaptiveFriction, TakesAMassErrorForFriction) {
  // 10 % too heavy a model: β = f − f_nom − m̂ q̈ = d + (m − m̂) q̈. On this path |q̈| stays below 20 mm/s², 0.1 N.
  for (const double mass : {0.9 * test::kMass, 1.1 * test::kMass}) {
    const Ridden r = ride(Observer::kAdaptive, 3.0, mass);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(r.beta[i], 3.0, 0.1);
    EXPECT_LT(r.error, 1e-6);
    EXPECT_GT(ride(Observer::kNone, 3.0, mass).error, 30e-6);
  }
}

}  // namespace
}  // namespace stribeck::control::adaptive_friction_test
