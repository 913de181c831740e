#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <stribeck/ident/drive/steady_rows.hpp>

namespace stribeck::ident::drive::steady_rows_test {
namespace {

constexpr double kStep = 1e-3;
constexpr double kExclude = 1e-4;

/// One stretch with the speed of a formula.
log::Motion motion(const std::function<double(double)>& speed, double time) {
  log::Motion m;
  m.sample_time = kStep;
  double x = 0.0;
  for (double t = 0.0; t < time; t += kStep) {
    m.x.push_back(x), m.v.push_back(speed(t)), m.a.push_back(0.0);
    m.direction.push_back(1), m.stretch.push_back(0), m.distance.push_back(x);
    x += kStep * speed(t + 0.5 * kStep);
  }
  return m;
}

std::size_t count(const std::vector<std::uint8_t>& steady) {
  return std::accumulate(steady.begin(), steady.end(), std::size_t{0});
}

/// Up to a speed within 0.1 s, kept until 2 s.
double jog(double t) { return 1e-3 * std::min(1.0, t / 0.1); }

TEST(SteadyRows, AJogIsSteadyAfterItsStart) {
  const log::Motion m = motion(jog, 2.0);
  const std::vector<std::uint8_t> steady = steady_rows(m, kExclude);
  EXPECT_GT(count(steady), m.rows() * 85 / 100);
  for (std::size_t k = 0; k < 45; ++k) EXPECT_EQ(steady[k], 0) << k;  // below half of the speed
}

TEST(SteadyRows, NoiseOfTheSpeedDoesNotMatterUpToAThird) {
  const log::Motion m =
      motion([](double t) { return jog(t) * (1.0 + 0.3 * std::sin(2.0 * M_PI * 170.0 * t)); }, 2.0);
  EXPECT_GT(count(steady_rows(m, kExclude)), m.rows() * 85 / 100);
}

// It stops for 40 ms of each 100 ms; slips are longer and shorter than the travel in which friction settles.
TEST(SteadyRows, AnAxisThatSticksAndSlipsIsNot) {
  for (const double speed : {0.5e-3, 5e-3, 20e-3}) {
    const log::Motion m = motion(
        [&](double t) {
          const double phase = std::fmod(t, 0.1) / 0.06;
          return phase < 1.0 ? speed * 1.5 * std::sin(M_PI * phase) : 0.0;
        },
        2.0);
    EXPECT_EQ(count(steady_rows(m, kExclude)), 0u) << speed;
  }
}

TEST(SteadyRows, NeitherIsASpeedThatChangesAllTheTime) {
  EXPECT_EQ(count(steady_rows(motion([](double t) { return 1e-4 * std::exp(4.0 * t); }, 2.0), kExclude)), 0u);
}

TEST(SteadyRows, TwoSpeedsWithoutAReversalBetweenThemAreBothSteady) {
  const log::Motion m = motion([](double t) { return t < 2.0 ? 1e-3 : 2e-3; }, 3.0);
  EXPECT_GT(count(steady_rows(m, kExclude)), m.rows() * 90 / 100);
}

TEST(SteadyRows, NoTravelNoSteadyRows) {
  EXPECT_EQ(count(steady_rows(motion([](double) { return 0.0; }, 1.0), kExclude)), 0u);
  EXPECT_EQ(count(steady_rows(motion(jog, 1.0), 0.0)), 0u);
  EXPECT_TRUE(steady_rows({}, kExclude).empty());
}

}  // namespace
}  // namespace stribeck::ident::drive::steady_rows_test
