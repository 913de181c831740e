// Causes of a circle's deviation, on virtual machines (test_virtual_circle.hpp).
// How often each cause is found, alone and in pairs: tests/acceptance/circle_causes_test.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/causes.hpp>
#include <stribeck/ident/circle/test_diagnosis.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::circle::causes_test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr double kFeed = 0.05;

// Limit: with no cause there is only noise, and nothing is found.
TEST(Causes, NoneWithoutACause) { EXPECT_TRUE(found_in(diagnosis_of({}, {kFeed})).empty()); }

// A spike of x beside a backlash of y that is compensated too much: the peaks are those of x, and the sizes come out.
TEST(Causes, SpikeAndNegativeBacklash) {
  VirtualMachine m;
  m.spike[0] = 3e-6;
  m.backlash[1] = -2e-6;
  const Diagnosis d = diagnosis_of(m, {kFeed});
  EXPECT_EQ(found_in(d), (std::vector<std::string>{"reversal spike x", "backlash y"}));
  // Three tenths of a micrometre is what the validation demands.
  EXPECT_NEAR(cause_in(d, CauseKind::kReversalSpike, 0).size, 3e-6, 0.3e-6);
  EXPECT_NEAR(cause_in(d, CauseKind::kBacklash, 1).size, -2e-6, 0.05e-6);
  EXPECT_NEAR(d.causes[0].share + d.causes[1].share, 1.0, 1e-12);
  ASSERT_EQ(d.peaks.size(), 8U);
  for (const QuadrantPeak& p : d.peaks) {
    if (p.axis != 0) continue;
    EXPECT_NEAR(p.height, 3e-6, 0.3e-6);
    // s·e^(1−s) squared is above a half from 0.44 to 1.86 of the time to its top, within two steps of a quarter of a degree.
    EXPECT_NEAR(p.delay, m.spike_time * kFeed / m.radius, 0.5 * kPi / 180.0);
    EXPECT_NEAR(p.width, 1.60 * m.spike_time * kFeed / m.radius, 0.5 * kPi / 180.0);
  }
  EXPECT_THAT(
      d.remarks,
      Contains(HasSubstr("a spike of friction cannot be distinguished from backlash that closes late")));
}

// Compensation that moves too far, within a tenth of a second of the reversal. Until it has moved, the axis stands outside of the fit,
// which was taken for a spike of that size.
TEST(Causes, ABacklashThatIsCompensatedTooMuchIsNoSpike) {
  VirtualMachine m;
  m.backlash[0] = -8e-6;
  std::mt19937_64 random(19);
  VirtualRecord r = travel(m, kFeed, 1.3, random);
  const double share = 1.0 - std::exp(-1.0 / (0.04 * m.rate));
  double followed = r.x.front() - r.cx.front();
  for (std::size_t i = 0; i < r.x.size(); ++i) {
    if (i > 0 && r.t[i] - r.t[i - 1] > 0.5) followed = r.x[i] - r.cx[i];
    followed += share * (r.x[i] - r.cx[i] - followed);
    r.x[i] = r.cx[i] + followed;
  }
  const auto d = diagnose({r.motion(m.radius)});
  ASSERT_TRUE(d);
  EXPECT_EQ(found_in(*d), (std::vector<std::string>{"backlash x"}));
  EXPECT_NEAR(cause_in(*d, CauseKind::kBacklash, 0).size, -8e-6, 0.1e-6);
}

// A record of two laps that begins on a quadrant, at rest: there the axis has not reversed in the first lap, and the mean of both laps
// had half of the spike.
TEST(Causes, TheBeginOfARunIsNoReversal) {
  VirtualMachine m;
  m.spike[0] = 20e-6;
  std::mt19937_64 random(19);
  const VirtualRecord whole = travel(m, kFeed, 3.0, random);
  VirtualRecord r;
  // From 0 degrees on in each direction, without what the reversal there does.
  bool started = false;
  double begin = 0.0;
  for (std::size_t i = 0; i < whole.x.size(); ++i) {
    started = started && whole.t[i] - whole.t[i - 1] < 0.5;
    if (!started && std::abs(std::atan2(whole.cy[i], whole.cx[i])) > 0.5 * kPi / 180.0) continue;
    if (!started) begin = whole.t[i];
    started = true;
    r.t.push_back(whole.t[i]), r.cx.push_back(whole.cx[i]), r.cy.push_back(whole.cy[i]);
    r.x.push_back(whole.t[i] - begin < 1.0 ? whole.cx[i] : whole.x[i]), r.y.push_back(whole.y[i]);
  }
  const auto d = diagnose({r.motion(m.radius)});
  ASSERT_TRUE(d);
  for (const QuadrantPeak& p : d->peaks) {
    if (p.axis == 0) {
      EXPECT_NEAR(p.height, 20e-6, 1e-6) << p.angle << ' ' << p.counter_clockwise;
    }
  }
}

// 220 degrees of the circle, in both directions and at two feeds: what they hold is found, with wider intervals.
TEST(Causes, OfArcs) {
  VirtualMachine m;
  m.backlash[0] = 6e-6;
  m.spike[1] = 5e-6;
  m.tilt = 60e-6;
  std::mt19937_64 random(19);
  for (const bool commanded : {true, false}) {
    std::vector<CircleMotion> all;
    for (const double feed : {kFeed, 2.5 * kFeed}) {
      const VirtualRecord whole = travel(m, feed, 1.3, random);
      VirtualRecord arcs;
      for (std::size_t i = 0; i < whole.x.size(); ++i) {
        if (whole.cy[i] < -std::sin(20.0 * kPi / 180.0) * m.radius) continue;
        arcs.t.push_back(whole.t[i]), arcs.x.push_back(whole.x[i]), arcs.y.push_back(whole.y[i]);
        if (commanded) arcs.cx.push_back(whole.cx[i]), arcs.cy.push_back(whole.cy[i]);
      }
      all.push_back(arcs.motion(m.radius));
      EXPECT_TRUE(all.back().arcs);
    }
    const auto d = diagnose(all);
    ASSERT_TRUE(d);
    const Cause& backlash = cause_in(*d, CauseKind::kBacklash, 0);
    EXPECT_TRUE(backlash.found);
    EXPECT_NEAR(backlash.size, 6e-6, 0.3e-6);
    const Cause& spike = cause_in(*d, CauseKind::kReversalSpike, 1);
    EXPECT_TRUE(spike.found);
    EXPECT_NEAR(spike.size, 5e-6, 0.5e-6);
    const Cause& squareness = cause_in(*d, CauseKind::kSquareness, 0);
    EXPECT_TRUE(squareness.found);
    EXPECT_NEAR(squareness.size, 0.5 * 60e-6 * m.radius, 0.6e-6);
    for (const std::string& one : found_in(*d))
      EXPECT_THAT(one, testing::AnyOf("backlash x", "reversal spike y", "squareness")) << commanded;
    // y reverses at +90 degrees alone.
    for (const QuadrantPeak& p : d->peaks) EXPECT_FALSE(p.axis == 1 && std::sin(p.angle) < 0.0);
    EXPECT_THAT(d->remarks, Contains(HasSubstr("an arc: ")));
  }
}

// Half a turn from border to border: one axis comes to one end alone, and play that differs between the ends would be lateral play of the other.
TEST(Causes, OfHalfATurn) {
  for (const int axis : {0, 1}) {
    VirtualMachine m;
    m.backlash[axis] = 5e-6;
    m.tilt = 60e-6;
    std::mt19937_64 random(19);
    const VirtualRecord whole = travel(m, kFeed, 1.3, random);
    VirtualRecord arcs;
    for (std::size_t i = 0; i < whole.x.size(); ++i) {
      if ((axis == 0 ? whole.cx[i] : whole.cy[i]) > 0.0) continue;
      arcs.t.push_back(whole.t[i]), arcs.x.push_back(whole.x[i]), arcs.y.push_back(whole.y[i]);
      arcs.cx.push_back(whole.cx[i]), arcs.cy.push_back(whole.cy[i]);
    }
    const auto d = diagnose({arcs.motion(m.radius)});
    ASSERT_TRUE(d);
    EXPECT_EQ(found_in(*d),
              (std::vector<std::string>{"squareness", axis == 0 ? "backlash x" : "backlash y"}));
    EXPECT_NEAR(cause_in(*d, CauseKind::kBacklash, axis).size, 5e-6, 0.2e-6);
  }
}

TEST(Causes, ASpikeAtOneEndOfAnAxis) {
  VirtualMachine m;
  m.spike[1] = 3e-6;
  m.spike_at_negative = 0.0;
  const Diagnosis d = diagnosis_of(m, {kFeed});
  EXPECT_EQ(found_in(d), (std::vector<std::string>{"reversal spike y"}));
  const Cause& spike = cause_in(d, CauseKind::kReversalSpike, 1);
  EXPECT_NEAR(spike.size, 3e-6, 0.3e-6);
  EXPECT_NEAR(spike.figures.back().value, 90.0, 1e-9);
}

// Their mean would be 2.5 um, and rank behind smaller causes.
TEST(Causes, SpikesOutwardsAtOneEndAndInwardsAtTheOther) {
  VirtualMachine m;
  m.spike[0] = 10e-6;
  m.spike_at_negative = -0.5;
  const Diagnosis d = diagnosis_of(m, {kFeed});
  const Cause& spike = cause_in(d, CauseKind::kReversalSpike, 0);
  ASSERT_TRUE(spike.found);
  EXPECT_NEAR(spike.size, 10e-6, 0.5e-6);
  EXPECT_NEAR(spike.effect, 15e-6, 0.7e-6);
  ASSERT_GE(spike.figures.size(), 2U);
  EXPECT_EQ(spike.figures[0].name, "at 0 deg");
  EXPECT_NEAR(spike.figures[0].value, 10.0, 0.5);
  EXPECT_EQ(spike.figures[1].name, "at 180 deg");
  EXPECT_NEAR(spike.figures[1].value, -5.0, 0.5);
}

// Vibration alone lifts some peaks and lowers others.
TEST(Causes, AVibrationIsNoSpike) {
  VirtualMachine m;
  m.vibration = 3e-6;
  m.vibration_frequency = 21.0;
  EXPECT_EQ(found_in(diagnosis_of(m, {kFeed})), (std::vector<std::string>{"vibration"}));
}

// In the radius an axis that vibrates alone shows its amplitude where it points outwards, and none where it goes along the circle.
TEST(Causes, AVibrationOfOneAxisHasItsNameAndAmplitude) {
  for (const int axis : {-1, 0, 1}) {
    VirtualMachine m;
    m.vibration = 1e-6;
    m.vibration_axis = axis;
    m.noise = 0.2e-6;
    const Diagnosis d = diagnosis_of(m, {kFeed});
    const auto vibration = std::find_if(d.causes.begin(), d.causes.end(),
                                        [](const Cause& c) { return c.kind == CauseKind::kVibration; });
    ASSERT_NE(vibration, d.causes.end()) << axis;
    EXPECT_EQ(vibration->axis.value_or(-1), axis);
    EXPECT_NEAR(vibration->size, 1e-6, 0.1e-6) << axis;
  }
}

// Only the stronger one was named.
TEST(Causes, TwoVibrationsOfTwoAxes) {
  std::mt19937_64 random(19);
  VirtualMachine m;
  m.vibration = 0.7e-6;
  m.vibration_frequency = 18.0;
  m.vibration_axis = 0;
  VirtualRecord r = travel(m, kFeed, 2.2, random);
  for (std::size_t i = 0; i < r.y.size(); ++i) r.y[i] += 0.5e-6 * std::sin(2.0 * kPi * 90.0 * r.t[i]);
  const auto d = diagnose({r.motion(m.radius)});
  ASSERT_TRUE(d);
  EXPECT_EQ(found_in(*d), (std::vector<std::string>{"vibration x", "vibration y"}));
  EXPECT_NEAR(cause_in(*d, CauseKind::kVibration, 0).size, 0.7e-6, 0.03e-6);
  EXPECT_NEAR(cause_in(*d, CauseKind::kVibration, 1).size, 0.5e-6, 0.03e-6);
  EXPECT_NEAR(cause_in(*d, CauseKind::kVibration, 1).figures[0].value, 90.0, 0.1);
}

// A quarter of this circle has 390 rows, and 78 at a fifth of the rate.
TEST(Causes, AVibrationOnAShortQuarter) {
  VirtualMachine m;
  m.radius = 0.02;
  m.vibration = 2.5e-6;
  const Diagnosis d = diagnosis_of(m, {0.02});
  const Cause& vibration = cause_in(d, CauseKind::kVibration, 0);
  EXPECT_TRUE(vibration.found);
  EXPECT_NEAR(vibration.size, 2.5e-6, 0.25e-6);
  EXPECT_NEAR(vibration.figures[0].value, 37.0, 1.0);
  m.rate = 50.0;
  EXPECT_THAT(diagnosis_of(m, {0.02}).remarks,
              Contains(HasSubstr("too few rows between the reversals to look for a vibration")));
}

// On a circle of 300 mm the pitch of a screw is 0.95 degrees where the axis is fastest.
TEST(Causes, ThePitchOfAScrewOnALargeCircle) {
  VirtualMachine m;
  m.radius = 0.3;
  m.cyclic[0] = 2e-6;
  m.pitch[0] = 5e-3;
  const Diagnosis d = diagnosis_of(m, {kFeed});
  EXPECT_EQ(found_in(d), (std::vector<std::string>{"cyclic error x"}));
  const Cause& cyclic = cause_in(d, CauseKind::kCyclic, 0);
  EXPECT_NEAR(cyclic.size, 2e-6, 0.1e-6);
  EXPECT_NEAR(cyclic.figures[0].value, 5.0, 0.01);
  // Samples five millimetres apart show its image, which is none.
  m.rate = 10.0;
  EXPECT_THAT(found_in(diagnosis_of(m, {kFeed})), Not(Contains(HasSubstr("cyclic"))));
}

TEST(Causes, LapsThatDriftAreNamed) {
  VirtualMachine m;
  std::mt19937_64 random(19);
  m.drift[0] = 0.07e-6;
  const auto d = diagnose({travel(m, kFeed, 3.3, random).motion(m.radius)});
  ASSERT_TRUE(d);
  // 12.6 s for a lap.
  EXPECT_THAT(d->remarks, Contains(HasSubstr("from one lap to the next the centre moves by 0.88 µm")));
  m.drift[0] = 0.0;
  const auto still = diagnose({travel(m, kFeed, 3.3, random).motion(m.radius)});
  EXPECT_THAT(still->remarks, Not(Contains(HasSubstr("from one lap to the next"))));
}

// A backlash of 3 um was taken for a long window behind the reversals where the centre drifted by half a micrometre, and was gone.
TEST(Causes, ADriftOfTheCentreHidesNoCause) {
  for (const double turns : {1.3, 3.3}) {
    VirtualMachine m;
    std::mt19937_64 random(19);
    m.backlash[0] = 3e-6;
    m.tilt = 20e-6;
    m.noise = 0.05e-6;
    const double length = 2.0 * (turns + 0.25) * 2.0 * kPi * m.radius / kFeed;  // of the log [s]
    m.drift[0] = 2e-6 / length;
    const auto d = diagnose({travel(m, kFeed, turns, random).motion(m.radius)});
    ASSERT_TRUE(d);
    EXPECT_THAT(found_in(*d), testing::IsSupersetOf({"backlash x", "squareness", "centre drift"})) << turns;
    EXPECT_NEAR(cause_in(*d, CauseKind::kBacklash, 0).size, 3e-6, 0.1e-6) << turns;
    // The first quarter of each direction is no part of it.
    EXPECT_NEAR(cause_in(*d, CauseKind::kDrift, 0).size, 2e-6, 0.3e-6) << turns;
    EXPECT_EQ(cause_in(*d, CauseKind::kDrift, 0).share, 0.0);
    m.drift[0] = 0.0;
    EXPECT_THAT(found_in(*diagnose({travel(m, kFeed, turns, random).motion(m.radius)})),
                Not(Contains("centre drift")));
  }
}

// Invariance: with x and y exchanged, every cause is that of the other axis, and the direction of the lag turns round.
TEST(Causes, AxesExchanged) {
  VirtualMachine m;
  m.backlash[0] = 4e-6;
  m.scale[1] = 30e-6;
  m.cyclic[1] = 1e-6;
  VirtualMachine other = m;
  std::swap(other.backlash[0], other.backlash[1]);
  std::swap(other.scale[0], other.scale[1]);
  std::swap(other.cyclic[0], other.cyclic[1]);
  const Diagnosis a = diagnosis_of(m, {kFeed});
  const Diagnosis b = diagnosis_of(other, {kFeed});
  EXPECT_NEAR(cause_in(a, CauseKind::kBacklash, 0).size, cause_in(b, CauseKind::kBacklash, 1).size, 0.03e-6);
  EXPECT_NEAR(cause_in(a, CauseKind::kScaleMismatch, 0).size, -cause_in(b, CauseKind::kScaleMismatch, 0).size,
              0.03e-6);
  const Cause& cyclic = cause_in(a, CauseKind::kCyclic, 1);
  EXPECT_NEAR(cyclic.size, cause_in(b, CauseKind::kCyclic, 0).size, 0.03e-6);
  EXPECT_NEAR(cyclic.size, 1e-6, 0.03e-6);
  EXPECT_EQ(cyclic.figures[0].name, "pitch");
  EXPECT_NEAR(cyclic.figures[0].value, 10.0, 0.02);
  EXPECT_NEAR(cyclic.figures[1].value, 0.7 * 180.0 / kPi, 3.0);
}

// The instrument 1 mm off, on a circle of 100 mm: the second order of the offset, 2.5 um, is no radius, no mismatch and no squareness.
TEST(Causes, AnOffsetOfTheCentreIsNoOtherCause) {
  VirtualMachine m;
  m.offset[0] = 0.8e-3;
  m.offset[1] = 0.6e-3;
  m.backlash[0] = 5e-6;
  const Diagnosis d = diagnosis_of(m, {kFeed});
  EXPECT_EQ(found_in(d), (std::vector<std::string>{"backlash x", "centre offset"}));
  const Cause& centre = cause_in(d, CauseKind::kCentre, 0);
  EXPECT_NEAR(centre.size, 1e-3, 1e-6);
  EXPECT_NEAR(centre.effect, 2e-3, 2e-6);
  EXPECT_NEAR(centre.figures[0].value, 800.0, 1.0);
  EXPECT_NEAR(centre.figures[1].value, 600.0, 1.0);
  EXPECT_NEAR(cause_in(d, CauseKind::kBacklash, 0).size, 5e-6, 0.05e-6);
  EXPECT_NEAR(cause_in(d, CauseKind::kRadius, 0).size, 0.0, 0.03e-6);
  EXPECT_NEAR(cause_in(d, CauseKind::kSquareness, 0).size, 0.0, 0.03e-6);
}

/// A ball-bar 1 mm off the centre of a machine that is larger by 3 um and 4 um oval; the angle of the command, or of the positions.
CircleMotion ball_bar_off(bool of_command) {
  std::vector<double> x, y, rx, ry;
  for (const double way : {1.0, -1.0}) {
    for (int i = 0; i < 2000; ++i) {
      const double a = 0.1 + way * 2.0 * kPi * 1.05 * i / 2000;
      const double r = 0.1 + 3e-6 + 4e-6 * std::cos(2.0 * a);
      const double px = r * std::cos(a) + 0.8e-3, py = r * std::sin(a) + 0.6e-3;
      const double angle = of_command ? a : std::atan2(py, px);
      x.push_back(std::hypot(px, py) * std::cos(angle)), y.push_back(std::hypot(px, py) * std::sin(angle));
      rx.push_back(0.1 * std::cos(angle)), ry.push_back(0.1 * std::sin(angle));
    }
  }
  CircleMotion m = circle_motion({x, y, rx, ry}, {}, 0.1);
  m.ball_bar = true;
  return m;
}

TEST(Causes, ABallBarMayHaveTheAngleOfTheCommandOrOfThePositions) {
  for (const bool of_command : {true, false}) {
    const auto d = diagnose({ball_bar_off(of_command)});
    ASSERT_TRUE(d);
    EXPECT_NEAR(cause_in(*d, CauseKind::kRadius, 0).size, 3e-6, 0.02e-6) << of_command;
    EXPECT_NEAR(cause_in(*d, CauseKind::kScaleMismatch, 0).size, 4e-6, 0.02e-6) << of_command;
    EXPECT_NEAR(cause_in(*d, CauseKind::kSquareness, 0).size, 0.0, 0.02e-6) << of_command;
    EXPECT_NEAR(cause_in(*d, CauseKind::kCentre, 0).size, 1e-3, 0.02e-6) << of_command;
  }
}

// The line lies between two of the spectrum, which are 0.49 Hz apart.
TEST(Causes, TheFrequencyOfAVibrationIsBetweenTheLinesToo) {
  VirtualMachine m;
  m.vibration = 1e-6;
  for (const double f : {31.0, 31.2, 31.35}) {
    m.vibration_frequency = f;
    const Diagnosis d = diagnosis_of(m, {kFeed});
    EXPECT_EQ(found_in(d), std::vector<std::string>{"vibration"});
    const Cause& v = cause_in(d, CauseKind::kVibration, 0);
    EXPECT_NEAR(v.size, 1e-6, 0.1e-6);
    EXPECT_EQ(v.figures[0].name, "frequency");
    EXPECT_NEAR(v.figures[0].value, f, 0.05) << f;
    EXPECT_GT(v.figures[0].half_width, 0.0);
    EXPECT_LT(v.figures[0].half_width, 0.1);
    EXPECT_THAT(d.remarks, Contains(HasSubstr("rows at 250 Hz tell vibrations up to 125 Hz")));
  }
}

// One direction cannot tell squareness from servo mismatch, and says so; two feeds tell a lag from a small radius.
TEST(Causes, SaysWhatCannotBeToldApart) {
  VirtualMachine m;
  m.tilt = 40e-6;
  std::mt19937_64 random(3);
  VirtualRecord record = travel(m, kFeed, 1.3, random);
  const std::size_t half = record.t.size() / 2;
  for (auto* column : {&record.t, &record.x, &record.y, &record.cx, &record.cy}) column->resize(half);
  CircleMotion grid = record.motion(m.radius);
  grid.scale = true;
  const auto one = diagnose({grid});
  ASSERT_TRUE(one);
  EXPECT_EQ(found_in(*one), std::vector<std::string>{"squareness"});
  EXPECT_THAT(one->remarks, Contains(HasSubstr("squareness cannot be distinguished from servo mismatch")));
  VirtualMachine lagging;
  lagging.lag[0] = lagging.lag[1] = 0.02;
  const Diagnosis slow = diagnosis_of(lagging, {kFeed});
  EXPECT_EQ(found_in(slow), std::vector<std::string>{"radius"});
  EXPECT_THAT(slow.remarks, Contains(HasSubstr("measure at a second feed")));
  const Diagnosis both = diagnosis_of(lagging, {kFeed / 3.0, kFeed});
  EXPECT_EQ(found_in(both), std::vector<std::string>{"lag"});
  // V²T²/(2R)
  EXPECT_NEAR(cause_in(both, CauseKind::kLag, 0).size, 5e-6, 0.1e-6);
  EXPECT_NEAR(cause_in(both, CauseKind::kLag, 0).figures[0].value, 20.0, 0.3);
}

// The encoders of the axes see no squareness: in a log of a control, one direction tells which axis follows later.
TEST(Causes, OneDirectionOfAControlTellsTheServoMismatch) {
  VirtualMachine m;
  m.lag[0] = 0.15e-3;
  std::mt19937_64 random(4);
  VirtualRecord record = travel(m, kFeed, 1.3, random);
  const std::size_t half = record.t.size() / 2;
  for (auto* column : {&record.t, &record.x, &record.y, &record.cx, &record.cy}) column->resize(half);
  const auto d = diagnose({record.motion(m.radius)});
  ASSERT_TRUE(d);
  EXPECT_EQ(found_in(*d), std::vector<std::string>{"servo mismatch"});
  EXPECT_NEAR(cause_in(*d, CauseKind::kServoMismatch, 0).figures.at(0).value, 0.15, 0.01);
  EXPECT_THAT(d->remarks, Not(Contains(HasSubstr("squareness cannot"))));
}

// Too few rows: no diagnosis in place of a poor one.
TEST(Causes, NoneOfFewRows) {
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i <= 100; ++i) {
    x.push_back(0.1 * std::cos(2.0 * kPi * i / 100));
    y.push_back(0.1 * std::sin(2.0 * kPi * i / 100));
  }
  const CircleMotion m = circle_motion({x, y, {}, {}}, {}, 0.1);
  ASSERT_EQ(m.runs.size(), 1U);
  EXPECT_FALSE(diagnose({m}).has_value());
}

// A soft loop under friction looks the same, and its own encoder sees no play.
TEST(Causes, BacklashInPositionsOfALoopIsNotToBeTypedIn) {
  VirtualMachine m;
  m.backlash[0] = 8e-6;
  std::mt19937_64 random(19);
  const VirtualRecord r = travel(m, kFeed, 1.3, random);
  CircleMotion motion = r.motion(m.radius);
  const auto next_step = [](const CircleMotion& one) {
    const auto d = diagnose({one});
    return std::string(words_of(d.value(), CauseKind::kBacklash).next_step);
  };
  EXPECT_THAT(next_step(motion), HasSubstr("do not enter it as backlash"));
  motion.scale = true;
  EXPECT_THAT(next_step(motion), HasSubstr("then add this value to the backlash compensation"));
  motion.scale = false;
  motion.ball_bar = true;
  EXPECT_THAT(next_step(motion), HasSubstr("then add this value to the backlash compensation"));
}

// An encoder sees its own axis alone: nothing may be aligned or entered by what its positions look like.
TEST(Causes, WhatEncodersOfTheAxesCannotSeeIsNotToBeSetRight) {
  Diagnosis own;
  own.own_encoder = true;
  for (const CauseKind kind : {CauseKind::kSquareness, CauseKind::kStraightness, CauseKind::kLateralPlay}) {
    EXPECT_THAT(std::string(words_of(own, kind).meaning), HasSubstr("which their own encoders cannot see"));
    EXPECT_FALSE(words_of(own, kind).parameter);
    EXPECT_EQ(words_of(Diagnosis{}, kind).meaning, words_of(kind).meaning);
  }
  EXPECT_THAT(std::string(words_of(own, CauseKind::kCentre).meaning), Not(HasSubstr("instrument")));
  // A compensation that pushes too much is on already.
  const auto next_of = [](const Diagnosis& of, CauseKind kind, double size) {
    Cause cause;
    cause.kind = kind;
    cause.size = size;
    return std::string(words_of(of, cause).next_step);
  };
  EXPECT_THAT(next_of({}, CauseKind::kReversalSpike, -3e-6), HasSubstr("too strong: reduce"));
  EXPECT_THAT(next_of({}, CauseKind::kReversalSpike, 3e-6), HasSubstr("switch on friction compensation"));
  EXPECT_THAT(next_of(own, CauseKind::kBacklash, -3e-6), HasSubstr("too strong: reduce"));
  EXPECT_THAT(next_of(own, CauseKind::kBacklash, 3e-6), HasSubstr("compensate it"));
  EXPECT_THAT(next_of({}, CauseKind::kBacklash, -3e-6), HasSubstr("a negative one lowers it"));
  EXPECT_THAT(std::string(words_of(Diagnosis{}, CauseKind::kCentre).meaning), HasSubstr("instrument"));
}

TEST(Causes, EachHasANextStep) {
  for (const auto& [kind, name] : EnumNames<CauseKind>::names) {
    EXPECT_FALSE(words_of(kind).meaning.empty()) << name;
    EXPECT_FALSE(words_of(kind).next_step.empty()) << name;
  }
}

}  // namespace
}  // namespace stribeck::ident::circle::causes_test
