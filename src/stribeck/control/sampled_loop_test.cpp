#include <gtest/gtest.h>

#include <stribeck/control/sampled_loop.hpp>

namespace stribeck::control::sampled_loop_test {
namespace {

TEST(RootsInsideUnitCircle, KnowsPolynomialsOfKnownRoots) {
  // (z − 0.9)(z + 0.8), (z − 1.1)(z + 0.8), z² − 2·0.99·cos(1)z + 0.99², the same with 1.01.
  EXPECT_TRUE(roots_inside_unit_circle<3>({-0.72, -0.1, 1.0}));
  EXPECT_FALSE(roots_inside_unit_circle<3>({-0.88, -0.3, 1.0}));
  constexpr double kCos1 = 0.54030230586813977;
  EXPECT_TRUE(roots_inside_unit_circle<3>({0.9801, -1.98 * kCos1, 1.0}));
  EXPECT_FALSE(roots_inside_unit_circle<3>({1.0201, -2.02 * kCos1, 1.0}));
  // numpy.poly([0.5, -0.7, 0.2 + 0.9j, 0.2 - 0.9j]) has 0.922 as largest root; with 0.5 + 0.9j it is 1.03.
  EXPECT_TRUE(roots_inside_unit_circle<5>({-0.2975, 0.31, 0.42, -0.2, 1.0}));
  EXPECT_FALSE(roots_inside_unit_circle<5>({-0.371, 0.562, 0.51, -0.8, 1.0}));
}

TEST(SampledLoop, PdIsStableUpToTheClosedForm) {
  for (const double period : {1e-4, 1e-3, 5e-3}) {
    for (const double q : {0.05, 0.3, 0.8}) {  // k_v T/2
      const double kv = 2.0 * q / period;
      const double border = 2.0 * kv * (2.0 - kv * period) / (2.0 + kv * period) / period;
      EXPECT_TRUE(sampled_loop_stable(0.999 * border, kv, 0.0, period));
      EXPECT_FALSE(sampled_loop_stable(1.001 * border, kv, 0.0, period));
    }
    EXPECT_FALSE(sampled_loop_stable(1.0, 2.0 / period, 0.0, period));
  }
}

TEST(SampledLoop, TakesNoGainOfTheWrongSign) {
  EXPECT_FALSE(sampled_loop_stable(-1.0, 80.0, 0.0, 1e-3));
  EXPECT_FALSE(sampled_loop_stable(1600.0, -80.0, 0.0, 1e-3));
  EXPECT_FALSE(sampled_loop_stable(1600.0, 80.0, -10.0, 1e-3));
  EXPECT_FALSE(sampled_loop_stable(1600.0, 0.0, 0.0, 1e-3));
}

}  // namespace
}  // namespace stribeck::control::sampled_loop_test
