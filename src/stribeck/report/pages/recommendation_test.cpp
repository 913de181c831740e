#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/report/pages/compare_report.hpp>
#include <stribeck/report/pages/recommendation.hpp>
#include <stribeck/report/test_result.hpp>

namespace stribeck::report::recommendation_test {
namespace {

using ::testing::HasSubstr;

CompareReportInput two() {
  CompareReportInput in;
  in.result = test::two_controllers();
  return in;
}

TEST(Recommendation, NamesTheControllerWithTheSmallestLargestError) {
  const CompareReportInput in = two();
  const Recommendation r = recommendation(blocks_of(in), in.result);
  EXPECT_EQ(
      r.words,
      "Use (b) conventional friction model: its largest contour error is 2.00\u00A0µm at 9.5 mm/s, the smallest of 2 "
      "controllers.");
  ASSERT_EQ(r.numbers.size(), 2u);
  EXPECT_EQ(r.numbers[1].name, "of the error of (a) no friction compensation remain");
  EXPECT_EQ(r.numbers[1].value, "25");
}

TEST(Recommendation, TheDefaultIsNamedUnlessItIsWorse) {
  CompareReportInput in = two();
  sim::CompareRow h = in.result.rows[1];
  h.controller.id = "h";
  h.controller.adaptation.enabled = true;
  h.controller.friction = sim::FrictionUse::kWhole;
  h.controller.feedforward = control::Feedforward::kDynamic;
  sim::CompareRow i = h;
  i.controller.id = "i";
  i.controller.adaptation.enabled = false;
  // 0.2 µm is within twice the standard error of the difference, 2 √2 · 0.25 µm / √4.
  h.mean.max_contour_error = 1.0e-6;
  i.mean.max_contour_error = 0.8e-6;
  h.spread.max_contour_error = i.spread.max_contour_error = 0.25e-6;
  in.result.spec.trials = 4;
  in.result.rows.push_back(h);
  in.result.rows.push_back(i);
  EXPECT_THAT(recommendation(blocks_of(in), in.result).words, HasSubstr("Use (h)"));
  in.result.rows.back().mean.max_contour_error = 0.5e-6;
  const std::string words = recommendation(blocks_of(in), in.result).words;
  EXPECT_THAT(words, HasSubstr("Use (i)"));
  EXPECT_THAT(words, HasSubstr(" The default, (h), leaves 1.00\u00A0µm at 9.5 mm/s."));
}

TEST(Recommendation, SaysWhereAnotherControllerIsBetter) {
  CompareReportInput in = two();
  in.result.spec.travels.push_back(in.result.spec.travels.front());
  in.result.spec.travels.back().speed = 54e-3;
  for (const std::size_t k : {0U, 1U}) {
    sim::CompareRow row = in.result.rows[k];
    row.travel = 1;
    row.mean.max_contour_error = k == 0 ? 2.5e-6 : 3.0e-6;
    in.result.rows.push_back(row);
  }
  const Recommendation r = recommendation(blocks_of(in), in.result);
  EXPECT_THAT(r.words, HasSubstr("Use (b)"));
  EXPECT_THAT(
      r.words,
      HasSubstr(
          "the smallest of 2 controllers over all speeds together; only at 54 mm/s, (a) is better: 2.50\u00A0µm"));
  EXPECT_THAT(r.numbers.back().name, HasSubstr("geometric mean over the speeds"));
}

TEST(Recommendation, NothingFiniteIsSaid) {
  CompareReportInput in = two();
  for (auto& row : in.result.rows) row.refused = "unstable";
  const Recommendation r = recommendation(blocks_of(in), in.result);
  EXPECT_TRUE(r.rows.empty());
  EXPECT_THAT(r.words, HasSubstr("No controller gave a finite result"));
  EXPECT_EQ(recommendation({}, in.result).words, "");
}

}  // namespace
}  // namespace stribeck::report::recommendation_test
