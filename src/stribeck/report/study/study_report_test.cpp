#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stribeck/core/numbers.hpp>
#include <stribeck/report/study/study_report.hpp>

namespace stribeck::report::study_report_test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// 200 machines with errors of 1 to 200, the last `lost` of them infinite.
StudyResult result(int lost = 0) {
  StudyResult r;
  r.machine = "table <1>";
  r.sampling = sim::Sampling::kRandom;
  r.samples = 200;
  r.runs = 200;
  r.seed = 4;
  r.parameters = "printed";
  r.factors = {{"x.friction", "scale, uniform, 0.7 to 1.3"}};
  r.columns = {{"max_contour_error_um", "max", "µm", 1.0},
               {"input_variation_V", "mean |Δu|", "mV", 1e3},
               {"power_W", "power", "W", 1.0}};
  StudiedRow row{"f", "observer", "9.5 mm/s", static_cast<std::uint64_t>(lost), 0, false, {}};
  row.figures.resize(3);
  row.figures[0].nominal = 90.0;
  row.figures[1].nominal = 0.02;
  row.figures[2].nominal = kNaN;
  for (int i = 1; i <= 200; ++i) {
    row.figures[0].spread.add(i > 200 - lost ? kInfinity : i);
    row.figures[1].spread.add(0.01 * i);
  }
  sim::SobolIndex index{{0.6, 0.5, 0.7}, {0.8, 0.7, 0.9}};
  row.figures[0].indices = {index};
  row.figures[0].index_samples = 25;
  r.rows = {row};
  return r;
}

TEST(StudyReport, TextHasQuantilesInTheShownUnit) {
  const std::string text = text_table(result());
  EXPECT_THAT(text, HasSubstr("200 machines that differ from \"table <1>\": random draws, seed 4."));
  EXPECT_THAT(text, HasSubstr("x.friction: scale, uniform, 0.7 to 1.3"));
  // Ranks of the sign test: 86 and 115 of 200 for the median.
  EXPECT_THAT(text,
              HasSubstr("f  max [µm]          90.00   100.0  86.01 … 115.0  190.1  183.9 … 197.1  200.0"));
  EXPECT_THAT(text, HasSubstr("f  mean |Δu| [mV]    20.00   999.5   860.3 … 1150"));
  EXPECT_THAT(text, HasSubstr("x.friction   60.0  50.0 … 70.0    80.0  70.0 … 90.0"));
  // Nothing is said of a figure that no run has.
  EXPECT_THAT(text, Not(HasSubstr("power")));
}

TEST(StudyReport, LostRunsAreSaid) {
  const std::string text = text_table(result(30));
  EXPECT_THAT(
      text,
      HasSubstr("(f) at 9.5 mm/s: the path is lost on 30 of 200 machines, 15.0 %; they count as infinite"));
  const auto json = to_json(result(30));
  const auto& figure = json["rows"][0]["figures"][0];
  EXPECT_TRUE(figure["mean"].is_null());
  EXPECT_TRUE(figure["largest"].is_null());
  EXPECT_TRUE(figure["quantiles"][2]["value"].is_null());
  EXPECT_NEAR(figure["quantiles"][1]["value"].get<double>(), 100.0, 0.1);
}

TEST(StudyReport, JsonHasNoUnitsLeftOut) {
  const auto json = to_json(result());
  EXPECT_EQ(json["schema"], "stribeck.study/1");
  ASSERT_EQ(json["rows"][0]["figures"].size(), 2U);
  const auto& figure = json["rows"][0]["figures"][1];
  EXPECT_EQ(figure["figure"], "input_variation_V");
  EXPECT_NEAR(figure["mean"].get<double>(), 1.005, 1e-12);
  EXPECT_EQ(json["rows"][0]["figures"][0]["indices"][0]["first_ci95"], nlohmann::ordered_json({0.5, 0.7}));
}

TEST(StudyReport, ThePageBeginsWithWhoIsBestAndHowSureThatIs) {
  StudyResult r = result();
  const auto page_of = [](const StudyResult& all) { return study_report({all, "again", "1"}); };
  EXPECT_THAT(
      page_of(r),
      HasSubstr(
          "9.5 mm/s: under (f) the largest error stays below 190.1 µm on 95 % of the machines (183.9 … "
          "197.1, 95 % sure). Of the variance under (f) 80.0 % (70.0 … 90.0, 95 % sure) goes with x.friction."));
  // A second one with half of the errors comes first; with nearly the same it is not told apart.
  StudiedRow other = r.rows.front();
  other.controller = "h";
  for (const double scale : {0.5, 0.99}) {
    other.figures[0].spread = {};
    for (int i = 1; i <= 200; ++i) other.figures[0].spread.add(scale * i);
    StudyResult both = r;
    both.rows.push_back(other);
    const std::string html = page_of(both);
    EXPECT_THAT(html, HasSubstr("9.5 mm/s: under (h) the largest error stays below"));
    EXPECT_THAT(html, HasSubstr("under (f), the next of 2, it is 190.1 µm"));
    EXPECT_EQ(html.find("do not tell apart") != std::string::npos, scale > 0.9);
  }
  EXPECT_THAT(page_of(result(5)), HasSubstr("It loses the path on 5 of 200 machines."));
  EXPECT_THAT(
      page_of(result(30)),
      HasSubstr(
          "every controller loses the path on more than 5 % of the machines; (f) does so on 30 of 200"));
}

TEST(StudyReport, AGridHasNoConfidence) {
  StudyResult r = result();
  r.sampling = sim::Sampling::kGrid;
  EXPECT_THAT(text_table(r), HasSubstr("– … –"));
  EXPECT_TRUE(to_json(r)["rows"][0]["figures"][0]["quantiles"][1]["ci95"][0].is_null());
}

TEST(StudyReport, PageHasBothPictures) {
  const std::string html =
      study_report({result(), "stribeck study s.toml -o out", "1", {{"s.toml", "0123abcd"}}});
  EXPECT_THAT(html, HasSubstr("0123abcd"));  // which file it was
  EXPECT_THAT(html, HasSubstr("Study: table &lt;1&gt;"));
  EXPECT_THAT(html, HasSubstr("share of the machines whose max is below a value"));
  EXPECT_THAT(html, HasSubstr("share of the variance that comes from each factor"));
  EXPECT_THAT(html, HasSubstr("stribeck study s.toml -o out"));
  StudyResult plain = result();
  plain.rows[0].figures[0].indices.clear();
  EXPECT_THAT(study_report({plain, "again", "1"}), Not(HasSubstr("Which factor matters")));
}

}  // namespace
}  // namespace stribeck::report::study_report_test
