#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/map/periodic.hpp>
#include <stribeck/ident/refused.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::map::periodic_test {
namespace {

using friction::EccentricForm;
using ::testing::HasSubstr;

/// Strokes of 0.2 m there and back at several speeds, 1 ms rows, first-order noise of 1 N.
struct Motion {
  std::vector<double> speeds{0.03, 0.06, 0.1};
  double length = 0.2;
  double noise = 1.0;
  double noise_time = 5e-3;
  bool both = true;
};

PeriodicRows strokes(const Motion& m, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  const double rho = m.noise_time > 0.0 ? std::exp(-1e-3 / m.noise_time) : 0.0;
  double d = m.noise * normal(engine);
  PeriodicRows rows;
  std::size_t at = 0;
  for (const double speed : m.speeds) {
    for (const int direction : {1, -1}) {
      for (double s = 0.0; s < m.length; s += 1e-3 * speed, ++at) {
        d = rho * d + std::sqrt(1.0 - rho * rho) * m.noise * normal(engine);
        if (direction < 0 && !m.both) continue;
        rows.x.push_back(direction > 0 ? s : m.length - s);
        rows.e.push_back(d);
        rows.direction.push_back(direction);
        rows.record.push_back(0);
        rows.at.push_back(at);
      }
    }
  }
  return rows;
}

void add(PeriodicRows& rows, double amplitude, double period, double phase, bool reversing = false) {
  for (std::size_t i = 0; i < rows.x.size(); ++i) {
    rows.e[i] +=
        amplitude * std::sin(2.0 * kPi * rows.x[i] / period - phase) * (reversing ? rows.direction[i] : 1.0);
  }
}

bool inside(const Interval& i, double truth) { return i.low <= truth && truth <= i.high; }

// A screw whose turn pushes and rubs: one period in both forms. In passes of one direction their sum is seen, in those of the other their
// difference, so that neither of them held in the other passes; and two neighbouring periods were each other's background.
TEST(Periodic, TermsThatHideEachOtherAreFoundTogether) {
  for (const double phase : {0.4, 1.0, 2.0}) {
    PeriodicRows rows = strokes({.speeds = {0.003, 0.01, 0.03, 0.1}}, 5);
    add(rows, 12.0, 10e-3, 0.4);
    add(rows, 15.0, 10e-3, phase, true);
    const PeriodicResult r = find_periodic(rows);
    ASSERT_EQ(r.terms.size(), 2u) << phase;
    EXPECT_EQ(r.terms[0].term.form, friction::EccentricForm::kProportional);
    EXPECT_NEAR(r.terms[0].term.amplitude, 15.0, 0.2);
    EXPECT_NEAR(r.terms[1].term.amplitude, 12.0, 0.2);
    EXPECT_TRUE(inside(r.terms[1].period, 10e-3));
  }
  PeriodicRows near = strokes({.speeds = {0.005, 0.02, 0.08}}, 6);
  add(near, 10.0, 10e-3, 0.2);
  add(near, 10.0, 9.2e-3, 1.0);
  const PeriodicResult r = find_periodic(near);
  ASSERT_EQ(r.terms.size(), 2u);
  EXPECT_NEAR(r.terms[0].term.amplitude, 10.0, 0.2);
  EXPECT_NEAR(r.terms[1].term.amplitude, 10.0, 0.2);
}

// Closed form: without noise the term comes back, its period to a millionth although the resolution λ²/stroke is
// a hundredth of it. Left are polynomials and tapers, which the projection of the regressors takes out.
TEST(Periodic, WithoutNoiseTheTermComesBack) {
  for (const bool reversing : {false, true}) {
    PeriodicRows rows = strokes({.noise = 0.0}, 1);
    add(rows, 1.3, 2.513e-3, 0.7, reversing);
    const PeriodicResult r = find_periodic(rows);
    ASSERT_EQ(r.terms.size(), 1u);
    const PeriodicTerm& t = r.terms.front();
    EXPECT_NEAR(t.term.amplitude, 1.3, 1e-5);
    EXPECT_NEAR(t.term.period, 2.513e-3, 1e-9);
    EXPECT_NEAR(t.term.phase, 0.7, 1e-4);
    EXPECT_EQ(t.term.form, reversing ? EccentricForm::kProportional : EccentricForm::kAdditive);
    EXPECT_TRUE(t.form_told);
    EXPECT_NEAR(t.share, 1.0, 1e-3);
    EXPECT_EQ(t.harmonic, 1);
  }
}

// 100 seeds, noise of 1 N that is correlated over 0.15 to 0.5 mm of travel: the 95 % intervals contain the truth in 90 % to
// 99 % of the cases. (Standard error of the share: 2 %. White-noise intervals would contain it in 50 %.)
TEST(Periodic, IntervalsHoldUnderCorrelatedNoise) {
  int amplitude = 0;
  int period = 0;
  int phase = 0;
  int found = 0;
  constexpr int kSeeds = 100;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    PeriodicRows rows = strokes({}, seed);
    add(rows, 0.5, 2.5e-3, -1.1, seed % 2 == 0);
    PeriodicOptions options;
    options.most = 1;
    options.shortest = 1e-3;
    const PeriodicResult r = find_periodic(rows, options);
    if (r.terms.empty()) continue;
    const PeriodicTerm& t = r.terms.front();
    if (std::abs(t.term.period - 2.5e-3) > 0.02e-3) continue;
    ++found;
    amplitude += inside(t.amplitude, 0.5);
    period += inside(t.period, 2.5e-3);
    phase += inside(t.phase, -1.1);
    EXPECT_EQ(t.term.form, seed % 2 == 0 ? EccentricForm::kProportional : EccentricForm::kAdditive);
  }
  EXPECT_EQ(found, kSeeds);
  for (const int share : {amplitude, period, phase}) {
    EXPECT_GE(share, 90);
    EXPECT_LE(share, 99);
  }
}

// Limit: nothing periodic. One in a thousand may be found by chance; of 60 seeds none or one.
TEST(Periodic, NoiseIsNoTerm) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    found += find_periodic(strokes({.noise_time = seed % 2 == 0 ? 0.05 : 2e-3}, seed)).terms.empty() ? 0 : 1;
  }
  EXPECT_LE(found, 1);
}

// Drift over the travel, the ring-down of reversals and steps between strokes of unequal length are smooth or local,
// not periodic.
TEST(Periodic, DriftTransientsAndUnequalStrokesAreNoTerm) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    PeriodicRows rows;
    std::size_t at = 0;
    int record = 0;
    for (const double length : {0.2, 0.1, 0.15, 0.05, 0.2}) {
      PeriodicRows part =
          strokes({.length = length, .noise = 0.2}, 100 * seed + static_cast<std::uint64_t>(record));
      for (std::size_t i = 0; i < part.x.size(); ++i) {
        const double x = part.x[i];
        const double way = part.direction[i] > 0 ? x : length - x;
        rows.x.push_back(x);
        rows.e.push_back(
            part.e[i] + 3.0 * std::exp(-way / 0.004) * std::cos(2.0 * kPi * way / 0.003) * part.direction[i] +
            2.0 * std::cos(kPi * x / 0.2) + 0.5 * part.direction[i] * record +
            1e-5 * static_cast<double>(at));
        rows.direction.push_back(part.direction[i]);
        rows.record.push_back(record);
        rows.at.push_back(part.at[i]);
        ++at;
      }
      ++record;
    }
    const PeriodicResult r = find_periodic(rows);
    EXPECT_TRUE(r.terms.empty()) << "seed " << seed << ": " << r.terms.front().term.period << " m, "
                                 << r.terms.front().term.amplitude << " N";
  }
}

// Hum is a line over the position in each pass of one speed, with another period in the passes of the next.
TEST(Periodic, AToneInTimeIsNoTerm) {
  std::size_t terms = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    PeriodicRows rows = strokes({.speeds = {0.03, 0.045, 0.06, 0.08, 0.1}, .noise = 0.3}, seed);
    const double frequency = 40.0 + 1.7 * static_cast<double>(seed);
    for (std::size_t i = 0; i < rows.e.size(); ++i)
      rows.e[i] += std::sin(2.0 * kPi * frequency * 1e-3 * static_cast<double>(rows.at[i]));
    terms += find_periodic(rows).terms.size();
  }
  EXPECT_EQ(terms, 0u);
}

// A part of the travel that rings (a worn spot, a resonance) has a line in its own spectrum, but not over the whole travel.
TEST(Periodic, ARingingPlaceIsNoTerm) {
  PeriodicRows rows = strokes({.noise = 0.3}, 8);
  for (std::size_t i = 0; i < rows.x.size(); ++i) {
    const double x = rows.x[i];
    rows.e[i] += 3.0 * std::exp(-std::pow((x - 0.07) / 0.012, 2.0)) * std::cos(2.0 * kPi * x / 0.003);
  }
  EXPECT_TRUE(find_periodic(rows).terms.empty());
}

/// Jogs of 2 s from one place, there and back: the farther from that place, the less the travel is covered.
PeriodicRows jogs(std::uint64_t seed, double noise = 0.3) {
  PeriodicRows rows;
  std::size_t record = 0;
  for (const double speed : {1e-4, 5e-4, 1e-3, 1.5e-3, 2.5e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3, 8e-3, 10e-3,
                             12e-3, 15e-3, 20e-3, 27e-3}) {
    Motion m;
    m.speeds = {speed};
    m.length = 2.0 * speed;
    m.noise = noise;
    const PeriodicRows one = strokes(m, 100 * seed + record);
    rows.x.insert(rows.x.end(), one.x.begin(), one.x.end());
    rows.e.insert(rows.e.end(), one.e.begin(), one.e.end());
    rows.direction.insert(rows.direction.end(), one.direction.begin(), one.direction.end());
    rows.record.insert(rows.record.end(), one.x.size(), static_cast<int>(record));
    rows.at.insert(rows.at.end(), one.at.begin(), one.at.end());
    ++record;
  }
  return rows;
}

TEST(Periodic, JogsFromOnePlaceShowTheTurnOfTheScrew) {
  int held = 0;
  for (const double period : {2e-3, 5e-3, 7e-3, 10e-3}) {
    for (std::uint64_t seed = 0; seed < 2; ++seed) {
      PeriodicRows rows = jogs(seed);
      add(rows, 2.0, period, 0.4);
      const PeriodicResult r = find_periodic(rows);
      ASSERT_EQ(r.terms.size(), 1u) << period << ' ' << seed;
      EXPECT_NEAR(r.terms[0].term.amplitude, 2.0, 0.1) << period << ' ' << seed;
      EXPECT_NEAR(r.terms[0].term.period, period, 0.01 * period) << seed;
      held += inside(r.terms[0].amplitude, 2.0) + inside(r.terms[0].period, period);
    }
  }
  EXPECT_GE(held, 14) << "of 16 intervals of 95 %";
  for (std::uint64_t seed = 0; seed < 8; ++seed)
    EXPECT_TRUE(find_periodic(jogs(50 + seed)).terms.empty()) << seed;
}

TEST(Periodic, WhatIsTooLongForTheWayIsNotToldButSaid) {
  Motion m;
  m.length = 0.02;
  m.speeds = {0.003, 0.006, 0.01};
  PeriodicRows rows = strokes(m, 4);
  EXPECT_TRUE(find_periodic(rows).cannot_tell.empty());
  add(rows, 5.0, 0.011, 0.4);
  const PeriodicResult r = find_periodic(rows);
  EXPECT_TRUE(r.terms.empty());
  ASSERT_EQ(r.cannot_tell.size(), 1u);
  EXPECT_THAT(r.cannot_tell[0], HasSubstr("periodic terms of more than 6.67 mm"));
}

TEST(Periodic, HarmonicsAreNumberedFromTheLongestPeriod) {
  PeriodicRows rows = strokes({.noise = 0.3}, 3);
  add(rows, 0.4, 12e-3, 0.3);
  add(rows, 0.8, 3e-3, -0.4);
  add(rows, 0.8, 1.5e-3, 2.0);
  const PeriodicResult r = find_periodic(rows);
  ASSERT_EQ(r.terms.size(), 3u);
  for (const PeriodicTerm& t : r.terms) {
    const int expected = static_cast<int>(std::lround(12e-3 / t.term.period));
    EXPECT_EQ(t.harmonic, expected);
    EXPECT_NEAR(t.term.period * expected, 12e-3, 0.05e-3);
  }
  EXPECT_NEAR(r.terms[2].term.amplitude, 0.4, 0.06);
  EXPECT_TRUE(std::is_sorted(r.spectrum.begin(), r.spectrum.end(),
                             [](const auto& a, const auto& b) { return a.period < b.period; }));
}

// Invariance: the mirrored axis has −φ for the additive form (f and x change sign), a moved origin moves the
// phase, other units scale.
TEST(Periodic, MirrorOriginAndUnits) {
  PeriodicRows rows = strokes({.noise = 0.3}, 5);
  add(rows, 0.9, 2.5e-3, 0.6);
  const PeriodicTerm a = find_periodic(rows).terms.at(0);
  PeriodicRows other = rows;
  for (std::size_t i = 0; i < rows.x.size(); ++i) {
    other.x[i] = -rows.x[i];
    other.e[i] = -rows.e[i];
    other.direction[i] = -rows.direction[i];
  }
  const PeriodicTerm mirrored = find_periodic(other).terms.at(0);
  EXPECT_NEAR(mirrored.term.period, a.term.period, 1e-4 * a.term.period);
  EXPECT_NEAR(mirrored.term.phase, -a.term.phase, 0.01);
  other = rows;
  for (double& x : other.x) x += 0.001;
  const PeriodicTerm moved = find_periodic(other).terms.at(0);
  EXPECT_NEAR(std::remainder(moved.term.phase - a.term.phase - 2.0 * kPi * 0.001 / a.term.period, 2.0 * kPi),
              0.0, 1e-3);
  other = rows;
  for (std::size_t i = 0; i < rows.x.size(); ++i) other.x[i] *= 1000.0, other.e[i] *= 0.01;
  const PeriodicTerm scaled = find_periodic(other).terms.at(0);
  EXPECT_NEAR(scaled.term.period, 1000.0 * a.term.period, 1e-6 * scaled.term.period);
  EXPECT_NEAR(scaled.term.amplitude, 0.01 * a.term.amplitude, 1e-6 * scaled.term.amplitude);
}

// Independent reference: ordinary least squares at the known period on every row, written out.
TEST(Periodic, AgreesWithLeastSquaresAtTheKnownPeriod) {
  PeriodicRows rows = strokes({.noise_time = 0.0}, 7);
  add(rows, 0.4, 4e-3, 1.9);
  double ss = 0, sc = 0, cc = 0, se = 0, ce = 0;
  for (std::size_t i = 0; i < rows.x.size(); ++i) {
    const double s = std::sin(2.0 * kPi * rows.x[i] / 4e-3);
    const double c = std::cos(2.0 * kPi * rows.x[i] / 4e-3);
    ss += s * s, sc += s * c, cc += c * c, se += s * rows.e[i], ce += c * rows.e[i];
  }
  const double det = ss * cc - sc * sc;
  const double amplitude = std::hypot((cc * se - sc * ce) / det, (ss * ce - sc * se) / det);
  const PeriodicTerm t = find_periodic(rows).terms.at(0);
  // The tapered ends cost a tenth of the rows: a third of the standard error of 1 N/√(N/2) = 0.012 N apart.
  EXPECT_NEAR(t.term.amplitude, amplitude, 0.008);
}

TEST(Periodic, OneDirectionCannotTellTheForm) {
  PeriodicRows rows = strokes({.noise = 0.2, .both = false}, 2);
  add(rows, 0.5, 2.5e-3, 0.0);
  const PeriodicResult r = find_periodic(rows);
  ASSERT_EQ(r.terms.size(), 1u);
  EXPECT_FALSE(r.terms[0].form_told);
  ASSERT_FALSE(r.cannot_tell.empty());
  EXPECT_THAT(r.cannot_tell.front(), HasSubstr("one direction only"));
}

TEST(Periodic, AKnownTurnKeepsItsWholeParts) {
  PeriodicRows rows = strokes({.noise = 0.2}, 4);
  add(rows, 0.6, 0.05 / 11.0, 0.5);
  add(rows, 0.5, 0.05 / 22.0, 0.2);
  PeriodicOptions options;
  options.turn = 0.05;
  const PeriodicResult r = find_periodic(rows, options);
  ASSERT_EQ(r.terms.size(), 2u);
  EXPECT_EQ(r.terms[0].harmonic, 11);
  EXPECT_EQ(r.terms[1].harmonic, 22);
  EXPECT_DOUBLE_EQ(r.terms[0].term.period, 0.05 / 11.0);
}

TEST(Periodic, ALineBesideTheKnownPeriodHasItExactly) {
  PeriodicRows rows = strokes({.noise = 0.2}, 4);
  add(rows, 0.6, 0.02, 0.5);
  add(rows, 0.4, 0.0031, 0.2);
  // Friction that falls slowly along the travel changes a free period.
  for (std::size_t i = 0; i < rows.x.size(); ++i) rows.e[i] *= 1.0 + 2.0 * rows.x[i];
  PeriodicOptions options;
  options.known = 0.02;
  const PeriodicResult r = find_periodic(rows, options);
  ASSERT_EQ(r.terms.size(), 2u);
  EXPECT_EQ(r.terms[0].term.period, 0.02);
  EXPECT_EQ(r.terms[0].period.high, 0.02);
  EXPECT_TRUE(inside(r.terms[0].phase, 0.5));
  EXPECT_TRUE(inside(r.terms[1].period, 0.0031));
  EXPECT_GT(r.terms[1].period.high, r.terms[1].term.period);
  options.known = 0.025;  // no line is near
  const PeriodicResult other = find_periodic(rows, options);
  ASSERT_EQ(other.terms.size(), 2u);
  EXPECT_NE(other.terms[0].term.period, 0.02);
  EXPECT_GT(other.terms[0].period.high, other.terms[0].term.period);
}

// Two poles of a linear motor behind a low-pass of 21 Hz: fast strokes show 13.3 mm and nothing of 6.7 mm, so that they spoke against the
// stronger of the two.
TEST(Periodic, StrokesTooFastForTheLowPassDoNotSpeakAgainstATerm) {
  PeriodicRows rows = strokes({.speeds = {0.02, 0.05, 0.25, 0.3, 0.35}, .length = 0.3, .noise = 0.5}, 4);
  add(rows, 8.0, 6.667e-3, 0.4);
  add(rows, 5.0, 13.333e-3, 1.1);
  log::Motion motion;
  motion.sample_time = 1e-3;
  motion.window = 6;
  rows.e = log::smooth_like(motion, rows.e);
  for (std::size_t i = 0; i < rows.x.size(); ++i) {
    const std::size_t next =
        i + 1 < rows.x.size() && rows.direction[i + 1] == rows.direction[i] ? i + 1 : i - 1;
    rows.blur.push_back(std::abs(rows.x[next] - rows.x[i]) / 1e-3 / log::cut_off_of(motion));
  }
  rows.passed = log::passed_by(motion);
  const PeriodicResult r = find_periodic(rows);
  ASSERT_EQ(r.terms.size(), 2u);
  EXPECT_NEAR(r.terms[0].term.amplitude, 8.0, 0.15);
  EXPECT_NEAR(r.terms[0].term.period, 6.667e-3, 2e-6);
  EXPECT_NEAR(r.terms[1].term.amplitude, 5.0, 0.15);
  EXPECT_TRUE(r.cannot_tell.empty());
  // Where the low-pass is not known, that there is a stronger one is said.
  rows.blur.clear();
  rows.passed = nullptr;
  const PeriodicResult blind = find_periodic(rows);
  ASSERT_EQ(blind.terms.size(), 1u);
  EXPECT_THAT(blind.cannot_tell,
              ::testing::Contains(HasSubstr("it is stronger in the residual than the periodic terms found")));
}

// Shares of a sine's amplitude behind the window, against the amplitude that the window leaves.
TEST(Periodic, WhatALowPassLeavesIsWhatTheWindowLeaves) {
  for (const bool butterworth : {false, true}) {
    log::Motion motion;
    motion.sample_time = 1e-3;
    if (butterworth) motion.cut_off = 30.0;
    if (!butterworth) motion.window = 5;
    const double cut_off = log::cut_off_of(motion);
    EXPECT_NEAR(cut_off, butterworth ? 30.0 : 23.8, 0.1);
    for (const double ratio : {0.1, 0.5, 1.0, 1.5, 2.0}) {
      std::vector<double> sine;
      for (int k = 0; k < 4000; ++k) sine.push_back(std::sin(2.0 * kPi * ratio * cut_off * 1e-3 * k));
      const std::vector<double> left = log::smooth_like(motion, sine);
      const double most = *std::max_element(left.begin() + 1500, left.begin() + 2500);
      EXPECT_NEAR(log::passed_by(motion)(ratio), most, 0.015) << ratio;
    }
  }
  EXPECT_EQ(log::passed_by(log::Motion{}), nullptr);
}

TEST(Periodic, RefusesWhatItCannotRead) {
  PeriodicRows rows = strokes({}, 1);
  rows.e[17] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { find_periodic(rows); }, ::testing::ThrowsMessage<Refused>(HasSubstr("row 17")));
  rows.e.pop_back();
  EXPECT_THAT([&] { find_periodic(rows); }, ::testing::ThrowsMessage<Refused>(HasSubstr("one length")));
  EXPECT_TRUE(find_periodic({}).terms.empty());
  EXPECT_FALSE(find_periodic({}).notes.empty());
}

}  // namespace
}  // namespace stribeck::ident::map::periodic_test
