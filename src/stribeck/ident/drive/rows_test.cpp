#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>

#include <stribeck/ident/drive/rows.hpp>
#include <stribeck/ident/drive/test_synthetic_log.hpp>
#include <stribeck/ident/refused.hpp>

namespace stribeck::ident::drive::rows_test {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

test::SyntheticLog any_log() {
  return test::synthetic_log([](double, double, double a) { return a; });
}

TEST(Rows, ExtentHoldsTheTopSpeedOfEachDirection) {
  const test::SyntheticLog s = any_log();
  const Extent e = extent_of(s.log);
  EXPECT_NEAR(e.top_speed[0], 0.1 + 0.003 * 7.3, 1e-4);  // both cosines at t = 0
  EXPECT_GT(e.top_speed[1], 0.1);
  EXPECT_DOUBLE_EQ(e.near, 2e-3 * 0.206);  // no noise: a share of the stroke
}

TEST(Rows, EveryUsedRowFitsTheWindow) {
  test::SyntheticLog s = any_log();
  auto& skip = (*s.records)[0].skip;
  skip.assign(s.log.motions[0].rows(), 0);
  for (std::size_t k = 5000; k < 6000; ++k) skip[k] = 1;
  const Extent e = extent_of(s.log);
  const Window window{2e-3, 0.3, 1e-3};
  const Rows rows = gather(s.log, e, window, 160);
  ASSERT_GT(rows.size(), 1000u);
  const log::Motion& m = s.log.motions[0];
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t k = rows.at[i];
    ASSERT_TRUE(k < 5000 || k >= 6000) << k;
    ASSERT_GE(m.distance[k], window.exclude) << k;
    ASSERT_GE(std::abs(m.v[k]), window.slowest_share * e.top_speed[rows.side[i]]) << k;
    ASSERT_LE(window.relaxation * std::abs(m.a[k]), 0.2 * m.v[k] * m.v[k]) << k;
    ASSERT_EQ(rows.side[i], m.v[k] > 0.0 ? 0 : 1) << k;
    ASSERT_EQ(rows.bin[i], rows.grid[rows.side[i]].bin(std::abs(m.v[k]))) << k;
  }
}

/// Strokes to and fro at one speed for 4 s each, four of them.
void add_slow_jogs(test::SyntheticLog& s, double speed) {
  constexpr double kStep = 1e-3, kTime = 16.0, kStroke = 4.0;
  log::Record rec;
  log::Motion m;
  rec.source = "jogs";
  rec.sample_time = m.sample_time = kStep;
  double x = 0.0, reversal = 0.0;
  for (double t = 0.0; t < kTime; t += kStep) {
    const int stretch = static_cast<int>(t / kStroke);
    const auto direction = static_cast<std::int8_t>(stretch % 2 == 0 ? 1 : -1);
    if (!m.stretch.empty() && stretch != m.stretch.back()) reversal = x, m.reversals.push_back(m.rows());
    m.x.push_back(x), m.v.push_back(direction * speed), m.a.push_back(0.0), m.instrument.push_back(0.0);
    m.direction.push_back(direction), m.stretch.push_back(stretch), m.f.push_back(0.0);
    m.distance.push_back(std::abs(x - reversal));
    rec.t.push_back(t), rec.x.push_back(x), rec.f.push_back(0.0);
    x += kStep * direction * speed;
  }
  m.stroke = kStroke * speed;
  m.reach = 1;
  s.records->push_back(std::move(rec));
  s.log.records = *s.records;
  s.log.force.push_back(m.f);
  s.log.predicted.emplace_back();
  s.log.motions.push_back(std::move(m));
}

// Rows of the fast motion are skipped: what is left is slow, and its bins have equal width.
TEST(Rows, SlowJogsAloneBelowATopSpeedThatIsNotUsed) {
  test::SyntheticLog s = test::synthetic_log([](double, double, double a) { return a; }, 0.0);
  (*s.records)[0].skip.assign(s.log.motions[0].rows(), 1);
  add_slow_jogs(s, 1e-3);
  add_slow_jogs(s, 1.5e-3);
  const Rows rows = gather(s.log, extent_of(s.log), {1e-4, 0.04, 1e-5}, 160);
  EXPECT_GT(rows.size(), 30000u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const map::Grid& g = rows.grid[rows.side[i]];
    ASSERT_EQ(g.slow_bins, 0);
    ASSERT_GE(g.bins, 8);
    ASSERT_GE(rows.bin[i], 0);
    ASSERT_LT(rows.bin[i], g.bins);
  }
}

// Few fast rows beside very many slow ones do not get a bin each, which would take their acceleration from the mass.
TEST(Rows, FastRowsHaveBinsForTheirOwnNumber) {
  test::SyntheticLog s = test::synthetic_log([](double, double, double a) { return a; }, 0.0);
  auto& skip = (*s.records)[0].skip;
  skip.assign(s.log.motions[0].rows(), 1);
  std::fill(skip.begin(), skip.begin() + 5000, std::uint8_t{0});
  const Window window{1e-4, 0.04, 1e-5};
  const int alone = gather(s.log, extent_of(s.log), window, 1000).grid[0].bins;
  add_slow_jogs(s, 1e-3);
  const map::Grid both = gather(s.log, extent_of(s.log), window, 1000).grid[0];
  EXPECT_EQ(both.bins - both.slow_bins, alone);
}

// A hundredth of the top speed of the other record: left out by their speed, used because they are steady.
TEST(Rows, SlowJogsBesideAFastMotionAreUsed) {
  test::SyntheticLog s = test::synthetic_log([](double, double, double a) { return a; }, 0.0);
  const Window window{1e-4, 0.04, 1e-5};
  const Rows fast = gather(s.log, extent_of(s.log), window, 160);
  constexpr double kSlow = 1e-3;
  add_slow_jogs(s, kSlow);
  const Rows both = gather(s.log, extent_of(s.log), window, 160);
  for (std::size_t side = 0; side < map::kSides; ++side) {
    EXPECT_EQ(fast.grid[side].slow_bins, 0);
    EXPECT_NEAR(both.grid[side].low, kSlow, 1e-9);
    EXPECT_DOUBLE_EQ(both.grid[side].knee, fast.grid[side].low);
    EXPECT_DOUBLE_EQ(both.grid[side].high, fast.grid[side].high);
    EXPECT_GT(both.grid[side].slow_bins, 3);
  }
  std::size_t slow = 0;
  for (std::size_t i = 0; i < both.size(); ++i) {
    if (both.record[i] != 1) continue;
    ++slow;
    ASSERT_LT(both.bin[i], both.grid[both.side[i]].slow_bins) << i;
  }
  EXPECT_GT(slow, 15000u);
  EXPECT_EQ(both.size(), fast.size() + slow);
}

TEST(Rows, BinsHoldTheSpeedsBetweenTheirBorders) {
  for (const map::Grid& g : {map::Grid{1e-3, 0.5, 40, 0.02, 12}, map::Grid{0.02, 0.5, 40}}) {
    for (int b = 0; b < g.bins; ++b) {
      const double left = g.left(b), right = g.left(b + 1);
      ASSERT_LT(left, right) << b;
      ASSERT_EQ(g.bin(left + 1e-6 * (right - left)), b);
      ASSERT_EQ(g.bin(right - 1e-6 * (right - left)), b);
      ASSERT_NEAR(g.width(0.5 * (left + right)), right - left, 1e-12) << b;
    }
    EXPECT_DOUBLE_EQ(g.left(0), g.low);
    EXPECT_DOUBLE_EQ(g.left(g.bins), g.high);
    EXPECT_EQ(g.bin(0.5 * g.low), 0);
    EXPECT_EQ(g.bin(2.0 * g.high), g.bins - 1);
  }
}

TEST(Rows, OneDirectionIsRefused) {
  test::SyntheticLog s = any_log();
  auto& skip = (*s.records)[0].skip;
  for (const double v : s.log.motions[0].v) skip.push_back(v < 0.0 ? 1 : 0);
  EXPECT_THAT(
      [&] {
        gather(s.log, extent_of(s.log), {1e-3, 0.04, 0.0}, 160);
      },
      ThrowsMessage<Refused>(HasSubstr("0 rows of negative sliding motion, expected at least 30")));
}

// Whole stretches, in turn: no stretch lies in two blocks, and every block has rows of both directions.
TEST(Rows, BlocksAreWholeStretches) {
  const test::SyntheticLog s = any_log();
  const Rows rows = gather(s.log, extent_of(s.log), {1e-3, 0.04, 0.0}, 160);
  EXPECT_EQ(rows.blocks, 7u);  // more than seven stretches of each direction
  std::vector<int> block_of(64, -1);
  std::set<std::pair<int, int>> seen;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    int& known = block_of[static_cast<std::size_t>(rows.stretch[i])];
    if (known < 0) known = rows.block[i];
    ASSERT_EQ(known, rows.block[i]) << i;
    seen.insert({rows.block[i], rows.side[i]});
  }
  EXPECT_EQ(seen.size(), 14u);
}

// Where a direction has fewer stretches than blocks, pieces of them take their place.
TEST(Rows, FewStretchesAreCutIntoPieces) {
  Rows rows;
  for (std::size_t i = 0; i < 500; ++i) {
    rows.record.push_back(0), rows.at.push_back(i), rows.stretch.push_back(i < 250 ? 0 : 1);
    rows.side.push_back(i < 250 ? 0 : 1), rows.bin.push_back(0);
  }
  number_blocks(rows);
  std::array<int, 5> count{};
  for (const auto b : rows.block) ++count.at(b);
  EXPECT_THAT(count, ::testing::Each(100));
}

/// Strokes to and fro, each with as many rows, of one record.
void add_strokes(Rows& rows, int record, int strokes, std::size_t length, int bin) {
  const int first = rows.stretch.empty() ? 0 : rows.stretch.back() + 1;
  for (int s = 0; s < strokes; ++s) {
    for (std::size_t k = 0; k < length; ++k) {
      rows.record.push_back(record), rows.at.push_back(static_cast<std::size_t>(s) * length + k);
      rows.stretch.push_back(first + s), rows.side.push_back(s % 2 == 0 ? 0 : 1),
          rows.bin.push_back(static_cast<decltype(rows.bin)::value_type>(bin));
    }
  }
}

// The held-out blocks decide the model: they must be the same whatever log is given first.
TEST(Rows, TheOrderOfTheRecordsDecidesNothing) {
  for (const int strokes : {4, 24}) {  // pieces of strokes, and whole ones
    Rows one, other;
    add_strokes(one, 0, strokes, 30, 5), add_strokes(one, 1, strokes + 2, 50, 9),
        add_strokes(one, 2, strokes, 30, 7);
    add_strokes(other, 0, strokes, 30, 7), add_strokes(other, 1, strokes, 30, 5),
        add_strokes(other, 2, strokes + 2, 50, 9);
    number_blocks(one), number_blocks(other);
    const auto blocks_of = [](const Rows& rows, int bin) {
      std::vector<int> out;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows.bin[i] == bin) out.push_back(rows.block[i]);
      }
      return out;
    };
    for (const int bin : {5, 7, 9})
      EXPECT_EQ(blocks_of(one, bin), blocks_of(other, bin)) << strokes << " " << bin;
    EXPECT_NE(blocks_of(one, 5), blocks_of(one, 7)) << strokes;
  }
}

// Logs of few strokes each: every block has rows of both directions.
TEST(Rows, FewStrokesInEachRecordFillAllBlocks) {
  for (const int records : {2, 3, 4}) {
    Rows rows;
    for (int r = 0; r < records; ++r) add_strokes(rows, r, 8, 30, 5 + r);
    number_blocks(rows);
    std::set<std::pair<int, int>> seen;
    for (std::size_t i = 0; i < rows.size(); ++i) seen.insert({rows.block[i], rows.side[i]});
    EXPECT_EQ(seen.size(), 2 * rows.blocks) << records;
  }
}

TEST(Rows, ASampleIsAlignedAsTheWholeLogIs) {
  test::SyntheticLog s = test::synthetic_log([](double x, double v, double) { return 3e3 * x + 70.0 * v; });
  Rows rows = gather(s.log, extent_of(s.log), {1e-3, 0.04, 0.0}, 160);
  EXPECT_EQ(sampled(rows).size(), rows.size());  // few enough
  EXPECT_FALSE(sampled(rows).sampled);
  AlignedLog whole = s.log;
  align_all(whole, 2.3);
  rows.sampled = true;
  align(s.log, 2.3, rows);
  EXPECT_EQ(s.log.shift, 2.3);
  for (const std::size_t k : rows.at) {
    ASSERT_EQ(s.log.motions[0].f[k], whole.motions[0].f[k]) << k;
    ASSERT_EQ(s.log.motions[0].f[k + 1], whole.motions[0].f[k + 1]) << k;
  }
}

}  // namespace
}  // namespace stribeck::ident::drive::rows_test
