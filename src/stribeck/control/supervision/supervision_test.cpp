// Supervision around a law: what goes out, what is latched, what rests over a bridged sample. Closed loops: tests/faults.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/control/supervision/supervisor.hpp>
#include <vector>

namespace stribeck::control::supervision_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kPeriod = 1e-3;
using Law = Contouring<2>;
using Watched = Supervised<Law, 2>;
using V = Vec<double, 2>;

Setup<2> setup(Observer observer = Observer::kDisturbance, bool adapts = false) {
  Setup<2> s;
  s.period = kPeriod;
  for (std::size_t i = 0; i < 2; ++i) {
    CompensationParams& c = s.compensation[i];
    c.model.mass = 1000.0;
    c.model.load = i == 1 ? 30.0 : 0.0;
    c.model.friction.steady = friction::Conventional<double>{20.0, 4500.0, {}};
    c.model.friction.dynamics = friction::LuGre<double>{7.2e6, 85e3, 0.05e-3};
    c.feedforward = Feedforward::kDynamic;
    c.observer = observer;
    c.adaptation.enabled = adapts;
    c.guarded = true;
    s.force_limit[i] = 250.0;
  }
  return s;
}

Supervision<2> limits() {
  Supervision<2> all;
  for (SupervisionParams& p : all) {
    p.speed_limit = 16e-3;
    p.acceleration_limit = 0.1;
  }
  return all;
}

/// 10 mm, from rest to 1 rad/s within the first second.
path::PathPoint<2> circle(double t) {
  path::PathPoint<2> r;
  const double phi = t < 1.0 ? 0.5 * t * t : t - 0.5;
  const double rate = t < 1.0 ? t : 1.0;
  const double gain = t < 1.0 ? 1.0 : 0.0;
  const double c = 10e-3 * std::cos(phi);
  const double s = 10e-3 * std::sin(phi);
  r.position = {{c, s}};
  r.velocity = {{-s * rate, c * rate}};
  r.acceleration = {{-c * rate * rate - s * gain, -s * rate * rate + c * gain}};
  return r;
}

/// Encoders of 0.1 um, with an error that changes slowly.
V read(const path::PathPoint<2>& r, double t) {
  V x;
  for (std::size_t i = 0; i < 2; ++i)
    x[i] = 1e-7 * std::round((r.position[i] + 0.2e-6 * std::sin(3.0 * t + static_cast<double>(i))) / 1e-7);
  return x;
}

/// A run of a supervised law; a break changes what it is given.
class Loop {
 public:
  explicit Loop(Observer observer = Observer::kDisturbance, bool adapts = false)
      : watched(ContouringParams::critical(60.0, 60.0), setup(observer, adapts), limits()),
        state(std::make_unique<Watched::State>()) {}

  V step(double elapsed = kNan) {
    path::PathPoint<2> r = circle(t);
    V x = read(r, t);
    x[0] += added;
    r.position[1] += command;
    t += kPeriod;
    return watched.step(*state, r, x, elapsed);
  }
  void go(int periods) {
    for (int k = 0; k < periods; ++k) step();
  }
  [[nodiscard]] Fault fault() const { return state->watch.fault; }

  Watched watched;
  std::unique_ptr<Watched::State> state;
  double t = 0.0;
  double added = 0.0;
  double command = 0.0;
};

TEST(Supervisor, SoundRunsAreThoseOfTheLawBitForBit) {
  for (const Observer observer :
       {Observer::kNone, Observer::kDisturbance, Observer::kKalman, Observer::kAdaptive}) {
    Loop run(observer, true);
    const Law law(ContouringParams::critical(60.0, 60.0), setup(observer, true));
    const auto alone = std::make_unique<Law::State>();
    for (int k = 0; k < 7000; ++k) {
      const path::PathPoint<2> r = circle(run.t);
      const V wanted = law.step(*alone, r, read(r, run.t));
      const V force = run.step();
      ASSERT_EQ(force[0], wanted[0]) << k;
      ASSERT_EQ(force[1], wanted[1]) << k;
    }
    EXPECT_EQ(run.fault(), Fault::kNone);
  }
}

TEST(Supervisor, DisabledItDoesNothing) {
  Supervision<2> off = limits();
  for (auto& p : off) p.checks = Checks::kNone;
  const Watched watched(ContouringParams::critical(60.0, 60.0), setup(), off);
  const Law law(ContouringParams::critical(60.0, 60.0), setup());
  Watched::State s;
  Law::State alone;
  for (int k = 0; k < 200; ++k) {
    path::PathPoint<2> r = circle(kPeriod * k);
    V x = read(r, kPeriod * k);
    if (k % 10 == 7) x[0] = kNan;
    if (k % 10 == 8) x[0] = 1.0;
    const V a = watched.step(s, r, x);
    const V b = law.step(alone, r, x);
    ASSERT_EQ(a[0], b[0]);
    ASSERT_EQ(a[1], b[1]);
  }
}

TEST(Supervisor, WithTheChecksOfLossAloneTheLawAnswersUntilItIsAFault) {
  Supervision<2> lost;
  for (auto& p : lost) p.checks = Checks::kLost;
  const Watched watched(ContouringParams::critical(60.0, 60.0), setup(), lost);
  for (const bool command : {false, true}) {
    const auto s = std::make_unique<Watched::State>();
    V last;
    for (int k = 0; k < 300; ++k) {
      path::PathPoint<2> r = circle(kPeriod * k);
      V x = read(r, kPeriod * k);
      if (k >= 200 && command) r.velocity[1] = kNan;
      if (k >= 200 && !command) x[1] = kNan;
      const V force = watched.step(*s, r, x);
      if (k >= 200 && k < 210) {
        EXPECT_EQ(force[0], last[0]) << k;
        EXPECT_EQ(force[1], last[1]) << k;
        EXPECT_EQ(s->watch.fault, Fault::kNone);
      }
      last = force;
    }
    EXPECT_EQ(s->watch.fault, command ? Fault::kCommandLost : Fault::kEncoderLost);
    EXPECT_EQ(last[0], 0.0);
    EXPECT_EQ(last[1], 30.0);
  }
}

TEST(Supervisor, ABridgedSampleLeavesEveryEstimateAsItWas) {
  for (const Observer observer : {Observer::kDisturbance, Observer::kKalman, Observer::kAdaptive}) {
    Loop run(observer, true);
    run.go(3000);
    const auto& c = run.state->law.compensation[0];
    const double estimate = c.estimate;
    const auto theta = c.adaptation.theta;
    const auto p = c.adaptation.p;
    run.added = kNan;
    run.step();
    EXPECT_EQ(c.estimate, estimate);
    for (std::size_t i = 0; i < FrictionRls::kCount; ++i) {
      EXPECT_EQ(c.adaptation.theta[i], theta[i]);
      EXPECT_EQ(c.adaptation.p[i][i], p[i][i]);
    }
    EXPECT_EQ(run.state->watch.axes[0].encoder.bridged, 1u);
    EXPECT_EQ(run.state->watch.axes[1].encoder.bridged, 0u);
    EXPECT_FALSE(run.state->law.bridged[1]);
    run.added = 0.0;
    run.step();
    EXPECT_FALSE(run.state->law.bridged[0]);
  }
}

TEST(Supervisor, AdaptationRestsOverASmallWildSampleAndObserversDoNot) {
  for (const Observer observer : {Observer::kDisturbance, Observer::kKalman, Observer::kAdaptive}) {
    Loop run(observer, true);
    run.go(3000);
    const auto& c = run.state->law.compensation[0];
    const double estimate = c.estimate;
    const auto theta = c.adaptation.theta;
    const double other = run.state->law.compensation[1].adaptation.theta[FrictionRls::kPositive];
    // Within the gate of 1.27 um, beyond a quarter of it.
    run.added = 0.8e-6;
    run.step();
    EXPECT_TRUE(run.state->law.doubtful[0]);
    EXPECT_FALSE(run.state->law.bridged[0]);
    EXPECT_FALSE(run.state->law.doubtful[1]);
    EXPECT_NE(c.estimate, estimate);
    for (std::size_t i = 0; i < FrictionRls::kCount; ++i) EXPECT_EQ(c.adaptation.theta[i], theta[i]);
    EXPECT_NE(run.state->law.compensation[1].adaptation.theta[FrictionRls::kPositive], other);
    EXPECT_EQ(run.state->watch.axes[0].encoder.bridged, 0u);
    run.added = 0.0;
    run.step();
    EXPECT_FALSE(run.state->law.doubtful[0]);
  }
}

TEST(Supervisor, UntilTheSignIsProvenTheForceIsCutAndTheLawKnows) {
  const Watched watched(ContouringParams::critical(300.0, 300.0), setup(), limits());
  const auto s = std::make_unique<Watched::State>();
  // The first axis is where it should not be, and stays there.
  path::PathPoint<2> r;
  r.position = {{2e-6, 0.0}};
  V force = watched.step(*s, r, V{});
  r.position[0] = 300e-6;
  force = watched.step(*s, r, V{});
  EXPECT_EQ(s->watch.fault, Fault::kNone);
  EXPECT_EQ(force[0], 125.0);
  EXPECT_EQ(s->law.force[0], 125.0);
  EXPECT_EQ(s->law.compensation[0].force[0], 125.0);
  EXPECT_TRUE(s->law.compensation[0].limited);
  EXPECT_TRUE(s->watch.axes[0].cut);
  EXPECT_FALSE(s->law.compensation[1].limited);
  EXPECT_EQ(s->watch.force[0], 125.0);
  s->watch.axes[0].proof.proven = true;
  EXPECT_GT(watched.step(*s, r, V{})[0], 125.0);
  EXPECT_FALSE(s->watch.axes[0].cut);
  // Each start has to prove it anew.
  watched.reset(*s);
  EXPECT_FALSE(s->watch.axes[0].proof.proven);
}

TEST(Supervisor, AWildSampleLeavesNothingBehind) {
  // Against the same run without it: forces come back, and what was learned, up to 0.22, is the same to a hundredth.
  for (const Observer observer : {Observer::kDisturbance, Observer::kKalman, Observer::kAdaptive}) {
    Loop with(observer, true);
    Loop without(observer, true);
    with.go(3000);
    without.go(3000);
    with.added = 1.0;
    with.step();
    without.step();
    with.added = 0.0;
    for (int k = 0; k < 200; ++k) {
      with.step();
      without.step();
    }
    const V a = with.step();
    const V b = without.step();
    EXPECT_NEAR(a[0], b[0], 0.2);
    for (std::size_t i = 0; i < FrictionRls::kCount; ++i)
      EXPECT_NEAR(with.state->law.compensation[0].adaptation.theta[i],
                  without.state->law.compensation[0].adaptation.theta[i], 2e-3);
  }
}

TEST(Supervisor, ALostEncoderStopsAllAxesWithinTheStopTimeAndStays) {
  Loop run;
  run.go(2000);
  run.added = kNan;
  int periods = 0;
  while (!Supervisor<2>::safe(run.state->watch) && periods < 1000) {
    run.step();
    ++periods;
  }
  EXPECT_EQ(run.fault(), Fault::kEncoderLost);
  EXPECT_EQ(run.state->watch.axis, 0u);
  EXPECT_LE(periods, 50);
  EXPECT_TRUE(Supervisor<2>::brake_requested(run.state->watch));
  // The weight of the second axis is held until its brake has closed.
  EXPECT_EQ(run.step()[0], 0.0);
  EXPECT_EQ(run.step()[1], 30.0);
  run.added = 0.0;
  run.go(100);
  EXPECT_EQ(run.fault(), Fault::kEncoderLost) << "latched";
  EXPECT_EQ(run.state->watch.counts[static_cast<std::size_t>(Fault::kEncoderLost)], 1u);
  run.watched.reset(*run.state);
  EXPECT_EQ(run.fault(), Fault::kNone);
  run.go(100);
  EXPECT_EQ(run.fault(), Fault::kNone);
  EXPECT_EQ(run.state->watch.counts[static_cast<std::size_t>(Fault::kEncoderLost)], 1u);
}

TEST(Supervisor, TheStopTimeOfASoundAxisCountsFromTheFirstBadSampleToo) {
  Loop run;
  run.go(3640);  // the second axis is at its full speed
  run.added = kNan;
  for (int k = 0; k < 50; ++k) run.step();
  EXPECT_EQ(run.fault(), Fault::kEncoderLost);
  EXPECT_TRUE(Supervisor<2>::safe(run.state->watch));
}

TEST(Supervisor, WhatWasLearnedSecondsAgoIsKeptOverAFault) {
  Loop run(Observer::kDisturbance, true);
  // The first axis moves in the negative direction alone at first, the second one in the positive direction.
  std::vector<double> history;
  std::vector<double> of_second;
  const auto& second = run.state->law.compensation[1].adaptation.theta[FrictionRls::kPositive];
  for (int k = 0; k < 3600; ++k) {
    run.step();
    history.push_back(run.state->law.compensation[0].adaptation.theta[FrictionRls::kNegative]);
    of_second.push_back(second);
  }
  run.added = kNan;
  run.go(20);
  ASSERT_EQ(run.fault(), Fault::kEncoderLost);
  run.added = 0.0;
  run.watched.reset(*run.state);
  const auto& s = run.state->law.compensation[0].adaptation;
  EXPECT_TRUE(s.recalled);
  const double kept = s.theta[FrictionRls::kNegative];
  EXPECT_NE(kept, 0.0);
  const auto when = std::find(history.begin(), history.end(), kept);
  ASSERT_NE(when, history.end());
  EXPECT_GE(history.end() - when, 1000);
  EXPECT_LE(history.end() - when, 2010);
  EXPECT_NE(second, 0.0);
  EXPECT_EQ(second, of_second[static_cast<std::size_t>(when - history.begin())]);
  const auto recalled = s.theta;
  run.go(1);
  for (std::size_t i = 0; i < FrictionRls::kCount; ++i) EXPECT_EQ(s.theta[i], recalled[i]);
  // So does a second fault at once, and a reset that follows a reset.
  run.added = kNan;
  run.go(20);
  ASSERT_EQ(run.fault(), Fault::kEncoderLost);
  run.added = 0.0;
  run.watched.reset(*run.state);
  for (std::size_t i = 0; i < FrictionRls::kCount; ++i) EXPECT_EQ(s.theta[i], recalled[i]);
  run.watched.reset(*run.state);
  for (std::size_t i = 0; i < FrictionRls::kCount; ++i) EXPECT_EQ(s.theta[i], recalled[i]);
  // And without a fault, reset forgets.
  run.go(3000);
  run.watched.reset(*run.state);
  EXPECT_EQ(s.theta[FrictionRls::kNegative], 0.0);
}

TEST(Supervisor, BeforeTheSecondStoreThereIsNothingToRecall) {
  // What was stored last may hold the fault already, so it is not taken; the one before has not been stored yet.
  Loop run(Observer::kDisturbance, true);
  run.go(1600);
  run.added = kNan;
  run.go(20);
  ASSERT_EQ(run.fault(), Fault::kEncoderLost);
  run.watched.reset(*run.state);
  EXPECT_FALSE(run.state->law.compensation[0].adaptation.recalled);
}

TEST(Supervisor, EveryNumberOfAReferenceIsLookedAt) {
  for (std::size_t i = 0; i < 2; ++i) {
    for (int part = 0; part < 6; ++part) {
      const Watched watched(ContouringParams::critical(60.0, 60.0), setup(), limits());
      const auto s = std::make_unique<Watched::State>();
      for (int k = 0; k < 5; ++k) watched.step(*s, circle(kPeriod * k), read(circle(kPeriod * k), 0.0));
      path::PathPoint<2> r = circle(5.0 * kPeriod);
      const V x = read(r, 0.0);
      if (part == 0) r.position[i] = kNan;
      if (part == 1) r.velocity[i] = kNan;
      if (part == 2) r.acceleration[i] = kNan;
      if (part == 3) r.frame[i][1 - i] = kNan;
      if (part == 4) r.frame_rate[1 - i][i] = kNan;
      if (part == 5) r.frame_acceleration[i][i] = kNan;
      const V force = watched.step(*s, r, x);
      EXPECT_EQ(s->watch.commands_lost, 1u) << i << ' ' << part;
      EXPECT_EQ(s->law.status.count(Status::kNotFinite), 0u) << "the law gets the reference that goes on";
      EXPECT_TRUE(std::isfinite(force[0]) && std::isfinite(force[1]));
    }
  }
}

TEST(Supervisor, AReferenceThatIsNoNumberGoesOnForAWhile) {
  Loop run;
  Loop sound;
  run.go(1500);
  sound.go(1500);
  run.command = kNan;
  for (int k = 0; k < 10; ++k) EXPECT_NEAR(run.step()[1], sound.step()[1], 3.0) << k;
  EXPECT_EQ(run.state->watch.commands_lost, 10u);
  EXPECT_EQ(run.fault(), Fault::kNone);
  run.step();
  EXPECT_EQ(run.fault(), Fault::kCommandLost);
}

TEST(Supervisor, LateStepsAreCountedAndTooLateOnesAreAFault) {
  Loop run;
  run.go(100);
  run.t += kPeriod;
  run.step(2.0 * kPeriod);
  EXPECT_EQ(run.state->watch.late, 1u);
  EXPECT_EQ(run.fault(), Fault::kNone);
  run.step(1.2 * kPeriod);
  EXPECT_EQ(run.state->watch.late, 1u);
  run.t += 11.0 * kPeriod;
  run.step(12.0 * kPeriod);
  EXPECT_EQ(run.fault(), Fault::kLate);
  Loop often;
  often.go(100);
  for (int k = 0; k < 11; ++k) {
    often.t += kPeriod;
    often.step(2.0 * kPeriod);
  }
  EXPECT_EQ(often.fault(), Fault::kLate);
}

// Lateness and the reference belong to all axes: the strictest checks of any of them hold, whichever axis is the first.
TEST(Supervisor, TheStrictestChecksOfAnyAxisHoldForLatenessAndReference) {
  const auto state = std::make_unique<Watched::State>();
  const auto fault_of = [&](Checks first, Checks second, bool late, int periods, double bridge_time = 10e-3) {
    Supervision<2> p = limits();
    p[0].checks = first;
    p[1].checks = second;
    p[1].bridge_time = bridge_time;
    const Watched watched(ContouringParams::critical(60.0, 60.0), setup(), p);
    std::construct_at(state.get());
    for (int k = 0; k < 300 + periods; ++k) {
      path::PathPoint<2> r = circle(1e-3 * k);
      const V x = read(r, 1e-3 * k);
      if (!late && k >= 300) r.position[1] = kNan;
      watched.step(*state, r, x, late && k >= 300 ? 2.0 * kPeriod : kNan);
    }
    return state->watch.fault;
  };
  using enum Checks;
  for (const bool swapped : {false, true}) {
    const auto of = [&](Checks a, Checks b, bool late, int periods) {
      return swapped ? fault_of(b, a, late, periods) : fault_of(a, b, late, periods);
    };
    EXPECT_EQ(of(kNone, kAll, false, 10), Fault::kNone);
    EXPECT_EQ(of(kNone, kAll, false, 11), Fault::kCommandLost);
    EXPECT_EQ(of(kNone, kLost, false, 11), Fault::kCommandLost);
    EXPECT_EQ(of(kNone, kNone, false, 50), Fault::kNone);
    EXPECT_EQ(of(kLost, kAll, true, 11), Fault::kLate);
    EXPECT_EQ(of(kLost, kLost, true, 50), Fault::kNone);
  }
  // The shortest time for which any axis may be bridged.
  EXPECT_EQ(fault_of(kAll, kAll, false, 4, 4e-3), Fault::kNone);
  EXPECT_EQ(fault_of(kAll, kAll, false, 5, 4e-3), Fault::kCommandLost);
}

TEST(Supervisor, LatenessWithoutEndIsCountedWithoutOverflow) {
  Supervision<2> lost;
  for (auto& p : lost) p.checks = Checks::kLost;
  const Watched watched(ContouringParams::critical(60.0, 60.0), setup(), lost);
  Watched::State s;
  watched.step(s, circle(0.0), read(circle(0.0), 0.0));
  s.watch.late_in_a_row = std::numeric_limits<int>::max();
  s.watch.late = UINT32_MAX;
  watched.step(s, circle(0.0), read(circle(0.0), 0.0), 3.0 * kPeriod);
  EXPECT_GT(s.watch.late_in_a_row, 0);
  EXPECT_EQ(s.watch.late, UINT32_MAX);
  EXPECT_EQ(s.watch.fault, Fault::kNone);
}

/// Two axes that differ in all that supervision looks at; the second machine has them in the other order.
template <bool kSwapped>
struct Unlike {
  Unlike() : watched(ContouringParams::critical(60.0, 60.0), axes(), checks()) {}
  static constexpr std::size_t place(std::size_t axis) { return kSwapped ? 1 - axis : axis; }
  static Setup<2> axes() {
    Setup<2> s = setup(Observer::kDisturbance, true);
    CompensationParams& y = s.compensation[1];
    y.model.mass = 600.0;
    y.model.friction.steady = friction::Conventional<double>{35.0, 2500.0, {}};
    y.encoder_resolution = 2e-7;
    y.adaptation.enabled = false;
    s.force_limit[1] = 180.0;
    if (kSwapped) std::swap(s.compensation[0], s.compensation[1]);
    if (kSwapped) std::swap(s.force_limit[0], s.force_limit[1]);
    return s;
  }
  static Supervision<2> checks() {
    Supervision<2> p = limits();
    p[1].speed_limit = 11e-3;
    p[1].acceleration_limit = 0.07;
    p[1].start_share = 0.7;
    if (kSwapped) std::swap(p[0], p[1]);
    return p;
  }
  /// Forces in the order of the first machine.
  V step(path::PathPoint<2> r, V x) {
    if (kSwapped) {
      for (V* v : {&r.position, &r.velocity, &r.acceleration, &x}) std::swap((*v)[0], (*v)[1]);
    }
    const V f = watched.step(state, r, x);
    return {{f[place(0)], f[place(1)]}};
  }
  Watched watched;
  Watched::State state;
};

TEST(Supervisor, WhichAxisIsTheFirstDoesNotMatter) {
  // What happens to one of the axes: nothing, samples that are lost, wild or frozen, and a step of the reference.
  enum class Event { kNothing, kLost, kWild, kSmall, kFrozen, kStep };
  for (const Event event :
       {Event::kNothing, Event::kLost, Event::kWild, Event::kSmall, Event::kFrozen, Event::kStep}) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto one = std::make_unique<Unlike<false>>();
      const auto other = std::make_unique<Unlike<true>>();
      V last;
      for (int k = 0; k < 2600; ++k) {
        path::PathPoint<2> r = circle(kPeriod * k);
        V x = read(r, kPeriod * k);
        const bool rare = k % 97 == 50;
        if (event == Event::kLost && (rare || k > 2300)) x[axis] = kNan;
        if (event == Event::kWild && (rare || k > 2300)) x[axis] += 1e-3;
        if (event == Event::kSmall && rare) x[axis] += 0.8e-6;
        if (event == Event::kFrozen && k > 2300) x[axis] = last[axis];
        if (event == Event::kStep && k < 3) r.position[axis] += 0.2e-3;
        last = x;
        const V force = one->step(r, x);
        const V swapped = other->step(r, x);
        const auto& a = one->state;
        const auto& b = other->state;
        // An axis that is checked after the one with the fault brakes from its velocity of the period before.
        const double near = a.watch.fault == Fault::kNone ? 1e-9 : 0.5;
        ASSERT_NEAR(force[0], swapped[0], near) << k;
        ASSERT_NEAR(force[1], swapped[1], near) << k;
        ASSERT_EQ(a.watch.fault, b.watch.fault) << k;
        ASSERT_EQ(a.watch.quiet, b.watch.quiet) << k;
        for (std::size_t i = 0; i < 2; ++i) {
          ASSERT_EQ(a.law.bridged[i], b.law.bridged[1 - i]) << k;
          ASSERT_EQ(a.law.doubtful[i], b.law.doubtful[1 - i]) << k;
          ASSERT_EQ(a.law.cut[i], b.law.cut[1 - i]) << k;
          if (a.watch.fault == Fault::kNone) {
            ASSERT_NEAR(a.law.force[i], b.law.force[1 - i], 1e-9) << k;
            ASSERT_EQ(a.watch.axes[i].encoder.reference, b.watch.axes[1 - i].encoder.reference) << k;
            ASSERT_NEAR(a.watch.axes[i].encoder.pushed[0], b.watch.axes[1 - i].encoder.pushed[0], 1e-9) << k;
          }
          ASSERT_EQ(a.watch.axes[i].motion.still_periods, b.watch.axes[1 - i].motion.still_periods) << k;
          ASSERT_EQ(a.watch.axes[i].motion.anchor, b.watch.axes[1 - i].motion.anchor) << k;
          ASSERT_EQ(a.watch.axes[i].proof.proven, b.watch.axes[1 - i].proof.proven) << k;
        }
      }
      const bool stops = event == Event::kLost || event == Event::kWild || event == Event::kFrozen;
      EXPECT_EQ(one->state.watch.fault != Fault::kNone, stops);
      if (stops) {
        EXPECT_EQ(one->state.watch.axis, axis);
        EXPECT_EQ(other->state.watch.axis, 1 - axis);
        EXPECT_EQ(one->watched.supervisor().limits(axis).force,
                  other->watched.supervisor().limits(1 - axis).force);
      }
      one->watched.reset(one->state);
      other->watched.reset(other->state);
      for (std::size_t k = 0; k < 2; ++k) {
        const auto& a = one->state.law.compensation[k].adaptation;
        const auto& b = other->state.law.compensation[1 - k].adaptation;
        EXPECT_EQ(a.recalled, b.recalled);
        for (std::size_t i = 0; i < FrictionRls::kCount; ++i) EXPECT_NEAR(a.theta[i], b.theta[i], 1e-9);
      }
    }
  }
}

TEST(Supervisor, ItIsSafeOnceTheForcesStayWhatTheyAre) {
  // At places of the circle where one axis or both move fast: one stops by itself before the other.
  for (const int periods : {2000, 2800, 3640, 5000}) {
    Loop run;
    run.go(periods);
    EXPECT_FALSE(Supervisor<2>::safe(run.state->watch)) << "it runs";
    run.added = kNan;
    bool was_safe = false;
    for (int k = 0; k < 80; ++k) {
      const V force = run.step();
      const bool safe = Supervisor<2>::safe(run.state->watch);
      EXPECT_TRUE(safe || !was_safe);
      if (safe) {
        EXPECT_EQ(force[0], 0.0) << periods << ' ' << k;
        EXPECT_EQ(force[1], 30.0) << periods << ' ' << k;
      }
      was_safe = safe;
    }
    EXPECT_TRUE(was_safe);
  }
}

TEST(Supervisor, AnEncoderThatNeverSaidAnythingIsNoReasonToBrake) {
  Loop run;
  run.added = kNan;
  double most = 0.0;
  for (int k = 0; k < 80; ++k) most = std::max(most, std::abs(run.step()[0]));
  EXPECT_EQ(run.fault(), Fault::kEncoderLost);
  // What the law itself asked for in the first periods of the run-in, and no force against a motion that nobody saw.
  EXPECT_LT(most, 40.0);
}

TEST(Supervisor, ALateStepMayTakeAsLongAsSamplesAreBridged) {
  // Ten periods, rounded to whole ones.
  for (const double periods : {9.6, 10.4, 10.6}) {
    Loop run;
    run.go(100);
    run.t += (std::round(periods) - 1.0) * kPeriod;
    run.step(periods * kPeriod);
    EXPECT_EQ(run.fault(), periods < 10.5 ? Fault::kNone : Fault::kLate) << periods;
  }
}

TEST(Supervisor, NothingIsStoredWhileAnAxisIsBridgedOrAtItsLimit) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    Loop run(Observer::kDisturbance, true);
    run.go(500);
    const int& quiet = run.state->watch.quiet;
    const int before = quiet;
    run.step();
    EXPECT_EQ(quiet, before + 1);
    path::PathPoint<2> r = circle(run.t);
    V x = read(r, run.t);
    x[axis] = kNan;
    run.watched.step(*run.state, r, x);
    EXPECT_EQ(quiet, before + 1) << "bridged";
    run.t += kPeriod;
    r = circle(run.t);
    r.acceleration[axis] = 1.0;  // of 0.25 m/s²
    run.watched.step(*run.state, r, read(r, run.t));
    EXPECT_EQ(quiet, before + 1) << "limited";
    run.t += kPeriod;
    run.go(5);  // the first of them brakes what the last one began
    EXPECT_GT(quiet, before + 1);
    EXPECT_EQ(run.fault(), Fault::kNone);
  }
}

TEST(Supervisor, AfterAResetItIsAsNew) {
  // A wild history, then a reset: the same as a controller that has just been made, force by force.
  Loop used;
  used.go(1500);
  used.added = 1e-3;
  used.go(3);
  used.added = 0.0;
  used.step(2.0 * kPeriod);
  used.command = kNan;
  used.go(4);
  used.command = 0.0;
  used.go(300);
  used.added = kNan;
  used.go(60);
  ASSERT_EQ(used.fault(), Fault::kEncoderLost);
  used.added = 0.0;
  used.watched.reset(*used.state);
  Loop fresh;
  used.t = fresh.t = 0.7;
  for (int k = 0; k < 1200; ++k) {
    // A late step, a lost sample and a lost reference at the beginning as well.
    used.added = fresh.added = k == 9 ? kNan : 0.0;
    used.command = fresh.command = k == 12 ? kNan : 0.0;
    const double elapsed = k == 5 ? 2.0 * kPeriod : kNan;
    const V a = used.step(elapsed);
    const V b = fresh.step(elapsed);
    ASSERT_EQ(a[0], b[0]) << k;
    ASSERT_EQ(a[1], b[1]) << k;
  }
  EXPECT_EQ(used.fault(), Fault::kNone);
}

TEST(Supervisor, EveryFaultHasANameAndAWayOut) {
  for (std::size_t i = 0; i < kFaults; ++i) {
    const auto f = static_cast<Fault>(i);
    EXPECT_FALSE(name_of(f).empty());
    EXPECT_FALSE(describe(f).empty());
    EXPECT_EQ(reaction(f) == Reaction::kNone, f == Fault::kNone);
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(name_of(f), name_of(static_cast<Fault>(k)));
  }
}

}  // namespace
}  // namespace stribeck::control::supervision_test
