#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/report/page/output.hpp>
#include <stribeck/report/test_result.hpp>

namespace stribeck::report::output_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

Plot plot_of_two() {
  Plot p;
  p.title = "Error at 3 mm/s";
  p.x_label = "time [s]";
  p.y_label = "error [um]";
  p.series = {{.label = "(f), with observer", .x = {0, 1}, .y = {0.5, test::kNaN}},
              {.label = "band", .x = {0}, .y_low = {1}, .y_high = {2}, .style = Style::kBand}};
  return p;
}

Table small_table() {
  return {
      "Errors & more", {{"name", "", false}, {"max", "um"}}, {{{"a|b_1"}, {"1.00", "± 0.10", "print 2 %"}}}};
}

TEST(Output, DataOfAFigure) {
  EXPECT_EQ(data_csv(plot_of_two()),
            "curve,time [s],error [um],low,high\n"
            "\"(f), with observer\",0,0.5,,\n"
            "\"(f), with observer\",1,,,\n"
            "band,0,,1,2\n");
  Plot bars{.x_tics = {{1.0, "(f)"}, {2.0, "(h)"}}};
  for (const double x : {1.0, 2.0}) bars.series.push_back({.x = {x}, .y = {x}, .style = Style::kBars});
  EXPECT_EQ(data_csv(bars), "curve,x,y,low,high\n(f),1,1,,\n(h),2,2,,\n");
}

// A circle of 10 mm about (20, 0) whose error is drawn 1000 times: 1 mm of the drawing is 1 µm.
TEST(Output, DataAroundACircleHoldAngleAndError) {
  Plot p;
  p.ring = Ring{20.0, 0.0, 10.0, 1.0};
  p.series = {{.label = "(f)", .x = {32.0, 20.0}, .y = {0.0, -9.5}},
              {.x = {0.0}, .y = {0.0}, .scale = ScaleLine::kBar}};
  EXPECT_EQ(data_csv(p),
            "curve,x as drawn,y as drawn,low,high,angle [deg],error [µm]\n"
            "(f),32,0,,,0,2\n"
            "(f),20,-9.5,,,270,-0.5\n"
            "scale,0,0,,,,\n");
}

TEST(Output, TablesForOtherDocuments) {
  const Table t = small_table();
  EXPECT_EQ(markdown(t),
            "Errors & more\n\n| name | max [µm] |\n|---|---:|\n| a\\|b_1 | 1.00 ± 0.10 (print 2 %) |\n");
  EXPECT_EQ(csv(t), "name,max [µm]\na|b_1,1.00 ± 0.10 (print 2 %)\n");
  EXPECT_EQ(latex(t),
            "% Errors & more\n\\begin{tabular}{lr}\n\\hline\nname & max [\\textmu{}m] \\\\\n\\hline\n"
            "a\\textbar{}b\\_1 & 1.00 $\\pm$ 0.10 (print 2 \\%) \\\\\n\\hline\n\\end{tabular}\n");
  // A spreadsheet would take such a cell for a formula.
  EXPECT_THAT(csv({"", {{"a", "", false}}, {{{"=1+1"}}}}), HasSubstr("\"=1+1\""));
}

TEST(Output, PartsOfAPageAsFiles) {
  const stribeck::test::Folder folder;
  Page page("t");
  page.figure(plot_of_two(), "");
  page.figure(Plot{}, "");
  page.table(small_table());
  write_page(page, {folder / "page", folder / "plots"});
  EXPECT_THAT(stribeck::test::text_of(folder / "page/index.html"), StartsWith("<!DOCTYPE html>"));
  std::set<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(folder / "plots"))
    names.insert(file.path().filename().string());
  const std::set<std::string> expected{"figure-01-error-at-3-mm-s.csv",
                                       "figure-01-error-at-3-mm-s.pdf",
                                       "figure-01-error-at-3-mm-s.png",
                                       "figure-01-error-at-3-mm-s.svg",
                                       "figure-02.csv",
                                       "figure-02.pdf",
                                       "figure-02.png",
                                       "figure-02.svg",
                                       "table-01-errors-more.csv",
                                       "table-01-errors-more.md",
                                       "table-01-errors-more.tex"};
  EXPECT_EQ(names, expected);
  const std::string svg = stribeck::test::text_of(folder / "plots/figure-01-error-at-3-mm-s.svg");
  EXPECT_THAT(svg, HasSubstr("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox"));
  EXPECT_THAT(svg, Not(HasSubstr("data-plot")));
  EXPECT_THAT(svg, HasSubstr("stroke='#444444'"));
  const std::string png = stribeck::test::text_of(folder / "plots/figure-02.png");
  EXPECT_EQ(png.substr(1, 3), "PNG");
  const std::string pdf = stribeck::test::text_of(folder / "plots/figure-01-error-at-3-mm-s.pdf");
  EXPECT_THAT(pdf, StartsWith("%PDF-"));
  EXPECT_THAT(pdf, HasSubstr("/CreationDate (D:0000"));
}

TEST(Output, OnlyTheFoldersThatAreWanted) {
  const stribeck::test::Folder folder;
  Page page("t");
  page.paragraph("text");
  write_page(page, {"", folder / "plots"});
  EXPECT_TRUE(std::filesystem::is_empty(folder / "plots"));
  write_page(page, {""});
}

TEST(Output, APageSaysWhatMadeIt) {
  const Made made{"stribeck compare m.toml", "1.2.3", {{"m.toml", "abc123"}}};
  Page page("t");
  page.made(made);
  const std::string html = page.html();
  EXPECT_THAT(html, HasSubstr("<pre><code>stribeck compare m.toml</code></pre>"));
  EXPECT_THAT(html, HasSubstr("<li>m.toml: abc123</li>"));
  EXPECT_THAT(html, HasSubstr("stribeck 1.2.3"));
  EXPECT_EQ(
      to_json(made).dump(),
      R"({"command":"stribeck compare m.toml","version":"1.2.3","inputs":[{"file":"m.toml","sha256":"abc123"}]})");
  Page without("t");
  without.made({});
  EXPECT_THAT(without.html(), Not(HasSubstr("<h2")));
}

}  // namespace
}  // namespace stribeck::report::output_test
