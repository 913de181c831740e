#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/io/log/log_spreadsheet.hpp>
#include <string>

namespace stribeck::io::log_spreadsheet_test {
namespace {

using detail::time_of_day;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Log parse(const std::string& text) { return parse_log(text, "log.csv"); }

TEST(Spreadsheet, UnitsInTheRowBelowTheNames) {
  const Log log = parse("t;x;i\ns;mm;A\n0.0;1.5;2\n0.1;1.6;3\n");
  EXPECT_EQ(log.rows, 2U);
  EXPECT_EQ(log.columns.at(0).unit_text, "s");
  EXPECT_EQ(log.columns.at(1).unit_text, "mm");
  EXPECT_EQ(log.columns.at(2).unit_text, "A");
  EXPECT_THAT(log.columns.at(1).values, ElementsAre(1.5, 1.6));
  EXPECT_THAT(log.notes, Contains(HasSubstr("line 2")));
  // Brackets, spellings of drives, a column without a unit, a decimal comma below.
  const Log other =
      parse("Zeit\tn\tI\tstate\n[ms]\t(U/min)\t[Ampere]\t\n0,5\t1,5\t2,0\t1\n1,5\t1,6\t3,0\t1\n");
  EXPECT_EQ(other.columns.at(1).unit_text, "rpm");
  EXPECT_EQ(other.columns.at(2).unit_text, "A");
  EXPECT_EQ(other.columns.at(3).unit_text, "");
  EXPECT_THAT(other.columns.at(0).values, ElementsAre(0.5, 1.5));
}

TEST(Spreadsheet, ATitleAboveTheNames) {
  // The index of a table has no name and is no title.
  const Log titled =
      parse("\"Trace\",\"\",\"\",\n\"t\",\"x\",\"f\",\n\"(s)\",\"(mm)\",\"(N)\",\n0,1,2,\n1,2,3,\n");
  EXPECT_EQ(titled.columns.at(1).header, "x");
  EXPECT_EQ(titled.columns.at(2).unit_text, "N");
  EXPECT_EQ(parse(",t_s,x_mm\n0,0.0,1\n1,0.1,2\n").columns.at(1).header, "t_s");
}

TEST(Spreadsheet, ATimeForEachVariable) {
  const Log log = parse("Timestamp;x;Timestamp;f\n0;1;0;5\n10;2;10;6\n");
  ASSERT_EQ(log.columns.size(), 3U);
  EXPECT_EQ(log.columns.at(2).header, "f");
  const Log letters = parse("Time A [ms];x [mm];Time B [ms];f [N]\n0;1;30;5\n10;2;40;6\n");
  EXPECT_THAT(letters.columns.at(letters.at("f").time).values, ElementsAre(30.0, 40.0));
  const Log own = parse("Time [ms];x [mm];Time [ms];f [N]\n0;1;0;5\n10;2;11;6\n");
  EXPECT_THAT(own.columns.at(own.at("f").time).values, ElementsAre(0.0, 11.0));
  EXPECT_THAT(own.columns.at(own.at("x").time).values, ElementsAre(0.0, 10.0));
  // Rows that the slower signal does not have are blank.
  const Log slow = parse("Time 1 [ms];x [mm];Time 2 [ms];f [N]\n0;1;0;5\n2;2;8;6\n4;3;16;7\n6;4;;\n8;5;;\n");
  EXPECT_THAT(slow.columns.at(slow.at("f").time).values, ElementsAre(0.0, 8.0, 16.0));
  EXPECT_THAT(slow.at("f").values, ElementsAre(5.0, 6.0, 7.0));
  EXPECT_THAT(slow.at("x").values, ElementsAre(1.0, 2.0, 3.0, 4.0, 5.0));
  // Without a unit a second time may be anything.
  const Log vague = parse("Time;x;Time 2;f\n0;1;30;5\n10;2;40;6\n");
  EXPECT_EQ(vague.columns.size(), 4U);
  EXPECT_THAT(vague.notes, Contains(HasSubstr("\"Time\" and \"Time 2\" hold different times")));
  EXPECT_THAT([] { parse("t;x;x\n0;1;0\n10;2;11\n"); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("stands twice")));
}

TEST(Spreadsheet, LinesBetweenAndBelowTheRows) {
  const Log log =
      parse("t_s,x_mm,f_N\n0,1,2\n// door opened\n1,2,3\nt_s,x_mm,f_N\n2,3,4\n\nMin,1,2\nMax,3,4,\n");
  EXPECT_EQ(log.rows, 3U);
  EXPECT_THAT(log.columns.at(2).values, ElementsAre(2.0, 3.0, 4.0));
  EXPECT_THAT(log.notes, Contains(HasSubstr("lines of text below the table were left out: 2")));
  EXPECT_THAT(log.notes, Contains(HasSubstr("lines that repeat the names of the columns were left out: 1")));
  // Words above further rows are damage, and so is a cell that was a number.
  EXPECT_THAT([] { parse("t_s,x_mm\n0,1\nMin,2\n1,2\n"); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("\"Min\"")));
  EXPECT_THAT([] { parse("t_s,x_mm\n0,1\n1,2\nO.5,2\n"); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("\"O.5\"")));
  EXPECT_THAT([] { parse("t_s,x_mm\n0,1\n1,2\ninf,2\n"); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("finite")));
}

TEST(Spreadsheet, Durations) {
  EXPECT_DOUBLE_EQ(*detail::duration("0.002 sec"), 0.002);
  EXPECT_DOUBLE_EQ(*detail::duration("1 days 00:00:01.500000"), 86401.5);
  EXPECT_FALSE(detail::duration("0.002"));
  EXPECT_FALSE(detail::duration("0.002 mm"));
  EXPECT_FALSE(detail::duration("1 days"));
  const Log log = parse("Time,x_mm\n5 sec,1\n5.5 sec,2\n6 sec,3\n");
  EXPECT_THAT(log.columns.at(0).values, ElementsAre(0.0, 0.5, 1.0));
  EXPECT_EQ(log.columns.at(0).unit_text, "s");
}

TEST(Spreadsheet, UnitsThatContradictTheNamesAreRefused) {
  EXPECT_THAT([] { parse("t_s,x_mm\ns,m\n0,1\n1,2\n"); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("the row of units says \"m\"")));
  // The same unit in both is none.
  EXPECT_EQ(parse("t_s,x_mm\ns,mm\n0,1\n1,2\n").rows, 2U);
}

TEST(Spreadsheet, WordsAreNoUnits) {
  EXPECT_THAT([] { parse("t_s,x_mm\nstart,stop\n0,1\n1,2\n"); }, ::testing::Throws<InputError>());
}

TEST(Spreadsheet, SeparatorOfExcel) {
  const Log log = parse("sep=;\r\nt_s;x_mm\r\n0,0;1,5\r\n0,1;1,6\r\n");
  ASSERT_EQ(log.columns.size(), 2U);
  EXPECT_THAT(log.columns[1].values, ElementsAre(1.5, 1.6));
  EXPECT_EQ(parse("\"sep=,\"\nt_s,x_mm\n0,1\n1,2\n").columns.size(), 2U);
}

TEST(Spreadsheet, TimesOfDay) {
  const Log log = parse("time,x_mm\n07:15:23.123,1\n07:15:23.124,2\n07:15:24,3\n");
  ASSERT_EQ(time_column(log), 0);
  EXPECT_EQ(log.columns[0].unit_text, "s");
  EXPECT_NEAR(log.columns[0].values[1], 0.001, 1e-11);
  EXPECT_NEAR(log.columns[0].values[2], 0.877, 1e-11);
  // Past midnight it goes on.
  const Log night = parse("Uhrzeit;x_mm\n2024-03-05T23:59:59,9Z;1\n2024-03-06T00:00:00,1Z;2\n");
  ASSERT_EQ(time_column(night), 0);
  EXPECT_NEAR(night.columns[0].values[1], 0.2, 1e-10);
}

TEST(Spreadsheet, FiguresBelowTimesOfDayAreLeftOut) {
  const Log log = parse(
      "Time;;x [mm];f [N];\n23:59:59.998;;0;1;\n23:59:59.999;;1;2;\n00:00:00.000;;2;3;\nMin;;0;1;\nMax;;2;3;\n");
  EXPECT_THAT(log.at("x").values, ElementsAre(0, 1, 2));
  EXPECT_EQ(log.at("Time").values.size(), 3U);
  EXPECT_NEAR(log.at("Time").values[2], 2e-3, 1e-9);
}

TEST(Spreadsheet, TimesOfDayBesideATimeStayText) {
  const Log log = parse("clock,t_s,x_mm\n07:15:23,0,1\n07:15:24,1,2\n");
  EXPECT_EQ(log.columns[0].texts.size(), 2U);
  EXPECT_EQ(time_column(log), 1);
}

TEST(Spreadsheet, WhatIsATimeOfDay) {
  EXPECT_EQ(time_of_day("00:00:01"), 1.0);
  EXPECT_EQ(time_of_day("1:02:03.5"), 3723.5);
  EXPECT_EQ(time_of_day("2024-03-05T01:00:00.25+01:00"), 3600.25);
  EXPECT_EQ(time_of_day("05.03.2024 01:00:00,25"), 3600.25);
  EXPECT_EQ(time_of_day("12:00:01 AM"), 1.0);
  EXPECT_EQ(time_of_day("1:00:00 pm"), 46800.0);
  for (const char* text :
       {"", "12", "12:30", "25:00:00", "12:61:00", "12:00:00 x", "a 12:00:00", "1-2T3:4:5"})
    EXPECT_FALSE(time_of_day(text)) << text;
}

TEST(Spreadsheet, ThousandsSeparatorsAreNamed) {
  EXPECT_THAT([] { parse("t_s;x_um\n0.0;107.8\n0.1;1,107.8\n"); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("thousands separators")));
}

TEST(Spreadsheet, GroupsOfThreeDigitsMayBeThousandsOrDecimals) {
  const auto refusal = [](const std::string& text) { return [text] { parse(text); }; };
  EXPECT_THAT(refusal("t [ms]\tx [um]\n0\t0\n1\t975\n2\t1,950\n3\t-12,345\n"),
              ::testing::ThrowsMessage<InputError>(AllOf(
                  HasSubstr("column \"x [um]\": got \"1,950\", which may be 1950 or have three decimals"),
                  HasSubstr("export the log without thousands separators"))));
  EXPECT_THAT(refusal("t [ms];x [um]\n0;0\n1;975\n2;1.950\n"),
              ::testing::ThrowsMessage<InputError>(HasSubstr("got \"1.950\", which may be 1950")));
  // Decimals: in each row, below 1, of another length, beside 1000 without a mark; comma tables have no decimal comma.
  for (const char* x : {"0.000;1.975;2.950", "1.250;1.975;2.950", "0;0.975;1.950", "0;1.975;2.9",
                        "0;1.975;2.9501", "1000;1.975;2.950", "0;1.975;0.000"}) {
    std::string text = "t [ms];x [um]\n";
    std::string_view rest = x;
    for (int k = 0; k < 3; ++k) {
      text += std::to_string(k) + ";" + std::string(rest.substr(0, rest.find(';'))) + "\n";
      rest.remove_prefix(std::min(rest.find(';') + 1, rest.size()));
    }
    EXPECT_EQ(parse(text).columns.at(1).values.at(1), text.find("0.975") == std::string::npos ? 1.975 : 0.975)
        << x;
  }
  // Another column tells the mark.
  EXPECT_EQ(parse("t [s];feed [mm/s]\n0.000;0\n0.001;8.333\n0.002;-8.333\n").columns.at(1).values.at(1),
            8.333);
  EXPECT_EQ(parse("t [ms];feed [mm/s];f [N]\n0;0;1\n1;8,333;12,34\n2;0;3\n").columns.at(1).values.at(1),
            8.333);
  EXPECT_EQ(parse("t [ms],x [um]\n0,0\n1,975\n2,1.950\n").columns.at(1).values.at(2), 1.95);
}

TEST(Spreadsheet, AHeadAboveTheNames) {
  // IndraWorks: keys and values in two cells, as many as a row of a small table.
  const Log indra = parse(
      "Oscilloscope\nDate;12.05.2024\nTime;10:23:11\nSampling interval;1000;us\n\n"
      "Time [us];x [mm];M [%]\n0;1,5;2\n1000;1,6;3\n2000;1,7;4\n");
  ASSERT_EQ(indra.columns.size(), 3U);
  EXPECT_THAT(indra.columns[1].values, ElementsAre(1.5, 1.6, 1.7));
  EXPECT_THAT(indra.notes, Contains(HasSubstr("in line 6")));
  EXPECT_THAT(indra.metadata, Contains(std::pair<std::string, std::string>("Sampling interval", "1000;us")));
  // The units in a row of their own, every cell in quotes.
  const Log sigma = parse(
      "\"Trace\"\n\"Model\",\"A1\"\n\"Count\",\"2\"\n\"\",\"Torque\",\"Speed\"\n\"[ms]\",\"[%]\",\"[min-1]\"\n"
      "0,1,2\n1,2,3\n");
  ASSERT_EQ(sigma.columns.size(), 3U);
  EXPECT_EQ(sigma.columns[0].unit_text, "ms");
  EXPECT_EQ(sigma.columns[2].unit_text, "min-1");
  EXPECT_EQ(sigma.rows, 2U);
}

TEST(Spreadsheet, AHeadOfKeysAndNumbersIsNoTable) {
  std::string text = "channels;3\nrate;1000\nblock;20\nt_s;x_mm;i_A\n";
  for (int k = 0; k < 30; ++k) text += std::to_string(k) + ";1;2\n";
  const Log log = parse(text);
  EXPECT_EQ(log.columns.size(), 3U);
  EXPECT_EQ(log.rows, 30U);
  // Rows of another length stay an error of the table.
  EXPECT_THAT([] { parse("t_s,x_mm\n0,1\n1,2,3\n2,3\n"); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("got 3 cells, expected 2")));
}

TEST(Spreadsheet, PointsBetweenThousandsBeforeADecimalComma) {
  const Log log = parse("Zeit [ms];Lage [mm]\n999,5;-12,25\n1.000,0;-1.234.567,25\n");
  EXPECT_THAT(log.columns.at(0).values, ElementsAre(999.5, 1000.0));
  EXPECT_THAT(log.columns.at(1).values, ElementsAre(-12.25, -1234567.25));
  for (const char* text : {"1.234", "12.34,5", "1.2345,6", "1234.567,8", ".123,4", "1,234", "", ","})
    EXPECT_FALSE(detail::grouped_number(text, ',')) << text;
}

TEST(Spreadsheet, CommasOrApostrophesBetweenThousandsBeforeADecimalPoint) {
  const Log log = parse("Time (ms),Position (um)\n999.5,-12.25\n\"1,000.0\",\"-1,234,567.25\"\n");
  EXPECT_THAT(log.columns.at(0).values, ElementsAre(999.5, 1000.0));
  EXPECT_THAT(log.columns.at(1).values, ElementsAre(-12.25, -1234567.25));
  EXPECT_THAT(parse("t [ms];x [um]\n999.5;1\n1'000.0;2\n").columns.at(0).values, ElementsAre(999.5, 1000.0));
  for (const char* text : {"1,234", "12,34.5", "1,2345.6", "1,234'567.8", ",123.4", "1.234", "", "."})
    EXPECT_FALSE(detail::grouped_number(text, '.')) << text;
}

TEST(Spreadsheet, MergedCellsAboveTheNamesTellTheAxis) {
  const auto names = [](const std::string& text) {
    std::vector<std::string> all;
    for (const Column& c : parse(text).columns) all.push_back(c.header);
    return all;
  };
  const std::string rows = "0;1;2;3;4\n1;2;3;4;5\n2;3;4;5;6\n";
  const std::vector<std::string> both{"Time [ms]", "X Pos [mm]", "X Torque [%]", "Y Pos [mm]",
                                      "Y Torque [%]"};
  EXPECT_EQ(names("Time;X;;Y;\n[ms];Pos [mm];Torque [%];Pos [mm];Torque [%]\n" + rows), both);
  EXPECT_EQ(names(";X;;Y\nTime [ms];Pos [mm];Torque [%];Pos [mm];Torque [%]\n" + rows), both);
  // Without a name twice, what stands above is no part of the names.
  EXPECT_EQ(names("Scope;3;of;4\nt_ms;a;b;c;d\n" + rows).at(1), "a");
}

TEST(Spreadsheet, AMeasurementFileOfLabViewHasAHeadOfTwoParts) {
  const std::string head =
      "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t,\n***End_of_Header***\t\n\nChannels\t2\nDelta_X\t0,001\n***End_of_Header***\t\t\n";
  const Log log =
      parse(head + "X_Value\tLage [mm]\tMoment [%]\tComment\n0,000\t1,5\t2\n0,001\t1,6\t3\n0,002\t1,7\t4\n");
  EXPECT_EQ(log.columns.size(), 3U);
  EXPECT_EQ(log.columns.at(0).header, "Time [s]");
  EXPECT_THAT(log.columns.at(0).values, ElementsAre(0.0, 0.001, 0.002));
}

TEST(Spreadsheet, LabViewTellsTheUnitsInItsHead) {
  const Log log = parse(
      "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\nChannels\t2\nY_Unit_Label\tmm\tN\n***End_of_Header***\t\t\n"
      "X_Value\tWeg\tKraft\n0.000\t1.5\t2\n0.001\t1.6\t3\n0.002\t1.7\t4\n");
  EXPECT_EQ(log.at("Weg").unit_text, "mm");
  EXPECT_EQ(log.at("Kraft").unit_text, "N");
}

TEST(Spreadsheet, ALegendAboveTheTableNamesItsColumns) {
  const Log log = parse(
      "Scope\nSampling Time: 1 ms\nCH1: Feedback position [mm]\nCH2: Torque feedback [%]\nTime(ms)\tCH1\tCH2\n0.0\t1\t2\n1.0\t2\t3\n2.0\t3\t4\n");
  EXPECT_EQ(log.at("Feedback position").unit_text, "mm");
  EXPECT_EQ(log.at("Torque feedback").unit_text, "%");
}

// Only a name that says nothing is replaced: "# x: mm" is a remark.
TEST(Spreadsheet, ARemarkOnAColumnIsNoName) {
  const Log log = parse("# x: mm\n# f: N\nt [s],x [mm],f [N]\n0,1,2\n1,2,3\n2,3,4\n");
  EXPECT_EQ(log.at("x").unit_text, "mm");
  EXPECT_EQ(log.at("f").unit_text, "N");
  EXPECT_EQ(parse("Position;mm\nForce;N\nt [s];Position;Force\n0;1;2\n1;2;3\n2;3;4\n").columns.at(1).header,
            "Position");
}

TEST(Spreadsheet, GroupsWithATimeEachTellTheAxis) {
  const Log log = parse(
      "Axis X;;Axis Y;\nTime [s];Position [mm];Time [s];Actual position [mm]\n0;1;0;2\n1;2;1;3\n2;3;2;4\n");
  EXPECT_EQ(log.columns.at(1).header, "Axis X Position [mm]");
}

TEST(Spreadsheet, ATimeBesideEachSignalMakesNoGroups) {
  const Log log = parse(
      "Trace;Trace1\nResolution;us\n\nTime [us];PRG.fActPosition;Time [us];PRG.fActTorque\n0;1.5;0;2\n1000;1.6;1000;3\n2000;1.7;2000;4\n");
  EXPECT_EQ(log.columns.at(1).header, "PRG.fActPosition");
}

TEST(Spreadsheet, NamesOnlyOfTwinCatHaveATimeBesideEachSignal) {
  const Log log = parse("Name;ActPos [mm];Name;ActTorque [%]\n0,0;1,5;0,0;2\n1,0;1,6;1,0;3\n2,0;1,7;2,0;4\n");
  EXPECT_EQ(log.columns.at(0).unit_text, "ms");
  EXPECT_EQ(log.columns.size(), 3U);
  const Log ticks = parse(
      "Name\tA\tName\tB\n133500000000000000\t1\t133500000000000000\t2\n133500000000010000\t1\t133500000000010000\t2\n");
  EXPECT_EQ(ticks.columns.at(0).unit_text, "0.1 us");
}

TEST(Spreadsheet, BlankColumnsAreLeftOut) {
  const Log log = parse("t_s,frame,x_mm\n0,,1\n1,,2\n2,,3\n");
  EXPECT_EQ(log.columns.size(), 2U);
  EXPECT_THAT(log.notes, Contains(HasSubstr("\"frame\" is blank in every row")));
  EXPECT_EQ(parse("t_s,i_A,x_mm\n0,,1\n1,5,2\n2,6,3\n").at("i").values.size(), 2U);
}

TEST(Spreadsheet, UnitsInTheWordsOfAName) {
  const Log log =
      parse("Seconds;Lage in mm;Moment in N m;Anteil in Prozent\n0,0;1,5;2;3\n0,1;1,6;3;4\n0,2;1,7;4;5\n");
  EXPECT_EQ(log.columns.at(0).unit_text, "s");
  EXPECT_EQ(log.columns.at(1).name, "Lage");
  EXPECT_EQ(log.columns.at(1).unit_text, "mm");
  EXPECT_EQ(log.columns.at(2).unit_text, "N m");
  EXPECT_EQ(log.columns.at(3).unit_text, "");
  EXPECT_EQ(time_column(log), 0);
}

TEST(Spreadsheet, AnODriveCountsTurns) {
  const Log log = parse(
      "t_s,axis0.encoder.pos_estimate,axis0.controller.pos_setpoint,axis0.motor.current_control.Iq_measured\n0,1,1,2\n1,2,2,2\n");
  EXPECT_EQ(log.columns.at(1).unit_text, "rev");
  EXPECT_EQ(log.columns.at(2).unit_text, "rev");
  EXPECT_EQ(log.columns.at(3).unit_text, "A");
  EXPECT_THAT(log.notes, Contains(HasSubstr("firmware 0.5.1")));
  EXPECT_EQ(parse("t_s,pos_estimate,iq_measured\n0,1,2\n1,2,2\n").columns.at(1).unit_text, "");
}

TEST(Spreadsheet, MinutesAndSecondsOfASpreadsheet) {
  const Log log = parse("Time (s),x_mm\n59:59.8,1\n59:59.9,2\n00:00.0,3\n");
  ASSERT_EQ(time_column(log), 0);
  EXPECT_NEAR(log.columns[0].values[1], 0.1, 1e-9);
  // Past the hour it goes on.
  EXPECT_NEAR(log.columns[0].values[2], 0.2, 1e-9);
  for (const char* text : {"12:30", "60:01.5", "1:2.5", "01:60.0", "a1:02.5"})
    EXPECT_FALSE(detail::minutes_and_seconds(text)) << text;
}

TEST(Spreadsheet, DatesMadeOfNumbersAreNamed) {
  EXPECT_THAT([] { parse("t_s;x_mm\n0;1,5\n1;01. Feb\n2;1,6\n"); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("a spreadsheet made a date of a number")));
}

TEST(Spreadsheet, UnitsBehindNumbersAreNamed) {
  EXPECT_THAT([] { parse("Time,Position\n0.0 s,1.5 mm\n0.1 s,1.6 mm\n"); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("a unit behind each number")));
}

TEST(Spreadsheet, UnitsOfScopesAndMicrocontrollers) {
  const Log scope = parse("x-axis,1\nsecond,Volt\n0.0,1.5\n0.1,1.6\n");
  EXPECT_EQ(time_column(scope), 0);
  EXPECT_EQ(scope.columns.at(1).unit_text, "V");
  const Log counts = parse("Time_ms,Position_counts,Torque_permil\n0,5,1\n1,6,2\n");
  EXPECT_EQ(counts.columns.at(1).unit_text, "count");
  EXPECT_EQ(counts.columns.at(2).name, "Torque");
  EXPECT_DOUBLE_EQ(in_si(counts.columns.at(2), quantity("", "")).at(0), 0.001);
}

// What drive tools and databases write, as a service engineer found it.
TEST(Spreadsheet, AMinusOfATypesetterIsAMinus) {
  const Log log = parse("Zeit;Position\ns;mm\n0,000;\u22120,0002\n0,002;\u22121,5e-3\n");
  EXPECT_THAT(log.at("Position").values, ElementsAre(-0.0002, -0.0015));
  EXPECT_THAT([] { parse("t_s,x_mm\n0,\u2212\u22121\n1,2\n2,3\n"); }, ::testing::Throws<InputError>());
}

TEST(Spreadsheet, ThousandsMayBeDividedByBlanksAndApostrophes) {
  for (const std::string_view divider : {" ", "\u00A0", "\u202F", "'"}) {
    const std::string thousand = "1" + std::string(divider) + "234";
    const Log log =
        parse("Zeit_s;Position_mm;Inkremente\n0,5;-" + thousand + ",25;" + thousand + "\n0,6;1,0;7\n");
    EXPECT_THAT(log.at("Position").values, ElementsAre(-1234.25, 1.0)) << divider;
    EXPECT_THAT(log.at("Inkremente").values, ElementsAre(1234.0, 7.0)) << divider;
  }
  EXPECT_THAT([] { parse("t_s;x_mm\n0;1 23,4\n1;2,5\n2;3,5\n"); }, ::testing::Throws<InputError>());
}

TEST(Spreadsheet, AMinusBehindTheDigitsIsAMinus) {
  const Log log = parse("Zeit;Position\ns;mm\n0,000;0,0002-\n0,002;1,5\n");
  EXPECT_THAT(log.at("Position").values, ElementsAre(-0.0002, 1.5));
  EXPECT_THAT([] { parse("t_s,x_mm\n0,-1-\n1,2\n2,3\n"); }, ::testing::Throws<InputError>());
}

TEST(Spreadsheet, AStampThatStaysIsNoTime) {
  const Log log = parse(
      "_start,_time,pos_mm\n2026-11-26T10:00:00Z,2026-11-26T10:15:23.124Z,0.5\n"
      "2026-11-26T10:00:00Z,2026-11-26T10:15:23.126Z,0.6\n");
  EXPECT_THAT(log.at("_time").values, ElementsAre(0.0, ::testing::DoubleNear(2e-3, 1e-9)));
  EXPECT_FALSE(log.at("_start").texts.empty());
}

TEST(Spreadsheet, MillisecondsBehindASemicolon) {
  EXPECT_DOUBLE_EQ(time_of_day("10:15:23;124").value(), 36923.124);
  const Log log = parse(
      "Header:,\"Date\",\"Time\",\"Pos\"\nData,\"11/26/2026\",\"10:15:23;124\",0\n"
      "Data,\"11/26/2026\",\"10:15:23;128\",1\n");
  EXPECT_THAT(log.at("Time").values, ElementsAre(0.0, ::testing::DoubleNear(4e-3, 1e-9)));
}

TEST(Spreadsheet, ACommaInATimeOfDayIsNoDecimalCommaOfOthers) {
  const Log log = parse("Zeit;x\n10:15:23,124;0.25\n10:15:23,126;0.75\n");
  EXPECT_THAT(log.at("x").values, ElementsAre(0.25, 0.75));
}

TEST(Spreadsheet, NamesWithBlanksBetweenWideColumns) {
  const Log log = parse(
      "Time (sec)   Mtr 1 Act Pos (mm)   Mtr 1 DAC Out (volts)\n0.000   -0.5   1.5\n0.002   0.5   2.5\n");
  ASSERT_EQ(log.columns.size(), 3U);
  EXPECT_EQ(log.columns.at(1).name, "Mtr 1 Act Pos");
  EXPECT_THAT(log.columns.at(2).values, ElementsAre(1.5, 2.5));
}

TEST(Spreadsheet, TypesBelowTheNamesAreLeftOut) {
  const Log log =
      parse("Time,Axis.ActPos,Axis.ActTrq\nLTIME,LREAL,REAL\n[ms],[mm],[N m]\n0.0,0.5,1\n2.0,0.6,2\n");
  EXPECT_EQ(log.at("Axis.ActPos").unit_text, "mm");
  EXPECT_THAT(log.at("Axis.ActTrq").values, ElementsAre(1.0, 2.0));
}

TEST(Spreadsheet, AHeadMayHaveAsManyCellsAsTheTable) {
  const Log log = parse("Sampling frequency;500 Hz\nx [mm];i [A]\n1;2\n2;3\n3;4\n");
  EXPECT_DOUBLE_EQ(log.columns.at(0).values.at(1), 2e-3);
  EXPECT_DOUBLE_EQ(
      parse("Abtastzeit [\u00B5s];2000\nx [mm];i [A]\n1;2\n2;3\n3;4\n").columns.at(0).values.at(1), 2e-3);
}

// A spreadsheet fills every row up to the width of the widest.
TEST(Spreadsheet, AHeadMayBeFilledUpToTheWidthOfTheTable) {
  for (const char* more : {"", ";;"}) {
    std::string text;
    for (const char* line :
         {"Recorder;V1.2;", "Machine;Mill 3;", "Date;2026-11-27;", ";;", "Time;Position;Force", "s;mm;N",
          "0;1.5;2", "0.1;1.6;2", "0.2;1.7;3", "0.3;1.8;2"})
      text += std::string(line) + more + "\n";
    const Log log = parse_log(text, "a.csv");
    ASSERT_GE(log.columns.size(), 3U) << text;
    EXPECT_EQ(log.columns[1].name, "Position");
    EXPECT_EQ(log.columns[1].unit_text, "mm");
    EXPECT_THAT(log.columns[1].values, ElementsAre(1.5, 1.6, 1.7, 1.8));
  }
}

TEST(Spreadsheet, LengthsOfTheUserHaveNoUnit) {
  for (const char* unit : {"[units]", "(Units)", "[EU]", "[LU]"}) {
    const Log log = parse("t [ms],Lage " + std::string(unit) + "\n0,1\n1,2\n");
    EXPECT_EQ(log.at("Lage").unit_text, "") << unit;
    EXPECT_THAT(log.notes, Contains(HasSubstr("is not known"))) << unit;
  }
  EXPECT_EQ(parse("t [ms],PL.FB (Counts16Bit)\n0,1\n1,2\n").at("PL.FB").unit_text, "count");
  EXPECT_EQ(parse("t [0.1ms],x [0.1um]\n0,1\n1,2\n").at("x").unit_text, "0.1um");
  EXPECT_EQ(parse("t [ms],Position [cnt] (a01)\n0,1\n1,2\n").at("Position (a01)").unit_text, "count");
}

TEST(Spreadsheet, PerMilleIsAUnit) {
  const Log log = parse("t_s,torque [\u2030]\n0,1\n1,2\n");
  EXPECT_DOUBLE_EQ(in_si(log.at("torque"), quantity("", "")).at(1), 0.002);
}

}  // namespace
}  // namespace stribeck::io::log_spreadsheet_test
