#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stribeck/sim/cutting_estimate.hpp>
#include <stribeck/sim/test_mill.hpp>

namespace stribeck::sim::cutting_force_test {
namespace {

CuttingForce ripples() {
  CuttingForce f;
  f.along = 40.0;
  f.across = -15.0;
  f.entry = 0.2;
  f.exit = 0.9;
  return f;
}

/// The force at a moment, from the formulas of the header.
std::array<double, 2> at(const CuttingForce& f, double t) {
  const double w = std::clamp(std::min((t - f.entry) / f.ramp, (f.exit - t) / f.ramp), 0.0, 1.0);
  const double turn = 2.0 * kPi * f.spindle_speed * t;
  const double z = f.teeth * turn;
  const double slow = 1.0 + f.run_out * std::cos(turn);
  return {w * f.along * (slow + f.tooth_passing * std::cos(z) + f.second * std::cos(2.0 * z)),
          w * f.across * (slow + f.tooth_passing * std::sin(z) + f.second * std::sin(2.0 * z))};
}

TEST(CuttingForce, MeanOverAPeriodIsTheIntegral) {
  const CuttingForce f = ripples();
  constexpr double kPeriod = 5e-3;  // the second harmonic of the teeth goes round once
  constexpr int kParts = 2000;
  for (const double t : {0.35, 0.41723, 0.6, 0.7}) {
    std::array<double, 2> sum{};
    for (int i = 0; i < kParts; ++i) {
      const auto now = at(f, t + kPeriod * (i + 0.5) / kParts);
      sum[0] += now[0] / kParts;
      sum[1] += now[1] / kParts;
    }
    const auto mean = f.mean_over(t, kPeriod);
    // Midpoint rule: (ωh)²/24 of the amplitudes, ωh = 2π/2000 at most.
    EXPECT_NEAR(mean[0], sum[0], 1e-5);
    EXPECT_NEAR(mean[1], sum[1], 1e-5);
  }
  for (const double t : {0.0, 0.19, 0.9, 5.0}) {
    EXPECT_EQ(f.mean_over(t, kPeriod)[0], 0.0);
    EXPECT_EQ(f.mean_over(t, kPeriod)[1], 0.0);
  }
  // Ramps are straight, a period without ripples.
  CuttingForce plain = f;
  plain.run_out = plain.tooth_passing = plain.second = 0.0;
  EXPECT_NEAR(plain.mean_over(0.2475, kPeriod)[0], 20.0, 1e-12);
  EXPECT_NEAR(plain.mean_over(0.8475, kPeriod)[0], 20.0, 1e-12);
}

TEST(CuttingForce, PeriodMeansLeaveTheMomentumAtTheTicks) {
  // Over whole turns of the spindle the means of periods average to the mean force.
  const CuttingForce f = ripples();
  double sum = 0.0;
  for (int k = 0; k < 400; ++k) sum += f.mean_over(0.3 + 1e-3 * k, 1e-3)[0] / 400.0;
  EXPECT_NEAR(sum, 40.0, 1e-12);
}

TEST(CuttingForce, DrivesTogetherAreTheSameAsOneAfterTheOther) {
  const Machine machine = test::mill();
  const auto make = [&](std::size_t i) {
    return plant::Axis(machine.axes[i].second.plant, machine.sample_time, 0.05);
  };
  plant::Axis a = make(0);
  plant::Axis b = make(1);
  plant::Axis c = make(0);
  plant::Axis d = make(1);
  for (auto* axis : {&a, &c}) axis->start(0.0, {8, true, true}, {1, 0, 0});
  for (auto* axis : {&b, &d}) axis->start(0.0, {8, true, true}, {1, 0, 1});
  for (int k = 0; k < 300; ++k) {
    const double u = 4.0 * std::sin(0.05 * k);
    const double cut = 30.0 * std::cos(0.3 * k);
    plant::Axis::step_together(a, u, b, -u, cut, 0.5 * cut);
    c.step(u, cut);
    d.step(-u, 0.5 * cut);
    ASSERT_EQ(a.position(), c.position()) << k;
    ASSERT_EQ(b.position(), d.position()) << k;
  }
}

struct Cut {
  Machine machine = test::mill(false);
  CompareSpec spec = milling().settings.front().spec;

  Cut() {
    spec.trials = 1;
    spec.travels.front().laps = 1.0;
    spec.travels.front().cutting->exit = 100.0;
  }
  [[nodiscard]] CuttingForce& force() { return *spec.travels.front().cutting; }
  [[nodiscard]] CompareResult run() const { return compare(machine, test::known(machine), spec); }
};

TEST(CuttingForce, PushesBackByForceOverStiffness) {
  for (const bool in_space : {false, true}) {
    Cut cut;
    cut.spec.controllers.resize(2);
    cut.force().run_out = cut.force().tooth_passing = cut.force().second = 0.0;
    if (in_space) {
      path::Fourier<3> tilted;
      tilted.axis[0].terms = {path::Harmonic{10e-3, 1.0, 0.0}};
      tilted.axis[1].terms = tilted.axis[2].terms = {path::Harmonic{10e-3 / std::sqrt(2.0), 1.0, -0.5 * kPi}};
      cut.spec.travels.front().path = tilted;
    }
    // One mass, so that directions do not mix.
    cut.machine.axes[1].second.plant = cut.machine.axes[2].second.plant = cut.machine.axes[0].second.plant;
    const CompareResult with = cut.run();
    cut.spec.travels.front().cutting.reset();
    const CompareResult without = cut.run();
    double along = 0.0;
    double across = 0.0;
    int n = 0;
    for (std::size_t k = 0; k < with.rows[1].trace.size(); ++k) {
      const ContourSample& a = with.rows[1].trace[k];
      if (!a.scored) continue;
      along += a.local[0] - without.rows[1].trace[k].local[0];
      across += a.local[1] - without.rows[1].trace[k].local[1];
      ++n;
    }
    // −F/(m·k_p): 40 and 20 N on 1000 kg at 3600 1/s². The frame turns by 1 rad/s; 2/60 rad of lag mix the two.
    EXPECT_NEAR(along / n, -40.0 / 3.6e6, 0.05 * 40.0 / 3.6e6) << in_space;
    EXPECT_NEAR(across / n, -20.0 / 3.6e6, 0.1 * 20.0 / 3.6e6) << in_space;
  }
}

TEST(CuttingForce, OnFiveAxesDoesTheWorkOfTheForceOnTheTip) {
  Travel t = five_axis().settings.front().spec.travels.front();
  t.laps = 0.5;
  CuttingForce f;
  f.along = 30.0;
  f.across = 10.0;
  f.run_out = f.tooth_passing = f.second = 0.0;
  t.cutting = f;
  const Route<5> route = sample<5>(t, 1e-3);
  ASSERT_EQ(route.cutting.size(), route.points.size());
  for (std::size_t k = 1500; k < 4000; k += 100) {
    // 30 N against 10 mm/s; across the path no work is done.
    EXPECT_NEAR(dot(route.cutting[k], route.points[k].velocity), 30.0 * 10e-3, 1e-9);
  }
}

TEST(CuttingEstimate, FindsMeanAndRippleWhereFrictionIsKnown) {
  Cut cut;
  cut.spec.controllers = {cut.spec.controllers[1]};
  const CompareResult result = cut.run();
  const CuttingFigures f = cutting_figures(result.rows[0].trace, cut.force());
  EXPECT_NEAR(f.truth.mean, 40.0, 0.1);
  EXPECT_NEAR(f.truth.turn, 8.0, 0.2);
  EXPECT_NEAR(f.truth.tooth, 20.0 * std::sin(0.1 * kPi) / (0.1 * kPi), 0.2);
  // Measured: +1 %, +5 %, −7 %. The rest is the bristles at the reversals and, for the oscillations, a force whose direction turns
  // by 1 rad/s under a bandwidth of 5 1/s: (1/5)²/2 and the effect of the reversals. Twice per tooth is not estimated: 6 N/√2 of
  // the RMS.
  EXPECT_NEAR(f.estimate.mean, f.truth.mean, 0.03 * f.truth.mean);
  EXPECT_NEAR(f.estimate.turn, f.truth.turn, 0.1 * f.truth.turn);
  EXPECT_NEAR(f.estimate.tooth, f.truth.tooth, 0.1 * f.truth.tooth);
  EXPECT_LT(f.rms_error, 0.15 * f.rms_truth);
  EXPECT_GT(f.rms_error, 0.02 * f.rms_truth);
}

TEST(CuttingEstimate, TakesAnErrorOfTheFrictionModelForCutting) {
  Cut cut;
  cut.spec.controllers = {cut.spec.controllers[1]};
  auto knowledge = test::known(cut.machine);
  const CompareResult right = compare(cut.machine, knowledge, cut.spec);
  for (auto& k : knowledge) {
    auto& map = std::get<friction::Conventional<double>>(k.eccentric->friction.steady);
    map.alpha0 *= 0.9;
    map.stribeck->alpha1 *= 0.9;
  }
  const CompareResult wrong = compare(cut.machine, knowledge, cut.spec);
  const double more = cutting_figures(wrong.rows[0].trace, cut.force()).estimate.mean -
                      cutting_figures(right.rows[0].trace, cut.force()).estimate.mean;
  // A tenth of Coulomb friction on each axis, seen along the feed: 2 sgn cos·cos + 2.1 sgn sin·sin, 4/π of it on average.
  EXPECT_NEAR(more, 0.5 * (2.0 + 2.1) * 4.0 / kPi, 0.15);
}

TEST(CuttingEstimate, FindsTheMeanWhereWavesCannotBeSeen) {
  // Once per tooth lies above half the sampling rate; then once per turn lies within the slow bandwidth too.
  for (const double spindle : {200.0, 10.0}) {
    Cut cut;
    cut.spec.controllers = {cut.spec.controllers[1]};
    cut.force().spindle_speed = spindle;
    const CompareResult result = cut.run();
    const CuttingFigures f = cutting_figures(result.rows[0].trace, cut.force());
    EXPECT_NEAR(f.estimate.mean, f.truth.mean, 0.03 * f.truth.mean) << spindle;
  }
}

TEST(CuttingEstimate, StaysEmptyWhereNothingCuts) {
  Cut cut;
  cut.spec.controllers.resize(1);
  cut.spec.travels.front().cutting.reset();
  const CompareResult result = cut.run();
  ASSERT_FALSE(result.rows[0].trace.empty());
  for (const ContourSample& s : result.rows[0].trace) {
    ASSERT_EQ(norm(s.cutting), 0.0);
    ASSERT_EQ(norm(s.cutting_estimate), 0.0);
  }
}

}  // namespace
}  // namespace stribeck::sim::cutting_force_test
