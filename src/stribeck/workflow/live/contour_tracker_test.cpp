#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/live/contour_tracker.hpp>
#include <stribeck/workflow/run/path_run.hpp>

namespace stribeck::workflow::contour_tracker_test {
namespace {

constexpr double kRadius = 10e-3;
constexpr double kRate = 0.95;  // [rad/s]
constexpr double kStep = 1e-3;  // [s]

std::array<double, 2> on_circle(double t, double radius) {
  return {radius * std::cos(kRate * t), radius * std::sin(kRate * t)};
}

// A loop that lags by 0.2 s, 1.9 mm, on a circle that is 5 um too large.
TEST(ContourTracker, ALagAlongThePathIsNoContourError) {
  ContourTracker tracker(2);
  double worst = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const double t = k * kStep;
    const double e = tracker.step(on_circle(t, kRadius), on_circle(std::max(t - 0.2, 0.0), kRadius + 5e-6));
    // Counter-clockwise, outside is on the right: negative. The path between two points is 1.1 nm inside of the circle.
    if (k > 300) worst = std::max(worst, std::abs(e + 5e-6));
  }
  EXPECT_LT(worst, 2e-9);
}

TEST(ContourTracker, InSpaceItIsADistanceAndOnOneAxisADifference) {
  ContourTracker space(3);
  double e = 0.0;
  for (int k = 0; k < 100; ++k) {
    const double s = k * 1e-5;
    e = space.step(std::array{s, 0.0, 0.0}, std::array{s, 3e-6, 4e-6});
  }
  EXPECT_NEAR(e, 5e-6, 1e-15);
  ContourTracker one(1);
  EXPECT_DOUBLE_EQ(one.step(std::array{1.0}, std::array{0.25}), -0.75);
}

TEST(ContourTracker, StandingStillAndAfterAGapItHasAValue) {
  ContourTracker tracker(2);
  for (int k = 0; k < 10; ++k)
    EXPECT_DOUBLE_EQ(tracker.step(std::array{1.0, 1.0}, std::array{1.0, 1.5}), 0.5);
  tracker.step(std::array{2.0, 1.0}, std::array{2.0, 1.0});
  tracker.restart();
  EXPECT_DOUBLE_EQ(tracker.step(std::array{9.0, 9.0}, std::array{9.0, 9.0}), 0.0);
}

// The trace of simulate, and the figure that it was given: the largest of the glitches is the quadrant glitch.
TEST(QuadrantGlitches, TheLargestIsTheQuadrantGlitch) {
  PathRunOptions o;
  o.run.controller = "a";
  const PathRun run = run_path(o, built_in_machine("biaxial-table"), "machine");
  const sim::CompareRow& row = run.result.rows.front();
  QuadrantGlitches quadrants(2);
  std::vector<QuadrantGlitch> found;
  std::size_t at_the_end = 0;
  for (const sim::ContourSample& s : row.trace) {
    if (!s.scored && at_the_end > 0) break;
    if (s.scored) ++at_the_end;
    if (s.scored)
      quadrants.step(s.time, std::array{s.reference[0], s.reference[1]}, s.contour_error * 1e6, found);
  }
  // Two laps; the circle begins at a quadrant, whose reversal lies before.
  ASSERT_GE(found.size(), 7U);
  double largest = 0.0;
  for (const QuadrantGlitch& p : found) largest = std::max(largest, std::abs(p.error_um));
  EXPECT_NEAR(largest, row.mean.quadrant_glitch * 1e6, 1e-9);
  // x and y take turns, each to and fro.
  for (std::size_t i = 2; i < found.size(); ++i) {
    EXPECT_NE(found[i].axis, found[i - 1].axis);
    EXPECT_NE(found[i].to_positive, found[i - 2].to_positive);
  }
}

}  // namespace
}  // namespace stribeck::workflow::contour_tracker_test
