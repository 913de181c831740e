#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/log/log.hpp>
#include <string>

namespace stribeck::io::split_times_test {
namespace {

using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

Log parse(const std::string& text, const ReadOptions& options = {}) {
  return parse_log(text, "log.csv", options);
}

/// 1200 rows, 2.5 ms apart, from 0.345 s behind a full second on; `row` writes the second of the log and the microseconds in it.
template <class Row>
Log table(const std::string& names, const Row& row) {
  std::string text = names + ",x [mm]\n";
  for (int k = 0; k < 1200; ++k) {
    const int us = 345000 + 2500 * k;
    text += row(us / 1000000, us % 1000000) + fmt::format(",{}\n", k);
  }
  return parse(text);
}

void expect_joined(const Log& log, const std::string& what) {
  const int at = time_column(log);
  ASSERT_GE(at, 0) << what;
  const Column& t = log.columns[static_cast<std::size_t>(at)];
  EXPECT_EQ(t.unit_text, "s") << what;
  ASSERT_EQ(t.values.size(), 1200U) << what;
  EXPECT_NEAR(t.values.back() - t.values.front(), 1199 * 2.5e-3, 1e-9) << what;
  EXPECT_NEAR(t.values[263] - t.values[261], 5e-3, 1e-9) << what;
  EXPECT_THAT(log.notes, Contains(HasSubstr("the time is the sum of columns"))) << what;
  EXPECT_THAT(log.notes, Not(Contains(HasSubstr("gap")))) << what;
}

// The seconds alone stand still, so the rows had no time.
TEST(SplitTimes, SecondsAndTheirFractionByTheWholeHeader) {
  for (const auto& [names, scale] : {std::pair{"tv_sec,tv_usec", 1},
                                     {"sec,usec", 1},
                                     {"Sekunden,Mikrosekunden", 1},
                                     {"time_s,time_us", 1},
                                     {"Time [s],Time [us]", 1},
                                     {"seconds,microseconds", 1},
                                     {"stamp.sec,stamp.us", 1}}) {
    expect_joined(
        table(names, [by = scale](int s, int us) { return fmt::format("{},{}", 1764400000 + s, us / by); }),
        names);
  }
  for (const char* names :
       {"header_stamp_sec,header_stamp_nanosec", "header_stamp_sec [s],header_stamp_nsec [ns]"})
    expect_joined(table(names, [](int s, int us) { return fmt::format("{},{}000", 1764400000 + s, us); }),
                  names);
  for (const char* names : {"Sekunden,Millisekunden", "sec,msec", "Timestamp,ms", "t,Milliseconds"})
    expect_joined(table(names, [](int s, int us) { return fmt::format("{},{}", 1764400000 + s, us / 1e3); }),
                  names);
}

TEST(SplitTimes, AClockAndItsFraction) {
  for (const char* names : {"Time,Milliseconds", "Time,ms", "Time,Time_ms", "Uhrzeit,Millisekunden",
                            "Clock,Time [ms]", "Zeit,Zeit.ms"}) {
    expect_joined(table(names, [](int s, int us) { return fmt::format("07:15:{:02},{}", 23 + s, us / 1e3); }),
                  names);
    expect_joined(table(names,
                        [](int s, int us) {
                          return s < 2 ? fmt::format("2025-11-29 23:59:{},{}", 58 + s, us / 1e3)
                                       : fmt::format("2025-11-30 00:00:{:02},{}", s - 2, us / 1e3);
                        }),
                  names);
  }
}

TEST(SplitTimes, TheSameTimeInTwoUnitsIsNoSum) {
  const auto time_at = [](const Log& log, std::size_t row) {
    const int at = time_column(log);
    const Column& t = log.columns.at(static_cast<std::size_t>(at));
    EXPECT_THAT(t.unit_text, AnyOf("s", "ms"));
    return t.values.at(row) * (t.unit_text == "s" ? 1.0 : 1e-3);
  };
  // Seconds that are rounded down, and up; the whole log in less than a second beside a clock.
  for (const int round : {0, 500, 999}) {
    std::string text = "Time [ms],Time [s],x [mm]\n";
    for (int k = 0; k < 400; ++k) text += fmt::format("{},{},{}\n", 2 * k, (2 * k + round) / 1000, k);
    EXPECT_NEAR(time_at(parse(text), 399), 0.798, 1e-9) << round;
  }
  std::string text = "Clock,Milliseconds,x [mm]\n";
  for (int k = 0; k < 400; ++k) text += fmt::format("07:15:{},{},{}\n", 23 + (2 * k + 600) / 1000, 2 * k, k);
  EXPECT_NEAR(time_at(parse(text), 399), 0.798, 1e-9);
  text = "t_s,t_ms,x [mm]\n";
  for (int k = 0; k < 400; ++k) text += fmt::format("{},{},{}\n", 2e-3 * k, 2 * k, k);
  EXPECT_NEAR(time_at(parse(text), 399), 0.798, 1e-9);
}

TEST(SplitTimes, AGivenSampleTimeIsNotUsedBesideThem) {
  ReadOptions options;
  options.sample_time = 0.25;
  const Log log = parse("tv_sec,tv_usec,x_mm\n1,0,1\n1,2000,2\n1,4000,3\n", options);
  EXPECT_NEAR(log.columns.at(0).values.at(2), 4e-3, 1e-12);
  EXPECT_THAT(log.notes, Contains(HasSubstr("the given sample time is not used")));
}

}  // namespace
}  // namespace stribeck::io::split_times_test
