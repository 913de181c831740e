#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <string>

namespace stribeck::io::log_stamps_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

Log parse(const std::string& text, const ReadOptions& options = {}) {
  return parse_log(text, "log.csv", options);
}

std::string refusal(const std::string& text) {
  try {
    parse(text);
  } catch (const InputError& e) {
    return e.problems().front().text();
  }
  ADD_FAILURE() << "accepted";
  return {};
}

TEST(LogStamps, SecondsAndNanosecondsOfRos) {
  for (const auto& [seconds, rest] : {std::pair{"secs", "nsecs"}, std::pair{"sec", "nanosec"}}) {
    const Log log = parse("time,header.stamp." + std::string(seconds) + ",header.stamp." + rest +
                          ",position[0]\n"
                          "2024/05/12/10:23:11.1,1715509391,999000000,1.5\n"
                          "2024/05/12/10:23:12.1,1715509392,1000000,1.6\n");
    const Column& t = log.columns.at(static_cast<std::size_t>(time_column(log)));
    EXPECT_EQ(t.unit_text, "s");
    // Two milliseconds, to the nanosecond.
    EXPECT_NEAR(t.values.at(1) - t.values.at(0), 2e-3, 1e-12);
    EXPECT_THAT(log.notes, Contains(HasSubstr(rest)));
    // The number in brackets is an index.
    EXPECT_EQ(log.columns.back().unit_text, "");
    EXPECT_THAT(log.notes, ::testing::Not(Contains(HasSubstr("is not known"))));
  }
}

TEST(LogStamps, SecondsAndNanosecondsWithTheirUnits) {
  const Log log = parse(
      "\"header.stamp.sec [s]\",\"header.stamp.nanosec [ns]\",\"joint_x.position [m]\"\n"
      "1715509391,999000000,1.5\n1715509392,1000000,1.6\n");
  const Column& t = log.columns.at(static_cast<std::size_t>(time_column(log)));
  EXPECT_NEAR(t.values.at(1) - t.values.at(0), 2e-3, 1e-12);
}

TEST(LogStamps, ANumberInBracketsIsAnIndexBesideOthers) {
  const Log log = parse("t [s],position[0],position[1],ratio[1]\n0,1,2,3\n0.1,1,2,3\n");
  EXPECT_EQ(log.columns.at(2).name, "position[1]");
  EXPECT_EQ(log.columns.at(2).unit_text, "");
  EXPECT_EQ(log.columns.at(3).name, "ratio");
  EXPECT_EQ(log.columns.at(3).unit_text, "1");
}

TEST(LogStamps, NamesInACommentAboveRowsWithText) {
  const Log log = parse(
      "%time,field.frame,field.name0,field.effort0\n1715509391100000000,,z,1\n"
      "1715509391102000000,,z,2\n");
  ASSERT_EQ(log.rows, 2U);
  EXPECT_EQ(log.columns.at(0).unit_text, "ns");
  EXPECT_EQ(log.at("field.effort0").values.at(1), 2.0);
  EXPECT_EQ(log.at("field.name0").texts.at(0), "z");
}

TEST(LogStamps, TimesSince1970HaveAUnit) {
  const auto unit = [](const std::string& first, const std::string& second) {
    const Log log = parse("__time,x_mm\n" + first + ",1\n" + second + ",2\n");
    return log.columns.at(static_cast<std::size_t>(time_column(log))).unit_text;
  };
  EXPECT_EQ(unit("1715509391.1", "1715509391.2"), "s");
  EXPECT_EQ(unit("1715509391100", "1715509391200"), "ms");
  EXPECT_EQ(unit("1715509391100000", "1715509391200000"), "us");
  EXPECT_EQ(unit("1715509391100000000", "1715509391200000000"), "ns");
  EXPECT_EQ(unit("0", "1"), "");
  // Microseconds and nanoseconds since the power came on, every millisecond: the rows would be a quarter of an hour apart.
  EXPECT_EQ(unit("1200000000", "1200001000"), "");
  EXPECT_EQ(unit("2000000000000", "2000001000000"), "");
}

/// A table of ten rows with this step of its first column.
std::string stepped(const std::string& name, double first, double step) {
  std::string text = name + ",x_mm\n";
  for (int k = 0; k < 10; ++k) text += fmt::format("{},{}\n", first + step * k, k);
  return text;
}

// A log of a drive has a row every 15 us to 0.2 s: mostly that is one unit alone.
TEST(LogStamps, ATimeWithoutAUnitHasTheOnlyOneThatFits) {
  const auto unit = [](double first, double step, const ReadOptions& options = {}) {
    return parse(stepped("time", first, step), options).columns.at(0).unit_text;
  };
  EXPECT_EQ(unit(0.0, 0.002), "s");
  EXPECT_EQ(unit(3.5, 0.01), "s");
  EXPECT_EQ(unit(0.0, 1e-4), "s");
  EXPECT_EQ(unit(0.0, 4.0), "ms");
  // 20 ms or 20 us, 0.25 s or 0.25 ms, 125 ms or 125 us; microseconds or ticks of 100 ns.
  EXPECT_EQ(unit(0.0, 0.02), "");
  EXPECT_EQ(unit(0.0, 0.25), "");
  EXPECT_EQ(unit(0.0, 125.0), "");
  EXPECT_EQ(unit(0.0, 1e4), "");
  // Perhaps numbers of rows.
  EXPECT_EQ(unit(0.0, 1.0), "");
  EXPECT_EQ(unit(1.0, 1.0), "");
  EXPECT_EQ(unit(100.0, 1.0), "");
  ReadOptions of_machine;
  of_machine.machine_period = 125e-6;
  EXPECT_EQ(unit(0.0, 125.0, of_machine), "us");
  of_machine.machine_period = 4e-3;
  EXPECT_EQ(unit(0.0, 0.02, of_machine), "s");
  EXPECT_EQ(unit(0.0, 0.002, of_machine), "") << "a row in half a period";
  EXPECT_THAT(
      parse(stepped("Time", 0.0, 0.002)).notes,
      Contains(HasSubstr("column \"Time\" has no unit; taken as s, in which the rows are 2 ms apart")));
}

TEST(LogStamps, AGivenSampleTimeTakesThePlaceOfStampsThatStandStill) {
  ReadOptions options;
  options.sample_time = 0.25;
  const Log log = parse("t_s,x_mm\n0,1\n0,2\n0,3\n1,4\n1,5\n", options);
  EXPECT_DOUBLE_EQ(log.columns.at(0).values.at(4), 1.0);
  EXPECT_EQ(log.columns.size(), 2U);
  EXPECT_THAT(log.notes, Contains(HasSubstr("stand still in 3 of 5 rows")));
  // Good stamps stay.
  EXPECT_THAT(parse("t_s,x_mm\n0,1\n1,2\n2,3\n", options).notes, Contains(HasSubstr("is not used")));
}

TEST(LogStamps, TheHeadIsQuotedWhereTheTimeIsMissing) {
  EXPECT_THAT(refusal("Scope\nSampling cycle;1.000;blocks\nx [mm];i [A]\n1;2\n2;3\n3;4\n"),
              AllOf(HasSubstr("its head says \"Sampling cycle: 1.000;blocks\""), HasSubstr("--sample-time")));
  // Two periods that differ, and a cycle that may be that of the control.
  EXPECT_THAT(
      refusal("Scope\nSample rate;8 kHz\nSample time;1 ms\nx [mm];i [A];f [N]\n1;2;3\n2;3;4\n3;4;5\n"),
      HasSubstr("its head says \"Sample rate: 8 kHz\""));
  EXPECT_THAT(refusal("Scope\nCycle;2 ms\nx [mm];i [A]\n1;2\n2;3\n3;4\n"),
              HasSubstr("its head says \"Cycle: 2 ms\""));
  EXPECT_THAT(refusal("x_mm,i_A\n0,1\n1,2\n"),
              HasSubstr("has no time column; the columns are \"x_mm\", \"i_A\" (give"));
}

TEST(LogStamps, TheHeadTellsThePeriodWhereNoColumnTellsTheTime) {
  const auto period = [](const std::string& line) {
    const Log log = parse("Scope\n" + line + "\nx [mm];i [A]\n1;2\n2;3\n3;4\n");
    EXPECT_THAT(log.notes, Contains(HasSubstr("made from the head of the file"))) << line;
    return log.columns.at(0).values.at(1);
  };
  EXPECT_DOUBLE_EQ(period("Sampling cycle;1.000;msec"), 1e-3);
  EXPECT_DOUBLE_EQ(period("Sample Rate: 8 kHz"), 125e-6);
  EXPECT_DOUBLE_EQ(period("\"Sampling Time[us]\";\"1000\""), 1e-3);
  EXPECT_DOUBLE_EQ(period("Sampling rate;2.0;ms"), 2e-3);
  EXPECT_DOUBLE_EQ(period("Sampling duration;12 s\nAbtastzeit;4 ms"), 4e-3);
}

// A row that the tool left out shows in its counter alone.
TEST(LogStamps, ACounterOfRowsTellsWhichAreMissing) {
  const Log log = parse("Scope\nSample Period;2 ms\nIndex;x [mm];i [A]\n7;1;2\n8;2;3\n11;3;4\n12;3;4\n");
  EXPECT_THAT(log.columns.at(0).values, testing::Pointwise(testing::DoubleEq(), {0.0, 2e-3, 8e-3, 10e-3}));
  EXPECT_THAT(log.notes, Contains(HasSubstr("the time is \"Index\" times 0.002 s")));
  ReadOptions options;
  options.sample_time = 0.25;
  EXPECT_DOUBLE_EQ(parse("sample,x_mm\n0,1\n1,2\n4,3\n", options).columns.at(0).values.at(2), 1.0);
  // Not every number that increases counts rows.
  EXPECT_DOUBLE_EQ(parse("x_mm,f\n0,1\n2,2\n4,3\n", options).columns.at(0).values.at(2), 0.5);
}

TEST(LogStamps, ACounterMayBeThatOfTheControl) {
  ReadOptions options;
  options.machine_period = 0.25;
  for (const char* name : {"IPO_Cycle", "servo cycle", "IPO-Takt"})
    EXPECT_DOUBLE_EQ(parse(std::string(name) + ",x_mm\n0,1\n5,2\n10,3\n", options).columns.at(0).values.at(2),
                     2.5)
        << name;
  // A time between rows counts rows, and a tick may be of any clock.
  options.sample_time = 0.25;
  for (const char* name : {"IPO_Cycle", "HAL_Tick"})
    EXPECT_DOUBLE_EQ(parse(std::string(name) + ",x_mm\n0,1\n5,2\n10,3\n", options).at("t").values.at(2), 0.5)
        << name;
}

// The period of the machine file was taken, and the mass was a quarter.
TEST(LogStamps, ATimeInAnUnknownUnitIsAskedFor) {
  for (const char* name : {"Time [100ns]", "Zeit [ticks]"}) {
    const std::string text = std::string(name) + ";x [mm];i [A]\n0;1;2\n20000;2;3\n40000;3;4\n";
    ReadOptions options;
    options.machine_period = 1e-3;
    try {
      parse(text, options);
      ADD_FAILURE() << name;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("looks like the time, in a unit that is not known")) << name;
    }
    options.times_needed = false;
    EXPECT_NO_THROW(parse(text, options)) << name;
    options.times_needed = true;
    options.sample_time = 2e-3;
    EXPECT_DOUBLE_EQ(parse(text, options).at("t").values.at(1), 2e-3) << name;
  }
}

TEST(LogStamps, WordsOfTheHeadThatDivideTheSampling) {
  for (const char* line :
       {"Save every;4", "Sampling multiplier;4", "Abtastfaktor;4", "Recording interval;4", "Sample ratio;8",
        "Every;2", "Save every;4 samples", "Record every;4th", "Log every;4 cycles"}) {
    EXPECT_THAT(refusal("Scope\nSample time;250 us\n" + std::string(line) +
                        "\nx [mm];i [A];f [N]\n1;2;3\n2;3;4\n3;4;5\n"),
                HasSubstr("its head says \"Sample time: 250 us, "))
        << line;
  }
  const auto period = [](const std::string& line) {
    const Log log = parse("Scope\nSample time;2 ms\n" + line + "\nx [mm];i [A];f [N]\n1;2;3\n2;3;4\n3;4;5\n");
    return log.columns.at(0).values.at(1);
  };
  for (const char* line :
       {"Individual axis;4", "Individuelle Achse;X", "Save every;1", "Samples;500", "Recorded samples;500",
        "Sampling interval;2000", "Sampling factor;0.5", "Gear ratio;4", "Analog factor;10", "Logic ratio;5",
        "History ratio;4", "Oversampling factor;4", "Save every;1 sample"})
    EXPECT_DOUBLE_EQ(period(line), 2e-3) << line;
}

TEST(LogStamps, TorquesAndTemperaturesCalledTAreNoTime) {
  for (const char* names :
       {"T [N m],t [s],phi [rad]", "T [degC],Time [s],x [mm]", "T,Time [s],x [mm]", "T,t,x [mm]",
        "Time [N],time [s],x [mm]", "Time,t [s],x [mm]", "Time [s],t,x [mm]"}) {
    const Log log = parse(std::string(names) + "\n20,0.000,1\n21,0.001,2\n20,0.002,3\n");
    EXPECT_EQ(time_column(log), 1) << names;
  }
  std::string doubled = "t [s],x [mm],Timestamp\n";
  for (int k = 0; k < 40; ++k)
    doubled += std::to_string(k == 7 ? 6 : k) + ",1," + std::to_string(16 * k) + "\n";
  EXPECT_EQ(time_column(parse(doubled)), 0);
  EXPECT_EQ(time_column(parse("t,x [mm],Time [s]\n0,1,0\n1,2,0\n2,3,1\n")), 0);
  EXPECT_EQ(time_column(parse("T [ms],x [mm],F [N]\n0,1,2\n1,2,3\n2,3,4\n")), 0);
  EXPECT_EQ(time_column(parse("T [0.1 ms],x [mm],F [N]\n0,1,2\n1,2,3\n2,3,4\n")), 0);
  EXPECT_THAT(refusal("T [degC],x [mm],F [N]\n20,1,2\n21,2,3\n20,3,4\n"), HasSubstr("has no time column"));
}

TEST(LogStamps, TheTimeOfAFilterIsNoPeriod) {
  for (const char* line : {"Sample filter;4 ms", "Sampling window;4 ms", "Sample delay;4 ms",
                           "Abtastfenster;4 ms", "Sampling trigger;4 ms"})
    EXPECT_THAT(refusal("Scope\n" + std::string(line) + "\nx [mm];i [A];f [N]\n1;2;3\n2;3;4\n3;4;5\n"),
                HasSubstr("has no time column"))
        << line;
}

TEST(LogStamps, AHeadWithADownsamplingDoesNotTellThePeriod) {
  EXPECT_THAT(refusal("Scope\nSample time;125 us\nDownsampling;16\nx [mm];i [A]\n1;2\n2;3\n3;4\n"),
              HasSubstr("its head says \"Sample time: 125 us, Downsampling: 16\""));
  EXPECT_DOUBLE_EQ(parse("Scope\nSample time;2 ms\nDownsampling;1\nx [mm];i [A]\n1;2\n2;3\n3;4\n")
                       .columns.at(0)
                       .values.at(1),
                   2e-3);
}

TEST(LogStamps, FilesThatAreNoText) {
  EXPECT_THAT(refusal("PAR1\x15"), HasSubstr("is a Parquet file"));
  EXPECT_THAT(refusal("\x89HDF\r\n"), HasSubstr("is an HDF5 file"));
  EXPECT_THAT(refusal("MATLAB 5.0 MAT-file"), HasSubstr("arrays in Python"));
  EXPECT_THAT(refusal("<!DOCTYPE html><html></html>"), HasSubstr("is a page of HTML"));
}

// A spreadsheet writes the time of day as a share of the day behind its number.
TEST(LogStamps, DaysOfASpreadsheetAreSeen) {
  std::string text = "Time,x [mm]\n";
  for (int k = 0; k < 50; ++k) text += fmt::format("{:.12f},{}\n", 46000.5 + k * 1e-3 / 86400.0, k);
  const Log log = parse_log(text, "e.csv");
  EXPECT_EQ(log.columns[0].unit_text, "d");
  EXPECT_THAT(log.notes,
              testing::Contains(testing::Field(&Note::text, testing::HasSubstr("spreadsheets count them"))));
  // Seconds of a day, every 0.125 ms, are none.
  text = "Time,x [mm]\n";
  for (int k = 0; k < 50; ++k) text += fmt::format("{:.6f},{}\n", 46000.5 + k * 1.25e-4, k);
  EXPECT_NE(parse_log(text, "s.csv").columns[0].unit_text, "d");
}

// pandas numbers a second column of a name: it was left out, and the force belonged to the times of the position.
TEST(LogStamps, ASecondTimeThatPandasNumbered) {
  std::string twice = "Time (s),x (mm),Time (s),F (N)\n", numbered = "Time (s),x (mm),Time (s).1,F (N)\n";
  for (int k = 0; k < 300; ++k) {
    const std::string row = std::to_string(0.001 * k) + "," + std::to_string(k) + "," +
                            std::to_string(0.001 * k + 0.0355) + "," + std::to_string(2 * k) + "\n";
    twice += row, numbered += row;
  }
  const Log a = parse(twice), b = parse(numbered);
  ASSERT_EQ(a.columns.size(), b.columns.size());
  for (std::size_t c = 0; c < a.columns.size(); ++c) {
    EXPECT_EQ(a.columns[c].name, b.columns[c].name);
    EXPECT_EQ(a.columns[c].unit_text, b.columns[c].unit_text);
    EXPECT_EQ(a.columns[c].values, b.columns[c].values);
  }
  // A second torque keeps its number, and has its unit.
  const Log torques = parse("t (s),M (Nm),M (Nm).1\n0,1,2\n1,2,3\n2,3,4\n");
  EXPECT_EQ(torques.columns[2].name, "M.1");
  EXPECT_EQ(torques.columns[2].unit_text, torques.columns[1].unit_text);
  // Without units the unit of the second one is not known, and that is said.
  EXPECT_THAT([] { parse("Time,x [mm],Time.1,F [N]\n0,1,0.5,2\n1,2,1.5,3\n2,3,2.5,4\n"); },
              ThrowsMessage<InputError>(HasSubstr("hold different times")));
}

}  // namespace
}  // namespace stribeck::io::log_stamps_test
