#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <stribeck/ident/map/static_fit.hpp>

namespace stribeck::ident::map::static_fit_test {
namespace {

using Family = StaticFit::Family;

/// Sums of 5 blocks of 4000 rows in 60 bins from `slowest` up to 0.1 m/s; force(side, speed) against the motion, white noise [N].
std::array<SideSums, kSides> sums_of(const std::function<double(int, double)>& force, double noise,
                                     double slowest = 1e-3) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::array<SideSums, kSides> out;
  for (int s = 0; s < kSides; ++s) {
    SideSums& side = out[static_cast<std::size_t>(s)];
    side.grid = {slowest, 0.1, 60};
    const std::vector<double> zero(60);
    side.block.assign(5, {zero, zero, zero, zero});
    for (BlockSums& block : side.block) {
      for (int i = 0; i < 4000; ++i) {
        const double speed = side.grid.low + (side.grid.high - side.grid.low) * uniform(engine);
        const double f = force(s, speed) + noise * normal(engine);
        const auto b = static_cast<std::size_t>(side.grid.bin(speed));
        block.n[b] += 1.0, block.v[b] += speed, block.f[b] += f, block.ff[b] += f * f;
      }
    }
  }
  return out;
}

double viscous(int, double speed) { return 40.0 + 600.0 * speed; }
double stribeck(int, double speed) {
  return viscous(0, speed) + 25.0 * std::exp(-std::pow(speed / 8e-3, 2.0));
}
double steep(int, double speed) { return viscous(0, speed) + 25.0 * std::exp(-speed / 8e-3); }
/// A bell at half the range in one direction.
double bell(int side, double speed) {
  return viscous(0, speed) + (side == 0 ? 18.0 * std::exp(-std::pow((speed - 0.05) / 0.012, 2.0)) : 0.0);
}

TEST(StaticFit, TakesTheFamilyThatMadeTheForce) {
  const StaticChoice line = choose_static(sums_of(viscous, 1.0), {});
  EXPECT_EQ(line.fit.family, Family::kSymmetric);
  EXPECT_NEAR(line.fit.coulomb, 40.0, 0.1);
  EXPECT_NEAR(line.fit.viscous, 600.0, 2.0);
  // The noise, and what friction changes within a bin: 600 N s/m over 1.65 mm/s, uniformly spread.
  EXPECT_NEAR(line.held_out_rms, std::sqrt(1.0 + std::pow(600.0 * 0.099 / 60.0, 2.0) / 12.0), 0.01);

  const StaticChoice fall = choose_static(sums_of(stribeck, 1.0), {});
  EXPECT_EQ(fall.fit.family, Family::kSymmetricStribeck);
  EXPECT_NEAR(fall.fit.rise, 25.0, 0.5);
  EXPECT_NEAR(fall.fit.v0, 8e-3, 3e-4);
  EXPECT_EQ(fall.fit.exponent, Exponent::kTwo);

  const StaticChoice one_exponent = choose_static(sums_of(steep, 1.0), {});
  EXPECT_EQ(one_exponent.fit.family, Family::kSymmetricStribeck);
  EXPECT_EQ(one_exponent.fit.exponent, Exponent::kOne);
  EXPECT_NEAR(one_exponent.fit.rise, 25.0, 0.5);
  EXPECT_NEAR(one_exponent.fit.v0, 8e-3, 3e-4);

  const StaticChoice one = choose_static(sums_of(bell, 1.0), {});
  EXPECT_EQ(one.fit.family, Family::kByDirection);
  ASSERT_EQ(one.fit.branch[0].terms.size(), 1u);
  EXPECT_TRUE(one.fit.branch[1].terms.empty());
  EXPECT_NEAR(one.fit.branch[0].terms[0].b * one.fit.top[0], 0.05, 1e-3);
  for (double v = 2e-3; v < 0.1; v += 5e-3) {
    EXPECT_NEAR(one.fit.force(0, v), bell(0, v), 0.6) << v;
    EXPECT_NEAR(one.fit.force(1, v), bell(1, v), 0.6) << v;
  }
}

TEST(StaticFit, EachDirectionHasItsOwnExponent) {
  StaticOptions options;
  options.symmetric = false;
  const auto force = [](int side, double speed) {
    return side == 0 ? stribeck(0, speed) : steep(1, speed) + 30.0;
  };
  const StaticChoice c = choose_static(sums_of(force, 1.0), options);
  ASSERT_TRUE(c.fit.branch[0].centred);
  ASSERT_TRUE(c.fit.branch[1].centred);
  EXPECT_FALSE(c.fit.branch[0].exponential);
  EXPECT_TRUE(c.fit.branch[1].exponential);
  StaticFit one = c.fit;
  EXPECT_EQ(one.name(), "by direction, Coulomb, viscous and Stribeck of exponent 1 for v < 0");
  one.branch[0] = {40.0, 50.0, {{18.0, 0.5, 0.12}}, false, 0.0};
  EXPECT_EQ(one.name(), "by direction, 1 Gaussian and a Stribeck part of exponent 1");
  for (double v = 2e-3; v < 0.1; v += 5e-3) {
    EXPECT_NEAR(c.fit.force(0, v), force(0, v), 0.4) << v;
    EXPECT_NEAR(c.fit.force(1, v), force(1, v), 0.4) << v;
  }
}

// A steep rise that only the slowest bins show: the bounds on the force at rest leave a further term no height.
TEST(StaticFit, NoTermIsIdle) {
  StaticOptions options;
  options.symmetric = false;
  const auto rise = [](int, double speed) {
    return viscous(0, speed) + 60.0 * std::exp(-std::pow(speed / 2e-3, 2.0));
  };
  const StaticChoice c = choose_static(sums_of(rise, 0.3), options);
  for (const BranchFit& branch : c.fit.branch) {
    for (const FitTerm& g : branch.terms) EXPECT_GT(std::abs(g.a), 1e-2) << "at " << g.b;
  }
}

// A force that rises in the last bins only, as an axis shows that turns at its largest speed: a bell beyond them would have any height.
TEST(StaticFit, NoNarrowTermIsCentredBeyondTheFastestRows) {
  StaticOptions options;
  options.symmetric = false;
  const auto turn = [](int, double speed) {
    return viscous(0, speed) + 200.0 * std::exp(-std::pow((speed - 0.1035) / 2e-3, 2.0));
  };
  const StaticChoice c = choose_static(sums_of(turn, 1.0), options);
  for (const BranchFit& branch : c.fit.branch) {
    for (const FitTerm& g : branch.terms)
      EXPECT_TRUE(g.b < 1.0 || g.c > 0.15) << "at " << g.b << ", width " << g.c << ", height " << g.a;
  }
}

// Noise of the size of the Stribeck part hides its shape; an exponent of 1 would rise more steeply below the slowest rows.
TEST(StaticFit, WhereTheLogDoesNotTellTheExponentIsTwo) {
  const auto faint = [](int, double speed) { return viscous(0, speed) + 3.0 * std::exp(-speed / 8e-3); };
  const StaticChoice c = choose_static(sums_of(faint, 10.0), {});
  EXPECT_FALSE(c.fit.family == Family::kSymmetricStribeck && c.fit.exponent == Exponent::kOne);
  StaticFit two, one;
  two.family = one.family = Family::kSymmetricStribeck;
  one.exponent = Exponent::kOne;
  EXPECT_LT(two.complexity(), one.complexity());
  EXPECT_EQ(two.parameters(), one.parameters());
}

TEST(StaticFit, ExactlyOneCandidateOfEachChoiceIsChosen) {
  const StaticChoice c = choose_static(sums_of(stribeck, 1.0), {});
  EXPECT_EQ(
      std::count_if(c.candidates.begin(), c.candidates.end(), [](const Candidate& x) { return x.chosen; }),
      1);
  EXPECT_EQ(c.block_loss.size(), 5u);
  EXPECT_NEAR(c.tested, 40000.0, 1.0);
  ASSERT_FALSE(c.simple.empty());
}

// A weight adds to both directions with opposite sign against the motion.
TEST(StaticFit, TellsALoadInTheSymmetricFamily) {
  const auto heavy = [](int side, double speed) { return viscous(0, speed) + (side == 0 ? 70.0 : -70.0); };
  const StaticChoice c = choose_static(sums_of(heavy, 1.0), {});
  EXPECT_EQ(c.fit.family, Family::kSymmetric);
  EXPECT_NEAR(c.fit.load, 70.0, 0.1);
  EXPECT_NEAR(c.fit.coulomb, 40.0, 0.1);
}

// By direction a load is taken out only where a branch would drive the motion otherwise.
TEST(StaticFit, ALoadByDirectionIsTakenOutWhereABranchWouldDrive) {
  StaticOptions options;
  options.symmetric = false;
  const auto with = [](double load) {
    return [load](int side, double speed) { return bell(side, speed) + (side == 0 ? load : -load); };
  };
  EXPECT_EQ(choose_static(sums_of(with(10.0), 1.0), options).fit.load, 0.0);
  const StaticChoice c = choose_static(sums_of(with(70.0), 1.0), options);
  EXPECT_NEAR(c.fit.load, 72.0, 4.0);  // and half of the bell's mean
  EXPECT_NEAR(c.fit.force(1, 0.05), bell(1, 0.05) - 70.0, 0.6);
}

// Where a load is known to pull, what differs by direction is that load, however small it is beside friction.
TEST(StaticFit, AKnownLoadIsTakenOutThoughNoBranchDrives) {
  StaticOptions options;
  options.symmetric = false;
  options.weighted = true;
  const auto with = [](int side, double speed) { return bell(0, speed) + (side == 0 ? 10.0 : -10.0); };
  const StaticChoice c = choose_static(sums_of(with, 1.0), options);
  EXPECT_NEAR(c.fit.load, 10.0, 0.3);
  EXPECT_NEAR(c.fit.force(0, 0.05), bell(0, 0.05) + 10.0, 0.6);
  EXPECT_NEAR(c.fit.force(1, 0.05), bell(0, 0.05) - 10.0, 0.6);
}

// By hand: the force at rest of the line 7 + 3·v is 7; a bump below a fifth of the top speed does not count.
TEST(StaticFit, TheLevelIsThatOfALineThroughTheFastForces) {
  double level = 0.0, weights = 0.0;
  for (const LevelPoint& p : level_points(0.5)) {
    level += p.weight * (7.0 + 3.0 * p.speed + (p.speed < 0.09 ? 100.0 : 0.0));
    weights += p.weight;
  }
  EXPECT_NEAR(level, 7.0, 1e-12);
  EXPECT_NEAR(weights, 1.0, 1e-12);
}

// A hydrostatic table: next to no Coulomb friction, and viscous friction that differs between the directions, which is no load.
TEST(StaticFit, ViscousFrictionThatDiffersByDirectionIsNoLoad) {
  StaticOptions options;
  options.symmetric = false;
  const auto table = [](double coulomb, double load) {
    return [=](int side, double speed) {
      return coulomb + (side == 0 ? 1500.0 + load / speed : 1400.0 - load / speed) * speed;
    };
  };
  const StaticChoice light = choose_static(sums_of(table(8.0, 0.0), 0.2), options);
  EXPECT_EQ(light.fit.load, 0.0);
  EXPECT_NEAR(light.fit.branch[0].eta0, 8.0, 0.5);
  EXPECT_NEAR(light.fit.branch[1].eta0, 8.0, 0.5);
  const StaticChoice heavy = choose_static(sums_of(table(8.0, 30.0), 0.2), options);
  EXPECT_NEAR(heavy.fit.load, 30.0, 0.5);
  // With no level at all, noise must not make friction drive the motion.
  const StaticChoice none = choose_static(sums_of(table(-0.1, 0.0), 0.2), options);
  EXPECT_GT(none.fit.branch[0].eta0, 0.0);
  EXPECT_GT(none.fit.branch[1].eta0, 0.0);
  EXPECT_NEAR(none.fit.force(0, 0.05), 75.0, 1.0);
}

TEST(StaticFit, AsManyTermsAsAreAskedFor) {
  StaticOptions options;
  options.terms = 2;
  const StaticChoice c = choose_static(sums_of(bell, 1.0), options);
  EXPECT_EQ(c.fit.family, Family::kByDirection);
  EXPECT_EQ(c.fit.branch[0].terms.size(), 2u);
  EXPECT_EQ(c.fit.branch[1].terms.size(), 2u);
  EXPECT_TRUE(c.simple.empty());
}

// Held out and fitted sums may differ: the judgement is on the held-out ones.
TEST(StaticFit, IsJudgedOnTheHeldOutSums) {
  auto sums = sums_of(viscous, 1.0);
  for (SideSums& side : sums) {
    side.held = side.block;
    for (BlockSums& b : side.held) {
      for (std::size_t i = 0; i < b.n.size(); ++i) {
        b.ff[i] += 2.0 * 3.0 * b.f[i] + 9.0 * b.n[i];  // every force three newtons higher
        b.f[i] += 3.0 * b.n[i];
      }
    }
  }
  EXPECT_NEAR(choose_static(sums, {}).held_out_rms, std::sqrt(1.0 + 9.0), 0.05);
}

TEST(StaticFit, GradientIsThatOfTheForce) {
  StaticFit symmetric;
  symmetric.family = Family::kSymmetricStribeck;
  symmetric.load = 3.0, symmetric.coulomb = 40.0, symmetric.viscous = 600.0;
  symmetric.rise = 25.0, symmetric.v0 = 8e-3;
  StaticFit by_direction;
  by_direction.top = {0.1, 0.09};
  by_direction.branch[0] = {40.0, 50.0, {{18.0, 0.5, 0.12}, {-5.0, 0.9, 0.3}}, false, 0.0};
  by_direction.branch[1] = {38.0, 52.0, {{9.0, 0.0, 0.2}}, true, 0.0};
  StaticFit steep_symmetric = symmetric, steep_by_direction = by_direction;
  steep_symmetric.exponent = Exponent::kOne;
  steep_by_direction.branch[1].exponential = true;
  for (const StaticFit& fit : {symmetric, by_direction, steep_symmetric, steep_by_direction}) {
    const auto p = static_cast<Eigen::Index>(fit.parameters());
    for (int side = 0; side < kSides; ++side) {
      const auto [first, count] = fit.span(side);
      std::vector<double> g(count);
      for (const double speed : {2e-3, 7e-3, 0.04, 0.08}) {
        fit.gradient(side, speed, g.data());
        for (std::size_t j = 0; j < count; ++j) {
          // A central difference through move(), which takes the same order of parameters.
          Eigen::VectorXd step = Eigen::VectorXd::Zero(p);
          const double h = 1e-6;
          step(static_cast<Eigen::Index>(first + j)) = h;
          StaticFit up = fit, down = fit;
          up.move(step);
          down.move(-step);
          const double slope = (up.force(side, speed) - down.force(side, speed)) / (2.0 * h);
          ASSERT_NEAR(g[j], slope, 1e-5 * std::max(1.0, std::abs(slope))) << side << ' ' << speed << ' ' << j;
        }
      }
    }
  }
}

// Triangles reach one speed and little else: a ripple over it became two opposite Gaussians.
TEST(StaticFit, ANarrowRangeOfSpeedsTellsNoShape) {
  const auto ripple = [](int, double speed) { return viscous(0, speed) + 3.0 * std::sin(speed / 1e-3); };
  const std::array<SideSums, kSides> narrow = sums_of(ripple, 0.2, 0.08);
  for (const bool symmetric : {true, false}) {
    StaticOptions options;
    options.symmetric = symmetric;
    const StaticChoice c = choose_static(narrow, options);
    EXPECT_NE(c.fit.family, Family::kSymmetricStribeck);
    for (const BranchFit& branch : c.fit.branch) EXPECT_TRUE(branch.terms.empty());
    EXPECT_NEAR(c.fit.force(0, 0.09), viscous(0, 0.09), 3.0);
  }
  EXPECT_NE(choose_static(sums_of(ripple, 0.2), {}).fit.family,
            Family::kSymmetric);  // of a wide range it does
}

TEST(StaticFit, AWidthMovesByHalfAtMost) {
  StaticFit fit;
  fit.family = Family::kSymmetricStribeck;
  fit.coulomb = 40.0, fit.v0 = 8e-3;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(5);
  step(4) = -1.0;
  fit.move(step);
  EXPECT_DOUBLE_EQ(fit.v0, 4e-3);
}

// One standard error: the simplest candidate within it wins; one that is far worse does not, however simple.
TEST(StaticFit, PicksTheSimplestWithinOneStandardError) {
  const std::vector<std::vector<double>> loss{
      {100, 104, 96, 101, 99}, {101, 102, 97, 103, 98}, {150, 160, 140, 151, 149}};
  const Picked p = pick(loss, {9, 4, 2}, {9, 4, 2}, 500.0, 10.0);
  EXPECT_EQ(p.chosen, 1u);
  EXPECT_TRUE(p.equal[0]);
  EXPECT_TRUE(p.equal[1]);
  EXPECT_FALSE(p.equal[2]);
  EXPECT_DOUBLE_EQ(p.rms[0], 1.0);
  EXPECT_EQ(p.error[0], 0.0);
  // Paired differences of the second: 1, −2, 1, 2, −1, mean 0.2.
  EXPECT_NEAR(p.error[1],
              std::sqrt((0.64 + 4.84 + 0.64 + 3.24 + 1.44) * 5.0 / 4.0) / 500.0 / (2.0 * p.rms[1]), 1e-12);
}

// Half a percent of the error that every block shows: the exponent is known, though a further term would not be worth it.
TEST(StaticFit, PicksTheBetterOfTwoExponentsWhereItIsSure) {
  const std::vector<std::vector<double>> loss{{1000, 1040, 960, 1010, 990}, {1010, 1051, 969, 1020, 1001}};
  EXPECT_EQ(pick(loss, {6, 5}, {5, 5}, 500.0, 1000.0).chosen, 0u);
  EXPECT_EQ(pick(loss, {6, 5}, {6, 5}, 500.0, 1000.0).chosen, 1u);
  const std::vector<std::vector<double>> unsure{{1000, 1040, 960, 1010, 990}, {1060, 1001, 1009, 950, 1031}};
  EXPECT_EQ(pick(unsure, {6, 5}, {5, 5}, 500.0, 1000.0).chosen, 1u);
}

// Noise hides a rise from a share of the error, not from the standard error of many blocks.
TEST(StaticFit, PicksWhatExplainsAForceWorthItsFrictionHoweverLargeTheNoise) {
  const std::vector<std::vector<double>> loss{{1000, 1001, 999, 1000}, {1012, 1013, 1011, 1013}};
  EXPECT_EQ(pick(loss, {9, 2}, {9, 2}, 4.0, 1000.0).chosen, 1u);  // 3.5 N beside 1000 N
  EXPECT_EQ(pick(loss, {9, 2}, {9, 2}, 4.0, 100.0).chosen, 0u);
}

}  // namespace
}  // namespace stribeck::ident::map::static_fit_test
