#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.hpp"

namespace stribeck::test::point_path_test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kTriangle = "x [mm],y [mm]\n0,0\n6,0\n3,4\n0,0\n";

TEST(PointPathCommand, SimulatesBothForms) {
  const Folder f;
  const std::string points = f.write("triangle.csv", kTriangle);
  for (const std::vector<std::string>& join : {std::vector<std::string>{}, {"--join", "spline"}}) {
    std::vector<std::string> words{"simulate", kMachine,        "--path", points,         "--speed",
                                   "5 mm/s",   "--controller",  "f",      "--parameters", "thesis",
                                   "-o",       f / "trace.csv", "--json", f / "out.json"};
    words.insert(words.end(), join.begin(), join.end());
    const Said said = command(words);
    ASSERT_EQ(said.code, 0) << said.err;
    EXPECT_THAT(said.out, HasSubstr("Part triangle.csv at 5 mm/s"));
    EXPECT_THAT(text_of(f / "trace.csv"), HasSubstr("contour_error"));
  }
}

TEST(PointPathCommand, ComparesAtEverySpeed) {
  const Folder f;
  const Said said = command({"compare", kMachine, "--path", f.write("triangle.csv", kTriangle), "--speed",
                             "2 mm/s", "--speed", "5 mm/s", "--parameters", "thesis", "--trials", "1"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("triangle.csv at 2 mm/s"));
  EXPECT_THAT(said.out, HasSubstr("triangle.csv at 5 mm/s"));
}

TEST(PointPathCommand, RefusesInOneLine) {
  const Folder f;
  const auto refused = [&](std::vector<std::string> words, const char* part) {
    words.insert(words.begin(), {"simulate", kMachine, "--parameters", "thesis", "-o", f / "trace.csv"});
    const Said said = command(words);
    EXPECT_EQ(said.code, 2) << part;
    EXPECT_THAT(said.err, HasSubstr(part));
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
  };
  refused({"--path", "circle", "--join", "spline"}, "--join: applies to a CSV file of points as --path only");
  refused({"--path", f / "none.csv"}, "none.csv");
  refused({"--path", f.write("z.csv", "x [mm],z [mm]\n0,0\n1,1\n")}, "of the axes of the machine");
}

}  // namespace
}  // namespace stribeck::test::point_path_test
