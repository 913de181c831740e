#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stribeck/ident/drive/places/places.hpp>
#include <stribeck/ident/drive/test_synthetic_log.hpp>

namespace stribeck::ident::drive::places_test {
namespace {

constexpr double kMass = 20.0, kForce = 40.0, kPerSpeed = 60.0;

/// Share of the level at a place, for the travel of ±0.103 m of the log.
double share(double x) { return 1.0 + 0.1 * std::sin(2.0 * kPi * x / 0.13); }

double even(double, double v, double a) { return kMass * a + (v > 0.0 ? kForce : -kForce) + kPerSpeed * v; }
double placed(double x, double v, double a) {
  return even(x, v, a) + (share(x) - 1.0) * (v > 0.0 ? kForce : -kForce);
}

Level level() {
  Level out;
  for (auto& curve : out.curve) {
    curve.grid = {0.0, 1.0, 1};
    curve.build(curve.grid, {1.0}, {0.5}, {kForce});
  }
  return out;
}

struct Looked {
  test::SyntheticLog log;
  Rows rows;
  std::vector<double> residual;
};

/// What the fit of mass and bins leaves, with white noise beside it.
Looked look(const std::function<double(double, double, double)>& force, double noise, double second = 0.003) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, noise);
  Looked out{test::synthetic_log(
                 [&](double x, double v, double a) { return force(x, v, a) + normal(random); }, second),
             {},
             {}};
  out.rows = gather(out.log.log, extent_of(out.log.log), {1e-3, 0.04, 0.0}, 160);
  const LinearFit fit = solve(out.log.log, out.rows, {});
  std::vector<double> columns(1);
  for (std::size_t i = 0; i < out.rows.size(); ++i)
    out.residual.push_back(residual_of(out.log.log, out.rows, {}, fit, i, columns));
  return out;
}

PlaceShares places_in(const Looked& l) { return find_places({l.log.log, l.rows, level(), l.residual}); }

// The mean over the travel belongs to the map: shares are compared by their differences.
TEST(Places, AreFoundWithIntervalsThatHoldThem) {
  const Looked l = look(placed, 0.5, 0.02);
  const PlaceShares found = places_in(l);
  ASSERT_EQ(found.places.size(), friction::kMostPlaces);
  double mean = 0.0;
  for (const friction::Place& p : found.places)
    mean += share(p.position) / static_cast<double>(friction::kMostPlaces);
  int inside = 0;
  for (std::size_t k = 0; k < found.places.size(); ++k) {
    const double truth = share(found.places[k].position) / mean;
    EXPECT_NEAR(found.places[k].level, truth, 0.03) << k;
    inside += std::abs(found.places[k].level - truth) <= std::max(found.half[k], 0.01) ? 1 : 0;
  }
  EXPECT_GE(inside, 10);
  EXPECT_LT(found.after, 0.7 * found.before);
}

TEST(Places, NoneAreFoundWhereFrictionIsTheSameEverywhere) {
  for (const double noise : {0.01, 0.5, 5.0})
    EXPECT_TRUE(places_in(look(even, noise)).places.empty()) << noise;
}

// A force that drifts along the travel but does not reverse is no friction.
TEST(Places, ASpringIsNotTakenForThem) {
  const Looked l = look([](double x, double v, double a) { return even(x, v, a) + 30.0 * x; }, 0.2);
  EXPECT_TRUE(places_in(l).places.empty());
}

TEST(Places, WhatIsLaidOverTheRowsIsNotFoundAgain) {
  Looked l = look(placed, 0.5, 0.02);
  const PlaceShares found = places_in(l);
  lay_places(l.log.log, l.rows, level(), found.places);
  const LinearFit fit = solve(l.log.log, l.rows, {});
  std::vector<double> columns(1);
  for (std::size_t i = 0; i < l.rows.size(); ++i)
    l.residual[i] = residual_of(l.log.log, l.rows, {}, fit, i, columns);
  EXPECT_TRUE(places_in(l).places.empty());
}

TEST(Places, TwoSetsTogetherAddTheirShares) {
  friction::Places a, b;
  a.push_back({0.0, 1.1, 1.0}), a.push_back({0.1, 0.9, 1.0});
  b.push_back({-0.1, 1.2, 1.0}), b.push_back({0.1, 1.0, 1.0});
  const friction::Places sum = together(a, b);
  ASSERT_EQ(sum.size(), 2u);
  EXPECT_DOUBLE_EQ(sum[0].level, 1.2);
  EXPECT_DOUBLE_EQ(sum[1].level, 0.9);
  EXPECT_EQ(together({}, b).size(), 2u);
}

}  // namespace
}  // namespace stribeck::ident::drive::places_test
