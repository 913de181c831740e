#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/log/filter.hpp>

namespace stribeck::ident::log::filter_test {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::vector<double> signal() {
  std::vector<double> x;
  for (int k = 0; k < 60; ++k) x.push_back(std::sin(0.11 * k) + 0.01 * k + 0.3 * std::cos(2.1 * k));
  return x;
}

void expect_near(const std::vector<double>& got, const std::vector<double>& expected, double relative) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i)
    EXPECT_NEAR(got[i], expected[i], relative * std::abs(expected[i])) << i;
}

// Coefficients of scipy.signal.butter(4, 0.2), cheby1(3, 1.0, 0.4), cheby1(8, 0.05, 0.08), SciPy 1.10.
TEST(Filter, DesignsAgreeWithScipy) {
  const Filter b = butterworth(4, 0.2);
  expect_near(b.b,
              {0.004824343357716231, 0.019297373430864923, 0.028946060146297387, 0.019297373430864923,
               0.004824343357716231},
              1e-13);
  expect_near(b.a, {1.0, -2.3695130071820376, 2.31398841441588, -1.0546654058785676, 0.18737949236818488},
              1e-13);
  const Filter c = chebyshev_1(3, 1.0, 0.4);
  expect_near(c.b, {0.07359708992862292, 0.22079126978586877, 0.22079126978586877, 0.07359708992862292},
              1e-13);
  expect_near(c.a, {1.0, -0.9761274763400589, 0.8567617757129297, -0.2918575799438873}, 1e-13);
  const Filter d = chebyshev_1(8, 0.05, 0.08);
  expect_near(d.a,
              {1.0, -7.397720470943626, 24.072727760966973, -44.998914665983264, 52.84346676692242,
               -39.915914352468405, 18.93766580976049, -5.159179426375671, 0.6178695015203624},
              1e-12);
  // Eight equal zeros and a gain of 4e-9 from cancelling poles: digits go.
  EXPECT_NEAR(d.b[0], 3.5863243209995207e-09, 1e-8 * d.b[0]);
}

// scipy.signal.filtfilt(b, a, x, padlen=3*(n-1)), SciPy 1.10.
TEST(Filter, ForwardBackwardAgreesWithScipyToTheEnds) {
  const std::vector<double> y = forward_backward(butterworth(4, 0.2), signal());
  expect_near({y[0], y[1], y[17], y[30], y[58], y[59]},
              {0.29677469355261465, 0.29485544645081135, 1.1230881941444977, 0.1423400698676869,
               0.6339827009128459, 0.7298562368918928},
              1e-11);
}

// scipy.signal.filtfilt(*cheby1(8, 0.05, 0.08), x, padlen=24)[9::10], SciPy 1.10: samples counted back from
// the end.
TEST(Filter, DecimationAgreesWithScipy) {
  expect_near(decimate(signal(), 10),
              {0.8797162310390396, 1.0584779528104724, 0.26161389892040765, -0.5865463757227294,
               -0.14240136563873435, 0.5116478844763864},
              1e-6);
}

// 2 Hz in rows of 62.5 us: at once, a filter of order 8 at 0.8/160 of the rate is not a number. What is slow
// loses 0.1 dB by the ripple of the filter, however many steps there are.
TEST(Filter, LargeFactorsKeepTheirDigits) {
  std::vector<double> x;
  for (int k = 0; k < 40000; ++k) x.push_back(std::sin(4.0 * kPi * 62.5e-6 * k));
  for (const std::size_t factor : {160UL, 169UL, 77UL}) {
    const std::vector<double> y = decimate(x, factor);
    ASSERT_EQ(y.size(), (x.size() - 1) / factor + 1);
    for (std::size_t i = 20; i + 20 < y.size(); ++i)
      EXPECT_NEAR(y[i], x[x.size() - 1 - (y.size() - 1 - i) * factor], 0.015) << factor << " " << i;
  }
  EXPECT_EQ(decimation_up_to(7), 7u);
  EXPECT_EQ(decimation_up_to(160), 160u);
  EXPECT_EQ(decimation_up_to(17), 16u);
  EXPECT_EQ(decimation_up_to(163), 162u);
}

TEST(Filter, AStraightLinePassesUnchanged) {
  std::vector<double> line;
  for (int k = 0; k < 80; ++k) line.push_back(3.0 - 0.25 * k);
  const std::vector<double> y = forward_backward(butterworth(3, 0.15), line);
  // Odd extension continues the line; what is left is the start of the filter at the far end of the
  // extension.
  for (std::size_t k = 10; k < 70; ++k) EXPECT_NEAR(y[k], line[k], 0.05);
  for (std::size_t k = 30; k < 50; ++k) EXPECT_NEAR(y[k], line[k], 1e-4);
}

TEST(Filter, ReversedTimeGivesReversedOutputOfASymmetricFilterPair) {
  std::vector<double> x = signal();
  const std::vector<double> forward = forward_backward(butterworth(2, 0.3), x);
  std::reverse(x.begin(), x.end());
  std::vector<double> backward = forward_backward(butterworth(2, 0.3), x);
  std::reverse(backward.begin(), backward.end());
  for (std::size_t k = 25; k < 35; ++k) EXPECT_NEAR(forward[k], backward[k], 1e-6);
}

TEST(Filter, RefusesWhatItCannotDo) {
  EXPECT_THAT([&] { butterworth(0, 0.2); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("order must be at least 1")));
  EXPECT_THAT([&] { butterworth(4, 1.0); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("must lie between 0 and 1")));
  EXPECT_THAT([&] { chebyshev_1(4, 0.0, 0.2); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("ripple must be positive")));
  EXPECT_THAT([&] { forward_backward(butterworth(4, 0.2), std::vector<double>(12, 1.0)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("too short for forward-backward filtering")));
}

}  // namespace
}  // namespace stribeck::ident::log::filter_test
