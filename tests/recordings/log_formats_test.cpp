#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <string>
#include <tests/recordings/recording.hpp>
#include <vector>

namespace stribeck::test::log_formats_test {
namespace {

using io::Log;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

/// First and last value of a column of `n` samples.
void expect_column(const Log& log, const std::string& name, const std::string& unit, std::size_t n,
                   double first, double last) {
  const io::Column& c = log.at(name);
  EXPECT_EQ(c.unit_text, unit) << name;
  ASSERT_EQ(c.values.size(), n) << name;
  EXPECT_DOUBLE_EQ(c.values.front(), first) << name;
  EXPECT_DOUBLE_EQ(c.values.back(), last) << name;
}

const io::Column& time_of(const Log& log, const std::string& name) {
  const int t = log.at(name).time;
  return log.columns.at(static_cast<std::size_t>(t < 0 ? io::time_column(log) : t));
}

TEST(LogFormats, TncScope) {
  STRIBECK_RECORDING(path, "tum_feed_axis/FeedStep150_N0_H55.sco");
  const Log log = io::read_log(path);
  EXPECT_EQ(log.format, "TNCscope");
  EXPECT_EQ(log.columns.size(), 6u);
  expect_column(log, "t", "us", 6848, 0.0, 20.541e6);
  expect_column(log, "v ist/Y", "mm/min", 6848, 0.29296875, 0.0);
  expect_column(log, "v soll/Y", "mm/min", 6848, 0.0, 0.0);
  expect_column(log, "s ist/Y", "mm", 6848, 400.0, 400.0);
  expect_column(log, "s soll/Y", "mm", 6848, 400.0, 400.0);
  expect_column(log, "I ist/Y", "A", 6848, 3.815, 0.031);
  EXPECT_TRUE(io::check_time(log.at("t").values).regular());
  EXPECT_THAT(log.metadata,
              testing::IsSupersetOf({Pair("CONTROL", "iTNC530"), Pair("sample time", "3000 us"),
                                     Pair("I ist/Y CYCLETIME", "100"), Pair("I ist/Y AXISTYPE", "Y")}));
  EXPECT_THAT(log.notes, testing::ElementsAre(HasSubstr("own cycle is 100 us")));

  // The same rows, written by another reader.
  STRIBECK_RECORDING(copy, "tum_feed_axis/tum_N0.csv");
  const Log other = io::read_log(copy);
  ASSERT_EQ(other.rows, 6848u);
  for (std::size_t k = 0; k < 6848; ++k) {
    ASSERT_NEAR(log.at("s ist/Y").values[k], other.at("pos_act").values[k], 5.1e-5);  // printed with 0.1 um
    ASSERT_NEAR(log.at("I ist/Y").values[k], other.at("current_abs").values[k], 1e-9);
  }
}

TEST(LogFormats, TwinCat) {
  for (const char* name : {"tab_decimalcomma", "tab_eof", "semicolon_decimalpoint", "comma_decimalpoint"}) {
    STRIBECK_RECORDING(path, std::string("log_formats/twincat_scope_") + name + ".csv");
    const Log log = io::read_log(path);
    EXPECT_EQ(log.format, "TwinCAT Scope");
    EXPECT_EQ(log.rows, 4996u) << name;
    ASSERT_EQ(log.columns.size(), 24u) << name;
    expect_column(log, "func_OS", "", 4996, 0.0, 999.0);
    expect_column(log, "var_REAL64", "", 1000, 0.0, 999.0);
    expect_column(log, "var_INT8", "", 1000, 0.0, -25.0);
    expect_column(log, "func_units_scaled", "dV", 1000, 10.0, -9980.0);
    expect_column(log, "func_units_unscaled", "V", 1000, 0.0, 999.0);
    expect_column(log, "test_special([{\xC3\xA4\xC3\xB6\xC3\xBC!?\xC3\x9F$\xC2\xB2}])", "", 1000, 0.0, 999.0);
    expect_column(log, "test space (1)", "", 1000, 0.0, 999.0);
    expect_column(log, "func_freesample", "", 201, 997.0, 997.0);
    EXPECT_EQ(time_of(log, "func_OS").values.at(1), 0.2) << name;
    EXPECT_EQ(time_of(log, "var_BIT").values.at(1), 1.0);
    EXPECT_EQ(time_of(log, "func_freesample").values.front(), -3.0);
    EXPECT_EQ(time_of(log, "func_freesample").values.at(1), 2.0);
    EXPECT_EQ(time_of(log, "func_OS").unit_text, "ms");
    EXPECT_THAT(log.notes, Contains(HasSubstr("3 different sampling times")));
    EXPECT_THAT(log.notes, Contains(HasSubstr("scale factors and offsets of \"func_scaled_int\"")));
    EXPECT_THAT(log.metadata, Contains(Pair("func_OS SymbolName", "MAIN.var_REAL_OS")));
  }
  STRIBECK_RECORDING(path, "log_formats/twincat_scope_tab_noOS.csv");
  const Log log = io::read_log(path);
  ASSERT_EQ(log.columns.size(), 20u);  // 19 channels with equal times
  EXPECT_EQ(log.rows, 1000u);
  expect_column(log, "t", "ms", 1000, 0.0, 999.0);
  expect_column(log, "var_UINT8", "", 1000, 0.0, 231.0);
  EXPECT_EQ(log.at("var_UINT8").time, -1);
}

TEST(LogFormats, SinumerikCapture) {
  STRIBECK_RECORDING(path, "siemens_edge_capture/capture_840Dsl.json");
  const Log log = io::read_log(path);
  EXPECT_EQ(log.format, "SINUMERIK Edge JSON");
  EXPECT_EQ(log.columns.size(), 62u);  // 61 signals and the time made of CYCLE
  expect_column(log, "t", "ms", 3818, 0.0, 15352.0);
  expect_column(log, "CYCLE", "1", 3818, 5558098.0, 5565774.0);
  expect_column(log, "ENC_POS|2", "mm", 3818, 910.000049, 910.00001);
  expect_column(log, "VEL_FFW|3", "mm/s", 3818, -4200.0, -4200.05);
  expect_column(log, "CURRENT|2", "A", 3818, -16.185791, -14.719482);
  expect_column(log, "TORQUE|2", "", 3818, -22.353412, -20.308373);
  EXPECT_EQ(log.at("ENC_POS|5").unit_text, "deg");
  const auto time = io::check_time(log.at("t").values);
  EXPECT_EQ(time.sample_time, 2.0);
  ASSERT_EQ(time.gaps.size(), 1u);
  EXPECT_EQ(time.gaps[0].row, 1495u);
  EXPECT_EQ(time.gaps[0].duration, 7720.0);
  EXPECT_THAT(log.notes,
              Contains(HasSubstr("from 5559591 to 5563451 after row 1494: 3859 samples (7.718 s)")));
  EXPECT_THAT(log.metadata, testing::IsSupersetOf(
                                {Pair("axis 1", "X1"), Pair("axis 6", "SP1"), Pair("sample time", "2 ms")}));

  STRIBECK_RECORDING(copy, "siemens_edge_capture/hf_xyz.csv");
  const Log flat = io::read_log(copy);
  EXPECT_EQ(flat.format, "SINUMERIK Edge CSV");
  for (const auto& c : flat.columns) {
    if (c.name == "t") continue;
    ASSERT_EQ(c.values.size(), 3818u);
    EXPECT_EQ(c.unit_text, log.at(c.name).unit_text) << c.name;
    for (std::size_t k = 0; k < 3818; ++k) {
      const double value = log.at(c.name).values[k];
      ASSERT_NEAR(c.values[k], value, 5e-7 + 5e-9 * std::abs(value)) << c.name << k;  // printed with 9 digits
    }
  }
}

TEST(LogFormats, EposStudio) {
  STRIBECK_RECORDING(path, "log_formats/maxon_epos_studio_recorder.csv");
  const Log log = io::read_log(path);
  EXPECT_EQ(log.format, "EPOS Studio");
  expect_column(log, "t", "ms", 500, 0.0, 6387.2);
  expect_column(log, "Velocity actual value averaged", "rpm", 500, -101.0, -101.0);
  expect_column(log, "Torque actual value averaged", "%", 500, -24.1, -28.3);
  EXPECT_THAT(log.metadata,
              testing::IsSupersetOf({Pair("Date", "2020-07-08 21:13:16"), Pair("sample time", "12.800 ms")}));
  EXPECT_THAT(log.notes, IsEmpty());
}

TEST(LogFormats, MrConfigurator) {
  STRIBECK_RECORDING(path, "log_formats/mitsubishi_mr_configurator2.csv");
  const Log log = io::read_log(path);
  EXPECT_EQ(log.format, "MR Configurator2");
  EXPECT_EQ(log.columns.size(), 5u);
  expect_column(log, "t", "ms", 1024, 0.0, 681.999318);
  expect_column(log, "Servo motor speed", "rpm", 1024, 0.0, 0.0);
  expect_column(log, "Torque", "%", 1024, -1.0, -1.8);
  expect_column(log, "Droop pulses", "count", 1024, -11.0, -4.0);
  expect_column(log, "INP", "", 1024, 2.5, 2.5);
  EXPECT_NEAR(io::check_time(log.at("t").values).sample_time, 0.666666, 1e-9);
}

TEST(LogFormats, NiDaq) {
  STRIBECK_RECORDING(path, "log_formats/ni_daqexpress_force.csv");
  const Log log = io::read_log(path);
  EXPECT_EQ(log.format, "NI DAQ");
  EXPECT_EQ(log.columns.size(), 3u);  // both channels have the same times
  expect_column(log, "t", "s", 1078, 0.0, 0.5385);
  expect_column(log, "Force", "V", 1078, -0.12917863583060313, -0.15511707445115688);
  expect_column(log, "Input 1", "V", 1078, -3.2159208831317652, 5.3305758855363266);
}

TEST(LogFormats, TablesOfManyRuns) {
  STRIBECK_RECORDING(path, "screw_drives/screw_drives.csv");
  const Log log = io::read_log(path);
  EXPECT_EQ(log.rows, 29500u);
  const auto& test = log.at("test").texts;
  ASSERT_EQ(test.size(), 29500u);
  EXPECT_EQ(test.front(), "steady");
  EXPECT_EQ(test.back(), "startstop");
  expect_column(log, "torque", "%", 29500, 32.8, 0.0);
  EXPECT_THAT(log.notes, Contains(HasSubstr("row 501: time goes back")));

  STRIBECK_RECORDING(arm, "dd_arm/const_velocity.csv");
  const Log runs = io::read_log(arm);
  EXPECT_EQ(runs.rows, 39554u);
  auto names = runs.at("run").texts;
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  EXPECT_EQ(names.size(), 54u);
}

TEST(LogFormats, NoTimeColumn) {
  STRIBECK_RECORDING(path, "umich_cnc_mill/experiment_01.csv");
  try {
    io::read_log(path);
    FAIL() << "a log without times was accepted";
  } catch (const io::InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("experiment_01.csv: has no time column"));
  }
  io::ReadOptions options;
  options.sample_time = 0.1;
  const Log log = io::read_log(path, options);
  EXPECT_EQ(log.rows, 1055u);
  expect_column(log, "X1_ActualPosition", "", 1055, 198.0, 141.0);
  EXPECT_NEAR(log.at("t").values.back(), 105.4, 1e-9);
  EXPECT_EQ(log.at("Machining_Process").texts.back(), "end");
}

TEST(LogFormats, Csv) {
  STRIBECK_RECORDING(path, "ubc_feed_axis/ubc_trial3_x.csv");
  const Log log = io::read_log(path);
  EXPECT_EQ(log.rows, 58500u);
  expect_column(log, "pos_act", "mm", 58500, -19.9999, -20.0);
  expect_column(log, "current_ref", "A", 58500, -0.388, -0.426);
  EXPECT_THAT(log.notes, IsEmpty());
}

}  // namespace
}  // namespace stribeck::test::log_formats_test
