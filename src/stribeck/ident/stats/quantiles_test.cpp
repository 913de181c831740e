#include <gtest/gtest.h>

#include <cmath>

#include <stribeck/ident/stats/quantiles.hpp>

namespace stribeck::ident::stats::quantiles_test {
namespace {

// Closed forms: with one degree of freedom t is Cauchy's distribution, tan(0.475·π); with two
// t_p = (2p − 1)·√(2/(4p(1 − p))).
TEST(Quantiles, StudentsFactorWithFewDegreesOfFreedom) {
  EXPECT_NEAR(student_factor(1.0), std::tan(0.475 * 3.14159265358979323846), 1e-9);
  EXPECT_NEAR(student_factor(2.0), 0.95 * std::sqrt(2.0 / (4.0 * 0.975 * 0.025)), 1e-9);
}

// Limit: the normal distribution's 1.959964 (any table); the next term is (z³ + z)/(4·freedom).
TEST(Quantiles, StudentsFactorGoesToThatOfTheNormalDistribution) {
  EXPECT_NEAR(student_factor(1e6), 1.959964 + (7.529 + 1.960) / 4e6, 1e-6);
}

// Closed forms: exp(−x/2) with two degrees of freedom, erfc(√(x/2)) with one.
TEST(Quantiles, TailOfChiSquared) {
  EXPECT_NEAR(chi_squared_above(5.0, 2.0), std::exp(-2.5), 1e-12);
  EXPECT_NEAR(chi_squared_above(3.0, 1.0), std::erfc(std::sqrt(1.5)), 1e-12);
  EXPECT_EQ(chi_squared_above(0.0, 4.0), 1.0);
  // F of 2 and n: (1 + 2 F/n)^(-n/2); F of 1 and 1: an arctangent.
  EXPECT_NEAR(fisher_above(3.0, 2.0, 10.0), std::pow(1.6, -5.0), 1e-12);
  EXPECT_NEAR(fisher_above(1.0, 1.0, 1.0), 0.5, 1e-12);
}

}  // namespace
}  // namespace stribeck::ident::stats::quantiles_test
