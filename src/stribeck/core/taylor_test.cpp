#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/core/taylor.hpp>
#include <utility>

namespace stribeck::taylor_test {
namespace {

TEST(Taylor, GivesTheKnownDerivativesOfElementaryFunctions) {
  const auto x = Taylor<4>::variable(0.7);
  const double s = std::sin(0.7);
  const double c = std::cos(0.7);
  for (const auto& [k, want] : {std::pair{0, s}, {1, c}, {2, -s}, {3, -c}, {4, s}}) {
    EXPECT_NEAR(sin(x).derivative(k), want, 1e-15) << k;
  }
  for (int k = 0; k <= 4; ++k) EXPECT_NEAR(exp(x).derivative(k), std::exp(0.7), 1e-14);
  // (1/x)'''' = 24/x^5; sqrt(x)''' = 3/8 x^(-5/2)
  EXPECT_NEAR((Taylor<4>(1.0) / x).derivative(4), 24.0 / std::pow(0.7, 5), 1e-11);
  EXPECT_NEAR(sqrt(x).derivative(3), 0.375 * std::pow(0.7, -2.5), 1e-13);
}

TEST(Taylor, SineOfWhatIsNotLinearFollowsTheChainRule) {
  const auto x = Taylor<4>::variable(0.7);
  const double s = std::sin(0.49);
  const double c = std::cos(0.49);
  // (sin x²)'' = 2 cos x² − 4x² sin x²,  (cos x²)' = −2x sin x²
  EXPECT_NEAR(sin(x * x).derivative(2), 2.0 * c - 4.0 * 0.49 * s, 1e-14);
  EXPECT_NEAR(sin(x * x).derivative(3), -12.0 * 0.7 * s - 8.0 * 0.343 * c, 1e-13);
  EXPECT_NEAR(cos(x * x).derivative(1), -2.0 * 0.7 * s, 1e-15);
  // 2x by the short way and by x + x² − x²
  EXPECT_NEAR(sin(2.0 * x).derivative(4), sin(2.0 * x + x * x - x * x).derivative(4), 1e-13);
}

// sin(t + t²) = t + t² − t³/6 − t⁴/2 + …: coefficients of one are no zeros.
TEST(Taylor, SineOfASeriesWhoseCoefficientsAreOne) {
  Taylor<2> two(0.0);
  two.c[1] = two.c[2] = 1.0;
  EXPECT_DOUBLE_EQ(sin(two).c[2], 1.0);
  EXPECT_DOUBLE_EQ(cos(two).c[2], -0.5);
}

TEST(Taylor, AngleOfAPointOnACircleIsItsParameter) {
  // Every quadrant; the radius does not matter, even when it changes.
  for (const double phi : {0.4, 2.0, -2.5, -0.9}) {
    const auto u = Taylor<4>::variable(phi);
    const Taylor<4> radius = Taylor<4>(2.0) + u * u;
    const Taylor<4> angle = atan2(radius * sin(u), radius * cos(u));
    EXPECT_NEAR(angle.c[0], phi, 1e-15);
    EXPECT_NEAR(angle.derivative(1), 1.0, 1e-14);
    for (int k = 2; k <= 4; ++k) EXPECT_NEAR(angle.derivative(k), 0.0, 1e-12) << k;
  }
  // atan u at 0.7: 1/(1 + u²), −2u/(1 + u²)², (6u² − 2)/(1 + u²)³.
  const Taylor<4> a = atan2(Taylor<4>::variable(0.7), Taylor<4>(1.0));
  EXPECT_NEAR(a.derivative(1), 1.0 / 1.49, 1e-15);
  EXPECT_NEAR(a.derivative(2), -1.4 / (1.49 * 1.49), 1e-15);
  EXPECT_NEAR(a.derivative(3), (6.0 * 0.49 - 2.0) / (1.49 * 1.49 * 1.49), 1e-14);
}

TEST(Taylor, ObeysPythagorasAndTheProductRuleToEveryOrder) {
  const auto x = Taylor<5>::variable(-1.3);
  const auto one = sin(x) * sin(x) + cos(x) * cos(x);
  EXPECT_NEAR(one.derivative(0), 1.0, 1e-15);
  for (int k = 1; k <= 5; ++k) EXPECT_NEAR(one.derivative(k), 0.0, 1e-12) << k;
  const auto back = (x * exp(x)) / exp(x);
  EXPECT_NEAR(back.derivative(1), 1.0, 1e-14);
  EXPECT_NEAR(back.derivative(5), 0.0, 1e-11);
}

}  // namespace
}  // namespace stribeck::taylor_test
