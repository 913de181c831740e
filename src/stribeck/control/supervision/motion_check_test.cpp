#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/control/supervision/motion_check.hpp>
#include <stribeck/control/supervision/safe_stop.hpp>

namespace stribeck::control::motion_check_test {
namespace {

constexpr double kMass = 1000.0;
constexpr double kLevel = 20.0;
constexpr double kPeriod = 1e-3;

friction::Model conventional() {
  friction::Model m;
  m.steady = friction::Conventional<double>{kLevel, 4500.0, {}};
  return m;
}

SupervisionLimits limits(double load = 0.0) {
  CompensationParams axis;
  axis.model.mass = kMass;
  axis.model.load = load;
  axis.model.friction = conventional();
  axis.encoder_resolution = 1e-7;
  SupervisionParams p;
  p.speed_limit = 16e-3;
  p.acceleration_limit = 0.1;
  return {p, axis, 250.0, kPeriod};
}

/// A mass with Coulomb friction under a held force; what the encoder says of it goes through the check.
struct Axis {
  double x = 0.0;
  double v = 0.0;
  double seen = 0.0;
  MotionCheck::State state;

  Fault step(const MotionCheck& check, double force, double acts, bool frozen = false) {
    const double before = seen;
    if (!frozen) seen = 1e-7 * std::round(x / 1e-7);
    MotionCheck::Motion m;
    m.position = seen;
    m.velocity = (seen - before) / kPeriod;
    m.force = force;
    const Fault f = check.step(state, m);
    const double friction = v != 0.0 ? kLevel * sign(v) : clamp_to(acts, -kLevel, kLevel);
    const double next = v + kPeriod * (acts - friction) / kMass;
    v = v * next < 0.0 ? 0.0 : next;
    x += kPeriod * v;
    return f;
  }
};

TEST(MotionCheck, AForceThatTurnsEachPeriodPushesNothing) {
  // It moves no mass, so that an encoder at rest is right.
  const MotionCheck check(limits());
  MotionCheck::State s;
  for (int k = 0; k < 2000; ++k) {
    MotionCheck::Motion m;
    m.force = k % 2 == 0 ? 200.0 : -200.0;
    ASSERT_EQ(check.step(s, m), Fault::kNone) << k;
  }
}

TEST(MotionCheck, SoundAxesAcceleratedAndBrakedAsHardAsTheyCanDoNotTrip) {
  const MotionCheck check(limits());
  for (const double force : {70.0, 120.0, 250.0}) {
    Axis a;
    // Up to 15 mm/s, then down and into the other direction, again and again.
    double direction = 1.0;
    for (int k = 0; k < 3000; ++k) {
      if (a.v * direction > 15e-3) direction = -direction;
      ASSERT_EQ(a.step(check, direction * force, direction * force), Fault::kNone) << force << " " << k;
    }
  }
}

TEST(MotionCheck, AWrongSignIsSeenWithinFiftyMicrometres) {
  const MotionCheck check(limits());
  for (const double sense : {1.0, -1.0}) {
    Axis a;
    Fault f = Fault::kNone;
    for (int k = 0; k < 1000 && f == Fault::kNone; ++k) f = a.step(check, sense * 80.0, -sense * 80.0);
    EXPECT_EQ(f, Fault::kWrongSign);
    EXPECT_LT(std::abs(a.x), 50e-6);
  }
}

TEST(MotionCheck, AnEncoderThatStandsUnderAForceIsSeen) {
  const MotionCheck check(limits());
  Axis a;
  Fault f = Fault::kNone;
  int periods = 0;
  for (; periods < 1000 && f == Fault::kNone; ++periods) f = a.step(check, 80.0, 80.0, true);
  EXPECT_EQ(f, Fault::kEncoderFrozen);
  // sqrt(4·20 um·1000 kg/62.5 N) = 36 ms, and three for the force to count.
  EXPECT_NEAR(periods, 40, 3);
  EXPECT_LT(a.x, 0.06e-3);
  // A force that friction may hold says nothing.
  Axis held;
  for (int k = 0; k < 3000; ++k) ASSERT_EQ(held.step(check, 19.0, 19.0), Fault::kNone);
}

MotionCheck::Motion at(double velocity, double error, double rate) {
  MotionCheck::Motion m;
  m.velocity = velocity;
  m.error = error;
  m.reference_rate = rate;
  return m;
}

TEST(MotionCheck, TheFollowingErrorMayGrowWithSpeed) {
  const MotionCheck check(limits());
  const auto judge = [&](double error, double rate) {
    MotionCheck::State s;
    return check.step(s, at(0.0, error, rate));
  };
  EXPECT_EQ(judge(0.31e-3, 0.0), Fault::kNone);
  EXPECT_EQ(judge(-0.33e-3, 0.0), Fault::kFollowingError);
  EXPECT_EQ(judge(1.3e-3, 10e-3), Fault::kNone);
  EXPECT_EQ(judge(1.33e-3, -10e-3), Fault::kFollowingError);
}

TEST(MotionCheck, NoFasterThanTheAxisMayBe) {
  const MotionCheck check(limits());
  const auto judge = [&](double velocity) {
    MotionCheck::State s;
    return check.step(s, at(velocity, 0.0, 0.0));
  };
  EXPECT_EQ(judge(24e-3), Fault::kNone);
  EXPECT_EQ(judge(-25e-3), Fault::kOverspeed);
}

TEST(MotionCheck, ABridgedSampleIsNoEvidence) {
  const MotionCheck check(limits());
  MotionCheck::State s;
  MotionCheck::Motion m = at(1.0, 1.0, 0.0);
  m.bridged = true;
  EXPECT_EQ(check.step(s, m), Fault::kNone);
}

TEST(MotionCheck, SaturationMayLastHalfASecond) {
  const MotionCheck check(limits());
  MotionCheck::State s;
  MotionCheck::Motion m = at(5e-3, 0.0, 5e-3);
  m.limited = true;
  for (int k = 0; k < 500; ++k) ASSERT_EQ(check.step(s, m), Fault::kNone) << k;
  EXPECT_EQ(check.step(s, m), Fault::kSaturated);
  m.limited = false;
  EXPECT_EQ(check.step(s, m), Fault::kNone);
}

TEST(MotionCheck, RegularSwingsOfHalfTheForceAreAnOscillation) {
  const MotionCheck check(limits());
  const auto trips = [&](double amplitude) {
    MotionCheck::State s;
    MotionCheck::Motion m = at(5e-3, 0.0, 5e-3);
    for (int k = 0; k < 2000; ++k) {
      m.feedback = amplitude * std::sin(2.0 * kPi * 20.0 * kPeriod * k);
      if (check.step(s, m) == Fault::kOscillation) return true;
    }
    return false;
  };
  EXPECT_TRUE(trips(100.0));
  EXPECT_FALSE(trips(50.0));
}

TEST(MotionCheck, HuntingThatFrictionExplainsIsNoOscillation) {
  // An integrator against friction: the force turns over between the two break-away forces, here 120 N and 140 N of 250 N.
  CompensationParams axis;
  axis.model.mass = kMass;
  axis.model.friction.steady = friction::Conventional<double>{100.0, 4500.0, {}};
  axis.encoder_resolution = 1e-7;
  const MotionCheck check(SupervisionLimits({}, axis, 250.0, kPeriod));
  const auto trips = [&](double amplitude) {
    MotionCheck::State s;
    for (int k = 0; k < 5000; ++k) {
      MotionCheck::Motion m;
      m.position = 1e-3 * k;
      m.feedback = amplitude * std::sin(2.0 * kPi * 4.0 * kPeriod * k);
      if (check.step(s, m) == Fault::kOscillation) return true;
    }
    return false;
  };
  EXPECT_FALSE(trips(120.0));
  EXPECT_FALSE(trips(140.0));
  EXPECT_TRUE(trips(200.0));
}

TEST(SafeStop, BrakesToAStandAndThenHoldsTheLoad) {
  for (const double load : {0.0, 30.0, -30.0}) {
    for (const double v0 : {10e-3, -10e-3}) {
      const SafeStop stop(limits(load), conventional());
      SafeStop::State s;
      stop.begin(s, Reaction::kBrake, 60.0 * sign(v0) + load, v0, 10);
      double v = v0;
      double x = 0.0;
      int periods = 0;
      for (int k = 0; k < 400; ++k) {
        const double force = stop.step(s);
        EXPECT_LE(std::abs(force), 250.0);
        if (s.left > 0) periods = k + 2;
        const double push = force - load;
        const double friction =
            v != 0.0 ? (kLevel + 4500.0 * std::abs(v)) * sign(v) : clamp_to(push, -20.0, 20.0);
        const double next = v + kPeriod * (push - friction) / kMass;
        v = v * next < 0.0 ? 0.0 : next;
        x += kPeriod * v;
      }
      EXPECT_EQ(s.force, load);
      EXPECT_LE(periods, 40);
      EXPECT_EQ(v, 0.0);
      // With friction alone it would be 1 mm and more.
      EXPECT_LT(std::abs(x), 0.3e-3);
      EXPECT_GT(x * v0, 0.0);
    }
  }
}

// Of 4 m/s in 40 ms, 100 m/s2 would do; with a limit, four fifths of it brake.
TEST(SafeStop, BrakesWithAHundredMetresPerSecondSquaredWhereNoForceLimitIsKnown) {
  for (const bool limited : {false, true}) {
    SupervisionLimits l = limits();
    l.force = limited ? 250.0 : SupervisionLimits::kOff;
    const SafeStop stop(l, conventional());
    SafeStop::State s;
    stop.begin(s, Reaction::kBrake, 0.0, 100.0, 0);
    EXPECT_DOUBLE_EQ(s.brake, limited ? 200.0 : 100.0 * kMass);
    EXPECT_DOUBLE_EQ(stop.step(s), limited ? -200.0 : -100.0 * kMass);
  }
}

TEST(SafeStop, AnAxisAtRestIsLetGoOverTwentyMilliseconds) {
  const SafeStop stop(limits(10.0), conventional());
  SafeStop::State s;
  stop.begin(s, Reaction::kBrake, 200.0, 0.0, 0);
  double last = 200.0;
  for (int k = 0; k < 21; ++k) {
    const double force = stop.step(s);
    EXPECT_LT(force, last);
    EXPECT_GT(force, last - 10.0);
    last = force;
  }
  EXPECT_NEAR(last, 10.0, 1e-9);
  EXPECT_EQ(stop.step(s), 10.0);
}

TEST(SafeStop, AfterAWrongSignThereIsNoForceAtOnce) {
  const SafeStop stop(limits(10.0), conventional());
  SafeStop::State s;
  stop.begin(s, reaction(Fault::kWrongSign), 200.0, 5e-3, 0);
  EXPECT_EQ(stop.step(s), 0.0);
}

TEST(SafeStop, NoTimeIsNoBrake) {
  const SafeStop stop(limits(10.0), conventional());
  SafeStop::State s;
  stop.begin(s, Reaction::kBrake, 200.0, 5e-3, 60);
  EXPECT_EQ(stop.step(s), 10.0);
}

}  // namespace
}  // namespace stribeck::control::motion_check_test
