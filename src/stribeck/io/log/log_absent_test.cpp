#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <string>

namespace stribeck::io::log_absent_test {
namespace {

using ::testing::Contains;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

Log parse(const std::string& text) { return parse_log(text, "log.csv", {}); }

/// A hundred rows; `cell` is the force in every `each`-th.
std::string table(const std::string& cell, int each) {
  std::string text = "t_s,x_mm,f_N\n";
  for (int k = 0; k < 100; ++k)
    text += std::to_string(k) + ",1," + (k % each == each - 1 ? cell : std::to_string(k)) + "\n";
  return text;
}

TEST(LogAbsent, FewCellsTakeTheirRows) {
  for (const char* cell :
       {"", "NaN", "-nan", "n/a", "null", "#N/A", "1.#QNAN", "-1.#IND00", "1.#IND", "1.#QNAN0"}) {
    const Log log = parse(table(cell, 40));
    EXPECT_EQ(log.rows, 98u) << cell;
    EXPECT_THAT(log.notes,
                Contains(HasSubstr("2 of 100 rows were left out: a cell of \"f_N\" holds no number "
                                   "(the first in line 41)")));
    EXPECT_THAT(log.notes, Contains(HasSubstr("time has 2 gaps")));
    for (const Column& c : log.columns) EXPECT_EQ(c.values.size(), 98u) << c.name;
    EXPECT_DOUBLE_EQ(log.at("f").values[39], 40.0);
  }
}

TEST(LogAbsent, AFirstCellWithAHashIsNoComment) {
  std::string text = "f [N];x [mm]\n";
  for (int k = 0; k < 12; ++k)
    text += (k % 3 == 2 ? k == 2 ? "#NV" : "#N/A" : std::to_string(k)) + ";" + std::to_string(10 * k) + "\n";
  ReadOptions options;
  options.sample_time = 1e-3;
  const Log log = parse_log(text, "log.csv", options);
  EXPECT_THAT(log.at("f").values, ElementsAre(0, 1, 3, 4, 6, 7, 9, 10));
  EXPECT_THAT(log.at("x").values, ElementsAre(0, 10, 20, 30, 40, 50, 60, 70, 80, 90, 100, 110));
  EXPECT_THAT(log.notes, Contains(HasSubstr("\"f [N]\" has numbers in 8 of 12 rows")));
  EXPECT_THAT(
      [&] { parse_log("f [N];x [mm]\n1;2\n#DIV/0!;3\n1;4\n", "log.csv", options); },
      ThrowsMessage<InputError>(HasSubstr("row 2, column \"f [N]\": got \"#DIV/0!\", expected a number")));
}

TEST(LogAbsent, CommentsAmongTheRowsStayComments) {
  const Log log = parse("t [s];x [mm]\n0;1\n# stopped here\n# by: hand; at 12:00\n#1;7\n1;2\n");
  EXPECT_THAT(log.at("x").values, ElementsAre(1, 2));
}

TEST(LogAbsent, RowsThatAreCommentedOutStayOut) {
  for (const char* first : {"10:00:0", "run "}) {
    const std::string at = first;
    const Log log = parse("stamp;t [s];x [mm]\n" + at + "0;0;1\n# gain;2;3\n#N/A;1;8\n#" + at + "1;1;7\n" +
                          at + "2;2;2\n");
    EXPECT_THAT(log.at("x").values, ElementsAre(1, 2)) << first;
  }
}

TEST(LogAbsent, NamesOfRunsMayBeginWithAHash) {
  const Log log = parse("Run;t [s];x [mm]\n#1;0.0;1\n# end of the run: none\n#1;0.5;2\n#2;1.0;3\n");
  EXPECT_THAT(log.at("Run").texts, ElementsAre("#1", "#1", "#2"));
  EXPECT_THAT(log.at("x").values, ElementsAre(1, 2, 3));
}

TEST(LogAbsent, RowsOfSeparatorsTakeTheirTime) {
  ReadOptions options;
  options.sample_time = 1e-3;
  for (const char separator : {';', ',', '\t'}) {
    std::string text = "x [mm];f [N]\n;\n";
    for (int k = 0; k < 10; ++k)
      text += k % 2 == 0 ? std::to_string(k) + ";" + std::to_string(10 * k) + "\n" : ";\n";
    text += ";\n";
    std::replace(text.begin(), text.end(), ';', separator);
    const Log log = parse_log(text, "log.csv", options);
    const Column& x = log.at("x");
    EXPECT_THAT(x.values, ElementsAre(0, 2, 4, 6, 8));
    const Column& t = x.time < 0 ? log.at("t") : log.columns[static_cast<std::size_t>(x.time)];
    ASSERT_EQ(t.values.size(), 5u);
    EXPECT_DOUBLE_EQ(t.values[4], 8e-3);
  }
}

TEST(LogAbsent, RowsOfSeparatorsAmongTimesAreLeftOut) {
  for (const char* names : {"t [ms];x [mm]\n", "clock;x [mm]\n"}) {
    const bool clock = names[0] == 'c';
    const std::string at = clock ? "10:00:0" : "";
    const Log log = parse(std::string(names) + at + "0;1\n" + at + "1;2\n;\n" + at + "2;3\n;\n");
    EXPECT_THAT(log.at("x").values, ElementsAre(1, 2, 3)) << names;
    EXPECT_THAT(log.notes, Contains(HasSubstr("lines without any value were left out: 2"))) << names;
  }
}

TEST(LogAbsent, NumbersOfRowsCountBlankRowsThemselves) {
  ReadOptions options;
  options.sample_time = 1e-3;
  const Log log = parse_log("Index;x [mm];f [N]\n1;1;1\n2;2;2\n;;\n3;3;3\n", "log.csv", options);
  EXPECT_THAT(log.at("x").values, ElementsAre(1, 2, 3));
  EXPECT_THAT(log.at("t").values, ElementsAre(0, 1e-3, 2e-3));
}

TEST(LogAbsent, AChannelOfAnotherRateHasItsOwnTimes) {
  const Log log = parse("t [ms];x [mm];f [N];g [N]\n0;1;;\n1;2;7;8\n2;3;;\n3;4;9;10\n4;5;;\n");
  const Column& f = log.at("f");
  EXPECT_THAT(f.values, ElementsAre(7, 9));
  ASSERT_GE(f.time, 0);
  const Column& t = log.columns[static_cast<std::size_t>(f.time)];
  EXPECT_THAT(t.values, ElementsAre(1, 3));
  EXPECT_EQ(t.unit_text, "ms");
  EXPECT_EQ(log.at("g").time, f.time);
  EXPECT_EQ(log.columns[static_cast<std::size_t>(log.at("x").time)].values.size(), 5u);
  EXPECT_THAT(log.notes, Contains(HasSubstr("\"f [N]\" has numbers in 2 of 5 rows")));
}

TEST(LogAbsent, ColumnsThatBeginLate) {
  const Log log = parse("t_s,state,x_mm,spare_N\n0,,,\n1,run,2,nan\n2,run,3,\n3,stop,4,\n");
  EXPECT_THAT(log.at("state").texts, ElementsAre("", "run", "run", "stop"));
  EXPECT_THAT(log.at("x").values, ElementsAre(2, 3, 4));
  EXPECT_EQ(log.find("spare"), nullptr);
  EXPECT_THAT(log.notes, Contains(HasSubstr("\"spare_N\" was left out: it holds no number")));
}

TEST(LogAbsent, ATimeIsNeeded) {
  // Without a time nobody sees the rows that are missing.
  EXPECT_THAT([] { parse("t_s,x_mm\n,1\nnan,2\nnan,3\n"); },
              ThrowsMessage<InputError>(HasSubstr("log.csv:2")));
  EXPECT_THAT([] { parse("t_s,x_mm\n0,1\nnan,2\n,3\n"); },
              ThrowsMessage<InputError>(HasSubstr("1 rows with a number in each cell")));
  EXPECT_THAT([] { parse("t_s,x_mm\n0,1\n1,inf\n2,3\n"); }, ThrowsMessage<InputError>(HasSubstr("finite")));
  EXPECT_THAT([] { parse("t_s,x_mm\n0,1\n1,O.5\n2,3\n"); }, ThrowsMessage<InputError>(HasSubstr("\"O.5\"")));
  EXPECT_THAT([] { parse_csv("t_s,x_mm\n0,1\n1,\n2,3\n", "log.csv"); },
              ThrowsMessage<InputError>(HasSubstr("the cell is blank")));
}

TEST(LogAbsent, TextOfJapanAndChina) {
  // Time [ms], position feedback, torque command; the second byte of a letter may be a bracket.
  const Log japan = parse(
      "\x8E\x9E\x8A\xD4[ms],\x88\xCA\x92\x75\x83\x74\x83\x42\x81\x5B\x83\x68\x83\x6F\x83\x62\x83\x4E[mm],"
      "\x83\x67\x83\x8B\x83\x4E[%]\n0,1,2\n1,2,3\n2,3,4\n");
  EXPECT_EQ(japan.columns[0].name, "時間");
  EXPECT_EQ(japan.columns[1].name, "位置フィードバック");
  EXPECT_EQ(japan.columns[1].unit_text, "mm");
  EXPECT_EQ(time_column(japan), 0);
  EXPECT_THAT(japan.notes, Contains(HasSubstr("read as Shift-JIS")));
  const Log china = parse("\xCA\xB1\xBC\xE4[ms],\xCA\xB5\xBC\xCA\xCE\xBB\xD6\xC3[mm]\n0,1\n1,2\n2,3\n");
  EXPECT_EQ(china.columns[1].name, "实际位置");
  // Latin-1 stays Latin-1.
  const Log latin = parse(
      "Zeit [ms],Gr\xF6\xDF"
      "e [\xB5m]\n0,1\n1,2\n2,3\n");
  EXPECT_EQ(latin.columns[1].name, "Größe");
  EXPECT_EQ(latin.columns[1].unit_text, "µm");
  // Excel's: a sign of per mille, and a dash for a minus.
  const Log windows = parse(
      "t [ms];x [mm];Moment [\x89]\n0;\x96 6,5;1\n1;-6,4;\x96"
      "2\n2;6,3;3\n");
  EXPECT_EQ(windows.columns[2].unit_text, "‰");
  EXPECT_THAT(windows.columns[1].values, ElementsAre(-6.5, -6.4, 6.3));
  EXPECT_EQ(windows.columns[2].values[1], -2.0);
  const Log two = parse(
      "t [ms];Moment [\x89];Strom [\x89]\n0;1;2\n1;2;\x96"
      "3\n2;3;4\n");
  EXPECT_EQ(two.columns[1].unit_text, "‰");
  EXPECT_EQ(two.columns[2].unit_text, "‰");
  // One minus, however many dashes there are.
  for (const char* dash : {"\x96", "\u2212", "\u2013 "}) {
    std::string many = "t [ms];x [mm]\n0;1\n1;";
    for (int i = 0; i < 100'000; ++i) many += dash;
    EXPECT_THROW(parse(many + "5\n2;3\n"), InputError);
    EXPECT_THROW(parse("t [ms];x [mm]\n0;1\n1;" + std::string(dash) + dash + "5\n2;3\n"), InputError);
  }
}

// An 8 kHz drive that writes every fourth cycle and counts cycles: what --sample-time gives is the time between rows.
TEST(LogAbsent, ACounterMayCountSeveralForARow) {
  const std::string text = "Cycle,x [mm]\n0,1\n4,2\n8,3\n16,5\n20,6\n";
  ReadOptions options;
  options.sample_time = 500e-6;
  const Log rows = parse_log(text, "log.csv", options);
  EXPECT_THAT(rows.at("t").values, ElementsAre(0.0, DoubleNear(500e-6, 1e-12), DoubleNear(1e-3, 1e-12),
                                               DoubleNear(2e-3, 1e-12), DoubleNear(2.5e-3, 1e-12)));
  EXPECT_THAT(rows.notes,
              Contains(HasSubstr("counts 4 for each row, so that rows are the given sample time apart")));
  // One step may be another, and a cell may be blank; a head that tells the time of rows counts as well.
  const std::string odd = "Cycle,x [mm]\n0,1\n4,2\n8,3\n12,5\n13,6\n16,7\n20,8\n";
  EXPECT_NEAR(parse_log(odd, "log.csv", options).at("t").values.back(), 2.5e-3, 1e-12);
  EXPECT_NEAR(parse_log("Sample time: 500 us\n" + text, "log.csv", {}).at("t").values.back(), 2.5e-3, 1e-12);
  // The period of the machine is that of a cycle, given or not.
  options.machine_period = 125e-6;
  for (const bool said : {false, true}) {
    options.sample_time = said ? std::optional(125e-6) : std::nullopt;
    const Log cycles = parse_log(text, "log.csv", options);
    EXPECT_NEAR(cycles.at("t").values.back(), 2.5e-3, 1e-12) << said;
    EXPECT_THAT(cycles.notes, Not(Contains(HasSubstr("say so with --sample-time"))));
  }
}

}  // namespace
}  // namespace stribeck::io::log_absent_test
