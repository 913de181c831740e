#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/bristle/bristle_path.hpp>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::bristle::bristle_path_test {
namespace {

constexpr double kPeriod = 0.001;
constexpr double kLevel = 20.0;
constexpr double kBreakAway = 20e-6;

/// Coulomb friction of 20 N and 1 kg.
friction::AxisModel known() {
  friction::AxisModel a;
  a.mass = 1.0;
  friction::Conventional<double> map;
  map.alpha0 = kLevel;
  a.friction.steady = map;
  return a;
}

/// A slow sine of position with friction that turns over as LuGre does, F = g·(1 − 2·exp(−d/δ)).
log::Record sine() {
  log::Record r;
  r.source = "sine";
  r.sample_time = kPeriod;
  r.loop = log::Loop::kClosed;
  const double amplitude = 1e-3, w = 2.0 * kPi / 2.0;
  for (int k = 0; k < 8000; ++k) {
    const double t = kPeriod * k;
    r.t.push_back(t);
    r.x.push_back(-amplitude * std::cos(w * t));
    const double half = std::floor(w * t / kPi);
    const double turn = std::fmod(half, 2.0) == 0.0 ? -amplitude : amplitude;
    const double sign = turn < 0.0 ? 1.0 : -1.0;
    const double share = half == 0.0 ? 1.0 : 1.0 - 2.0 * std::exp(-std::abs(r.x.back() - turn) / kBreakAway);
    r.f.push_back(sign * kLevel * share);
  }
  return r;
}

BristleData data_of(const log::Record& record) {
  BristleData data;
  data.motion.push_back(log::reconstruct(record));
  data.level = {kLevel, kLevel};
  data.reversals = data.motion[0].reversals.size() - 1;
  return data;
}

BristlePath cut(bool whole) {
  const log::Record record = sine();
  return cut_path({record}, data_of(record), known(), {kBreakAway, -0.5, whole});
}

TEST(BristlePath, StepsOfASampleAddUpToItsTimeAndTravel) {
  const log::Record record = sine();
  const BristlePath path = cut(false);
  ASSERT_FALSE(path.pieces.empty());
  std::size_t fine = 0;
  for (const PathPiece& piece : path.pieces) {
    for (std::size_t i = 0; i < piece.samples.size(); ++i) {
      const PathSample& sample = piece.samples[i];
      double time = 0.0, travel = 0.0, early = 0.0, late = 0.0;
      for (std::size_t j = sample.first; j < sample.first + sample.count; ++j) {
        const PathStep& step = path.steps[j];
        time += step.dt, travel += step.v * step.dt, early += step.early, late += step.late;
      }
      const std::size_t k = piece.begin + i;
      ASSERT_NEAR(time, kPeriod, 1e-15) << "row " << k;
      ASSERT_NEAR(travel, record.x[k + 1] - record.x[k], 1e-15) << "row " << k;
      // The window of a row is a triangle over its two neighbours: half of it lies on each side.
      ASSERT_NEAR(early, 0.5, 1e-12);
      ASSERT_NEAR(late, 0.5, 1e-12);
      fine += sample.count > 1 ? 1 : 0;
    }
  }
  EXPECT_GT(fine, 0U) << "no sample is fine enough to need sub-steps: the test is empty";
}

// Rows count within eight break-away distances of a reversal, before and after it.
TEST(BristlePath, RowsLieNearReversalsUnlessAllAreWanted) {
  const log::Record record = sine();
  for (const PathRow& row : cut(false).rows)
    ASSERT_GE(std::abs(record.x[row.at]), 1e-3 - 8.01 * kBreakAway) << "row " << row.at;
  // All but those that the window and the whitening reach over at both ends.
  EXPECT_GT(cut(true).rows.size(), record.x.size() - 20);
  EXPECT_LT(cut(false).rows.size(), record.x.size() / 2);
}

TEST(BristlePath, ARecordThatStartsAtAReversalHasAnUnknownStart) { EXPECT_EQ(cut(true).starts, 1); }

// An axis that stands for a minute between two motions: the rows in between tell nothing, and cost as much as all others.
TEST(BristlePath, TheMiddleOfALongRestIsLeftOut) {
  log::Record record = sine();
  const log::Record motion = record;
  constexpr std::size_t kRest = 60'000;
  const auto append = [&](double x, double f) {
    record.t.push_back(kPeriod * static_cast<double>(record.t.size()));
    record.x.push_back(x);
    record.f.push_back(f);
  };
  for (std::size_t k = 0; k < kRest; ++k) append(motion.x.back(), motion.f.back());
  for (std::size_t k = 0; k < motion.x.size(); ++k) append(motion.x[k], motion.f[k]);
  const BristlePath path = cut_path({record}, data_of(record), known(), {kBreakAway, -0.5, true});
  EXPECT_LT(path.steps.size(), 60'000U);
  EXPECT_EQ(path.starts, 2) << "the state after the rest is not known";
  for (const PathRow& row : path.rows)
    ASSERT_TRUE(row.at < motion.x.size() + 1000 || row.at + 1000 > motion.x.size() + kRest) << row.at;
  std::size_t after = 0;
  for (const PathRow& row : path.rows) after += row.at >= motion.x.size() + kRest ? 1 : 0;
  EXPECT_GT(after, motion.x.size() - 100);
}

TEST(BristlePath, GuessIsTheDistanceAtWhichFrictionCrossesZero) {
  const log::Record record = sine();
  // Rows are up to 3 µm apart near a reversal, a straight line between them errs by less than a tenth.
  EXPECT_NEAR(guess_break_away({record}, data_of(record), known()), kBreakAway, 0.1 * kBreakAway);
}

// Three boxes of 2j + 1 rows: a constant stays, a single row becomes a bell of sum one.
TEST(BristlePath, WindowKeepsAConstantAndTheSum) {
  BristlePath path;
  path.window = 2;
  const std::size_t n = 60;
  std::vector<double> out(n), work;
  const std::vector<double> one(n, 3.0);
  filter_like(path, false, n, one.data(), out.data(), work);
  for (std::size_t k = 6; k + 6 < n; ++k) EXPECT_NEAR(out[k], 3.0, 1e-12);
  std::vector<double> single(n, 0.0);
  single[30] = 1.0;
  filter_like(path, false, n, single.data(), out.data(), work);
  double sum = 0.0;
  for (std::size_t k = 6; k + 6 < n; ++k) sum += out[k];
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_NEAR(out[24], out[36], 1e-15);
  EXPECT_GT(out[30], out[29]);
}

TEST(BristlePath, WhiteningAddsTheRowsBefore) {
  BristlePath path;
  path.whitening = {-0.5, 0.25};
  const std::vector<double> column{1.0, 2.0, 4.0, 8.0};
  std::vector<double> out(4), work;
  filter_like(path, true, 4, column.data(), out.data(), work);
  EXPECT_NEAR(out[2], 4.0 - 0.5 * 2.0 + 0.25 * 1.0, 1e-15);
  EXPECT_NEAR(out[3], 8.0 - 0.5 * 4.0 + 0.25 * 2.0, 1e-15);
  filter_like(path, false, 4, column.data(), out.data(), work);
  EXPECT_EQ(out[3], 8.0);
}

// Another implementation: the Yule–Walker equations (R + 0.3·γ0·1)·c = −γ solved as a matrix.
TEST(BristlePath, WhiteningSolvesTheYuleWalkerEquations) {
  BristlePath path;
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  std::vector<double> e;
  double x = 0.0;
  for (std::size_t k = 0; k < 2000; ++k) {
    x = 0.7 * x + normal(engine);
    e.push_back(x);
    path.rows.push_back({0, k, 0, false});
  }
  const auto p = static_cast<Eigen::Index>(kMostWhitening);
  Eigen::VectorXd gamma(p + 1);
  for (Eigen::Index l = 0; l <= p; ++l) {
    double sum = 0.0;
    for (std::size_t k = static_cast<std::size_t>(l); k < e.size(); ++k)
      sum += e[k] * e[k - static_cast<std::size_t>(l)];
    gamma(l) = sum / static_cast<double>(e.size() - static_cast<std::size_t>(l));
  }
  Eigen::MatrixXd R(p, p);
  for (Eigen::Index i = 0; i < p; ++i) {
    for (Eigen::Index j = 0; j < p; ++j) R(i, j) = gamma(std::abs(i - j)) + (i == j ? 0.3 * gamma(0) : 0.0);
  }
  const Eigen::VectorXd expected = stats::solve_lu(R, -gamma.tail(p));
  const std::vector<double> c = whitening_of(path, e.data());
  ASSERT_EQ(c.size(), kMostWhitening);
  for (std::size_t i = 0; i < c.size(); ++i) EXPECT_NEAR(c[i], expected(static_cast<Eigen::Index>(i)), 1e-10);
}

}  // namespace
}  // namespace stribeck::ident::bristle::bristle_path_test
