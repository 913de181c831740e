#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/log/log.hpp>
#include <string>

namespace stribeck::io::lines_above_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

std::string lines(const std::string& format, int count) {
  std::string text;
  for (int k = 0; k < count; ++k) text += fmt::format(fmt::runtime(format), k);
  return text;
}

// A drive writes its parameters above the trace; with 20 of them they were taken for the table.
TEST(LinesAbove, ManyLinesOfAKeyAndANumberAreNoTable) {
  const std::string table = "t [s];x [mm];F [N]\n" + lines("{};1;2\n", 30);
  for (const char* title : {"", "Drive trace;AX5000\n", "Drive trace\n"}) {
    for (const int count : {5, 19, 20, 25, 60, 150}) {
      const Log log = parse_log(title + lines("P{:04};1.5\n", count) + table, "log.csv");
      EXPECT_EQ(log.rows, 30U) << title << count;
      EXPECT_EQ(log.at("F").values.at(29), 2.0) << title << count;
      EXPECT_THAT(log.metadata, Contains(testing::Pair("P0003", "1.5"))) << title << count;
    }
  }
  const Log units = parse_log(
      "Trace;1\n" + lines("P{};1.5\n", 25) + "\nt;x;F\ns;mm;N\n" + lines("{};1;2\n", 30), "log.csv");
  EXPECT_EQ(units.at("F").unit_text, "N");
}

TEST(LinesAbove, ARowOfSeparatorsDoesNotHideTheHead) {
  for (const char* blank : {";;\n", ";;;\n", "\"\";\"\";\"\"\n"}) {
    const Log log = parse_log(
        std::string("Rig 7\nDate;2026\nt [s];x [mm];F [N]\n0;1;2\n1;2;3\n") + blank + "2;3;4\n3;4;5\n",
        "log.csv");
    EXPECT_EQ(log.at("F").values.back(), 5.0) << blank;
  }
}

// The head of a second segment within the first 200 lines was taken for that of the file, and the first segment was lost.
TEST(LinesAbove, ASecondSegmentOfLabViewIsNamed) {
  const std::string part =
      "Channels\t2\t\t\nSamples\t3\t3\t\n***End_of_Header***\t\t\t\nX_Value\tx [mm]\tF [N]\tComment\n";
  const std::string file = "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\t\n";
  const std::string rows = lines("{}.5\t1.5\t2.5\t\n", 3);
  EXPECT_EQ(parse_log(file + part + rows, "log.lvm", {.times_needed = false}).rows, 3U);
  try {
    parse_log(file + part + rows + "\t\t\t\n" + part + rows, "log.lvm", {.times_needed = false});
    ADD_FAILURE() << "accepted";
  } catch (const std::exception& e) {
    EXPECT_THAT(e.what(), HasSubstr("a segment of LabVIEW begins here"));
  }
}

TEST(LinesAbove, ATableOfATextAndANumberStaysOne) {
  const Log runs = parse_log("run;x [mm]\n" + lines("r{};1.5\n", 30), "log.csv", {.times_needed = false});
  EXPECT_EQ(runs.rows, 30U);
  const Log clock = parse_log("Title\n\nTime;x [mm]\n" + lines("07:15:{:02};1.5\n", 30), "log.csv");
  EXPECT_EQ(clock.rows, 30U);
  // Rows of numbers are not left out in favour of a later table.
  try {
    parse_log("t [s];x [mm]\n" + lines("{};1\n", 25) + "t [s];x [mm];F [N]\n" + lines("{};1;2\n", 25),
              "log.csv");
    ADD_FAILURE() << "accepted";
  } catch (const std::exception& e) {
    EXPECT_THAT(e.what(), HasSubstr("row 26: got 3 cells, expected 2"));
  }
}

}  // namespace
}  // namespace stribeck::io::lines_above_test
