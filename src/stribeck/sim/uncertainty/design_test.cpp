#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <set>
#include <stribeck/sim/uncertainty/design.hpp>
#include <vector>

namespace stribeck::sim::design_test {
namespace {

std::uint64_t digits(double share) { return static_cast<std::uint64_t>(share * 0x1p52); }

// The first points as printed (Bratley and Fox 1988; Joe and Kuo's file new-joe-kuo-6): the random shift falls out of the difference.
TEST(Design, SobolBeginsAsPrinted) {
  const Design design(Sampling::kSobol, 16, 3, 7);
  const std::vector<std::array<double, 3>> printed{
      {0.5, 0.5, 0.5},       {0.75, 0.25, 0.25},    {0.25, 0.75, 0.75},   {0.375, 0.375, 0.625},
      {0.875, 0.875, 0.125}, {0.625, 0.125, 0.875}, {0.125, 0.625, 0.375}};
  for (std::size_t n = 1; n <= printed.size(); ++n) {
    for (std::size_t d = 0; d < 3; ++d) {
      const std::uint64_t x = digits(design.share(n, d)) ^ digits(design.share(0, d));
      EXPECT_EQ(static_cast<double>(x) * 0x1p-52, printed[n - 1][d]) << n << ", " << d;
    }
  }
}

// Of 2^m points, every dimension has one in each of 2^m equal parts, and any two of the first dimensions fill the square evenly.
TEST(Design, SobolFillsEveryDimensionEvenly) {
  constexpr std::size_t kDimensions = 64;
  constexpr std::uint64_t kPoints = 4096;
  for (const std::uint64_t seed : {1U, 2U}) {
    const Design design(Sampling::kSobol, kPoints, kDimensions, seed);
    for (std::size_t d = 0; d < kDimensions; ++d) {
      std::set<int> parts;
      for (std::uint64_t n = 0; n < kPoints; ++n)
        parts.insert(static_cast<int>(design.share(n, d) * static_cast<double>(kPoints)));
      EXPECT_EQ(parts.size(), kPoints) << d;
    }
    std::array<int, 64> cells{};
    for (std::uint64_t n = 0; n < 64; ++n)
      ++cells[static_cast<std::size_t>(design.share(n, 0) * 8) * 8 +
              static_cast<std::size_t>(design.share(n, 1) * 8)];
    for (const int in_cell : cells) EXPECT_EQ(in_cell, 1);
  }
}

TEST(Design, LatinHypercubeHasOneInEachPart) {
  for (const std::uint64_t samples : {1U, 2U, 7U, 64U, 1000U, 4097U}) {
    const Design design(Sampling::kLatinHypercube, samples, 5, 3);
    for (std::size_t d = 0; d < 5; ++d) {
      std::set<int> parts;
      for (std::uint64_t n = 0; n < samples; ++n)
        parts.insert(static_cast<int>(design.share(n, d) * static_cast<double>(samples)));
      EXPECT_EQ(parts.size(), samples) << d;
      EXPECT_EQ(*parts.rbegin(), static_cast<int>(samples) - 1);
    }
  }
}

// Correlation of two dimensions of N points: standard deviation 1/√N = 0.01; six of them.
TEST(Design, DimensionsAreIndependent) {
  constexpr std::uint64_t kSamples = 10000;
  for (const Sampling sampling : {Sampling::kRandom, Sampling::kLatinHypercube, Sampling::kSobol}) {
    const Design design(sampling, kSamples, 4, 11);
    for (std::size_t a = 0; a < 4; ++a) {
      double mean = 0.0;
      double square = 0.0;
      for (std::uint64_t n = 0; n < kSamples; ++n) {
        const double x = design.share(n, a);
        ASSERT_GT(x, 0.0);
        ASSERT_LT(x, 1.0);
        mean += x / kSamples;
        square += (x - 0.5) * (x - 0.5) / kSamples;
      }
      EXPECT_NEAR(mean, 0.5, 0.02);
      EXPECT_NEAR(square, 1.0 / 12.0, 0.01);
      for (std::size_t b = 0; b < a; ++b) {
        double product = 0.0;
        for (std::uint64_t n = 0; n < kSamples; ++n)
          product += 12.0 * (design.share(n, a) - 0.5) * (design.share(n, b) - 0.5) / kSamples;
        EXPECT_NEAR(product, 0.0, 0.06) << enum_name(sampling) << " " << a << " " << b;
      }
    }
  }
}

TEST(Design, SeedsDiffer) {
  for (const Sampling sampling : {Sampling::kRandom, Sampling::kLatinHypercube, Sampling::kSobol}) {
    EXPECT_NE(Design(sampling, 100, 2, 1).share(5, 1), Design(sampling, 100, 2, 2).share(5, 1));
    EXPECT_EQ(Design(sampling, 100, 2, 1).share(5, 1), Design(sampling, 100, 2, 1).share(5, 1));
  }
  // A random design does not change with the number of samples: a longer study begins like a shorter one.
  EXPECT_EQ(Design(Sampling::kRandom, 10, 2, 1).share(5, 1), Design(Sampling::kRandom, 99, 2, 1).share(5, 1));
  EXPECT_EQ(Design(Sampling::kSobol, 10, 2, 1).share(5, 1), Design(Sampling::kSobol, 99, 2, 1).share(5, 1));
}

}  // namespace
}  // namespace stribeck::sim::design_test
