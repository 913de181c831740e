#include <gtest/gtest.h>

#include <stribeck/path/contour_error.hpp>
#include <stribeck/path/fourier.hpp>
#include <stribeck/path/reference.hpp>

namespace stribeck::path::path_test {
namespace {

constexpr double kPeriod = 5e-3;

class EveryCurve : public testing::TestWithParam<Shape> {
 protected:
  Curve curve{GetParam(), 10e-3};
};
INSTANTIATE_TEST_SUITE_P(Curve, EveryCurve,
                         testing::Values(Shape::kCircle, Shape::kEight, Shape::kTrifolium));

TEST_P(EveryCurve, DerivativesEqualCentralDifferences) {
  for (const double phi : {0.1, 1.0, 2.7}) {
    const auto d = derivatives<3>(curve, phi);
    const double h = 1e-4;
    const auto up = derivatives<2>(curve, phi + h);
    const auto down = derivatives<2>(curve, phi - h);
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 2; ++axis) {
        EXPECT_NEAR(d[k + 1][axis], (up[k][axis] - down[k][axis]) / (2 * h), 1e-8) << k << " at " << phi;
      }
    }
  }
}

// Implicit equations of the named curves, which know nothing of phi.
TEST_P(EveryCurve, HasTheShapeOfItsName) {
  const double r = curve.size;
  for (const double phi : {0.1, 0.4, 1.0, 2.2, 2.7, 4.0}) {
    const auto p = curve.point(phi);
    const double x = curve.shape == Shape::kTrifolium ? p[0] - r : p[0], y = p[1];
    const double square = x * x + y * y;
    const double left = curve.shape == Shape::kCircle ? square / (r * r) - 1.0
                        : curve.shape == Shape::kEight
                            ? (y * y * r * r - x * x * (r * r - x * x)) / (r * r * r * r)
                            : (square * square - r * x * (3.0 * y * y - x * x)) / (r * r * r * r);
    EXPECT_NEAR(left, 0.0, 1e-12) << phi;
  }
}

TEST_P(EveryCurve, ClosesAfterALapAndNeverStandsStill) {
  const Vec2 gap = curve.point(0.3 + curve.period()) - curve.point(0.3);
  EXPECT_LT(norm(gap), 1e-16);
  for (int i = 0; i < 1000; ++i) EXPECT_GT(stretch(curve, curve.period() * i / 1000.0), 1e-3);
}

TEST_P(EveryCurve, ReferenceTravelsAtTheSpeedOfItsLaw) {
  const SpeedLaw law{9.5e-3, 1.0, lap_length(curve)};
  Reference reference(curve, law);
  double arc = 0.0;
  PathPoint<2> last = reference.point();
  while (!reference.finished()) {
    reference.advance(kPeriod);
    const PathPoint<2> now = reference.point();
    EXPECT_NEAR(norm(now.velocity), law.at(reference.time()).speed, 1e-15);
    arc += norm(now.position - last.position);
    last = now;
  }
  // Chords are shorter than arcs by (kappa s)^2/24 of their length, below 3e-6 here.
  EXPECT_NEAR(arc, law.length(), 1e-5 * law.length());
}

TEST_P(EveryCurve, ParameterFollowsTheArcLengthToItsPromise) {
  // At the end of a run of exactly one lap in all, phi must be one period on: no error of the stepping may
  // gather.
  const double cruise = lap_length(curve) - 9.5e-3 * 1.0;
  Reference reference(curve, {9.5e-3, 1.0, cruise});
  while (!reference.finished()) reference.advance(kPeriod);
  EXPECT_NEAR(reference.point().phi, curve.period(), 1e-10);
}

TEST_P(EveryCurve, RatesAreDerivativesOfTheirMotion) {
  const SpeedLaw law{9.5e-3, 1.0, lap_length(curve)};
  constexpr double kFine = 1e-4;
  Reference reference(curve, law);
  while (reference.time() < 0.6) reference.advance(kFine);  // inside the run-in, where everything changes
  const PathPoint<2> before = reference.point();
  reference.advance(kFine);
  const PathPoint<2> now = reference.point();
  reference.advance(kFine);
  const PathPoint<2> after = reference.point();
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(now.velocity[i], (after.position[i] - before.position[i]) / (2 * kFine), 1e-9);
    EXPECT_NEAR(now.acceleration[i], (after.velocity[i] - before.velocity[i]) / (2 * kFine), 1e-7);
  }
  for (int row = 0; row < 2; ++row) {
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(now.frame_rate[row][i], (after.frame[row][i] - before.frame[row][i]) / (2 * kFine), 1e-6);
      EXPECT_NEAR(now.frame_acceleration[row][i],
                  (after.frame_rate[row][i] - before.frame_rate[row][i]) / (2 * kFine), 1e-5);
    }
  }
  EXPECT_NEAR(norm(now.frame[0]), 1.0, 1e-15);
}

TEST_P(EveryCurve, ExactContourErrorIsTheOffsetThatWasMade) {
  for (const double phi : {0.2, 0.9, 2.2}) {
    const auto q = derivatives<1>(curve, phi);
    const Vec2 normal = (1.0 / norm(q[1])) * Vec2{{-q[1][1], q[1][0]}};
    for (const double offset : {3e-6, -20e-6}) {
      // Searched from a reference 15 um further on.
      const double from = phi + 15e-6 / norm(q[1]);
      EXPECT_NEAR(contour_error(curve, q[0] + offset * normal, from), offset, 1e-15);
    }
  }
}

TEST_P(EveryCurve, LinearisedContourErrorIsOffBySecondOrder) {
  const double phi = 0.9;
  const auto q = derivatives<1>(curve, phi);
  const Vec2 t = (1.0 / norm(q[1])) * q[1];
  const auto difference = [&](double size) {
    const Vec2 e = size * Vec2{{0.6 * t[0] - 0.8 * t[1], 0.6 * t[1] + 0.8 * t[0]}};
    return std::abs(contour_error(curve, q[0] + e, phi) -
                    linearised_contour_error(Vec2{{dot(t, e), t[0] * e[1] - t[1] * e[0]}}));
  };
  const double order = std::log2(difference(40e-6) / difference(20e-6));
  EXPECT_NEAR(order, 2.0, 0.05);
}

TEST_P(EveryCurve, ExactContourErrorFarFromThePathIsTheDistance) {
  // Against brute force: a lost axis must not look as if it were close.
  for (const Vec2 p : {Vec2{{0.3, 0.2}}, Vec2{{-0.7, 0.01}}, Vec2{{0.02, -0.05}}}) {
    for (const double phi : {0.1, 1.5, 2.9}) {
      double least = 1e9;
      for (int i = 0; i < 20000; ++i)
        least = std::min(least, norm(p - curve.point(curve.period() * i / 20000.0)));
      EXPECT_GT(std::abs(contour_error(curve, p, phi)), 0.999 * least);
      EXPECT_LT(std::abs(contour_error(curve, p, phi)), least + 0.03);  // a minimum, if not always the least
    }
  }
}

TEST(ContourError, IsPositiveToTheLeft) {
  const Curve circle{Shape::kCircle, 10e-3};  // counter-clockwise: left is inside
  EXPECT_GT(contour_error(circle, Vec2{{9.999e-3, 0.0}}, 0.0), 0.0);
  EXPECT_LT(contour_error(circle, Vec2{{10.001e-3, 0.0}}, 0.0), 0.0);
}

TEST(ContourError, OfACircleIsTheRadiusDeviationFromAnywhere) {
  const Curve circle{Shape::kCircle, 10e-3};
  EXPECT_NEAR(contour_error(circle, Vec2{{6e-3, 8.1e-3}}, 0.0), 10e-3 - std::hypot(6e-3, 8.1e-3), 1e-17);
}

TEST(SpeedLaw, BeginsAndEndsAtRestWithoutAStep) {
  const SpeedLaw law{9.5e-3, 1.0, 20e-3};
  EXPECT_EQ(law.at(0.0).speed, 0.0);
  EXPECT_EQ(law.at(-1.0).s, 0.0);
  EXPECT_NEAR(law.at(1.0 - 1e-9).speed, 9.5e-3, 1e-15);
  EXPECT_NEAR(law.at(1.0 - 1e-9).acceleration, 0.0, 1e-9);
  EXPECT_NEAR(law.at(law.duration()).s, law.length(), 1e-15);
  EXPECT_NEAR(law.length(), 9.5e-3 * 1.0 + 20e-3, 1e-15);
  // s' = speed, speed' = acceleration, on the way out too.
  for (const double t : {0.3, 0.8, 2.0, law.duration() - 0.4}) {
    EXPECT_NEAR((law.at(t + 1e-6).s - law.at(t - 1e-6).s) / 2e-6, law.at(t).speed, 1e-9);
    EXPECT_NEAR((law.at(t + 1e-6).speed - law.at(t - 1e-6).speed) / 2e-6, law.at(t).acceleration, 1e-8);
  }
}

TEST(SpeedLaw, RunInCoversHalfOfWhatItsEndSpeedWould) {
  // 2 s to 0.3 m/s, 3 s at it, 2 s to rest: the blend is symmetric about its middle, where it is half as fast.
  const SpeedLaw law{0.3, 2.0, 0.9};
  EXPECT_NEAR(law.duration(), 7.0, 1e-15);
  EXPECT_NEAR(law.at(1.0).speed, 0.15, 1e-15);
  EXPECT_NEAR(law.at(2.0).s, 0.3, 1e-15);
  EXPECT_NEAR(law.at(3.5).s, 0.75, 1e-15);
  EXPECT_NEAR(law.at(5.0).s, 1.2, 1e-15);
  EXPECT_NEAR(law.at(6.0).s + law.at(1.0).s, 1.5, 1e-15);
  const SpeedLaw::Point end = law.at(7.5);
  EXPECT_NEAR(end.s, 1.5, 1e-15);
  EXPECT_EQ(end.speed, 0.0);
  EXPECT_EQ(end.acceleration, 0.0);
  EXPECT_EQ(law.at(3.0).acceleration, 0.0);
}

TEST(Curve, LapOfACircleIsItsCircumference) {
  EXPECT_NEAR(lap_length(Curve{Shape::kCircle, 10e-3}), 2 * kPi * 10e-3, 1e-15);
  // SciPy quad of the stretch of the eight: 60.97223470105 mm for R = 10 mm (lemniscate of Gerono).
  EXPECT_NEAR(lap_length(Curve{Shape::kEight, 10e-3}), 60.97223470105e-3, 1e-14);
}

TEST(SpeedLaw, OfWhichOnlyTheSpeedIsGivenRunsInAndOutForASecondEach) {
  SpeedLaw law;
  EXPECT_EQ(law.at(0.5).speed, 0.0);
  law.speed = 0.1;
  EXPECT_EQ(law.duration(), 2.0);
  EXPECT_EQ(law.length(), 0.1);
  EXPECT_EQ(law.at(1.0).speed, 0.1);
}

TEST(Fourier, EachAxisSwingsAboutItsOwnOffset) {
  Fourier<2> c;
  c.axis[0].offset = 0.1;
  c.axis[1].offset = -0.2;
  c.axis[0].terms = {Harmonic{0.01, 1.0, 0.0}};
  c.axis[1].terms = {Harmonic{0.02, 3.0, 0.0}};
  const auto begin = c.point(0.0);
  EXPECT_DOUBLE_EQ(begin[0], 0.11);
  EXPECT_DOUBLE_EQ(begin[1], -0.18);
  const auto half = c.point(kPi);
  EXPECT_DOUBLE_EQ(half[0], 0.09);
  EXPECT_DOUBLE_EQ(half[1], -0.22);
  // A harmonic of which only the size is given is the first one, and begins at its peak.
  Fourier<1> one;
  Harmonic first;
  EXPECT_EQ(first.amplitude, 0.0);
  first.amplitude = 0.01;
  one.axis[0].terms = {first};
  EXPECT_DOUBLE_EQ(one.point(0.0)[0], 0.01);
  EXPECT_DOUBLE_EQ(one.point(kPi)[0], -0.01);
}

/// A parabola of this curvature at its vertex [1/m], from 10 mm before it to 20 mm beyond it: its length is known in closed form.
struct Parabola {
  static constexpr std::size_t kAxes = 2;
  double curvature = 60.0;
  [[nodiscard]] static constexpr double period() noexcept { return 0.03; }
  [[nodiscard]] static constexpr bool closed() noexcept { return false; }
  template <Real T>
  [[nodiscard]] Vec<T, 2> point(const T& phi) const noexcept {
    const T x = phi - T(0.01);
    return {{x, (0.5 * curvature) * x * x}};
  }
  /// From the vertex to x [m].
  [[nodiscard]] double length(double x) const {
    const double u = curvature * x;
    return (u * std::sqrt(1.0 + u * u) + std::asinh(u)) / (2.0 * curvature);
  }
};

TEST(Reference, EachStepEndsWhereTheLawIsAlsoOnABendThatChanges) {
  // Steps of 0.2 mm, in which the path turns by 0.7°: what is left is of the fifth power of that.
  const Parabola c;
  constexpr double kStep = 4e-3;
  const SpeedLaw law{0.05, 0.1, 0.02};
  Reference<Parabola> reference(c, law);
  const double begin = c.length(-0.01);
  for (int k = 0; !reference.finished(); ++k) {
    const double travelled = c.length(reference.point().phi - 0.01) - begin;
    EXPECT_NEAR(travelled, law.at(reference.time()).s, 6e-13) << k;
    reference.advance(kStep);
  }
}

}  // namespace
}  // namespace stribeck::path::path_test
