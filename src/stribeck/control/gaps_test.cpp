// Periods without a sample: one that is NaN, one that supervision bridged, a cycle that the host missed. Observers must take the motion of
// two periods for what it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/control/laws/learning.hpp>
#include <stribeck/control/laws/pid.hpp>
#include <stribeck/control/laws/repetitive.hpp>
#include <stribeck/control/laws/zpetc.hpp>
#include <stribeck/control/supervision/supervisor.hpp>
#include <vector>

namespace stribeck::control::gaps_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kPeriod = 1e-3;
constexpr double kMass = 100.0;
constexpr double kFriction = 30.0;
using Law = Contouring<1>;
using Watched = Supervised<Law, 1>;

constexpr std::array kObservers{Observer::kNone, Observer::kDisturbance, Observer::kKalman,
                                Observer::kAdaptive};

Setup<1> setup(Observer observer, double delay = 0.0) {
  Setup<1> s;
  s.period = kPeriod;
  CompensationParams& c = s.compensation[0];
  c.model.mass = kMass;
  c.model.friction.steady = friction::Conventional<double>{kFriction, 0.0, {}};
  c.feedforward = Feedforward::kSteady;
  c.observer = observer;
  c.observer_pole = 40.0;
  c.model.delay = delay;
  s.force_limit = {{2000.0}};
  return s;
}

/// 0.28 m/s in the middle of a stroke.
path::PathPoint<1> stroke(double t) {
  path::PathPoint<1> r;
  r.position = {{0.2 * (1.0 - std::cos(1.5 * t))}};
  r.velocity = {{0.3 * std::sin(1.5 * t)}};
  r.acceleration = {{0.45 * std::cos(1.5 * t)}};
  return r;
}

/// What becomes of one sample.
struct Period {
  double sample = 0.0;    ///< [m]
  bool missed = false;    ///< the host does not call the law
  double elapsed = kNan;  ///< that it tells [s]
};

struct Motion {
  std::vector<double> force;  ///< that acted [N]
  double worst = 0.0;         ///< error from `from` on [m]
  FrictionRls::Vector theta;  ///< what adaptation has learned at the end
};

/// The axis follows the stroke from the middle of its acceleration on; `trouble` changes single periods.
Motion follow(const Setup<1>& s, Checks checks, ErrorRate form, int from,
              const std::function<void(int, Period&)>& trouble) {
  SupervisionParams limits;
  limits.checks = checks;
  limits.start_share = 1.0;
  ContouringParams gains = ContouringParams::critical(60.0, 60.0);
  gains.error_rate = form;
  const Watched law(gains, s, {limits});
  const auto state = std::make_unique<Watched::State>();
  constexpr double kBegin = 0.3;
  constexpr int kDelay = 8;
  std::array<double, kDelay + 1> waiting{};
  const auto late = static_cast<std::size_t>(std::lround(s.compensation[0].delay() / kPeriod));
  double x = stroke(kBegin).position[0];
  double v = stroke(kBegin).velocity[0];
  waiting.fill(kFriction + kMass * stroke(kBegin).acceleration[0]);
  Motion run;
  for (int k = 0; k < 700; ++k) {
    const path::PathPoint<1> r = stroke(kBegin + kPeriod * k);
    Period period{1e-7 * std::round(x / 1e-7), false, kNan};
    trouble(k, period);
    for (std::size_t i = kDelay; i > 0; --i) waiting[i] = waiting[i - 1];
    if (!period.missed) waiting[0] = law.step(*state, r, {{period.sample}}, period.elapsed)[0];
    EXPECT_EQ(state->watch.fault, Fault::kNone) << k;
    if (k >= from) run.worst = std::max(run.worst, std::abs(x - r.position[0]));
    run.force.push_back(waiting[late]);
    const double a = (waiting[late] - kFriction) / kMass;
    x += kPeriod * (v + 0.5 * kPeriod * a);
    v += kPeriod * a;
  }
  run.theta = state->law.compensation[0].adaptation.theta;
  return run;
}

/// Largest difference of the forces that acted [N].
double apart(const Motion& a, const Motion& b) {
  double most = 0.0;
  for (std::size_t k = 0; k < a.force.size(); ++k) most = std::max(most, std::abs(a.force[k] - b.force[k]));
  return most;
}

void nothing(int, Period&) {}

/// Every kind of observer, differences of both forms, forces that come at once and two periods late. `most`: difference of forces, of which
/// the second differences of the encoder's step are 10 N.
void expect_no_jump(Checks checks, int at, const std::function<void(int, Period&)>& trouble, double most,
                    double farthest) {
  for (const double delay : {0.0, 2.0 * kPeriod}) {
    for (const Observer observer : kObservers) {
      for (const ErrorRate form : {ErrorRate::kDifferenceOfError, ErrorRate::kLate, ErrorRate::kObserved}) {
        if (form == ErrorRate::kObserved && observer != Observer::kKalman) continue;
        const Setup<1> s = setup(observer, delay);
        const Motion sound = follow(s, checks, form, at, nothing);
        const Motion run = follow(s, checks, form, at, trouble);
        EXPECT_LT(apart(run, sound), most)
            << static_cast<int>(observer) << ' ' << static_cast<int>(form) << ' ' << delay;
        EXPECT_LT(run.worst, sound.worst + farthest)
            << static_cast<int>(observer) << ' ' << static_cast<int>(form) << ' ' << delay;
      }
    }
  }
}

constexpr int kAt = 400;

// The held force of a NaN is that of an accelerated stroke: it differs by some newtons itself. Taken for motion, two periods made a force
// of m·v/T·(1 − exp(−K·T)): 556 N.
TEST(Gaps, ASampleThatIsNanIsNoMotionOfTwoPeriods) {
  for (const int length : {1, 2, 5})
    expect_no_jump(
        Checks::kLost, kAt,
        [length](int k, Period& p) {
          if (k >= kAt && k < kAt + length) p.sample = kNan;
        },
        8.0 + 2.0 * length, 1.0e-6);
}

TEST(Gaps, AMissedCycleThatTheHostTellsIsNoMotionOfTwoPeriods) {
  for (const Checks checks : {Checks::kNone, Checks::kLost, Checks::kAll})
    for (const int length : {1, 2})
      expect_no_jump(
          checks, kAt,
          [length](int k, Period& p) {
            if (k >= kAt && k < kAt + length) p.missed = true;
            if (k == kAt + length) p.elapsed = (1 + length) * kPeriod;
          },
          8.0 + 2.0 * length, 1.0e-6);
}

TEST(Gaps, ABridgedSampleIsNoMotionOfTwoPeriods) {
  expect_no_jump(
      Checks::kAll, kAt,
      [](int k, Period& p) {
        if (k == kAt) p.sample = kNan;
      },
      10.0, 1.0e-6);
}

// The model of the adaptation goes on with the reference: the force of two periods must not meet the motion of one.
TEST(Gaps, AdaptationLearnsNothingFromAGap) {
  auto s = setup(Observer::kDisturbance);
  CompensationParams& c = s.compensation[0];
  c.model.friction.dynamics = friction::LuGre<double>{1e7, 0.0, {}};
  c.feedforward = Feedforward::kDynamic;
  c.adaptation.enabled = true;
  const auto sample = [](int k, Period& p) {
    if (k % 100 == 50) p.sample = kNan;
  };
  const auto cycle = [](int k, Period& p) {
    p.missed = k % 100 == 50;
    if (k % 100 == 51) p.elapsed = 2.0 * kPeriod;
  };
  const Motion sound = follow(s, Checks::kLost, ErrorRate::kDifferenceOfError, kAt, nothing);
  for (const std::function<void(int, Period&)>& trouble :
       {std::function<void(int, Period&)>(sample), std::function<void(int, Period&)>(cycle)}) {
    const Motion run = follow(s, Checks::kLost, ErrorRate::kDifferenceOfError, kAt, trouble);
    for (std::size_t i = 0; i < FrictionRls::kCount; ++i)
      EXPECT_NEAR(run.theta[i], sound.theta[i], 0.02) << i;
  }
}

TEST(Gaps, AfterALongGapTheMotionIsSeenAnewFromTwoSamples) {
  // 20 ms with the force held; the axis is off by a·t²/2 of 0.09 mm at most, and comes back as after any error of that size.
  const auto trouble = [](int k, Period& p) {
    if (k >= kAt && k < kAt + 20) p.missed = true;
    if (k == kAt + 20) p.elapsed = 21.0 * kPeriod;
  };
  const Motion bare =
      follow(setup(Observer::kNone), Checks::kLost, ErrorRate::kDifferenceOfError, kAt, trouble);
  // No rate is taken from the first sample: 0.09 mm ask for 32 N.
  EXPECT_NEAR(bare.force[kAt + 20], bare.force[kAt + 19], 60.0);
  for (const Observer observer : kObservers) {
    const Motion run = follow(setup(observer), Checks::kLost, ErrorRate::kDifferenceOfError, kAt, trouble);
    EXPECT_LT(run.worst, 3.0 * bare.worst) << static_cast<int>(observer);
    EXPECT_LT(apart(run, bare), 60.0) << static_cast<int>(observer);
  }
}

// Its first sample is bridged: the observers waited for a second one that never counted, and m·v became a force of 520 N.
TEST(Gaps, AnAxisInMotionIsTakenOverAlsoWhereItsFirstSamplesAreBad) {
  for (const Observer observer : kObservers) {
    for (const int first : {0, 1, 2}) {
      const auto trouble = [first](int k, Period& p) {
        if (k == first) p.sample = kNan;
      };
      const Motion run = follow(setup(observer), Checks::kAll, ErrorRate::kDifferenceOfError, 0, trouble);
      double most = 0.0;
      for (const double f : run.force) most = std::max(most, std::abs(f));
      EXPECT_LT(most, 110.0) << static_cast<int>(observer) << ' ' << first;
      EXPECT_LT(run.worst, 2e-6) << static_cast<int>(observer) << ' ' << first;
    }
  }
}

TEST(Gaps, TheDifferenceOverSeveralPeriodsIsCarriedOnToItsEnd) {
  // x = 3t²: 6t is the velocity, that of a backward difference half a period earlier.
  const auto x = [](int k) { return 3.0 * (k * kPeriod) * (k * kPeriod); };
  for (const int gap : {0, 1, 4}) {
    TrackingError e;
    for (const int k : {0, 1, 2}) e.update(x(k), 0.0, 0.0, kPeriod, ErrorRate::kDifferenceOfError);
    e.missed = gap;
    e.update(x(3 + gap), 0.0, 0.0, kPeriod, ErrorRate::kDifferenceOfError);
    EXPECT_NEAR(e.velocity, 6.0 * (2.5 + gap) * kPeriod, 1e-12) << gap;
    EXPECT_NEAR(e.rate, e.velocity, 1e-12) << gap;
    EXPECT_EQ(e.missed, 0);
  }
  // The second sample has no velocity before it: the mean stands.
  TrackingError e;
  e.update(0.0, 0.0, 0.0, kPeriod, ErrorRate::kDifferenceOfError);
  e.missed = 1;
  e.update(1e-3, 0.0, 0.0, kPeriod, ErrorRate::kDifferenceOfError);
  EXPECT_NEAR(e.velocity, 0.5, 1e-15);
}

TEST(Gaps, TheMotionCountsAsUnknownAfterTenPeriodsOrMoreThanFourAtOnce) {
  const auto known_after = [](int samples, int periods) {
    const Law law(ContouringParams::critical(60.0, 60.0), setup(Observer::kKalman));
    Law::State s;
    for (int k = 0; k < 50; ++k) law.step(s, stroke(0.7 + kPeriod * k), stroke(0.7 + kPeriod * k).position);
    for (int k = 0; k < samples; ++k) law.step(s, stroke(0.75), {{kNan}});
    s.periods = periods;
    law.step(s, stroke(0.8), stroke(0.8).position);
    return s.error[0].moves;
  };
  EXPECT_TRUE(known_after(1, 1));
  EXPECT_TRUE(known_after(10, 1));
  EXPECT_FALSE(known_after(11, 1));
  EXPECT_TRUE(known_after(0, 5));
  EXPECT_FALSE(known_after(0, 6));
  EXPECT_TRUE(known_after(7, 4));
  EXPECT_FALSE(known_after(7, 5));
}

TEST(Gaps, EachAxisOfTwoIsTheAxisAlone) {
  control::Setup<2> both;
  both.period = kPeriod;
  both.force_limit = {{2000.0, 2000.0}};
  std::array<control::Setup<1>, 2> alone{setup(Observer::kKalman),
                                         setup(Observer::kDisturbance, 1.5 * kPeriod)};
  alone[1].compensation[0].model.mass = 300.0;
  for (std::size_t i = 0; i < 2; ++i) both.compensation[i] = alone[i].compensation[0];
  const Pid<2> law(PidParams{}, both);
  const std::array<Pid<1>, 2> one{Pid<1>(PidParams{}, alone[0]), Pid<1>(PidParams{}, alone[1])};
  Pid<2>::State s;
  std::array<Pid<1>::State, 2> t;
  for (int k = 0; k < 100; ++k) {
    path::PathPoint<2> r;
    Vec<double, 2> x;
    for (std::size_t i = 0; i < 2; ++i) {
      const path::PathPoint<1> of = stroke(0.3 + 0.4 * static_cast<double>(i) + kPeriod * k);
      r.position[i] = of.position[0];
      r.velocity[i] = of.velocity[0];
      r.acceleration[i] = of.acceleration[0];
      x[i] = r.position[i] + 1e-6 * std::sin(0.4 * k);
    }
    if (k == 40) x = {{kNan, kNan}};
    s.periods = k == 70 ? 3 : k == 85 ? 20 : 1;
    const Vec<double, 2> f = law.step(s, r, x);
    for (std::size_t i = 0; i < 2; ++i) {
      t[i].periods = s.periods;
      const path::PathPoint<1> of = stroke(0.3 + 0.4 * static_cast<double>(i) + kPeriod * k);
      EXPECT_EQ(f[i], one[i].step(t[i], of, {{x[i]}})[0]) << i << ' ' << k;
    }
  }
}

// The velocity of the Kalman observer follows the force that it makes; a drive with a loop of its own holds the velocity against it.
TEST(Gaps, AnAxisWithALoopOfItsOwnKeepsTheDifferencedRate) {
  control::Setup<2> s;
  s.period = kPeriod;
  for (auto& c : s.compensation) c = setup(Observer::kKalman).compensation[0];
  s.compensation[1].model.drive_loop =
      friction::DriveLoop{friction::DriveMode::kVelocity, 2e4, 0.01, {}, {}, false, true};
  s.force_limit = {{2000.0, 2000.0}};
  ContouringParams gains = ContouringParams::critical(60.0, 60.0);
  gains.error_rate = ErrorRate::kObserved;
  const Contouring<2> law(gains, s);
  Contouring<2>::State state;
  double apart = 0.0;
  for (int k = 0; k < 200; ++k) {
    const double at = stroke(0.7 + kPeriod * k).position[0] + 1e-6 * std::sin(0.3 * k);
    path::PathPoint<2> r;
    for (std::size_t i = 0; i < 2; ++i) {
      r.position[i] = stroke(0.7 + kPeriod * k).position[0];
      r.velocity[i] = stroke(0.7 + kPeriod * k).velocity[0];
      r.acceleration[i] = stroke(0.7 + kPeriod * k).acceleration[0];
    }
    law.step(state, r, {{at, at}});
    if (k == 0) continue;
    EXPECT_DOUBLE_EQ(state.error[0].rate, state.compensation[0].kalman.estimate[1] - r.velocity[0]) << k;
    apart = std::max(
        apart, std::abs(state.error[1].rate - (state.compensation[1].kalman.estimate[1] - r.velocity[1])));
  }
  EXPECT_GT(apart, 1e-4);
}

// The change of velocity over a gap is that of several periods: taken for one, a strong acceleration would count as a wild sample.
TEST(Gaps, TheUsualChangeOfVelocityIsThatOfOnePeriod) {
  constexpr double kAcceleration = 3.0;
  control::Setup<2> s;
  s.period = kPeriod;
  s.compensation[0].model.mass = s.compensation[1].model.mass = kMass;
  s.compensation[1].encoder_resolution = 1e-3;
  s.force_limit = {{2000.0, 2000.0}};
  const Contouring<2> law(ContouringParams::critical(60.0, 60.0), s);
  Contouring<2>::State state;
  for (int k = 0; k < 400; ++k) {
    const double t = kPeriod * k;
    path::PathPoint<2> r;
    r.position = {{0.5 * kAcceleration * t * t, 0.0}};
    r.velocity = {{kAcceleration * t, 0.0}};
    r.acceleration = {{kAcceleration, 0.0}};
    Vec<double, 2> x = r.position;
    if (k >= 396 && k < 399) x[1] = kNan;
    law.step(state, r, x);
  }
  EXPECT_NEAR(state.change[0], kAcceleration * kPeriod, 0.01 * kAcceleration * kPeriod);
  EXPECT_EQ(state.change[1], 0.0);
}

// Its reference comes from four points of the programme: over a missing one they would say v/T for the acceleration, 280 m/s².
TEST(Gaps, ZpetcKnowsWhichPointsOfTheReferenceAreMissing) {
  ZpetcParams params;
  params.preview = Preview::kDelayed;
  const Zpetc<1> law(params, setup(Observer::kNone));
  enum class Gap { kNone, kSample, kReference, kMissed };
  const auto forces = [&](Gap gap) {
    Zpetc<1>::State s;
    std::vector<double> all;
    for (int k = 0; k < 60; ++k) {
      path::PathPoint<1> r = stroke(0.7 + kPeriod * k);
      Vec<double, 1> x = stroke(0.7 + kPeriod * (k - 2)).position;
      s.periods = 1;
      if (k == 40 && gap == Gap::kMissed) continue;
      if (k == 41 && gap == Gap::kMissed) s.periods = 2;
      if (k == 40 && gap == Gap::kSample) x[0] = kNan;
      if (k == 40 && gap == Gap::kReference) r.acceleration[0] = kNan;
      const double f = law.step(s, r, x)[0];
      if (k > 40) all.push_back(f);
    }
    return all;
  };
  const std::vector<double> sound = forces(Gap::kNone);
  for (const Gap gap : {Gap::kSample, Gap::kReference, Gap::kMissed}) {
    const std::vector<double> f = forces(gap);
    for (std::size_t k = 0; k < f.size(); ++k)
      EXPECT_NEAR(f[k], sound[k], 15.0) << static_cast<int>(gap) << ' ' << k;
  }
}

TEST(Gaps, RepetitiveBeginsAnewAfterAGap) {
  auto s = setup(Observer::kNone);
  s.lap = 1.0;
  const Repetitive<1> law(RepetitiveParams{}, s);
  const auto state = std::make_unique<Repetitive<1>::State>();
  path::PathPoint<1> r;
  const auto step = [&](int k, double sample) {
    r.phi = 1e-3 * k;
    law.step(*state, r, {{sample}});
  };
  for (int k = 0; k < 20; ++k) step(k, 0.0);
  EXPECT_GT(state->known, 2);
  step(20, kNan);
  EXPECT_EQ(state->known, 0);
  for (int k = 21; k < 30; ++k) step(k, 0.0);
  state->periods = 2;
  step(31, 0.0);
  EXPECT_EQ(state->known, 1) << "the feedback of this tick alone";
}

TEST(Gaps, LearningBeginsAnewAfterAMissedCycle) {
  auto s = setup(Observer::kNone);
  s.lap = 1.0;
  const Learning<1> law(LearningParams{}, s);
  const auto state = std::make_unique<Learning<1>::State>();
  path::PathPoint<1> r;
  for (int k = 0; k < 20; ++k) {
    r.phi = 1e-3 * k;
    law.step(*state, r, {{0.0}});
  }
  EXPECT_GT(state->known, 4U);
  state->periods = 2;
  r.phi = 21e-3;
  law.step(*state, r, {{0.0}});
  EXPECT_EQ(state->known, 1U) << "the command of this tick alone";
}

}  // namespace
}  // namespace stribeck::control::gaps_test
