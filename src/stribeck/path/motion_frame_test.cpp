// The frame of a motion against that of the path it travels.
#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/path/curve.hpp>
#include <stribeck/path/motion_frame.hpp>
#include <vector>

namespace stribeck::path::motion_frame_test {
namespace {

constexpr double kPeriod = 1e-3;

/// An ellipse in space: speed, curvature and its plane all vary.
PathPoint<3> space(double t) {
  PathPoint<3> r;
  const double w = 2.0;
  r.position = {{8e-3 * std::cos(w * t), 5e-3 * std::sin(w * t), 3e-3 * std::sin(w * t + 1.0)}};
  r.velocity = {{-8e-3 * w * std::sin(w * t), 5e-3 * w * std::cos(w * t), 3e-3 * w * std::cos(w * t + 1.0)}};
  r.acceleration = (-w * w) * r.position;
  return r;
}

template <std::size_t N>
void expect_rotation(const PathPoint<N>& r) {
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t k = 0; k < N; ++k) ASSERT_NEAR(dot(r.frame[i], r.frame[k]), i == k ? 1.0 : 0.0, 1e-9);
  }
}

TEST(MotionFrame, OnACircleTurnsWithTheSpeedOverTheRadius) {
  // Closed form: t = (−sin, cos), ṫ = −ω n…, n = inwards; R = 10 mm at 10 mm/s is 1 rad/s.
  const MotionFrame<2> frame(kPeriod, 1e-5, 15.0);
  MotionFrame<2>::State s;
  PathPoint<2> r;
  for (int k = 0; k < 2000; ++k) {
    const double a = k * kPeriod;
    r = {};
    r.position = {{10e-3 * std::cos(a), 10e-3 * std::sin(a)}};
    r.velocity = {{-10e-3 * std::sin(a), 10e-3 * std::cos(a)}};
    r.acceleration = -1.0 * r.position;
    frame.step(s, r);
    expect_rotation(r);
    if (k == 0) continue;
    EXPECT_NEAR(r.frame[0][0], -std::sin(a), 1e-12);
    EXPECT_NEAR(r.frame[1][0], -std::cos(a), 1e-12);
    EXPECT_NEAR(r.frame_rate[0][0], -std::cos(a), 1e-12);
    EXPECT_NEAR(r.frame_rate[1][0], std::sin(a), 1e-12);
    // The jerk is that of half a period ago.
    EXPECT_NEAR(r.frame_acceleration[0][0], std::sin(a), 1e-3);
  }
}

TEST(MotionFrame, DerivativesAreThoseOfTheFrame) {
  const MotionFrame<3> frame(kPeriod, 1e-5, 100.0);
  MotionFrame<3>::State s;
  std::vector<PathPoint<3>> run;
  for (int k = 0; k < 3000; ++k) {
    run.push_back(space(k * kPeriod));
    frame.step(s, run.back());
    expect_rotation(run.back());
  }
  for (std::size_t k = 2; k + 1 < run.size(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        const double difference = (run[k + 1].frame[i][j] - run[k - 1].frame[i][j]) / (2.0 * kPeriod);
        // T²/6 times the third derivative, some 10 1/s³.
        ASSERT_NEAR(run[k].frame_rate[i][j], difference, 2e-5) << k;
        const double second = (run[k + 1].frame_rate[i][j] - run[k - 1].frame_rate[i][j]) / (2.0 * kPeriod);
        // Half a period times the same, for the jerk.
        ASSERT_NEAR(run[k].frame_acceleration[i][j], second, 2e-2) << k;
      }
    }
  }
}

TEST(MotionFrame, BeginsWithTheNormalOnTheInsideOfTheFirstBend) {
  // A left-hand bend and a right-hand one, from their middle: in space the first normal points to the centre.
  for (const double side : {1.0, -1.0}) {
    const MotionFrame<3> frame(kPeriod, 1e-5, 15.0);
    MotionFrame<3>::State s;
    PathPoint<3> r;
    r.position = {{0.0, -side * 10e-3, 0.0}};
    r.velocity = {{10e-3, 0.0, 0.0}};
    r.acceleration = {{0.0, side * 10e-3, 0.0}};
    frame.step(s, r);
    EXPECT_NEAR(r.frame[1][1], side, 1e-12);
    EXPECT_NEAR(r.frame[2][2], side, 1e-12);
  }
}

TEST(MotionFrame, HoldsAtRestAndNeverLeavesItsLimits) {
  // A line, a stop, a corner of 90°, a turn back, and a planner whose acceleration jumps.
  const MotionFrame<3> frame(kPeriod, 1e-5, 15.0);
  MotionFrame<3>::State s;
  PathPoint<3> r;
  Vec<double, 3> x{};
  Vec<double, 3> v{};
  const Vec<double, 3> directions[4] = {
      {{1.0, 0.0, 0.0}}, {{0.0, 1.0, 0.0}}, {{0.0, -1.0, 0.0}}, {{0.6, 0.0, 0.8}}};
  for (const auto& way : directions) {
    for (int k = 0; k < 200; ++k) {
      const double a = k < 50 ? 0.2 : k < 100 ? 0.0 : k < 150 ? -0.2 : 0.0;
      r = {};
      r.acceleration = a * way;
      v = v + kPeriod * r.acceleration;
      x = x + kPeriod * v;
      r.velocity = v;
      r.position = x;
      const Mat<double, 3> before = s.rt;
      frame.step(s, r);
      expect_rotation(r);
      if (norm(v) < 1e-5) {
        EXPECT_EQ(r.frame[0], before[0]);
        EXPECT_EQ(norm(r.frame_rate[0]), 0.0);
      } else {
        EXPECT_NEAR(dot(r.frame[0], way), 1.0, 1e-9);
      }
      EXPECT_LE(norm(r.frame_rate[0]), 15.0 * (1.0 + 1e-9));
      EXPECT_LE(norm(r.frame_acceleration[0]), 225.0 * (1.0 + 1e-9));
    }
  }
}

/// Straight on at 10 mm/s from where the state is, for a second.
template <std::size_t N>
PathPoint<N> straight(const MotionFrame<N>& frame, typename MotionFrame<N>::State& s,
                      const Vec<double, N>& way) {
  PathPoint<N> r;
  Vec<double, N> x = s.position;
  for (int k = 0; k < 1000; ++k) {
    r = {};
    r.velocity = 10e-3 * way;
    x = x + kPeriod * r.velocity;
    r.position = x;
    frame.step(s, r);
    expect_rotation(r);
    EXPECT_NEAR(dot(r.frame[0], way), 1.0, 1e-12);
    // A line has no curvature, and a corner in no time has none that could be given.
    EXPECT_EQ(norm(r.frame_rate[0]), 0.0);
    EXPECT_EQ(norm(r.frame_acceleration[0]), 0.0);
  }
  return r;
}

TEST(MotionFrame, AnExactCornerAtSpeedTurnsTheTangentAtOnceAndKeepsTheNormalAcrossTheCorner) {
  // What lies along the axis of the corner has nothing to do with it, whatever the angle: within the x-y plane, and within planes that
  // lie askew to the normals.
  for (const double tilt : {0.0, 0.4, 1.2}) {
    for (const double degrees : {30.0, 59.0, 61.0, 90.0, 110.0, 135.0, 179.0}) {
      const MotionFrame<3> frame(kPeriod, 1e-5, 15.0);
      typename MotionFrame<3>::State s;
      const auto before = straight<3>(frame, s, {{1.0, 0.0, 0.0}});
      const double a = degrees * kPi / 180.0;
      const auto after =
          straight<3>(frame, s, {{std::cos(a), std::sin(a) * std::cos(tilt), std::sin(a) * std::sin(tilt)}});
      // From 120 degrees on normals are kept as near as can be, which is another rotation.
      if (tilt > 0.0 && degrees > 120.0) continue;
      const Vec<double, 3> axis{{0.0, -std::sin(tilt), std::cos(tilt)}};
      for (std::size_t i = 1; i < 3; ++i)
        EXPECT_NEAR(dot(after.frame[i], axis), dot(before.frame[i], axis), 1e-9) << degrees << ' ' << tilt;
    }
  }
}

TEST(MotionFrame, AReversalOnALineAtSpeedLeavesTheNormals) {
  const MotionFrame<3> space(kPeriod, 1e-5, 15.0);
  typename MotionFrame<3>::State s;
  const auto there = straight<3>(space, s, {{0.6, 0.8, 0.0}});
  const auto back = straight<3>(space, s, {{-0.6, -0.8, 0.0}});
  for (std::size_t i = 1; i < 3; ++i) EXPECT_LT(norm(back.frame[i] - there.frame[i]), 1e-12);
  const MotionFrame<2> plane(kPeriod, 1e-5, 15.0);
  typename MotionFrame<2>::State p;
  const auto right = straight<2>(plane, p, {{1.0, 0.0}});
  const auto left = straight<2>(plane, p, {{-1.0, 0.0}});
  EXPECT_LT(norm(left.frame[1] - right.frame[1]), 1e-12);
}

TEST(MotionFrame, AFasterMotionAlongTheSameWayHasTheSameFrame) {
  const MotionFrame<3> frame(kPeriod, 1e-6, 100.0);
  MotionFrame<3>::State slow;
  MotionFrame<3>::State fast;
  for (int k = 0; k < 4000; ++k) {
    PathPoint<3> r = space(0.25 * k * kPeriod);
    r.velocity = 0.25 * r.velocity;
    r.acceleration = 0.0625 * r.acceleration;
    frame.step(slow, r);
    if (k % 4 != 0) continue;
    PathPoint<3> q = space(0.25 * k * kPeriod);
    frame.step(fast, q);
    // Double reflection is off by the fourth power of the step.
    for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(norm(r.frame[i] - q.frame[i]), 1e-7) << k;
    if (k > 0) {
      EXPECT_LT(norm(4.0 * r.frame_rate[0] - q.frame_rate[0]), 1e-9);
    }
  }
}

}  // namespace
}  // namespace stribeck::path::motion_frame_test
