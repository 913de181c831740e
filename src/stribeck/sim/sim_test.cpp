#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/sim/parallel.hpp>
#include <stribeck/sim/recording.hpp>
#include <stribeck/sim/test_machine.hpp>

namespace stribeck::sim::sim_test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kPeriod = 5e-3;

double worst_difference(const std::vector<ContourSample>& a, const std::vector<ContourSample>& b) {
  double worst = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    worst = std::max(worst, std::abs(a[k].contour_error - b[k].contour_error));
  return worst;
}

/// One controller of V2 at one speed.
struct Case {
  Machine machine = test::biaxial_table();
  Route<2> route;
  control::Setup<2> setup;
  AnyController<2> controller;
  Drives drives;

  Case(double speed, std::size_t which, Machine m = test::biaxial_table(),
       path::Shape shape = path::Shape::kCircle)
      : machine(std::move(m)),
        route(sample<2>(test::circle(speed, 1.0, shape), machine.sample_time)),
        setup(make_setup<2>(machine, test::printed(), {0, 1}, biaxial_controllers()[which])),
        controller(make_controller<2>(biaxial_controllers()[which].law, setup)),
        drives(machine, {0, 1}, 1.05 * speed) {}

  Metrics run(const plant::Fidelity& fidelity) { return drives.run<2>(controller, route, fidelity, 1, 0); }
  std::vector<ContourSample> trace(int substeps, bool quantised = false) {
    std::vector<ContourSample> seen;
    drives.run<2>(controller, route, {substeps, quantised, false}, 1, 0, &seen);
    return seen;
  }
  int chosen() { return choose_substeps<2>(drives, controller, route, 1e-9); }
};

TEST(Substeps, ChosenOnesPutTheTraceWithinANanometreOfAConvergedOne) {
  for (const auto& [speed, which] : {std::pair{9.5e-3, 0}, {9.5e-3, 5}, {3e-3, 2}, {3e-3, 3}, {0.5e-3, 5}}) {
    Case c(speed, which);
    const int n = c.chosen();
    const auto converged = c.trace(256);
    // The reference has converged itself: half as many steps agree within a tenth of what is asked.
    ASSERT_LT(worst_difference(c.trace(128), converged), 1e-10) << speed;
    EXPECT_LT(worst_difference(c.trace(n), converged), 1e-9)
        << n << " sub-steps at " << speed << " m/s, controller " << which;
  }
}

TEST(Substeps, AreEnoughForOtherMachines) {
  // Ten times stiffer bristles at 1 ms; GMS; an axial mode; a voltage drive with a fast armature.
  auto stiff = test::biaxial_table();
  stiff.sample_time = 1e-3;
  for (auto& [name, a] : stiff.axes)
    std::get<friction::LuGre<double>>(a.plant.friction.dynamics).sigma0 = 3e9;
  auto flexible = test::biaxial_table();
  for (auto& [name, a] : flexible.axes) a.plant.axial_mode = plant::AxialMode{60.0, 0.03, 0.3};
  auto voltage = test::biaxial_table();
  // 2 ohm, 2 mH, 17.8 N m/A, 0.02 V s/rad, 5 mm: the same force per volt at standstill.
  for (auto& [name, a] : voltage.axes)
    a.plant.drive = plant::VoltageDrive{93.7e-3, 2.0, 2e-3, 17.8, 0.02, 5e-3};
  for (const Machine& m : {stiff, flexible, voltage}) {
    Case c(9.5e-3, 5, m);
    EXPECT_LT(worst_difference(c.trace(c.chosen()), c.trace(1024)), 1e-9);
  }
}

TEST(Substeps, GmsConvergesToTheSameAccuracy) {
  auto m = test::biaxial_table();
  for (auto& [name, a] : m.axes) {
    friction::Gms<double> law;
    for (const double k : {1.6e8, 0.8e8, 0.4e8, 0.2e8}) law.elements.push_back({k, 0.25});
    law.attraction = 1e5;
    law.damping_coefficient = 600e3;
    a.plant.friction.dynamics = law;
  }
  Case c(9.5e-3, 5, m);
  EXPECT_LT(worst_difference(c.trace(c.chosen()), c.trace(1024)), 1e-9);
}

TEST(Substeps, WithQuantisersMaximumAndRmsAgreeWithAConvergedRun) {
  for (const std::size_t which : {0U, 3U, 5U}) {
    Case c(9.5e-3, which);
    const Metrics quick = c.run({c.chosen(), true, false});
    const Metrics slow = c.run({512, true, false});
    EXPECT_NEAR(quick.max_contour_error, slow.max_contour_error,
                std::max(0.005 * slow.max_contour_error, 10e-9));
    EXPECT_NEAR(quick.rms, slow.rms, std::max(0.005 * slow.rms, 10e-9));
  }
}

TEST(Drives, FrictionIsTheWholeErrorOfAControllerWithoutCompensation) {
  // At a high constant friction the normal error of PD is F / (m w^2): the static gain of the loop. Between
  // reversals (a) at 9.5 mm/s must lie near that, on both axes' parts: 768.6 .. 3106 N over 57650 * 1600 = 8
  // .. 34 um; projected on the normal, RMS of the table is 6.8 um (an independent simulation, and print).
  Case c(9.5e-3, 0);
  const Metrics m = c.run({8, false, false});
  EXPECT_NEAR(m.rms, 6.8e-6, 0.1e-6);
  EXPECT_NEAR(m.max_contour_error, 12.3e-6, 0.3e-6);
}

TEST(Drives, RunsStartFromRestWithoutAJump) {
  Case c(9.5e-3, 5);
  const auto trace = c.trace(4);
  EXPECT_EQ(trace.front().contour_error, 0.0);
  for (std::size_t k = 1; k < trace.size(); ++k)
    EXPECT_LT(std::abs(trace[k].contour_error - trace[k - 1].contour_error), 2e-6);
  EXPECT_FALSE(trace.front().scored);
  EXPECT_NEAR(norm(trace.back().velocity), 0.0, 1e-4);
}

TEST(Compare, ReproducesAnIndependentSimulationOfTheBiaxialTable) {
  // docs/theory/plant.md: max / RMS in um of a simulation by another author with the printed parameters. Its figures have two
  // digits, and noise changes the third digit of the computed ones. 6 % on the maxima (of ten trials; the number of its trials is not
  // known), 10 % or 0.08 um on RMS.
  constexpr double kFast[6][2] = {{12.3, 6.8}, {5.3, 2.2}, {4.9, 0.75}, {15.9, 4.6}, {5.2, 1.2}, {4.6, 0.71}};
  constexpr double kSlow[6][2] = {{12.4, 6.5}, {5.9, 1.5},  {5.7, 0.66},
                                  {10.6, 1.7}, {7.0, 0.72}, {5.4, 0.59}};
  auto spec = test::bi_table();
  spec.trials = 4;
  const CompareResult result = compare(test::biaxial_table(), test::printed(), spec);
  ASSERT_EQ(result.rows.size(), 12U);
  for (std::size_t i = 0; i < 12; ++i) {
    const auto& expected = i < 6 ? kSlow[i] : kFast[i - 6];
    const Metrics& m = result.rows[i].mean;
    EXPECT_NEAR(m.max_contour_error * 1e6, expected[0], 0.06 * expected[0]) << i;
    EXPECT_NEAR(m.rms * 1e6, expected[1], std::max(0.10 * expected[1], 0.08)) << i;
    EXPECT_LE(m.sd, m.rms);
    EXPECT_LE(m.mean_abs, m.rms);
    EXPECT_LE(m.quadrant_glitch, m.max_contour_error);
    EXPECT_TRUE(std::isnan(m.mean_abs_ui)) << "k_a is not known";
  }
}

TEST(Compare, IsTheSameOnAnyNumberOfThreads) {
  auto spec = test::bi_table();
  spec.travels = {test::circle(9.5e-3, 1.0)};
  spec.trials = 3;
  spec.threads = 1;
  const auto one = compare(test::biaxial_table(), test::printed(), spec);
  spec.threads = 5;
  const auto five = compare(test::biaxial_table(), test::printed(), spec);
  ASSERT_FALSE(one.rows.empty());
  ASSERT_EQ(one.rows.size(), five.rows.size());
  for (std::size_t i = 0; i < one.rows.size(); ++i) {
    EXPECT_EQ(one.rows[i].mean.max_contour_error, five.rows[i].mean.max_contour_error);
    EXPECT_EQ(one.rows[i].mean.rms, five.rows[i].mean.rms);
    EXPECT_EQ(one.rows[i].spread.rms, five.rows[i].spread.rms);
  }
}

TEST(Compare, WhatCannotBeSimulatedIsARowThatSaysWhy) {
  auto spec = test::bi_table();
  spec.travels = {test::circle(9.5e-3, 1.0)};
  spec.trials = 2;
  spec.controllers = biaxial_controllers();
  // Far too fast for a period of 5 ms.
  spec.controllers[1].law = control::ContouringParams::critical(4000.0, 4000.0);
  const auto alone = compare(test::biaxial_table(), test::printed(), [&] {
    auto one = spec;
    one.controllers = {spec.controllers[5]};
    return one;
  }());
  const auto result = compare(test::biaxial_table(), test::printed(), spec);
  EXPECT_NE(result.rows[1].refused.find("edge of stability"), std::string::npos) << result.rows[1].refused;
  EXPECT_TRUE(std::isnan(result.rows[1].mean.max_contour_error));
  EXPECT_TRUE(result.rows[1].trace.empty());
  EXPECT_EQ(result.rows[5].refused, "");
  EXPECT_EQ(result.rows[5].mean.rms, alone.rows[0].mean.rms);
  // More than the whole mass uncertain: the force would switch at any height.
  control::SlidingModeParams sliding;
  sliding.mass_bound = {1e6};
  spec.controllers[2].law = sliding;
  EXPECT_THAT(compare(test::biaxial_table(), test::printed(), spec).rows[2].refused,
              testing::HasSubstr("mass_bound is 1e+06 kg, expected less than the mass"));
  spec.controllers = {spec.controllers[1]};
  EXPECT_THROW(compare(test::biaxial_table(), test::printed(), spec), Refused);
}

TEST(Compare, TrialsDifferAndTheSeedDecides) {
  auto spec = test::bi_table();
  spec.travels = {test::circle(9.5e-3, 1.0)};
  spec.controllers = {biaxial_controllers()[5]};
  spec.trials = 2;
  const auto first = compare(test::biaxial_table(), test::printed(), spec);
  EXPECT_GT(first.rows[0].spread.rms, 0.0);
  spec.seed = 2;
  EXPECT_NE(compare(test::biaxial_table(), test::printed(), spec).rows[0].mean.rms, first.rows[0].mean.rms);
}

TEST(Metrics, AreTheTextbookDefinitions) {
  MetricsCollector<2> c;
  for (const double e : {3e-6, -4e-6, 0.0, 5e-6}) {
    MetricsCollector<2>::Sample s;
    s.contour_error = e;
    s.tracking_error = {{-2e-6, 1e-6}};
    s.in_glitch = e < 0.0;
    s.voltage = {{e * 1e6, 0.0}};
    s.current = {{2.0, 0.0}};
    s.mechanical_power = 1e6 * e;
    c.add(s);
  }
  const Metrics m = c.result();
  EXPECT_DOUBLE_EQ(m.max_contour_error, 5e-6);
  EXPECT_DOUBLE_EQ(m.quadrant_glitch, 4e-6);
  EXPECT_NEAR(m.rms, std::sqrt(50.0 / 4) * 1e-6, 1e-18);
  EXPECT_NEAR(m.sd, std::sqrt(12.5 - 1.0) * 1e-6, 1e-18);
  EXPECT_NEAR(m.mean_abs, 3e-6, 1e-18);
  EXPECT_NEAR(m.mean_abs_tracking[0], 2e-6, 1e-18);
  EXPECT_NEAR(m.input_variation, (7 + 4 + 5) / 3.0 / 2.0, 1e-12);
  EXPECT_NEAR(m.mean_abs_ui, (6 + 8 + 0 + 10) / 4.0, 1e-12);
  EXPECT_NEAR(m.mechanical_power, (3 - 4 + 0 + 5) / 4.0, 1e-12);
}

// The first point of a circle is on the circle: an axis that friction holds there has no contour error.
TEST(Metrics, AnAxisThatStaysBehindIsNoSmallError) {
  for (const double moved : {0.0, 0.4, 0.6, 1.0}) {
    MetricsCollector<2> c;
    for (int k = 0; k < 400; ++k) {
      const double phi = 0.02 * k;
      MetricsCollector<2>::Sample s;
      s.contour_error = 1e-6;
      const Vec<double, 2> r{{10e-3 * std::cos(phi), 10e-3 * std::sin(phi)}};
      s.position = {{10e-3 + moved * (r[0] - 10e-3), moved * r[1]}};
      s.tracking_error = s.position - r;
      c.add(s);
    }
    EXPECT_EQ(std::isinf(c.result().max_contour_error), moved < 0.5) << moved;
  }
}

TEST(Compare, AControllerThatMovesNothingIsRefused) {
  auto spec = test::bi_table();
  spec.travels = {test::circle(3e-3, 1.0)};
  spec.controllers = {biaxial_controllers()[0], biaxial_controllers()[5]};
  auto& law = std::get<control::ContouringParams>(spec.controllers[0].law);
  law.kp = {0.01};
  law.kv = {0.2};
  spec.trials = 1;
  const auto result = compare(test::biaxial_table(), test::printed(), spec);
  EXPECT_THAT(result.rows[0].refused, testing::HasSubstr("moves less than half as far as it should"));
  EXPECT_EQ(result.rows[1].refused, "");
}

TEST(Metrics, ASampleThatIsNoNumberIsNotForgotten) {
  MetricsCollector<2> c;
  for (const double e : {5e-6, std::nan(""), 1e-6}) {
    MetricsCollector<2>::Sample s;
    s.contour_error = s.orientation_error = e;
    c.add(s);
  }
  EXPECT_TRUE(std::isnan(c.result().max_contour_error));
  EXPECT_TRUE(std::isnan(c.result().rms));
}

TEST(GlitchWindow, OpensAtAReversalForItsTravel) {
  GlitchWindow<2> window;
  path::PathPoint<2> r;
  std::vector<double> inside;
  for (int k = -200; k <= 400; ++k) {
    const double t = k * kPeriod;
    r.position = {{-0.5e-3 * t * t, 1e-3 * t}};  // x turns at t = 0
    r.velocity = {{-1e-3 * t, 1e-3}};
    if (window.step(r)) inside.push_back(t);
  }
  EXPECT_NEAR(inside.front(), 0.0, 1.1 * kPeriod);
  EXPECT_NEAR(inside.back(), std::sqrt(0.15 / 0.5), 1.1 * kPeriod);
}

TEST(Recording, HoldsWhatAControlCouldLog) {
  const Machine m = test::biaxial_table();
  std::vector<double> reference;
  for (int k = 0; k < 1000; ++k) reference.push_back(1e-3 * (1 - std::cos(0.475 * k * kPeriod)));
  const Recording log = record_closed_loop(m, 0, reference, 1);
  ASSERT_EQ(log.x.size(), 1000U);
  for (std::size_t k = 0; k < 1000; ++k) {
    EXPECT_NEAR(log.x[k], reference[k], 40e-6);
    EXPECT_DOUBLE_EQ(log.u[k] * 1048.0, log.f[k]);
    EXPECT_NEAR(log.x[k] / 25e-9, std::round(log.x[k] / 25e-9), 1e-6);
  }
  const Recording again = record_closed_loop(m, 0, reference, 1);
  EXPECT_EQ(log.f, again.f);
  EXPECT_NE(log.f, record_closed_loop(m, 0, reference, 2).f);
}

TEST(Recording, HoldsBothEncodersWhereThereAreTwo) {
  Machine m = test::biaxial_table();
  plant::AxisParams& p = m.axes[0].second.plant;
  p.mass = 2000.0;
  p.lost_motion = plant::LostMotion{10e-6, 0.0, 20e6, 0.2, 0.25, 0.5};
  p.second_encoder = plant::SecondEncoder{100e-9};
  m.axes[0].second.commissioning.mass = 2000.0;
  m.sample_time = 1e-3;
  std::vector<double> reference;
  for (int k = 0; k < 4000; ++k) reference.push_back(5e-3 * std::cos(2 * kPi * k / 2000.0));
  const auto lost = [](const std::vector<double>& motor, const std::vector<double>& scale) {
    // Half a period apart, in the middle of the travel: both ways.
    return (motor[3500] - scale[3500]) - (motor[2500] - scale[2500]);
  };
  const Recording by_motor = record_closed_loop(m, 0, reference, 1);
  ASSERT_EQ(by_motor.scale.size(), by_motor.x.size());
  EXPECT_TRUE(by_motor.motor.empty());
  // Backlash and the wind-up under half of friction, which is above 500 N at these speeds.
  EXPECT_GT(lost(by_motor.x, by_motor.scale), 10e-6 + 2 * 0.5 * 500.0 / 20e6);
  p.encoder.side = plant::EncoderSide::kTable;
  const Recording by_scale = record_closed_loop(m, 0, reference, 1);
  ASSERT_EQ(by_scale.motor.size(), by_scale.x.size());
  EXPECT_TRUE(by_scale.scale.empty());
  EXPECT_NEAR(lost(by_scale.motor, by_scale.x), lost(by_motor.x, by_motor.scale), 2e-6);
  p.second_encoder.reset();
  EXPECT_TRUE(record_closed_loop(m, 0, reference, 1).motor.empty());
}

// 20 kg on bristles of 6 N/um swing with 87 Hz, far too fast for a loop of 5 ms: on slow jogs it hunts around standstill, and the motion
// of one number of sub-steps is never that of another. Its size is the same.
TEST(Recording, OfALoopThatHuntsIsOneOfManyAlike) {
  Machine m = test::biaxial_table();
  MachineAxis& axis = m.axes[0].second;
  axis.plant.mass = 20.0;
  axis.plant.friction = {};
  axis.plant.friction.steady =
      friction::Conventional<double>{30.0, 22.0, friction::Stribeck<double>{36.0, 4e-3, 2.0}};
  friction::LuGre<double> bristles;
  bristles.sigma0 = 6e6;
  bristles.sigma1 = 200.0;
  axis.plant.friction.dynamics = bristles;
  axis.commissioning.mass = 20.0;
  axis.commissioning.omega = 40.0;
  axis.commissioning.observer_pole = 20.0;
  axis.plant.delay_periods = 1;
  axis.plant.delay_fraction = 0.5;
  std::vector<double> reference;
  for (int k = 0; k < 2000; ++k) {
    const double t = kPeriod * (k % 1000);
    reference.push_back(0.2e-3 * (k < 1000 ? t : 1000 * kPeriod - t));
  }
  const Recording log = record_closed_loop(m, 0, reference, 1);
  double most = 0.0;
  for (std::size_t k = 0; k < log.x.size(); ++k) most = std::max(most, std::abs(log.x[k] - reference[k]));
  EXPECT_LT(most, 2e-3);
  EXPECT_GT(most, 1e-6);
  // An unstable one is refused as before.
  axis.commissioning.omega = 400.0;
  reference.resize(300);
  EXPECT_THROW(static_cast<void>(record_closed_loop(m, 0, reference, 1)), Refused);
}

TEST(ParallelFor, RunsEveryJobOnceAndPassesTheFirstErrorOn) {
  std::vector<int> done(1000);
  parallel_for(
      done.size(), 4, [] { return 0; }, [&](int&, std::size_t i) { ++done[i]; });
  EXPECT_EQ(done, std::vector<int>(1000, 1));
  EXPECT_THAT(
      [&] {
        parallel_for(
            8, 4, [] { return 0; },
            [](int&, std::size_t i) {
              if (i == 3) throw std::runtime_error("three");
            });
      },
      ThrowsMessage<std::runtime_error>(HasSubstr("three")));
}

// The slow travel alone has tables of friction that end at a lower speed, and another number of sub-steps: its trace was 9 nm off.
TEST(Compare, ASingleTrialIsThatOfTheComparisonToTheLastBit) {
  const Machine machine = test::biaxial_table();
  CompareSpec spec = test::bi_table();
  spec.controllers = {biaxial_controllers()[5]};
  spec.trials = 2;
  const CompareResult all = compare(machine, test::printed(), spec);
  for (std::size_t t = 0; t < spec.travels.size(); ++t) {
    CompareSpec one = spec;
    one.travels.insert(one.travels.begin(), spec.travels[t]);
    for (std::uint32_t trial = 0; trial < spec.trials; ++trial) {
      const CompareRow row = run_once(machine, test::printed(), one, trial).rows.front();
      EXPECT_EQ(row.mean.max_contour_error, all.rows[t].trials[trial].max_contour_error) << t;
      EXPECT_EQ(row.mean.rms, all.rows[t].trials[trial].rms) << t;
      EXPECT_EQ(row.substeps, all.rows[t].substeps);
    }
  }
}

}  // namespace
}  // namespace stribeck::sim::sim_test
