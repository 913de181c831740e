#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stribeck/report/plot/contour_plots.hpp>
#include <stribeck/report/test_result.hpp>
#include <string>
#include <vector>

namespace stribeck::report::contour_plots_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// One row for each error [µm], called (a), (b) …, cosines on the circle of two_controllers().
sim::CompareResult with_errors(const std::vector<double>& errors) {
  sim::CompareResult result = test::two_controllers();
  const sim::CompareRow pattern = result.rows[1];  // 2 µm
  result.rows.clear();
  for (const double e : errors) {
    sim::CompareRow row = pattern;
    row.controller.id = std::string(1, static_cast<char>('a' + result.rows.size()));
    for (sim::ContourSample& s : row.trace) s.contour_error *= e / 2.0;
    result.rows.push_back(std::move(row));
  }
  return result;
}

std::vector<std::string> in_words(const sim::CompareResult& result) {
  const Rows rows = rows_of(result, 0);
  std::vector<std::string> words;
  for (const ScaleGroup& g : scale_groups(rows)) words.push_back(names_of(g.rows, rows));
  return words;
}

TEST(ScaleGroups, BeginBelowAQuarter) {
  EXPECT_THAT(in_words(with_errors({12, 5, 3.01, 0.4, 0.2})), ElementsAre("(a) to (c)", "(d) and (e)"));
  EXPECT_THAT(in_words(with_errors({12, 5, 2.99, 0.8})), ElementsAre("(a) and (b)", "(c) and (d)"));
  EXPECT_THAT(in_words(with_errors({0.3, 12, 2, 0.4, 5})), ElementsAre("(b) and (e)", "(c)", "(a) and (d)"));
  EXPECT_THAT(in_words(with_errors({4, 3, 2})), ElementsAre("(a) to (c)"));
  EXPECT_THAT(in_words(with_errors({})), ElementsAre());
}

TEST(ScaleGroups, TakeWhatHasNoTraceAlong) {
  sim::CompareResult result = with_errors({12, 0.4});
  result.rows[0].trace.clear();
  EXPECT_THAT(in_words(result), ElementsAre("(a) and (b)"));
  result.rows[1].trace.clear();
  EXPECT_THAT(in_words(result), ElementsAre("(a) and (b)"));
}

// A list of all names was longer than its figure is wide.
TEST(ScaleGroups, NamesThatFollowOneAnotherAreARange) {
  const sim::CompareResult result = with_errors({12, 0.3, 0.3, 12, 0.3, 0.3, 0.3, 12, 0.3, 0.3});
  const Rows rows = rows_of(result, 0);
  EXPECT_EQ(names_of({rows[1], rows[2], rows[4], rows[5], rows[6], rows[8]}, rows),
            "(b), (c), (e) to (g) and (i)");
  EXPECT_EQ(names_of({rows[8], rows[9]}, rows), "(i) and (j)");
  EXPECT_EQ(names_of({}, rows), "");
}

TEST(ScaleGroups, LeaveOutTheCoarserStepByStep) {
  const sim::CompareResult result = with_errors({12, 0.3, 2, 1.9});
  const Rows rows = rows_of(result, 0);
  const std::vector<Rows> finer = finer_rows(rows);
  ASSERT_EQ(finer.size(), 2u);
  EXPECT_EQ(names_of(finer[0], rows), "(b) to (d)");
  EXPECT_EQ(names_of(finer[1], rows), "(b)");
}

// The half height is 1.08 of the largest error; 12 µm to 0.4 µm is a factor of 30.
TEST(ContourPlots, GiveSmallErrorsAScaleThatSaysSo) {
  const sim::CompareResult result = with_errors({12, 11, 10, 9, 0.4});
  for (const ScaledPlots& drawn : {path_plots(result, 0, {}), time_plots(result, 0, {})}) {
    ASSERT_EQ(drawn.plots.size(), 3u);
    EXPECT_NEAR(drawn.plots[0].y_range->high, 1.08 * 12.0, 0.02);
    EXPECT_NEAR(drawn.plots[1].y_range->low, -1.08 * 12.0, 0.02);
    EXPECT_NEAR(drawn.plots[2].y_range->high, 1.08 * 0.4, 0.001);
    EXPECT_THAT(drawn.plots[0].title, HasSubstr(": (a) to (c)"));
    EXPECT_THAT(drawn.plots[0].title, ::testing::Not(HasSubstr("finer")));
    EXPECT_THAT(drawn.plots[2].title, HasSubstr(": (e), scale 30 times finer"));
    EXPECT_EQ(drawn.scales,
              "Scales differ: ±13\u00A0µm for (a) to (d); ±0.43\u00A0µm for (e) (30 times finer).");
  }
  EXPECT_EQ(path_plots(with_errors({4, 3, 2, 1}), 0, {}).scales, "All drawings have the same scale.");
  EXPECT_EQ(path_plots(with_errors({4, 3}), 0, {}).scales, "");
}

TEST(ContourPlots, CallTheErrorOfOneAxisWhatItIs) {
  sim::CompareResult result = with_errors({4});
  EXPECT_EQ(path_plots(result, 0, {}).plots[0].y_label, "contour error [µm]");
  result.axes = {"x"};
  EXPECT_EQ(path_plots(result, 0, {}).plots[0].y_label, "tracking error [µm]");
  EXPECT_THAT(time_plots(result, 0, {}).plots[0].title, HasSubstr("Tracking error at 9.5 mm/s over time"));
}

TEST(ContourPlots, ShowRunInAndRunOutOnlyWhereAskedFor) {
  const sim::CompareResult result = with_errors({4});
  const Plot scored = time_plots(result, 0, {}).plots[0];
  const Plot whole = time_plots(result, 0, {.scored_only = false}).plots[0];
  EXPECT_GE(scored.series[0].x.front(), 1.0);
  EXPECT_EQ(whole.series[0].x.front(), 0.0);
  EXPECT_EQ(scored.markers.size(), 0u);
  EXPECT_EQ(whole.markers.size(), 2u);
}

// 300° are scored, from half a lap on: what lies between their end and their beginning is a gap, not a line.
TEST(ContourPlots, LeaveAGapWhereNothingWasScored) {
  sim::CompareResult result = with_errors({4});
  auto& trace = result.rows[0].trace;
  const auto first =
      std::find_if(trace.begin(), trace.end(), [](const sim::ContourSample& x) { return x.scored; });
  const double begin = first->phi + kPi;
  for (sim::ContourSample& x : trace)
    x.scored = x.scored && x.phi > begin && x.phi < begin + 300.0 / 180.0 * kPi;
  const Lap lap = last_lap(trace, result.spec.travels[0]);
  std::size_t gaps = 0;
  for (std::size_t k = 0; k < lap.angle.size(); ++k) {
    EXPECT_EQ(lap.samples[k] == nullptr, std::isnan(lap.angle[k]));
    if (lap.samples[k] == nullptr) ++gaps;
  }
  EXPECT_EQ(gaps, 1u);
  const Lap full = last_lap(with_errors({4}).rows[0].trace, result.spec.travels[0]);
  // A whole lap is drawn without a break but where it ends and begins.
  EXPECT_LE(std::count_if(full.angle.begin(), full.angle.end(), [](double a) { return std::isnan(a); }), 1);
  ASSERT_FALSE(full.angle.empty());
}

}  // namespace
}  // namespace stribeck::report::contour_plots_test
