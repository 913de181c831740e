#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/replay/moving_rows.hpp>
#include <vector>

namespace stribeck::ident::replay::moving_rows_test {
namespace {

constexpr double kPeriod = 0.02;  // [s]
constexpr double kTop = 1.0;      // [m/s]

/// Rows 0 to 99 at top speed, 100 to 299 as `slow` says, the rest at top speed in the other direction.
template <class Slow>
std::vector<double> velocities(Slow&& slow) {
  std::vector<double> v;
  for (int k = 0; k < 400; ++k) v.push_back(k < 100 ? kTop : k < 300 ? slow(k) : -kTop);
  return v;
}

/// How many of rows 120 to 279 move.
std::size_t moving_in_the_middle(const std::vector<double>& v, const log::Record& record = {}) {
  std::vector<std::size_t> all(v.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::size_t count = 0;
  for (const std::size_t i : moving_rows({record, all, v, 1e-5, kPeriod}, all))
    count += i >= 120 && i < 280 ? 1 : 0;
  return count;
}

TEST(MovingRows, AFeedOfAFiftiethOfTheTopSpeedMoves) {
  EXPECT_EQ(moving_in_the_middle(velocities([](int) { return 0.02 * kTop; })), 160u);
}

TEST(MovingRows, AnAxisThatQuiversStands) {
  const auto quiver = [](double mean) {
    return velocities([mean](int k) { return mean + 0.02 * std::sin(2.0 * kPi * 5.0 * kPeriod * k); });
  };
  EXPECT_EQ(moving_in_the_middle(quiver(0.0)), 0u);
  EXPECT_EQ(moving_in_the_middle(quiver(0.015)), 0u);  // it creeps on in the wind
  EXPECT_EQ(moving_in_the_middle(quiver(0.045)), 160u);
}

// A slow reversal is no rest: the speed changes along a straight line.
TEST(MovingRows, ASlowReversalMoves) {
  const auto v = velocities([](int k) { return 0.04 * (200.0 - k) / 100.0; });
  EXPECT_GT(moving_in_the_middle(v), 90u);
}

// A loop that creeps behind a reference at rest shows no friction of motion.
TEST(MovingRows, StandsWhereItsReferenceDoes) {
  const auto v = velocities([](int) { return 0.02 * kTop; });
  log::Record record;
  double r = 0.0;
  for (int k = 0; k < 400; ++k) record.r.push_back(r += k < 100 || k >= 300 ? kPeriod * kTop : 0.0);
  EXPECT_EQ(moving_in_the_middle(v, record), 0u);
  for (int k = 200; k < 400; ++k) record.r[static_cast<std::size_t>(k)] += 1e-6 * k;
  EXPECT_EQ(moving_in_the_middle(v, record), 80u + 13u);  // from a quarter of a second before it
}

// Without an encoder nothing shows that a speed of a two-hundredth is one.
TEST(MovingRows, AVelocityAloneShowsNoSlowFeed) {
  const auto v = velocities([](int) { return 0.005 * kTop; });
  log::Record record;
  EXPECT_EQ(moving_in_the_middle(v, record), 160u);
  record.integrated = true;
  EXPECT_EQ(moving_in_the_middle(v, record), 0u);
}

/// A sine of 10 mm whose friction of 30 N builds up over `distance` after each reversal, and what a model without pre-sliding makes of it.
struct Sine {
  std::vector<double> x, measured, modelled, friction;
  std::vector<std::size_t> row, moving;

  explicit Sine(double distance, double level = 30.0) {
    double z = 1.0;
    for (std::size_t k = 0; k < 4000; ++k) {
      const double t = 0.005 * static_cast<double>(k), v = 0.01 * std::cos(t);
      x.push_back(0.01 * std::sin(t));
      if (k > 0) {
        const double moved = x[k] - x[k - 1];
        z += ((moved > 0.0 ? 1.0 : -1.0) - z) * -std::expm1(-std::abs(moved) / distance);
      }
      friction.push_back(v > 0.0 ? 30.0 : -30.0);
      modelled.push_back(friction.back() - 2.0 * x.back());
      measured.push_back(level * z - 2.0 * x.back());
      row.push_back(k), moving.push_back(k);
    }
  }
  [[nodiscard]] std::vector<std::size_t> settled() const {
    return settled_rows({x, row, measured, modelled, friction}, moving);
  }
};

TEST(MovingRows, WithoutPreSlidingTheDistanceBehindAReversalIsLeftOut) {
  const Sine sine(0.2e-3);
  const std::vector<std::size_t> settled = sine.settled();
  EXPECT_LT(settled.size(), sine.moving.size());
  EXPECT_GT(settled.size(), sine.moving.size() / 2);
  for (const std::size_t k : settled) EXPECT_LT(std::abs(sine.measured[k] - sine.modelled[k]), 6.0) << k;
}

TEST(MovingRows, AWrongLevelIsNotTakenForFrictionThatBuildsUp) {
  EXPECT_EQ(Sine(1e-9).settled().size(), 4000U);
  EXPECT_EQ(Sine(1e-9, 45.0).settled().size(), 4000U);
  EXPECT_EQ(Sine(1e-9, 20.0).settled().size(), 4000U);
}

}  // namespace
}  // namespace stribeck::ident::replay::moving_rows_test
