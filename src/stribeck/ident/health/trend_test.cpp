#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stribeck/ident/health/trend.hpp>

namespace stribeck::ident::health::trend_test {
namespace {

/// Daily tests about 1 with a scatter of 1.5 %, and what else a test adds.
struct Series {
  int days = 200;
  double season = 0.0;  ///< amplitude of a year
  double per_degree = 0.0;
  int step_day = 1000;
  double step = 0.0;
  double correlation = 0.0;

  [[nodiscard]] std::vector<Reading> readings(std::uint32_t seed) const {
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    std::vector<Reading> out;
    double noise = 0.0;
    for (int d = 0; d < days; ++d) {
      noise = correlation * noise + std::sqrt(1.0 - correlation * correlation) * normal(generator);
      const double year = std::sin(2.0 * 3.14159265358979 * d / 365.0 + seed);
      const double degrees = 20.0 + 8.0 * year + normal(generator);
      Reading r;
      r.day = d;
      r.value =
          1.0 + 0.015 * noise + season * year + per_degree * (degrees - 20.0) + (d >= step_day ? step : 0.0);
      r.half_width = 0.005;
      if (per_degree != 0.0) r.temperature = degrees;
      out.push_back(r);
    }
    return out;
  }
};

// Without noise, by hand: 1 up to day 19, 0.8 from day 20 on.
TEST(HealthTrend, AnExactStepIsFoundOnItsDayWithItsSize) {
  std::vector<Reading> readings;
  for (int d = 0; d < 40; ++d) readings.push_back({static_cast<double>(d), d < 20 ? 1.0 : 0.8, 0.001, kNaN});
  const Trend trend = trend_of(readings, {});
  ASSERT_EQ(trend.steps.size(), 1U);
  EXPECT_EQ(trend.steps[0].day, 20.0);
  EXPECT_EQ(trend.steps[0].earliest, 20.0);
  EXPECT_EQ(trend.steps[0].latest, 20.0);
  EXPECT_NEAR(trend.steps[0].change, -0.2, 1e-3);  // the slope prior pulls a little
  EXPECT_GT(trend.steps[0].probability, 0.999);
  EXPECT_TRUE(trend.stepped);
  EXPECT_NEAR(trend.reference, 1.0, 1e-3);
  EXPECT_NEAR(trend.now, 0.8, 1e-3);
}

// Half of the differences between tests three apart stand across a step when there are nine of them. The step was taken for scatter: it was
// found with eight tests and gone with the ninth.
TEST(HealthTrend, AStepStaysFoundWhileTestsAreAdded) {
  for (const double size : {0.2, 0.5, 1.0, -0.3}) {
    for (int before = 3; before <= 9; ++before) {
      for (int after = 3; after <= 9; ++after) {
        Series s;
        s.days = before + after;
        s.step_day = before;
        s.step = size;
        int found = 0;
        for (std::uint32_t seed = 1; seed <= 20; ++seed) {
          const Trend t = trend_of(s.readings(seed), TrendOptions{});
          if (t.steps.size() == 1 && t.steps[0].day == before && std::abs(t.steps[0].change - size) < 0.06)
            ++found;
        }
        EXPECT_GE(found, 17) << size << ": " << before << " and " << after;
      }
    }
  }
}

// Few tests of an axis that has not changed.
TEST(HealthTrend, FewTestsRaiseNoAlarm) {
  int alarms = 0, trends = 0;
  for (int days = 6; days <= 24; ++days) {
    for (std::uint32_t seed = 1; seed <= 50; ++seed) {
      Series s;
      s.days = days;
      alarms += trend_of(s.readings(seed), TrendOptions{}).steps.empty() ? 0 : 1;
      ++trends;
    }
  }
  EXPECT_LE(alarms, trends / 200);
}

TEST(HealthTrend, ASeasonIsDriftAndNoStep) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    Series series;
    series.days = 365;
    series.season = 0.08;
    const Trend trend = trend_of(series.readings(seed), {});
    EXPECT_TRUE(trend.steps.empty()) << "seed " << seed << ", day " << trend.steps.front().day;
    EXPECT_FALSE(trend.changed()) << "seed " << seed;
  }
}

// Of twenty years with scatter correlated by a half from day to day, none raises an alarm.
TEST(HealthTrend, CorrelatedScatterRaisesNoAlarm) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    Series series;
    series.days = 365;
    series.season = 0.05;
    series.correlation = 0.5;
    EXPECT_FALSE(trend_of(series.readings(seed), {}).changed()) << "seed " << seed;
  }
}

TEST(HealthTrend, AStepInASeasonIsFoundWithinAWeek) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    Series series;
    series.days = 127;
    series.season = 0.08;
    series.step_day = 120;
    series.step = -0.15;
    const Trend trend = trend_of(series.readings(seed), {});
    ASSERT_EQ(trend.steps.size(), 1U) << "seed " << seed;
    EXPECT_NEAR(trend.steps[0].day, 120.0, 1.0) << "seed " << seed;
    // Five half widths: the interval of one seed of twenty misses as it should.
    EXPECT_NEAR(trend.steps[0].change, -0.15, 2.5 * trend.steps[0].half_width) << "seed " << seed;
    EXPECT_TRUE(trend.stepped) << "seed " << seed;
  }
}

TEST(HealthTrend, OneOrTwoWildTestsAreNoChange) {
  std::vector<Reading> readings = Series().readings(3);
  readings[100].value += 0.5;
  readings[101].value += 0.5;
  readings.back().value -= 0.4;
  const Trend trend = trend_of(readings, {});
  EXPECT_TRUE(trend.steps.empty());
  EXPECT_FALSE(trend.changed());
}

TEST(HealthTrend, WhatWasRepairedNoLongerCounts) {
  std::vector<Reading> readings = Series().readings(4);
  for (int d = 80; d < 110; ++d) readings[static_cast<std::size_t>(d)].value += 0.2;
  const Trend trend = trend_of(readings, {});
  ASSERT_EQ(trend.steps.size(), 2U);
  EXPECT_TRUE(trend.steps[0].beyond_limit && trend.steps[0].undone);
  EXPECT_FALSE(trend.steps[1].undone) << "the repair itself lasts";
  EXPECT_TRUE(trend.steps[1].restores);
  EXPECT_FALSE(trend.stepped);
}

// A second fault that ends at another level than the first began at.
TEST(HealthTrend, AStepBeyondWhatWasThereBeforeRestoresNothing) {
  std::vector<Reading> readings = Series().readings(4);
  for (int d = 80; d < 110; ++d) readings[static_cast<std::size_t>(d)].value += 0.2;
  for (std::size_t d = 110; d < readings.size(); ++d) readings[d].value -= 0.2;
  const Trend trend = trend_of(readings, {});
  ASSERT_EQ(trend.steps.size(), 2U);
  EXPECT_FALSE(trend.steps[0].restores || trend.steps[1].restores);
  EXPECT_TRUE(trend.stepped);
}

TEST(HealthTrend, AFaultThatComesBackIsAFault) {
  std::vector<Reading> readings = Series().readings(4);
  for (std::size_t d = 40; d < 70; ++d) readings[d].value += 0.2;
  for (std::size_t d = 100; d < readings.size(); ++d) readings[d].value += 0.2;
  const Trend trend = trend_of(readings, {});
  ASSERT_EQ(trend.steps.size(), 3U);
  EXPECT_TRUE(trend.steps[1].restores);
  EXPECT_FALSE(trend.steps[2].restores);
  EXPECT_TRUE(trend.steps[2].matters());
}

TEST(HealthTrend, TheEffectOfTemperatureIsTakenOff) {
  Series series;
  series.days = 180;  // half a year: warm at one end, cold at the other
  series.per_degree = -0.006;
  const Trend trend = trend_of(series.readings(5), {});
  EXPECT_NEAR(trend.per_degree, -0.006, 0.0015);  // scatter 1.5 %, differences of about 1.5 K
  EXPECT_FALSE(trend.changed());
  EXPECT_LT(std::abs(trend.now - trend.reference), 0.03);
}

// Once a week the difference of thirty tests is one of seven months: a season is no effect of temperature.
TEST(HealthTrend, ASeasonOfWeeklyTestsIsNoEffectOfTemperature) {
  std::vector<Reading> readings;
  for (int week = 0; week < 60; ++week) {
    const double day = 7.0 * week, year = std::sin(2.0 * std::numbers::pi * day / 365.0);
    // Colder and warmer from week to week without any effect, and both warm and slack in summer.
    readings.push_back({day, 1.0 + 0.1 * year, 0.001, 20.0 + 6.0 * year + (week % 2 == 0 ? 3.0 : -3.0)});
  }
  EXPECT_LT(std::abs(trend_of(readings, {}).per_degree), 0.003);
}

TEST(HealthTrend, SlowWearIsADriftBeyondItsLimit) {
  std::vector<Reading> readings = Series().readings(6);
  for (std::size_t d = 60; d < readings.size(); ++d) readings[d].value += 0.003 * static_cast<double>(d - 60);
  const Trend trend = trend_of(readings, {});
  EXPECT_TRUE(trend.drifted);
  EXPECT_TRUE(trend.steps.empty());
  EXPECT_NEAR(trend.slope, 0.003, 0.0005);
}

// Invariance: another unit and another day of beginning change nothing but the unit and the day.
TEST(HealthTrend, UnitsAndDatesDoNotMatter) {
  Series series;
  series.step_day = 100;
  series.step = 0.15;
  std::vector<Reading> readings = series.readings(7), other = readings;
  for (Reading& r : other) {
    r.day += 20000.0;
    r.value *= 1000.0;
    r.half_width *= 1000.0;
  }
  const Trend a = trend_of(readings, {});
  const Trend b = trend_of(other, {1000.0});
  ASSERT_EQ(a.steps.size(), 1U);
  ASSERT_EQ(b.steps.size(), 1U);
  EXPECT_EQ(b.steps[0].day, a.steps[0].day + 20000.0);
  EXPECT_NEAR(b.steps[0].change, 1000.0 * a.steps[0].change, 1e-6);
}

TEST(HealthTrend, FewerThanThreeReadingsHaveNoTrend) {
  EXPECT_FALSE(trend_of({}, {}).known());
  EXPECT_FALSE(trend_of({{0.0, 1.0, 0.1, kNaN}, {1.0, 2.0, 0.1, kNaN}}, {}).changed());
  EXPECT_TRUE(trend_of({{0.0, 1.0, 0.1, kNaN}, {1.0, 1.0, 0.1, kNaN}, {2.0, 1.0, 0.1, kNaN}}, {}).known());
}

// A step needs three tests: until then it is told as what it is.
TEST(HealthTrend, TheNewestTestsThatDifferArePending) {
  std::vector<Reading> readings;
  for (const double value : {30.4, 30.9, 30.2, 39.6})
    readings.push_back({static_cast<double>(readings.size()), value, 0.3, kNaN});
  Trend trend = trend_of(readings, {.scale = 30.4});
  EXPECT_FALSE(trend.changed());
  ASSERT_TRUE(trend.pending);
  EXPECT_EQ(trend.pending->tests, 1U);
  EXPECT_NEAR(trend.pending->change, 9.2, 1e-9);
  readings.push_back({4.0, 39.9, 0.3, kNaN});
  trend = trend_of(readings, {.scale = 30.4});
  ASSERT_TRUE(trend.pending);
  EXPECT_EQ(trend.pending->tests, 2U);
  readings.push_back({5.0, 39.4, 0.3, kNaN});
  trend = trend_of(readings, {.scale = 30.4});
  EXPECT_TRUE(trend.stepped);
  EXPECT_FALSE(trend.pending);
}

TEST(HealthTrend, OneWildTestInThePastIsNotPending) {
  std::vector<Reading> readings;
  for (const double value : {30.4, 30.9, 30.2, 39.6, 30.5})
    readings.push_back({static_cast<double>(readings.size()), value, 0.3, kNaN});
  EXPECT_FALSE(trend_of(readings, {.scale = 30.4}).pending);
}

}  // namespace
}  // namespace stribeck::ident::health::trend_test
