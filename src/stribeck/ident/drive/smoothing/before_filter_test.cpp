#include <gtest/gtest.h>
#include <cmath>
#include <complex>
#include <stribeck/ident/drive/smoothing/before_filter.hpp>
#include <vector>

namespace stribeck::ident::drive::before_filter_test {
namespace {

constexpr double kTurn = 2.0 * 3.14159265358979323846 / 200.0;  // of the sine, from row to row

/// A sine of amplitude 1, and what a filter of first order makes of it: its response at this frequency.
std::vector<double> sine(double time) {
  const std::complex<double> response = 1.0 / std::complex<double>(1.0, kTurn * time);
  std::vector<double> out;
  for (int k = 0; k < 1000; ++k) out.push_back((response * std::polar(1.0, kTurn * k)).real());
  return out;
}

TEST(BeforeFilter, TheForceBeforeItIsFoundAgain) {
  const std::vector<double> plain = sine(0.0);
  for (const double time : {0.7, 3.0, 12.0}) {
    const std::vector<double> found = before_filter(sine(time), time);
    ASSERT_EQ(found.size(), plain.size());
    for (std::size_t k = 20; k + 20 < plain.size(); ++k)
      ASSERT_NEAR(found[k], plain[k], 3e-3) << time << " " << k;
  }
}

TEST(BeforeFilter, NoiseHasABound) {
  for (const double time : {1.0, 4.0, 7.4, 7.6, 12.4, 20.0, 100.0}) {
    std::vector<double> impulse(1001, 0.0);
    impulse[500] = 1.0;
    double square = 0.0;
    for (const double value : before_filter(impulse, time)) square += value * value;
    EXPECT_LT(std::sqrt(square), 5.4) << time;
  }
}

TEST(BeforeFilter, ARecordKnowsWhatWasTakenOffIt) {
  log::Record record;
  record.sample_time = 2e-3;
  record.f = sine(4.0);
  take_off({8e-3, 1e-4}, record);
  EXPECT_NEAR(record.f[200], 1.0, 3e-3);
  ASSERT_TRUE(record.filter);
  EXPECT_EQ(record.filter->time, 8e-3);
  EXPECT_EQ(record.filter->half_width, 1e-4);
}

TEST(BeforeFilter, RowsWithoutAWholeLineAreSkipped) {
  log::Record record;
  record.sample_time = 1e-3;
  record.f.assign(100, 0.0);
  record.skip.assign(100, 0);
  record.skip[50] = 1;
  take_off({10e-3, 1e-4}, record);  // two rows to either side
  std::vector<std::size_t> skipped;
  for (std::size_t k = 0; k < record.skip.size(); ++k) {
    if (record.skip[k] != 0) skipped.push_back(k);
  }
  EXPECT_EQ(skipped, (std::vector<std::size_t>{0, 1, 48, 49, 50, 51, 52, 98, 99}));
}

TEST(BeforeFilter, ShortRecordsStayWhole) {
  EXPECT_TRUE(before_filter({}, 3.0).empty());
  EXPECT_EQ(before_filter(std::vector<double>{2.0}, 3.0), std::vector<double>{2.0});
  const std::vector<double> rest(5, 7.0);
  EXPECT_EQ(before_filter(rest, 50.0), rest);
}

}  // namespace
}  // namespace stribeck::ident::drive::before_filter_test
