#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stribeck/sim/study/robustness.hpp>
#include <stribeck/sim/test_machine.hpp>
#include <vector>

namespace stribeck::sim::robustness_test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Two controllers on a piece of a circle that holds a reversal.
RobustnessSpec quick(std::uint32_t machines) {
  RobustnessSpec spec;
  spec.travels = {test::circle(9.5e-3, 0.3)};
  spec.controllers = {biaxial_controllers()[5], biaxial_controllers()[0]};
  spec.machines = machines;
  return spec;
}

TEST(Robustness, IsTheSameOnAnyNumberOfThreads) {
  RobustnessSpec spec = quick(5);
  spec.threads = 1;
  const auto one = robustness(test::biaxial_table(), test::printed(), spec);
  spec.threads = 3;
  const auto three = robustness(test::biaxial_table(), test::printed(), spec);
  for (std::size_t r = 0; r < one.rows.size(); ++r) {
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_EQ(one.rows[r].runs[i].metrics.max_contour_error,
                three.rows[r].runs[i].metrics.max_contour_error);
      EXPECT_EQ(one.rows[r].runs[i].metrics.rms, three.rows[r].runs[i].metrics.rms);
    }
  }
  EXPECT_NE(one.rows[0].runs[0].metrics.rms, one.rows[0].runs[1].metrics.rms);
}

TEST(Robustness, WithoutVariationAMachineIsATrialOfCompare) {
  // The same noise; other sub-steps, so that a count of the encoder, 25 nm, may fall otherwise here and there.
  RobustnessSpec spec = quick(3);
  spec.variation = Variation::none();
  const auto result = robustness(test::biaxial_table(), test::printed(), spec);
  CompareSpec same;
  same.travels = spec.travels;
  same.controllers = spec.controllers;
  same.trials = 3;
  const auto compared = compare(test::biaxial_table(), test::printed(), same);
  for (std::size_t r = 0; r < 2; ++r) {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(result.rows[r].runs[i].metrics.max_contour_error,
                  compared.rows[r].trials[i].max_contour_error, 50e-9);
      EXPECT_NEAR(result.rows[r].runs[i].metrics.rms, compared.rows[r].trials[i].rms, 10e-9);
    }
    EXPECT_EQ(result.rows[r].nominal.metrics.rms, result.rows[r].runs[0].metrics.rms);
    EXPECT_EQ(lost(result.rows[r]), 0U);
  }
}

TEST(Robustness, ControllersKnowTheNominalMachineAlone) {
  // What was identified stays as it is while the friction falls by 30 %: without an observer the feed-forward pushes too hard by
  // that, and the error has the other sign and 30 % of the size of one without compensation.
  RobustnessSpec spec = quick(1);
  spec.variation = Variation::none();
  spec.controllers = {biaxial_controllers()[0], biaxial_controllers()[2]};
  Machine slippery = test::biaxial_table();
  Deviation d;
  d.friction = 0.7;
  for (auto& [name, axis] : slippery.axes) axis.plant = deviated(axis.plant, d);
  const auto nominal = robustness(test::biaxial_table(), test::printed(), spec);
  const auto other = robustness(slippery, test::printed(), spec);
  EXPECT_NEAR(other.rows[0].nominal.metrics.mean_abs / nominal.rows[0].nominal.metrics.mean_abs, 0.7, 0.02);
  EXPECT_NEAR(other.rows[1].nominal.metrics.mean_abs / nominal.rows[0].nominal.metrics.mean_abs, 0.3, 0.06);
}

TEST(Robustness, ALoopThatIsLostIsAResult) {
  // 60 and 70 rad/s bear no further sample of delay; 40 rad/s do.
  RobustnessSpec spec = quick(8);
  spec.travels = {test::circle(9.5e-3, 1.0)};
  spec.variation = Variation::none();
  spec.variation.delay = 1;
  spec.controllers = {biaxial_controllers().back(),
                      biaxial_controllers(control::ContouringParams::critical(60.0, 70.0)).back()};
  const auto result = robustness(test::biaxial_table(), test::printed(), spec);
  std::size_t late = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const auto& d = result.deviations[i];
    EXPECT_FALSE(result.rows[0].runs[i].lost) << i;
    // Delay on both axes, or on none: with one late axis it takes longer than a lap to be sure.
    if (d[0].delay == d[1].delay) {
      EXPECT_EQ(result.rows[1].runs[i].lost, d[0].delay == 1) << i;
    }
    late += d[0].delay == 1 && d[1].delay == 1 ? 1 : 0;
  }
  ASSERT_GT(late, 0U);
  EXPECT_GE(lost(result.rows[1]), late);
  EXPECT_EQ(quantiles(figures(result.rows[1], &Metrics::rms)).worst, kInfinite);
}

TEST(Robustness, TheLoopBearsEveryModeThatIsDrawnAndNotEveryMode) {
  // Worst of the ranges: a light machine, the least damping, the heaviest table; low modes, and those that ring at half the
  // sampling frequency. Heavier tables are not drawn because this loop cannot bear them.
  RobustnessSpec spec = quick(1);
  spec.travels = {test::circle(9.5e-3, 1.0)};
  spec.variation = Variation::none();
  spec.controllers.resize(1);
  const auto with = [&](double frequency, double share, int delay) {
    Machine m = test::biaxial_table();
    Deviation d;
    d.mass = 0.8;
    d.delay = delay;
    d.axial_mode = plant::AxialMode{frequency, 0.02, share};
    for (auto& [name, axis] : m.axes) axis.plant = deviated(axis.plant, d);
    return robustness(m, test::printed(), spec).rows[0].nominal;
  };
  const double half_sampling = 100.0 * std::sqrt(0.8);
  for (const double frequency : {60.0, 65.0, 75.0, 0.98 * half_sampling, half_sampling, 120.0, 300.0}) {
    for (const int delay : {0, 1}) {
      const RobustRun run = with(frequency, 0.2, delay);
      EXPECT_EQ(run.limited, 0.0) << frequency << " Hz, delay " << delay;
      // 24 and 29 mV without a mode.
      EXPECT_LT(run.metrics.input_variation, 0.036) << frequency << " Hz, delay " << delay;
    }
  }
  EXPECT_TRUE(with(60.0, 0.4, 0).lost);
  EXPECT_TRUE(with(100.0 * std::sqrt(0.6), 0.4, 0).lost);
}

TEST(Robustness, TheThesisControllerOnOtherMachines) {
  // 400 machines: 5.95 µm in the median, 8.5 at 99 % (docs/theory/robustness.md). Of twelve the median is off by 0.4 µm (one
  // deviation of 1.1 µm / √12 · 1.25).
  RobustnessSpec spec = quick(12);
  spec.travels = {test::circle(9.5e-3, 1.0)};
  spec.controllers.resize(1);
  const auto result = robustness(test::biaxial_table(), test::printed(), spec);
  EXPECT_EQ(lost(result.rows[0]), 0U);
  const Quantiles q = quantiles(figures(result.rows[0], &Metrics::max_contour_error));
  EXPECT_GT(q.median, 4.8e-6);
  EXPECT_LT(q.median, 7.2e-6);
  EXPECT_LT(q.worst, 11e-6);
  EXPECT_LT(result.rows[0].nominal.metrics.max_contour_error, q.median);
}

TEST(Robustness, RefusesASpecThatMeansNothing) {
  RobustnessSpec spec = quick(0);
  EXPECT_THAT([&] { robustness(test::biaxial_table(), test::printed(), spec); },
              ThrowsMessage<Refused>(HasSubstr("needs a travel, a controller and a machine at least")));
  spec = quick(1);
  spec.variation.mass = 2.0;
  EXPECT_THAT([&] { robustness(test::biaxial_table(), test::printed(), spec); },
              ThrowsMessage<Refused>(HasSubstr("variation.mass: ")));
  spec = quick(1);
  spec.axes = {0, 7};
  EXPECT_THAT([&] { robustness(test::biaxial_table(), test::printed(), spec); },
              ThrowsMessage<Refused>(HasSubstr("the path has 2 axes, the machine")));
}

TEST(Quantile, InterpolatesAsNumPyDoes) {
  const std::vector<double> values{3.0, 1.0, 4.0, 1.5, 9.0};
  EXPECT_EQ(interpolated_quantile(values, 0.5), 3.0);
  EXPECT_EQ(interpolated_quantile(values, 0.0), 1.0);
  EXPECT_EQ(interpolated_quantile(values, 1.0), 9.0);
  // numpy.quantile([3, 1, 4, 1.5, 9], [0.9, 0.3, 0.99])
  EXPECT_NEAR(interpolated_quantile(values, 0.9), 7.0, 1e-12);
  EXPECT_NEAR(interpolated_quantile(values, 0.3), 1.8, 1e-12);
  EXPECT_NEAR(interpolated_quantile(values, 0.99), 8.8, 1e-12);
  EXPECT_TRUE(std::isnan(interpolated_quantile({}, 0.5)));
}

TEST(Quantile, CountsALostLoopAsInfinite) {
  RobustRow row;
  RobustRow reference;
  for (const double e : {1.0, 2.0, 3.0, 4.0}) {
    row.runs.emplace_back().metrics.rms = e;
    reference.runs.emplace_back().metrics.rms = 4.0;
  }
  row.runs[1].lost = row.runs[2].lost = true;
  reference.runs[2].lost = reference.runs[3].lost = true;
  EXPECT_EQ(figures(row, &Metrics::rms), (std::vector<double>{1.0, kInfinite, kInfinite, 4.0}));
  EXPECT_EQ(ratios(row, reference, &Metrics::rms), (std::vector<double>{0.25, kInfinite, kInfinite, 0.0}));
  const Quantiles q = quantiles(figures(row, &Metrics::rms));
  EXPECT_EQ(q.median, kInfinite);
  EXPECT_NEAR(interpolated_quantile(figures(row, &Metrics::rms), 0.3), 1.0 + 0.9 * 3.0, 1e-12);
}

}  // namespace
}  // namespace stribeck::sim::robustness_test
