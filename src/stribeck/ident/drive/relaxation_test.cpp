#include <gtest/gtest.h>

#include <cmath>

#include <stribeck/ident/drive/relaxation.hpp>
#include <stribeck/ident/drive/rows.hpp>
#include <stribeck/ident/drive/test_synthetic_log.hpp>

namespace stribeck::ident::drive::relaxation_test {
namespace {

constexpr double kLevel = 40.0, kMass = 250.0, kStiffness = 8e4;  // g/σ0 = 0.5 mm

/// Dahl friction in closed form: from −g at the reversal, F = g·(1 − 2·exp(−σ0·s/g)) against the motion.
test::SyntheticLog dahl_log() {
  test::SyntheticLog s = test::synthetic_log([](double, double, double a) { return kMass * a; });
  log::Motion& m = s.log.motions[0];
  for (std::size_t k = 0; k < m.rows(); ++k) {
    const double settled = m.stretch[k] == 0 ? 0.0 : 2.0 * std::exp(-kStiffness * m.distance[k] / kLevel);
    m.f[k] += m.direction[k] * kLevel * (1.0 - settled);
  }
  return s;
}

Level level() {
  Level l;
  for (auto& curve : l.curve) {
    const map::Grid grid{0.0, 0.2, 8};
    const std::vector<double> n(8, 1.0), force(8, kLevel);
    curve.build(grid, n, {0.0125, 0.0375, 0.0625, 0.0875, 0.1125, 0.1375, 0.1625, 0.1875}, force);
  }
  return l;
}

TEST(Relaxation, FindsTheStiffnessOfDahlFriction) {
  const test::SyntheticLog s = dahl_log();
  const Relaxation r = find_relaxation(s.log.motions, level(), kMass, 0.0, 5e-3);
  EXPECT_NEAR(r.sigma0, kStiffness, 0.05 * kStiffness);
  EXPECT_NEAR(r.length, kLevel / r.sigma0, 1e-12);
}

TEST(Relaxation, WithoutAReversalThereIsNone) {
  test::SyntheticLog s = dahl_log();
  s.log.motions[0].reversals.clear();
  const Relaxation r = find_relaxation(s.log.motions, level(), kMass, 0.0, 5e-3);
  EXPECT_EQ(r.length, 0.0);
  EXPECT_TRUE(std::isinf(r.sigma0));
}

// What friction lags behind its level is what the closed form says, once the first reversal has passed.
TEST(Relaxation, TheLagIsThatOfTheClosedForm) {
  const test::SyntheticLog s = dahl_log();
  const log::Motion& m = s.log.motions[0];
  Rows rows = gather(s.log, extent_of(s.log), {1e-4, 0.04, 0.0}, 160);
  find_lag(s.log.motions, level(), {kStiffness, kLevel / kStiffness}, rows);
  double largest = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t k = rows.at[i];
    if (m.stretch[k] == 0) continue;
    // Where the stretch before was too short to settle, the closed form does not hold.
    const std::size_t reversal = m.reversals[static_cast<std::size_t>(m.stretch[k]) - 1];
    if (m.distance[reversal - 1] < 10.0 * kLevel / kStiffness) continue;
    const double lag = -m.direction[k] * kLevel * 2.0 * std::exp(-kStiffness * m.distance[k] / kLevel);
    ASSERT_NEAR(rows.lag[i], lag, 0.02 * kLevel) << k;
    largest = std::max(largest, std::abs(lag));
  }
  EXPECT_GT(largest, 0.5 * kLevel);  // the test has seen a lag
}

}  // namespace
}  // namespace stribeck::ident::drive::relaxation_test
