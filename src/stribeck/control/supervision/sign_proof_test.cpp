#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stribeck/control/supervision/sign_proof.hpp>

namespace stribeck::control::sign_proof_test {
namespace {

constexpr double kMass = 1000.0;
constexpr double kLevel = 20.0;
constexpr double kPeriod = 1e-3;

SupervisionLimits limits(double load = 0.0, SupervisionParams p = {}, double force_limit = 250.0) {
  CompensationParams axis;
  axis.model.mass = kMass;
  axis.model.load = load;
  axis.model.friction.steady = friction::Conventional<double>{kLevel, 4500.0, {}};
  axis.encoder_resolution = 1e-7;
  return {p, axis, force_limit, kPeriod};
}

/// A mass with Coulomb friction; `sense` is that of its encoder.
struct Axis {
  double sense = 1.0;
  double x = 0.0;
  double v = 0.0;
  double seen = 0.0;
  SignProof::State state;

  bool step(const SupervisionLimits& l, double force) {
    const double before = seen;
    seen = sense * 1e-7 * std::round(x / 1e-7);
    SignProof::step(state, l, seen, (seen - before) / kPeriod, force);
    const double acts = force - l.load;
    const double friction = v != 0.0 ? kLevel * sign(v) : clamp_to(acts, -kLevel, kLevel);
    const double next = v + kPeriod * (acts - friction) / kMass;
    v = v * next < 0.0 ? 0.0 : next;
    x += kPeriod * v;
    return state.proven;
  }
};

TEST(SignProof, TheForceStaysWithinItsShareAroundTheLoadUntilItIsProven) {
  const SupervisionLimits l = limits(30.0);
  SignProof::State s;
  EXPECT_EQ(SignProof::limited(s, l, 155.0), 155.0);
  EXPECT_EQ(SignProof::limited(s, l, 250.0), 155.0);
  EXPECT_EQ(SignProof::limited(s, l, -250.0), -95.0);
  s.proven = true;
  EXPECT_EQ(SignProof::limited(s, l, 250.0), 250.0);
}

TEST(SignProof, TheShareLeavesRoomForThePush) {
  SupervisionParams p;
  EXPECT_DOUBLE_EQ(limits().start, 125.0);
  p.start_share = 0.2;
  EXPECT_DOUBLE_EQ(limits(0.0, p).start, 1.25 * 62.5);
  p.start_share = 1.0;
  EXPECT_EQ(limits(0.0, p).start, SupervisionLimits::kOff);
  EXPECT_EQ(limits(0.0, {}, SupervisionLimits::kOff).start, SupervisionLimits::kOff);
}

TEST(SignProof, ASoundAxisProvesItsSignWithinMicrometres) {
  for (const double load : {0.0, 30.0}) {
    const SupervisionLimits l = limits(load);
    for (const double push : {25.0, -40.0, 120.0}) {
      Axis a;
      for (int k = 0; k < 1000 && !a.step(l, load + push); ++k) {
      }
      EXPECT_TRUE(a.state.proven) << push;
      EXPECT_LT(std::abs(a.x), 10e-6) << push;
    }
  }
}

TEST(SignProof, AWrongSignIsNeverProvenEvenWhileTheForceBrakes) {
  const SupervisionLimits l = limits();
  Axis a;
  a.sense = -1.0;
  for (int k = 0; k < 100; ++k) ASSERT_FALSE(a.step(l, 100.0)) << k;
  // The encoder continues in the direction of the present force, for more than 0.1 mm.
  const double before = a.x;
  while (a.v > 0.0) ASSERT_FALSE(a.step(l, -100.0));
  EXPECT_GT(a.x - before, 0.1e-3);
  // And with a force that changes its sign before the axis stops.
  for (int k = 0; k < 400; ++k) ASSERT_FALSE(a.step(l, k / 20 % 2 == 0 ? -100.0 : -60.0)) << k;
}

TEST(SignProof, AForceThatFrictionHoldsProvesNothing) {
  const SupervisionLimits l = limits();
  Axis a;
  for (int k = 0; k < 1000; ++k) ASSERT_FALSE(a.step(l, 15.0));
  // Nor does motion under a force that is too small to be a push.
  SignProof::State s;
  for (int k = 0; k < 1000; ++k) SignProof::step(s, l, 1e-6 * k, 1e-3, 5.0);
  EXPECT_FALSE(s.proven);
}

TEST(SignProof, APushOfMonthsIsCountedWithoutOverflow) {
  const SupervisionLimits l = limits();
  SignProof::State s;
  for (int k = 0; k < 10; ++k) SignProof::step(s, l, 0.0, 0.0, 100.0);
  s.pushed = std::numeric_limits<int>::max();
  for (int k = 0; k < 10; ++k) {
    SignProof::step(s, l, 0.0, 0.0, 100.0);
    ASSERT_GT(s.pushed, 0);
  }
  EXPECT_FALSE(s.proven);
}

}  // namespace
}  // namespace stribeck::control::sign_proof_test
