#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <string>

namespace stribeck::io::decimal_mark_test {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Log parse(const std::string& text) { return parse_log(text, "log.csv"); }

TEST(DecimalMark, ACommaInAWordIsNone) {
  const Log log = parse("t [s];x [mm];state\n0.0;0.25;moving, fast\n0.5;0.75;\"on, slow\"\n");
  EXPECT_EQ(log.at("x").values.at(1), 0.75);
  EXPECT_EQ(log.at("state").texts.at(0), "moving, fast");
  const Log german = parse("t [s];x [mm];Zustand\n0,0;0,25;fährt, schnell\n0,5;0,75;\n");
  EXPECT_EQ(german.at("x").values.at(1), 0.75);
}

// An axis at rest for the first hundred rows, beside dates with points.
TEST(DecimalMark, IsFoundBelowManyWholeNumbers) {
  std::string text = "Datum;t [ms];x [mm];F [N]\n";
  for (int k = 0; k < 150; ++k) text += fmt::format("29.11.2026;{};0;0\n", k);
  for (int k = 150; k < 300; ++k) text += fmt::format("29.11.2026;{};12,25;-163,5\n", k);
  const Log log = parse(text);
  EXPECT_EQ(log.at("x").values.at(299), 12.25);
  EXPECT_EQ(log.at("F").values.at(299), -163.5);
}

TEST(DecimalMark, QuotedCommasBetweenCommasAreNamed) {
  EXPECT_THAT([] { parse("\"t [s]\",\"x [mm]\"\n\"0,0000\",\"0,1\"\n\"0,0010\",\"44,4199\"\n"); },
              ThrowsMessage<InputError>(HasSubstr("has decimal commas in quotes")));
  EXPECT_THAT([] { parse("\"t [s]\";\"x [mm]\"\n0.5 a;\"0,1\"\n0.7 a;\"44,4199\"\n"); },
              ThrowsMessage<InputError>(testing::Not(HasSubstr("has decimal commas in quotes"))));
}

}  // namespace
}  // namespace stribeck::io::decimal_mark_test
