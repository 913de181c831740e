#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include <ceres/jet.h>

#include <stribeck/friction/gaussian.hpp>
#include <stribeck/ident/map/gaussian_fit.hpp>
#include <stribeck/ident/test_drive.hpp>

namespace stribeck::ident::map::gaussian_fit_test {
namespace {

constexpr double kTop = 9.5e-3;

Bins bins_of_table(char axis, double direction) {
  test::Drive drive;
  drive.friction = test::table_2_3(axis);
  Bins bins;
  for (int i = 5; i < 160; ++i) {
    const double u = (i + 0.5) / 160.0;
    bins.u.push_back(u);
    bins.force.push_back(direction * drive.steady(direction * u * kTop));
    bins.weight.push_back(70.0 / std::sqrt(1.02 - u * u));  // rows of a sine
  }
  return bins;
}

FitSettings settings() {
  FitSettings s;
  s.noise = 18.0;
  s.height_scale = 27000.0;
  s.slope_scale = 540.0;
  return s;
}

// Exact data of Table 2.3: three terms reach it from blind starts on all four branches. 0.2 N is what the
// pulls and a stopping rule at a ten-thousandth of the noise leave; a local minimum is off by 20 N and more.
TEST(GaussianFit, FindsAllBranchesOfTable23WithThreeTerms) {
  for (const char axis : {'x', 'y'}) {
    for (const double direction : {1.0, -1.0}) {
      const Bins bins = bins_of_table(axis, direction);
      const auto ladder = fit_ladder(bins, 4, settings());
      ASSERT_EQ(ladder.size(), 5u);
      for (std::size_t i = 0; i < bins.size(); ++i) {
        EXPECT_NEAR(ladder[3].force(bins.u[i]), bins.force[i], 0.2)
            << axis << direction << " u " << bins.u[i];
      }
    }
  }
}

// With other random starts the same optimum is reached to 0.1 % of the sum of squares of the rows, whose noise of 18 N the bins
// do not show. Only a third of the usual starts is used, so the search over the neighbours of a minimum must replace the
// others. bench/identify_bench counts 100 sets on I1.
TEST(GaussianFit, EndsAtTheSameOptimumFromOtherStarts) {
  for (const char axis : {'x', 'y'}) {
    for (const double direction : {1.0, -1.0}) {
      const Bins bins = bins_of_table(axis, direction);
      FitSettings s = settings();
      s.scattered = 32;
      double rows = 0.0;
      for (const double w : bins.weight) rows += w;
      for (unsigned set = 0; set < 25; ++set) {
        s.first_start = 1 + 32 * set;
        EXPECT_LT(fit_ladder(bins, 3, s).back().cost, 1e-3 * rows * s.noise * s.noise)
            << axis << direction << " set " << set;
      }
    }
  }
}

TEST(GaussianFit, WithoutTermsIsTheStraightLine) {
  Bins bins;
  for (int i = 1; i <= 40; ++i) {
    bins.u.push_back(i / 40.0);
    bins.force.push_back(700.0 + 900.0 * i / 40.0);
    bins.weight.push_back(1.0 + i % 3);
  }
  const auto fit = fit_ladder(bins, 0, settings()).front();
  EXPECT_NEAR(fit.eta0, 700.0, 1e-9);
  EXPECT_NEAR(fit.eta1, 900.0, 1e-9);
  EXPECT_NEAR(fit.cost, 0.0, 1e-15);
}

// The derivative in the fit against automatic derivatives of the map that compensators use.
TEST(GaussianFit, GradientIsThatOfTheFrictionMap) {
  using Jet = ceres::Jet<double, 5>;
  BranchFit fit;
  fit.eta0 = 700.0;
  fit.eta1 = 900.0;
  fit.terms = {{400.0, 0.3, 0.2}};
  friction::Gaussian<Jet> map;
  map.velocity_range = {-1.0, 1.0};
  map.positive.eta0 = Jet(700.0, 0);
  map.positive.eta1 = Jet(900.0, 1);
  map.positive.gaussians.push_back({Jet(400.0, 2), Jet(0.3, 3), Jet(0.2, 4)});
  for (const double u : {0.05, 0.3, 0.41, 0.9}) {
    double g[5];
    fit.gradient(u, g);
    const Jet f = friction::steady_force(map, Jet(u));
    EXPECT_NEAR(fit.force(u), f.a, 1e-9);
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(g[i], f.v(i), 1e-9) << "u " << u << " parameter " << i;
  }
}

// A Stribeck part of either exponent that is narrower than a hundredth of the range, seen by slow bins alone.
TEST(GaussianFit, AStribeckPartIsAsNarrowAsTheSlowestBinsShow) {
  for (const Exponent exponent : {Exponent::kOne, Exponent::kTwo}) {
    constexpr double kWidth = 0.006;
    Bins bins;
    for (double u = 0.001; u < 1.0; u *= 1.15) {
      bins.u.push_back(u);
      bins.force.push_back(
          500.0 + 300.0 * u +
          120.0 * std::exp(exponent == Exponent::kOne ? -u / kWidth : -std::pow(u / kWidth, 2.0)));
      bins.weight.push_back(100.0);
    }
    const auto fit = fit_centred(bins, settings(), exponent);
    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->exponential, exponent == Exponent::kOne);
    EXPECT_NEAR(fit->terms.front().c, kWidth, 1e-3 * kWidth);
    EXPECT_NEAR(fit->terms.front().a, 120.0, 0.1);
    EXPECT_NEAR(fit->eta0, 500.0, 0.1);
    // The other exponent does not describe it.
    const auto other =
        fit_centred(bins, settings(), exponent == Exponent::kOne ? Exponent::kTwo : Exponent::kOne);
    if (other) {
      EXPECT_GT(other->cost, 100.0 * fit->cost + 1.0);
    }
  }
}

TEST(GaussianFit, AnExponentialIsAFewGaussians) {
  const FitTerm fall{50.0, 0.0, 0.02};
  const std::vector<FitTerm> parts = as_gaussians(fall);
  EXPECT_LE(parts.size(), friction::kMaxGaussians);
  const auto sum = [&](double u) {
    double f = 0.0;
    for (const FitTerm& g : parts) f += friction::GaussianTerm<double>{g.a, g.b, g.c}.value(u);
    return f;
  };
  EXPECT_NEAR(sum(0.0), fall.a, 1e-9);
  for (double u = 0.0; u < 0.3; u += 1e-4)
    EXPECT_NEAR(sum(u), fall.a * std::exp(-u / fall.c), 0.008 * fall.a) << u;
}

TEST(GaussianFit, ScalesWithForce) {
  Bins bins = bins_of_table('y', 1.0);
  const auto a = fit_ladder(bins, 2, settings());
  for (double& f : bins.force) f *= 4.0;
  FitSettings s = settings();
  s.noise *= 4.0;
  s.height_scale *= 4.0;
  s.slope_scale *= 4.0;
  const auto b = fit_ladder(bins, 2, s);
  for (const double u : {0.1, 0.5, 0.9})
    EXPECT_NEAR(4.0 * a[2].force(u), b[2].force(u), 1e-6 * b[2].force(u));
}

TEST(GaussianFit, KeepsTheSignOfTheMotionWithinTheRange) {
  for (const char axis : {'x', 'y'}) {
    for (const double direction : {1.0, -1.0}) {
      for (const BranchFit& fit : fit_ladder(bins_of_table(axis, direction), 6, settings())) {
        for (double u = 0.0; u <= 1.0; u += 0.02) EXPECT_GT(fit.force(u) - fit.eta1 * u, 0.0);
      }
    }
  }
}

TEST(GaussianFit, StopsWhenTheBinsCarryNoMoreParameters) {
  Bins bins;
  for (int i = 1; i <= 12; ++i) {
    bins.u.push_back(i / 12.0);
    bins.force.push_back(100.0 + i);
    bins.weight.push_back(10.0);
  }
  EXPECT_EQ(fit_ladder(bins, 6, settings()).size(), 2u);
}

}  // namespace
}  // namespace stribeck::ident::map::gaussian_fit_test
