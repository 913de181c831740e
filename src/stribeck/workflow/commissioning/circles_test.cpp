#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/workflow/commissioning/circles.hpp>

namespace stribeck::workflow::commissioning::circles_test {
namespace {

RunningAxis axis_of(const char* name, char letter, double low, double high) {
  RunningAxis a;
  a.name = name;
  a.letter = letter;
  a.limits.travel_min = low;
  a.limits.travel_max = high;
  a.limits.speed = 0.02;
  a.limits.acceleration = 0.1;
  return a;
}

TEST(Circles, HaveRoom) {
  RunningAxes all;
  all.axes = {axis_of("x", 'X', -0.1, 0.1), axis_of("z", 'Z', -0.05, -0.01)};
  const CirclePlan plan = plan_circle(all);
  ASSERT_NE(plan.u, nullptr);
  EXPECT_EQ(plan.plane, "G18");
  EXPECT_DOUBLE_EQ(plan.middle_u, 0.0);
  EXPECT_DOUBLE_EQ(plan.middle_v, -0.03);
  EXPECT_NEAR(plan.radius, 0.006, 1e-12) << "0.3 of 20 mm";
  EXPECT_NEAR(plan.speed, 0.01, 1e-12);
  EXPECT_NE(plan.laps(true).find("G2 X6.0000 Z-30.0000 I-6.0000 K0"), std::string::npos) << plan.laps(true);
  all.axes.pop_back();
  EXPECT_EQ(plan_circle(all).u, nullptr);
}

TEST(Circles, TheFirstLapDoesNotCount) {
  RunningAxes all;
  all.axes = {axis_of("x", 'X', -0.1, 0.1), axis_of("y", 'Y', -0.1, 0.1)};
  const CirclePlan plan = plan_circle(all);
  for (const double way : {1.0, -1.0}) {
    AxisRows u;
    AxisRows v;
    constexpr int kRows = 3000;  // at rest, three laps, at rest
    for (int k = -100; k < kRows + 100; ++k) {
      const double angle = way * 2.0 * kPi * 3.0 * std::clamp(k, 0, kRows) / kRows;
      for (AxisRows* rows : {&u, &v}) {
        const double at = plan.radius * (rows == &u ? std::cos(angle) : std::sin(angle));
        rows->r.push_back(at);
        rows->x.push_back(k);
        rows->f.push_back(0.0);
      }
    }
    const auto [a, b] = counted_laps(plan, u, v);
    ASSERT_FALSE(a.x.empty());
    EXPECT_NEAR(a.x.front(), 1000.0, 2.0) << "row after the first lap";
    // 0.2 rad of 6 pi are 32 rows.
    EXPECT_NEAR(a.x.back(), 3000.0 - 32.0, 2.0);
    EXPECT_EQ(a.x.size(), b.x.size());
  }
}

}  // namespace
}  // namespace stribeck::workflow::commissioning::circles_test
