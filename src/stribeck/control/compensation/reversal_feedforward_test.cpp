/// Tests of reversal_feedforward.hpp. Longer than 500 lines: build-up by table, distance and model on one set of motions.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <random>
#include <stribeck/control/compensation/reversal_feedforward.hpp>
#include <stribeck/friction/test_maps.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::control::reversal_feedforward_test {
namespace {

constexpr double kPeriod = 1e-3;
constexpr double kLevel = 1000.0;
constexpr double kDistance = 4e-6;

friction::Model flat() {
  friction::Model m;
  m.steady = friction::Conventional<double>{kLevel, 0.0, {}};
  return m;
}

ReversalParams exponential(double distance = kDistance) {
  ReversalParams p;
  p.distance = distance;
  return p;
}

ReversalParams table(std::initializer_list<BuildUpPoint> points) {
  ReversalParams p;
  for (const auto& point : points) p.build_up.push_back(point);
  return p;
}

/// Constant acceleration through a reversal at t = 0.
MotionAhead through(double acceleration, double t) {
  return {0.5 * acceleration * t * t, acceleration * t, acceleration, 0.0};
}

MotionAhead sine(double amplitude, double omega, double t) {
  const double c = std::cos(omega * t);
  const double s = std::sin(omega * t);
  return {-amplitude * c, amplitude * omega * s, amplitude * omega * omega * c,
          -amplitude * omega * omega * omega * s};
}

/// Mean of f over [0, 1], middle rule.
template <class F>
double mean(F f, int parts = 20000) {
  double sum = 0.0;
  for (int i = 0; i < parts; ++i) sum += f((i + 0.5) / parts);
  return sum / parts;
}

/// Holds from begin to end [s]; returns the part of each mean force that reverses [N].
template <class Motion>
std::vector<double> drive(const ReversalFeedforward& law, ReversalFeedforward::State& s, Motion motion,
                          double begin, double end, double period = kPeriod) {
  std::vector<double> force;
  const int count = static_cast<int>(std::lround((end - begin) / period));
  for (int k = 0; k < count; ++k) {
    const MotionAhead r = motion(begin + k * period);
    force.push_back(law.step(s, r, r.velocity).bristle);
  }
  return force;
}

/// An axis that is moved by hand, step by step, from where it stands; each move takes one period at constant speed.
class ByHand {
 public:
  explicit ByHand(const ReversalParams& params, double moving = 0.0, const friction::Model& model = flat())
      : law_(params, model, kPeriod) {
    law_.step(state_, {0.0, 0.0, 0.0, 0.0}, moving);
  }
  /// Share of the level after the move.
  double move(double distance) {
    law_.step(state_, {x_, distance / kPeriod, 0.0, 0.0}, 0.0);
    x_ += distance;
    law_.step(state_, {x_, 0.0, 0.0, 0.0}, 0.0);
    return state_.share;
  }
  double dwell() { return law_.step(state_, {x_, 0.0, 0.0, 0.0}, 0.0).bristle; }
  const ReversalFeedforward::State& state() const { return state_; }

 private:
  ReversalFeedforward law_;
  ReversalFeedforward::State state_;
  double x_ = 0.0;
};

// Closed form ------------------------------------------------------------------------------------------------------------

TEST(Reversal, ExponentialOverDistanceUnderConstantAcceleration) {
  const double a = 50e-3;
  // The reversal at the start of a hold, at its middle, and near its end.
  for (const double phase : {0.0, 0.5, 0.93}) {
    const ReversalFeedforward law(exponential(), flat(), kPeriod);
    ReversalFeedforward::State s;
    for (int k = -20; k < 60; ++k) {
      const double begin = (k - phase) * kPeriod;
      const MotionAhead r = through(a, begin);
      const double force = law.step(s, r, r.velocity).bristle;
      const double expected = mean([&](double share) {
        const double t = begin + share * kPeriod;
        return t < 0.0 ? -kLevel : kLevel * (1.0 - 2.0 * std::exp(-0.5 * a * t * t / kDistance));
      });
      // Three points of Gauss's rule on each side of the turn; the middle rule takes a cell across it, 1000 N/20000.
      EXPECT_NEAR(force, expected, 0.06) << "hold " << k << " phase " << phase;
    }
  }
}

TEST(Reversal, TableWithStepDelayAndOvershoot) {
  // A quarter at once, nothing for 2 µm, up to 1.2 at 6 µm, then back to 1 at 10 µm.
  const std::vector<BuildUpPoint> p{{0.0, 0.25}, {2e-6, 0.25}, {6e-6, 1.2}, {10e-6, 1.0}};
  const auto share = [&](double s) {
    for (std::size_t i = 1; i < p.size(); ++i) {
      if (s <= p[i].distance)
        return p[i - 1].share +
               (p[i].share - p[i - 1].share) * (s - p[i - 1].distance) / (p[i].distance - p[i - 1].distance);
    }
    return 1.0;
  };
  for (const double direction : {1.0, -1.0}) {
    ByHand axis(table({p[0], p[1], p[2], p[3]}), -direction);
    double s = 0.0;
    for (const double d : {0.7e-6, 0.9e-6, 1.1e-6, 2.3e-6, 1.0e-6, 2.5e-6, 3.0e-6}) {
      s += d;
      EXPECT_NEAR(axis.move(direction * d), direction * (2.0 * share(s) - 1.0), 1e-12) << s;
    }
  }
}

TEST(Reversal, TurnWithinAHoldIsNotLostBetweenHolds) {
  // 0.2 m/s² and 5 ms: the axis goes 0.6 µm out and back within one hold.
  const double a = 0.2;
  const double period = 5e-3;
  const ReversalFeedforward law(exponential(), flat(), period);
  ReversalFeedforward::State s;
  drive(
      law, s, [&](double t) { return through(a, t); }, -0.5 - 0.5 * period, 2.0 * period, period);
  const double end = 0.5 * a * std::pow(s.velocity / a + period, 2);
  EXPECT_NEAR(s.share, 1.0 - 2.0 * std::exp(-end / kDistance), 1e-9);
}

// Limits -----------------------------------------------------------------------------------------------------------------

TEST(Reversal, WithoutDistanceIsTheMapWithASwitch) {
  friction::Model model;
  model.steady = friction::test::table_2_3_x();
  const double period = 5e-3;
  const ReversalFeedforward law(exponential(1e-18), model, period);
  ReversalFeedforward::State s;
  for (int k = 0; k < 1000; ++k) {
    const MotionAhead r = sine(10e-3, 0.95, 0.1 + k * period);
    const double force = law.step(s, r, r.velocity).sum();
    const double expected = mean(
        [&](double share) {
          const double v = r.velocity_at(share * period);
          const auto p = model.parts(v, 0.0);
          return p.level * sign(v) + p.viscous;
        },
        2000);
    // The midpoint rule puts one cell across the turn, 2300 N/2000; elsewhere the middle of the hold differs from its mean by
    // F̈T²/24 < 0.02 N.
    ASSERT_NEAR(force, expected, r.velocity * r.velocity_at(period) < 0.0 ? 1.2 : 0.02) << k;
  }
}

TEST(Reversal, SlowingWithoutReversingIsTheMap) {
  friction::Model model;
  model.steady = friction::test::table_2_3_x();
  model.dynamics = friction::LuGre<double>{3e8, 600e3, 0.05e-3};
  ReversalParams params;
  params.short_move = 20e-6;
  for (const double lead : {0.0, 2e-3}) {
    params.lead = lead;
    const ReversalFeedforward law(params, model, kPeriod);
    ReversalFeedforward::State s;
    // From 5 mm/s down to 10 µm/s and up again.
    const auto at = [](double t) {
      const double mean_speed = 2.505e-3;
      const double swing = 2.495e-3;
      return MotionAhead{mean_speed * t + swing * std::sin(t), mean_speed + swing * std::cos(t),
                         -swing * std::sin(t), -swing * std::cos(t)};
    };
    for (int k = 0; k < 7000; ++k) {
      const MotionAhead r = at(k * kPeriod);
      const double middle = lead + 0.5 * kPeriod;
      const auto p = model.parts(r.velocity_at(middle), r.position_at(middle));
      const auto f = law.step(s, r, r.velocity);
      ASSERT_EQ(s.share, 1.0) << k;
      ASSERT_NEAR(f.bristle, p.level, 1e-9) << k;
      ASSERT_NEAR(f.viscous, p.viscous, 1e-9) << k;
    }
  }
}

TEST(Reversal, DwellHolds) {
  for (const auto& params : {exponential(), table({{5e-6, 0.9}, {20e-6, 1.0}})}) {
    ByHand axis(params, -1.0);
    axis.move(1.5e-6);
    const double force = axis.dwell();
    EXPECT_GT(force, -kLevel);
    EXPECT_LT(force, 0.5 * kLevel);
    for (int k = 0; k < 5000; ++k) ASSERT_EQ(axis.dwell(), force);
    // And goes on from there.
    ByHand without(params, -1.0);
    without.move(1.5e-6);
    EXPECT_EQ(axis.move(1e-6), without.move(1e-6));
  }
}

TEST(Reversal, BeginsRelaxedAtRestAndBuiltUpInMotion) {
  const ReversalFeedforward law(exponential(), flat(), kPeriod);
  ReversalFeedforward::State rest;
  EXPECT_EQ(law.step(rest, {0.1, 0.0, 0.0, 0.0}, 0.0).sum(), 0.0);
  ReversalFeedforward::State moving;
  EXPECT_EQ(law.step(moving, {0.1, -3e-3, 0.0, 0.0}, -3e-3).sum(), -kLevel);
  // From rest the first build-up: 1 − exp(−s/d); a table as if half of the reversal were to do, p(2s).
  EXPECT_NEAR(ByHand(exponential()).move(-2e-6), -(1.0 - std::exp(-0.5)), 1e-12);
  EXPECT_NEAR(ByHand(table({{4e-6, 0.8}, {10e-6, 1.0}})).move(2e-6), 0.8, 1e-12);
  EXPECT_NEAR(ByHand(table({{4e-6, 0.8}, {10e-6, 1.0}})).move(5e-6), 1.0, 1e-12);
}

// Invariance -------------------------------------------------------------------------------------------------------------

TEST(Reversal, Mirrored) {
  for (auto params : {exponential(), table({{0.0, 0.2}, {5e-6, 0.9}, {20e-6, 1.0}})}) {
    params.short_move = 3e-6;
    params.lead = 1e-3;
    params.rate_limit = 2e5;
    const ReversalFeedforward law(params, flat(), kPeriod);
    ReversalFeedforward::State s;
    ReversalFeedforward::State mirrored;
    const FrictionScales scales{1.1, 0.8, 1.0, 1.2};
    const FrictionScales swapped{0.8, 1.1, 1.0, 1.2};
    for (int k = 0; k < 3000; ++k) {
      const double t = k * kPeriod;
      // Strokes of 8 µm with turns in between.
      MotionAhead r = sine(4e-6, 30.0, t);
      const MotionAhead quick = sine(1e-6, 170.0, t);
      r = {r.position + quick.position, r.velocity + quick.velocity, r.acceleration + quick.acceleration,
           r.jerk + quick.jerk};
      const MotionAhead back{-r.position, -r.velocity, -r.acceleration, -r.jerk};
      ASSERT_EQ(law.step(s, r, r.velocity, scales).sum(),
                -law.step(mirrored, back, back.velocity, swapped).sum());
    }
  }
}

TEST(Reversal, DependsOnDistanceNotOnTime) {
  const double faster = 8.0;  // a power of two: the same bits
  for (const auto& params : {exponential(), table({{5e-6, 0.9}, {20e-6, 1.0}})}) {
    const ReversalFeedforward law(params, flat(), kPeriod);
    const ReversalFeedforward quick_law(params, flat(), kPeriod / faster);
    ReversalFeedforward::State s;
    ReversalFeedforward::State quick;
    for (int k = 0; k < 2000; ++k) {
      const MotionAhead r = sine(15e-6, 20.0, k * kPeriod);
      const MotionAhead q{r.position, faster * r.velocity, faster * faster * r.acceleration,
                          faster * faster * faster * r.jerk};
      ASSERT_EQ(law.step(s, r, r.velocity).sum(), quick_law.step(quick, q, q.velocity).sum());
    }
  }
}

TEST(Reversal, LeadGivesTheSameForcesEarlier) {
  ReversalParams early = exponential();
  early.lead = 3 * kPeriod;
  const ReversalFeedforward law(exponential(), flat(), kPeriod);
  const ReversalFeedforward ahead(early, flat(), kPeriod);
  ReversalFeedforward::State s;
  ReversalFeedforward::State led;
  const auto at = [](double t) { return sine(10e-3, 3.0, t); };
  const auto plain = drive(law, s, at, 0.2, 5.2);
  const auto forces = drive(ahead, led, at, 0.2, 5.2);
  for (std::size_t k = 3; k < plain.size(); ++k) {
    // Predicted 4 ms on by the Taylor series: the travel is off by ω⁴·A·τ⁴/24 < 1e-11 m, 0.005 N at 2·g/d.
    ASSERT_NEAR(forces[k - 3], plain[k], 0.05) << k;
  }
}

TEST(Reversal, ScalesScaleLevelAndDistance) {
  const FrictionScales scales{1.2, 0.7, 1.0, 1.5};
  const ReversalFeedforward law(exponential(), flat(), kPeriod);
  ReversalFeedforward::State s;
  law.step(s, {0.0, 0.0, 0.0, 0.0}, -1.0, scales);
  law.step(s, {0.0, 3e-3, 0.0, 0.0}, 3e-3, scales);
  const double force = law.step(s, {3e-6, 0.0, 0.0, 0.0}, 0.0, scales).bristle;
  const double d = kDistance * 1.2 / 1.5;
  EXPECT_NEAR(force, kLevel * (1.2 - (1.2 + 0.7) * std::exp(-3e-6 / d)), 1e-9);
}

// Partial reversals ------------------------------------------------------------------------------------------------------

TEST(Reversal, PartialReversalStartsWhereTheBuildUpGotTo) {
  ByHand axis(table({{4e-6, 0.8}, {12e-6, 1.0}}), -1.0);
  EXPECT_NEAR(axis.move(1e-6), -1.0 + 2.0 * 0.2, 1e-12);     // up the main branch
  EXPECT_NEAR(axis.move(-0.5e-6), -0.6 - 2.0 * 0.1, 1e-12);  // back over half the distance, by the same curve
  EXPECT_NEAR(axis.move(0.5e-6), -0.6, 1e-12);               // the small loop closes
  EXPECT_NEAR(axis.move(3e-6), -1.0 + 2.0 * 0.8, 1e-12);     // and is forgotten: the main branch goes on
  EXPECT_NEAR(axis.move(-4e-6), 0.6 - 2.0 * 0.8, 1e-12);     // back over the whole distance
  EXPECT_NEAR(axis.move(-1e-6), -1.0, 1e-12);
  ByHand other(exponential(), -1.0);
  const double h = other.move(1e-6);
  EXPECT_NEAR(h, 1.0 - 2.0 * std::exp(-0.25), 1e-12);
  EXPECT_NEAR(other.move(-1e-6), -1.0 + (h + 1.0) * std::exp(-0.25), 1e-12);
}

TEST(Reversal, MinorLoopsStayInsideTheMajorLoop) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> distance(-8e-6, 8e-6);
  ByHand axis(table({{0.0, 0.1}, {1e-6, 0.1}, {2e-6, 0.7}, {5e-6, 0.75}, {9e-6, 1.0}}));
  for (int k = 0; k < 5000; ++k) ASSERT_LE(std::abs(axis.move(distance(random))), 1.0 + 1e-12) << k;
}

TEST(Reversal, ForceGoesOnWhereTheDirectionsDiffer) {
  friction::Model model;
  friction::Gaussian<double> map;
  map.positive.eta0 = 900.0;
  map.negative.eta0 = -600.0;
  map.velocity_range = {-1e-2, 1e-2};
  model.steady = map;
  for (const auto& params : {exponential(), table({{5e-6, 0.9}, {20e-6, 1.0}})}) {
    const double a = 20e-3;
    const ReversalFeedforward law(params, model, kPeriod);
    ReversalFeedforward::State s;
    const auto force = drive(
        law, s, [&](double t) { return through(a, t); }, -0.1, 0.2);
    EXPECT_EQ(force.front(), -600.0);
    EXPECT_NEAR(force.back(), 900.0, 1e-6);
    for (std::size_t k = 1; k < force.size(); ++k) {
      ASSERT_GE(force[k], force[k - 1]);
      // The table is steepest, 1500 N·0.9/5 µm at √(2·a·5 µm) = 0.45 mm/s; a jump would be 300 N.
      ASSERT_LT(force[k] - force[k - 1], 125.0);
    }
  }
}

// Independent reference: the friction models themselves, in small steps -------------------------------------------------------

template <class Dynamics>
void expect_like(const Dynamics& dynamics, const friction::test::Flat& map, double tolerance) {
  friction::Model model;
  model.steady = friction::Conventional<double>{map.level, 0.0, {}};
  model.dynamics = dynamics;
  const ReversalFeedforward law({}, model, kPeriod);
  ReversalFeedforward::State s;
  typename Dynamics::State bristle;
  constexpr int kParts = 200;
  double force = 0.0;
  double worst = 0.0;
  for (int k = 0; k < 2000; ++k) {
    // From rest; strokes from 1 to 30 µm, so that some turn before they slide.
    MotionAhead r = sine(15e-6, 10.0, k * kPeriod);
    const MotionAhead quick = sine(2e-6, 63.0, k * kPeriod);
    r = {r.position + quick.position, r.velocity + quick.velocity, r.acceleration + quick.acceleration,
         r.jerk + quick.jerk};
    double sum = 0.0;
    for (int i = 0; i < kParts; ++i) {
      const double dt = kPeriod / kParts;
      const double next = dynamics.step(map, bristle, r.velocity_at((i + 0.5) * dt), 0.0, dt);
      sum += 0.5 * (force + next);
      force = next;
    }
    worst = std::max(worst, std::abs(law.step(s, r, r.velocity).bristle - sum / kParts));
  }
  EXPECT_LT(worst, tolerance);
}

TEST(Reversal, IsLuGreWhereTheLevelIsConstant) {
  expect_like(friction::LuGre<double>{2.5e8, 0.0, {}}, {kLevel}, 0.02);
}

TEST(Reversal, IsGmsWhereTheLevelIsConstant) {
  friction::Gms<double> gms;
  for (const double share : {0.1, 0.2, 0.3, 0.4}) gms.elements.push_back({1e8 * (0.6 - share), share});
  gms.attraction = 1e9;
  // Elements reach their limits at corners, which 200 parts of a hold cut by up to 0.12 N.
  expect_like(gms, {kLevel}, 0.2);
}

// Three quarters of the reversal after a distance of g·l/(σ0·k)·ln 2 by the shares l, k of the place: the law of the model, which the
// reversal follows, has that as well.
TEST(Reversal, BuildsUpAsThePlaceHasIt) {
  for (const double level : {1.0, 2.0, 4.0}) {
    for (const double stiffness : {1.0, 0.25}) {
      friction::Model model;
      model.steady = friction::Conventional<double>{kLevel, 0.0, {}};
      model.dynamics = friction::LuGre<double>{2.5e8, 0.0, {}};
      model.places = {friction::Place{0.0, level, stiffness}};
      const ReversalFeedforward law({}, model, kPeriod);
      const FrictionFeedforward bristle(model, kPeriod);
      ReversalFeedforward::State s;
      FrictionFeedforward::State b;
      double apart = 0.0;
      for (int k = 0; k < 3000; ++k) {
        const MotionAhead r = sine(40e-6, 5.0, k * kPeriod);
        const double f = law.step(s, r, r.velocity).bristle;
        const double g = bristle.step(b, r).bristle;
        if (k > 700) apart = std::max(apart, std::abs(f - g));
      }
      EXPECT_LT(apart, 0.01 * level * kLevel) << level << ' ' << stiffness;
    }
  }
  // A distance that is given is that of every place.
  friction::Model model;
  model.steady = friction::Conventional<double>{kLevel, 0.0, {}};
  ReversalParams given;
  given.distance = 5e-6;
  const auto share_after = [&](double level) {
    model.places = {friction::Place{0.0, level, 1.0}};
    const ReversalFeedforward law(given, model, kPeriod);
    ReversalFeedforward::State s;
    for (int k = 0; k < 500; ++k) law.step(s, sine(40e-6, 5.0, k * kPeriod), 0.1);
    return s.share;
  };
  EXPECT_NEAR(share_after(1.0), share_after(4.0), 1e-12);
}

// What controls add ------------------------------------------------------------------------------------------------------

TEST(Reversal, ShortMovesGetLess) {
  ReversalParams params = exponential();
  params.short_move = 10e-6;
  const double full = 2.0 * (1.0 - std::exp(-0.5));
  EXPECT_NEAR(ByHand(params, -1.0).move(2e-6), -1.0 + 0.2 * full, 1e-12);
  // A move of that length and any longer one as without.
  EXPECT_NEAR(ByHand(params, -1.0).move(10e-6), 1.0 - 2.0 * std::exp(-2.5), 1e-12);
  EXPECT_NEAR(ByHand(params, -1.0).move(12e-6), 1.0 - 2.0 * std::exp(-3.0), 1e-12);
  // To and fro by 1 µm moves the force by less than a fifth of what it would.
  ByHand with(params, -1.0);
  ByHand without(exponential(), -1.0);
  for (int k = 0; k < 20; ++k) {
    const double there = with.move(1e-6);
    const double there_without = without.move(1e-6);
    const double swing = std::abs(with.move(-1e-6) - there);
    const double swing_without = std::abs(without.move(-1e-6) - there_without);
    if (k > 10) {
      EXPECT_LT(swing, 0.2 * swing_without) << k;
    }
  }
}

TEST(Reversal, RateIsLimitedOfThePartThatReverses) {
  friction::Model model;
  model.steady = friction::Conventional<double>{kLevel, 5e5, {}};
  ReversalParams params = exponential();
  params.rate_limit = 4e4;
  const ReversalFeedforward law(params, model, kPeriod);
  ReversalFeedforward::State s;
  const double a = 0.5;
  double before = -kLevel;
  int limited = 0;
  for (int k = -20; k < 200; ++k) {
    const MotionAhead r = through(a, k * kPeriod);
    const auto f = law.step(s, r, r.velocity);
    ASSERT_LE(f.bristle - before, 40.0 + 1e-9);
    ASSERT_NEAR(f.viscous, 5e5 * r.velocity_at(0.5 * kPeriod), 1e-6);
    limited += f.bristle - before > 39.999 ? 1 : 0;
    before = f.bristle;
  }
  EXPECT_NEAR(limited, 50, 5);  // 2000 N at 40 N per period
  EXPECT_EQ(before, kLevel);
}

TEST(Reversal, AWrongPredictionLeavesNoTrace) {
  // Braking to a stop at 0.2 m/s²; until it stops that looks like a reversal to come.
  for (auto params : {exponential(), table({{5e-6, 0.9}, {20e-6, 1.0}})}) {
    params.lead = 2e-3;
    const double a = 0.2;
    const ReversalFeedforward law(params, flat(), kPeriod);
    ReversalFeedforward::State s;
    const auto stop = [&](double t) {
      return t < 0.0 ? MotionAhead{-0.5 * a * t * t, -a * t, -a, 0.0} : MotionAhead{};
    };
    const auto force = drive(law, s, stop, -0.05, 0.05);
    // It acts on no more than the travel that it predicts, a·(lead + T)²/2 = 0.9 µm.
    for (const double f : force) EXPECT_GT(f, kLevel * (1.0 - 2.0 * 0.9e-6 / kDistance));
    EXPECT_LT(*std::min_element(force.begin(), force.end()), 0.99 * kLevel);
    EXPECT_EQ(force.back(), kLevel);
    EXPECT_EQ(s.share, 1.0);
  }
}

TEST(Reversal, NeverNan) {
  std::mt19937_64 random(20260101);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::uniform_int_distribution<int> power(-320, 308);
  const auto any = [&] { return unit(random) < -0.8 ? 0.0 : unit(random) * std::pow(10.0, power(random)); };
  friction::Model model;
  model.steady = friction::test::table_2_3_x();
  for (auto params : {exponential(), table({{0.0, 0.2}, {5e-6, 1.3}, {20e-6, 1.0}})}) {
    params.lead = 2e-3;
    params.short_move = 1e-6;
    params.rate_limit = 1e6;
    const ReversalFeedforward law(params, model, kPeriod);
    ReversalFeedforward::State s;
    for (int k = 0; k < 200000; ++k) {
      const MotionAhead r{any(), any(), any(), any()};
      ASSERT_TRUE(std::isfinite(law.step(s, r, r.velocity).sum()))
          << k << ": " << r.position << " " << r.velocity << " " << r.acceleration << " " << r.jerk;
    }
  }
}

TEST(Reversal, ANumberThatIsNotFiniteGivesTheLastForce) {
  const ReversalFeedforward law(exponential(), flat(), kPeriod);
  ReversalFeedforward::State s;
  ReversalFeedforward::State undisturbed;
  for (int k = 0; k < 200; ++k) {
    const MotionAhead r = sine(15e-6, 20.0, k * kPeriod);
    const double force = law.step(s, r, r.velocity).sum();
    EXPECT_EQ(force, law.step(undisturbed, r, r.velocity).sum());
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      EXPECT_EQ(law.step(s, {bad, r.velocity, 0.0, 0.0}, r.velocity).sum(), force);
      EXPECT_EQ(law.step(s, {r.position, r.velocity, 0.0, bad}, r.velocity).sum(), force);
    }
  }
}

// On a loop: the table of docs/theory/reversal.md ----------------------------------------------------------------------------

/// Largest tracking error [µm] of the biaxial table's x axis (Table 2.3 over LuGre; no noise, no encoder) under PD with a
/// double pole at 40 rad/s and this feed-forward, on r = −10 cos ωt mm, after the first period of the motion.
template <class Friction>
double worst_error_um(double speed, double lag, Friction feedforward) {
  constexpr double kMass = 57650.0;
  constexpr double kOmega = 40.0;
  constexpr double kTick = 5e-3;
  constexpr int kParts = 20;
  const auto map = friction::test::table_2_3_x();
  const friction::LuGre<double> truth{3e8, 600e3, 0.05e-3};
  friction::LuGre<double>::State bristle;
  const double omega = speed / 10e-3;
  const int ticks = static_cast<int>(2.0 * 2.0 * kPi / omega / kTick);
  const double dt = kTick / kParts;
  // Of a first-order lag over dt: what is left at its end, and in the mean.
  const double keeps = lag > 0.0 ? std::exp(-dt / lag) : 0.0;
  const double keeps_in_mean = lag / dt * (1.0 - keeps);
  double x = -10e-3;
  double v = 0.0;
  double e_before = 0.0;
  double current = 0.0;
  double worst = 0.0;
  for (int k = 0; k < ticks; ++k) {
    const MotionAhead r = sine(10e-3, omega, k * kTick);
    const double e = x - r.position;
    const double rate = (e - e_before) / kTick;
    e_before = e;
    const double force =
        kMass * (r.acceleration + 0.5 * kTick * r.jerk - 2.0 * kOmega * rate - kOmega * kOmega * e) +
        feedforward(r);
    if (k > ticks / 2) worst = std::max(worst, std::abs(e));
    for (int i = 0; i < kParts; ++i) {
      const double acting = force + keeps_in_mean * (current - force);
      current = force + keeps * (current - force);
      v += dt * (acting - truth.step(map, bristle, v, 0.0, dt)) / kMass;
      x += dt * v;
    }
  }
  return worst * 1e6;
}

TEST(ReversalOnALoop, TableOfThePage) {
  friction::Model fixed;
  fixed.steady = friction::test::table_2_3_x();
  friction::Model model = fixed;
  model.dynamics = friction::LuGre<double>{3e8, 600e3, 0.05e-3};
  const auto worst = [&](double speed, const ReversalParams& params, const friction::Model& known,
                         double lag = 0.0) {
    const ReversalFeedforward law(params, known, 5e-3);
    ReversalFeedforward::State s;
    return worst_error_um(speed, lag, [&](const MotionAhead& r) { return law.step(s, r, r.velocity).sum(); });
  };
  const auto steady = [&](double speed) {
    return worst_error_um(speed, 0.0, [&](const MotionAhead& r) {
      const auto p = fixed.parts(r.velocity, r.position);
      return p.level * sign(r.velocity) + p.viscous;
    });
  };
  ReversalParams led;
  led.lead = 3e-3;
  ReversalParams slow;
  slow.rate_limit = 4e4;
  const double d = 3.8e-6;
  struct Row {
    const char* name;
    ReversalParams params;
    const friction::Model* known;
    double lag;
    double at_9_5;
    double at_3;
  };
  const Row rows[] = {
      {"pre-sliding of the model", {}, &model, 0.0, 0.18, 0.075},
      {"4 um, no pre-sliding known", {}, &fixed, 0.0, 0.57, 0.76},
      {"half the distance", exponential(0.5 * d), &fixed, 0.0, 1.86, 2.00},
      {"twice the distance", exponential(2.0 * d), &fixed, 0.0, 2.75, 3.23},
      {"linear over 6 um", table({{6e-6, 1.0}}), &fixed, 0.0, 1.18, 1.92},
      {"linear over 8 um", table({{8e-6, 1.0}}), &fixed, 0.0, 1.53, 1.80},
      {"linear over 1 um", table({{1e-6, 1.0}}), &fixed, 0.0, 3.77, 4.55},
      {"current lags 3 ms", {}, &model, 3e-3, 0.52, 0.12},
      {"current lags 3 ms, lead 3 ms", led, &model, 3e-3, 0.19, 0.08},
      {"at most 40 kN/s", slow, &model, 0.0, 1.62, 0.075},
  };
  // 5 % of each, or 0.01 µm, for sub-steps and compilers.
  const auto expect = [](double error, double printed) {
    EXPECT_NEAR(error, printed, std::max(0.05 * printed, 0.01));
  };
  expect(steady(9.5e-3), 4.78);
  expect(steady(3e-3), 5.61);
  for (const Row& row : rows) {
    SCOPED_TRACE(row.name);
    expect(worst(9.5e-3, row.params, *row.known, row.lag), row.at_9_5);
    expect(worst(3e-3, row.params, *row.known, row.lag), row.at_3);
  }
  // A build-up over time that is right at 9.5 mm/s is one over a tenth of the distance at 3 mm/s.
  expect(worst(3e-3, exponential(d * (3.0 / 9.5) * (3.0 / 9.5)), fixed), 4.34);
}

TEST(Reversal, ParametersAreChecked) {
  const auto problem = [](const ReversalParams& p) {
    std::string key = "none";
    p.validate([&](std::string_view name, std::string_view) { key = name; });
    return key;
  };
  EXPECT_EQ(problem({}), "none");
  EXPECT_EQ(problem(exponential()), "none");
  EXPECT_EQ(problem(table({{0.0, 0.2}, {5e-6, 1.0}})), "none");
  EXPECT_EQ(problem(table({{5e-6, 0.2}, {5e-6, 1.0}})), "build_up");
  EXPECT_EQ(problem(table({{5e-6, 0.2}, {6e-6, 0.9}})), "build_up");
  ReversalParams both = table({{5e-6, 1.0}});
  both.distance = 1e-6;
  EXPECT_EQ(problem(both), "distance");
}

TEST(MotionAhead, RestsWhereNothingIsSaidOfIt) {
  for (const double t : {0.0, 1.0, -2.0}) {
    EXPECT_EQ(MotionAhead{}.position_at(t), 0.0);
    EXPECT_EQ(MotionAhead{}.velocity_at(t), 0.0);
  }
}

TEST(MotionAhead, LaterIsTheSameMotion) {
  const MotionAhead now{0.1, 0.2, -3.0, 40.0};
  for (const double t : {0.0, 0.3, -0.2}) {
    for (const double on : {0.1, 0.5}) {
      EXPECT_NEAR(now.later(t).position_at(on), now.position_at(t + on), 1e-13);
      EXPECT_NEAR(now.later(t).velocity_at(on), now.velocity_at(t + on), 1e-13);
    }
    // Velocity is the rate of the position.
    EXPECT_NEAR((now.position_at(t + 1e-5) - now.position_at(t - 1e-5)) / 2e-5, now.velocity_at(t), 1e-8);
  }
}

}  // namespace
}  // namespace stribeck::control::reversal_feedforward_test
