#include <gtest/gtest.h>

#include <stribeck/friction/conventional.hpp>
#include <stribeck/friction/table.hpp>
#include <stribeck/friction/test_maps.hpp>

namespace stribeck::friction::table_test {
namespace {

template <class M>
double largest_deviation(const M& map, double v_max) {
  const Table table = Table::build(map, v_max);
  double worst = 0.0;
  for (int i = -20000; i <= 20000; ++i) {
    const double v = v_max * i / 20000.0;
    if (i == 0) continue;
    worst = std::max(worst, std::abs(table.parts(v, 0.0).level - map.parts(v, 0.0).level));
    EXPECT_DOUBLE_EQ(table.parts(v, 0.0).viscous, map.parts(v, 0.0).viscous);
  }
  return worst;
}

TEST(Table, FollowsTable23WithinATenthOfAMillinewton) {
  // The header promises 1e-4 N; two-sided, so that a metric that sees nothing fails too. The range ends
  // inside the grid: the kink of the held border lies on no cell edge.
  EXPECT_LT(largest_deviation(test::table_2_3_x(), 12e-3), 1e-4);
  EXPECT_LT(largest_deviation(test::table_2_3_y(), 12e-3), 2e-2) << "narrow third term of y, v < 0";
  EXPECT_GT(largest_deviation(test::table_2_3_x(), 9.5e-3), 1e-9);
}

TEST(Table, ResolvesAStribeckRiseOfMicrometresPerSecond) {
  const Conventional<double> map{20.0, 5e3, Stribeck<double>{35.0, 20e-6, 2.0}};
  EXPECT_LT(largest_deviation(map, 20e-3), 1e-4 * 35.0);
}

TEST(Table, HoldsTheBorderAndStaysFiniteAtRest) {
  const auto map = test::table_2_3_x();
  const Table table = Table::build(map, 9.5e-3);
  EXPECT_NEAR(table.parts(1.0, 0.0).level, map.parts(9.5e-3, 0.0).level, 1e-3);
  EXPECT_NEAR(table.parts(0.0, 0.0).level, map.parts(0.0, 0.0).level, 1e-4);
  EXPECT_NEAR(table.parts(-1e-300, 0.0).level, map.parts(-1e-12, 0.0).level, 1e-4);
}

}  // namespace
}  // namespace stribeck::friction::table_test
