#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <stribeck/io/log/test_logs.hpp>
#include <stribeck/io/units.hpp>
#include <string>
#include <vector>

namespace stribeck::io::log_formats_test {
namespace {

using testing::ThrowsMessage;

using testing::Contains;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::Pair;
using testing::Pointwise;

ReadOptions given(std::vector<std::string> names, double sample_time) {
  ReadOptions options;
  options.names = std::move(names);
  if (sample_time > 0.0) options.sample_time = sample_time;
  return options;
}

std::string refusal(std::string_view text, const ReadOptions& options = {}) {
  try {
    static_cast<void>(parse_log(text, "log.txt", options));
    return "accepted";
  } catch (const InputError& e) {
    return e.what();
  }
}

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

/// Most samples say the same in their own ways.
const std::vector<double> kX{1.5, 2.5, 3.25, 2.75, 1.25, 0.5, 1.125, 1.875};
const std::vector<double> kF{-10.25, -11.5, -9.75, 12.5, 13.5, 11.25, -12.5, -10.5};

std::vector<double> seconds(const Log& log) {
  return in_si(log.columns.at(static_cast<std::size_t>(time_column(log))), quantity("s", "s"));
}

TEST(LogFormats, Csv) {
  const Log log = parse_log(test::csv_sample(), "a.csv");
  EXPECT_EQ(log.format, "CSV");
  EXPECT_EQ(log.rows, 8u);
  EXPECT_EQ(log.at("x").values, kX);
  EXPECT_EQ(log.at("f").values, kF);
  EXPECT_THAT(log.at("phase").texts, ElementsAre("start", "run", "run", "run", "run", "run", "run", "end"));
  EXPECT_THAT(log.at("phase").values, IsEmpty());
  EXPECT_THAT(log.notes, IsEmpty());

  const Log comma = parse_log(test::csv_decimal_comma_sample(), "b.csv");
  EXPECT_THAT(in_si(comma.at("x"), quantity("m", "m")).front(), DoubleNear(10.5e-6, 1e-18));
  EXPECT_THAT(comma.notes, IsEmpty());
}

TEST(LogFormats, TextColumns) {
  const auto log = [](const char* text) { return parse_log(text, "a.csv"); };
  const Log quoted = log("t_s,run\n0,\"a, b\"\n1,\"c \"\"d\"\"\"\n2,\n3,1\n");
  EXPECT_THAT(quoted.at("run").texts, ElementsAre("a, b", "c \"d\"", "", "1"));
  const Log back = parse_log(csv_text(quoted), "b.csv");
  EXPECT_EQ(back.at("run").texts, quoted.at("run").texts);
  EXPECT_EQ(back.at("t").values, quoted.at("t").values);
  // One damaged cell in the first row would turn a column of numbers into text.
  EXPECT_THAT(refusal("t_s,x\n0,1x5\n1,2\n2,3\n3,4\n"),
              HasSubstr("row 1, column \"x\": got \"1x5\", expected a number"));
  EXPECT_THAT(refusal("t_s,x\n0,1\n1,2\n2,a\n3,4\n"), HasSubstr("log.txt:4: row 3, column \"x\""));
  EXPECT_THAT(refusal("a,b\nx,y\nx,y\nx,y\n"), HasSubstr("no column of numbers"));
}

TEST(LogFormats, TimeThatIsMissing) {
  EXPECT_THAT(refusal(test::untimed_sample()), HasSubstr("has no time column"));
  EXPECT_THAT(refusal(test::untimed_sample()),
              AllOf(HasSubstr("--sample-time"), HasSubstr("sample_time = \"1 ms\" into log.txt.toml")));
  const Log log = parse_log(test::untimed_sample(), "a.csv", given({}, 0.1));
  EXPECT_EQ(log.columns[0].name, "t");
  EXPECT_NEAR(seconds(log).back(), 0.7, 1e-15);
  EXPECT_EQ(log.at("X1_ActualPosition").values.front(), 198.0);
  EXPECT_THAT(log.notes, Contains(HasSubstr("made from the given sample time of 0.1 s")));

  ReadOptions named;
  named.time_column = "stamp";
  EXPECT_EQ(parse_log("stamp,x\n0,1\n1,2\n2,3\n", "a", named).columns.size(), 2u);
  named.time_column = "none";
  EXPECT_THAT(refusal("stamp,x\n0,1\n1,2\n2,3\n", named), HasSubstr("no column \"none\""));
  // A table of several runs is no error, but said.
  EXPECT_THAT(parse_log("t_s,x\n0,1\n1,2\n0,3\n1,4\n", "a").notes,
              Contains(HasSubstr("row 3: time goes back")));
}

TEST(LogFormats, NamesInPlaceOfAHeader) {
  const Log log = parse_log(test::untimed_sample(), "a.csv", given({"x mm", "i A", "phase"}, 0.1));
  EXPECT_EQ(log.at("x").unit_text, "mm");
  EXPECT_EQ(log.at("i").unit_text, "A");
  EXPECT_EQ(log.rows, 8u);
  EXPECT_THAT(log.notes, Contains(HasSubstr("the given names of the columns replace those in line 1")));
}

TEST(LogFormats, TncScope) {
  const Log log = parse_log(test::tncscope_sample(), "a.sco");
  EXPECT_EQ(log.format, "TNCscope");
  ASSERT_EQ(log.columns.size(), 4u);
  EXPECT_THAT(seconds(log),
              Pointwise(DoubleNear(1e-15), {0.0, 0.003, 0.006, 0.009, 0.012, 0.015, 0.018, 0.021}));
  EXPECT_EQ(log.at("s ist/Y").unit_text, "mm");
  EXPECT_EQ(log.at("v ist/Y").unit_text, "mm/min");
  EXPECT_EQ(log.at("I ist/Y").unit_text, "A");
  EXPECT_EQ(log.at("v ist/Y").values.at(4), -10.5);
  EXPECT_THAT(log.metadata, testing::IsSupersetOf({Pair("CONTROL", "iTNC530"), Pair("s ist/Y AXISTYPE", "Y"),
                                                   Pair("sample time", "3000 us")}));
  EXPECT_THAT(log.notes, IsEmpty());

  EXPECT_THAT(parse_log(replaced(test::tncscope_sample(), "%COUNT=8", "%COUNT=9"), "a").notes,
              Contains(HasSubstr("says 9 samples, the file has 8")));
  EXPECT_THAT(parse_log(replaced(test::tncscope_sample(), "1.450000000e+001", "9.450000000e+001"), "a").notes,
              Contains(HasSubstr("leave the range of the header")));
  EXPECT_THAT(parse_log(replaced(test::tncscope_sample(), "%CYCLETIME=3000", "%CYCLETIME=100"), "a").notes,
              Contains(HasSubstr("own cycle is 100 us")));
  EXPECT_THAT(parse_log(replaced(test::tncscope_sample(), "mm\r", "furlong/moon\r"), "a").notes,
              Contains(HasSubstr("unit \"furlong/moon\" is not known")));
  EXPECT_THAT(refusal(replaced(test::tncscope_sample(), "%COLUMN=2", "%COLUMN=1")),
              HasSubstr("%COLUMN=1 stands twice"));
  EXPECT_THAT(refusal(replaced(test::tncscope_sample(), "1.450000000e+001", "1.45O")),
              HasSubstr("row 4, column \"s ist/Y\": got \"1.45O\", expected a number"));
}

TEST(LogFormats, TwinCatInAllItsSeparators) {
  for (const char s : {'\t', ';', ',', ' ', ':'}) {
    for (const char decimal : {'.', ','}) {
      if (s == ',' && decimal == ',') continue;
      std::string text = test::twincat_sample(s, decimal);
      if (s == ' ') {
        // The variant with blanks quotes texts.
        for (const char* words :
             {"Starttime of export", "Endtime of export", "act pos", "temp (1)", "Unit ScaleFactor",
              "Unit Offset", "V (Voltage)", "mm (Position)", "Dienstag, 5. M\xC3\xA4rz"}) {
          for (auto at = text.find(words); at != std::string::npos;
               at = text.find(words, at + std::string_view(words).size() + 2)) {
            text.replace(at, std::string_view(words).size(), "\"" + std::string(words) + "\"");
          }
        }
      }
      const Log log = parse_log(text, "a.csv");
      EXPECT_EQ(log.format, "TwinCAT Scope") << text;
      ASSERT_EQ(log.columns.size(), 5u) << text;
      EXPECT_EQ(log.rows, 8u);
      EXPECT_EQ(log.at("act pos").values, kX) << text;
      EXPECT_EQ(log.at("act pos").unit_text, "mm");
      EXPECT_EQ(log.at("act pos").time, 0);
      EXPECT_THAT(log.at("torque").values, ElementsAre(10, 12, -3, -7, -9, -8, 4, 9));
      EXPECT_THAT(log.at("temp (1)").values, ElementsAre(20.5, 20.25, 20.75, 21.5));
      EXPECT_EQ(log.at("temp (1)").time, 3);
      EXPECT_EQ(log.at("temp (1)").unit_text, "V");
      EXPECT_THAT(log.columns[3].values, ElementsAre(0, 2, 4, 6));
      EXPECT_EQ(log.columns[3].unit_text, "ms");
      EXPECT_THAT(log.notes, ElementsAre(HasSubstr("2 different sampling times"))) << text;
    }
  }
}

TEST(LogFormats, TwinCatTraps) {
  const std::string good = test::twincat_sample();
  // The sample time in the header follows the locale, the data do not.
  const std::string locale =
      replaced(replaced(test::twincat_sample(','), "SampleTime[ms],1,1", "SampleTime[ms],1,0,1,0"),
               "SampleTime[ms],2", "SampleTime[ms],2,0");
  EXPECT_EQ(parse_log(locale, "a").at("act pos").values, kX);
  EXPECT_EQ(parse_log(good + "EOF\n", "a").rows, 8u);
  EXPECT_THAT(refusal(good + "EOF\n8\t1\t1\n"), HasSubstr("goes on behind its EOF"));
  EXPECT_THAT(refusal(test::twincat_sample(',', ',')), HasSubstr("export it with tabs"));
  EXPECT_THAT(refusal(replaced(good, "2.75", "2,75")), HasSubstr("with a decimal point, as in other cells"));
  EXPECT_THAT(refusal(replaced(good, "5\t0.5\t-8", "5\t0.5")), HasSubstr("end inside a group"));
  EXPECT_THAT(refusal(replaced(good, "5\t0.5\t-8", "\t0.5\t-8")), HasSubstr("without a time"));
  EXPECT_THAT(refusal(replaced(good, "act pos", "act\tpos")), HasSubstr("is the separator part of a name"));
  // Shorter than its own start and end say.
  EXPECT_THAT(parse_log(good.substr(0, good.find("5\t0.5")), "a").notes,
              Contains(HasSubstr("\"act pos\" ends at 4 ms of 7 ms of the export")));
  EXPECT_THAT(parse_log(replaced(good, "ScaleFactor\t1", "ScaleFactor\t10"), "a").notes,
              Contains(HasSubstr("scale factors and offsets of \"act pos\"")));
  // Absent samples give a channel times of its own.
  const Log absent = parse_log(replaced(good, "2.75\t-7", "2.75\tNaN"), "a");
  EXPECT_EQ(absent.at("torque").values.size(), 7u);
  EXPECT_THAT(absent.columns.at(static_cast<std::size_t>(absent.at("torque").time)).values,
              ElementsAre(0, 1, 2, 4, 5, 6, 7));
  EXPECT_THAT(absent.notes, Contains(HasSubstr("1 of 8 samples are absent")));
  // One time column for each channel: equal ones are one.
  const Log single = parse_log(
      "Name\tx\nStarttime of export\t10\t\t\nEndtime of export\t20010\t\t\n\n\n"
      "Name\ta\tName\tb\nData-Type\tBIT\tData-Type\tBIT\n\n0\tTrue\t0\t2\n1\tFalse\t1\t3\n2\tTrue\t2\t4\n",
      "a");
  EXPECT_EQ(single.columns.size(), 3u);
  EXPECT_EQ(single.at("b").time, -1);
  EXPECT_THAT(single.at("a").values, ElementsAre(1, 0, 1));
  // Absolute times of 100 ns are beyond what a double resolves.
  const Log absolute = parse_log(
      "Name\tx\nStarttime of export\t133000000000000000\nEndtime of export\t133000000000000020\n\n\n"
      "Name\ta\n\n133000000000000000\t1\n133000000000000010\t2\n133000000000000020\t3\n",
      "a");
  EXPECT_THAT(absolute.columns[0].values, Pointwise(DoubleNear(1e-15), {0.0, 0.001, 0.002}));
}

TEST(LogFormats, EposStudio) {
  const Log log = parse_log(test::epos_sample(), "a.csv");
  EXPECT_EQ(log.format, "EPOS Studio");
  EXPECT_THAT(seconds(log),
              Pointwise(DoubleNear(1e-12), {0.0, 0.0128, 0.0256, 0.0384, 0.0512, 0.064, 0.0768, 0.0896}));
  EXPECT_EQ(log.at("Velocity actual value averaged").unit_text, "rpm");
  EXPECT_EQ(log.at("Torque actual value averaged").unit_text, "%");
  EXPECT_EQ(log.at("Torque actual value averaged").values.at(4), 31.0);
  EXPECT_THAT(log.metadata, Contains(Pair("Date", "2024-03-05 10:00:00")));
  EXPECT_THAT(log.notes, IsEmpty());

  const Log resaved = parse_log(test::epos_resaved_sample(), "a.csv");
  EXPECT_EQ(resaved.at("Torque actual value averaged").values.at(1), -400.0);
  EXPECT_THAT(resaved.notes, ElementsAre(HasSubstr("row 2 (line 10) carries the remark \"was -24.8\"")));
  auto a = resaved.columns;
  a[2].values[1] = -24.8;
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(a[c].values, log.columns[c].values);
  EXPECT_THAT(parse_log(replaced(test::epos_sample(), "period:;12.8", "period:;6.4"), "a").notes,
              Contains(HasSubstr("12.8 ms apart, the header says 6.400 ms")));
}

TEST(LogFormats, MrConfigurator) {
  const Log log = parse_log(test::mr_sample(), "a.csv");
  EXPECT_EQ(log.format, "MR Configurator2");
  ASSERT_EQ(log.columns.size(), 5u);  // two were not selected
  EXPECT_EQ(log.at("Servo motor speed").unit_text, "rpm");
  EXPECT_EQ(log.at("Torque").unit_text, "%");
  // The name carries the scale.
  EXPECT_NEAR(in_si(log.at("Droop pulses"), pure_number()).front(), -1100.0, 1e-9);
  EXPECT_EQ(log.at("INP").unit_text, "");
  EXPECT_NEAR(seconds(log).back(), 4.666662e-3, 1e-15);  // 0.667 ms is rounded
  EXPECT_THAT(log.notes, ElementsAre(HasSubstr("units are not in the file"),
                                     HasSubstr("2 channels that were not selected")));
}

TEST(LogFormats, NiDaq) {
  const Log log = parse_log(test::ni_sample(), "a.csv");
  EXPECT_EQ(log.format, "NI DAQ");
  EXPECT_EQ(log.at("Force").values.size(), 8u);
  EXPECT_EQ(log.at("Input 1").values.size(), 4u);
  EXPECT_EQ(log.at("Input 1").unit_text, "V");
  EXPECT_THAT(log.columns.at(static_cast<std::size_t>(log.at("Input 1").time)).values,
              ElementsAre(0, 0.001, 0.002, 0.003));
  EXPECT_THAT([&] { csv_text(log); },
              ThrowsMessage<InputError>(HasSubstr("samples, expected")));  // no common table
  EXPECT_THAT(refusal(replaced(test::ni_sample(), "0.001,-3.22", ",-3.22")),
              HasSubstr("got a value without a time"));
  EXPECT_THAT(parse_log(replaced(test::ni_sample(), "Interval,0.0005", "Interval,0.005"), "a").notes,
              Contains(HasSubstr("0.0005 apart, the header says 0.005")));
}

TEST(LogFormats, UnitsInCapitals) {
  const Log log = parse_log(
      "TIME [SEC],POS [MM],VEL [MM/MIN],TRQ [NM],CUR [AMPS],TABLE [DEG],DRIVE_RPM,AXIS (M),Torque Actual (0.1%)\n"
      "0,1,2,3,4,5,6,7,1\n0.1,2,3,4,5,6,7,8,2\n0.2,3,4,5,6,7,8,9,3\n",
      "a.csv");
  std::vector<std::string> units;
  for (const Column& c : log.columns) units.push_back(c.unit_text);
  EXPECT_THAT(units, ElementsAre("s", "mm", "mm/min", "N m", "A", "deg", "rpm", testing::Ne("m"), "0.1 %"));
  EXPECT_THAT(log.notes, testing::Not(Contains(HasSubstr("is not known"))));
}

TEST(LogFormats, HalSampler) {
  const std::vector<std::string> pins{"x mm", "f [N]", "in-position"};
  const Log log = parse_log(test::halsampler_sample(), "a.log", given(pins, 1e-3));
  EXPECT_EQ(log.format, "LinuxCNC halsampler");
  EXPECT_EQ(log.at("x").values, kX);
  EXPECT_EQ(log.at("f").values, kF);
  EXPECT_EQ(log.at("f").unit_text, "N");
  EXPECT_EQ(log.at("in-position").unit_text, "");
  // The overrun left no step in the numbers: one sample is missing at least. 5 → 9: three.
  EXPECT_THAT(seconds(log), Pointwise(DoubleNear(1e-15), {0.0, 1e-3, 2e-3, 4e-3, 5e-3, 6e-3, 10e-3, 11e-3}));
  EXPECT_THAT(log.notes,
              Contains(HasSubstr("overrun before row 4: samples were lost, how many is not in the file")));
  EXPECT_THAT(log.notes, Contains(HasSubstr("the sample number jumps before row 7: 3 samples are missing")));
  EXPECT_THAT(log.notes, Contains(HasSubstr("2 gaps")));
  EXPECT_EQ(check_time(seconds(log)).gaps.size(), 2u);

  std::string untagged = "overrun\n";
  for (std::size_t i = 0; i < kX.size(); ++i) {
    if (i == 3) untagged += "overrun\noverrun\n";
    untagged += std::to_string(kX[i]) + " " + std::to_string(kF[i]) + " 1 \n";
  }
  const Log bare = parse_log(untagged, "a.log", given(pins, 1e-3));
  EXPECT_EQ(bare.at("x").values, kX);
  ASSERT_EQ(check_time(seconds(bare)).gaps.size(), 1u);
  EXPECT_EQ(check_time(seconds(bare)).gaps[0].row, 4u);

  EXPECT_THAT(refusal(untagged), HasSubstr("halsampler write log.txt.toml with columns ="));
  EXPECT_THAT(refusal(untagged, given(pins, 0.0)),
              HasSubstr("has no time (give the period of the sampling thread with --sample-time"));
  EXPECT_THAT(refusal(untagged, given({"x mm"}, 1e-3)), HasSubstr("got 3 columns, expected 1 as named"));
  EXPECT_THAT(refusal(test::halsampler_sample() + "2 1 1 1 \n", given(pins, 1e-3)),
              HasSubstr("goes from 10 to 2"));
}

TEST(LogFormats, SinumerikCapture) {
  const Log log = parse_log(test::sinumerik_json_sample(), "a.json");
  EXPECT_EQ(log.format, "SINUMERIK Edge JSON");
  EXPECT_EQ(log.at("ENC_POS|1").values, kX);
  EXPECT_EQ(log.at("CURRENT|1").values, kF);
  EXPECT_EQ(log.at("ENC_POS|1").unit_text, "mm");
  EXPECT_EQ(log.at("ENC_POS|4").unit_text, "deg");
  EXPECT_EQ(log.at("CURRENT|1").unit_text, "A");
  EXPECT_THAT(seconds(log), Pointwise(DoubleNear(1e-15), {0.0, 2e-3, 4e-3, 6e-3, 0.1, 0.102, 0.104, 0.106}));
  EXPECT_THAT(log.metadata,
              testing::IsSupersetOf({Pair("axis 1", "X1"), Pair("axis 4", "C1"), Pair("MachineName", "rig_7"),
                                     Pair("sample time", "2 ms")}));
  EXPECT_THAT(log.notes,
              Contains(HasSubstr(
                  "CYCLE jumps once, first from 103 to 150 after row 4: 46 samples (0.092 s) are missing")));
  EXPECT_THAT(log.notes, Contains(HasSubstr("units are not in the file")));

  EXPECT_THAT(refusal(replaced(test::sinumerik_json_sample(), "0.5,11.25,89.5", "0.5,null,89.5")),
              HasSubstr("log.txt:19: row 6 of HFData, column \"CURRENT|1\": got null, expected a number"));
  EXPECT_THAT(refusal(replaced(test::sinumerik_json_sample(), "0.5,11.25,89.5", "0.5,89.5")),
              HasSubstr("log.txt:19: row 6 of HFData: got 3 values, expected 4"));
  EXPECT_THAT(refusal(test::sinumerik_json_sample().substr(0, 900)), HasSubstr("is cut off"));
  EXPECT_THAT(refusal(replaced(test::sinumerik_json_sample(), "[103,", "[103;")),
              HasSubstr("is not valid JSON near byte"));
  EXPECT_THAT(refusal(replaced(test::sinumerik_json_sample(), "\"CycleTimeMs\" : 2,", "")),
              HasSubstr("no CycleTimeMs"));
  EXPECT_EQ(seconds(parse_log(replaced(test::sinumerik_json_sample(), "\"CycleTimeMs\" : 2,", ""), "a",
                              given({}, 2e-3))),
            seconds(log));

  for (const auto& [axis, unit] : {std::pair{"MC1", "deg"},
                                   {"MSP1", "deg"},
                                   {"SP1", "deg"},
                                   {"S2", "deg"},
                                   {"B", "deg"},
                                   {"c1", "deg"},
                                   {"MX1", "mm"},
                                   {"MZ2", "mm"},
                                   {"Z", "mm"},
                                   {"XM1", "mm"},
                                   {"", "mm"},
                                   {"AX1", ""},
                                   {"Gantry", ""}}) {
    const Log other = parse_log(
        replaced(test::sinumerik_json_sample(), "\"C1\"", "\"" + std::string(axis) + "\""), "a.json");
    EXPECT_EQ(other.at("ENC_POS|4").unit_text, unit) << axis;
    EXPECT_EQ(std::count_if(other.notes.begin(), other.notes.end(),
                            [](const Note& n) { return n.text.find("does not say whether") != n.text.npos; }),
              *unit == 0 ? 1 : 0)
        << axis;
  }

  const Log flat = parse_log(test::sinumerik_csv_sample(), "a.csv", given({}, 2e-3));
  EXPECT_EQ(flat.format, "SINUMERIK Edge CSV");
  EXPECT_EQ(flat.at("ENC_POS|1").unit_text, "mm");
  EXPECT_THAT(seconds(flat), Pointwise(DoubleNear(1e-15), seconds(log)));
  EXPECT_THAT(refusal(test::sinumerik_csv_sample()), HasSubstr("only the counter CYCLE"));
}

TEST(LogFormats, SinumerikTrace) {
  const Log log = parse_log(test::sinumerik_trace_sample(), "a.xml");
  EXPECT_EQ(log.format, "SINUMERIK trace");
  const Column& current = log.at("Current i(q)");
  EXPECT_EQ(current.header, "/Nck/current [u1, 1]");
  EXPECT_EQ(current.unit_text, "A");
  // Recorded on change: held where a rec leaves it out, and where the rec itself is left out (8 ms).
  EXPECT_THAT(current.values, ElementsAre(-1.25, -1.5, -1.5, 2.25, 2.25, 2.5, -1.75, -1.5));
  EXPECT_THAT(log.at("Brake").values, ElementsAre(0, 0, 1, 1, 1, 1, 1, 1));
  // Recorded in a slower cycle: no sample in between.
  const Column& position = log.at("Position <1>");
  EXPECT_THAT(position.values, ElementsAre(10.5, 11.5, 11.25, 10.75));
  EXPECT_THAT(log.columns.at(static_cast<std::size_t>(position.time)).values,
              ElementsAre(0.002, 0.006, 0.010, 0.014));
  EXPECT_EQ(log.columns.at(static_cast<std::size_t>(current.time)).values.size(), 8u);
  EXPECT_THAT(log.notes, Contains(HasSubstr("recorded on change")));
  EXPECT_THAT(log.metadata, Contains(Pair("startTime", "2024-03-05T10:00:00Z")));

  // Neither fits: what is missing is absent.
  const Log other = parse_log(
      replaced(test::sinumerik_trace_sample(), "datapointCount=\"8\"", "datapointCount=\"11\""), "a");
  EXPECT_EQ(other.at("Current i(q)").values.size(), 6u);
  EXPECT_THAT(other.notes, Contains(HasSubstr("11 samples are stated, 6 are there")));

  EXPECT_THAT(refusal(replaced(test::sinumerik_trace_sample(), "f1=\"2.5", "f7=\"2.5")),
              HasSubstr("rec 5 has \"f7\", which no dataSignal names"));
  EXPECT_THAT(refusal(replaced(test::sinumerik_trace_sample(), "2.500000", "2.5x")),
              HasSubstr("log.txt:20: rec 5, signal \"/Nck/current [u1, 1]\": got \"2.5x\""));
  EXPECT_THAT(refusal(test::sinumerik_trace_sample().substr(0, 1100)), HasSubstr("is cut off or damaged"));
  EXPECT_THAT(refusal(replaced(test::sinumerik_trace_sample(), "<rec ", "<rec <")),
              HasSubstr("is not valid XML"));
}

// Only the results in it are known: refused with the way out, and never at the cost of memory.
TEST(LogFormats, RenishawBallBarIsToldTheWayOut) {
  const std::string plane = "<?xml version=\"1.0\"?>\n<A><B><PLANE TEST_PLANE=\"XY\"/></B></A>";
  const std::string result = "<A><FEATURE NAME=\"AF_CIRCULARITY\" DT=\"UT_LENGTH_UM\">8.1</FEATURE></A>";
  for (const std::string& text : {plane, result})
    EXPECT_THAT(refusal(text), AllOf(HasSubstr(".b5r"), HasSubstr("export the samples as a table")));
  EXPECT_THAT(refusal("<A><PLANE/><FEATURE NAME=\"a\"/></A>"), HasSubstr("no SINUMERIK trace"));
  EXPECT_THAT(refusal(plane.substr(0, plane.size() - 8)), HasSubstr("is cut off or damaged"));
  EXPECT_THAT(refusal("<!DOCTYPE A [<!ENTITY a \"aa\"><!ENTITY b \"&a;&a;\">]><A>&b;</A>"),
              HasSubstr("has a document type"));
}

/// Gzip, the UTF-8 mark and other line ends change nothing.
TEST(LogFormats, PackedAndMarkedTheSame) {
  for (const auto& sample : test::sample_logs()) {
    const auto options = given(sample.names, sample.sample_time);
    const Log plain = parse_log(sample.text, "a", options);
    std::string packed(sample.text.size() + 1000, '\0');
    z_stream stream{};
    ASSERT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, 31, 8, Z_DEFAULT_STRATEGY), Z_OK);
    std::string in = sample.text;
    stream.next_in = reinterpret_cast<Bytef*>(in.data());
    stream.avail_in = static_cast<uInt>(in.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    ASSERT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    std::string other;
    for (const char c : sample.text) {
      if (c == '\r') continue;
      if (c == '\n') other += '\r';
      other += c;
    }
    std::vector<std::string> same{packed, other};
    if (sample.text[0] != '\xEF') same.push_back("\xEF\xBB\xBF" + sample.text);
    for (const auto& text : same) {
      const Log log = parse_log(text, "a", options);
      EXPECT_EQ(log.format, plain.format) << sample.name;
      EXPECT_EQ(log.notes, plain.notes) << sample.name;
      ASSERT_EQ(log.columns.size(), plain.columns.size()) << sample.name;
      for (std::size_t i = 0; i < log.columns.size(); ++i) {
        EXPECT_EQ(log.columns[i].name, plain.columns[i].name) << sample.name;
        EXPECT_EQ(log.columns[i].values, plain.columns[i].values) << sample.name;
        EXPECT_EQ(log.columns[i].texts, plain.columns[i].texts) << sample.name;
        EXPECT_EQ(log.columns[i].unit_text, plain.columns[i].unit_text) << sample.name;
      }
    }
  }
}

TEST(LogFormats, ARowThatMayBeCutIsLeftOut) {
  const Log log = parse_log("t_s,x\n0,1.5\n1,2.5\n2,3", "a");  // 3.5 before it was cut
  EXPECT_EQ(log.rows, 2u);
  EXPECT_THAT(log.notes,
              ElementsAre(HasSubstr("the last row (row 3, line 4) was left out: it has no line end")));
  EXPECT_EQ(parse_csv("t_s,x\n0,1.5\n1,2.5\n2,3", "a").rows, 3u);  // a table by hand
}

TEST(LogFormats, SideFile) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("stribeck_side_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "run.log").string();
  write_atomically(path, test::halsampler_sample());
  const auto refused = [&](const char* side) {
    write_atomically(path + ".toml", side);
    try {
      static_cast<void>(read_log(path));
      return std::string("accepted");
    } catch (const InputError& e) {
      return std::string(e.what());
    }
  };
  EXPECT_THAT([&] { read_log(path); }, ThrowsMessage<InputError>(HasSubstr("column")));
  EXPECT_EQ(refused("columns = [\"x mm\", \"f N\", \"in-position\"]\nsample_time = \"1 ms\"\n"), "accepted");
  const Log log = read_log(path);
  EXPECT_EQ(log.at("x").values, kX);
  EXPECT_EQ(log.at("x").unit_text, "mm");
  // What the caller gives goes before the side file.
  EXPECT_EQ(read_log(path, given({"y um", "f N", "z"}, 2e-3)).at("y").unit_text, "um");
  EXPECT_EQ(seconds(read_log(path, given({}, 2e-3)))[1], 2e-3);
  EXPECT_THAT(refused("columns = [\"x mm\"]\nsample_time = \"1 mm\"\n"),
              HasSubstr("run.log.toml:2: sample_time"));
  EXPECT_THAT(refused("colums = [\"x mm\"]\n"), HasSubstr("columns"));
  EXPECT_THAT(refused("sample_time = \"0 ms\"\n"), HasSubstr("above 0"));
  // The name that it had before.
  EXPECT_THAT(refused("columns = [\"x mm\"]\nperiod = \"1 ms\"\n"),
              AllOf(HasSubstr("run.log.toml:2: period"), HasSubstr("sample_time = ")));
  std::filesystem::remove_all(folder);
}

TEST(LogFormats, UnitsAsMachinesSpellThem) {
  Notes notes;
  const auto unit = [&](const char* text) { return detail::plain_unit(text, "c", notes); };
  for (const auto& [text, plain] : {std::pair{"Ampere", "A"},
                                    {"U/min", "rpm"},
                                    {"r/min", "rpm"},
                                    {"°", "deg"},
                                    {"Incr", "count"},
                                    {"(None)", ""},
                                    {"dV (Voltage)", "dV"},
                                    {"\xCE\xBCm", "µm"},
                                    {"\xB5m", "µm"},
                                    {"mm/min", "mm/min"},
                                    {"%", "%"},
                                    {"Nm", "Nm"},
                                    {"-", "1"},
                                    {" \"V\" ", "V"}}) {
    EXPECT_EQ(unit(text), plain) << text;
    EXPECT_TRUE(*plain == 0 || is_unit(plain)) << plain;
  }
  EXPECT_THAT(notes, IsEmpty());
  for (const char* peak : {"Apk", "A_pk", "A pk", "Apeak"})
    EXPECT_NEAR(unit_factor(unit(peak), "A"), 1.0 / std::sqrt(2.0), 1e-15) << peak;
  EXPECT_EQ(notes.size(), 4U);
  EXPECT_THAT(notes, testing::Each(HasSubstr("peak current, read as RMS")));
  notes.clear();
  EXPECT_EQ(unit("furlong/moon"), "");
  EXPECT_EQ(unit("10 mm"), "");
  EXPECT_THAT(notes, ElementsAre(HasSubstr("furlong/moon"), HasSubstr("10 mm")));
  EXPECT_NEAR(unit_factor("rpm", "rad/s"), 2.0 * M_PI / 60.0, 1e-15);

  EXPECT_EQ(detail::header_of("x mm"), "x [mm]");
  EXPECT_EQ(detail::header_of("x actual mm/s"), "x actual [mm/s]");
  EXPECT_EQ(detail::header_of("x [N s/mm]"), "x [N s/mm]");
  EXPECT_EQ(detail::header_of("x 0.00029296875 mm"), "x [0.00029296875 mm]");
  EXPECT_EQ(detail::header_of("x actual 1e-3 mm/s"), "x actual [1e-3 mm/s]");
  EXPECT_EQ(detail::header_of("x Inkr"), "x [Inkr]");
  EXPECT_EQ(detail::header_of("torque 0.1 %"), "torque [0.1 %]");
  EXPECT_EQ(detail::header_of("axis 2 mm"), "axis 2 [mm]");
  EXPECT_EQ(detail::header_of("x 0.5"), "x 0.5");
  EXPECT_EQ(detail::header_of("axis 1"), "axis 1");
  EXPECT_EQ(detail::header_of("in position"), "in position");
}

TEST(LogFormats, UnitsInHeadsAsToolsWriteThem) {
  const Log american = parse_log("t (s),x [cnt],torque (lb-in)\n0,1,2\n1,2,3\n2,3,4\n", "a.csv");
  EXPECT_EQ(american.columns[1].unit_text, "count");
  const Log rates = parse_log("t (s),v [cnt/sec],w [counts/100ms]\n0,1,2\n1,2,3\n2,3,4\n", "a.csv");
  EXPECT_EQ(rates.columns[1].unit_text, "count/s");
  EXPECT_EQ(rates.columns[2].unit_text, "count/s");
  EXPECT_NEAR(in_si(american.at("torque"), quantity("N m", "N m"))[0], 2.0 * 0.1129848, 1e-6);
  // Quantity over unit counts where every column is written so.
  const Log slashes = parse_log("t/ms;s_ist/mm;v/mm/s;M_ist/Nm\n0;1;2;3\n1;2;3;4\n2;3;4;5\n", "b.csv");
  EXPECT_EQ(slashes.at("s_ist").unit_text, "mm");
  EXPECT_EQ(slashes.at("v").unit_text, "mm/s");
  EXPECT_EQ(slashes.at("M_ist").unit_text, "Nm");
  EXPECT_EQ(parse_log("t_s,enc/m\n0,1\n1,2\n2,3\n", "c.csv").columns[1].name, "enc/m");
}

// A side file names the columns, the file has units below its own names: the same unit in two spellings is no contradiction.
TEST(LogFormats, OneUnitInTwoSpellings) {
  const Log log = parse_log("a;b;c\n[s];[mm];[Nm]\n0;1;2\n1;2;3\n2;3;4\n", "a.csv",
                            given({"t s", "x mm", "torque N m"}, 0.0));
  EXPECT_EQ(log.columns[2].name, "torque");
  EXPECT_DOUBLE_EQ(in_si(log.columns[2], quantity("N m", "N m"))[1], 3.0);
  EXPECT_THAT(refusal("a;b\n[s];[mm]\n0;1\n1;2\n2;3\n", given({"t s", "x um"}, 0.0)),
              HasSubstr("the row of units says \"mm\""));
}

TEST(LogFormats, EqualNames) {
  const Log log = parse_log(replaced(test::tncscope_sample(), "v ist/Y", "s ist/Y"), "a");
  EXPECT_EQ(log.columns[2].name, "s ist/Y #2");
  EXPECT_THAT(log.notes, Contains(HasSubstr("stands more than once")));
}

}  // namespace
}  // namespace stribeck::io::log_formats_test
