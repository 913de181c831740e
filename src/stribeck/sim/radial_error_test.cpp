#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <stribeck/core/scalar.hpp>
#include <stribeck/sim/radial_error.hpp>

namespace stribeck::sim {
namespace {

struct Circle {
  std::vector<double> x, y, cx, cy;

  template <class Error>
  explicit Circle(Error&& error, double direction = 1.0, double laps = 1.0, double offset = 0.0) {
    constexpr int kSamples = 3600;
    for (int i = 0; i < kSamples * laps; ++i) {
      const double phi = direction * 2.0 * kPi * i / kSamples;
      const double r = 10e-3 + error(phi);
      x.push_back(offset + r * std::cos(phi));
      y.push_back(-offset + r * std::sin(phi));
      cx.push_back(offset + 10e-3 * std::cos(phi));
      cy.push_back(-offset + 10e-3 * std::sin(phi));
    }
  }
  [[nodiscard]] CircleTest judged(bool with_command = true) const {
    return circle_test(with_command ? CircleSamples{x, y, cx, cy} : CircleSamples{x, y, {}, {}}, 10e-3);
  }
};

// Closed form: e = a·cos 2φ has maximum a, RMS a/√2, and G = 2a.
TEST(CircleTest, OvalInClosedForm) {
  const CircleTest t = Circle([](double phi) { return 4e-6 * std::cos(2.0 * phi); }).judged();
  EXPECT_NEAR(t.max_error, 4e-6, 1e-10);
  EXPECT_NEAR(t.rms, 4e-6 / std::sqrt(2.0), 1e-10);
  // The least-squares centre is that of the oval up to its second order.
  EXPECT_NEAR(t.circular_deviation, 8e-6, 1e-9);
  EXPECT_NEAR(t.quadrant_glitch, 4e-6, 1e-10);
  EXPECT_TRUE(t.counter_clockwise);
}

// A bump counts as a quadrant's only behind it, in the direction of travel.
TEST(CircleTest, GlitchBehindTheQuadrant) {
  const auto bump = [](double phi) {
    return std::abs(std::remainder(phi - 1.62, 2.0 * kPi)) < 0.02 ? 5e-6 : 0.0;
  };
  EXPECT_NEAR(Circle(bump).judged().quadrant_glitch, 5e-6, 1e-12);
  const CircleTest back = Circle(bump, -1.0).judged();
  EXPECT_FALSE(back.counter_clockwise);
  EXPECT_LT(back.quadrant_glitch, 1e-12);
  EXPECT_NEAR(back.max_error, 5e-6, 1e-12);
}

// Invariance: where the circle lies, and how often it is travelled, does not matter.
TEST(CircleTest, DoesNotDependOnPlaceAndLaps) {
  const auto error = [](double phi) { return 3e-6 * std::sin(3.0 * phi) + 1e-6; };
  const CircleTest a = Circle(error).judged();
  const CircleTest b = Circle(error, 1.0, 3.0, 0.5).judged();
  EXPECT_NEAR(a.max_error, b.max_error, 1e-12);
  EXPECT_NEAR(a.rms, b.rms, 1e-12);
  EXPECT_NEAR(b.revolutions, 3.0, 1e-3);
  // sin 3φ does not move the fitted centre.
  EXPECT_NEAR(Circle(error).judged(false).max_error, a.max_error, 1e-9);
}

// Limit: without a command a shifted circle has no error; with one it has.
TEST(CircleTest, ShiftIsSeenAgainstACommandOnly) {
  Circle c([](double) { return 0.0; });
  for (double& x : c.x) x += 20e-6;
  EXPECT_NEAR(c.judged().max_error, 20e-6, 1e-9);
  EXPECT_LT(c.judged(false).max_error, 1e-12);
}

TEST(CircleTest, RefusesWhatIsNone) {
  const std::vector<double> few(10, 1.0);
  EXPECT_THROW(circle_test({few, few, {}, {}}, 1e-2), std::invalid_argument);
  const std::vector<double> rest(500, 1.0);
  EXPECT_THROW(circle_test({rest, rest, {}, {}}, 1e-2), std::invalid_argument);
  const Circle half([](double) { return 0.0; }, 1.0, 0.5);
  EXPECT_THROW((void)half.judged(), std::invalid_argument);
}

}  // namespace
}  // namespace stribeck::sim
