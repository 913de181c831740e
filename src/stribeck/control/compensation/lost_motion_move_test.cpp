// Lost motion as a shaped move of the motor's set-point.

#include <set>
#include <stribeck/control/compensation/lost_motion_move.hpp>
#include <stribeck/core/test_fields.hpp>
#include <string>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

namespace stribeck::control::lost_motion_move_test {
namespace {

constexpr double kPeriod = 1e-3;
constexpr LostMotionBounds kAxis{0.1, 1.0, 10.0, -0.2, 0.2};

LostMotionParams worn() {
  LostMotionParams p;
  p.backlash = 12e-6;
  p.stiffness = 30e6;
  p.table_friction = 210.0;
  return p;
}

/// 350 N of friction, whatever the speed.
CompensationParams axis_law() {
  CompensationParams c;
  c.model.mass = 1200.0;
  c.model.friction.steady = friction::Conventional<double>{350.0, 0.0, {}};
  return c;
}

/// Runs over a reference r(t) with its derivatives; returns every output.
template <class Motion>
std::vector<LostMotionMove::Output> run(const LostMotionMove& move, double seconds, Motion&& at) {
  const auto state = std::make_unique<LostMotionMove::State>();
  std::vector<LostMotionMove::Output> out;
  for (int k = 0; k * kPeriod < seconds; ++k) {
    const std::array<double, 3> r = at(k * kPeriod);
    out.push_back(move.step(*state, r[0], r[1], r[2]));
  }
  return out;
}

std::array<double, 3> sine(double t) {
  constexpr double A = 5e-3, w = 1.0;
  return {A * std::sin(w * t), A * w * std::cos(w * t), -A * w * w * std::sin(w * t)};
}

struct Peaks {
  double speed = 0.0, acceleration = 0.0, jerk = 0.0, most = 0.0;
};

/// From the positions alone.
Peaks peaks_of(const std::vector<LostMotionMove::Output>& out) {
  Peaks p;
  for (std::size_t k = 3; k < out.size(); ++k) {
    const double a = out[k].position, b = out[k - 1].position, c = out[k - 2].position,
                 d = out[k - 3].position;
    p.most = std::max(p.most, std::abs(a));
    p.speed = std::max(p.speed, std::abs(a - b) / kPeriod);
    p.acceleration = std::max(p.acceleration, std::abs(a - 2 * b + c) / (kPeriod * kPeriod));
    p.jerk = std::max(p.jerk, std::abs(a - 3 * b + 3 * c - d) / (kPeriod * kPeriod * kPeriod));
  }
  return p;
}

// Closed form: while the table slides, the motor is ahead by half the backlash and friction over stiffness.
TEST(LostMotionMove, StandsAheadByHalfOfWhatIsLost) {
  const LostMotionMove move(worn(), axis_law(), kAxis, kPeriod);
  const auto out = run(move, 6.0, sine);
  const double half = 6e-6 + 210.0 / 30e6;
  EXPECT_NEAR(out[1000].position, half, 1e-3 * half);   // forwards
  EXPECT_NEAR(out[3000].position, -half, 1e-3 * half);  // backwards
  EXPECT_NEAR(out[5900].position, half, 1e-3 * half);
  EXPECT_NEAR(out[3000].velocity, 0.0, 1e-7);
}

// Its own force is that of motor and spring in place of the law's: nothing while all slides.
TEST(LostMotionMove, AddsNoForceWhileTheTableSlides) {
  CompensationParams law = axis_law();
  law.feedforward = Feedforward::kSteady;
  const LostMotionMove move(worn(), law, kAxis, kPeriod);
  const auto out = run(move, 3.5, sine);
  EXPECT_NEAR(out[1000].force, 0.0, 0.2);
  EXPECT_NEAR(out[3000].force, 0.0, 0.2);
}

TEST(LostMotionMove, NeverStepsWhateverTheBounds) {
  std::mt19937 engine(5);
  const auto drawn = [&](double low, double high) {
    return low * std::pow(high / low, static_cast<double>(engine()) / 4294967296.0);
  };
  for (int i = 0; i < 40; ++i) {
    LostMotionParams p = worn();
    p.backlash = drawn(1e-6, 60e-6);
    p.stiffness = drawn(5e6, 100e6);
    p.build_up = drawn(1e-7, 10e-6);
    const LostMotionBounds most{drawn(5e-4, 0.1), drawn(0.05, 3.0), drawn(5.0, 300.0), -0.2, 0.2};
    if (!lost_motion_move_fits(p, most, kPeriod)) continue;
    SCOPED_TRACE(::testing::Message() << "case " << i);
    const LostMotionMove move(p, axis_law(), most, kPeriod);
    const Peaks seen = peaks_of(run(move, 9.0, sine));
    EXPECT_LE(seen.speed, most.speed * (1.0 + 1e-9));
    EXPECT_LE(seen.acceleration, most.acceleration * (1.0 + 1e-9));
    EXPECT_LE(seen.jerk, most.jerk * (1.0 + 1e-6));
    EXPECT_GT(seen.most, 0.45 * p.backlash);
  }
}

// Limit: as quick as jerk alone permits, the move takes 4·(D/2J)^(1/3), within a period for each box.
TEST(LostMotionMove, IsAsQuickAsTheBoundsPermit) {
  const LostMotionMove move(worn(), axis_law(), {10.0, 100.0, 10.0, -0.2, 0.2}, kPeriod);
  const double D = 12e-6 + 2.0 * 210.0 / 30e6;
  const double shortest = 4.0 * std::cbrt(0.5 * D / 10.0) / kPeriod;
  EXPECT_GE(move.boxes().sum(), shortest);
  EXPECT_LE(move.boxes().sum(), shortest + 4.0);
  LostMotionParams slow = worn();
  slow.move.cycles = 200;
  EXPECT_NEAR(LostMotionMove(slow, axis_law(), kAxis, kPeriod).boxes().sum(), 200.0, 4.0);
  slow.move.cycles = 1000;
  EXPECT_TRUE(lost_motion_move_fits(slow, kAxis, kPeriod));
  slow.move.cycles = {};
  slow.move.speed = 1e-6;
  EXPECT_FALSE(lost_motion_move_fits(slow, kAxis, kPeriod));
}

// The middle of the move is where the friction of the table is gone: ln 2 of its build-up after the reversal.
TEST(LostMotionMove, CrossesWhereTheTableHangsFree) {
  LostMotionParams p;
  p.backlash = 20e-6;
  const LostMotionMove move(p, axis_law(), kAxis, kPeriod);
  const auto out = run(move, 2.5, sine);
  const double turn = kPi / 2.0;
  const double free = turn + std::sqrt(2.0 * p.build_up * std::log(2.0) / 5e-3);
  std::size_t crossed = 1500;
  while (out[crossed].position > 0.0) ++crossed;
  EXPECT_NEAR(static_cast<double>(crossed) * kPeriod, free, 2.0 * kPeriod);
}

// Over a distance: half of the backlash after half of it.
TEST(LostMotionMove, TakesItsDistance) {
  LostMotionParams p;
  p.backlash = 20e-6;
  p.build_up = 1e-9;
  p.move.distance = 200e-6;
  const LostMotionMove move(p, axis_law(), kAxis, kPeriod);
  const auto out = run(move, 2.5, sine);
  const double middle = kPi / 2.0 + std::sqrt(2.0 * 100e-6 / 5e-3);
  EXPECT_NEAR(out[static_cast<std::size_t>(middle / kPeriod)].position, 0.0, 0.4e-6);
  EXPECT_NEAR(out.back().position, -10e-6, 1e-9);
}

TEST(LostMotionMove, MirroredAndShiftedMotionsHaveTheSame) {
  const LostMotionMove move(worn(), axis_law(), kAxis, kPeriod);
  const auto as_it_is = run(move, 4.0, sine);
  const auto mirrored = run(move, 4.0, [](double t) {
    const auto r = sine(t);
    return std::array{-r[0], -r[1], -r[2]};
  });
  const auto shifted = run(move, 4.0, [](double t) {
    auto r = sine(t);
    r[0] += 0.1;
    return r;
  });
  for (std::size_t k = 0; k < as_it_is.size(); ++k) {
    EXPECT_DOUBLE_EQ(mirrored[k].position, -as_it_is[k].position);
    EXPECT_NEAR(shifted[k].position, as_it_is[k].position, 1e-12);
  }
}

// A backlash that grows along the travel is the one at the reversal.
TEST(LostMotionMove, FollowsABacklashThatChangesAlongTheTravel) {
  LostMotionParams p;
  p.backlash = 10e-6;
  p.backlash_slope = 100e-6;
  const LostMotionMove move(p, axis_law(), kAxis, kPeriod);
  const auto at = [&](double middle) {
    return run(move, 3.0,
               [&](double t) {
                 auto r = sine(t);
                 r[0] += middle;
                 return r;
               })
        .back()
        .position;
  };
  EXPECT_NEAR(at(0.1), -0.5 * (10e-6 + 100e-6 * (0.1 + 5e-3 * std::sin(3.0))), 0.02e-6);
  EXPECT_NEAR(at(-0.15), 0.0, 1e-12);  // never below none
}

// Reversals that follow each other within a move wait for its end, and the bounds hold.
TEST(LostMotionMove, ManyReversalsKeepTheBounds) {
  const LostMotionMove move(worn(), axis_law(), kAxis, kPeriod);
  const auto quick = [](double t) {
    constexpr double A = 50e-6, w = 160.0;
    return std::array{A * std::sin(w * t), A * w * std::cos(w * t), -A * w * w * std::sin(w * t)};
  };
  const Peaks seen = peaks_of(run(move, 2.0, quick));
  EXPECT_LE(seen.speed, kAxis.speed);
  EXPECT_LE(seen.acceleration, kAxis.acceleration);
  EXPECT_LE(seen.jerk, 2.0 * kAxis.jerk);  // of two moves that meet
}

TEST(LostMotionMove, RestAndBadNumbersChangeNothing) {
  const LostMotionMove move(worn(), axis_law(), kAxis, kPeriod);
  const auto state = std::make_unique<LostMotionMove::State>();
  for (int k = 0; k < 200; ++k) EXPECT_EQ(move.step(*state, 1e-3, 0.0, 0.0).position, 0.0);
  for (int k = 0; k < 2000; ++k) {
    const auto r = sine(k * kPeriod);
    move.step(*state, r[0], r[1], r[2]);
  }
  const double before = state->out.position;
  const auto out = move.step(*state, std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0);
  EXPECT_EQ(out.position, before);
  const double rest = sine(1999 * kPeriod)[0];
  for (int k = 0; k < 500; ++k) EXPECT_NEAR(move.step(*state, rest, 0.0, 0.0).position, before, 1e-9);
}

TEST(LostMotionMove, NothingIsLostAndNothingMoves) {
  const LostMotionMove move({}, axis_law(), kAxis, kPeriod);
  for (const auto& o : run(move, 4.0, sine)) EXPECT_EQ(o.position, 0.0);
}

TEST(LostMotionMove, IsTheSameInTheMirror) {
  // Also a first way that is shorter than the move, and the first period.
  LostMotionParams p = worn();
  p.table_mass = 300.0;
  CompensationParams law = axis_law();
  law.feedforward = Feedforward::kSteady;
  const LostMotionMove move(p, law, kAxis, kPeriod);
  for (const double begin : {-1.6, -0.02, 0.01, 1.55}) {
    const auto at = [&](double t, double side) {
      const auto r = sine(t < 0.05 ? begin - 0.3 * t : begin + t);
      return std::array<double, 3>{side * r[0], side * r[1], side * r[2]};
    };
    const auto one = run(move, 4.0, [&](double t) { return at(t, 1.0); });
    const auto other = run(move, 4.0, [&](double t) { return at(t, -1.0); });
    for (std::size_t k = 0; k < one.size(); ++k) {
      ASSERT_EQ(one[k].position, -other[k].position) << begin << ' ' << k;
      ASSERT_EQ(one[k].velocity, -other[k].velocity) << begin << ' ' << k;
      ASSERT_EQ(one[k].acceleration, -other[k].acceleration) << begin << ' ' << k;
      ASSERT_EQ(one[k].force, -other[k].force) << begin << ' ' << k;
    }
  }
}

TEST(LostMotionMove, BeforeTheFirstReferenceThereIsNoMove) {
  const LostMotionMove move(worn(), axis_law(), kAxis, kPeriod);
  const auto state = std::make_unique<LostMotionMove::State>();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < 3; ++i) {
    const LostMotionMove::Output out =
        move.step(*state, i == 0 ? nan : 0.0, i == 1 ? nan : 0.0, i == 2 ? nan : 0.0);
    EXPECT_EQ(out.position, 0.0);
    EXPECT_EQ(out.velocity, 0.0);
    EXPECT_EQ(out.acceleration, 0.0);
    EXPECT_EQ(out.force, 0.0);
  }
  // At rest there is none either, for as long as it lasts.
  for (const auto& out : run(move, 0.3, [](double) { return std::array{0.1, 0.0, 0.0}; })) {
    EXPECT_EQ(out.position, 0.0);
    EXPECT_EQ(out.force, 0.0);
  }
}

TEST(LostMotionMove, WithinWideBoundsItTakesThreePeriods) {
  // The boxes are at least one, one and two periods long.
  const LostMotionBoxes n = lost_motion_boxes(1e-6, {1e3, 1e6, 1e12, 0.0, 0.0}, kPeriod, 0.0);
  EXPECT_EQ(n.third, 1.0);
  EXPECT_EQ(n.second, 1.0);
  EXPECT_EQ(n.first, 2.0);
}

TEST(LostMotionMove, TheLargestMoveIsThatOfTheEndWithTheWidestPlay) {
  LostMotionParams p;
  p.backlash = 10e-6;
  EXPECT_EQ(LostMotionMove::lost(p, {}), 10e-6);
  for (const double slope : {20e-6, -20e-6}) {
    p.backlash_slope = slope;
    EXPECT_DOUBLE_EQ(LostMotionMove::lost(p, {0.0, 0.0, 0.0, -0.2, 0.2}), 14e-6);
    EXPECT_DOUBLE_EQ(LostMotionMove::lost(p, {0.0, 0.0, 0.0, -0.2, 0.1}), slope < 0.0 ? 14e-6 : 12e-6);
    EXPECT_EQ(LostMotionMove::lost(p, {}), 10e-6) << "an axis without travel";
  }
}

TEST(LostMotionParams, StiffnessAndFrictionOfTheTableGoTogether) {
  using Keys = std::set<std::string>;
  LostMotionParams p;
  EXPECT_EQ(stribeck::test::complaints(p), Keys{});
  p.table_friction = 210.0;
  EXPECT_EQ(stribeck::test::complaints(p), Keys{"stiffness"});
  p.stiffness = 30e6;
  EXPECT_EQ(stribeck::test::complaints(p), Keys{});
  p.table_friction = 0.0;
  EXPECT_EQ(stribeck::test::complaints(p), Keys{"table_friction"});
  p.table_friction = 0.5;
  EXPECT_EQ(stribeck::test::complaints(p), Keys{}) << "a small table";
}

}  // namespace
}  // namespace stribeck::control::lost_motion_move_test
