#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/control/laws/repetitive.hpp>
#include <stribeck/control/laws/test_laps.hpp>
#include <stribeck/control/laws/test_laws.hpp>

namespace stribeck::control::repetitive_test {
namespace {

using Laps = test::Laps<RepetitiveParams>;
using test::table;

TEST(Repetitive, ErrorOfLapFiveIsATenthOfThatOfLapOne) {
  // With one period, with many places per tick and with many ticks per place, and with φ begun anew each lap.
  struct Case {
    double period;
    double seconds;
    bool wrapped;
  };
  for (const Case c :
       {Case{5e-3, 6.6, false}, Case{1e-3, 6.6, true}, Case{5e-3, 21.0, false}, Case{1e-3, 2.0, false}}) {
    const auto ripple = [](double angle) {
      return 50.0 * std::sin(3.0 * angle) + 30.0 * std::cos(7.0 * angle);
    };
    Laps run({}, c.period, c.seconds, c.wrapped);
    const double first = run.lap(ripple);
    for (int k = 0; k < 3; ++k) run.lap(ripple);
    const double fifth = run.lap(ripple);

    EXPECT_LT(fifth, 0.1 * first) << c.period << " s, laps of " << c.seconds << " s";
  }
}

TEST(Repetitive, DoesNotDivergeInAHundredLaps) {
  // Reversals, ripple, noise of 5 N, and a machine that is 20 % heavier than the model says.
  for (const double period : {1e-3, 5e-3}) {
    Laps run({}, period, 4.0, false, 1.2 * test::kMass);
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0.0, 5.0);
    const auto force = [&](double angle) { return table(angle) + noise(random); };
    const double first = run.lap(force);
    double worst = 0.0;
    double last = 0.0;
    for (int k = 2; k <= 100; ++k) {
      last = run.lap(force);
      if (k > 5) worst = std::max(worst, last);
    }

    EXPECT_LT(worst, 0.05 * first) << period << " s, seed 3";
    EXPECT_LT(last, 0.05 * first) << period << " s, seed 3";
  }
}

TEST(Repetitive, ForgetsFromLapToLapByTheFactorOfItsHeader) {
  // The change of a harmonic of the error shrinks from lap to lap by Q·(1 − γ z² T(z)).
  constexpr double kPeriod = 5e-3;
  constexpr double kSeconds = 5.12;  // 1024 ticks per lap: the places' width is a tick
  for (const int n : {4, 20, 40, 60}) {
    RepetitiveParams p;
    p.learning = 0.4;
    Laps run(p, kPeriod, kSeconds);
    const auto force = [&](double angle) { return 30.0 * std::cos(n * angle); };
    std::array<std::complex<double>, 5> e;
    for (auto& lap : e) {
      run.lap(force, n);
      lap = run.harmonic;
    }
    const double w = n * 2.0 * kPi / kSeconds;
    // The mean over a place is a low-pass of its own.
    const double half = 0.5 * w * kPeriod;
    const double place = std::sin(half) / half;
    const double factor = p.factor(0, w, kPeriod) * place;
    // From the third lap on: the second still has the start from rest in it.

    EXPECT_NEAR(std::abs((e[4] - e[3]) / (e[3] - e[2])), factor, 0.01) << n;
  }
}

TEST(Repetitive, LeavesOfAPeriodicErrorWhatItsHeaderSays) {
  // (1 − Q)/(1 − factor) of what PD alone has, about 1 %, and a little more for the mean over a place; an eighth were the
  // memory read one place off.
  constexpr double kPeriod = 5e-3;
  constexpr double kSeconds = 5.12;
  Laps run({}, kPeriod, kSeconds);
  const auto force = [](double angle) { return 30.0 * std::cos(20.0 * angle); };
  for (int k = 0; k < 20; ++k) run.lap(force, 20);
  const double w = 20.0 * 2.0 * kPi / kSeconds;
  const double pd_alone = 30.0 / test::kMass / (w * w + 1600.0) * 512.0;
  const RepetitiveParams p;
  const double stays = (1.0 - p.low_pass(w)) / (1.0 - p.factor(0, w, kPeriod));
  EXPECT_LT(std::abs(run.harmonic), 2.0 * stays * pd_alone);
  EXPECT_GT(std::abs(run.harmonic), 0.5 * stays * pd_alone);
  EXPECT_LT(stays, 0.015);
}

TEST(Repetitive, ConvergesWhereTheFactorIsBelowOneAndNotWhereItIsNot) {
  for (const double period : {1e-3, 5e-3}) EXPECT_TRUE(RepetitiveParams{}.converges(period)) << period;
  // Without lead and without a low-pass at a long period the learning runs away; the factor says so, and so does the run.
  RepetitiveParams p;
  p.lead = 0;
  p.cutoff = 1000.0;
  p.learning = 1.0;
  EXPECT_FALSE(p.converges(5e-3));
  const auto force = [](double angle) { return 30.0 * std::cos(20.0 * angle) + table(angle); };
  Laps wild(p, 5e-3, 4.0);
  const double first = wild.lap(force);
  double last = 0.0;
  for (int k = 0; k < 30; ++k) last = wild.lap(force);
  EXPECT_GT(last, 2.0 * first);
  p.lead = 2;
  EXPECT_TRUE(p.converges(5e-3));
  Laps tame(p, 5e-3, 4.0);
  for (int k = 0; k < 30; ++k) last = tame.lap(force);
  EXPECT_LT(last, 0.1 * first);
}

TEST(Repetitive, TheLowPassHasItsHalfAtTheCutOff) {
  RepetitiveParams p;
  p.cutoff = 70.0;
  EXPECT_EQ(p.low_pass(0.0), 1.0);
  EXPECT_NEAR(p.low_pass(70.0), 0.5, 1e-4);
  EXPECT_GT(p.low_pass(20.0), 0.99);
  EXPECT_LT(p.low_pass(200.0), 0.01);
}

TEST(Repetitive, WithoutALapItIsPd) {
  const auto setup = test::masses<2>(1e-3);  // its lap is NaN
  const Repetitive<2> law({}, setup);
  const Contouring<2> pd(ContouringParams::critical(40.0, 40.0), setup);
  Repetitive<2>::State s;
  Contouring<2>::State t;
  path::PathPoint<2> r;
  for (int k = 0; k < 3000; ++k) {
    r.phi += 0.01;
    const Vec2 x{{1e-6 * std::sin(r.phi), 2e-6}};
    const Vec2 f = law.step(s, r, x);
    const Vec2 g = pd.step(t, r, x);
    ASSERT_NEAR(f[0], g[0], 1e-12);
    ASSERT_NEAR(f[1], g[1], 1e-12);
  }
  EXPECT_EQ(s.learned, Vec2{});
}

TEST(Repetitive, LapsThatAreTooShortAreNotLearned) {
  const auto constant = [](double) { return 50.0; };
  Laps brief({}, 1e-3, 0.4);
  for (int k = 0; k < 10; ++k) brief.lap(constant);
  EXPECT_EQ(brief.state.learned[0], 0.0);
  Laps longer({}, 1e-3, 0.6);
  for (int k = 0; k < 10; ++k) longer.lap(constant);
  EXPECT_NEAR(longer.state.learned[0], 50.0 / test::kMass, 0.01);
}

TEST(Repetitive, ForgetsNothingAtStandstillAndStaysFiniteWhenPhiRunsBackOrJumps) {
  Laps run({}, 1e-3, 3.0);
  for (int k = 0; k < 5; ++k) run.lap(table);
  auto setup = test::masses<1>(1e-3);
  setup.lap = 2.0 * kPi;
  const Repetitive<1> law({}, setup);
  path::PathPoint<1> r;
  r.phi = 10.0 * kPi;
  for (int k = 0; k < 10; ++k) law.step(run.state, r, {{run.mass.x}});  // the lead runs out
  const auto memory = run.state.memory.cell;
  for (int k = 0; k < 100; ++k) law.step(run.state, r, {{run.mass.x}});
  EXPECT_EQ(run.state.memory.cell, memory);
  // Over a jump nothing is entered.
  r.phi += 1.5;
  for (int k = 0; k < 20; ++k) {
    r.phi += 1e-3;
    law.step(run.state, r, {{run.mass.x}});
  }
  int changed = 0;
  for (std::size_t k = 0; k < memory.size(); ++k) changed += run.state.memory.cell[k] == memory[k] ? 0 : 1;
  EXPECT_LE(changed, 5);
  for (const double phi : {31.0, 30.0, 12.0, 1e6, -1e6, 1e300, 0.0, std::nan(""), 0.1}) {
    r.phi = phi;
    EXPECT_TRUE(std::isfinite(law.step(run.state, r, {{0.0}})[0])) << phi;
  }
}

TEST(Repetitive, TheMemoryAsksForNoMoreThanTheForceLimit) {
  auto setup = test::masses<1>(1e-3);
  setup.lap = 2.0 * kPi;
  setup.force_limit = {{60.0}};
  const Repetitive<1> law({}, setup);
  Repetitive<1>::State s;
  test::Mass mass;
  path::PathPoint<1> r;
  for (int k = 0; k < 20000; ++k) {
    r.phi = 2e-3 * k;
    mass.move(law.step(s, r, {{mass.x}})[0] - 100.0, 1e-3);
    ASSERT_LE(std::abs(s.learned[0]) * test::kMass, 60.0 * 1.5);  // Q overshoots a step by less than half
  }
  for (const auto& bin : s.memory.cell) ASSERT_LE(std::abs(bin[0]) * test::kMass, 60.0 * (1.0 + 1e-12));
}

TEST(Repetitive, KeepsWhatEveryLawKeeps) {
  test::expect_nan_answered(RepetitiveParams{});
  test::expect_limits_kept(RepetitiveParams{});
  test::expect_mirrored(RepetitiveParams{});
  for (const double period : {1e-3, 5e-3})
    EXPECT_LT(test::worst_error_under_known_friction(RepetitiveParams{}, period), 1e-12);
}

TEST(Repetitive, FirstLapAnswersADisturbanceAsPdDoes) {
  constexpr double kPeriod = 1e-5;
  test::Disturbed<RepetitiveParams> loop({}, kPeriod, 100.0);
  for (int k = 1; k <= 30; ++k) {
    const double t = 0.01 * k;
    const double e = 100.0 / test::kMass / 1600.0 * (1.0 - (1.0 + 40.0 * t) * std::exp(-40.0 * t));
    EXPECT_NEAR(loop.error_after(1000), -e, 1e-3 * 100.0 / test::kMass / 1600.0) << t;
  }
}

TEST(RepetitiveParams, WhetherItConvergesDoesNotDependOnTheUnitOfTime) {
  for (const double second : {1.0, 1e3, 1.0 / 3600.0}) {
    for (const double cutoff : {100.0, 1000.0}) {
      RepetitiveParams p;
      p.kp = {1600.0 / (second * second)};
      p.kv = {80.0 / second};
      p.cutoff = cutoff / second;
      RepetitiveParams si;
      si.cutoff = cutoff;
      EXPECT_EQ(p.converges(5e-3 * second), si.converges(5e-3)) << second << ", " << cutoff;
      for (const double omega : {1.0, 30.0, 300.0})
        EXPECT_NEAR(p.factor(0, omega / second, 5e-3 * second), si.factor(0, omega, 5e-3), 1e-12) << omega;
    }
  }
}

TEST(RepetitiveParams, AnyAxisCanKeepItFromConverging) {
  for (const std::size_t axis : {0, 2}) {
    RepetitiveParams p;
    p.kp = {1600.0, 1600.0, 1600.0};
    p.kv = {80.0, 80.0, 80.0};
    ASSERT_TRUE(p.converges(1e-3));
    p.kv[axis] = 0.0;  // no damping
    EXPECT_FALSE(p.converges(1e-3)) << axis;
    EXPECT_NE(p.factor(axis, 30.0, 1e-3), p.factor(1, 30.0, 1e-3)) << axis;
  }
}

}  // namespace
}  // namespace stribeck::control::repetitive_test
