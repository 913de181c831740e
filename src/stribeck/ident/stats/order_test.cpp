#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::stats::order_test {
namespace {

// By hand: 1 2 3 5 8 in ascending order.
TEST(Order, MedianIsTheMiddleElement) {
  EXPECT_EQ(median({5.0, 1.0, 3.0, 8.0, 2.0}), 3.0);
  EXPECT_EQ(median({5.0, 1.0, 3.0, 2.0}), 3.0) << "of an even number the upper of the two in the middle";
  EXPECT_EQ(median({7.0}), 7.0);
}

TEST(Order, QuantilesGoFromTheSmallestToTheLargest) {
  const std::vector<double> values{5.0, 1.0, 3.0, 8.0, 2.0};
  EXPECT_EQ(quantile(values, 0.0), 1.0);
  EXPECT_EQ(quantile(values, 0.25), 2.0);
  EXPECT_EQ(quantile(values, 0.99), 5.0) << "below the last element until the share is 1";
  EXPECT_EQ(quantile(values, 1.0), 8.0);
  EXPECT_EQ(nth_smallest(values, 3), 5.0);
}

TEST(Order, AnEmptyListHasNoQuantile) {
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
  EXPECT_TRUE(std::isnan(thinned_quantile({}, 0.5)));
}

// Invariance: the mirrored list has the mirrored median.
TEST(Order, MirroredListHasTheMirroredMedian) {
  const std::vector<double> values{4.0, -2.0, 9.0, 0.5, 1.0};
  std::vector<double> mirrored;
  for (const double x : values) mirrored.push_back(-x);
  EXPECT_EQ(median(mirrored), -median(values));
}

// 0, 1, … 299999: every sixth element stays, so that the median of those is off by at most six.
TEST(Order, ThinningALongListMovesAQuantileByLessThanItsStride) {
  std::vector<double> values;
  for (int k = 0; k < 300000; ++k) values.push_back(k);
  EXPECT_NEAR(thinned_quantile(values, 0.5), quantile(values, 0.5), 6.0);
  EXPECT_NE(thinned_quantile(values, 0.5), quantile(values, 0.5)) << "the list was not thinned";
  values.resize(100000);
  EXPECT_EQ(thinned_quantile(values, 0.3), quantile(values, 0.3)) << "up to 100 000 elements all count";
}

TEST(Order, MagnitudesLoseTheirSign) {
  EXPECT_EQ(magnitudes({-2.0, 0.0, 3.0}), (std::vector<double>{2.0, 0.0, 3.0}));
}

}  // namespace
}  // namespace stribeck::ident::stats::order_test
