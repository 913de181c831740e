#include <gtest/gtest.h>

#include <cmath>

#include <stribeck/ident/stats/least_squares.hpp>

namespace stribeck::ident::stats::least_squares_test {
namespace {

/// Rosenbrock's valley as squares: 10·(y − x²) and 1 − x.
struct Valley : Residuals {
  [[nodiscard]] int count() const override { return 2; }
  [[nodiscard]] int parameters() const override { return 2; }
  bool evaluate(const double* p, double* r, double* jacobian) const override {
    if (p[0] < -2.0) return false;
    r[0] = 10.0 * (p[1] - p[0] * p[0]);
    r[1] = 1.0 - p[0];
    if (jacobian == nullptr) return true;
    jacobian[0] = -20.0 * p[0], jacobian[2] = 10.0;
    jacobian[1] = -1.0, jacobian[3] = 0.0;
    return true;
  }
};

// Closed form: the minimum 0 at (1, 1). The valley is flat: with its default tolerances the search ends where a step of 1e-8 of p is
// all that is left, so this test asks for tighter ones.
TEST(LeastSquares, FindsTheEndOfRosenbrocksValley) {
  Eigen::VectorXd p(2);
  p << -1.2, 1.0;
  DescentOptions tight;
  tight.gradient_tolerance = 1e-14;
  tight.parameter_tolerance = 1e-14;
  tight.function_tolerance = 1e-16;
  const Descent end = minimise_squares(Valley{}, p, tight);
  EXPECT_NEAR(p(0), 1.0, 1e-6);
  EXPECT_NEAR(p(1), 1.0, 1e-6);
  EXPECT_LT(end.cost, 1e-12);
}

// ½·(10·(1 − 1.44))² + ½·2.2² = 12.1 at the start: one iteration cannot end the search, but never climbs.
TEST(LeastSquares, EndsWhenTheIterationsAreUsedUp) {
  Eigen::VectorXd p(2);
  p << -1.2, 1.0;
  DescentOptions one;
  one.iterations = 1;
  const Descent end = minimise_squares(Valley{}, p, one);
  EXPECT_GT(end.cost, 0.1);
  EXPECT_LE(end.cost, 12.1 + 1e-9);
}

}  // namespace
}  // namespace stribeck::ident::stats::least_squares_test
