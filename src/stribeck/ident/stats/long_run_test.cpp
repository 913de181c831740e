#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include <numeric>
#include <random>
#include <stribeck/ident/stats/long_run.hpp>

namespace stribeck::ident::stats::long_run_test {
namespace {

/// First-order noise of variance 1.
std::vector<double> coloured(std::size_t n, double rho, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> e;
  double x = normal(engine);
  for (std::size_t k = 0; k < n; ++k) {
    e.push_back(x);
    x = rho * x + std::sqrt(1.0 - rho * rho) * normal(engine);
  }
  return e;
}

std::vector<std::size_t> rows(std::size_t n) {
  std::vector<std::size_t> at(n);
  std::iota(at.begin(), at.end(), std::size_t{0});
  return at;
}

double variance_of_sum(const std::vector<double>& e, const std::vector<std::size_t>& at) {
  const std::vector<int> record(e.size(), 0);
  LongRun sum(1, memory_of(e, record, at));
  for (std::size_t i = 0; i < e.size(); ++i) *sum.row(0, at[i]) += e[i];
  return sum.covariance()[0];
}

// Σ over all lags of ρ^|l| is (1 + ρ)/(1 − ρ): 19 for ρ = 0.9, so that white-noise errors are 4.4 times too
// small. The average over 40 seeds of 20 000 rows has a standard error of 2 %.
TEST(LongRun, FindsTheLongRunVarianceOfFirstOrderNoise) {
  const std::size_t n = 20000;
  double mean = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed)
    mean += variance_of_sum(coloured(n, 0.9, seed), rows(n)) / (n * 40.0);
  EXPECT_NEAR(mean, 19.0, 1.5);
}

TEST(LongRun, WhiteNoiseHasTheVarianceOfItsRows) {
  const std::size_t n = 20000;
  const std::vector<double> e = coloured(n, 0.0, 7);
  EXPECT_NEAR(memory_of(e, std::vector<int>(n, 0), rows(n)).rows, 0.5, 1e-12);
  EXPECT_NEAR(variance_of_sum(e, rows(n)) / n, 1.0, 0.15);
}

// Rows left out keep their place: with every second second dropped the variance halves, the correlation
// stays.
TEST(LongRun, GapsNeitherLoseNorInventCorrelation) {
  const std::size_t n = 20000;
  double mean = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const std::vector<double> all = coloured(n, 0.9, seed);
    std::vector<double> e;
    std::vector<std::size_t> at;
    for (std::size_t k = 0; k < n; ++k) {
      if (k / 500 % 2 == 0) e.push_back(all[k]), at.push_back(k);
    }
    mean += variance_of_sum(e, at) / (n / 2.0 * 40.0);
  }
  EXPECT_NEAR(mean, 19.0, 2.0);
}

// Correlation over hundreds of rows, in two records with gaps: ½ + Σ ρ^l is 49.5 for ρ = 0.98, 2.5 of them below the lag where it ends.
TEST(LongRun, ALongMemoryIsThatOfItsNoise) {
  const std::size_t n = 20000;
  double mean = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const std::vector<double> first = coloured(n, 0.98, seed), second = coloured(n, 0.98, 100 + seed);
    std::vector<double> e;
    std::vector<int> record;
    std::vector<std::size_t> at;
    for (const int r : {0, 1}) {
      for (std::size_t k = 0; k < n; ++k) {
        if (k % 700 < 100) continue;
        e.push_back((r == 0 ? first : second)[k]), record.push_back(r), at.push_back(k);
      }
    }
    mean += memory_of(e, record, at).rows / 40.0;
  }
  EXPECT_NEAR(mean, 47.0, 3.0);
}

TEST(LongRun, RecordsAreIndependent) {
  LongRun sum(1, {5.0, 1, 10});
  *sum.row(0, 0) += 3.0;
  *sum.row(1, 0) += 4.0;
  EXPECT_DOUBLE_EQ(sum.covariance()[0], 25.0);
}

}  // namespace
}  // namespace stribeck::ident::stats::long_run_test
