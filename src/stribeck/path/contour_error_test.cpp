#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stribeck/path/contour_error.hpp>
#include <stribeck/path/curve.hpp>
#include <stribeck/path/fourier.hpp>

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

/// 30 mm along x, bent to a parabola of this curvature [1/m]: an open path.
struct Bent {
  static constexpr std::size_t kAxes = 2;
  double curvature = 0.0;
  [[nodiscard]] static constexpr double period() noexcept { return 0.03; }
  [[nodiscard]] static constexpr bool closed() noexcept { return false; }
  template <Real T>
  [[nodiscard]] Vec<T, 2> point(const T& phi) const noexcept {
    return {{phi, (0.5 * curvature) * phi * phi}};
  }
};

TEST(ContourError, AnOpenPathEndsAtItsEnds) {
  const Bent line;
  for (const double start : {0.0, 0.01}) {
    const NearestPoint before = nearest_from(line, Vec<double, 2>{{-4e-3, 3e-3}}, start);
    EXPECT_TRUE(before.converged);
    EXPECT_EQ(before.phi, 0.0);
    const NearestPoint beyond = nearest_from(line, Vec<double, 2>{{0.034, 3e-3}}, 0.03 - start);
    EXPECT_TRUE(beyond.converged);
    EXPECT_EQ(beyond.phi, 0.03);
  }
  // From the other end it is found among points all along the path.
  for (const double start : {0.0, 0.015, 0.03}) {
    EXPECT_NEAR(contour_error(line, Vec<double, 2>{{-4e-3, 3e-3}}, start), 5e-3, 1e-15);
    EXPECT_NEAR(contour_error(line, Vec<double, 2>{{0.034, -3e-3}}, start), -5e-3, 1e-15);
  }
}

TEST(ContourError, IsFoundAllAlongAnOpenPath) {
  // Farther along than the search from the reference goes.
  const Bent line;
  for (const double at : {0.001, 0.01, 0.02, 0.029}) {
    for (const double start : {0.0, 0.03})
      EXPECT_NEAR(contour_error(line, Vec<double, 2>{{at, -2e-3}}, start), -2e-3, 1e-15)
          << at << ' ' << start;
  }
}

TEST(ContourError, AnOpenPathIsAsLongAsCalculusSays) {
  EXPECT_NEAR(lap_length(Bent{}), 0.03, 1e-15);
  const double end = 80.0 * 0.03;  // slope of the parabola there
  const double length = (end * std::sqrt(1.0 + end * end) + std::asinh(end)) / (2.0 * 80.0);
  EXPECT_NEAR(lap_length(Bent{80.0}), length, 1e-7 * length);
}

/// An ellipse of 20 mm by 8 mm.
Fourier<2> ellipse() {
  Fourier<2> c;
  c.axis[0].terms = {Harmonic{20e-3, 1.0, 0.0}};
  c.axis[1].terms = {Harmonic{8e-3, 1.0, -0.5 * kPi}};
  return c;
}

TEST(ContourError, AClosedPathHasNoSeam) {
  const auto c = ellipse();
  const double lap = c.period();
  for (const double at : {-0.02 * lap, 0.02 * lap}) {
    const auto q = derivatives<1>(c, at);
    const double size = 1e-3 / norm(q[1]);
    const Vec<double, 2> inside = q[0] + Vec<double, 2>{{-size * q[1][1], size * q[1][0]}};
    const NearestPoint from = nearest_from(c, inside, -at);  // from the other side of the seam
    EXPECT_TRUE(from.converged);
    EXPECT_NEAR(from.phi, at, 1e-9);
    EXPECT_NEAR(contour_error(c, inside, -at), 1e-3, 1e-12);  // to the left, which is inside
  }
}

TEST(ContourError, IsFoundFromFarAlongThePathToo) {
  const auto c = ellipse();
  for (int k = 0; k < 24; ++k) {
    const double at = c.period() * k / 24;
    const auto q = derivatives<1>(c, at);
    const double size = 0.5e-3 / norm(q[1]);
    const Vec<double, 2> outside = q[0] + Vec<double, 2>{{size * q[1][1], -size * q[1][0]}};
    EXPECT_NEAR(contour_error(c, outside, at + 0.2 * c.period()), -0.5e-3, 1e-11) << k;
    // Half of the radius of curvature inside, where Newton's steps need the curvature.
    const auto bend = derivatives<2>(c, at);
    const double speed = norm(bend[1]);
    const double turn = (bend[1][0] * bend[2][1] - bend[1][1] * bend[2][0]) / (speed * speed * speed);
    const double deep = std::min(0.5 / turn, 3e-3);
    const Vec<double, 2> inside = q[0] + Vec<double, 2>{{-deep / speed * q[1][1], deep / speed * q[1][0]}};
    const NearestPoint found = nearest_from(c, inside, at + 0.02);
    EXPECT_TRUE(found.converged) << k;
    EXPECT_NEAR(found.phi, at, 1e-9) << k;
  }
}

}  // namespace
}  // namespace stribeck::path::contour_error_test
