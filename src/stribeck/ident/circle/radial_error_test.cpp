#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/radial_error.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::circle::radial_error_test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kGlitchTravel = 0.15e-3;

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
    return circle_test(with_command ? CircleSamples{x, y, cx, cy} : CircleSamples{x, y, {}, {}}, 10e-3,
                       kGlitchTravel);
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
  EXPECT_THAT(
      [&] {
        circle_test({few, few, {}, {}}, 1e-2, kGlitchTravel);
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("too few samples, expected at least")));
  const std::vector<double> rest(500, 1.0);
  EXPECT_THAT(
      [&] {
        circle_test({rest, rest, {}, {}}, 1e-2, kGlitchTravel);
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("the positions are no circle")));
}

std::string refusal(const Circle& c, double radius = 10e-3) {
  try {
    static_cast<void>(circle_test({c.x, c.y, {}, {}}, radius, kGlitchTravel));
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "accepted";
}

TEST(CircleTest, RefusesPartsOfACircleAndSaysWhich) {
  const auto none = [](double) { return 0.0; };
  EXPECT_EQ(refusal(Circle(none, 1.0, 0.25)),
            "an arc of 90 deg, expected at least 175 deg, better a revolution");
  EXPECT_EQ(refusal(Circle(none, -1.0, 0.48)),
            "an arc of 173 deg, expected at least 175 deg, better a revolution");
  Circle back(none);
  for (std::size_t i = back.x.size(); i-- > 0;) {
    back.x.push_back(back.x[i]);
    back.y.push_back(back.y[i]);
  }
  EXPECT_EQ(refusal(back), "both directions of travel, expected one");
  // From 44 to 62 degrees the log has no sample: a quadrant could be hidden there. A gap of 4 degrees is harmless.
  Circle gap(none);
  gap.x.erase(gap.x.begin() + 440, gap.x.begin() + 620);
  gap.y.erase(gap.y.begin() + 440, gap.y.begin() + 620);
  EXPECT_EQ(refusal(gap), "no sample from 50 to 60 deg, expected some in every such sector");
  Circle small(none);
  small.x.erase(small.x.begin() + 440, small.x.begin() + 480);
  small.y.erase(small.y.begin() + 440, small.y.begin() + 480);
  EXPECT_EQ(refusal(small), "accepted");
  EXPECT_EQ(refusal(Circle(none), 20e-3), "a circle with a radius of 10 mm, expected 20 mm within a fifth");
  EXPECT_EQ(refusal(Circle(none), 11e-3), "accepted");
}

// Arcs of 220 degrees, there and there again: what is not travelled between them is no part of the circle.
TEST(CircleTest, ArcsOneBehindTheOther) {
  const auto oval = [](double phi) { return 4e-6 * std::cos(2.0 * phi); };
  for (const double way : {1.0, -1.0}) {
    const Circle arc(oval, way, 220.0 / 360.0);
    Circle both = arc;
    std::vector<int> part(arc.x.size(), 0);
    part.resize(2 * arc.x.size(), 1);
    both.x.insert(both.x.end(), arc.x.begin(), arc.x.end());
    both.y.insert(both.y.end(), arc.y.begin(), arc.y.end());
    both.cx.insert(both.cx.end(), arc.cx.begin(), arc.cx.end());
    both.cy.insert(both.cy.end(), arc.cy.begin(), arc.cy.end());
    const CircleTest t = circle_test({both.x, both.y, both.cx, both.cy, {}, part}, 10e-3, kGlitchTravel);
    EXPECT_NEAR(t.max_error, 4e-6, 1e-10);
    EXPECT_NEAR(t.revolutions, 440.0 / 360.0, 0.01);
    EXPECT_EQ(t.counter_clockwise, way > 0.0);
    // A gap within the arc may hide a quadrant.
    Circle gap(oval, way, 220.0 / 360.0);
    for (auto* column : {&gap.x, &gap.y, &gap.cx, &gap.cy})
      column->erase(column->begin() + 800, column->begin() + 1000);
    EXPECT_THAT([&] { static_cast<void>(gap.judged()); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("no sample from")));
  }
}

// Independent reference: the six points of Gander, Golub and Strebel (doi:10.1007/BF01934268, section 3), four decimals printed;
// the algebraic fit has another circle.
TEST(LeastSquaresCircle, AsPrintedByGanderGolubStrebel) {
  const std::vector<double> x{1.0, 2.0, 5.0, 7.0, 9.0, 3.0};
  const std::vector<double> y{7.0, 6.0, 8.0, 7.0, 5.0, 7.0};
  const LeastSquaresCircle c = least_squares_circle(x, y);
  EXPECT_NEAR(c.x, 4.7398, 5e-5);
  EXPECT_NEAR(c.y, 2.9835, 5e-5);
  EXPECT_NEAR(c.radius, 4.7142, 5e-5);
}

// A quarter of a circle with noise of 100 um: over 20000 arcs the algebraic fit is 100 um too small in the mean, the geometric one
// 0.2 um too large; over these 400 the mean has a standard deviation of 3.7 um, four of which are allowed. No change of the circle
// is better.
TEST(LeastSquaresCircle, ArcWithNoiseHasNoBias) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, 100e-6);
  double radius = 0.0;
  constexpr int kArcs = 400;
  for (int arc = 0; arc < kArcs; ++arc) {
    std::vector<double> x;
    std::vector<double> y;
    for (int i = 0; i <= 200; ++i) {
      const double phi = 0.5 * kPi * i / 200;
      x.push_back(0.3 + 10e-3 * std::cos(phi) + noise(random));
      y.push_back(10e-3 * std::sin(phi) + noise(random));
    }
    const LeastSquaresCircle c = least_squares_circle(x, y);
    radius += c.radius / kArcs;
    const auto squares = [&](double cx, double cy, double r) {
      double sum = 0.0;
      for (std::size_t i = 0; i < x.size(); ++i) sum += std::pow(std::hypot(x[i] - cx, y[i] - cy) - r, 2);
      return sum;
    };
    const double least = squares(c.x, c.y, c.radius);
    for (const double h : {-1e-7, 1e-7}) {
      EXPECT_GT(squares(c.x + h, c.y, c.radius), least);
      EXPECT_GT(squares(c.x, c.y + h, c.radius), least);
      EXPECT_GT(squares(c.x, c.y, c.radius + h), least);
    }
  }
  EXPECT_NEAR(radius, 10e-3, 15e-6);
}

// Limits: exact points give their circle, a short arc too; a line and a single place have none. Invariance: scale and place.
TEST(LeastSquaresCircle, LimitsAndInvariance) {
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i < 20; ++i) {
    x.push_back(3.0 + 2.0 * std::cos(0.01 * i));
    y.push_back(-1.0 + 2.0 * std::sin(0.01 * i));
  }
  const LeastSquaresCircle c = least_squares_circle(x, y);
  EXPECT_NEAR(c.x, 3.0, 1e-9);
  EXPECT_NEAR(c.y, -1.0, 1e-9);
  EXPECT_NEAR(c.radius, 2.0, 1e-9);
  y[7] += 1e-4;
  const LeastSquaresCircle one = least_squares_circle(x, y);
  for (double& v : x) v = 1e-3 * (v + 5.0);
  for (double& v : y) v = 1e-3 * (v - 7.0);
  const LeastSquaresCircle moved = least_squares_circle(x, y);
  EXPECT_NEAR(moved.x, 1e-3 * (one.x + 5.0), 1e-10);
  EXPECT_NEAR(moved.radius, 1e-3 * one.radius, 1e-10);
  EXPECT_THAT([&] { (void)least_squares_circle(x, x); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("the positions are no circle")));
  EXPECT_THAT([&] { (void)least_squares_circle(std::vector<double>(9, 1.0), std::vector<double>(9, 2.0)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("the positions are no circle")));
  EXPECT_THAT([&] { (void)least_squares_circle({}, {}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("the positions are no circle")));
}

}  // namespace
}  // namespace stribeck::ident::circle::radial_error_test
