// evaluate with files of a ball-bar, through the command: text, JSON, page; what is refused in one line with exit code 2.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <tests/cli/command.hpp>

namespace stribeck::test::ball_bar_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// Both directions with a backlash of x of 4 um.
std::string bar_table(const std::string& head) {
  std::string text = head;
  for (int i = 0; i <= 2880; ++i) {
    const bool forward = i <= 1440;
    const double turn = 0.25 * (forward ? i : 2880 - i) * M_PI / 180.0;
    const double behind = std::sin(turn) * (forward ? 1.0 : -1.0) > 0.0 ? 2.0 : -2.0;
    text += std::to_string(turn * 180.0 / M_PI) + ";" + std::to_string(behind * std::cos(turn)) + "\n";
  }
  return text;
}

TEST(EvaluateBallBar, RadiusAndFeedOfTheFile) {
  const Folder f;
  const std::string head = "# radius: 150 mm\n# feed (mm/min): 1500\nangle [deg];deviation [um]\n";
  const std::string bar = f.write("bar.csv", bar_table(head));
  const Said said = command({"evaluate", bar, "--json", f / "e.json", "--report", f / "page"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, AllOf(HasSubstr("an error along the circle cannot be seen"), HasSubstr("no times"),
                              Not(HasSubstr("the feed is not known"))));
  const auto json = nlohmann::json::parse(text_of(f / "e.json"));
  EXPECT_DOUBLE_EQ(json["radius_mm"].get<double>(), 150.0);
  const auto& d = json["logs"][0]["diagnosis"];
  EXPECT_EQ(d["causes"][0]["cause"], "backlash");
  EXPECT_NEAR(d["causes"][0]["size_um"].get<double>(), 4.0, 0.01);
  EXPECT_NEAR(d["peaks"][0]["feed_mm_per_min"].get<double>(), 1500.0, 1e-9);
  EXPECT_THAT(text_of(f / "page/index.html"), HasSubstr("Circle of 150 mm"));
  // --size and --feed go before the file.
  const Said given =
      command({"evaluate", bar, "--size", "100 mm", "--feed", "3 m/min", "--json", f / "e.json"});
  ASSERT_EQ(given.code, 0) << given.err;
  EXPECT_THAT(given.out, HasSubstr("Note: bar: states a feed of 1500 mm/min; --feed gives 3000 mm/min."));
  EXPECT_DOUBLE_EQ(nlohmann::json::parse(text_of(f / "e.json"))["radius_mm"].get<double>(), 100.0);
}

TEST(EvaluateBallBar, BadFilesAreRefusedInOneLine) {
  const Folder f;
  const auto refused = [&](const std::string& text, const std::string& says,
                           const std::string& name = "bad.csv") {
    const Said said = command({"evaluate", f.write(name, text), "--size", "100 mm"});
    EXPECT_EQ(said.code, 2) << says;
    EXPECT_THAT(said.err, AllOf(StartsWith("stribeck: "), HasSubstr(says)));
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
  };
  const std::string head = "angle [deg];radius [mm]\n";
  refused("", "empty");
  refused(head, "no data rows");
  refused(head + "0;100\n0;nan\n", "got \"nan\", expected a number");
  refused(head + "0;100\n0;100\n0;100\n", "bad.csv");
  refused(head + "0;0\n1;0\n", "row 1: a radius of 0 mm");
  refused("W;L\n0;100\n1;100\n", "--map x=");
  const std::string b5r =
      "<A><PLANE TEST_PLANE=\"XY\"/><FEATURE NAME=\"AF_SQUARENESS\" DT=\"UT_SQUARENESS\">1</FEATURE></A>";
  refused(b5r, "export the samples as a table", "bar.b5r");
  refused(b5r.substr(0, 60), "is cut off or damaged", "cut.b5r");
  refused("<!DOCTYPE A [<!ENTITY a \"aaaa\">]>" + b5r, "has a document type", "entity.b5r");
  refused("<A><b/></A>", "is XML but", "other.b5r");
  const std::string series = f.write("series.csv", "direction,reading [um]\n+,1\n-,2\n");
  EXPECT_THAT(command({"evaluate", series, "--path", "indicator", "--feed", "1 m/min"}).err,
              HasSubstr("--feed: applies to circles only"));
}

}  // namespace
}  // namespace stribeck::test::ball_bar_test
