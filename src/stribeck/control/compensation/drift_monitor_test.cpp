#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <stribeck/control/compensation/drift_monitor.hpp>
#include <string_view>
#include <utility>

namespace stribeck::control::drift_monitor_test {
namespace {

constexpr double kPeriod = 5e-3;

TEST(DriftMonitor, BreakAwayIsTheLevelOverTheStiffness) {
  using A = FrictionRls;
  A::State a;
  a.theta[A::kPositive] = 0.4;
  a.theta[A::kNegative] = 0.2;
  a.theta[A::kStiffness] = 0.625;
  a.deviation[A::kStiffness] = 0.1;
  const auto d = DriftMonitor::report({}, a, kPeriod);
  // 1.3 times the level over 1.625 times the stiffness: a fifth less distance. A stiffness that is a little higher shortens it further.
  EXPECT_NEAR(d.level, 0.3, 1e-12);
  EXPECT_NEAR(d.break_away, -0.2, 1e-12);
  const double step = 1e-6;
  A::State b = a;
  b.theta[A::kStiffness] += step;
  const double slope = (DriftMonitor::report({}, b, kPeriod).break_away - d.break_away) / step;
  EXPECT_NEAR(d.break_away_deviation, -slope * 0.1, 1e-6);
}

TEST(DriftMonitor, SaysWhatChangedOnceItIsSure) {
  using A = FrictionRls;
  const auto verdict = [](std::initializer_list<std::pair<std::size_t, double>> theta, double deviation) {
    A::State a;
    a.informed = true;
    for (const auto& [i, value] : theta) a.theta[i] = value;
    for (std::size_t i = 0; i < A::kCount; ++i) {
      a.deviation[i] = deviation;
      a.p[i][i] = deviation * deviation;
    }
    return DriftMonitor::report({}, a, kPeriod).verdict;
  };
  EXPECT_EQ(verdict({}, 0.03), DriftVerdict::kAsCommissioned);
  EXPECT_EQ(verdict({{A::kPositive, 0.3}, {A::kNegative, 0.3}}, 0.2), DriftVerdict::kNotYet);
  EXPECT_EQ(verdict({{A::kPositive, 0.3}, {A::kNegative, 0.3}}, 0.03), DriftVerdict::kMuchMore);
  EXPECT_EQ(verdict({{A::kPositive, 0.3}, {A::kNegative, -0.1}}, 0.03), DriftVerdict::kAsCommissioned);
  EXPECT_EQ(verdict({{A::kPositive, -0.2}, {A::kNegative, -0.1}}, 0.03), DriftVerdict::kLess);
  // Within three standard deviations of the level, 0.11/√2 each, nothing has changed.
  EXPECT_EQ(verdict({{A::kPositive, -0.13}, {A::kNegative, -0.13}}, 0.11), DriftVerdict::kAsCommissioned);
  EXPECT_EQ(verdict({{A::kPositive, -0.17}, {A::kNegative, -0.17}}, 0.11), DriftVerdict::kAsCommissioned);
  EXPECT_EQ(verdict({{A::kPositive, -0.24}, {A::kNegative, -0.24}}, 0.11), DriftVerdict::kLess);
  EXPECT_EQ(verdict({{A::kPositive, 0.13}, {A::kNegative, 0.13}}, 0.11), DriftVerdict::kAsCommissioned);
  // A quarter of the level is much only where it is beyond them too.
  EXPECT_EQ(verdict({{A::kPositive, 0.26}, {A::kNegative, 0.26}}, 0.125), DriftVerdict::kAsCommissioned);
  EXPECT_EQ(verdict({{A::kPositive, -0.26}, {A::kNegative, -0.26}}, 0.125), DriftVerdict::kAsCommissioned);
  EXPECT_EQ(verdict({{A::kViscous, 0.3}}, 0.03), DriftVerdict::kMoreViscous);
  EXPECT_EQ(verdict({{A::kViscous, -0.3}}, 0.03), DriftVerdict::kLessViscous);
  EXPECT_EQ(verdict({{A::kViscous, -0.3}}, 0.11), DriftVerdict::kAsCommissioned);
  EXPECT_EQ(verdict({{A::kMass, 0.2}}, 0.03), DriftVerdict::kAnotherMass);
  EXPECT_EQ(verdict({{A::kDelay, 1.5}, {A::kMass, 0.2}}, 0.03), DriftVerdict::kAnotherDelay);
  EXPECT_EQ(verdict({{A::kDelay, 0.9}}, 0.03), DriftVerdict::kAsCommissioned);
  // The level goes first: what is wrong there is in all of it.
  EXPECT_EQ(verdict({{A::kViscous, 0.3}, {A::kPositive, 0.12}, {A::kNegative, 0.12}}, 0.03),
            DriftVerdict::kMore);
  // More level and less slope, or the other way round: a map without the Stribeck rise of these speeds.
  EXPECT_EQ(verdict({{A::kViscous, -0.5}, {A::kPositive, 0.15}, {A::kNegative, 0.15}}, 0.04),
            DriftVerdict::kAnotherShape);
  EXPECT_EQ(verdict({{A::kViscous, 0.8}, {A::kPositive, -0.22}, {A::kNegative, -0.22}}, 0.05),
            DriftVerdict::kAnotherShape);
  // A slope that slow motion hardly tells is no news, however far the estimate went.
  const auto slope_only = [](double viscous, double deviation) {
    A::State a;
    a.informed = true;
    a.theta[A::kPositive] = a.theta[A::kNegative] = -0.06;
    a.theta[A::kViscous] = viscous;
    a.deviation[A::kViscous] = deviation;
    a.p[A::kPositive][A::kPositive] = a.p[A::kNegative][A::kNegative] = 0.02 * 0.02;
    return DriftMonitor::report({}, a, kPeriod).verdict;
  };
  EXPECT_EQ(slope_only(0.9, 0.22), DriftVerdict::kAsCommissioned);
  EXPECT_EQ(slope_only(0.9, 0.18), DriftVerdict::kAnotherShape);
  EXPECT_EQ(slope_only(-0.9, 0.22), DriftVerdict::kAsCommissioned);
  EXPECT_EQ(slope_only(-0.9, 0.18), DriftVerdict::kLessViscous);
}

// In one run nobody can tell a change of the machine from an error of the model.
TEST(DriftMonitor, NamesTheLimitsOfTheModelAndNoMaintenance) {
  for (const DriftVerdict v :
       {DriftVerdict::kMore, DriftVerdict::kMuchMore, DriftVerdict::kLess, DriftVerdict::kMuchLess,
        DriftVerdict::kMoreViscous, DriftVerdict::kLessViscous}) {
    const std::string_view words = describe(v);
    EXPECT_NE(words.find("in the model"), std::string_view::npos) << words;
    EXPECT_NE(words.find("a log of these speeds"), std::string_view::npos) << words;
    for (const std::string_view maintenance : {"lubric", "preload", "covers"})
      EXPECT_EQ(words.find(maintenance), std::string_view::npos) << words;
  }
}

/// A level that goes from `from` to `to` with a time constant of 20 s, then stays, over 110 s of motion.
Drift after_a_fall(double from, double to, double deviation, double informed_after) {
  using A = FrictionRls;
  DriftMonitor::State s;
  A::State a;
  for (std::size_t i = 0; i < A::kCount; ++i) a.deviation[i] = deviation;
  a.p[A::kPositive][A::kPositive] = a.p[A::kNegative][A::kNegative] = 2.0 * deviation * deviation;
  double t = 0.0;
  for (; t < 110.0; t += kPeriod) {
    a.informed = t >= informed_after;
    a.theta[A::kPositive] = a.theta[A::kNegative] = to + (from - to) * std::exp(-t / 20.0);
    DriftMonitor::step(s, a, true, kPeriod);
  }
  return DriftMonitor::report(s, a, kPeriod);
}

TEST(DriftMonitor, TellsFallingFrictionFromAnEstimateOnItsWay) {
  // Friction falls by 20 % while the estimate knows it to 0.5 %.
  EXPECT_EQ(after_a_fall(0.1, -0.1, 0.005, 0.0).verdict, DriftVerdict::kWarmingUp);
  // The same numbers from an estimate that knows nothing yet for its first 90 s, or is unsure to 4 %: no trend.
  EXPECT_NE(after_a_fall(0.1, -0.1, 0.005, 90.0).verdict, DriftVerdict::kWarmingUp);
  EXPECT_NE(after_a_fall(0.1, -0.1, 0.04, 0.0).verdict, DriftVerdict::kWarmingUp);
}

TEST(DriftMonitor, TheTrendOfALevelThatFallsSteadilyIsItsSlope) {
  // Both averages follow a ramp with their time constants.
  using A = FrictionRls;
  for (const double slope : {-1e-4, 2e-4}) {
    DriftMonitor::State s;
    A::State a;
    a.informed = true;
    for (double t = 0.0; t < 900.0; t += 0.02) {
      a.theta[A::kPositive] = a.theta[A::kNegative] = slope * t;
      DriftMonitor::step(s, a, true, 0.02);
    }
    EXPECT_NEAR(DriftMonitor::report(s, a, 1e-3).trend, slope, 0.01 * std::abs(slope));
  }
}

}  // namespace
}  // namespace stribeck::control::drift_monitor_test
