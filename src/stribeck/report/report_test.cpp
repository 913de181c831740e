#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <sstream>
#include <stribeck/io/file.hpp>
#include <stribeck/report/pages/compare_report.hpp>
#include <stribeck/report/pages/identify_report.hpp>
#include <stribeck/report/pages/reproduction.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/test_result.hpp>

namespace stribeck::report::report_test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

CompareReportInput input() {
  CompareReportInput in;
  in.result = test::two_controllers();
  in.experiment = "bi-table";
  in.printed = kBiaxialTables;
  in.command = "stribeck compare table.toml --seed 7";
  in.axes.resize(2);
  in.axes[0].models = {{"gaussian", test::fit()}};
  return in;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(CompareReport, SaysWhoWonAndByHowMuch) {
  const std::string page = compare_report(input());
  EXPECT_THAT(page,
              HasSubstr("At 9.5 mm/s (b) conventional friction model leaves the smallest RMS contour error, "
                        "1.00\u00A0µm: 75\u00A0% less than (a) no friction compensation (4.00\u00A0µm)."));
  EXPECT_THAT(page, HasSubstr("Its largest error is 2.00\u00A0µm, 75\u00A0% less than (a)"));
  EXPECT_THAT(page, HasSubstr("1.00\u00A0µm within the first 0.15\u00A0mm after an axis reverses; the "
                              "largest error lies elsewhere"));
  EXPECT_THAT(page,
              HasSubstr("<b>2.00</b> <small>± 0.25</small><span class=\"note\">thesis 5.38 · ×0.37</span>"));
  EXPECT_THAT(
      page,
      HasSubstr(
          "no controller is within 10 % of the printed value; the largest difference has (b), 0.37 times the printed value."));
  EXPECT_THAT(page, HasSubstr("error magnified 500 times"));
  EXPECT_THAT(page, HasSubstr("stribeck compare table.toml --seed 7"));
  EXPECT_THAT(page, HasSubstr("axis x, gaussian model: speeds above 9 mm/s were seen once"));
  // Bars 2, contours 2, angle 1, time 1, close up 2, map of x 2, forces 2.
  EXPECT_EQ(count(page, "<svg "), 12u);
}

TEST(CompareReport, ChanceIsNoVictory) {
  CompareReportInput in = input();
  in.result.rows[0].mean.rms = in.result.rows[1].mean.rms + 0.1e-6;  // two standard errors are 0.18 µm
  EXPECT_THAT(compare_report(in), HasSubstr("; the difference to (a) is within the scatter"));
  in.result.rows[0].mean.rms = in.result.rows[1].mean.rms + 0.2e-6;
  EXPECT_THAT(compare_report(in), Not(HasSubstr("within the scatter")));
}

// (b) has a twentieth of the error of (a): bars, contour, traces and close-up get a scale of its own.
TEST(CompareReport, SmallErrorsGetAScaleOfTheirOwn) {
  CompareReportInput in = input();
  for (auto& s : in.result.rows[1].trace) s.contour_error *= 0.2;
  const std::string page = compare_report(in);
  EXPECT_THAT(page, HasSubstr("error × 500<"));
  EXPECT_THAT(page, HasSubstr("error × 10000<"));
  EXPECT_THAT(page, HasSubstr("(b): the path (grey)"));
  EXPECT_THAT(page, HasSubstr("its error magnified 10000 times. Dashed: 0.1 µm to both sides"));
  EXPECT_THAT(page, HasSubstr("Maximum at 9.5 mm/s, finer scale"));
  EXPECT_THAT(page, HasSubstr("Where x reverses, at 9.5 mm/s: (b), scale 20 times finer"));
  EXPECT_THAT(page,
              HasSubstr("Scales differ: ±8.6\u00A0µm for (a); ±0.43\u00A0µm for (b) (20 times finer)."));
  // Bars 4, contours 2, angle 2, time 2, close up 4, map of x 2, forces 2.
  EXPECT_EQ(count(page, "<svg "), 18u);
}

TEST(CompareReport, SaysWhatDefinesAController) {
  CompareReportInput in = input();
  in.result.spec.controllers[1].law = control::PredictiveParams{};
  const std::string page = test::without_script(compare_report(in));
  EXPECT_THAT(page, HasSubstr("<td>conventional</td><td>steady</td>"));
  EXPECT_THAT(page, HasSubstr("model predictive contouring: omega 40 rad/s, horizon 80 ms"));
  EXPECT_THAT(page, Not(HasSubstr("()")));
}

TEST(CompareReport, SharedWarningsAreSaidOnce) {
  CompareReportInput in = input();
  in.axes[1].models = {{"gaussian", test::fit()}};
  const std::string page = compare_report(in);
  EXPECT_THAT(page,
              HasSubstr("<li>speeds above 9 mm/s were seen once (axis x, gaussian model; axis y, gaussian "
                        "model)</li>"));
  // The caller of a comparison has them already.
  in.warnings = {"speeds above 9 mm/s were seen once (axis x, gaussian model; axis y, gaussian model)"};
  EXPECT_EQ(count(compare_report(in), "<li>speeds above 9 mm/s were seen once ("), 1u);
}

/// Width and height of what the first path of a colour covers [px].
std::array<double, 2> extent(const std::string& svg, const std::string& color) {
  const auto at = svg.find(" d='", svg.find("stroke='" + color + "'")) + 4;
  std::string spaced;
  for (const char c : svg.substr(at, svg.find('\'', at) - at)) {
    if (c == 'M' || c == 'l' || c == '-') spaced += ' ';
    spaced += c;
  }
  std::istringstream path(spaced);
  std::array<double, 2> low{1e9, 1e9};
  std::array<double, 2> high{-1e9, -1e9};
  std::array<double, 2> here{};
  std::string token;
  for (std::size_t k = 0; path >> token;) {
    if (token[0] == 'M') here = {0.0, 0.0};
    if (token[0] == 'M' || token[0] == 'l') token.erase(0, 1);
    if (token.empty()) continue;
    here[k] += std::stod(token);
    low[k] = std::min(low[k], here[k]);
    high[k] = std::max(high[k], here[k]);
    k = 1 - k;
  }
  return {high[0] - low[0], high[1] - low[1]};
}

// Positive errors lie to the left of the direction of travel, which on this circle is inside: 8 µm magnified
// 500 times make a circle of 10 mm one of 6 mm. Coordinates are rounded to 0.1 px.
TEST(CompareReport, ContourIsDrawnOnTheRightSide) {
  CompareReportInput in = input();
  in.axes.clear();
  in.result.rows.resize(1);
  for (auto& s : in.result.rows[0].trace) s.contour_error = 8e-6;
  const std::string page = compare_report(in);
  const auto at = page.find("<svg", page.find("Contour, error magnified</h2>"));
  const std::string svg = page.substr(at, page.find("</svg>", at) - at);
  const auto path = extent(svg, "#9aa0a6");
  const auto way = extent(svg, "#7a7a7a");
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(way[k], 0.6 * path[k], 0.3) << path[k];
  EXPECT_GT(path[0], 100.0);
}

/// The circle of two_controllers() as a machine of one's own gets it: about the middle of the travel.
path::Fourier<2> own_circle(double radius) {
  path::Fourier<2> p;
  p.axis[0] = {0.1, {path::Harmonic{radius, 1.0, 0.0}}};
  p.axis[1] = {-0.05, {path::Harmonic{radius, 1.0, -0.5 * kPi}}};
  return p;
}

TEST(CompareReport, TheCircleOfAMachineOfOnesOwnIsDrawnToo) {
  CompareReportInput in = input();
  in.axes.clear();
  in.result.rows.resize(1);
  for (auto& s : in.result.rows[0].trace) s.contour_error = 8e-6;
  in.result.spec.travels[0].path = own_circle(0.01);
  const std::string page = compare_report(in);
  ASSERT_THAT(page, HasSubstr("Contour, error magnified</h2>"));
  const auto at = page.find("<svg", page.find("Contour, error magnified</h2>"));
  const std::string svg = page.substr(at, page.find("</svg>", at) - at);
  const auto path = extent(svg, "#9aa0a6");
  const auto way = extent(svg, "#7a7a7a");
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(way[k], 0.6 * path[k], 0.3) << path[k];
  EXPECT_NEAR(path[0], path[1], 0.5);
  EXPECT_THAT(svg, HasSubstr("max 8.00"));
  EXPECT_THAT(page, HasSubstr("angle φ of the reference"));
  // A sum of harmonics that is no circle is called by its parameter.
  auto eight = own_circle(0.01);
  eight.axis[1].terms[0].order = 2.0;
  in.result.spec.travels[0].path = eight;
  EXPECT_THAT(compare_report(in), HasSubstr("parameter φ of the path"));
}

// Behind 2 mm of path an axis of a circle of 30 mm has travelled 0.07 mm.
TEST(CompareReport, TheEndOfTheGlitchWindowIsInsideTheCloseUp) {
  CompareReportInput in = input();
  in.axes.clear();
  const auto marks = [&] {
    const std::string page = compare_report(in);
    return count(page.substr(page.find("One quadrant, close up</h2>")), ">0.15 mm of ");
  };
  const std::size_t small = marks();
  EXPECT_EQ(small, 2u);
  for (auto& row : in.result.rows)
    for (auto& s : row.trace) s.reference = 3.0 * s.reference;
  in.result.spec.travels[0].path = own_circle(0.03);
  in.result.spec.travels[0].speed *= 3.0;
  EXPECT_EQ(marks(), small);
}

TEST(CompareReport, TruthOnlyWhereItIsGiven) {
  CompareReportInput in = input();
  EXPECT_THAT(compare_report(in), Not(HasSubstr("true friction")));
  friction::Model truth;
  truth.steady = friction::Conventional<double>{800.0, 1e5, {}};
  in.axes[1].truth = truth;
  const std::string page = compare_report(in);
  EXPECT_THAT(page, HasSubstr("true friction of the virtual machine, which no controller may use"));
  // In the map of y and in the forces of y.
  EXPECT_EQ(count(page, ">true friction</text>"), 2u);
}

TEST(CompareReport, AnAxisThatTurnsHasTorques) {
  CompareReportInput in = input();
  EXPECT_EQ(count(compare_report(in), "force [N]</text>"), 2u);
  in.axes[0].rotary = true;
  in.axes[0].models[0].second.rotary = true;
  const std::string page = compare_report(in);
  EXPECT_EQ(count(page, "force [N]</text>"), 1u);  // of y
  EXPECT_EQ(count(page, "torque [N m]</text>"), 1u);
  EXPECT_THAT(page, HasSubstr("20.5 N m RMS on motion that was not fitted"));
  // Without a fit the axis file is drawn in the same units.
  in.axes[0].models.clear();
  friction::Model truth;
  truth.steady = friction::Conventional<double>{800.0, 1e5, {}};
  in.axes[0].truth = truth;
  EXPECT_THAT(compare_report(in), HasSubstr("friction [N m]</text>"));
}

TEST(CompareReport, WarnsOfWhatHappened) {
  CompareReportInput in = input();
  in.result.rows[0].status.counts[static_cast<std::size_t>(Status::kOutputLimited)] = 3;
  in.warnings = {"from the caller"};
  const std::string page = compare_report(in);
  EXPECT_THAT(page,
              HasSubstr("(a) at 9.5 mm/s: the output reached the limit of the drive (3 times in 4 trials)"));
  EXPECT_THAT(page, HasSubstr("from the caller"));
}

TEST(CompareReport, StandsAloneWhateverItIsCalled) {
  CompareReportInput in = input();
  in.result.machine = in.result.axes[0] = in.command = in.origin = in.parameters = in.experiment =
      test::kHostile;
  in.result.rows[0].controller.label = in.result.rows[1].controller.id = test::kHostile;
  in.axes[0].models[0].second.warnings = {test::kHostile};
  in.axes[0].models[0].second.parameters[0].name = test::kHostile;
  const std::string page = test::without_script(compare_report(in));
  for (const char* foreign : {"http:", "https:", "<script", "<link", " src=", "url("})
    EXPECT_THAT(page, Not(HasSubstr(foreign)));
  std::set<std::string> ids;
  for (auto at = page.find(" id=\"plot-"); at != std::string::npos; at = page.find(" id=\"plot-", at + 1)) {
    const std::string id = page.substr(at + 5, page.find('"', at + 5) - at - 5);
    EXPECT_TRUE(ids.insert(id).second) << id;
  }
  EXPECT_GT(ids.size(), 10u);
  EXPECT_FALSE(std::filesystem::exists("stribeck_pwned"));
}

TEST(CompareReport, SurvivesAnEmptyResult) {
  CompareReportInput in;
  EXPECT_THAT(compare_report(in), HasSubstr("</html>"));
  in.result = test::two_controllers();
  for (auto& row : in.result.rows) {
    row.trace.clear();
    row.mean = row.spread = test::nothing();
  }
  EXPECT_THAT(compare_report(in), HasSubstr("no controller gave a finite result"));
}

TEST(CompareReport, IsWrittenAsOneFile) {
  const auto directory =
      std::filesystem::temp_directory_path() / ("stribeck_report_" + std::to_string(::getpid()));
  write_compare_report((directory / "deep").string(), input());
  EXPECT_EQ(io::read_text((directory / "deep" / "index.html").string()), compare_report(input()));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory / "deep"), {}), 1);
  std::filesystem::remove_all(directory);
}

TEST(IdentifyReport, SaysWhatTheDataCannotTell) {
  const std::string page = test::without_script(
      identify_report({"x", {test::fit()}, test::kHostile, "stribeck identify", "0.1.0"}));
  EXPECT_THAT(page, HasSubstr("Mass 57.650 N s²/mm (95 %: 57.600 … 57.700)"));
  EXPECT_THAT(page, HasSubstr("1 of 3 parameters are not determined by the data"));
  // Beside the name, which stays in view where the table is wider than the screen.
  EXPECT_THAT(page,
              ContainsRegex(
                  "<tr><td>[a-z_0-9]+<span class=\"note\">not determined by the data: do not use it alone"));
  EXPECT_THAT(page, HasSubstr("speeds above 9 mm/s were seen once"));
  EXPECT_THAT(page, HasSubstr("<b>Gaussian, 1 term, v &gt; 0</b>"));
  EXPECT_EQ(count(page, "<svg "), 2u);
  EXPECT_THAT(page, Not(HasSubstr("<script")));
}

TEST(IdentifyReport, ShowsWhatIsLeftFromEverySide) {
  const std::string page =
      identify_report({"x", {test::whole_fit()}, "log.csv", "stribeck identify", "0.1.0"});
  // Map 2, residual 3, spectrum 1.
  EXPECT_EQ(count(page, "<svg "), 6u);
  EXPECT_THAT(page, HasSubstr("A force of 1.50 N repeats every 2.500 mm and reverses with the direction"));
  EXPECT_THAT(page, HasSubstr("breaks away after about 12 µm"));
  EXPECT_THAT(page, HasSubstr("What this log does not determine</b><ul>\n<li>the stiffness of pre-sliding"));
  EXPECT_THAT(page, HasSubstr("measured, less periodic terms"));
  EXPECT_THAT(page, HasSubstr("Residual against position"));
  EXPECT_THAT(page, HasSubstr("2.50 mm</text>"));
}

TEST(IdentifyReport, KeepsTheUnitsOfTheLog) {
  const std::string page =
      test::without_script(identify_report({"x", {test::own_units(true)}, "log.csv", "", ""}));
  EXPECT_THAT(page, HasSubstr("Inertia 57650 A s²/rad"));
  EXPECT_THAT(page, HasSubstr("velocity [rad/s]"));
  EXPECT_THAT(page, HasSubstr("residual [A]"));
  EXPECT_THAT(page, HasSubstr("period [rad]"));
  EXPECT_THAT(page, HasSubstr("The log gives no scale: forces are in A, positions in rad."));
  for (const char* foreign : {"[N]", "mm/s", " N RMS", "µm", ">N<"})
    EXPECT_THAT(page, Not(HasSubstr(foreign)));
}

TEST(IdentifyReport, SurvivesAnEmptyResult) {
  ident::Result r;
  r.residuals.resize(3);
  r.spectrum.resize(3);
  EXPECT_THAT(identify_report({"", {r}, "", "", ""}), HasSubstr("</html>"));
}

TEST(CompareReport, DrawsWithoutTheRowsThatCouldNotBeSimulated) {
  CompareReportInput input;
  input.result = test::two_controllers();
  sim::CompareRow& row = input.result.rows[0];
  row.mean = row.spread = test::nothing();
  row.trace.clear();
  row.substeps = 0;
  row.refused = "too stiff";
  const std::string page = compare_report(input);
  EXPECT_THAT(page, HasSubstr("(a) at 9.5 mm/s: not simulated: too stiff"));
  EXPECT_THAT(page, HasSubstr("Contour of (b) conventional friction model"));
  EXPECT_THAT(page, Not(HasSubstr("Contour of (a)")));
}

TEST(Parameters, DecimalsFollowTheInterval) {
  EXPECT_EQ(shown_number(57.6612, 57.18, 58.14), "57.66");
  EXPECT_EQ(shown_number(-9662.3, -18852.0, -471.0), "-9700");
  EXPECT_EQ(shown_number(294517.0, 276144.0, 302133.0), "295000");
  EXPECT_EQ(shown_number(0.14349, 0.1431, 0.1439), "0.14349");
  EXPECT_EQ(shown_number(12.3456, test::kNaN, test::kNaN), "12.35");
  // Over decades: no number that is known to be above zero is shown as zero.
  EXPECT_EQ(shown_number(5.488, 0.774, 33500.0), "5.5");
  EXPECT_EQ(shown_number(0.774, 0.774, 33500.0), "0.77");
  EXPECT_EQ(shown_number(33500.0, 0.774, 33500.0), "34000");
  EXPECT_EQ(shown_number(0.004, -3.0, 5.0), "0.0");
}

// The thesis prints no quadrant ratio: it stands in the tables of what goes beyond it, and only where there is one.
TEST(Reproduction, QuadrantRatioBeyondTheThesis) {
  sim::CompareResult result = test::two_controllers();
  const auto columns = [&](const std::string& id) {
    sim::Experiment experiment;
    experiment.id = id;
    std::vector<std::string> heads;
    const ReproducedSection s = reproduced(experiment, {}, result, "");
    for (const Column& c : s.table.columns) heads.push_back(c.head);
    for (const auto& row : s.table.rows) EXPECT_EQ(row.size(), heads.size());
    return heads;
  };
  using ::testing::Contains;
  EXPECT_THAT(columns("beyond-x"), Not(Contains("quadrant ratio")));
  result.rows[1].mean.quadrant_ratio = 12.0;
  EXPECT_THAT(columns("beyond-x"), Contains("quadrant ratio"));
  EXPECT_THAT(columns("x"), Not(Contains("quadrant ratio")));
  sim::Experiment beyond;
  beyond.id = "beyond-x";
  const ReproducedSection s = reproduced(beyond, {}, result, "");
  EXPECT_EQ(s.table.rows[0][3].text, "–");
  EXPECT_EQ(s.table.rows[1][3].text, "12.00");
}

}  // namespace
}  // namespace stribeck::report::report_test
