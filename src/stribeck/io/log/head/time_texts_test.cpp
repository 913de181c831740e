#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/log/log.hpp>
#include <string>
#include <vector>

namespace stribeck::io::time_texts_test {
namespace {

using ::testing::DoubleNear;
using ::testing::Pointwise;

/// Times of a table with these texts.
std::vector<double> times(const std::vector<std::string>& texts, char separator = ',') {
  std::string table = std::string("Zeit") + separator + "x [mm]\n";
  for (const std::string& text : texts) table += text + separator + "1.5\n";
  const Log log = parse_log(table, "log.csv");
  const int at = time_column(log);
  if (at < 0) return {};
  EXPECT_EQ(log.columns[static_cast<std::size_t>(at)].unit_text, "s");
  return log.columns[static_cast<std::size_t>(at)].values;
}

TEST(TimeTexts, DurationsOfIec61131) {
  EXPECT_THAT(times({"T#0ms", "T#1ms", "T#2ms"}), Pointwise(DoubleNear(1e-12), {0.0, 1e-3, 2e-3}));
  EXPECT_THAT(times({"TIME#59s998ms", "TIME#1m", "TIME#1m_0s_2ms"}),
              Pointwise(DoubleNear(1e-12), {0.0, 2e-3, 4e-3}));
  EXPECT_THAT(times({"LTIME#1d2h3us500ns", "lt#1d2h1.5ms", "LT#1d2h3ms"}),
              Pointwise(DoubleNear(1e-9), {0.0, 1496.5e-6, 2996.5e-6}));
}

TEST(TimeTexts, DatesOfIec61131) {
  EXPECT_THAT(
      times({"DT#2026-11-29-07:39:57.345", "DT#2026-11-29-07:39:57.346", "DT#2026-11-29-07:39:57.347"}),
      Pointwise(DoubleNear(1e-9), {0.0, 1e-3, 2e-3}));
  EXPECT_THAT(
      times({"LDT#2026-11-29-23:59:59.998", "LDT#2026-11-30-00:00:00.000", "LDT#2026-11-30-00:00:00.002"}),
      Pointwise(DoubleNear(1e-9), {0.0, 2e-3, 4e-3}));
  EXPECT_THAT(times({"TOD#07:39:57.5", "TOD#07:39:58.5", "TOD#07:39:59.5"}),
              Pointwise(DoubleNear(1e-9), {0.0, 1.0, 2.0}));
}

TEST(TimeTexts, HoursGoOnAfterADay) {
  EXPECT_THAT(times({"25:00:00.000", "25:00:00.001", "25:00:00.002"}),
              Pointwise(DoubleNear(1e-9), {0.0, 1e-3, 2e-3}));
  EXPECT_THAT(times({"23:59:59.998", "24:00:00.000", "100:00:00.000"}),
              Pointwise(DoubleNear(1e-6), {0.0, 2e-3, 76.0 * 3600.0 + 2e-3}));
  // A clock begins again.
  EXPECT_THAT(times({"23:59:59.998", "00:00:00.000", "00:00:00.002"}),
              Pointwise(DoubleNear(1e-9), {0.0, 2e-3, 4e-3}));
}

TEST(TimeTexts, MillisecondsWithoutLeadingZeros) {
  for (const std::string mark : {";", ":"}) {
    EXPECT_THAT(times({"07:39:57" + mark + "998", "07:39:58" + mark + "5", "07:39:58" + mark + "12"}),
                Pointwise(DoubleNear(1e-9), {0.0, 7e-3, 14e-3}))
        << mark;
    // Two digits in all cells are hundredths.
    EXPECT_THAT(times({"07:39:57" + mark + "98", "07:39:57" + mark + "99", "07:39:58" + mark + "00"}),
                Pointwise(DoubleNear(1e-9), {0.0, 0.01, 0.02}))
        << mark;
  }
  const Log log = parse_log("run,x [mm]\na;5,1\nb;100,2\n", "log.csv", {.times_needed = false});
  EXPECT_EQ(log.at("run").texts.at(0), "a;5");
}

}  // namespace
}  // namespace stribeck::io::time_texts_test
