#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stribeck/control/supervision/encoder_check.hpp>
#include <vector>

namespace stribeck::control::encoder_check_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// An axis of 1000 kg with 20 N of friction and 250 N, encoder of 0.1 um, 1 ms: A = 0.27 m/s², A·T² = 0.27 um.
SupervisionLimits limits(double period = 1e-3) {
  CompensationParams axis;
  axis.model.mass = 1000.0;
  axis.model.friction.steady = friction::Conventional<double>{20.0, 4500.0, {}};
  axis.encoder_resolution = 1e-7;
  SupervisionParams p;
  p.speed_limit = 16e-3;
  p.acceleration_limit = 0.1;
  return {p, axis, 250.0, period};
}

/// 10 mm · sin t, seen by an encoder.
struct Sine {
  double t = 0.0;
  double dt = 1e-3;
  [[nodiscard]] double r() const { return 10e-3 * std::sin(t); }
  [[nodiscard]] double v() const { return 10e-3 * std::cos(t); }
  [[nodiscard]] double a() const { return -10e-3 * std::sin(t); }
  [[nodiscard]] double read() const { return 1e-7 * std::round((r() + 3e-6) / 1e-7); }
  double step(EncoderCheck::State& s, const SupervisionLimits& l, double sample, int periods = 1) {
    return EncoderCheck::step(s, l, sample, r(), v(), a(), periods);
  }
};

// Both in one period: the prediction was no number from then on, and every good sample counted as lost.
TEST(EncoderCheck, NoNumberFromEncoderAndReferenceInOnePeriodIsForgotten) {
  const SupervisionLimits l = limits();
  for (const int apart : {0, 1}) {
    EncoderCheck::State s;
    Sine sine;
    for (int k = 0; k < 200; ++k, sine.t += sine.dt) {
      const double r = k == 100 ? kNan : sine.r();
      const double sample = k == 100 + apart ? kNan : sine.read();
      const double used = EncoderCheck::step(s, l, sample, r, sine.v(), sine.a());
      EXPECT_NEAR(used, sine.r() + 3e-6, 2e-6) << k;
      EXPECT_EQ(EncoderCheck::judge(s, l), Fault::kNone) << k;
    }
    EXPECT_LE(s.bridged, 2U);
    EXPECT_EQ(s.in_a_row, 0);
  }
}

// An axis that stands, while neither encoder nor reference say anything: it is taken to stand.
TEST(EncoderCheck, WithoutEncoderAndReferenceAnAxisAtRestStaysWhereItIs) {
  const SupervisionLimits l = limits();
  for (const int lost : {0, 1, 2}) {
    EncoderCheck::State s;
    for (int k = 0; k < 50; ++k) EncoderCheck::step(s, l, 5e-3, 5e-3, 0.0, 0.0);
    for (int k = 0; k < 5; ++k) {
      const double r = lost == 0 ? kNan : 5e-3;
      const double rate = lost == 1 ? kInfinite : 0.0;
      const double acceleration = lost == 2 ? -kInfinite : 0.0;
      EXPECT_EQ(EncoderCheck::step(s, l, kNan, r, rate, acceleration), 5e-3) << lost << ' ' << k;
    }
    EXPECT_EQ(EncoderCheck::step(s, l, 5e-3, 5e-3, 0.0, 0.0), 5e-3);
    EXPECT_FALSE(EncoderCheck::bridges(s));
  }
}

TEST(SupervisionLimits, FollowFromTheAxis) {
  const SupervisionLimits l = limits();
  EXPECT_DOUBLE_EQ(l.growth, (250.0 + 20.0) / 1000.0 * 1e-6);
  EXPECT_DOUBLE_EQ(l.noise, 1e-6);
  EXPECT_DOUBLE_EQ(l.speed, 24e-3);
  EXPECT_DOUBLE_EQ(l.push, 62.5);
  EXPECT_DOUBLE_EQ(l.following, 0.32e-3);
  EXPECT_EQ(l.samples, 10);
  EXPECT_EQ(l.stop_periods, 50);
  // Never fewer than three samples, whatever the period.
  EXPECT_EQ(limits(5e-3).samples, 3);
}

TEST(SupervisionLimits, ALargeForceMayMoveTheAxisFurther) {
  // Half as far again as the model's mass goes in a period under this force, braked by its friction. The usual reach is the least.
  const SupervisionLimits l = limits();
  for (const double force : {300.0, 1000.0, 5000.0})
    EXPECT_DOUBLE_EQ(l.growth_after(force), 1.5 * (force + 20.0) / 1000.0 * 1e-6) << force;
  EXPECT_EQ(l.growth_after(0.0), l.growth);
}

TEST(SupervisionLimits, ScaleWithTheUnits) {
  // The same axis in units of length, time and mass that are powers of two of the metre, second and kilogram.
  struct In {
    double m, s, kg;
  };
  const auto of = [](const In& u, double load) {
    const double n = u.kg * u.m / (u.s * u.s);
    CompensationParams axis;
    axis.model.mass = 1000.0 * u.kg;
    axis.model.load = load * n;
    axis.model.friction.steady = friction::Conventional<double>{20.0 * n, 4500.0 * n * u.s / u.m, {}};
    axis.encoder_resolution = 1e-7 * u.m;
    SupervisionParams p;
    p.speed_limit = 16e-3 * u.m / u.s;
    p.acceleration_limit = 0.05 * u.m / (u.s * u.s);
    p.omega = 20.0 / u.s;
    return SupervisionLimits(p, axis, 250.0 * n, 1e-3 * u.s);
  };
  for (const double load : {0.0, 60.0, -60.0}) {
    const SupervisionLimits si = of({1.0, 1.0, 1.0}, load);
    for (const In& u : {In{4.0, 1.0, 1.0}, In{1.0, 1.0, 0.25}}) {
      const double n = u.kg * u.m / (u.s * u.s);
      const SupervisionLimits l = of(u, load);
      EXPECT_DOUBLE_EQ(l.noise, si.noise * u.m);
      EXPECT_DOUBLE_EQ(l.growth, si.growth * u.m);
      EXPECT_DOUBLE_EQ(l.growth_after(900.0 * n), si.growth_after(900.0) * u.m);
      EXPECT_DOUBLE_EQ(l.speed, si.speed * u.m / u.s);
      EXPECT_DOUBLE_EQ(l.level, si.level * n);
      EXPECT_DOUBLE_EQ(l.push, si.push * n);
      EXPECT_DOUBLE_EQ(l.start, si.start * n);
      EXPECT_DOUBLE_EQ(l.following, si.following * u.m);
      EXPECT_DOUBLE_EQ(l.swing, si.swing * n);
      EXPECT_DOUBLE_EQ(l.rattle(), si.rattle() * u.m / u.s);
    }
  }
}

TEST(SupervisionLimits, ADelayCountsInWholePeriodsUpToTheLongest) {
  CompensationParams axis;
  axis.model.mass = 1000.0;
  for (const auto& [delay, periods] : {std::pair{0.0, 0}, std::pair{0.3e-3, 1}, std::pair{1e-3, 1},
                                       std::pair{2.1e-3, 3}, std::pair{8e-3, 8}, std::pair{11e-3, 8}}) {
    axis.model.delay = delay;
    EXPECT_EQ(SupervisionLimits({}, axis, 250.0, 1e-3).late_periods, periods) << delay;
  }
}

TEST(SupervisionLimits, WithoutAForceLimitTwiceTheFrictionIsAPush) {
  CompensationParams axis;
  axis.model.mass = 1000.0;
  axis.model.friction.steady = friction::Conventional<double>{200.0, 4500.0, {}};
  EXPECT_EQ(SupervisionLimits({}, axis, kInfinite, 1e-3).push, 400.0);
  EXPECT_EQ(SupervisionLimits({}, axis, 800.0, 1e-3).push, 400.0);
  EXPECT_EQ(SupervisionLimits({}, axis, 4000.0, 1e-3).push, 1000.0);
}

/// The same axis with 200 N of friction, and commands of at most 20 mm/s²: friction stops it harder than any command.
SupervisionLimits rough(double period) {
  CompensationParams axis;
  axis.model.mass = 1000.0;
  axis.model.friction.steady = friction::Conventional<double>{200.0, 4500.0, {}};
  axis.encoder_resolution = 1e-7;
  SupervisionParams p;
  p.speed_limit = 16e-3;
  p.acceleration_limit = 0.02;
  return {p, axis, 800.0, period};
}

TEST(SupervisionLimits, FrictionThatTurnsOverMovesASoftLoopByLessThanTheFollowingError) {
  // The machine has a fifth more friction and 0.85 of the mass of its model. At a reversal feed-forward and observer have their old
  // sign: the loop alone takes twice the friction. Against the limit of an axis that rests: 1/ω of its speed limit is for motion.
  for (const double omega : {5.0, 10.0, 40.0, 200.0}) {
    CompensationParams axis;
    axis.model.mass = 1000.0;
    axis.model.friction.steady = friction::Conventional<double>{200.0, 4500.0, {}};
    SupervisionParams p;
    p.speed_limit = 16e-3;
    p.omega = omega;
    const SupervisionLimits l(p, axis, 800.0, 1e-3);
    const double room = l.following - std::max(20e-3, 1.0 / omega) * 16e-3;
    double x = 0.0;
    double v = 0.0;
    double worst = 0.0;
    const double dt = 1e-3 / omega;
    for (int k = 0; k < 20000; ++k) {
      const double law = -1000.0 * (omega * omega * x + 2.0 * omega * v);
      v += dt * (law + 2.0 * 1.2 * 200.0) / 850.0;
      x += dt * v;
      worst = std::max(worst, x);
    }
    EXPECT_LT(worst, room) << omega;
    // And not by much less: the check is to see what friction does not explain.
    EXPECT_GT(worst, 0.7 * room) << omega;
    p.following_error = 1e-3;
    EXPECT_EQ(SupervisionLimits(p, axis, 800.0, 1e-3).following, 1e-3);
  }
}

TEST(SupervisionLimits, WhatNobodyKnowsIsNotChecked) {
  CompensationParams axis;
  axis.model.mass = 1000.0;
  const SupervisionLimits l({}, axis, kInfinite, 1e-3);
  EXPECT_EQ(l.growth, kInfinite);
  EXPECT_EQ(l.speed, kInfinite);
  EXPECT_EQ(l.push, kInfinite);
  EXPECT_EQ(l.following, kInfinite);
  // But a sample that is no number is bridged all the same.
  EncoderCheck::State s;
  Sine m;
  for (int k = 0; k < 10; ++k, m.t += m.dt) EXPECT_EQ(m.step(s, l, m.read()), m.read());
  EXPECT_NEAR(m.step(s, l, kNan), m.r() + 3e-6, 2e-7);
  EXPECT_EQ(s.bridged, 1u);
}

TEST(SupervisionLimits, AJumpThatIsSetIsTheGateOfOneSample) {
  CompensationParams axis;
  axis.model.mass = 1000.0;
  axis.encoder_resolution = 1e-7;
  SupervisionParams p;
  p.jump = 5e-6;
  const SupervisionLimits l(p, axis, 250.0, 1e-3);
  EXPECT_DOUBLE_EQ(l.noise + l.growth, 5e-6);
}

TEST(EncoderCheck, GoodSamplesPassBitForBit) {
  for (const double period : {1e-3, 5e-3}) {
    const SupervisionLimits l = limits(period);
    EncoderCheck::State s;
    Sine m;
    m.dt = period;
    for (; m.t < 13.0; m.t += m.dt) ASSERT_EQ(m.step(s, l, m.read()), m.read()) << m.t;
    EXPECT_EQ(s.bridged, 0u);
  }
}

TEST(EncoderCheck, AWildSampleOfAnySizeIsBridged) {
  const SupervisionLimits l = limits();
  for (const double size : {2e-6, 1e-3, 1.0, 1e9, 1e15, 1e300, kInfinite, -kInfinite, kNan}) {
    for (const double when : {0.3, 1.57, 2.5}) {
      EncoderCheck::State s;
      Sine m;
      for (; m.t < when; m.t += m.dt) m.step(s, l, m.read());
      // Two steps of the encoder: what a difference of its samples is off by.
      EXPECT_NEAR(m.step(s, l, m.read() + size), m.read(), 2.01e-7) << size;
      EXPECT_TRUE(EncoderCheck::bridges(s));
      for (int k = 0; k < 100; ++k) {
        m.t += m.dt;
        ASSERT_EQ(m.step(s, l, m.read()), m.read()) << size << " " << k;
      }
      EXPECT_EQ(s.bridged, 1u);
      EXPECT_EQ(EncoderCheck::judge(s, l), Fault::kNone);
    }
  }
}

TEST(EncoderCheck, AWildSampleInsideTheGateDoesNotDragTheNextOnesOut) {
  // Nor with the law's response to it: a motion of half its size in the other direction.
  for (const double period : {1e-3, 5e-3}) {
    const SupervisionLimits l = limits(period);
    EncoderCheck::State s;
    Sine m;
    m.dt = period;
    for (; m.t < 1.0; m.t += m.dt) m.step(s, l, m.read());
    const double size = 0.9 * (l.noise + l.growth);
    EXPECT_EQ(m.step(s, l, m.read() + size), m.read() + size);
    for (int k = 0; k < 20; ++k) {
      m.t += m.dt;
      const double sample = m.read() - 0.5 * size * std::exp(-0.3 * k);
      ASSERT_EQ(m.step(s, l, sample), sample) << k;
    }
  }
}

TEST(EncoderCheck, ASmallWildSampleIsDoubtfulAndAnAxisThatReallyLeavesIsNot) {
  for (const double period : {1e-3, 5e-3}) {
    const SupervisionLimits l = limits(period);
    const double size = 0.5 * (l.noise + l.growth);
    for (const bool stays : {false, true}) {
      EncoderCheck::State s;
      Sine m;
      m.dt = period;
      for (; m.t < 1.0; m.t += m.dt) {
        m.step(s, l, m.read());
        ASSERT_FALSE(EncoderCheck::doubts(s)) << m.t;
      }
      EXPECT_EQ(m.step(s, l, m.read() + size), m.read() + size);
      EXPECT_TRUE(EncoderCheck::doubts(s));
      EXPECT_FALSE(EncoderCheck::bridges(s));
      m.t += m.dt;
      m.step(s, l, m.read() + (stays ? 2.0 * size : 0.0));
      EXPECT_FALSE(EncoderCheck::doubts(s));
      // One that is bridged is not doubtful as well.
      m.t += m.dt;
      m.step(s, l, 1.0);
      EXPECT_TRUE(EncoderCheck::bridges(s));
      EXPECT_FALSE(EncoderCheck::doubts(s));
    }
  }
}

TEST(EncoderCheck, AnAxisThatLeavesItsReferenceIsFollowed) {
  // From rest with all the force there is, away from a reference at rest; then the same against a friction that stops it.
  const SupervisionLimits l = limits();
  EncoderCheck::State s;
  double x = 0.0;
  double v = 0.0;
  for (int k = 0; k < 150; ++k) {
    const double a = k < 80 ? 0.25 : k < 140 ? -0.27 : 0.0;
    const double sample = 1e-7 * std::round(x / 1e-7);
    ASSERT_EQ(EncoderCheck::step(s, l, sample, 0.0, 0.0, 0.0), sample) << k;
    x += 1e-3 * v + 0.5e-6 * a;
    v += 1e-3 * a;
  }
}

TEST(EncoderCheck, AnAxisThatFrictionStopsHarderThanAnyCommandIsFollowed) {
  // Out of a slip of 3 mm/s, while the reference creeps on. A fifth more friction and 0.85 of the mass.
  for (const double period : {1e-3, 5e-3}) {
    const SupervisionLimits l = rough(period);
    EncoderCheck::State s;
    double x = 0.0;
    double v = 3e-3;
    const int slides = static_cast<int>(0.1 / period);
    for (int k = 0; k < 3 * slides; ++k) {
      const double sample = 1e-7 * std::round(x / 1e-7);
      const double r = 1e-4 * period * k;
      ASSERT_EQ(EncoderCheck::step(s, l, sample, r, 1e-4, 0.0), sample) << period << " " << k;
      const double before = v;
      if (k > slides) v = std::max(v - period * 1.2 * 200.0 / 850.0, 0.0);
      x += 0.5 * period * (before + v);
    }
    EXPECT_EQ(s.bridged, 0u);
  }
}

/// An axis of 850 kg under this force, from rest, for so many periods of 5 ms; returns the samples that were bridged.
std::uint32_t pushed_by(double force, bool told, EncoderCheck::State& s, double& x) {
  const SupervisionLimits l = rough(5e-3);
  double v = 0.0;
  for (int k = 0; k < 20; ++k) {
    EncoderCheck::step(s, l, 1e-7 * std::round(x / 1e-7), 0.0, 0.0, 0.0);
    const double now = k < 5 ? 0.0 : force;
    if (told) EncoderCheck::push(s, now);
    const double a = k < 5 ? 0.0 : (force - 200.0) / 850.0;
    x += 5e-3 * v + 0.5 * 25e-6 * a;
    v += 5e-3 * a;
    if (v > 30e-3) break;
  }
  return s.bridged;
}

TEST(EncoderCheck, AForceThatAsksForMoreThanCommandsWidensTheGateWhileItActs) {
  // 0.7 m/s², where friction that turns over makes 0.6 m/s² and commands four times 0.02 m/s².
  const double force = 800.0;
  EncoderCheck::State told, untold;
  double x = 0.0;
  double y = 0.0;
  EXPECT_EQ(pushed_by(force, true, told, x), 0u);
  EXPECT_GT(pushed_by(force, false, untold, y), 0u);
  // Once the force has gone for two windows, a sample of twice the gate is wild again.
  const SupervisionLimits l = rough(5e-3);
  EncoderCheck::State s;
  for (int k = 0; k < 20; ++k) {
    EncoderCheck::step(s, l, 0.0, 0.0, 0.0, 0.0);
    EncoderCheck::push(s, k < 10 ? force : 0.0);
  }
  EncoderCheck::step(s, l, 2.0 * (l.noise + l.growth), 0.0, 0.0, 0.0);
  EXPECT_EQ(s.bridged, 1u);
}

TEST(EncoderCheck, AnAxisThatFrictionHoldsWhileItsReferenceLeavesIsNotFrozen) {
  // A reversal at 1.4 m/s² with an encoder of 1.3 µm and 2 ms: the axis stands for 40 ms and moves by a step now and then.
  CompensationParams axis;
  axis.model.mass = 4.3;
  axis.model.friction.steady = friction::Conventional<double>{40.0, 200.0, {}};
  axis.encoder_resolution = 1.34e-6;
  SupervisionParams p;
  p.speed_limit = 1.0;
  p.acceleration_limit = 4.8;
  const SupervisionLimits l(p, axis, 390.0, 2e-3);
  EncoderCheck::State s;
  for (int k = -50; k < 20; ++k) {
    const double t = 2e-3 * k;
    const double r = -0.7 * t * t;
    // It follows until it stops, then it creeps: steps of the encoder, and none between them.
    const double x = k < 0 ? r : 0.0;
    const double sample = 1.34e-6 * std::round(x / 1.34e-6) - (k > 5 ? 1.34e-6 * (k / 6) : 0.0);
    ASSERT_EQ(EncoderCheck::step(s, l, sample, r, -1.4 * t, -1.4), sample) << k;
  }
}

TEST(EncoderCheck, AVibrationTurnsBetweenTwoEqualSamples) {
  // 1 µm at 400 Hz, ten samples a period, as a table rings on its axial mode: 6.3 m/s² of 10 m/s² that the force can do. A dropped
  // sample is bridged again once the axis has moved smoothly for two windows of 10 ms.
  CompensationParams axis;
  axis.model.mass = 100.0;
  axis.model.friction.steady = friction::Conventional<double>{20.0, 200.0, {}};
  axis.encoder_resolution = 1.8e-8;
  SupervisionParams p;
  p.speed_limit = 0.1;
  const SupervisionLimits l(p, axis, 1000.0, 2.5e-4);
  EncoderCheck::State s;
  for (int k = 0; k < 400; ++k) {
    const double size = std::min({1.0, 0.01 * k, 0.01 * (400 - k)});
    const double x = size * 1e-6 * std::cos(2.0 * kPi * (k + 0.5) / 10.0);
    const double sample = 1.8e-8 * std::round(x / 1.8e-8);
    ASSERT_EQ(EncoderCheck::step(s, l, sample, 0.0, 0.0, 0.0), sample) << k;
  }
  // Away at 2 mm/s, 28 steps of the encoder a period.
  double x = 0.0;
  double last = 0.0;
  for (int k = 0; k < 120; ++k) {
    const double moves = std::min(0.5e-6, 0.025e-6 * k);
    x += moves;
    const double sample = k == 119 ? last : 1.8e-8 * std::round(x / 1.8e-8);
    last = EncoderCheck::step(s, l, sample, x, moves / 2.5e-4, 0.0);
    ASSERT_EQ(EncoderCheck::bridges(s), k == 119) << k;
  }
}

TEST(EncoderCheck, AnAxisThatIsTooFastIsNotImplausible) {
  // The motion check is to say that it is too fast. Three times the limit is impossible.
  const SupervisionLimits l = limits();
  EncoderCheck::State s;
  double x = 0.0;
  double v = 0.0;
  for (int k = 0; v < 60e-3; ++k) {
    const double sample = 1e-7 * std::round(x / 1e-7);
    const double used = EncoderCheck::step(s, l, sample, 0.0, 0.0, 0.0);
    if (v < 2.9 * 16e-3) {
      ASSERT_EQ(used, sample) << v;
    }
    x += 1e-3 * v;
    v += 0.25e-3;
  }
  EXPECT_EQ(EncoderCheck::judge(s, l), Fault::kEncoderImplausible);
}

TEST(EncoderCheck, AReferenceThatJumpsIsNoMotionOfTheAxis) {
  const SupervisionLimits l = limits();
  EncoderCheck::State s;
  Sine m;
  for (; m.t < 1.0; m.t += m.dt) m.step(s, l, m.read());
  for (int k = 0; k < 20; ++k, m.t += m.dt)
    ASSERT_EQ(EncoderCheck::step(s, l, m.read(), m.r() + 1e-3, m.v(), m.a()), m.read()) << k;
  EXPECT_NEAR(EncoderCheck::step(s, l, kNan, m.r() + 1e-3, m.v(), m.a()), m.read(), 3e-7);
}

TEST(EncoderCheck, WhereTheReferenceJumpsTheAxisIsTakenToGoOn) {
  // It moves 2 mm/s faster than the reference, whose jump comes together with a lost sample.
  const SupervisionLimits l = limits();
  for (const double side : {1.0, -1.0}) {
    for (const double jump : {1e-3, -1e-3}) {
      EncoderCheck::State s;
      double x = 0.0;
      double r = 0.0;
      for (int k = 0; k < 100; ++k) {
        EncoderCheck::step(s, l, x, r, side * 10e-3, 0.0);
        x += side * 12e-6;
        r += side * 10e-6;
      }
      EXPECT_NEAR(EncoderCheck::step(s, l, kNan, r + jump, side * 10e-3, 0.0), x, 1e-8);
      EXPECT_NEAR(EncoderCheck::step(s, l, kNan, r + jump + side * 10e-6, side * 10e-3, 0.0),
                  x + side * 12e-6, 1e-8);
    }
  }
}

TEST(EncoderCheck, TooManyInARowAreAFault) {
  const auto count = [](const SupervisionLimits& l, double sample, bool frozen) {
    EncoderCheck::State s;
    Sine m;
    double last = 0.0;
    for (; m.t < 0.5; m.t += m.dt) last = m.step(s, l, m.read());
    for (int k = 1; k < 100; ++k, m.t += m.dt) {
      m.step(s, l, frozen ? last : m.read() + sample);
      if (const Fault f = EncoderCheck::judge(s, l); f != Fault::kNone) return std::pair(k, f);
    }
    return std::pair(0, Fault::kNone);
  };
  const SupervisionLimits l = limits();
  EXPECT_EQ(count(l, kNan, false), std::pair(11, Fault::kEncoderLost));
  EXPECT_EQ(count(l, kInfinite, false), std::pair(11, Fault::kEncoderLost));
  EXPECT_EQ(count(l, 1e-3, false), std::pair(11, Fault::kEncoderImplausible));
  EXPECT_EQ(count(l, 0.0, true), std::pair(11, Fault::kEncoderFrozen));
}

TEST(EncoderCheck, DroppedSamplesAreBridgedUpToAFifth) {
  const SupervisionLimits l = limits();
  for (const double share : {0.1, 0.3}) {
    std::mt19937 random(7);
    EncoderCheck::State s;
    Sine m;
    double last = m.read();
    double worst = 0.0;
    bool fault = false;
    for (; m.t < 1.2; m.t += m.dt) {
      if (!(m.t > 0.01 && std::uniform_real_distribution(0.0, 1.0)(random) < share)) last = m.read();
      worst = std::max(worst, std::abs(m.step(s, l, last) - m.read()));
      fault = fault || EncoderCheck::judge(s, l) == Fault::kEncoderUnreliable;
    }
    EXPECT_EQ(fault, share > 0.2) << share;
    // A dropped sample itself is up to 10 um off.
    EXPECT_LT(worst, 1.3e-6) << share;
    EXPECT_GT(s.bridged, 50u);
  }
}

TEST(EncoderCheck, DroppedSamplesAtAnySpeedDoNotDragThePrediction) {
  // Through reversals, at 5 ms, up to three in a row: there a repeated sample lies inside the gate.
  const SupervisionLimits l = limits(5e-3);
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937 random(seed);
    EncoderCheck::State s;
    Sine m;
    m.dt = 5e-3;
    double last = m.read();
    int in_a_row = 0;
    for (; m.t < 6.5; m.t += m.dt) {
      const bool dropped =
          m.t > 0.1 && in_a_row < 3 && std::uniform_real_distribution(0.0, 1.0)(random) < 0.1;
      in_a_row = dropped ? in_a_row + 1 : 0;
      if (!dropped) last = m.read();
      ASSERT_NEAR(m.step(s, l, last), m.read(), l.noise + l.growth) << "seed " << seed << " at " << m.t;
      ASSERT_EQ(EncoderCheck::judge(s, l), Fault::kNone) << "seed " << seed << " at " << m.t;
    }
  }
}

TEST(EncoderCheck, MissedPeriodsAreNotWild) {
  const SupervisionLimits l = limits();
  EncoderCheck::State s;
  Sine m;
  for (; m.t < 0.5; m.t += m.dt) m.step(s, l, m.read());
  m.t += 2.0 * m.dt;
  EXPECT_EQ(m.step(s, l, m.read(), 3), m.read());
  m.t += m.dt;
  EXPECT_EQ(m.step(s, l, m.read()), m.read());
}

TEST(EncoderCheck, OverMissedPeriodsAnAxisMayAccelerateAllTheTime) {
  // It leaves at rest with 0.24 of the 0.27 m/s² that it can do, unseen for n periods: a·(nT)²/2 away from where it stood.
  const SupervisionLimits l = limits();
  for (const int periods : {1, 3, 6}) {
    for (const double side : {1.0, -1.0}) {
      EncoderCheck::State s;
      for (int k = 0; k < 50; ++k) EncoderCheck::step(s, l, 0.0, 0.0, 0.0, 0.0);
      const double t = 1e-3 * periods;
      const double x = side * 0.5 * 0.24 * t * t;
      EXPECT_EQ(EncoderCheck::step(s, l, x, 0.0, 0.0, 0.0, periods), x) << periods;
      EXPECT_FALSE(EncoderCheck::bridges(s)) << periods;
      // Three times as far as it can get is wild.
      EncoderCheck::State wild;
      for (int k = 0; k < 50; ++k) EncoderCheck::step(wild, l, 0.0, 0.0, 0.0, 0.0);
      const double far = side * (1.1e-6 + 1.1 * 0.27 * t * t);
      EXPECT_EQ(EncoderCheck::step(wild, l, far, 0.0, 0.0, 0.0, periods), 0.0) << periods;
      EXPECT_TRUE(EncoderCheck::bridges(wild)) << periods;
    }
  }
}

TEST(EncoderCheck, AnAxisThatStandsForMonthsIsStillJudged) {
  // 25 days at 1 kHz are more samples than an int counts.
  const SupervisionLimits l = limits();
  EncoderCheck::State s;
  for (int k = 0; k < 10; ++k) EncoderCheck::step(s, l, 1e-3, 1e-3, 0.0, 0.0);
  s.same = std::numeric_limits<int>::max();
  for (int k = 0; k < 10; ++k) {
    EncoderCheck::step(s, l, 1e-3, 1e-3, 0.0, 0.0);
    ASSERT_GT(s.same, 0);
    ASSERT_EQ(s.bridged, 0u);
  }
}

TEST(EncoderCheck, IsTheSameInTheMirror) {
  const SupervisionLimits l = limits();
  EncoderCheck::State s, mirrored;
  Sine m;
  for (int k = 0; k < 2000; ++k, m.t += m.dt) {
    const double sample = k % 97 == 50 ? m.read() + 1e-3 : k % 131 == 70 ? kNan : m.read();
    const double a = m.step(s, l, sample);
    const double b = EncoderCheck::step(mirrored, l, -sample, -m.r(), -m.v(), -m.a());
    ASSERT_EQ(a, -b) << k;
  }
}

TEST(EncoderCheck, BeginsWithAMissingSample) {
  const SupervisionLimits l = limits();
  EncoderCheck::State s;
  Sine m;
  m.t = 1.0;
  EXPECT_EQ(m.step(s, l, kNan), m.r()) << "no error that nobody saw";
  m.t += m.dt;
  EXPECT_EQ(m.step(s, l, m.read()), m.read());
}

}  // namespace
}  // namespace stribeck::control::encoder_check_test
