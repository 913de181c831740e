#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <set>
#include <stribeck/io/error.hpp>
#include <stribeck/report/plot/force_plot.hpp>
#include <stribeck/report/plot/plot.hpp>
#include <stribeck/report/plot/time_axis.hpp>
#include <stribeck/report/test_result.hpp>

namespace stribeck::report::plot_test {
namespace {

using test::kHostile;
using test::kNaN;
using ::testing::HasSubstr;
using ::testing::Not;

Plot line_plot() {
  Plot p;
  p.title = "error";
  p.x_label = "time [s]";
  p.y_label = "error [µm]";
  p.series = {{.label = "one", .x = {0, 1, 2}, .y = {0, 1, 0}}};
  return p;
}

std::vector<std::string> attributes(const std::string& svg, const std::string& name) {
  std::vector<std::string> all;
  for (const char quote : {'"', '\''}) {
    const std::string key = " " + name + "=" + quote;
    for (auto at = svg.find(key); at != std::string::npos; at = svg.find(key, at + 1)) {
      const auto begin = at + key.size();
      all.push_back(svg.substr(begin, svg.find(quote, begin) - begin));
    }
  }
  return all;
}

TEST(Plot, DrawsEveryStyleWithIdsOfItsOwn) {
  Plot p = line_plot();
  p.series.push_back({.label = "points", .x = {0.5}, .y = {0.5}, .style = Style::kPoints});
  p.series.push_back(
      {.label = "band", .x = {0, 2}, .y_low = {0, 0}, .y_high = {1, 1}, .style = Style::kBand});
  p.series.push_back({.label = "steps", .x = {0, 2}, .y = {0, 1}, .style = Style::kSteps, .dashed = true});
  p.series.push_back(
      {.x = {1}, .y = {0.5}, .y_low = {0.4}, .y_high = {0.6}, .style = Style::kBars, .width = 0.5});
  p.markers = {{1.0, "here"}};
  p.notes = {{1.0, 0.5, "note"}};
  Plot tics = line_plot();
  tics.x_tics = {{0.0, "100 %"}, {1.0, "b"}};
  tics.legend = Legend::kTopLeft;
  Plot logarithmic = line_plot();
  logarithmic.log_x = logarithmic.log_y = true;
  const auto all = render({p, tics, logarithmic});
  ASSERT_EQ(all.size(), 3u);
  std::set<std::string> ids;
  for (const std::string& svg : all) {
    EXPECT_TRUE(svg.starts_with("<svg "));
    EXPECT_TRUE(svg.ends_with("</svg>"));
    EXPECT_THAT(svg, HasSubstr("role=\"img\" aria-label=\"error\"><title>error</title>"));
    EXPECT_THAT(svg, HasSubstr("viewBox=\"0 0 920 320\""));
    EXPECT_THAT(svg, Not(HasSubstr("http")));
    EXPECT_THAT(svg, Not(HasSubstr("script")));
    for (const std::string& id : attributes(svg, "id")) EXPECT_TRUE(ids.insert(id).second) << id << " twice";
    for (const std::string& href : attributes(svg, "href")) EXPECT_TRUE(ids.contains(href.substr(1))) << href;
    for (const std::string& id : ids) EXPECT_TRUE(id.starts_with("plot-")) << id;
  }
  EXPECT_GE(ids.size(), 3u);
  EXPECT_THAT(all[1], HasSubstr("100 %"));
}

TEST(Plot, AScreenReaderIsAlwaysToldSomething) {
  Plot p = line_plot();
  EXPECT_EQ(described(p), "error");
  p.title = "";
  EXPECT_EQ(described(p), "error [µm] over time [s]: one");
  EXPECT_THAT(render({p})[0], HasSubstr("<title>error [µm] over time [s]: one</title>"));
  EXPECT_EQ(described(Plot{}), "Drawing");
  p.description = "One turn.";
  EXPECT_EQ(described(p), "One turn.");
}

TEST(Plot, SameBytesAgain) {
  EXPECT_EQ(render({line_plot(), line_plot()}), render({line_plot(), line_plot()}));
}

TEST(Plot, DrawsWhereItShould) {
  Plot p;
  p.title = "";
  p.axes = false;
  p.width = 208;
  p.height = 108;
  p.x_range = Range{0, 1};
  p.y_range = Range{0, 1};
  p.series = {{.x = {0, 0.5, 1}, .y = {0, 0.5, 1}}};
  // Margins of 4 px: from (4, 104) over the middle to (204, 4).
  EXPECT_THAT(render({p})[0], HasSubstr("'M4 104l100-50 100-50'"));
}

TEST(Plot, EqualAspectKeepsCirclesRound) {
  Plot p;
  p.axes = false;
  p.equal_aspect = true;
  p.width = 208;
  p.height = 108;
  p.series = {{.x = {-1, 1, 0}, .y = {0, 0, 1}}, {.x = {0, 0}, .y = {-1, 1}}};
  const std::string script = gnuplot_script({p});
  // y fills the height with its room of 6 %, and x gets twice as much for twice the pixels.
  EXPECT_THAT(script, HasSubstr("set yrange [-1.12:1.12]"));
  EXPECT_THAT(script, HasSubstr("set xrange [-2.24:2.24]"));
}

TEST(Plot, NothingToDrawIsNoError) {
  Plot p = line_plot();
  p.series = {{.label = "empty"},
              {.x = {kNaN}, .y = {1.0}},
              {.x = {1.0}, .y_low = {kNaN}, .y_high = {1}, .style = Style::kBand}};
  p.notes = {{kNaN, 1.0, "nowhere"}};
  p.markers = {{kNaN, "nowhere"}};
  p.x_tics = {{kNaN, "nowhere"}, {1.0, "here"}};
  p.y_range = Range{kNaN, 1.0};
  EXPECT_THAT(render({p}), ::testing::SizeIs(1));
  p.x_range = Range{2.0, 2.0};
  EXPECT_THAT(render({p}), ::testing::SizeIs(1));
  EXPECT_TRUE(render({}).empty());
}

/// Height of a marker's label, as a share of the drawing.
double label_height(const std::string& script, const std::string& label) {
  const std::string key = "set label '" + label + "' at first ";
  const auto at = script.find("screen ", script.find(key));
  return std::stod(script.substr(at + 7));
}

TEST(Plot, LabelsOfMarkersDoNotCoverEachOther) {
  Plot p = line_plot();
  p.markers = {{0.0, "x reverses"}, {0.02, "0.15 mm of x"}, {1.0, "far away"}};
  const std::string script = gnuplot_script({p});
  EXPECT_NEAR(label_height(script, "0.15 mm of x") - label_height(script, "x reverses"), 14.0 / p.height,
              1e-5);
  EXPECT_EQ(label_height(script, "far away"), label_height(script, "x reverses"));
}

TEST(Plot, UnitsOfLabelsAreWrittenAsPeopleDo) {
  Plot p = line_plot();
  p.x_label = "eta2 [N s2/mm]";
  p.y_label = "no unit, s2";
  const std::string script = gnuplot_script({p});
  EXPECT_THAT(script, HasSubstr("'eta2 [N s²/mm]'"));
  EXPECT_THAT(script, HasSubstr("'no unit, s2'"));
}

TEST(Plot, LessDetailMakesLessData) {
  Plot p = line_plot();
  p.series[0].x.clear();
  p.series[0].y.clear();
  for (int i = 0; i < 10000; ++i) {
    p.series[0].x.push_back(i);
    p.series[0].y.push_back(std::sin(i));
  }
  const std::size_t all = gnuplot_script({p}).size();
  p.detail = 0.5;
  EXPECT_NEAR(static_cast<double>(gnuplot_script({p}).size()) / static_cast<double>(all), 0.5, 0.05);
}

TEST(Plot, ValuesFarFromZeroStayApart) {
  Plot p = line_plot();
  p.series[0].x = {50000.125, 50000.25, 50000.375};
  EXPECT_THAT(gnuplot_script({p}), HasSubstr("\n50000.125 0 \n50000.25 1 \n50000.375 0 \n"));
}

TEST(Plot, StampsOfAClockAreCountedFromTheFirstRow) {
  const ForceOverTime force{"log.csv", {1764414000.0, 1764414000.5, 1764414001.0}, {1, 2, 3}, {1, 2, 2}};
  const Plot p = force_plot(force, "", "N", "#0072b2");
  EXPECT_EQ(p.x_label, "time since the first row, 1764414000 s [s]");
  for (const Series& s : p.series) EXPECT_THAT(s.x, testing::ElementsAre(0.0, 0.5, 1.0)) << s.label;
  // A log that is part of a longer one keeps its times.
  EXPECT_EQ(time_axis({40.0, 41.0}).label, "time [s]");
  EXPECT_EQ(time_axis({40.0, kNaN, 41.0}).origin, 0.0);
  EXPECT_EQ(time_axis({}).origin, 0.0);
}

TEST(Plot, GapsStayGaps) {
  Plot p = line_plot();
  p.series[0].x = {0, 1, kNaN, 2, 3};
  p.series[0].y = {0, 1, 0, kNaN, 3};
  EXPECT_THAT(gnuplot_script({p}), HasSubstr("\n0 0 \n1 1 \n\n3 3 \nEOD\n"));
}

TEST(Plot, HostileTextIsOnlyText) {
  Plot p = line_plot();
  p.title = p.x_label = p.y_label = p.description = kHostile;
  p.series[0].label = p.markers.emplace_back(Marker{1.0, kHostile}).label;
  p.notes = {{1.0, 0.5, kHostile, "red'; system 'touch stribeck_pwned'"}};
  p.series[0].color = "#12345'; system 'touch stribeck_pwned'";
  p.x_tics = {{1.0, kHostile}};
  for (const Legend legend : {Legend::kAbove, Legend::kTopRight}) {
    p.legend = legend;
    const std::string svg = render({p})[0];
    EXPECT_THAT(svg,
                HasSubstr("`touch stribeck_pwned` $(touch stribeck_pwned) @pwd {/Bold b}_c 50% %s 'q' \\n"));
    EXPECT_THAT(svg, Not(HasSubstr("<script")));
    EXPECT_EQ(svg.find("</svg>"), svg.size() - 6);
    // What looks like an attribute in a text stays as it was written.
    EXPECT_THAT(svg, HasSubstr("id='gnuplot_canvas' &lt;/svg"));
  }
  EXPECT_FALSE(std::filesystem::exists("stribeck_pwned"));
}

TEST(Plot, MissingGnuplotSaysWhatToInstall) {
  const char* path = std::getenv("PATH");
  const std::string before = path != nullptr ? path : "";
  ::setenv("PATH", "/nonexistent", 1);
  try {
    render({line_plot()});
    ADD_FAILURE() << "no error";
  } catch (const io::InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("gnuplot-nox"));
    EXPECT_THAT(e.what(), Not(HasSubstr("\n")));
  }
  ::setenv("PATH", before.c_str(), 1);
}

TEST(Thin, PeaksSurvive) {
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i < 100000; ++i) {
    x.push_back(i);
    y.push_back(std::sin(i * 0.001));
  }
  y[12345] = 50.0;
  y[12347] = -40.0;
  y[99000] = 30.0;
  thin(x, y, 500);
  EXPECT_LE(x.size(), 1010u);
  EXPECT_GE(x.size(), 900u);
  EXPECT_TRUE(std::is_sorted(x.begin(), x.end()));
  EXPECT_EQ(x.front(), 0.0);
  EXPECT_EQ(x.back(), 99999.0);
  for (const double peak : {50.0, -40.0, 30.0}) EXPECT_EQ(std::count(y.begin(), y.end(), peak), 1) << peak;
  const auto at = std::find(y.begin(), y.end(), 50.0) - y.begin();
  EXPECT_EQ(x[static_cast<std::size_t>(at)], 12345.0);
}

TEST(Thin, KeepsGapsAndWhatItCannotThin) {
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i < 1000; ++i) {
    x.push_back(i);
    y.push_back(i == 500 ? kNaN : 1.0);
  }
  thin(x, y, 10);
  EXPECT_EQ(std::count_if(y.begin(), y.end(), [](double v) { return std::isnan(v); }), 1);
  std::vector<double> circle{1, 0, -1, 0, 1};
  std::vector<double> other{0, 1, 0, -1, 0};
  thin(circle, other, 1);
  EXPECT_EQ(circle.size(), 5u);
}

TEST(Colors, AreFixedAndDifferent) {
  std::set<std::string> all;
  for (const char* id : {"a", "b", "c", "d", "e", "f"}) all.insert(controller_color(id));
  EXPECT_EQ(all.size(), 6u);
  EXPECT_EQ(controller_color("f", 0), controller_color("f", 3));
  EXPECT_EQ(controller_color("mine", 1), controller_color("other", 17));
  for (std::size_t k = 0; k < 16; ++k) all.insert(controller_color("mine", k));
  EXPECT_EQ(all.size(), 16u);
}

TEST(Plot, TellsAScriptWhereItsValuesStand) {
  Plot p = line_plot();
  p.title = "it's <b>";
  p.series.push_back({.label = "two", .x = {0, 2}, .y = {0, 0.5}, .color = "#0072b2"});
  p.series.push_back({.label = "not drawn", .x = {kNaN}, .y = {kNaN}});
  p.ring = Ring{1.0, 0.5, 0.25, 8.0};
  const std::string svg = render({p})[0];
  const auto facts = attributes(svg, "data-plot");
  ASSERT_EQ(facts.size(), 1u);
  EXPECT_THAT(facts[0], HasSubstr("it&#39;s &lt;b&gt;"));
  EXPECT_THAT(facts[0], HasSubstr("\"x\":[0.0,2.0,0]"));
  EXPECT_THAT(facts[0], HasSubstr("\"n\":\"two\",\"c\":\"#0072b2\",\"g\":[2]"));
  EXPECT_THAT(facts[0], Not(HasSubstr("not drawn")));
  EXPECT_THAT(svg, HasSubstr("gnuplot_plot_2\""));
  // 920 px less margins of 66 and 20 are 834 px for two units of x.
  EXPECT_THAT(facts[0], HasSubstr("\"ring\":[483.0,"));
  EXPECT_THAT(facts[0], HasSubstr(",104.3,0.01918465]"));
}

TEST(Plot, CurvesDifferInDashAndColour) {
  Plot p = line_plot();
  for (const char* label : {"two", "three"}) p.series.push_back({.label = label, .x = {0, 2}, .y = {0, 1}});
  const std::string script = gnuplot_script({p});
  EXPECT_THAT(script, HasSubstr("lw 1.6 dt 1 "));
  EXPECT_THAT(script, HasSubstr("lw 1.6 dt (14,3) "));
  EXPECT_THAT(script, HasSubstr("lw 1.6 dt (9,3,2,3) "));
}

}  // namespace
}  // namespace stribeck::report::plot_test
