#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include <stribeck/ident/methods/jog/jog_parts.hpp>

namespace stribeck::ident::methods::jog::jog_jump_test {
namespace {

/// Means at ten speeds in both directions, ascending in speed, each with an error of 0.1 N.
std::vector<Point> means(const std::function<double(double)>& friction) {
  std::vector<Point> out;
  double v = 1e-3;
  for (int i = 0; i < 10; ++i, v *= 1.3) {
    for (const double sign : {1.0, -1.0}) {
      Point p;
      p.v = sign * v;
      p.f = sign * friction(v);
      p.error = 0.1;
      out.push_back(p);
    }
  }
  number_folds(out);
  return out;
}

// 20 N below 3 mm/s and 23 N above: 3 of the mean 21.5.
TEST(JogJump, IsFoundBetweenTheTwoSpeedsWithItsShare) {
  const auto jump = find_jump(means([](double v) { return v < 3e-3 ? 20.0 : 23.0; }));
  ASSERT_TRUE(jump.has_value());
  EXPECT_LT(jump->below, 3e-3);
  EXPECT_GT(jump->above, 3e-3);
  EXPECT_NEAR(jump->above / jump->below, 1.3, 1e-9);
  EXPECT_NEAR(jump->share, 3.0 / 21.5, 1e-9);
}

TEST(JogJump, ACurveHasNone) {
  EXPECT_FALSE(find_jump(means([](double v) { return 20.0 + 5.0 * std::exp(-v / 3e-3) + 100.0 * v; })));
  EXPECT_FALSE(find_jump(means([](double) { return 20.0; })));
}

// Both directions must have it: another day moves friction, a load moves the force.
TEST(JogJump, OfOneDirectionAloneIsNone) {
  std::vector<Point> points = means([](double) { return 20.0; });
  for (Point& p : points) {
    if (p.v > 3e-3) p.f += 3.0;
  }
  EXPECT_FALSE(find_jump(points));
}

TEST(JogJump, NumbersEachSpeedOnce) {
  std::vector<Point> points = means([](double) { return 20.0; });
  EXPECT_EQ(number_folds(points), 10U);
  EXPECT_EQ(points.front().fold, 0U);
  EXPECT_EQ(points.back().fold, 9U);
}

}  // namespace
}  // namespace stribeck::ident::methods::jog::jog_jump_test
