#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stribeck/report/circle/circle_change.hpp>
#include <stribeck/report/test_result.hpp>

namespace stribeck::report::circle_change_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A log of one direction, with laps of these circular deviations [µm].
CircleLog log_of(const std::string& label, const std::vector<double>& deviations) {
  ident::circle::DirectionTest d;
  for (const double um : deviations) {
    d.laps.push_back({um * 1e-6, 0.5e-6, um * 1e-6});
    d.circular_deviation = std::fmax(d.circular_deviation, um * 1e-6);
  }
  d.radial_max = 2e-6;
  d.radial_min = -3e-6;
  ident::circle::CircularTest test;
  test.directions = {d};
  test.mean_radial_deviation = -1.5e-6;
  CircleLog log;
  log.label = label;
  log.test = test;
  ident::circle::CircleTest circle;
  circle.max_error = d.circular_deviation;
  circle.circular_deviation = d.circular_deviation;
  circle.rms = 0.5e-6;
  circle.quadrant_glitch = 1e-6;
  for (int i = 0; i <= 360; ++i) {
    circle.angle.push_back(i * 0.0174533);
    circle.error.push_back(1e-6 * std::sin(0.0349066 * i));
  }
  circle.revolutions = 1.0;
  log.circles = {circle};
  return log;
}

const CircleChange& change_of(const std::vector<CircleChange>& all, const std::string& figure) {
  for (const CircleChange& c : all) {
    if (c.figure == figure) return c;
  }
  throw std::runtime_error("no change of " + figure);
}

// By hand: means 11 and 5, variances of the means 1/3 and 1/3, 4 degrees of freedom, t 2.776.
TEST(CircleChange, IntervalOfTheDifferenceIsThatOfWelch) {
  const auto all = circle_changes(log_of("a", {10, 11, 12}), log_of("b", {4, 5, 6}));
  const CircleChange& g = change_of(all, "G");
  EXPECT_NEAR(g.before, 11e-6, 1e-12);
  EXPECT_NEAR(g.difference(), -6e-6, 1e-12);
  EXPECT_NEAR(g.half_width, 2.776e-6 * std::sqrt(2.0 / 3.0), 1e-9);
  EXPECT_EQ(g.verdict(), "smaller");
  EXPECT_EQ(change_of(all, "RMS").verdict(), "within the repeatability");  // the same in every lap
}

TEST(CircleChange, ChangesWithinTheScatterOrOfOneLapAreNoChanges) {
  EXPECT_EQ(change_of(circle_changes(log_of("a", {10, 14}), log_of("b", {9, 13})), "G").verdict(),
            "within the repeatability");
  EXPECT_EQ(change_of(circle_changes(log_of("a", {10}), log_of("b", {1, 2})), "G").verdict(),
            "not known: one lap");
  EXPECT_EQ(change_of(circle_changes(log_of("a", {1, 1.1}), log_of("b", {9, 9.1})), "G").verdict(), "larger");
}

TEST(CircleChange, PeaksAreComparedAtTheSamePlace) {
  CircleLog a = log_of("a", {10, 11});
  CircleLog b = log_of("b", {10, 11});
  ident::circle::QuadrantPeak peak;
  peak.axis = 1;
  peak.angle = 1.5708;
  peak.height = -6e-6;
  peak.half_width_95 = 0.3e-6;
  peak.laps = 2;
  peak.repeatability = 0.0;
  a.diagnosis.emplace().peaks = {peak};
  peak.height = 2e-6;
  peak.half_width_95 = 0.4e-6;
  b.diagnosis.emplace().peaks = {peak};
  const auto all = circle_changes(a, b);
  const CircleChange& c = change_of(all, "peak y 90°");
  EXPECT_NEAR(c.half_width, 0.5e-6, 1e-12);
  EXPECT_EQ(c.verdict(), "smaller, turned round");  // nearer to zero
  EXPECT_EQ((CircleChange{"peak x 0°", "ccw", 3.72e-6, -3.26e-6, 0.5e-6}.verdict()),
            "turned round (overcompensated)");
  EXPECT_EQ((CircleChange{"peak x 0°", "ccw", 3.72e-6, -3.26e-6, 0.4e-6}.verdict()), "smaller, turned round");
  EXPECT_EQ((CircleChange{"peak x 0°", "ccw", 3.72e-6, -0.3e-6, 0.4e-6}.verdict()), "smaller");
  EXPECT_EQ((CircleChange{"peak x 0°", "ccw", 3.26e-6, -3.72e-6, 0.4e-6}.verdict()), "larger, turned round");
  EXPECT_EQ((CircleChange{"peak x 0°", "ccw", -3.72e-6, 3.26e-6, 0.5e-6}.verdict()), "turned round");
  // Laps that scatter by a micrometre leave 4 um on either side, of two laps each; one lap leaves nothing known.
  a.diagnosis->peaks[0].repeatability = b.diagnosis->peaks[0].repeatability = 1e-6;
  EXPECT_NEAR(change_of(circle_changes(a, b), "peak y 90°").half_width, 4.33e-6, 0.05e-6);
  a.diagnosis->peaks[0].repeatability = std::nan("");
  EXPECT_EQ(change_of(circle_changes(a, b), "peak y 90°").verdict(), "not known: one lap");
  // Where neither has a peak, there is no change of one.
  a.diagnosis->peaks[0].height = b.diagnosis->peaks[0].height = 0.1e-6;
  EXPECT_EQ(circle_changes(a, b).size(), 3u);
  b.diagnosis->peaks[0].height = 2e-6;
  b.diagnosis->peaks[0].angle = 4.7124;
  EXPECT_EQ(circle_changes(a, b).size(), 3u);
}

TEST(CircleLimits, JudgeEveryFigureOfEveryLog) {
  CircleReportInput input;
  input.radius = 0.01;
  input.logs = {log_of("before", {10, 11}), log_of("after", {4, 5})};
  input.limits = {{"G", 5e-6}, {"F", 3e-6}, {"D", 1e-6}, {"G(b)", 9e-6}};
  std::vector<bool> passed;
  for (const CircleVerdict& v : circle_verdicts(input)) passed.push_back(v.passed());
  EXPECT_EQ(passed, (std::vector<bool>{false, true, false, false, true, true, false, false}));
  EXPECT_THAT(limits_text(input),
              HasSubstr("above: before G of 11.00 µm, limit 5.00 µm (the others are compared"));
  EXPECT_THAT(limits_text(input), HasSubstr("FAILED: after G(b) was not measured, limit 9.00 µm\n"));
  EXPECT_TRUE(limits_json(input)[3]["value_um"].is_null());
  const std::string page = circle_report(input);
  EXPECT_THAT(page, HasSubstr("Failed: 2 of 4 figures are beyond their limits or not measured."));
  EXPECT_THAT(page, HasSubstr("Change from before to after</h2>"));
  // What was there before does not decide; measurements of one machine all do, and a single one.
  EXPECT_FALSE(within_limits(input));
  input.limits = {{"G", 5e-6}};
  EXPECT_TRUE(within_limits(input));
  input.together.emplace();
  EXPECT_FALSE(within_limits(input));
  input.together.reset();
  std::swap(input.logs[0], input.logs[1]);
  EXPECT_FALSE(within_limits(input));
  input.logs.pop_back();
  EXPECT_TRUE(within_limits(input));
  input.logs = {log_of("before", {10, 11})};
  EXPECT_FALSE(within_limits(input));
  for (const std::string& figure : limited_figures()) {
    const double value = limited_figure(input.logs[0], figure);
    EXPECT_EQ(std::isfinite(value), figure != "G(b)" && figure != "H") << figure;
  }
}

TEST(CirclePage, FirstScreenHoldsAnswerNumbersAndThePicture) {
  CircleReportInput input;
  input.title = "Circle";
  input.radius = 0.01;
  input.logs = {log_of("one", {4, 5})};
  const std::string page = test::without_script(circle_report(input));
  const auto lead = page.find("The circle of 10 mm deviates by G = 5.00 µm from round");
  const auto numbers = page.find("<dl class=\"numbers\">");
  const auto picture = page.find("<svg ");
  const auto contents = page.find("<nav ");
  ASSERT_NE(lead, std::string::npos);
  EXPECT_LT(lead, numbers);
  EXPECT_LT(numbers, picture);
  EXPECT_LT(picture, contents);
  for (const char* mark : {">III</text>", ">x+</text>", ">5 µm</text>"}) EXPECT_THAT(page, HasSubstr(mark));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace stribeck::report::circle_change_test
