#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stribeck/core/numbers.hpp>
#include <stribeck/sim/uncertainty/distribution.hpp>

namespace stribeck::sim::distribution_test {
namespace {

struct Moments {
  double mean;
  double sd;
  double fourth;  ///< over sd⁴
};

/// By the midpoint rule over the share.
Moments moments(const Distribution& d) {
  constexpr int kPoints = 400000;
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) sum += value_at(d, (i + 0.5) / kPoints);
  const double mean = sum / kPoints;
  double square = 0.0;
  double fourth = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const double x = value_at(d, (i + 0.5) / kPoints) - mean;
    square += x * x;
    fourth += x * x * x * x;
  }
  const double variance = square / kPoints;
  return {mean, std::sqrt(variance), fourth / kPoints / (variance * variance)};
}

TEST(Distribution, MomentsOfUniformAndLogUniform) {
  const Moments u = moments(Uniform<double>{0.7, 1.3});
  EXPECT_NEAR(u.mean, 1.0, 1e-9);
  EXPECT_NEAR(u.sd, 0.6 / std::sqrt(12.0), 1e-9);
  EXPECT_NEAR(u.fourth, 1.8, 1e-6);
  const Moments l = moments(LogUniform<double>{1.0, 10.0});
  const double mean = 9.0 / std::log(10.0);
  EXPECT_NEAR(l.mean, mean, 1e-8);
  EXPECT_NEAR(l.sd, std::sqrt(99.0 / (2.0 * std::log(10.0)) - mean * mean), 1e-8);
}

// The ends at 5 sd take 1.5e-5 of the variance.
TEST(Distribution, MomentsOfNormalAndLogNormal) {
  const Moments n = moments(Normal<double>{3.0, 0.5, {}, {}});
  EXPECT_NEAR(n.mean, 3.0, 1e-9);
  EXPECT_NEAR(n.sd, 0.5, 1e-5);
  EXPECT_NEAR(n.fourth, 3.0, 1e-3);
  constexpr double kSigma = 0.25;
  const Moments l = moments(LogNormal<double>{2.0, kSigma, {}, {}});
  EXPECT_NEAR(l.mean, 2.0 * std::exp(0.5 * kSigma * kSigma), 1e-5);
  EXPECT_NEAR(l.sd, l.mean * std::sqrt(std::expm1(kSigma * kSigma)), 1e-4);
  EXPECT_NEAR(value_at(LogNormal<double>{2.0, kSigma, {}, {}}, 0.5), 2.0, 1e-12);
}

TEST(Distribution, NormalBetweenEnds) {
  // Half of a normal distribution.
  const Moments half = moments(Normal<double>{0.0, 1.0, 0.0, 8.0});
  EXPECT_NEAR(half.mean, std::sqrt(2.0 / std::numbers::pi), 1e-5);
  EXPECT_NEAR(half.sd, std::sqrt(1.0 - 2.0 / std::numbers::pi), 1e-5);
  // Its mirror gives the mirrored values, also far out.
  for (const double u : {0x1p-30, 0.125, 0.5, 0.875}) {  // 1 − u is exact
    EXPECT_NEAR(value_at(Normal<double>{0.0, 1.0, -12.0, -10.0}, u),
                -value_at(Normal<double>{0.0, 1.0, 10.0, 12.0}, 1.0 - u), 1e-9);
  }
  const double far = value_at(Normal<double>{0.0, 1.0, 10.0, 12.0}, 0.5);
  EXPECT_GT(far, 10.0);
  EXPECT_LT(far, 10.2);
}

TEST(Distribution, ListAndStepsAreEquallyLikely) {
  const Distribution list = ListOf<double>{{3.0, -1.0, 7.0}};
  EXPECT_EQ(value_at(list, 0.1), 3.0);
  EXPECT_EQ(value_at(list, 0.4), -1.0);
  EXPECT_EQ(value_at(list, 0.999999), 7.0);
  const Distribution steps = Steps<double>{0.1, 0.7, 4};
  EXPECT_EQ(number_of_values(steps), 4U);
  EXPECT_EQ(value_number(steps, 0), 0.1);
  EXPECT_NEAR(value_number(steps, 1), 0.3, 1e-15);
  EXPECT_EQ(value_number(steps, 3), 0.7);
  EXPECT_EQ(value_at(steps, 0.99), 0.7);
  EXPECT_EQ(number_of_values(Uniform<double>{0.0, 1.0}), 0U);
}

TEST(Distribution, StaysWithinItsSupport) {
  const std::vector<Distribution> all{
      Uniform<double>{-2.0, 3.0},          LogUniform<double>{1e-3, 7.0},
      Normal<double>{1.0, 0.2, {}, {}},    Normal<double>{1.0, 0.2, 0.9, {}},
      LogNormal<double>{3.0, 1.0, {}, {}}, LogNormal<double>{3.0, 1.0, {}, 3.5},
      ListOf<double>{{2.0, -5.0}},         Steps<double>{1.0, 2.0, 3}};
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(problem(all[i]), "") << i;
    const auto [low, high] = support(all[i]);
    double before = -kInfinity;
    for (const double u : {1e-17, 1e-9, 0.2, 0.6, 1.0 - 1e-12, 1.0 - 0x1p-53}) {
      const double x = value_at(all[i], u);
      EXPECT_GE(x, low - 1e-12 * std::abs(low)) << i;
      EXPECT_LE(x, high + 1e-12 * std::abs(high)) << i;
      EXPECT_TRUE(i == 6 || x >= before) << i;  // a list has its own order
      before = x;
    }
  }
}

TEST(Distribution, ProblemsAreNamed) {
  EXPECT_EQ(problem(Uniform<double>{1.0, 1.0}), "high: expected a value above low, or nothing varies");
  EXPECT_EQ(problem(Normal<double>{1.0, -0.1, {}, {}}),
            "sd: got -0.1, expected a standard deviation above 0");
  EXPECT_EQ(problem(Normal<double>{1.0, 0.0, {}, {}}), "sd: got 0, expected a standard deviation above 0");
  EXPECT_NE(problem(Normal<double>{1.0, 0.1, 2.0, 1.0}), "");
  EXPECT_NE(problem(Normal<double>{1.0, 0.1, 20.0, 21.0}), "");
  EXPECT_EQ(problem(LogNormal<double>{0.0, 0.1, {}, {}}),
            "median: got 0, expected a median above 0, whose logarithm exists");
  EXPECT_NE(problem(LogNormal<double>{1.0, -0.1, {}, {}}), "");
  EXPECT_NE(problem(LogNormal<double>{1.0, 0.1, 0.0, {}}), "");
  EXPECT_NE(problem(LogUniform<double>{0.0, 1.0}), "");
  EXPECT_EQ(problem(ListOf<double>{}), "values: got an empty list, expected one value or more");
  EXPECT_NE(problem(Steps<double>{0.0, 1.0, 1}), "");
}

}  // namespace
}  // namespace stribeck::sim::distribution_test
