#include <gtest/gtest.h>

#include <stribeck/friction/lugre.hpp>
#include <stribeck/ident/bristle/bristle_parts.hpp>

namespace stribeck::ident::bristle::bristle_part_test {
namespace {

/// Pieces of ten rows and twenty steps; the velocity of a step is the number of its piece. The first start is unknown.
BristlePath path_of(int pieces) {
  BristlePath path;
  path.window = 2;
  for (int i = 0; i < pieces; ++i) {
    PathPiece piece;
    piece.unknown_start = i == 0;
    for (int k = 0; k < 10; ++k) {
      piece.samples.push_back({path.steps.size(), 2, false});
      piece.rows.push_back(static_cast<std::size_t>(k));
      for (int j = 0; j < 2; ++j) {
        PathStep step;
        step.v = i;
        path.steps.push_back(step);
      }
      path.rows.push_back({0, static_cast<std::size_t>(100 * i + k), i, true});
    }
    path.pieces.push_back(piece);
  }
  path.starts = 1;
  path.stretches = pieces;
  return path;
}

TEST(BristlePart, TakesPairsOfPiecesSpreadEvenly) {
  const BristlePath whole = path_of(40);
  const BristlePath part = part_of(whole, 100);  // every fourth pair
  ASSERT_EQ(part.pieces.size(), 9u);             // 1, 8, 9, 16, 17, …: the unknown start is left out
  EXPECT_EQ(part.starts, 0);
  EXPECT_EQ(part.window, 2);
  EXPECT_EQ(part.rows.size(), 90u);
  EXPECT_EQ(part.stretches, 9);
  for (std::size_t i = 0; i < part.rows.size(); ++i)
    EXPECT_EQ(part.rows[i].stretch, static_cast<int>(i / 10));
  const std::vector<int> kept{1, 8, 9, 16, 17, 24, 25, 32, 33};
  for (std::size_t p = 0; p < kept.size(); ++p) {
    EXPECT_EQ(part.rows[10 * p].at, static_cast<std::size_t>(100 * kept[p]));
    for (const PathSample& sample : part.pieces[p].samples)
      for (std::size_t j = sample.first; j < sample.first + sample.count; ++j)
        EXPECT_EQ(part.steps[j].v, kept[p]) << p;
  }
}

/// One piece of `stretches` stretches of ten rows, one sub-step in each; the velocity of a step is the number of its row.
BristlePath long_piece(int stretches) {
  constexpr std::size_t kBefore = 30;  // ticks before the first row and behind the last one
  BristlePath path;
  path.window = 2;
  PathPiece piece;
  piece.unknown_start = true;
  const std::size_t ticks = static_cast<std::size_t>(10 * stretches) + 2 * kBefore;
  for (std::size_t k = 0; k + 1 < ticks; ++k) {
    piece.samples.push_back({k, 1, false});
    PathStep step;
    step.v = static_cast<double>(k);
    path.steps.push_back(step);
  }
  for (std::vector<double>* column :
       {&piece.acceleration, &piece.force, &piece.given, &piece.speed, &piece.at})
    for (std::size_t k = 0; k < ticks; ++k) column->push_back(static_cast<double>(k));
  piece.held.assign(ticks + 1, 0.0);
  for (int s = 0; s < stretches; ++s) {
    for (int k = 0; k < 10; ++k) {
      const std::size_t at = kBefore + static_cast<std::size_t>(10 * s + k);
      piece.rows.push_back(at);
      path.rows.push_back({0, at, s, true});
    }
  }
  path.pieces.push_back(piece);
  path.starts = 1;
  path.stretches = stretches;
  return path;
}

TEST(BristlePart, ALongPieceIsCutBehindAStretch) {
  const BristlePath whole = long_piece(50);
  const BristlePath part = shortened(whole, 95);  // of 500 rows
  ASSERT_EQ(part.pieces.size(), 1u);
  const PathPiece& piece = part.pieces.front();
  EXPECT_EQ(part.rows.size(), 100u);
  EXPECT_EQ(part.stretches, 10);
  EXPECT_EQ(part.starts, 1);
  ASSERT_EQ(piece.rows.size(), 100u);
  EXPECT_EQ(piece.rows.back(), 129u);
  // The window reaches 3·2 + 4 ticks beyond the last row, and D²x one more.
  ASSERT_GE(piece.force.size(), 129u + 10u + 2u);
  EXPECT_LT(piece.force.size(), 150u);
  EXPECT_EQ(piece.samples.size() + 1, piece.force.size());
  EXPECT_EQ(piece.held.size(), piece.force.size() + 1);
  EXPECT_EQ(part.steps.size(), piece.samples.size());
  for (std::size_t k = 0; k < piece.samples.size(); ++k) {
    EXPECT_EQ(piece.force[k], static_cast<double>(k));
    EXPECT_EQ(part.steps[piece.samples[k].first].v, static_cast<double>(k));
  }
  // Never fewer than four stretches, and nothing is cut where there is room.
  EXPECT_EQ(shortened(whole, 1).rows.size(), 40u);
  EXPECT_EQ(shortened(whole, 500).rows.size(), 500u);
  EXPECT_EQ(shortened(whole, 500).pieces.front().force.size(), whole.pieces.front().force.size());
}

// One step of LuGre along a path is that of friction/lugre.hpp, slow and fast, forward and back, whatever the damping.
TEST(LuGreBristle, StepsAsTheLaw) {
  for (const double v : {-0.3, -1e-3, -1e-7, 0.0, 1e-6, 2e-4, 0.05}) {
    LuGreCase::Law<double> mine;
    mine.law.sigma0 = 1.5e7;
    mine.law.sigma1 = 5e5;
    mine.law.damping_velocity = 3e-4;
    Bristle<friction::LuGre<double>, double> law{mine.law, {}};
    mine.start(-0.6, 80.0);
    law.start(-0.6, 80.0);
    PathStep step;
    step.dt = 2e-4;
    step.v = v;
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(mine.advance(step, 80.0), law.advance(step, 80.0), 1e-9) << v;  // rounding of 80 N
      EXPECT_NEAR(mine.state.z, law.state.z, 1e-18) << v;
    }
  }
}

TEST(BristlePart, IsEverythingWhereThatIsFew) {
  const BristlePath part = part_of(path_of(6), 100);
  EXPECT_EQ(part.pieces.size(), 5u);
  EXPECT_EQ(part.steps.size(), 100u);
}

// A jog slower than everything that makes a bristle slide is one piece of many rows.
TEST(BristlePart, ThePairsWithTheFewestRowsAreTaken) {
  BristlePath whole = path_of(40);
  for (std::size_t i = 10; i < 12; ++i) {
    for (std::size_t k = 10; k < 500; ++k) whole.pieces[i].rows.push_back(k);
  }
  whole.rows.clear();
  for (std::size_t i = 0; i < whole.pieces.size(); ++i) {
    for (const std::size_t k : whole.pieces[i].rows)
      whole.rows.push_back({0, 1000 * i + k, static_cast<int>(i), true});
  }
  const BristlePath all_but_those = shortest_of(whole, 390, 20);
  EXPECT_EQ(all_but_those.pieces.size(), 37u);  // without the unknown start and the two long ones
  for (const PathRow& row : all_but_those.rows) EXPECT_TRUE(row.at < 10'000 || row.at >= 12'000);
  EXPECT_EQ(shortest_of(whole, 100, 0).pieces.size(), 9u);
  EXPECT_EQ(shortest_of(whole, 100, 20).pieces.size(), 21u);
  EXPECT_EQ(shortest_of(whole, 100, 40).pieces.size(), 39u);
}

}  // namespace
}  // namespace stribeck::ident::bristle::bristle_part_test
