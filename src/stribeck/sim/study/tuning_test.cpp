#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stribeck/sim/study/tuning.hpp>
#include <stribeck/sim/test_machine.hpp>

namespace stribeck::sim::tuning_test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// (f) on a lap of the circle.
TuneSpec short_spec() {
  TuneSpec s;
  s.compare.travels = {test::circle(9.5e-3, 1.0)};
  s.reference = biaxial_controllers()[5];
  s.compare.controllers = {*s.reference};
  s.compare.trials = 2;
  s.evaluations = 36;
  s.search_trials = 1;
  return s;
}

double error(const std::vector<TravelScore>& s) { return s.at(0).mean.max_contour_error + s.at(0).mean.rms; }

TEST(Gains, AreTheNumbersThatCountInTime) {
  ControllerSpec c;
  c.law = control::SlidingModeParams{};
  const auto names = [&](std::size_t axes) {
    std::vector<std::string> all;
    for (const Gain& g : gains_of(c, axes)) all.push_back(g.name);
    return all;
  };
  const auto has = [&](std::size_t axes, const char* name) {
    const auto all = names(axes);
    return std::find(all.begin(), all.end(), name) != all.end();
  };
  EXPECT_TRUE(has(2, "law.lambda[1]"));
  EXPECT_FALSE(has(1, "law.lambda[1]"));
  EXPECT_TRUE(has(2, "law.boundary"));
  EXPECT_TRUE(has(2, "observer_pole"));
  EXPECT_FALSE(has(2, "law.mass_bound"));
  // An integral that is not there is no gain to change.
  control::PidParams pid;
  pid.ki = {0.0};
  c.law = pid;
  EXPECT_FALSE(has(2, "law.ki"));
  EXPECT_TRUE(has(2, "law.kp"));
}

TEST(Gains, SlowedKeepDampingRatios) {
  ControllerSpec c;
  c.law = control::ContouringParams::critical(40.0, 60.0);
  const ControllerSpec half = slowed(c, 2, 0.5);
  const auto expected = control::ContouringParams::critical(20.0, 30.0);
  const auto& law = std::get<control::ContouringParams>(half.law);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_DOUBLE_EQ(law.kp[i], expected.kp[i]);
    EXPECT_DOUBLE_EQ(law.kv[i], expected.kv[i]);
  }
  EXPECT_DOUBLE_EQ(half.observer_pole, 10.0);
  // Times grow: at half the speed an integral time is twice as long.
  ControllerSpec cascade;
  cascade.law = control::CascadeParams{};
  EXPECT_DOUBLE_EQ(std::get<control::CascadeParams>(slowed(cascade, 2, 0.5).law).integral_time[0], 0.2);
}

TEST(Tune, IsBetterWithinTheLimitsOnAnyNumberOfThreads) {
  TuneSpec s = short_spec();
  s.compare.controllers.push_back(biaxial_controllers()[2]);
  s.compare.threads = 1;
  const TuneResult one = tune(test::biaxial_table(), test::printed(), s);
  s.compare.threads = 3;
  const TuneResult three = tune(test::biaxial_table(), test::printed(), s);
  ASSERT_EQ(one.controllers.size(), 2U);
  EXPECT_EQ(one.reference, "f");
  for (std::size_t i = 0; i < 2; ++i) {
    const TunedController& c = one.controllers[i];
    ASSERT_TRUE(c.found());
    EXPECT_LE(c.evaluations, s.evaluations + 1);
    EXPECT_LT(error(c.after), error(c.before));
    EXPECT_GE(c.tuned_margins.phase, s.limits.phase_margin);
    EXPECT_GE(c.tuned_margins.gain, s.limits.gain_margin);
    EXPECT_GE(c.tuned_margins.delay, 5e-3);
    // 0.5 % are kept back; two trials spread by less.
    EXPECT_LE(c.after[0].mean.input_variation, 1.01 * one.variation_limit[0]);
    // Without an observer its pole has no effect, and stays.
    const bool pole =
        std::any_of(c.gains.begin(), c.gains.end(), [](const auto& g) { return g.name == "observer_pole"; });
    EXPECT_EQ(pole, c.start.id == "f");
    ASSERT_EQ(c.gains.size(), three.controllers[i].gains.size());
    for (std::size_t k = 0; k < c.gains.size(); ++k)
      EXPECT_EQ(c.gains[k].tuned, three.controllers[i].gains[k].tuned);
    EXPECT_EQ(error(c.after), error(three.controllers[i].after));
  }
}

TEST(Tune, SeesTheDelayThatMakesTheStartUnstable) {
  Machine late = test::biaxial_table();
  for (auto& [name, a] : late.axes) a.plant.delay_periods = 1;
  auto known = test::printed();  // and says so
  for (AxisKnowledge& k : known) k.gaussian->delay = k.conventional->delay = late.sample_time;
  TuneSpec s = short_spec();
  s.compare.controllers[0].law = control::ContouringParams::critical(60.0, 70.0);
  s.evaluations = 12;
  const TuneResult r = tune(late, known, s);
  const TunedController& c = r.controllers[0];
  EXPECT_FALSE(c.start_margins.stable);
  ASSERT_TRUE(c.found());
  EXPECT_TRUE(c.tuned_margins.stable);
  EXPECT_GE(c.tuned_margins.phase, s.limits.phase_margin);
  // The machine that it runs on agrees: friction keeps the unstable loop in a limit cycle, and the tuned one is out of it.
  EXPECT_LT(c.after.at(0).mean.max_contour_error, 0.5 * c.before.at(0).mean.max_contour_error);
  EXPECT_LT(c.after.at(0).mean.input_variation, 0.5 * c.before.at(0).mean.input_variation);
}

TEST(Tune, FindsAnotherShapeWhereNoSpeedHasTheMargins) {
  TuneSpec s = short_spec();
  ControllerSpec& kalman = s.compare.controllers[0];
  kalman.observer = control::Observer::kKalman;
  kalman.observer_pole = 60.0;
  std::get<control::ContouringParams>(kalman.law).error_rate = control::ErrorRate::kObserved;
  s.limits.input_variation = 1.0;
  s.evaluations = 12;
  const Machine machine = test::biaxial_table();
  const auto known = test::printed();
  const TunedController c = tune(machine, known, s).controllers[0];
  EXPECT_LT(c.start_margins.phase, s.limits.phase_margin);
  // The ratio of the poles decides, not the speed: the same phase at a quarter of it, but for the sampling.
  const ControllerSpec slow = slowed(c.start, 2, 0.25);
  EXPECT_LT(loop_margins<2>(slow.law, make_setup<2>(machine, known, {0, 1}, slow)).phase,
            s.limits.phase_margin);
  ASSERT_TRUE(c.found());
  EXPECT_GE(c.tuned_margins.phase, s.limits.phase_margin);
  EXPECT_GE(c.tuned_margins.gain, s.limits.gain_margin);
  EXPECT_GE(c.tuned_margins.delay, s.limits.delay_margin * machine.sample_time);
  EXPECT_LE(c.evaluations, s.evaluations + 1);
  EXPECT_GT(c.tries, c.evaluations);
}

TEST(Tune, SaysWhichLimitNoGainsMeetAndByHowMuch) {
  TuneSpec s = short_spec();
  s.limits.input_variation = 1e-6;
  s.evaluations = 12;
  const TunedController c = tune(test::biaxial_table(), test::printed(), s).controllers[0];
  ASSERT_TRUE(c.miss.has_value());
  EXPECT_EQ(c.miss->limit, Limit::kInputVariation);
  EXPECT_EQ(c.miss->travel, 0U);
  // No slower than friction feed-forward alone varies it.
  EXPECT_GT(c.miss->nearest, 1e-3);
  EXPECT_LT(c.miss->nearest, c.before.at(0).mean.input_variation);
  EXPECT_EQ(c.miss->asked, 1e-6);
  // The start and 50 slower ones, each looked at and run; 5 gains changed by a tenth; nine speeds of the start's shape and ten
  // gains for each of three others; the remaining 8 evaluations and one that COBYLA is over.
  EXPECT_EQ(c.tries, 51 + 5 + 9 + 3 * 10 + 9);
  EXPECT_TRUE(c.after.empty());
  EXPECT_EQ(c.tuned.observer_pole, c.start.observer_pole);
  s.limits.input_variation = 1.0;
  // No loop around a mass, with a hold and any delay, has this phase margin.
  s.limits.phase_margin = kPi / 2.0;
  const TunedController steep = tune(test::biaxial_table(), test::printed(), s).controllers[0];
  ASSERT_TRUE(steep.miss.has_value());
  EXPECT_EQ(steep.miss->limit, Limit::kPhaseMargin);
  EXPECT_EQ(steep.miss->asked, s.limits.phase_margin);
  // Slower and better damped comes nearer.
  EXPECT_GT(steep.miss->nearest, steep.start_margins.phase);
  EXPECT_LT(steep.miss->nearest, s.limits.phase_margin);
  // The start and 50 slower ones, 128 shapes at two speeds each.
  EXPECT_EQ(steep.tries, 51 + 2 * 128);
  EXPECT_EQ(steep.evaluations, 0);
  s.compare.controllers.clear();
  EXPECT_THAT([&] { tune(test::biaxial_table(), test::printed(), s); },
              ThrowsMessage<Refused>(HasSubstr("expected at least one controller and one travel")));
}

}  // namespace
}  // namespace stribeck::sim::tuning_test
