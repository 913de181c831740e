#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include <stribeck/workflow/log/fingerprint.hpp>

namespace stribeck::workflow::fingerprint_test {
namespace {

struct Rows {
  std::vector<double> x, f;
};

/// A stroke there and back in steps of 1 µm, with noise of the force in steps of 0.1 N.
Rows recording(std::uint64_t seed, std::size_t n = 4000) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0.0, 2.0);
  Rows out;
  for (std::size_t k = 0; k < n; ++k) {
    const double phase = 2.0 * 3.14159265358979 * static_cast<double>(k) / 2000.0;
    out.x.push_back(1e-6 * std::round(2e4 * std::sin(phase)));
    out.f.push_back(0.1 * std::round(10.0 * (std::copysign(50.0, std::cos(phase)) + normal(engine))));
  }
  return out;
}

Fingerprint of(const Rows& rows) {
  Fingerprint out;
  out.add(rows.x, rows.f);
  return out;
}

TEST(Fingerprint, ACopyAndAPartLieWithinTheRecording) {
  const Rows whole = recording(1);
  Rows part;
  part.x.assign(whole.x.begin() + 777, whole.x.begin() + 3000);
  part.f.assign(whole.f.begin() + 777, whole.f.begin() + 3000);
  EXPECT_TRUE(of(whole).within(of(whole)));
  EXPECT_TRUE(of(part).within(of(whole)));
  EXPECT_FALSE(of(whole).within(of(part)));
}

TEST(Fingerprint, TheSameMotionRecordedAgainIsNoCopy) {
  const Fingerprint first = of(recording(1));
  EXPECT_GT(first.size(), 100U);
  EXPECT_FALSE(of(recording(2)).within(first));
}

// At rest every log holds the same rows.
TEST(Fingerprint, RowsAtRestSayNothing) {
  const Rows rest{std::vector<double>(4000, 0.125), std::vector<double>(4000, 7.0)};
  EXPECT_EQ(of(rest).size(), 0U);
  EXPECT_FALSE(of(rest).within(of(rest)));
}

TEST(Fingerprint, ACopyIsFoundInAnyOrder) {
  const Rows whole = recording(1);
  Rows part, less;
  part.x.assign(whole.x.begin() + 777, whole.x.begin() + 3000);
  part.f.assign(whole.f.begin() + 777, whole.f.begin() + 3000);
  less.x.assign(whole.x.begin() + 900, whole.x.begin() + 2900);
  less.f.assign(whole.f.begin() + 900, whole.f.begin() + 2900);
  using Holders = std::vector<std::optional<std::size_t>>;
  const std::optional<std::size_t> none;
  EXPECT_EQ(holders_of({of(whole), of(recording(2)), of(part)}), (Holders{none, none, 0}));
  EXPECT_EQ(holders_of({of(less), of(part), of(recording(2)), of(whole)}), (Holders{3, 3, none, none}));
  EXPECT_EQ(holders_of({of(whole), of(whole)}), (Holders{none, 0}));
  // Nearly all is enough: of three cuts each one may hold the next.
  const auto first = [&](std::ptrdiff_t rows) {
    Rows cut;
    cut.x.assign(whole.x.begin(), whole.x.begin() + rows);
    cut.f.assign(whole.f.begin(), whole.f.begin() + rows);
    return of(cut);
  };
  EXPECT_EQ(holders_of({first(3440), first(3720), of(whole)}), (Holders{2, 2, none}));
}

}  // namespace
}  // namespace stribeck::workflow::fingerprint_test
