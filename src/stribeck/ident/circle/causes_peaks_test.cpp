// Spikes of a circle's deviation, on virtual machines (test_virtual_circle.hpp).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/ident/circle/test_diagnosis.hpp>

namespace stribeck::ident::circle::causes_peaks_test {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr double kFeed = 0.05;

// Spikes narrower than the step of the rows (a quarter of a degree), also where the axis crosses a play at the same time: heights that the
// rows averaged were up to a third too small, and beside the play a tenth was left.
TEST(CausesPeaks, ASpikeNarrowerThanTheStepsOfTheRows) {
  for (const double backlash : {0.0, 3e-6}) {
    for (const double feed : {1.0 / 120.0, 1.0 / 30.0}) {
      VirtualMachine m;
      m.rate = 1000.0;
      m.spike[0] = 7e-6;
      m.spike_time = 0.012;
      m.backlash[0] = backlash;
      const Diagnosis d = diagnosis_of(m, {feed});
      const Cause& spike = cause_in(d, CauseKind::kReversalSpike, 0);
      EXPECT_TRUE(spike.found);
      EXPECT_NEAR(spike.size, 7e-6, 0.3e-6) << feed << ' ' << backlash;
      EXPECT_GT(spike.half_width, std::abs(spike.size - 7e-6)) << feed << ' ' << backlash;
      EXPECT_NEAR(cause_in(d, CauseKind::kBacklash, 0).size, backlash, 0.05e-6);
    }
  }
}

// A spike that reaches 50 degrees behind the reversal: with 32 degrees left out of the fit, the rest of it was taken for backlash.
TEST(CausesPeaks, ABroadSpikeIsNoBacklash) {
  VirtualMachine m;
  m.spike[0] = 10e-6;
  m.spike_time = 0.4;
  const Diagnosis d = diagnosis_of(m, {kFeed});
  ASSERT_FALSE(d.causes.empty());
  EXPECT_EQ(found_in(d).front(), "reversal spike x");
  // The top is 11 degrees behind the reversal, where the radius sees its cosine.
  const double top = m.spike_time * kFeed / m.radius;
  EXPECT_NEAR(cause_in(d, CauseKind::kReversalSpike, 0).size, 10e-6 * std::cos(top), 0.5e-6);
  EXPECT_LT(std::abs(cause_in(d, CauseKind::kBacklash, 0).size), 0.5e-6);
  EXPECT_THAT(d.remarks, Contains(HasSubstr("what x does behind its reversals reaches over")));
}

// The axis sticks and then swings beyond, which is the larger part: it was told to have too much compensation.
TEST(CausesPeaks, WhatComesFirstTellsTheCause) {
  for (const double height : {-9e-6, 9e-6}) {
    VirtualMachine m;
    m.spike[1] = height;
    m.spike_time = 0.1;
    m.before = 0.9;
    const Diagnosis d = diagnosis_of(m, {kFeed});
    const Cause& spike = cause_in(d, CauseKind::kReversalSpike, 1);
    ASSERT_TRUE(spike.found);
    EXPECT_GT(spike.size * height, 0.0);
    EXPECT_LT(spike.before * height, 0.0);
    EXPECT_THAT(spike.figures, Contains(testing::Field(&Cause::Figure::name, "before it")));
    EXPECT_THAT(
        std::string(words_of(d, spike).next_step),
        HasSubstr(height < 0.0 ? "switch on friction compensation" : "too strong or comes too early"));
    m.before = 0.0;
    const Diagnosis plain = diagnosis_of(m, {kFeed});
    EXPECT_TRUE(std::isnan(cause_in(plain, CauseKind::kReversalSpike, 1).before));
  }
}

// A ball-bar of rows every 0.19 degrees, of which five are on a spike: its height was the mean over the step, 4.4 of 7 um.
TEST(CausesPeaks, ASpikeOfFewRows) {
  for (const double height : {7e-6, -7e-6}) {
    VirtualMachine m;
    m.rate = 50.0;
    m.spike[0] = height;
    m.spike_time = 0.04;
    const Diagnosis d = diagnosis_of(m, {1.0 / 60.0});
    const Cause& spike = cause_in(d, CauseKind::kReversalSpike, 0);
    EXPECT_TRUE(spike.found);
    EXPECT_NEAR(spike.size, height, 0.4e-6);
    EXPECT_GT(spike.half_width, std::abs(spike.size - height));
    EXPECT_EQ(found_in(d).size(), 1U);
  }
}

// A low spike whose top lies where the axis crosses its play: its tail behind the play was stated, 1.1 of 2 um, as if it were the top.
TEST(CausesPeaks, ALowSpikeWithinThePlay) {
  VirtualMachine m;
  m.rate = 1000.0;
  m.noise = 0.05e-6;
  m.spike[0] = 2e-6;
  m.spike_time = 0.04;
  m.backlash[0] = 6e-6;
  const Diagnosis d = diagnosis_of(m, {1.0 / 60.0});
  const Cause& spike = cause_in(d, CauseKind::kReversalSpike, 0);
  EXPECT_TRUE(spike.found);
  EXPECT_NEAR(spike.size, 2e-6, 0.15e-6);
  EXPECT_GT(spike.half_width, std::abs(spike.size - 2e-6));
}

// With few rows in the play the top is not seen: said, and the interval is that of one reversal.
TEST(CausesPeaks, ATopThatThePlayHidesIsAtLeastAsHigh) {
  VirtualMachine m;
  m.rate = 70.0;
  m.noise = 0.05e-6;
  m.spike[0] = 6e-6;
  m.spike_time = 0.04;
  m.backlash[0] = 5e-6;
  const Diagnosis d = diagnosis_of(m, {1.0 / 60.0});
  const Cause& spike = cause_in(d, CauseKind::kReversalSpike, 0);
  EXPECT_TRUE(spike.found);
  EXPECT_GT(spike.size + spike.half_width, 6e-6);
  EXPECT_THAT(d.remarks, Contains(HasSubstr("at least as high as stated")));
}

// Rows 4 ms apart on a spike of 20 ms: the flanks were taken for noise, and a coarse mean for the height.
TEST(CausesPeaks, TheFlanksOfASpikeAreNoNoise) {
  VirtualMachine m;
  m.noise = 0.05e-6;
  m.spike[0] = 6e-6;
  m.spike_time = 0.02;
  const Diagnosis d = diagnosis_of(m, {1.0 / 60.0});
  const Cause& spike = cause_in(d, CauseKind::kReversalSpike, 0);
  EXPECT_NEAR(spike.size, 6e-6, 0.25e-6);
  EXPECT_GT(spike.half_width, std::abs(spike.size - 6e-6));
}

// Stick-slip bends the whole circle: no advice on compensation, which was to be reduced.
TEST(CausesPeaks, ABroadSpikeGetsNoAdviceOnCompensation) {
  VirtualMachine m;
  m.spike[0] = -10e-6;
  m.spike_time = 0.4;
  const Diagnosis d = diagnosis_of(m, {kFeed});
  const Cause& spike = cause_in(d, CauseKind::kReversalSpike, 0);
  ASSERT_TRUE(spike.found && spike.broad);
  EXPECT_THAT(std::string(words_of(d, spike).next_step), HasSubstr("stick-slip"));
}

}  // namespace
}  // namespace stribeck::ident::circle::causes_peaks_test
