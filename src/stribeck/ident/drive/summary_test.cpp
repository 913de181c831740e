#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <stribeck/ident/drive/summary.hpp>

namespace stribeck::ident::drive::summary_test {
namespace {

/// Coulomb 40 N, viscous 500 N·s/m up to 0.1 m/s; a Stribeck part of 12 N that fades over 3 mm/s.
map::StaticFit with_stribeck() {
  map::StaticFit fit;
  fit.top = {0.1, 0.1};
  for (map::BranchFit& b : fit.branch) b = {40.0, 50.0, {{12.0, 0.0, 0.03}}, true, 0.0};
  return fit;
}
constexpr map::Grid kGrid{0.002, 0.1, 50};

TEST(Summary, IsThatOfTheLaw) {
  const Summary s = summary_of(with_stribeck(), 0, kGrid);
  EXPECT_NEAR(s.coulomb.value, 40.0, 1e-9);
  EXPECT_NEAR(s.viscous.value, 500.0, 1e-6);
  EXPECT_NEAR(s.at_rest.value, 52.0, 1e-12);
  EXPECT_NEAR(s.rise.value, 12.0, 1e-9);
  ASSERT_TRUE(s.stribeck_speed);
  EXPECT_NEAR(s.stribeck_speed->value, 0.003, 1e-7);  // exp(−(v/c)²) is 1/e at v = c
}

// A Stribeck part of exponent 1 is not over at a fifth of the top speed: the line through the curve from there on would be too high.
TEST(Summary, TheLineOfAnExponentialRiseIsThatOfTheLaw) {
  map::StaticFit fit = with_stribeck();
  for (map::BranchFit& b : fit.branch) b = {40.0, 50.0, {{12.0, 0.0, 0.1}}, true, 0.0, true};
  map::StaticFit symmetric;
  symmetric.family = map::StaticFit::Family::kSymmetricStribeck;
  symmetric.top = {0.1, 0.1};
  symmetric.coulomb = 40.0, symmetric.viscous = 500.0, symmetric.rise = 12.0, symmetric.v0 = 0.01;
  symmetric.exponent = map::Exponent::kOne;
  for (const map::StaticFit& law : {fit, symmetric}) {
    const Summary s = summary_of(law, 0, kGrid);
    EXPECT_NEAR(s.coulomb.value, 40.0, 1e-9);
    EXPECT_NEAR(s.viscous.value, 500.0, 1e-6);
    ASSERT_TRUE(s.stribeck_speed);
    EXPECT_NEAR(s.stribeck_speed->value, 0.01, 1e-7);
  }
}

// Slow in one direction, fast in the other: a law of both directions is known from the fast one; a curve of the slow one alone is a knee.
TEST(Summary, ASlowDirectionHasTheLineOfBothOrNone) {
  map::StaticFit symmetric;
  symmetric.family = map::StaticFit::Family::kSymmetricStribeck;
  symmetric.top = {0.0125, 0.25};
  symmetric.coulomb = 40.0, symmetric.viscous = 500.0, symmetric.rise = 12.0, symmetric.v0 = 0.01;
  const Summary both = summary_of(symmetric, 0, {0.004, 0.0125, 50});
  EXPECT_NEAR(both.coulomb.value, 40.0, 1e-9);
  EXPECT_NEAR(both.viscous.value, 500.0, 1e-6);
  EXPECT_TRUE(both.line_seen);
  map::StaticFit curve = with_stribeck();
  curve.top = {0.0125, 0.25};
  for (map::BranchFit& b : curve.branch) b.terms = {{12.0, 0.0, 0.9}};
  EXPECT_FALSE(summary_of(curve, 0, {0.004, 0.0125, 50}).line_seen);
  EXPECT_TRUE(summary_of(curve, 1, {0.004, 0.25, 50}).line_seen);
}

// Each derivative against the difference of the figure when its parameter moves.
TEST(Summary, DerivativesAreThoseOfTheFigures) {
  const map::StaticFit fit = with_stribeck();
  const Summary s = summary_of(fit, 1, kGrid);
  const std::array<double, 4> steps{1e-3, 1e-3, 1e-3, 1e-6};
  for (std::size_t j = 0; j < steps.size(); ++j) {
    const auto moved = [&](double by) {
      map::StaticFit other = fit;
      map::BranchFit& b = other.branch[1];
      double* const parameters[] = {&b.eta0, &b.eta1, &b.terms[0].a, &b.terms[0].c};
      *parameters[j] += by;
      return summary_of(other, 1, kGrid);
    };
    const Summary up = moved(steps[j]), down = moved(-steps[j]);
    const auto k = static_cast<Eigen::Index>(j);
    const auto expect = [&](const Figure& f, double a, double b, double scale) {
      EXPECT_NEAR(f.slope(k), (a - b) / (2.0 * steps[j]), 1e-3 * scale) << "parameter " << j;
    };
    expect(s.coulomb, up.coulomb.value, down.coulomb.value, 1.0);
    expect(s.viscous, up.viscous.value, down.viscous.value, 10.0);
    expect(s.at_rest, up.at_rest.value, down.at_rest.value, 1.0);
    expect(*s.stribeck_speed, up.stribeck_speed->value, down.stribeck_speed->value, 0.1);
  }
}

TEST(Summary, AStraightLineHasNoStribeckSpeed) {
  map::StaticFit fit = with_stribeck();
  for (map::BranchFit& b : fit.branch) b = {40.0, 50.0, {}, false, 0.0};
  EXPECT_FALSE(summary_of(fit, 0, kGrid).stribeck_speed);
}

TEST(Summary, SpeedsBeginWhereTheDataBeginAndLieCloserTowardsRest) {
  const std::vector<double> speeds = curve_speeds(kGrid, 40);
  ASSERT_EQ(speeds.size(), 40u);
  EXPECT_EQ(speeds.front(), kGrid.low);
  EXPECT_EQ(speeds.back(), kGrid.high);
  for (std::size_t i = 1; i < speeds.size(); ++i) EXPECT_GT(speeds[i], speeds[i - 1]);
  EXPECT_LT(speeds[1] - speeds[0], 0.3 * (speeds[39] - speeds[38]));
  const std::vector<double> shown = shown_speeds(kGrid);
  ASSERT_EQ(shown.size(), 9u);
  for (const double v : shown) {
    EXPECT_GE(v, kGrid.low);
    EXPECT_LE(v, kGrid.high);
  }
}

// Half widths in percent of the friction; only the ends count.
TEST(Summary, ACurveEndsWhereTheDataHardlyTellIt) {
  const auto part_of = [](const std::vector<double>& percent) {
    std::vector<CurvePoint> points;
    for (const double p : percent) points.push_back({0.01, -50.0, -50.0 - 0.5 * p, -50.0 + 0.5 * p});
    return told_part(points);
  };
  const std::vector<double> middle{19, 1, 1, 1, 60, 1, 1, 1, 1, 1, 19};
  std::vector<double> all{900, 21};
  all.insert(all.end(), middle.begin(), middle.end());
  all.insert(all.end(), {21, 30, 500});
  EXPECT_EQ(part_of(all), (std::pair<std::size_t, std::size_t>{2, 13}));
  EXPECT_EQ(part_of(middle), (std::pair<std::size_t, std::size_t>{0, 11}));
  // Nine points are no curve.
  EXPECT_EQ(part_of({30, 1, 1, 1, 1, 1, 1, 1, 1, 1}), (std::pair<std::size_t, std::size_t>{0, 10}));
  EXPECT_EQ(part_of({}), (std::pair<std::size_t, std::size_t>{0, 0}));
}

// The thrust of a drill: friction of both directions is alike but for the slow feed downwards.
TEST(Summary, ARiseOfOneDirectionAloneIsSaid) {
  const Shown shown{log::Record{}};
  map::StaticFit fit = with_stribeck();
  EXPECT_FALSE(one_sided_rise(fit, {kGrid, kGrid}, shown));
  fit.branch[1].terms[0].a = 60.0;
  const auto said = one_sided_rise(fit, {kGrid, kGrid}, shown);
  ASSERT_TRUE(said);
  EXPECT_THAT(*said, ::testing::HasSubstr("friction of the negative direction is"));
  EXPECT_THAT(*said, ::testing::HasSubstr("force of the process"));
  // Both directions rise; a load that was taken for friction; the other direction was never slow.
  map::StaticFit both = fit;
  both.branch[0].terms[0].a = 50.0;
  EXPECT_FALSE(one_sided_rise(both, {kGrid, kGrid}, shown));
  map::StaticFit loaded = with_stribeck();
  loaded.branch[0].eta0 += 35.0, loaded.branch[1].eta0 -= 35.0;
  EXPECT_FALSE(one_sided_rise(loaded, {kGrid, kGrid}, shown));
  EXPECT_FALSE(one_sided_rise(fit, {map::Grid{0.02, 0.1, 50}, kGrid}, shown));
}

}  // namespace
}  // namespace stribeck::ident::drive::summary_test
