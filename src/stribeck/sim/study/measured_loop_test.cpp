#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stribeck/control/laws.hpp>
#include <stribeck/sim/study/held_drive.hpp>
#include <stribeck/sim/study/loop_margins.hpp>
#include <stribeck/sim/study/measured_loop.hpp>

namespace stribeck::sim::measured_loop_test {
namespace {

constexpr double kPeriod = 1e-3;
constexpr double kMass = 1000.0;
const MarginRule kRule{kPi / 4.0, 2.0};

/// The response of a drive, as exact as a computation can be.
MeasuredPlant plant(const std::optional<plant::AxialMode>& mode = {}, double half_width = 0.0,
                    double delay = 0.0, double top = 480.0) {
  const HeldDrive drive(kMass, kPeriod, delay, mode);
  MeasuredPlant out{kPeriod, {}, {}, {}};
  for (double hz = 1.0; hz < top; hz *= 1.003) {
    out.omega.push_back(2.0 * kPi * hz);
    out.response.push_back(drive.at(out.omega.back()));
    out.half_width.push_back(half_width);
  }
  return out;
}

// Margins measured on the law itself, by another computation.
TEST(MeasuredLoop, MarginsAreThoseOfTheLaw) {
  control::Setup<2> setup;
  setup.period = kPeriod;
  for (auto& c : setup.compensation) {
    c.model.mass = kMass;
    c.observer = control::Observer::kNone;
    c.model.delay = 0.7 * kPeriod;
  }
  for (const double omega : {40.0, 120.0, 250.0}) {
    const LoopMargins law = loop_margins<2>(control::ContouringParams::critical(omega, omega), setup);
    const MeasuredMargins m = measured_margins(plant({}, 0.0, 0.7 * kPeriod), {kMass, omega, {}});
    EXPECT_EQ(m.stable, law.stable);
    // Straight lines between frequencies 0.3 % apart.
    EXPECT_NEAR(m.phase, law.phase, 1e-4);
    EXPECT_NEAR(m.gain_up, law.gain_up, 1e-3 * law.gain_up);
    EXPECT_NEAR(m.crossover, law.crossover, 1e-4 * law.crossover);
  }
}

TEST(MeasuredLoop, AnUnstableLoopIsCalledUnstable) {
  EXPECT_TRUE(measured_margins(plant(), {kMass, 300.0, {}}).stable);
  EXPECT_FALSE(measured_margins(plant({}, 0.0, 3.0 * kPeriod), {kMass, 300.0, {}}).stable);
}

/// Largest error of the last tenth of 4 s after a step of the reference: two masses, force on the first, whose position is measured.
double left_after_step(const plant::AxialMode& mode, double omega) {
  const double table = mode.table_share * kMass, drive = kMass - table;
  const double own = 2.0 * kPi * mode.frequency;
  const double stiffness = table * own * own, damping = 2.0 * mode.damping_ratio * table * own;
  double x = 0.0, v = 0.0, y = 0.0, w = 0.0, before = 0.0, left = 0.0;
  constexpr int kSteps = 4000, kParts = 200;
  for (int k = 0; k < kSteps; ++k) {
    const double e = 1e-3 - x;
    const double force = kMass * (omega * omega * e + 2.0 * omega * (e - before) / kPeriod);
    before = e;
    for (int i = 0; i < kParts; ++i) {  // semi-implicit Euler at 5 µs
      const double spring = stiffness * (x - y) + damping * (v - w);
      constexpr double kStep = kPeriod / kParts;
      v += kStep * (force - spring) / drive, w += kStep * spring / table;
      x += kStep * v, y += kStep * w;
    }
    if (k > 9 * kSteps / 10) left = std::max(left, std::abs(e));
  }
  return left;
}

// The peak of a resonance behind its own antiresonance rises through 1 with phase lead, where arg(−L) is far below zero.
TEST(MeasuredLoop, AResonanceWithLeadIsNoInstability) {
  const plant::AxialMode mode{55.0, 0.03, 0.4};
  const MeasuredMargins m = measured_margins(plant(mode), {kMass, 60.0, {}});
  EXPECT_LT(left_after_step(mode, 60.0), 1e-6);
  EXPECT_TRUE(m.stable);
  EXPECT_GT(m.phase, 1.0);
  const LoopProposal p = propose_loop(plant(mode), kMass, kRule, {});
  EXPECT_GT(p.omega, 100.0);
  EXPECT_LT(left_after_step(mode, p.omega), 1e-6);
}

TEST(MeasuredLoop, AWideIntervalTakesItsPartOfTheMargins) {
  const MeasuredMargins sure = measured_margins(plant(), {kMass, 100.0, {}});
  const MeasuredMargins wide = measured_margins(plant({}, 0.2), {kMass, 100.0, {}});
  EXPECT_NEAR(sure.sure_phase, sure.phase, 1e-12);
  EXPECT_NEAR(wide.sure_phase, wide.phase - std::asin(0.2), 1e-9);
  EXPECT_NEAR(wide.sure_gain, wide.gain_up / 1.2, 1e-9 * wide.gain_up);
}

TEST(MeasuredLoop, TheProposalKeepsTheRuleAndTheNextOneDoesNot) {
  const MeasuredPlant p = plant({}, 0.05);
  const LoopProposal found = propose_loop(p, kMass, kRule);
  EXPECT_EQ(found.limit, LoopLimit::kPhase);
  EXPECT_GE(found.margins.sure_phase, kRule.phase);
  EXPECT_GE(found.margins.sure_gain, kRule.gain);
  EXPECT_LT(measured_margins(p, {kMass, 1.02 * found.omega, {}}).sure_phase, kRule.phase);
}

TEST(MeasuredLoop, SaysWhereTheIntervalLimitsAndNotTheLoop) {
  EXPECT_FALSE(propose_loop(plant({}, 0.001), kMass, kRule).unsure);
  EXPECT_TRUE(propose_loop(plant({}, 0.2), kMass, kRule).unsure);
}

// A line at the ripple of the screw is poorly known: a loop ten times as slow was proposed, beside a present one that keeps the rule.
TEST(MeasuredLoop, OnePoorlyKnownLineIsNoLimit) {
  MeasuredPlant p = plant({}, 0.02);
  const LoopProposal before = propose_loop(p, kMass, kRule);
  const auto line = static_cast<std::size_t>(
      std::lower_bound(p.omega.begin(), p.omega.end(), 0.3 * before.omega) - p.omega.begin());
  p.half_width.at(line) = 0.9;
  double least = 10.0;
  for (double omega = 0.05 * before.omega; omega < 0.3 * before.omega; omega *= 1.01)
    least = std::min(least, measured_margins(p, {kMass, omega, {}}).sure_phase);
  EXPECT_LT(least, kRule.phase);
  const LoopProposal found = propose_loop(p, kMass, kRule);
  EXPECT_DOUBLE_EQ(found.omega, before.omega);
  EXPECT_DOUBLE_EQ(found.limit_at, before.limit_at);
}

// A band that is poorly known in front of the crossover may hide anything: no loop beyond it is sure.
TEST(MeasuredLoop, APoorlyKnownBandIsALimit) {
  MeasuredPlant p = plant({}, 0.02);
  const LoopProposal before = propose_loop(p, kMass, kRule);
  for (std::size_t k = 0; k < p.omega.size(); ++k) {
    if (p.omega[k] > 0.8 * before.omega && p.omega[k] < before.omega) p.half_width[k] = 0.9;
  }
  const LoopProposal found = propose_loop(p, kMass, kRule);
  EXPECT_LT(found.omega, 0.6 * before.omega);
  EXPECT_TRUE(found.unsure);
}

TEST(MeasuredLoop, WhatIsNotMeasuredIsNotProposed) {
  const LoopProposal found = propose_loop(plant({}, 0.0, 0.0, 40.0), kMass, kRule);
  EXPECT_EQ(found.limit, LoopLimit::kMeasured);
  EXPECT_LT(2.0 * found.omega, 2.0 * kPi * 40.0);  // crosses 1 at about twice ω
}

TEST(MeasuredLoop, ANotchHelpsWhereAResonanceLimitsAndOnlyThere) {
  const plant::AxialMode mode{40.0, 0.02, 0.4};
  const double resonance = 2.0 * kPi * 40.0 * std::sqrt(1.0 + 0.4 / 0.6);
  const MeasuredPlant p = plant(mode, 0.0, 3.0 * kPeriod);
  const LoopProposal without = propose_loop(p, kMass, kRule);
  EXPECT_NEAR(without.limit_at, resonance, 0.3 * resonance);
  const auto with = propose_notch(p, kMass, kRule, resonance, 0.05, without.omega);
  ASSERT_TRUE(with);
  EXPECT_GT(with->omega, 7.0 / 6.0 * without.omega);
  // Also where the resonance has moved.
  for (const double off : {0.95, 1.0, 1.05}) {
    const MeasuredMargins m =
        measured_margins(plant(plant::AxialMode{40.0 * off, 0.02, 0.4}, 0.0, 3.0 * kPeriod),
                         {kMass, with->omega, with->notch});
    EXPECT_TRUE(m.stable);
    EXPECT_GT(m.phase, 0.95 * kRule.phase);  // not only the resonance moves here
  }
}

// A range one hertz wide between loops that are too slow to be damped is no place for a loop.
TEST(MeasuredLoop, ANarrowRangeThatKeepsTheRuleIsPassedOver) {
  MeasuredPlant p = plant();
  for (std::size_t k = 0; k < p.omega.size(); ++k) {
    const double hz = p.omega[k] / (2.0 * kPi);
    if (hz < 12.0 && (hz < 3.0 || hz > 4.0)) p.response[k] *= std::polar(1.0, -0.6);
  }
  const LoopProposal found = propose_loop(p, kMass, kRule);
  EXPECT_GT(found.margins.crossover, 2.0 * kPi * 12.0);
  EXPECT_EQ(found.omega, propose_loop(plant(), kMass, kRule).omega);
}

TEST(Notch, HasItsDepthInTheMiddleAndLeavesTheEnds) {
  const Notch n{600.0, 0.1, 0.5};
  EXPECT_NEAR(std::abs(n.at(600.0, kPeriod)), 0.1, 1e-12);
  EXPECT_NEAR(std::abs(n.at(1e-3, kPeriod) - 1.0), 0.0, 1e-5);
  EXPECT_NEAR(std::abs(n.at(kPi / kPeriod, kPeriod)), 1.0, 1e-9);
}

}  // namespace
}  // namespace stribeck::sim::measured_loop_test
