#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <string>

namespace stribeck::io::json_table_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

Log parse(const std::string& text) { return parse_log(text, "log.json"); }

std::string refusal(const std::string& text) {
  try {
    parse(text);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(JsonTable, OneObjectInEachLine) {
  const Log log = parse(
      "{\"ts\": 1795688123.124, \"axis\": \"x\", \"pos_mm\": -0.25, \"torque_nm\": 2, \"on\": true}\n\n"
      "{\"ts\": 1795688123.126, \"axis\": \"x\", \"pos_mm\": 1e-3, \"torque_nm\": 3, \"on\": false}\n");
  EXPECT_EQ(log.format, "JSON");
  EXPECT_EQ(log.rows, 2U);
  EXPECT_EQ(log.at("pos").unit_text, "mm");
  EXPECT_THAT(log.at("pos").values, ElementsAre(-0.25, 1e-3));
  EXPECT_THAT(log.at("on").values, ElementsAre(1.0, 0.0));
  EXPECT_EQ(log.at("torque").unit_text, "N m");
  EXPECT_THAT(log.at("axis").texts, ElementsAre("x", "x"));
}

TEST(JsonTable, AListOfObjects) {
  const Log log = parse(R"([{"t_s": 0, "x_mm": 1}, {"t_s": 0.5, "x_mm": 2}])");
  EXPECT_THAT(log.at("t").values, ElementsAre(0.0, 0.5));
  EXPECT_THAT(log.at("x").values, ElementsAre(1.0, 2.0));
  const Log inside = parse(R"({"drive": "X, 1", "samples": [{"t_s": 0, "x_mm": 1}, {"t_s": 1, "x_mm": 2}]})");
  EXPECT_THAT(inside.at("x").values, ElementsAre(1.0, 2.0));
  EXPECT_THAT(inside.metadata, Contains(Pair("drive", "X, 1")));
}

TEST(JsonTable, AListForEachColumn) {
  const Log log = parse(R"({"sample time": "2 ms", "x, measured_mm": [1, 2, 3], "f_N": [4, 5.5, 6]})");
  EXPECT_THAT(log.at("f").values, ElementsAre(4.0, 5.5, 6.0));
  EXPECT_THAT(log.at("x, measured").values, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(log.at("t").values, ElementsAre(0.0, 2e-3, 4e-3));
  EXPECT_THAT(refusal(R"({"t_s": [0, 1, 2], "x_mm": [1, 2]})"),
              HasSubstr("x_mm: has 2 values, expected 3 as in \"t_s\""));
}

TEST(JsonTable, TheLongestTableInsideIsTaken) {
  const std::string rows = R"([{"t_s": 0, "x_mm": 1}, {"t_s": 0.5, "x_mm": 2}, {"t_s": 1, "x_mm": 3}])";
  const std::string lists = R"({"t_s": [0, 0.5, 1], "x_mm": [1, 2, 3]})";
  for (const std::string& data : {rows, lists}) {
    for (const char* beside :
         {R"("channels": [{"name": "x", "unit": "mm"}, {"name": "t", "unit": "s"}])",
          R"("events": [{"t_s": 0, "id": 1}, {"t_s": 5, "id": 2}])",
          R"("limits": {"min": [1, 2], "max": [3, 4]})",
          R"("calibration": {"gains": [1, 2, 3, 4], "offsets": [3]})", R"("axes": ["x", "y", "z", "a"])"}) {
      EXPECT_THAT(parse("{" + std::string(beside) + R"(, "data": )" + data + "}").at("x").values,
                  ElementsAre(1.0, 2.0, 3.0))
          << beside;
      EXPECT_THAT(parse(R"({"data": )" + data + ", " + beside + "}").at("x").values,
                  ElementsAre(1.0, 2.0, 3.0))
          << beside;
    }
  }
  // A damaged table is refused, and no shorter one is read in its place.
  EXPECT_THAT(refusal(R"({"events": [{"t_s": 0, "id": 1}, {"t_s": 5, "id": 2}],
                         "data": {"t_s": [0, 1, 2, 3], "x_mm": [1, 2, 3, 4], "f_N": [1, 2, 3]}})"),
              HasSubstr("f_N: has 3 values, expected 4"));
}

TEST(JsonTable, ValuesInsideARow) {
  const Log log = parse(
      "{\"stamp\": {\"sec\": 1, \"nanosec\": 0}, \"position\": [1.5, 2.5]}\n"
      "{\"stamp\": {\"sec\": 1, \"nanosec\": 2000000}, \"position\": [1.75, 2.75]}\n");
  EXPECT_THAT(log.at("t").values, ElementsAre(0.0, 2e-3));
  EXPECT_THAT(log.at("position_1").values, ElementsAre(2.5, 2.75));
}

TEST(JsonTable, WhatARowLacksIsAbsent) {
  const Log log = parse(
      R"([{"t_s": 0, "x_mm": 1}, {"t_s": 1}, {"t_s": 2, "x_mm": null}, {"t_s": 2.5, "x_mm": NaN, "who": "NaN \" NaN"}, {"t_s": 3, "x_mm": 4, "f_N": 5}])");
  EXPECT_EQ(log.rows, 5U);
  EXPECT_THAT(log.at("x").values, ElementsAre(1.0, 4.0));
  EXPECT_THAT(log.notes, Contains(HasSubstr("\"x_mm\" has numbers in 2 of 5 rows")));
}

TEST(JsonTable, AKeyMayComeLate) {
  std::string text;
  for (int i = 0; i < 300; ++i)
    text += "{\"t_s\": " + std::to_string(i) + (i < 150 ? "" : ", \"x_mm\": 2") + "}\n";
  EXPECT_EQ(parse(text).at("x").values.size(), 150U);
}

TEST(JsonTable, DamageIsNamed) {
  EXPECT_THAT(
      refusal("{\"t_s\":0,\"x_mm\":1}\n{\"t_s\":1,\"x_mm\":2}\n{\"t_s\":2;}\n{\"t_s\":3,\"x_mm\":2}\n"),
      HasSubstr("log.json:3: is no JSON object"));
  // The last line may be cut while it is written.
  EXPECT_EQ(parse("{\"t_s\":0,\"x_mm\":1}\n{\"t_s\":1,\"x_mm\":2}\n{\"t_s\":2,\"x_").rows, 2U);
  EXPECT_THAT(refusal(R"([{"t_s": 0, "x_mm": 1}, {"t_s": 0.5)"), HasSubstr("is cut off"));
  EXPECT_THAT(refusal(R"({"name": "x", "mass": 3})"),
              HasSubstr("no table, expected one object in each line"));
  EXPECT_THAT(refusal(std::string(100, '[') + "{\"t\":1}" + std::string(100, ']')),
              HasSubstr("nested deeper"));
}

// A hundred rows of many keys, then many rows without them: as a table it would be a thousand times the file.
TEST(JsonTable, RowsWithoutMostKeysAreRefused) {
  std::string text = "[{\"t_s\":0";
  for (int i = 0; i < 2000; ++i) text += ",\"k" + std::to_string(i) + "\":1";
  text += "}";
  for (int i = 1; i < 2000; ++i) text += ",{\"t_s\":" + std::to_string(i) + "}";
  EXPECT_THAT(refusal(text + "]"), HasSubstr("lack most of the keys"));
}

TEST(JsonTable, ABracketAtTheBeginIsNotAlwaysJson) {
  const Log log = parse("[SERVO GUIDE]\nSampling,2,ms\nt_s,x_mm,f_N\n0,1,2\n1,2,3\n2,3,4\n");
  EXPECT_THAT(log.at("x").values, ElementsAre(1.0, 2.0, 3.0));
}

}  // namespace
}  // namespace stribeck::io::json_table_test
