// Run-in, directions, laps, and the quantities after ISO 230-4, on circles made by formulas.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/circularity.hpp>
#include <vector>

namespace stribeck::ident::circle::circularity_test {
namespace {

using testing::HasSubstr;

/// Travel on a circle of 50 mm whose radial error is given over angle and direction; 1 ms between rows.
struct Travel {
  std::vector<double> t, x, y, cx, cy;
  double angle = 0.0;
  double rate = 0.0;

  template <class Error>
  void go(double turns, double rate_at_end, const Error& error) {
    const double goal = angle + 2.0 * kPi * turns;
    const double way = turns > 0.0 ? 1.0 : -1.0;
    const double rate_at_begin = rate;
    const double begin = angle;
    while (way * (goal - angle) > 0.0) {
      const double done = std::abs((angle - begin) / (goal - begin));
      // The square of the speed grows evenly along the way: constant acceleration.
      rate = std::sqrt(
          std::max(0.0, rate_at_begin * rate_at_begin * (1.0 - done) + rate_at_end * rate_at_end * done));
      rate = std::max(rate, 0.02);
      angle += way * rate * 1e-3;
      add(50e-3 + error(angle, way));
    }
    rate = rate_at_end;
  }
  void add(double radius) {
    t.push_back(1e-3 * static_cast<double>(t.size()));
    x.push_back(0.2 + radius * std::cos(angle));
    y.push_back(-0.1 + radius * std::sin(angle));
    cx.push_back(0.2 + 50e-3 * std::cos(angle));
    cy.push_back(-0.1 + 50e-3 * std::sin(angle));
  }
  [[nodiscard]] CircleMotion motion(bool commanded = true) const {
    return circle_motion(samples(commanded), t, 50e-3);
  }
  [[nodiscard]] CircleSamples samples(bool commanded = true) const {
    return commanded ? CircleSamples{x, y, cx, cy} : CircleSamples{x, y, {}, {}};
  }
};

constexpr double kRate = 2.0;  // 100 mm/s

template <class Error>
Travel there_and_back(const Error& error) {
  Travel travel;
  for (const double way : {1.0, -1.0}) {
    // While it gathers speed the axis is 50 um outside: a score of that would be seen.
    const auto outside = [](double, double) { return 50e-6; };
    travel.go(way * 0.1, kRate, outside);
    travel.go(way * 2.3, kRate, error);
    travel.go(way * 0.1, 0.0, outside);
  }
  return travel;
}

TEST(CircleMotion, RunInOffDirectionsAndLapsApart) {
  const auto none = [](double, double) { return 0.0; };
  for (const bool commanded : {true, false}) {
    const Travel travel = there_and_back(none);
    const CircleMotion m = travel.motion(commanded);
    ASSERT_EQ(m.runs.size(), 2U);
    EXPECT_TRUE(m.runs[0].counter_clockwise);
    EXPECT_FALSE(m.runs[1].counter_clockwise);
    for (const CircleRun& run : m.runs) {
      // Where the speed is within a tenth of the final one the last part of the run-in counts: 0.1 turn · (1 − 0.83). Of what is left
      // beyond two laps, 15 degrees at both ends are not scored.
      EXPECT_NEAR(run.revolutions, 2.3 - 30.0 / 360.0, 0.04);
      EXPECT_NEAR(run.feed, 0.1, 0.002);
      EXPECT_EQ(run.lap.back(), 2);
    }
    EXPECT_TRUE(m.notes.empty());
  }
}

// As a ball-bar measures in a plane with z: 220 degrees, there and back.
TEST(CircleMotion, ArcsStandForACircleWhereThereIsNone) {
  const auto oval = [](double a, double way) { return 3e-6 * std::cos(2.0 * a) + (way > 0.0 ? 1e-6 : 0.0); };
  for (const bool commanded : {true, false}) {
    Travel travel;
    travel.angle = -35.0 * kPi / 180.0;
    for (const double way : {1.0, -1.0}) {
      travel.go(way * 12.0 / 360.0, kRate, oval);
      travel.go(way * 226.0 / 360.0, kRate, oval);
      travel.go(way * 12.0 / 360.0, 0.0, oval);
    }
    const CircleMotion m = travel.motion(commanded);
    EXPECT_TRUE(m.arcs);
    ASSERT_EQ(m.runs.size(), 2U);
    const double near = commanded ? 1e-8 : 10e-6;  // an oval moves the centre of an arc
    EXPECT_NEAR(m.centre_x, 0.2, near);
    EXPECT_NEAR(m.centre_y, -0.1, near);
    for (const CircleRun& run : m.runs) EXPECT_NEAR(run.revolutions * 360.0, 226.0, 12.0);
    const CircularTest t = circular_test(travel.samples(commanded), m);
    ASSERT_EQ(t.directions.size(), 2U);
    ASSERT_TRUE(t.hysteresis.has_value());
    EXPECT_NEAR(*t.hysteresis, 1e-6, 0.02e-6);
    for (const DirectionTest& d : t.directions) {
      ASSERT_EQ(d.laps.size(), 1U);
      // A linear programme has 2.70 um from -20 to 200 degrees, 2.57 um from -18 to 198: a part of the oval goes into the centre.
      EXPECT_NEAR(d.circular_deviation, 2.7e-6, 0.15e-6);
    }
  }
  // Beside a whole revolution an arc is left out.
  Travel whole;
  whole.go(1.1, kRate, oval);
  whole.go(-220.0 / 360.0, kRate, oval);
  const CircleMotion m = whole.motion();
  EXPECT_FALSE(m.arcs);
  EXPECT_EQ(m.runs.size(), 1U);
}

TEST(CircleMotion, AnArcOfFewRowsIsFound) {
  std::vector<double> x, y;
  for (int k = 0; k <= 110; ++k) {
    const double angle = (-20.0 + 2.0 * k) * kPi / 180.0;
    x.push_back(0.3 + 50e-3 * std::cos(angle));
    y.push_back(50e-3 * std::sin(angle));
  }
  const CircleMotion m = circle_motion({x, y, {}, {}}, {}, 50e-3);
  EXPECT_TRUE(m.arcs);
  ASSERT_EQ(m.runs.size(), 1U);
  EXPECT_NEAR(m.runs[0].revolutions * 360.0, 220.0, 1e-6);
  EXPECT_NEAR(m.centre_x, 0.3, 1e-9);
}

// One direction over the upper half, the other over the lower one: they have no angle in common.
TEST(CircularTest, NoHysteresisWhereTheDirectionsDoNotMeet) {
  const auto none = [](double, double) { return 0.0; };
  Travel travel;
  travel.rate = kRate;
  travel.angle = 1.0 * kPi / 180.0;
  travel.go(177.0 / 360.0, kRate, none);
  travel.angle = -1.0 * kPi / 180.0;
  travel.go(-177.0 / 360.0, kRate, none);
  const CircleMotion m = travel.motion();
  ASSERT_EQ(m.runs.size(), 2U);
  const CircularTest t = circular_test(travel.samples(), m);
  EXPECT_FALSE(t.hysteresis.has_value());
}

/// A revolution of 50 mm at full speed between approaches: along a radius, or along a half circle of half the radius.
Travel approached(bool along_an_arc, double oval) {
  Travel t;
  const double step = kRate * 50e-3 * 1e-3;
  const auto add = [&](double x, double y, double rx, double ry) {
    t.t.push_back(1e-3 * static_cast<double>(t.t.size()));
    t.x.push_back(0.2 + x), t.y.push_back(-0.1 + y), t.cx.push_back(0.2 + rx), t.cy.push_back(-0.1 + ry);
  };
  const double length = along_an_arc ? kPi * 25e-3 : 50e-3;
  const auto approach = [&](double s) {
    const double a = kPi - s / 25e-3;
    const double x = along_an_arc ? 25e-3 + 25e-3 * std::cos(a) : s;
    const double y = along_an_arc ? -25e-3 * std::sin(a) : 0.0;
    add(x, y, x, y);
  };
  for (double s = 0.0; s < length; s += step) approach(s);
  for (double a = 0.0; a < 2.2 * kPi; a += step / 50e-3) {
    const double r = 50e-3 + oval * std::cos(2.0 * a);
    add(r * std::cos(a), r * std::sin(a), 50e-3 * std::cos(a), 50e-3 * std::sin(a));
  }
  return t;
}

TEST(CircleMotion, TheApproachIsNoPartOfTheCircle) {
  for (const bool along_an_arc : {false, true}) {
    for (const bool commanded : {true, false}) {
      const CircleMotion m = approached(along_an_arc, 3e-6).motion(commanded);
      ASSERT_EQ(m.runs.size(), 1U);
      // Without a command a part of the approach is within the error of a machine, a thousandth of the radius.
      const double near = commanded ? 1e-7 : 60e-6;
      EXPECT_NEAR(m.centre_x, 0.2, near);
      EXPECT_NEAR(m.centre_y, -0.1, near);
      const auto [low, high] = std::minmax_element(m.runs[0].error.begin(), m.runs[0].error.end());
      EXPECT_NEAR(*low, -3e-6, near);
      EXPECT_NEAR(*high, 3e-6, near);
      EXPECT_NEAR(m.runs[0].revolutions, 1.1 - 30.0 / 360.0, 0.04);
      EXPECT_GT(m.longest_arc, 2.1 * kPi);
    }
  }
}

// As controls move: in along the radius, a stop, one circle from rest to rest, a stop, out, and the same the other way round. The way
// back began on the circle, so that its approach was in its middle and was scored: G was 2 mm.
TEST(CircleMotion, AStopAndAnApproachAlongTheRadiusAreNotScored) {
  const auto oval = [](double a, double) { return 3e-6 * std::cos(2.0 * a); };
  for (const bool commanded : {true, false}) {
    Travel t;
    for (const double way : {1.0, -1.0}) {
      const auto stand = [&](double radius) {
        t.add(radius);
        t.cx.back() = t.x.back(), t.cy.back() = t.y.back();
      };
      for (double r = 48e-3; r < 50e-3; r += 20e-6) stand(r);
      for (int k = 0; k < 200; ++k) stand(50e-3);
      t.rate = 0.0;
      t.go(way * 0.02, kRate, oval);
      t.go(way * 0.96, kRate, oval);
      t.go(way * 0.02, 0.0, oval);
      for (int k = 0; k < 200; ++k) stand(50e-3);
      for (double r = 50e-3; r > 48e-3; r -= 20e-6) stand(r);
    }
    const CircleMotion m = t.motion(commanded);
    ASSERT_EQ(m.runs.size(), 2U);
    for (const CircleRun& run : m.runs) {
      EXPECT_NEAR(run.revolutions, 1.0, 0.01);
      const auto [low, high] = std::minmax_element(run.error.begin(), run.error.end());
      EXPECT_NEAR(*low, -3e-6, commanded ? 0.1e-6 : 0.3e-6);
      EXPECT_NEAR(*high, 3e-6, commanded ? 0.1e-6 : 0.3e-6);
    }
  }
}

// A row for every 3.9 degrees: what settles at both ends is less than the revolution has beyond a whole one.
TEST(CircleMotion, AWholeRevolutionIsLeftOfFewRows) {
  for (const double degrees : {361.0, 364.0, 375.0, 386.0}) {
    Travel t;
    for (double a = 0.0; a <= degrees; a += 3.9) {
      t.angle = a * kPi / 180.0;
      t.add(50e-3);
    }
    const CircleMotion m = t.motion();
    ASSERT_EQ(m.runs.size(), 1U) << degrees;
    EXPECT_GT(m.runs[0].revolutions, 0.98) << degrees;
  }
}

// Two records joined with times that go on: the way back begins half a revolution elsewhere.
TEST(CircleMotion, AJumpOfTheAngleEndsARun) {
  const auto none = [](double, double) { return 0.0; };
  Travel t;
  t.go(1.5, kRate, none);
  t.angle += kPi;
  t.go(-1.5, kRate, none);
  const CircleMotion m = t.motion();
  ASSERT_EQ(m.runs.size(), 2U);
  for (const CircleRun& run : m.runs) EXPECT_LT(run.revolutions, 1.5);
}

TEST(CircleMotion, ACommandOfAnotherRadiusIsSaid) {
  Travel travel;
  travel.go(0.1, kRate, [](double, double) { return 0.0; });
  travel.go(1.4, kRate, [](double, double) { return 0.0; });
  EXPECT_TRUE(circle_motion(travel.samples(), travel.t, 50e-3 + 0.4e-6).notes.empty());
  const CircleMotion m = circle_motion(travel.samples(), travel.t, 49.9e-3);
  ASSERT_EQ(m.notes.size(), 1U);
  EXPECT_THAT(m.notes[0], HasSubstr("the commanded circle has a radius of 50 mm, and 49.9 mm were given"));
  EXPECT_THAT(m.notes[0], HasSubstr("holds the difference of 100 um (give --size \"50 mm\")"));
  EXPECT_TRUE(circle_motion(travel.samples(false), travel.t, 49.9e-3).notes.empty());
}

TEST(CircleMotion, ARowThatStandsOutIsNamed) {
  const auto oval = [](double a, double) { return 2e-6 * std::cos(2.0 * a); };
  Travel travel;
  travel.go(0.1, kRate, oval);
  travel.go(1.4, kRate, oval);
  EXPECT_TRUE(travel.motion().notes.empty());
  travel.x[900] += 200e-6;
  const CircleMotion m = travel.motion();
  ASSERT_EQ(m.notes.size(), 1U);
  EXPECT_THAT(m.notes[0], HasSubstr("row 901 stands out of its neighbours by"));
}

// Without enough travel the run-in stays, and this is said; an arc is left out, and said.
TEST(CircleMotion, SaysWhatIsNotCut) {
  const auto none = [](double, double) { return 0.0; };
  Travel travel;
  travel.go(0.1, kRate, none);
  travel.go(0.8, kRate, none);
  travel.go(0.1, 0.0, none);
  travel.go(-0.4, 0.0, none);
  const CircleMotion m = travel.motion();
  ASSERT_EQ(m.runs.size(), 1U);
  EXPECT_NEAR(m.runs[0].revolutions, 1.0, 1e-3);
  ASSERT_EQ(m.notes.size(), 2U);
  EXPECT_THAT(m.notes[0], HasSubstr("run-in and run-out are scored too"));
  EXPECT_THAT(m.notes[1], HasSubstr("an arc of 144 deg is left out"));
}

// Closed form: e = ±b·cos 2φ + c by direction. Each direction is 2b wide, both together too; they differ by 2b; the mean is c.
TEST(CircularTest, QuantitiesInClosedForm) {
  constexpr double b = 4e-6;
  constexpr double c = -3e-6;
  const Travel travel =
      there_and_back([](double phi, double way) { return way * b * std::cos(2.0 * phi) + c; });
  const CircularTest t = circular_test(travel.samples(), travel.motion());
  ASSERT_EQ(t.directions.size(), 2U);
  // The nearest sample is at most half a step of 2 mrad from the top: b·(2·1e-3)²/2 = 8e-12; run-in of up to 1 % more is cut.
  for (const DirectionTest& d : t.directions) {
    EXPECT_NEAR(d.circular_deviation, 2.0 * b, 1e-9);
    EXPECT_NEAR(d.radial_max, b + c, 1e-9);
    EXPECT_NEAR(d.radial_min, -b + c, 1e-9);
    ASSERT_EQ(d.laps.size(), 2U);
    for (const LapTest& lap : d.laps) {
      EXPECT_NEAR(lap.circular_deviation, 2.0 * b, 1e-9);
      EXPECT_NEAR(lap.max_error, b - c, 1e-9);
    }
  }
  ASSERT_TRUE(t.bidirectional && t.hysteresis);
  EXPECT_NEAR(*t.bidirectional, 2.0 * b, 1e-9);
  EXPECT_NEAR(*t.hysteresis, 2.0 * b, 1e-9);
  // 2.3 laps are no whole number: the quarter that is travelled once more pulls the least-squares radius by some percent of b.
  EXPECT_NEAR(t.mean_radial_deviation, c, 0.1 * b);
}

// Limits: one direction has no hysteresis. Invariance: mirrored in x, the directions exchange and no quantity changes.
TEST(CircularTest, OneDirectionAndMirror) {
  const auto error = [](double phi, double way) {
    return 2e-6 * std::sin(3.0 * phi) + 1e-6 * way * std::cos(phi + 0.3);
  };
  Travel one;
  one.go(0.1, kRate, error);
  one.go(2.0, kRate, error);
  const CircularTest single = circular_test(one.samples(), one.motion());
  EXPECT_EQ(single.directions.size(), 1U);
  EXPECT_FALSE(single.bidirectional || single.hysteresis);
  const Travel travel = there_and_back(error);
  Travel mirrored = travel;
  for (double& v : mirrored.x) v = -v;
  for (double& v : mirrored.cx) v = -v;
  const CircularTest a = circular_test(travel.samples(), travel.motion());
  const CircularTest b = circular_test(mirrored.samples(), mirrored.motion());
  EXPECT_NEAR(*a.hysteresis, *b.hysteresis, 1e-11);
  EXPECT_NEAR(*a.bidirectional, *b.bidirectional, 1e-12);
  EXPECT_NEAR(a.directions[0].circular_deviation, b.directions[0].circular_deviation, 1e-12);
  EXPECT_FALSE(b.directions[0].counter_clockwise);
}

}  // namespace
}  // namespace stribeck::ident::circle::circularity_test
