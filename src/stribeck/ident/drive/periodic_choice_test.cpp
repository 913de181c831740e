#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/drive/periodic_choice.hpp>
#include <stribeck/ident/drive/test_synthetic_log.hpp>

namespace stribeck::ident::drive::periodic_choice_test {
namespace {

constexpr double kPeriod = 0.017;

test::SyntheticLog with_screw(double amplitude) {
  std::mt19937_64 engine(2);
  std::normal_distribution<double> normal;
  return test::synthetic_log([&](double x, double v, double a) {
    return 250.0 * a + (v > 0.0 ? 40.0 : -40.0) + amplitude * std::sin(2.0 * kPi * x / kPeriod - 0.4) +
           normal(engine);
  });
}

struct Chosen {
  Rows rows;
  PeriodicChoice choice;
};
Chosen choose(const test::SyntheticLog& s) {
  Rows rows = gather(s.log, extent_of(s.log), {1e-3, 0.04, 0.0}, 160);
  const LinearFit first = solve(s.log, rows, {});
  const LinearFit fit = solve(s.log, rows, {}, &first);
  Notes notes;
  PeriodicChoice choice =
      choose_periodic(s.log, rows, {}, fit, choose_map(s.log, rows, {}, fit, {}), {}, notes);
  return {std::move(rows), std::move(choice)};
}

// A cogging of two thirds of the friction was left out, because one of its blocks was missed by 400 times the others.
TEST(PeriodicChoice, OneBlockThatIsMissedByFarHidesNoGain) {
  std::vector<double> without(12, 1.0), with(12, 0.02);
  without[7] = 400.0;
  EXPECT_TRUE(predicts_better(without, with, 1.0));
  // Half of the blocks gain, half lose.
  for (std::size_t k = 0; k < with.size(); k += 2) with[k] = 2.0;
  EXPECT_FALSE(predicts_better(without, with, 1.0));
  // The scatter alone.
  without.assign(12, 1.0);
  for (std::size_t k = 0; k < with.size(); ++k) with[k] = k % 2 == 0 ? 0.9 : 1.09;
  EXPECT_FALSE(predicts_better(without, with, 1.0));
}

TEST(PeriodicChoice, ATermOfTheForceIsKept) {
  const test::SyntheticLog s = with_screw(6.0);
  const Chosen c = choose(s);
  ASSERT_EQ(c.choice.terms.periodic.size(), 1u);
  EXPECT_NEAR(c.choice.terms.periodic[0].period, kPeriod, 1e-5);
  EXPECT_EQ(c.choice.terms.periodic[0].form, friction::EccentricForm::kAdditive);
  ASSERT_EQ(c.choice.fit.value.size(), 3);
  EXPECT_NEAR(std::hypot(c.choice.fit.value(1), c.choice.fit.value(2)), 6.0, 0.1);
  EXPECT_TRUE(c.choice.map.map.candidates.back().chosen);
  EXPECT_EQ(c.choice.map.map.candidates.back().name, "with 1 periodic term");
  EXPECT_FALSE(c.choice.spectrum.empty());
}

TEST(PeriodicChoice, WithoutATermNothingChanges) {
  const test::SyntheticLog s = with_screw(0.0);
  const Chosen c = choose(s);
  EXPECT_TRUE(c.choice.terms.periodic.empty());
  EXPECT_EQ(c.choice.fit.value.size(), 1);
  EXPECT_FALSE(c.choice.map.joint);
}

// On a plain sine every speed occurs at two places only: bins of speed take the even part of the term for friction, and what they leave
// does not stand out.
TEST(PeriodicChoice, ATermIsFoundOnAPlainSine) {
  for (const double period : {0.0045, 0.017, 0.048}) {
    SCOPED_TRACE(period);
    std::mt19937_64 engine(2);
    std::normal_distribution<double> normal;
    const test::SyntheticLog s = test::synthetic_log(
        [&](double x, double v, double a) {
          const double rise = 15.0 * std::exp(-std::pow(v / 0.012, 2.0));
          return 250.0 * a + (v > 0.0 ? 40.0 + rise : -40.0 - rise) + 300.0 * v +
                 6.0 * std::sin(2.0 * kPi * x / period + 1.3) + normal(engine);
        },
        0.0);
    const Chosen c = choose(s);
    ASSERT_EQ(c.choice.terms.periodic.size(), 1u);
    EXPECT_NEAR(c.choice.terms.periodic[0].period, period, 0.002 * period);
    ASSERT_TRUE(c.choice.map.joint);
    const VectorXd& value = *c.choice.map.joint;
    EXPECT_NEAR(std::hypot(value(1), value(2)), 6.0, 0.2);
    for (const double speed : {0.01, 0.03, 0.09}) {
      const double truth = 40.0 + 15.0 * std::exp(-std::pow(speed / 0.012, 2.0)) + 300.0 * speed;
      EXPECT_NEAR(c.choice.map.map.fit.force(0, speed), truth, 0.5);
      EXPECT_NEAR(c.choice.map.map.fit.force(1, speed), truth, 0.5);
    }
  }
}

// The map of few parameters beside which the search begins has no bump: only beside the chosen map the period comes right.
TEST(PeriodicChoice, ATermIsFoundBesideABumpOfFriction) {
  constexpr double kLead = 0.012;
  std::mt19937_64 engine(2);
  std::normal_distribution<double> normal;
  const auto friction = [](double speed) {
    return 40.0 + 300.0 * speed + 12.0 * std::exp(-std::pow((speed - 0.05) / 0.02, 2.0)) +
           8.0 * std::exp(-std::pow(speed / 0.003, 2.0));
  };
  const test::SyntheticLog s = test::synthetic_log(
      [&](double x, double v, double a) {
        const double d = v > 0.0 ? 1.0 : -1.0;
        return 250.0 * a + d * (friction(std::abs(v)) + 6.0 * std::sin(2.0 * kPi * x / kLead + 1.5)) +
               normal(engine);
      },
      0.0);
  const Chosen c = choose(s);
  ASSERT_EQ(c.choice.terms.periodic.size(), 1u);
  EXPECT_NEAR(c.choice.terms.periodic[0].period, kLead, 1e-4 * kLead);
  const VectorXd& value = c.choice.map.joint ? *c.choice.map.joint : c.choice.fit.value;
  EXPECT_NEAR(std::hypot(value(1), value(2)), 6.0, 0.1);
  for (const double speed : {0.01, 0.03, 0.05, 0.09}) {
    EXPECT_NEAR(c.choice.map.map.fit.force(0, speed), friction(speed), 0.2);
    EXPECT_NEAR(c.choice.map.map.fit.force(1, speed), friction(speed), 0.2);
  }
}

TEST(PeriodicChoice, ABumpOfFrictionOnAPlainSineIsNoTerm) {
  std::mt19937_64 engine(2);
  std::normal_distribution<double> normal;
  const test::SyntheticLog s = test::synthetic_log(
      [&](double, double v, double a) {
        const double bump = 10.0 * std::exp(-std::pow((std::abs(v) - 0.05) / 0.02, 2.0));
        return 250.0 * a + (v > 0.0 ? 40.0 + bump : -40.0 - bump) + 300.0 * v + normal(engine);
      },
      0.0);
  EXPECT_TRUE(choose(s).choice.terms.periodic.empty());
}

// Against a sum over a hundredth of a row: steps of a third of a period.
TEST(PeriodicChoice, ColumnsAreTheMeanOverTheTriangle) {
  const test::SyntheticLog s = with_screw(0.0);
  const std::vector<double>& x = s.log.records[0].x;
  double fastest = 0.0;
  std::size_t k = 1;
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    if (std::abs(x[i + 1] - x[i]) > fastest) fastest = std::abs(x[i + 1] - x[i]), k = i;
  }
  map::PeriodicTerm term;
  term.term.period = 3.0 * fastest;
  ASSERT_EQ(s.log.motions[0].window, 0);
  const PeriodicColumns columns = columns_of(s.log, term);
  double sum = 0.0;
  constexpr int kParts = 1000;
  for (int i = -kParts; i < kParts; ++i) {
    const double t = (i + 0.5) / kParts;
    const double place = t < 0.0 ? x[k] + t * (x[k] - x[k - 1]) : x[k] + t * (x[k + 1] - x[k]);
    sum += (1.0 - std::abs(t)) * std::sin(2.0 * kPi * place / term.term.period) / kParts;
  }
  EXPECT_NEAR(columns.sine[0][k], sum, 1e-5);
}

// The search sees the force less everything else, so the term is in it with its own amplitude.
TEST(PeriodicChoice, TheSearchSeesTheTermAlone) {
  const test::SyntheticLog s = with_screw(6.0);
  const Chosen c = choose(s);
  const map::PeriodicRows rows = rows_for_periodic(s.log, c.rows, c.choice.terms, c.choice.fit);
  ASSERT_EQ(rows.e.size(), c.rows.size());
  double square = 0.0;
  for (std::size_t i = 0; i < rows.e.size(); ++i) {
    ASSERT_EQ(rows.x[i], s.log.motions[0].x[rows.at[i]]);
    ASSERT_EQ(rows.direction[i], c.rows.side[i] == 0 ? 1 : -1);
    square += std::pow(rows.e[i] - 6.0 * std::sin(2.0 * kPi * rows.x[i] / kPeriod - 0.4), 2.0);
  }
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(rows.e.size())), 1.0, 0.05);  // the noise
}

}  // namespace
}  // namespace stribeck::ident::drive::periodic_choice_test
