#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <string>

namespace stribeck::io::broken_names_test {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Alt and Enter in a cell of Excel.
TEST(BrokenNames, ANameInTwoLinesIsOne) {
  for (const std::string end : {"\n", "\r\n"}) {
    const Log log = parse_log("\"t" + end + "[s]\";\"x" + end + "[mm]\";\"F" + end + "[N]\"" + end +
                                  "0,0;0,25;1,5" + end + "0,5;0,75;2,5" + end,
                              "log.csv");
    EXPECT_EQ(log.rows, 2U);
    EXPECT_EQ(log.at("x [mm]").unit_text, "mm");
    EXPECT_EQ(log.at("F").values.at(1), 2.5);
    const Log head = parse_log("Rig;7" + end + "\"t [s]\";\"Position" + end + "(ist) [mm]\";F [N]" + end +
                                   "0;1;2" + end + "1;2;3" + end + "2;3;4" + end,
                               "log.csv");
    EXPECT_EQ(head.at("Position (ist)").values.at(2), 3.0);
  }
  // The lines of the file keep their numbers.
  EXPECT_THAT([] { parse_log("\"t\n[s]\";\"x\n\n[mm]\"\n0;1\n1;x\n2;3\n", "log.csv"); },
              ThrowsMessage<InputError>(HasSubstr("log.csv:6: row 2")));
}

TEST(BrokenNames, OtherQuotesStay) {
  const Log inch = parse_log("t [s];x [mm];part\n0;1;5\" pipe\n1;2;6\" pipe\n", "log.csv");
  EXPECT_EQ(inch.rows, 2U);
  EXPECT_EQ(inch.at("part").texts.at(0), "5\" pipe");
  const Log doubled = parse_log("t [s];\"x \"\"ist\"\" [mm]\"\n0;1\n1;2\n", "log.csv");
  EXPECT_EQ(doubled.at("x \"ist\"").values.at(1), 2.0);
}

}  // namespace
}  // namespace stribeck::io::broken_names_test
