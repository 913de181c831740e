#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stribeck/control/observers/residual_noise.hpp>

namespace stribeck::control::residual_noise_test {
namespace {

constexpr double kPeriod = 1e-3;

/// r after so many seconds of first-order noise of standard deviation 2 and correlation from sample to sample `a`, on a bias.
double noise_of(double a, double bias, double least, double seconds) {
  const ResidualNoise law(20.0, kPeriod);
  ResidualNoise::State s;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double x = 2.0 * normal(random);
  double r = 0.0;
  for (int k = 0; k < static_cast<int>(seconds / kPeriod); ++k) {
    r = law.step(s, bias + x, 0.0, least);
    x = a * x + 2.0 * std::sqrt(1.0 - a * a) * normal(random);
  }
  return r;
}

TEST(ResidualNoise, IsTheDensityOfTheNoise) {
  // White: its variance. First order: variance·(1 + a)/(1 − a). 80 blocks: 1/√80·√3 of standard deviation, 20 %.
  EXPECT_NEAR(noise_of(0.0, 0.0, 1e-3, 100.0), 4.0, 0.4 * 4.0);
  EXPECT_NEAR(noise_of(0.95, 0.0, 1e-3, 100.0), 4.0 * 39.0, 0.4 * 4.0 * 39.0);
}

TEST(ResidualNoise, ABiasIsNoNoise) {
  EXPECT_NEAR(noise_of(0.95, 500.0, 1e-3, 100.0), noise_of(0.95, 0.0, 1e-3, 100.0), 1.0);
  const ResidualNoise law(20.0, kPeriod);
  ResidualNoise::State s;
  for (int k = 0; k < 10000; ++k) EXPECT_EQ(law.step(s, 500.0, 0.0, 3.0), 3.0);
}

TEST(ResidualNoise, IsNeverBelowWhatIsAssumed) {
  EXPECT_EQ(noise_of(0.0, 0.0, 40.0, 100.0), 40.0);
  // And begins there: a quarter of a second of twice the assumed noise is not yet believed.
  EXPECT_EQ(noise_of(0.0, 0.0, 2.0, 0.25), 2.0);
}

TEST(ResidualNoise, WhatIsToBeLearnedIsNoNoise) {
  // A residual of variance r + h = 4, of which the filter expects h = 3.
  const ResidualNoise law(20.0, kPeriod);
  ResidualNoise::State s;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double r = 0.0;
  for (int k = 0; k < 100000; ++k) r = law.step(s, 2.0 * normal(random), 3.0, 0.8);
  EXPECT_LT(r, 1.8);
}

TEST(ResidualNoise, ForgetsWithItsMemory) {
  const ResidualNoise law(20.0, kPeriod);
  ResidualNoise::State s;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double loud = 0.0;
  for (int k = 0; k < 60000; ++k) loud = law.step(s, 10.0 * normal(random), 0.0, 1.0);
  EXPECT_GT(loud, 50.0);
  double r = 0.0;
  for (int k = 0; k < 20000; ++k) r = law.step(s, 0.0, 0.0, 1.0);
  // e⁻¹ after one memory.
  EXPECT_NEAR(r / loud, std::exp(-1.0), 0.02);
}

TEST(ResidualNoise, IsTheSameInOtherUnits) {
  const ResidualNoise law(20.0, kPeriod);
  ResidualNoise::State s, t;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 5000; ++k) {
    const double e = normal(random);
    const double r = law.step(s, e, 0.5, 0.25);
    EXPECT_NEAR(law.step(t, -1e3 * e, 0.5e6, 0.25e6), 1e6 * r, 1e-6 * r * 1e6);
  }
}

TEST(ResidualNoise, WithoutResidualsItIsTheLeast) {
  const ResidualNoise noise(10.0, 1e-3);
  ResidualNoise::State s;
  for (int k = 0; k < 3000; ++k) ASSERT_EQ(noise.step(s, 0.0, 0.0, 1e-12), 1e-12) << k;
}

}  // namespace
}  // namespace stribeck::control::residual_noise_test
