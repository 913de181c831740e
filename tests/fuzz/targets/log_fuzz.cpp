// The log readers: whatever the bytes, a log whose values are finite, or an InputError that names the file. The first byte chooses what
// the caller gives.
#include <cmath>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/io/log/test_logs.hpp>
#include <tests/fuzz/targets/log_checks.hpp>

namespace stribeck::fuzz {
namespace {

constexpr std::uint8_t kNames = 1;
constexpr std::uint8_t kSampleTime = 2;
constexpr std::uint8_t kTable = 4;

}  // namespace

std::vector<std::string> seeds() {
  std::vector<std::string> all;
  for (const auto& sample : io::test::sample_logs()) {
    const int mode = (sample.names.empty() ? 0 : kNames) | (sample.sample_time > 0.0 ? kSampleTime : 0);
    all.push_back(std::string(1, static_cast<char>(mode)) + sample.text);
  }
  return all;
}

std::vector<std::string> words() {
  return {"%TNCscopeNT data file",
          "%[CURVE1]",
          "%[DATA]",
          "%NAME=",
          "%COLUMN=",
          "%DIMENSION=",
          "%COUNT=",
          "Name",
          "Starttime of export",
          "Endtime of export",
          "Data-Type",
          "SampleTime[ms]",
          "Unit",
          "EOF",
          "Date:;",
          "EPOS Studio Version:;",
          "Recorded samples:;",
          "Axis1",
          "Number of sampling data,",
          "Time,",
          "Not selected",
          "Timestamp,",
          "Interval,",
          "Channel name,",
          "overrun",
          "\"HFData\":[[",
          "\"SignalListHFData\"",
          "\"CycleTimeMs\":",
          "\"Payload\"",
          "CYCLE",
          "ENC_POS|1",
          "<traceSession>",
          "<traceData>",
          "<dataFrame>",
          "<dataSignal id=\"",
          "datapointCount=\"",
          "interval=\"",
          "<rec time=\"",
          "<!DOCTYPE",
          "<![CDATA[",
          "&#x",
          "\xEF\xBB\xBF",
          "\x1F\x8B\x08"};
}

void one(std::string_view input) {
  const std::uint8_t mode = mode_of(input);
  try {
    if ((mode & kTable) != 0) {
      check(io::parse_csv(input, "fuzz.log", {}));
      return;
    }
    io::ReadOptions options;
    if ((mode & kNames) != 0) options.names = {"x mm", "f N", "in-position"};
    if ((mode & kSampleTime) != 0) options.sample_time = 1e-3;
    check(io::parse_log(input, "fuzz.log", options));
  } catch (const io::InputError& e) {
    check(e, "fuzz.log");
  }
}

}  // namespace stribeck::fuzz
