#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <stribeck/path/five_axis.hpp>
#include <stribeck/path/reference.hpp>

namespace stribeck::path::five_axis_test {
namespace {

using V3 = Vec<double, 3>;
using V5 = Vec<double, 5>;

constexpr double kDegree = kPi / 180.0;

TiltingTable table() { return {0.1, {{3e-3, -2e-3, 50e-3}}}; }

ConeFrustum frustum() { return {table(), {{1e-3, 0.0, 5e-3}}, 20e-3, 30.0 * kDegree, 15.0 * kDegree}; }

V5 random_axes(std::mt19937& g) {
  std::uniform_real_distribution<double> length(-50e-3, 50e-3);
  std::uniform_real_distribution<double> tilt(0.1, 1.4);
  std::uniform_real_distribution<double> turn(-3.0, 3.0);
  return {{length(g), length(g), length(g), 0.1 * tilt(g), 0.1 * turn(g)}};
}

TEST(TiltingTable, HasTheKnownValuesAtQuarterTurns) {
  const TiltingTable t{0.2, {}};
  const double quarter = 0.2 * 0.5 * kPi;
  // Untilted, the workpiece turns with C under the tool: what was ahead on x is seen on −y.
  const V3 turned = t.tip(V5{{1.0, 0.0, 2.0, 0.0, quarter}});
  EXPECT_NEAR(turned[0], 0.0, 1e-15);
  EXPECT_NEAR(turned[1], -1.0, 1e-15);
  EXPECT_NEAR(turned[2], 2.0, 1e-15);
  // Tilted by a right angle the tool lies along +y of the workpiece.
  const V3 lying = t.direction(V5{{0.0, 0.0, 0.0, quarter, 0.0}});
  EXPECT_NEAR(lying[0], 0.0, 1e-15);
  EXPECT_NEAR(lying[1], 1.0, 1e-15);
  EXPECT_NEAR(lying[2], 0.0, 1e-15);
}

TEST(TiltingTable, ThereAndBackIsTheSamePlace) {
  std::mt19937 g(5);
  const TiltingTable t = table();
  for (int i = 0; i < 1000; ++i) {
    const V5 q = random_axes(g);
    const V5 back = t.axes(t.tip(q), t.direction(q));
    // Rounding of a sine over that of its angle: 1e-16 · 50 mm/sin 0.1.
    for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(back[k], q[k], 1e-15) << "case " << i << " axis " << k;
    EXPECT_NEAR(norm(t.direction(q)), 1.0, 1e-15);
  }
}

TEST(TiltingTable, WorkpieceKeepsDistancesAndTheTurnOfCMatters) {
  std::mt19937 g(6);
  const TiltingTable t = table();
  for (int i = 0; i < 100; ++i) {
    V5 q = random_axes(g);
    V5 p = random_axes(g);
    p[3] = q[3];
    p[4] = q[4];
    // The table standing still, tips are as far from each other as the linear axes say.
    EXPECT_NEAR(norm(t.tip(q) - t.tip(p)), std::hypot(q[0] - p[0], q[1] - p[1], q[2] - p[2]), 1e-16);
    // A whole turn of C changes nothing.
    p = q;
    p[4] += 2.0 * kPi * t.radius;
    EXPECT_NEAR(norm(t.tip(q) - t.tip(p)), 0.0, 1e-15);
  }
}

TEST(TiltingTable, JacobianIsTheLimitOfDifferences) {
  std::mt19937 g(7);
  const TiltingTable t = table();
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 20; ++i) {
    const V5 q = random_axes(g);
    const TipJacobian j = jacobian(t, q);
    for (std::size_t k = 0; k < 5; ++k) {
      V5 up = q;
      V5 down = q;
      up[k] += kStep;
      down[k] -= kStep;
      const V3 tip = (0.5 / kStep) * (t.tip(up) - t.tip(down));
      const V3 direction = (0.5 / kStep) * (t.direction(up) - t.direction(down));
      // Third derivative (0.1 m/(0.1 m)³, 1/(0.1 m)³) times step²/6, rounding 1e-17/step.
      EXPECT_NEAR(norm(tip - j.tip[k]), 0.0, 5e-9) << k;
      EXPECT_NEAR(norm(direction - j.direction[k]), 0.0, 5e-8) << k;
    }
  }
}

TEST(TiltingTable, ForcesOnTheAxesDoTheWorkOfTheForceOnTheTip) {
  std::mt19937 g(8);
  const TiltingTable t = table();
  const V5 q = random_axes(g);
  const V5 p = random_axes(g);
  const V5 small = 1e-7 * (p - q);
  const V3 force{{30.0, -20.0, 10.0}};
  const double at_tip = dot(force, t.tip(q + small) - t.tip(q));
  EXPECT_NEAR(dot(to_axes(t, q, force), small), at_tip, 1e-5 * std::abs(at_tip));
}

TEST(ConeFrustum, ToolLiesOnTheConeAndItsTipOnACircle) {
  const ConeFrustum c = frustum();
  ASSERT_TRUE(c.possible());
  const V3 w{{0.0, std::sin(30.0 * kDegree), std::cos(30.0 * kDegree)}};
  for (int i = 0; i < 60; ++i) {
    const double phi = 2.0 * kPi * i / 60;
    const V5 q = c.point(phi);
    // Seen through the machine's kinematics, not through the formula of the path.
    const V3 tip = c.table.tip(q) - c.centre;
    const V3 o = c.table.direction(q);
    EXPECT_NEAR(norm(tip), 20e-3, 1e-16);
    EXPECT_NEAR(dot(tip, w), 0.0, 1e-16);
    EXPECT_NEAR(std::acos(dot(o, w)), 15.0 * kDegree, 1e-14);
    // The flank: circle's radius, cone's axis and tool lie in one plane.
    EXPECT_NEAR(dot(cross(tip, w), o), 0.0, 1e-16);
    EXPECT_NEAR(q[3] / 0.1, std::acos(o[2]), 1e-14);
  }
  // C swings by asin(sin θ/sin β) to both sides, A between β − θ and β + θ.
  double widest = 0.0;
  double steepest = 0.0;
  for (int i = 0; i < 3600; ++i) {
    const V5 q = c.point(2.0 * kPi * i / 3600);
    widest = std::max(widest, std::abs(q[4]));
    steepest = std::max(steepest, q[3]);
  }
  EXPECT_NEAR(widest / 0.1, std::asin(std::sin(15.0 * kDegree) / std::sin(30.0 * kDegree)), 1e-6);
  EXPECT_NEAR(steepest / 0.1, 45.0 * kDegree, 1e-6);
}

TEST(ConeFrustum, ClosesAfterItsLapAndNotBefore) {
  const ConeFrustum c = frustum();
  EXPECT_TRUE(c.closed());
  EXPECT_NEAR(norm(c.point(c.period()) - c.point(0.0)), 0.0, 1e-15);
  for (int i = 1; i < 12; ++i) EXPECT_GT(norm(c.point(c.period() * i / 12) - c.point(0.0)), 1e-3) << i;
}

TEST(ConeFrustum, WithoutConeTheTableStands) {
  ConeFrustum c = frustum();
  c.half_angle = 0.0;
  for (const double phi : {0.1, 2.0, 4.0}) {
    const auto q = series<2>(c, phi);
    EXPECT_NEAR(q[3].derivative(1), 0.0, 1e-16);
    EXPECT_NEAR(q[4].derivative(1), 0.0, 1e-16);
    EXPECT_NEAR(q[4].c[0], 0.0, 1e-16);
  }
  c.half_angle = c.inclination;
  EXPECT_FALSE(c.possible());
  // A cone that reaches beyond the horizontal has no place on the table.
  c.inclination = 0.9;
  c.half_angle = 0.8;
  EXPECT_FALSE(c.possible());
  c.half_angle = 0.6;
  EXPECT_TRUE(c.possible());
}

TEST(ConeFrustum, AsGivenItIsPossibleAndEachOfItsSizesCanBeWrong) {
  EXPECT_TRUE(ConeFrustum{}.possible());
  for (const double wrong : {0.0, -0.1, std::nan("")}) {
    ConeFrustum c;
    c.radius = wrong;
    EXPECT_FALSE(c.possible()) << wrong;
    c = {};
    c.inclination = wrong;
    EXPECT_FALSE(c.possible()) << wrong;
    c = {};
    c.half_angle = wrong;
    EXPECT_EQ(c.possible(), wrong == 0.0) << wrong;
  }
  ConeFrustum c;
  c.radius = 1e-4;  // a tenth of a millimetre
  c.inclination = 0.02;
  c.half_angle = 0.01;
  EXPECT_TRUE(c.possible());
}

TEST(ConeFrustum, DerivativesOfAxisMotionAreTheLimitOfDifferences) {
  const ConeFrustum c = frustum();
  constexpr double kStep = 1e-3;
  for (const double phi : {0.3, 1.7, 3.9, 5.5}) {
    const auto d = derivatives<6>(c, phi);
    for (std::size_t k = 0; k < 4; ++k) {
      const V5 up = derivatives<4>(c, phi + kStep)[k];
      const V5 down = derivatives<4>(c, phi - kStep)[k];
      // The difference misses step²/6 of the derivative two orders higher; beyond, step⁴/120 of the one after (1e-14 · 1e3).
      const V5 missed = (0.5 / kStep) * (up - down) - d[k + 1];
      EXPECT_NEAR(norm(missed - (kStep * kStep / 6.0) * d[k + 3]), 0.0, 1e-10) << phi << " " << k;
    }
  }
}

TEST(TipDeviation, AgreesWithTheAxisErrorsToSecondOrder) {
  const ConeFrustum c = frustum();
  const TipPath<ConeFrustum> trace{c};
  const V5 error{{0.4, -0.7, 0.5, 0.9, -0.6}};
  std::array<double, 2> contour{};
  std::array<double, 2> orientation{};
  const std::array sizes{200e-6, 100e-6};
  for (std::size_t i = 0; i < 2; ++i) {
    for (int n = 0; n < 12; ++n) {
      const double phi = 0.2 + 0.5 * n;
      const V5 q = c.point(phi);
      const V5 e = sizes[i] * error;
      const TipDeviation exact = tip_deviation(c, q + e, phi);
      const TipJacobian j = jacobian(c.table, q);
      V3 tip{};
      V3 direction{};
      for (std::size_t k = 0; k < 5; ++k) {
        tip = tip + e[k] * j.tip[k];
        direction = direction + e[k] * j.direction[k];
      }
      // What lies along the path moves the nearest point; its tool axis is the wanted one there.
      const auto p = derivatives<1>(trace, phi);
      const double along = dot(tip, p[1]) / dot(p[1], p[1]);
      V3 turned;
      const auto o = c.direction(Taylor<1>::variable(phi));
      for (std::size_t k = 0; k < 3; ++k) turned[k] = o[k].c[1];
      contour[i] = std::max(contour[i], std::abs(exact.contour - norm(tip - along * p[1])));
      orientation[i] =
          std::max(orientation[i], std::abs(exact.orientation - norm(direction - along * turned)));
    }
  }
  // Halving the error leaves a quarter of what first order misses.
  EXPECT_NEAR(contour[0] / contour[1], 4.0, 0.1);
  EXPECT_NEAR(orientation[0] / orientation[1], 4.0, 0.1);
  EXPECT_LT(contour[1], 1e-6);
}

TEST(TipDeviation, IsZeroOnThePathAndIgnoresProgressAlongIt) {
  const ConeFrustum c = frustum();
  for (const double phi : {0.3, 2.0, 4.4}) {
    // 2 mm ahead of the reference on the path is no contour error.
    const TipDeviation d = tip_deviation(c, c.point(phi + 0.1), phi);
    EXPECT_NEAR(d.contour, 0.0, 1e-14);
    EXPECT_NEAR(d.orientation, 0.0, 1e-12);
  }
}

TEST(TipDeviation, OfATurnOfTheTableAloneIsThatAngle) {
  const ConeFrustum c = frustum();
  const double phi = 0.9;
  V5 q = c.point(phi);
  // Tilt by 1 mrad and let the linear axes follow, so that the tip stays.
  V5 tilted = q;
  tilted[3] += 1e-3 * 0.1;
  const V5 again = c.table.axes(c.table.tip(q), c.table.direction(tilted));
  const TipDeviation d = tip_deviation(c, again, phi);
  EXPECT_NEAR(d.contour, 0.0, 1e-15);
  EXPECT_NEAR(d.orientation, 1e-3, 1e-13);
}

TEST(Reference, TravelsTheFrustumWithAnOrthonormalFrame) {
  const ConeFrustum c = frustum();
  Reference<ConeFrustum> reference(c, {0.5, 1.0, 2.0 * kPi}, Pace::kRate);
  double worst = 0.0;
  while (!reference.finished()) {
    const auto r = reference.point();
    for (std::size_t i = 0; i < 5; ++i) {
      for (std::size_t k = 0; k <= i; ++k)
        worst = std::max(worst, std::abs(dot(r.frame[i], r.frame[k]) - (i == k ? 1.0 : 0.0)));
    }
    // Tip speed is R·φ̇ under the law.
    if (reference.time() > 1.0 && reference.time() < 1.0 + 4.0 * kPi) {
      const auto q = c.table.tip(r.position);
      const auto ahead = c.table.tip(r.position + 1e-5 * r.velocity);
      EXPECT_NEAR(norm(ahead - q) / 1e-5, 20e-3 * 0.5, 1e-7);
    }
    reference.advance(0.02);
  }
  EXPECT_LT(worst, 1e-14);
}

}  // namespace
}  // namespace stribeck::path::five_axis_test
