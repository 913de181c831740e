#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stribeck/report/json.hpp>
#include <stribeck/report/pages/verdict.hpp>
#include <stribeck/report/test_result.hpp>
#include <string>

namespace stribeck::report::verdict_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// (a) and (f) of the thesis, (g) and the default (h) beyond it.
sim::CompareResult beyond() {
  sim::CompareResult result = test::two_controllers();
  sim::CompareRow row = result.rows[0];
  result.rows.resize(1);
  const auto add = [&](const char* id, const char* label, double max, double rms, double input,
                       double ratio) {
    row.controller.id = id;
    row.controller.label = label;
    row.mean = test::metrics(max, rms);
    row.mean.input_variation = input;
    row.mean.quadrant_ratio = ratio;
    result.rows.push_back(row);
  };
  row.controller.friction = sim::FrictionUse::kGaussian;
  row.controller.observer = control::Observer::kDisturbance;
  add("f", "Gaussian", 5e-6, 0.6e-6, 0.020, 12.0);
  row.controller.friction = sim::FrictionUse::kWhole;
  row.controller.feedforward = control::Feedforward::kDynamic;
  add("g", "dynamic", 0.25e-6, 0.06e-6, 0.0185, 1.1);
  row.controller.adaptation.enabled = true;
  add("h", "adapting", 0.5e-6, 0.12e-6, 0.018, 1.25);
  return result;
}

TEST(Verdict, SetsTheDefaultAgainstTheLastOfTheThesis) {
  const sim::CompareResult result = beyond();
  EXPECT_EQ(
      verdict(rows_of(result, 0), "3 mm/s", result),
      "At 3 mm/s (h) adapting, the default, has a largest contour error of 0.50\u00A0µm and "
      "0.12\u00A0µm RMS; (f) Gaussian, the last controller of the thesis, leaves 5.00\u00A0µm and "
      "0.60\u00A0µm RMS: 90\u00A0% less and 80\u00A0% less. The largest error around a reversal is 1.25 "
      "times that of equally long windows elsewhere (quadrant ratio), under (f) 12.00 times. The control input "
      "varies by 18.0\u00A0mV from period to period, 10\u00A0% less than under (f) (20.0\u00A0mV). (g) "
      "dynamic leaves the smallest errors: 0.25\u00A0µm and 0.06\u00A0µm RMS; the difference to (h) is within the scatter. (a) no friction compensation "
      "leaves 8.00\u00A0µm and 4.00\u00A0µm RMS.");
}

// 414.19 beside a maximum of 416.68 was called the largest error of all.
TEST(Verdict, TheErrorAtAQuadrantIsTheLargestOnlyWhereItIs) {
  sim::CompareResult result = test::two_controllers();
  const auto said = [&](double glitch) {
    result.rows[1].mean.quadrant_glitch = glitch * result.rows[1].mean.max_contour_error;
    return verdict(rows_of(result, 0), "3 mm/s", result);
  };
  EXPECT_THAT(said(1.0), HasSubstr("and that is the largest error of all"));
  EXPECT_THAT(said(0.99), HasSubstr("; the largest error is hardly more"));
  EXPECT_THAT(said(0.5), HasSubstr("; the largest error lies elsewhere"));
}

TEST(Verdict, SaysOnlyWhatTheJsonHolds) {
  const sim::CompareResult result = beyond();
  const std::string words = verdict(rows_of(result, 0), "3 mm/s", result);
  const auto json = to_json(result, "bi-table");
  for (const auto& row : json["rows"]) {
    if (row["controller"] == "g") continue;  // only its maximum and RMS are said
    for (const char* key : {"max_contour_error_um", "rms_um"})
      EXPECT_THAT(words, HasSubstr(fmt::format("{:.2f}\u00A0µm", row[key].get<double>())));
    if (row["controller"] == "a") continue;
    EXPECT_THAT(words, HasSubstr(fmt::format("{:.2f} times", row["quadrant_ratio"].get<double>())));
    EXPECT_THAT(words,
                HasSubstr(fmt::format("{:.1f}\u00A0mV", 1e3 * row["input_variation_V"].get<double>())));
  }
}

TEST(Verdict, CallsNobodyOfTheThesisWhoIsNot) {
  sim::CompareResult result = beyond();
  result.rows[1].controller.id = "pid";
  EXPECT_THAT(verdict(rows_of(result, 0), "3 mm/s", result), Not(HasSubstr("thesis")));
  result = beyond();
  result.rows.back().controller.id = "mine";
  EXPECT_THAT(verdict(rows_of(result, 0), "3 mm/s", result), Not(HasSubstr("default")));
}

TEST(Verdict, TakesTheBestWhereNoneAdapts) {
  sim::CompareResult result = beyond();
  result.rows.pop_back();
  const std::string words = verdict(rows_of(result, 0), "3 mm/s", result);
  EXPECT_THAT(words, HasSubstr("At 3 mm/s (g) dynamic has a largest contour error of 0.25"));
  EXPECT_THAT(words, HasSubstr("95\u00A0% less and 90\u00A0% less"));
  EXPECT_THAT(words, Not(HasSubstr("the default")));
  EXPECT_THAT(words, Not(HasSubstr("leaves the smallest errors")));
}

TEST(Verdict, SaysWhatLearningLeaves) {
  sim::CompareResult result = beyond();
  result.rows[2].mean = test::metrics(1e-6, 0.2e-6);
  result.rows[2].controller.law = control::LearningParams{};
  EXPECT_THAT(verdict(rows_of(result, 0), "3 mm/s", result),
              HasSubstr(" (g) dynamic leaves 1.00\u00A0µm and 0.20\u00A0µm RMS. (a)"));
}

TEST(Verdict, DoesNotHideThatSomethingGotWorse) {
  sim::CompareResult result = beyond();
  result.rows[3].mean.max_contour_error = 6e-6;
  result.rows[3].mean.input_variation = 0.030;
  const std::string words = verdict(rows_of(result, 0), "3 mm/s", result);
  EXPECT_THAT(words, HasSubstr("20\u00A0% more and 80\u00A0% less"));
  EXPECT_THAT(words, HasSubstr("50\u00A0% more than under (f)"));
}

TEST(Verdict, NothingIsAHundredPercentLess) {
  sim::CompareResult result = beyond();
  result.rows.back().mean = test::metrics(0.01e-6, 0.0001e-6);
  const std::string words = verdict(rows_of(result, 0), "3 mm/s", result);
  EXPECT_THAT(words, HasSubstr("99.8\u00A0% less"));
  EXPECT_THAT(words, Not(HasSubstr("100\u00A0% less")));
}

TEST(Verdict, WithoutTheThesisOrWithoutFiguresNamesNoRivals) {
  sim::CompareResult result = beyond();
  EXPECT_TRUE(rivals_of(rows_of(result, 0)));
  result.rows[1].mean = test::nothing();
  EXPECT_FALSE(rivals_of(rows_of(result, 0)));
  result = beyond();
  result.rows.erase(result.rows.begin(), result.rows.begin() + 2);
  EXPECT_FALSE(rivals_of(rows_of(result, 0)));
  EXPECT_FALSE(rivals_of({}));
  EXPECT_THAT(verdict(rows_of(result, 0), "3 mm/s", result),
              HasSubstr("(g) dynamic leaves the smallest RMS"));
  result = beyond();
  result.rows[2].mean = result.rows[3].mean = test::nothing();
  EXPECT_FALSE(rivals_of(rows_of(result, 0)));
}

}  // namespace
}  // namespace stribeck::report::verdict_test
