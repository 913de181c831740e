#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/log/faults/test_faults.hpp>

namespace stribeck::ident::log::lost_rows_test {
namespace {

using test::kinds;
using test::strokes;
using test::texts;
using ::testing::Contains;
using ::testing::HasSubstr;

/// Rows far from both ends and from each other.
std::vector<std::size_t> places(std::size_t count, std::uint64_t seed, std::size_t rows) {
  std::mt19937_64 engine(seed);
  std::uniform_int_distribution<std::size_t> any(20, rows - 20);
  std::vector<std::size_t> out;
  while (out.size() < count) {
    const std::size_t k = any(engine);
    if (std::none_of(out.begin(), out.end(), [&](std::size_t o) { return (o > k ? o - k : k - o) < 12; }))
      out.push_back(k);
  }
  std::sort(out.rbegin(), out.rend());
  return out;
}

void erase(RawLog& log, std::size_t k) {
  for (std::vector<double>* c : {&log.x.y, &log.r.y, &log.f.y}) {
    if (!c->empty()) c->erase(c->begin() + static_cast<std::ptrdiff_t>(k));
  }
}

void repeat(RawLog& log, std::size_t k) {
  for (std::vector<double>* c : {&log.x.y, &log.r.y, &log.f.y}) {
    if (!c->empty()) c->insert(c->begin() + static_cast<std::ptrdiff_t>(k), (*c)[k]);
  }
}

/// Stamps as if nothing had happened.
void renumber(RawLog& log) {
  log.x.t.resize(log.x.y.size());
  for (std::size_t k = 0; k < log.x.t.size(); ++k) log.x.t[k] = 1e-3 * static_cast<double>(k);
}

/// Largest distance of the only record's positions from the undamaged ones.
double largest_off(const Conditioned& c, const RawLog& truth) {
  if (c.records.size() != 1 || c.records[0].x.size() != truth.x.y.size()) return INFINITY;
  double worst = 0.0;
  for (std::size_t k = 0; k < truth.x.y.size(); ++k)
    worst = std::max(worst, std::abs(c.records[0].x[k] - truth.x.y[k]));
  return worst;
}

double speed_at(const RawLog& log, std::size_t k) { return std::abs(log.x.y[k + 1] - log.x.y[k - 1]) / 2e-3; }

/// Places where a row is seen to be missing: slower ones do not matter.
std::vector<std::size_t> moving(std::vector<std::size_t> rows, const RawLog& log) {
  std::erase_if(rows, [&](std::size_t k) {
    return speed_at(log, k) < 0.02 || speed_at(log, k - 8) < 0.02 || speed_at(log, k + 8) < 0.02;
  });
  return rows;
}

TEST(LostRows, ArePutInAgain) {
  for (const bool reference : {true, false}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      const RawLog truth = strokes(seed, reference);
      RawLog log = truth;
      const std::vector<std::size_t> gone = moving(places(60, seed, log.x.y.size()), truth);
      ASSERT_GT(gone.size(), 20U);
      for (const std::size_t k : gone) erase(log, k);
      renumber(log);
      const Conditioned c = condition(log);
      EXPECT_THAT(kinds(c), ::testing::ElementsAre("lost")) << seed << "\n" << texts(c);
      EXPECT_EQ(c.findings.at(0).values.at(1), static_cast<double>(gone.size())) << seed;
      EXPECT_LT(largest_off(c, truth), 1e-6) << seed;
      EXPECT_NEAR(c.rough.mass, 100.0, 1.0) << seed;
    }
  }
}

TEST(LostRows, CoarseStampsTellTheTimeOfAllRows) {
  const RawLog truth = strokes(1, false);
  RawLog log = truth;
  for (double& t : log.x.t) t = 0.1 * std::floor(10.0 * t + 0.3 + 1e-9);
  const std::vector<std::size_t> gone = moving(places(60, 1, log.x.y.size()), truth);
  for (const std::size_t k : gone) {
    erase(log, k);
    log.x.t.erase(log.x.t.begin() + static_cast<std::ptrdiff_t>(k));
  }
  const Conditioned c = condition(log);
  EXPECT_THAT(kinds(c), ::testing::UnorderedElementsAre("rounded-time", "lost")) << texts(c);
  ASSERT_EQ(c.records.size(), 1U);
  // One row in ten thousand is what the counting leaves open; without the lost rows it would be 0.4 %.
  EXPECT_NEAR(c.records[0].sample_time, 1e-3, 2e-7);
}

TEST(LostRows, RowsWrittenTwiceAreLeftOut) {
  const RawLog truth = strokes(4, true);
  RawLog log = truth;
  const std::vector<std::size_t> again = moving(places(60, 4, log.x.y.size()), truth);
  for (const std::size_t k : again) repeat(log, k);
  renumber(log);
  const Conditioned c = condition(log);
  EXPECT_THAT(kinds(c), ::testing::ElementsAre("repeated")) << texts(c);
  EXPECT_EQ(c.findings.at(0).values.at(1), static_cast<double>(again.size()));
  EXPECT_LT(largest_off(c, truth), 1e-7);
}

TEST(LostRows, RowsNotRenewedAreMended) {
  for (const bool all : {true, false}) {
    const RawLog truth = strokes(5, true);
    RawLog log = truth;
    const std::vector<std::size_t> stale = moving(places(60, 5, log.x.y.size()), truth);
    for (const std::size_t k : stale) {
      log.x.y[k] = log.x.y[k - 1];
      if (all) log.r.y[k] = log.r.y[k - 1], log.f.y[k] = log.f.y[k - 1];
    }
    const Conditioned c = condition(log);
    EXPECT_THAT(kinds(c), ::testing::ElementsAre("stale")) << texts(c);
    EXPECT_EQ(c.findings.at(0).values.at(1), static_cast<double>(stale.size()));
    EXPECT_LT(largest_off(c, truth), 1e-6);
  }
}

TEST(LostRows, BlockIsCutThere) {
  RawLog log = strokes(6, true);
  for (std::size_t i = 0; i < 200; ++i) erase(log, 2300);
  renumber(log);
  const Conditioned c = condition(log);
  EXPECT_EQ(c.records.size(), 2U) << texts(c);
  EXPECT_THAT(kinds(c), Contains("jump"));
  EXPECT_THAT(texts(c), HasSubstr("rows are missing"));
  EXPECT_NEAR(c.rough.mass, 100.0, 1.0);
}

TEST(LostRows, PositionAndReferenceSetAnewAreFound) {
  RawLog log = strokes(7, true);
  for (std::size_t k = 2300; k < log.x.y.size(); ++k) log.x.y[k] -= 0.05, log.r.y[k] -= 0.05;
  const Conditioned c = condition(log);
  EXPECT_EQ(c.records.size(), 2U) << texts(c);
  EXPECT_THAT(texts(c), HasSubstr("set anew"));
}

TEST(LostRows, CoarseStepsAreNoLostRows) {
  for (const double step : {1e-6, 1e-5}) {
    RawLog log = strokes(8, false);
    for (double& x : log.x.y) x = step * std::round(x / step);
    const Conditioned c = condition(log);
    EXPECT_TRUE(c.findings.empty()) << step << "\n" << texts(c);
  }
}

// Counts of 0.1 um in inches of seven digits: no whole number of digits. At 0.1005 mm/s every two hundredth row has two of them.
TEST(LostRows, CountsInInchesAreNoLostRows) {
  constexpr double kDigit = 25.4e-3 * 1e-7, kCount = 1e-7, kSpeed = 0.1005e-3;
  RawLog log;
  log.source = "log.csv";
  double at = 0.0;
  for (std::size_t k = 0; k < 40000; ++k) {
    const double v = k / 4000 % 2 == 0 ? kSpeed : -kSpeed;
    at += 1e-3 * v;
    log.x.t.push_back(1e-3 * static_cast<double>(k));
    log.x.y.push_back(kDigit * std::round(kCount * std::round(at / kCount) / kDigit));
    log.f.y.push_back(std::copysign(20.0, v));
  }
  const Conditioned c = condition(log);
  EXPECT_THAT(kinds(c), testing::Not(testing::AnyOf(Contains("lost"), Contains("stale")))) << texts(c);
}

// Counts of 0.1 um behind a gear, logged as the angle of the motor with three decimals: steps of 10 and 11 digits, of 21 and 22. Slow
// strokes among fast ones, whose ends have one count or two from row to row.
TEST(LostRows, CountsInRoundedAnglesAreNoLostRows) {
  constexpr double kTurn = 10e-3 / 3.0 / 360.0, kDigit = 1e-3 * kTurn, kCount = 1e-7;
  RawLog log;
  log.source = "log.csv";
  double at = 0.0;
  for (std::size_t k = 0; k < 40000; ++k) {
    const double share = static_cast<double>(k % 4000) / 4000.0;
    const double v = (k / 4000 % 2 == 0 ? 2e-3 : -2e-3) * std::sin(3.14159265 * share);
    at += 1e-3 * v;
    log.x.t.push_back(1e-3 * static_cast<double>(k));
    log.x.y.push_back(kDigit * std::round(kCount * std::round(at / kCount) / kDigit));
    log.f.y.push_back(std::copysign(20.0, v));
  }
  const Conditioned c = condition(log);
  EXPECT_THAT(kinds(c),
              testing::Not(testing::AnyOf(Contains("lost"), Contains("stale"), Contains("repeated"))))
      << texts(c);
}

// No slow rows tell the counts of the encoder: the step of the speed itself is none.
TEST(LostRows, AreFoundAtOneSpeedInOneDirectionToo) {
  RawLog log;
  log.source = "log.csv";
  for (std::size_t k = 0; k < 20000; ++k) {
    if (k == 5000 || k == 9000) continue;
    log.x.y.push_back(1e-7 * std::round(1e-3 * static_cast<double>(k) * 0.1 / 1e-7));
    log.f.y.push_back(20.0 + 0.1 * std::sin(static_cast<double>(k)));
  }
  renumber(log);
  const Conditioned c = condition(log);
  EXPECT_THAT(kinds(c), Contains("lost")) << texts(c);
}

TEST(LostRows, KeepLeavesThemAlone) {
  const RawLog truth = strokes(9, true);
  RawLog log = truth;
  for (const std::size_t k : moving(places(10, 9, log.x.y.size()), truth)) erase(log, k);
  renumber(log);
  ConditionOptions options;
  options.keep = {"lost", "jump"};
  EXPECT_TRUE(condition(log, options).findings.empty());
}

}  // namespace
}  // namespace stribeck::ident::log::lost_rows_test
