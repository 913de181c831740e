#include <gtest/gtest.h>

#include <stribeck/path/contour_error.hpp>
#include <stribeck/path/curve.hpp>

namespace stribeck::path::contour_error_test {
namespace {

// Positive to the left of the direction of travel, in every quarter of the curve.
TEST(ContourError, HasTheSignOfTheSideOfThePath) {
  const Curve eight{Shape::kEight, 10e-3};
  for (int k = 0; k < 40; ++k) {
    const double phi = (k + 0.37) * eight.period() / 40.0;
    const auto q = derivatives<1>(eight, phi);
    const double length = norm(q[1]);
    const Vec<double, 2> left{{-q[1][1] / length, q[1][0] / length}};
    for (const double off : {2e-6, -2e-6})
      EXPECT_NEAR(contour_error(eight, q[0] + off * left, phi), off, 1e-12) << phi;
  }
}

}  // namespace
}  // namespace stribeck::path::contour_error_test
