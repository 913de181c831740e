#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/drive/map/map_choice.hpp>
#include <stribeck/ident/drive/periodic_choice.hpp>
#include <stribeck/ident/drive/test_synthetic_log.hpp>

namespace stribeck::ident::drive::map_choice_test {
namespace {

constexpr double kPeriod = 0.017;

/// Coulomb and viscous friction, a load and a periodic term; noise [N].
test::SyntheticLog with_screw(double noise) {
  std::mt19937_64 engine(2);
  std::normal_distribution<double> normal;
  return test::synthetic_log([&](double x, double v, double a) {
    return 250.0 * a + (v > 0.0 ? 40.0 : -40.0) + 12.0 + 900.0 * v +
           6.0 * std::sin(2.0 * kPi * x / kPeriod + 0.4) + noise * normal(engine);
  });
}

Rows rows_of(const test::SyntheticLog& s) { return gather(s.log, extent_of(s.log), {1e-3, 0.04, 0.0}, 160); }

Terms screw_of(const test::SyntheticLog& s) {
  map::PeriodicTerm term;
  term.term.period = kPeriod;
  Terms terms;
  terms.periodic.push_back(columns_of(s.log, term));
  return terms;
}

LinearFit second_pass(const test::SyntheticLog& s, const Rows& rows, const Terms& terms) {
  const LinearFit first = solve(s.log, rows, terms);
  return solve(s.log, rows, terms, &first);
}

map::StaticFit symmetric(const Rows& rows) {
  map::StaticFit start;
  start.family = map::StaticFit::Family::kSymmetric;
  start.coulomb = 20.0;
  start.viscous = 500.0;
  start.v0 = 0.01;
  start.top = {rows.grid[0].high, rows.grid[1].high};
  return start;
}

TEST(MapChoice, TheFamilyThatMadeTheForceIsChosen) {
  const test::SyntheticLog s = with_screw(1.0);
  const Rows rows = rows_of(s);
  const Terms terms = screw_of(s);
  const MapChoice choice = choose_map(s.log, rows, terms, second_pass(s, rows, terms), {});
  EXPECT_EQ(choice.map.fit.family, map::StaticFit::Family::kSymmetric);
  EXPECT_NEAR(choice.map.fit.coulomb, 40.0, 0.5);
  EXPECT_NEAR(choice.map.fit.load, 12.0, 0.3);
  EXPECT_NEAR(choice.map.held_out_rms, 1.0, 0.1);
  EXPECT_FALSE(choice.joint);
}

// Noise-free, Gauss–Newton on the sums finds everything up to what a bin is wide.
TEST(MapChoice, MapAndLinearTermsAreFittedTogether) {
  const test::SyntheticLog s = with_screw(0.0);
  const Rows rows = rows_of(s);
  const LinearFit fit = second_pass(s, rows, screw_of(s));
  const JointFit joint = fit_jointly(symmetric(rows), fit, fit.sums.blocks);
  ASSERT_TRUE(joint.good);
  EXPECT_NEAR(joint.map.coulomb, 40.0, 0.05);
  EXPECT_NEAR(joint.map.viscous, 900.0, 2.0);
  EXPECT_NEAR(joint.map.load, 12.0, 0.05);
  EXPECT_NEAR(joint.linear(0), 250.0, 0.2);
  EXPECT_NEAR(joint.linear(1), 6.0 * std::cos(0.4), 0.02);
  EXPECT_NEAR(joint.linear(2), 6.0 * std::sin(0.4), 0.02);
}

// Sums of products against a loop over the rows; the map at the mean speed of the bin, as the sums have it.
TEST(MapChoice, LossOfABlockIsThatOfItsRows) {
  const test::SyntheticLog s = with_screw(1.0);
  const Rows rows = rows_of(s);
  const Terms terms = screw_of(s);
  const LinearFit fit = second_pass(s, rows, terms);
  const JointFit joint = fit_jointly(symmetric(rows), fit, 2);
  double direct = 0.0;
  std::vector<double> c(terms.count() + 1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows.block[i] != 2) continue;
    const std::size_t side = rows.side[i];
    const BinSums t = fit.sums.of(side, 2, static_cast<std::size_t>(rows.bin[i]));
    double e = terms.fill(s.log, rows, i, c.data()) -
               map::kDirection[side] * joint.map.force(static_cast<int>(side), t.speed() / t.rows());
    for (std::size_t j = 0; j < terms.count(); ++j) e -= joint.linear(static_cast<Index>(j)) * c[j];
    direct += e * e;
  }
  EXPECT_NEAR(loss_of(joint, fit.sums, 2), direct, 1e-6 * direct);
}

// Friction that rises steeply below the slowest rows: how far, no row shows.
TEST(MapChoice, FrictionAtRestStaysNearTheLargestThatRowsShow) {
  const test::SyntheticLog s = test::synthetic_log([](double x, double v, double a) {
    const double friction = 40.0 + 900.0 * std::abs(v) + 4000.0 * std::exp(-std::abs(v) / 0.0008);
    return 250.0 * a + (v > 0.0 ? friction : -friction) + 6.0 * std::sin(2.0 * kPi * x / kPeriod + 0.4);
  });
  const Rows rows = rows_of(s);
  const LinearFit fit = second_pass(s, rows, screw_of(s));
  map::StaticFit start = symmetric(rows);
  start.family = map::StaticFit::Family::kSymmetricStribeck;
  start.exponent = map::Exponent::kOne;
  start.rise = 20.0;
  const JointFit joint = fit_jointly(start, fit, fit.sums.blocks);
  ASSERT_TRUE(joint.good);
  const double slowest = std::min(rows.grid[0].low, rows.grid[1].low);
  EXPECT_LE(joint.map.force(0, 0.0), 1.6 * joint.map.force(0, slowest));
}

// A block that is left out does not move the fit.
TEST(MapChoice, ABlockLeftOutIsNotSeen) {
  const test::SyntheticLog s = with_screw(1.0);
  const Rows rows = rows_of(s);
  LinearFit fit = second_pass(s, rows, screw_of(s));
  const JointFit before = fit_jointly(symmetric(rows), fit, 1);
  fit.sums.products[1] *= 3.0;
  for (auto& side : fit.sums.by_block) {
    const std::size_t size = side.size() / fit.sums.blocks;
    for (std::size_t j = size; j < 2 * size; ++j) side[j] *= 3.0;
  }
  const JointFit after = fit_jointly(symmetric(rows), fit, 1);
  EXPECT_EQ(before.map.coulomb, after.map.coulomb);
  EXPECT_EQ(before.linear, after.linear);
}

}  // namespace
}  // namespace stribeck::ident::drive::map_choice_test
