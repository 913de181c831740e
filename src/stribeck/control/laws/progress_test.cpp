#include <gtest/gtest.h>

#include <algorithm>
#include <stribeck/control/laws/progress.hpp>

namespace stribeck::control::progress_test {
namespace {

constexpr double kPeriod = 1e-3;  // [s]
using Two = Progress<2, 4>;

/// One along x at 0.1 m/s without acceleration, within ±2 m/s².
Two::Stage straight() {
  Two::Stage s;
  s.d = {{0.1, 0.0}};
  s.low = {{-2.0, -2.0}};
  s.high = {{2.0, 2.0}};
  return s;
}

// θ̈ moves an axis by c·T + d; one that stands and must accelerate across the path is held by c·z ≤ high alone.
TEST(Progress, AnAxisThatTheProgressDoesNotMoveLimitsTheRate) {
  const Two progress(kPeriod);
  for (const double sign : {1.0, -1.0}) {
    Two::Work w;
    w.stage[0] = straight();
    w.stage[0].c[1] = sign * 8.0;
    w.stage[0].d[1] = -kPeriod * w.stage[0].c[1];  // so that it does not move it
    // The bounds of x are no bounds of y.
    w.stage[0].high[0] = 5.0;
    w.stage[0].low[0] = -5.0;
    progress.reach(w, 1, 1.0);
    EXPECT_NEAR(w.greatest[0], 2.0 / 8.0, 1e-12) << sign;
  }
}

TEST(Progress, AStandingAxisLimitsTheRateFromAnyRate) {
  // Faster than programmed as well, and each axis by its own bounds: the rate is √(bound/c).
  const Two progress(kPeriod);
  for (std::size_t stands = 0; stands < 2; ++stands) {
    for (const double sign : {1.0, -1.0}) {
      for (const double most : {0.5, 1.0, 4.0}) {
        Two::Work w;
        Two::Stage& s = w.stage[0];
        s.d[1 - stands] = 0.1;
        s.low[1 - stands] = -9.0;
        s.high[1 - stands] = 7.0;
        s.c[stands] = sign * 4.0;
        s.d[stands] = -kPeriod * s.c[stands];
        s.low[stands] = -6.0;
        s.high[stands] = 8.0;
        s.most = most;
        progress.reach(w, 1, most);
        EXPECT_NEAR(w.greatest[0], std::min(most, sign > 0.0 ? 8.0 / 4.0 : 6.0 / 4.0), 1e-9)
            << sign << ' ' << most;
      }
    }
  }
}

TEST(Progress, OfTwoAxesThatStandTheTighterBoundCounts) {
  const Two progress(kPeriod);
  for (std::size_t tight = 0; tight < 2; ++tight) {
    for (const double sign : {1.0, -1.0}) {
      Two::Work w;
      Two::Stage& s = w.stage[0];
      for (std::size_t i = 0; i < 2; ++i) {
        s.c[i] = sign * 4.0;
        s.d[i] = -kPeriod * s.c[i];
        s.high[i] = i == tight ? 1.0 : 3.0;
        s.low[i] = i == tight ? -2.0 : -3.0;
      }
      s.most = 1.0;
      progress.reach(w, 1, 1.0);
      EXPECT_NEAR(w.greatest[0], sign > 0.0 ? 0.25 : 0.5, 1e-9) << tight << sign;
    }
  }
}

TEST(Progress, WhereNothingSatisfiesAllBoundsItBrakesOrKeepsItsRate) {
  const Two progress(kPeriod);
  Two::Work w;
  w.stage[0] = straight();
  w.greatest = {1.0, 1.0};
  // x wants at least 3 m/s², y at most 1: the mean of both speeds up, which nobody asked for.
  w.stage[0].low = {{0.3, -0.1}};
  w.stage[0].high = {{0.4, 0.1}};
  w.stage[0].d = {{0.1, 0.1}};
  const Two::Moved moved = progress.advance(w, 1, {0.5, 0.0, 0.0}, 0.0);
  EXPECT_LE(moved.pull, 0.0);
  EXPECT_LE(moved.rate, 0.5);
  EXPECT_NEAR(moved.place, 0.5 * (0.5 + moved.rate), 1e-15);
}

TEST(Progress, GoesAsFastAsTheBoundPermits) {
  const Two progress(kPeriod);
  Two::Work w;
  w.stage[0] = straight();
  w.greatest = {1.0, 1.0};
  const Two::Moved moved = progress.advance(w, 1, {0.5, 0.0, 0.0}, 0.0);
  EXPECT_NEAR(moved.pull, 2.0 / 0.1, 1e-9);  // a = d·θ̈
  EXPECT_NEAR(moved.rate, 0.5 + kPeriod * 20.0, 1e-12);
}

}  // namespace
}  // namespace stribeck::control::progress_test
