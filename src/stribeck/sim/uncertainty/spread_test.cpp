#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/sim/uncertainty/design.hpp>
#include <stribeck/sim/uncertainty/spread.hpp>

namespace stribeck::sim::spread_test {
namespace {

TEST(Spread, QuantilesAreWithinTheirError) {
  for (const std::uint64_t n : {1U, 2U, 10U, 999U, 20000U}) {
    Spread spread;
    std::vector<double> all;
    double sum = 0.0;
    for (std::uint64_t i = 0; i < n; ++i) {
      // Both signs, zeros, and twelve decades.
      const double u = random_share(5, n, i);
      const double x = u < 0.05 ? 0.0 : (u < 0.3 ? -1.0 : 1.0) * std::pow(10.0, 12.0 * u - 9.0);
      spread.add(x);
      all.push_back(x);
      sum += x;
    }
    std::sort(all.begin(), all.end());
    EXPECT_EQ(spread.count(), n);
    EXPECT_EQ(spread.smallest(), all.front());
    EXPECT_EQ(spread.largest(), all.back());
    EXPECT_NEAR(spread.mean(), sum / static_cast<double>(n), 1e-9 * std::abs(sum));
    for (const double p : {0.01, 0.05, 0.5, 0.9, 0.99}) {
      const double exact = all[static_cast<std::size_t>(std::ceil(p * static_cast<double>(n))) - 1];
      EXPECT_NEAR(spread.quantile(p).value, exact, 1.001 * kSpreadError * std::abs(exact)) << n << ", " << p;
    }
  }
}

TEST(Spread, DeviationOfKnownNumbers) {
  Spread spread;
  for (const double x : {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0}) spread.add(x);
  EXPECT_DOUBLE_EQ(spread.mean(), 5.0);
  EXPECT_NEAR(spread.deviation(), std::sqrt(32.0 / 7.0), 1e-14);
}

// Ranks from the table of the sign test: n = 20, median: 6th and 15th. With 5 values there is no limit of 97.5 %.
TEST(Spread, ConfidenceHasTheRanksOfTheSignTest) {
  Spread spread;
  for (int i = 1; i <= 20; ++i) spread.add(i);
  const Confident median = spread.quantile(0.5);
  EXPECT_NEAR(median.value, 10.0, 0.01);
  EXPECT_NEAR(median.low, 6.0, 0.01);
  EXPECT_NEAR(median.high, 15.0, 0.01);
  Spread few;
  for (int i = 1; i <= 5; ++i) few.add(i);
  EXPECT_TRUE(std::isnan(few.quantile(0.5).low));
  EXPECT_TRUE(std::isnan(few.quantile(0.5).high));
  EXPECT_TRUE(std::isnan(spread.quantile(0.99).high));
}

// The interval covers in 95 % at least, by steps of the binomial distribution at most 97.5 % here: 2000 trials, three deviations of 0.5 %.
TEST(Spread, ConfidenceCovers) {
  for (const double p : {0.5, 0.95}) {
    int covered = 0;
    constexpr int kTrials = 2000;
    for (int t = 0; t < kTrials; ++t) {
      Spread spread;
      for (std::uint64_t i = 0; i < 400; ++i)
        spread.add(1.0 + random_share(9, static_cast<std::uint64_t>(t), i));
      const Confident q = spread.quantile(p);
      covered += q.low <= 1.0 + p && 1.0 + p <= q.high ? 1 : 0;
    }
    EXPECT_GT(covered, 0.935 * kTrials) << p;
    EXPECT_LT(covered, 0.985 * kTrials) << p;
  }
}

TEST(Spread, InfiniteValuesHaveARankAndNoMean) {
  Spread spread;
  for (int i = 1; i <= 90; ++i) spread.add(i);
  for (int i = 0; i < 10; ++i) spread.add(kInfinity);
  EXPECT_EQ(spread.infinite(), 10U);
  EXPECT_TRUE(std::isnan(spread.mean()));
  EXPECT_NEAR(spread.quantile(0.5).value, 50.0, 0.03);
  EXPECT_EQ(spread.quantile(0.95).value, kInfinity);
  EXPECT_EQ(spread.largest(), kInfinity);
  EXPECT_NEAR(spread.shares(1000).back().share, 0.9, 1e-12);
}

TEST(Spread, SharesRiseToOne) {
  Spread spread;
  for (std::uint64_t i = 0; i < 5000; ++i) spread.add(1.0 + random_share(2, i, 0));
  const auto points = spread.shares(100);
  EXPECT_LE(points.size(), 101U);
  EXPECT_EQ(points.back().share, 1.0);
  for (std::size_t i = 1; i < points.size(); ++i) {
    EXPECT_GT(points[i].x, points[i - 1].x);
    EXPECT_GT(points[i].share, points[i - 1].share);
    EXPECT_NEAR(points[i].share, points[i].x - 1.0, 0.03);
  }
}

TEST(Spread, OfNothing) {
  const Spread none;
  EXPECT_TRUE(std::isnan(none.mean()));
  EXPECT_TRUE(std::isnan(none.quantile(0.5).value));
  EXPECT_TRUE(none.shares(10).empty());
}

}  // namespace
}  // namespace stribeck::sim::spread_test
