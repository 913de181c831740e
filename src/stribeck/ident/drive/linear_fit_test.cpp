#include <gtest/gtest.h>

#include <cmath>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/drive/periodic_choice.hpp>
#include <stribeck/ident/drive/test_synthetic_log.hpp>

namespace stribeck::ident::drive::linear_fit_test {
namespace {

constexpr double kMass = 250.0, kLevel = 40.0, kViscous = 900.0, kLoad = 12.0;

double coulomb(double, double v, double a) { return kMass * a + (v > 0.0 ? kLevel : -kLevel) + kLoad; }
double viscous(double x, double v, double a) { return coulomb(x, v, a) + kViscous * v; }

Rows rows_of(const test::SyntheticLog& s) { return gather(s.log, extent_of(s.log), {1e-3, 0.04, 0.0}, 160); }

// Friction that is constant within every bin leaves nothing beside the mass: exact in the first pass.
TEST(LinearFit, FindsTheMassBesideFreeFriction) {
  const test::SyntheticLog s = test::synthetic_log(coulomb);
  const LinearFit fit = solve(s.log, rows_of(s), {});
  EXPECT_NEAR(fit.mass, kMass, 1e-9 * kMass);
  EXPECT_NEAR(fit.plain_mass, kMass, 1e-9 * kMass);
  for (const VectorXd& held : fit.held_out) EXPECT_NEAR(held(0), kMass, 1e-9 * kMass);
  for (const double f : fit.curve[0].force) EXPECT_NEAR(f, kLevel + kLoad, 1e-8);
  for (const double f : fit.curve[1].force) EXPECT_NEAR(f, kLevel - kLoad, 1e-8);
  EXPECT_EQ(fit.load, 0.0);  // friction is larger than the load: they are not told apart here
}

// The curve of the pass before takes the slope within a bin out.
TEST(LinearFit, TheSecondPassTakesTheSlopeWithinABinOut) {
  const test::SyntheticLog s = test::synthetic_log(viscous);
  const Rows rows = rows_of(s);
  const LinearFit first = solve(s.log, rows, {});
  const LinearFit second = solve(s.log, rows, {}, &first);
  EXPECT_LT(std::abs(second.mass - kMass), std::abs(first.mass - kMass) + 1e-9);
  EXPECT_NEAR(second.mass, kMass, 1e-3 * kMass);
  EXPECT_NEAR(second.curve[0].line().slope, kViscous, 1e-2 * kViscous);
}

TEST(LinearFit, ALoadAboveTheFrictionIsTakenOut) {
  const test::SyntheticLog s =
      test::synthetic_log([](double x, double v, double a) { return coulomb(x, v, a) + 100.0; });
  EXPECT_NEAR(solve(s.log, rows_of(s), {}).load, 100.0 + kLoad, 1e-8);
}

TEST(LinearFit, AKnownMassIsTakenOff) {
  const test::SyntheticLog s = test::synthetic_log(coulomb);
  const Rows rows = rows_of(s);
  Terms terms;
  terms.known_mass = kMass;
  EXPECT_EQ(terms.count(), 0u);
  const LinearFit fit = solve(s.log, rows, terms);
  EXPECT_EQ(fit.mass, kMass);
  EXPECT_EQ(fit.value.size(), 0);
  std::vector<double> columns(1);
  for (std::size_t i = 0; i < rows.size(); i += 97)
    ASSERT_NEAR(residual_of(s.log, rows, terms, fit, i, columns), 0.0, 1e-8);
}

// Every sum has a name; the names point to what was added up.
TEST(LinearFit, SumsAreThoseOfTheRows) {
  const test::SyntheticLog s = test::synthetic_log(viscous);
  const Rows rows = rows_of(s);
  const LinearFit fit = solve(s.log, rows, {});
  const std::size_t side = 1, bin = 20, block = 3;
  double count = 0, acceleration = 0, force = 0, speed = 0, in_block = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows.side[i] != side || rows.bin[i] != static_cast<int>(bin)) continue;
    const std::size_t k = rows.at[i];
    count += 1.0;
    if (rows.block[i] == block) in_block += 1.0;
    acceleration += s.log.motions[0].a[k];
    force += s.log.motions[0].f[k];
    speed += std::abs(s.log.motions[0].v[k]);
  }
  ASSERT_GT(count, 10.0);
  const BinSums sums = fit.sums.of(side, bin);
  EXPECT_EQ(sums.rows(), count);
  EXPECT_NEAR(sums.column(0), acceleration, 1e-9);
  EXPECT_NEAR(sums.mass_instrument(), acceleration, 1e-9);  // first pass
  EXPECT_NEAR(sums.force(), force, 1e-6);
  EXPECT_NEAR(sums.speed(), speed, 1e-9);
  EXPECT_EQ(fit.sums.of(side, block, bin).rows(), in_block);
}

TEST(LinearFit, APeriodicTermIsALinearOne) {
  constexpr double kPeriod = 0.013;
  test::SyntheticLog s = test::synthetic_log(coulomb);
  map::PeriodicTerm term;
  term.term.period = kPeriod;
  Terms terms;
  terms.periodic.push_back(columns_of(s.log, term));
  for (std::size_t k = 0; k < s.log.motions[0].rows(); ++k)
    s.log.motions[0].f[k] += 5.0 * terms.periodic[0].sine[0][k] - 2.0 * terms.periodic[0].cosine[0][k];
  const LinearFit fit = solve(s.log, rows_of(s), terms);
  ASSERT_EQ(fit.value.size(), 3);
  EXPECT_NEAR(fit.value(0), kMass, 1e-8 * kMass);
  EXPECT_NEAR(fit.value(1), 5.0, 1e-7);
  EXPECT_NEAR(fit.value(2), -2.0, 1e-7);
}

// An instrument that has nothing to do with the acceleration is given up.
TEST(LinearFit, AnInstrumentOfNoUseIsGivenUp) {
  test::SyntheticLog s = test::synthetic_log(coulomb);
  log::Motion& m = s.log.motions[0];
  for (std::size_t k = 0; k < m.rows(); ++k) m.instrument[k] = std::sin(2.1 * static_cast<double>(k));
  const Rows rows = rows_of(s);
  const LinearFit first = solve(s.log, rows, {});
  EXPECT_FALSE(first.mass_by_acceleration);
  const LinearFit second = solve(s.log, rows, {}, &first);
  EXPECT_TRUE(second.mass_by_acceleration);
  EXPECT_NEAR(second.mass, kMass, 1e-6 * kMass);
  EXPECT_EQ(second.multiplier.front(), 0u);
}

}  // namespace
}  // namespace stribeck::ident::drive::linear_fit_test
