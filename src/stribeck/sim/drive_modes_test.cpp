// The biaxial table with drives that close their velocity or position loop themselves, cycles of 250 µs, one of them delay. The law's
// force reaches the axis through the drive's own loop.
#include <gtest/gtest.h>

#include <stribeck/sim/recording.hpp>
#include <stribeck/sim/test_machine.hpp>

namespace stribeck::sim::drive_modes_test {
namespace {

enum class Way { kForce, kVelocity, kPosition };

/// Bandwidth of the velocity loop [Hz] and its integral time [s].
struct Loop {
  double bandwidth = 200.0;
  double integral_time = 10e-3;
};
constexpr Loop kStiff{};
constexpr Loop kSoft{20.0, 50e-3};

Machine table(Way way, bool offset, const Loop& loop = kStiff) {
  Machine m = test::biaxial_table();
  if (way == Way::kForce) return m;
  for (auto& [name, axis] : m.axes) {
    plant::DriveLoop d;
    d.loop.mode = way == Way::kVelocity ? friction::DriveMode::kVelocity : friction::DriveMode::kPosition;
    d.loop.gain = axis.plant.mass * 2.0 * kPi * loop.bandwidth;
    d.loop.integral_time = loop.integral_time;
    d.loop.force_offset = offset;
    if (way == Way::kPosition) {
      d.loop.position_gain = 0.3 * loop.bandwidth;
      d.loop.velocity_feedforward = 1.0;
      d.position_resolution = 10e-9;
    }
    d.cycle = 250e-6;
    d.delay_cycles = 1;
    d.motor_resolution = 0.6e-9;
    axis.plant.drive_loop = d;
  }
  return m;
}

/// Largest contour errors without and with compensation by the true model [m].
struct Errors {
  double without = 0.0;
  double with = 0.0;
};

Errors errors(Way way, bool offset, const Loop& loop = kStiff, bool reports = false) {
  Machine m = table(way, offset, loop);
  std::vector<AxisKnowledge> known(2);
  for (std::size_t i = 0; i < 2; ++i) {
    auto& plant = m.axes[i].second.plant;
    if (plant.drive_loop) plant.drive_loop->loop.force_feedback = reports;
    known[i].whole = friction::AxisModel{plant.mass, 0.0, plant.friction};
  }
  CompareSpec spec;
  spec.travels = {test::circle(3e-3, 1.0)};
  spec.trials = 1;
  spec.controllers = {{"a", "none", FrictionUse::kNone, control::Observer::kNone},
                      {"i", "dynamic", FrictionUse::kWhole, control::Observer::kKalman}};
  for (auto& c : spec.controllers) c.law = control::ContouringParams::critical(40.0, 40.0);
  spec.controllers[1].feedforward = control::Feedforward::kDynamic;
  const CompareResult r = compare(m, known, spec);
  return {r.rows[0].mean.max_contour_error, r.rows[1].mean.max_contour_error};
}

TEST(DriveModes, VelocityAndPositionDrivesAreCompensatedAsWellAsForceDrives) {
  const Errors force = errors(Way::kForce, false);
  EXPECT_LT(force.with, 0.4 * force.without);
  for (const bool offset : {false, true}) {
    EXPECT_LT(errors(Way::kVelocity, offset).with, 2.0 * force.with);
    EXPECT_LT(errors(Way::kPosition, offset).with, 4.0 * force.with);
  }
}

// A stiff loop leaves a glitch of one step of the encoder, 25 nm; there is little to take out.
TEST(DriveModes, OnASoftLoopTheModelTakesOutMostOfTheGlitch) {
  for (const Way way : {Way::kVelocity, Way::kPosition}) {
    for (const bool offset : {false, true}) {
      const Errors e = errors(way, offset, kSoft);
      EXPECT_GT(e.without, 0.3e-6);
      EXPECT_LT(e.with, 0.4 * e.without);
    }
  }
}

TEST(DriveModes, AnObserverThatSeesTheForceOfTheDriveDoesNoHarm) {
  for (const Way way : {Way::kVelocity, Way::kPosition}) {
    for (const Loop& loop : {kStiff, kSoft})
      EXPECT_LT(errors(way, false, loop, true).with, 1.2 * errors(way, false, loop, false).with + 25e-9);
  }
}

TEST(DriveModes, ARecordingHasTheForceOfTheDrive) {
  const Machine m = table(Way::kVelocity, false);
  std::vector<double> reference;
  for (int k = 0; k < 2000; ++k) reference.push_back(k < 200 ? 0.0 : 5e-3 * m.sample_time * (k - 200));
  const Recording log = record_closed_loop(m, 0, reference, 1);
  const double friction = m.axes[0].second.plant.friction.parts(5e-3, 0.0).level +
                          m.axes[0].second.plant.friction.parts(5e-3, 0.0).viscous;
  double mean = 0.0;
  for (std::size_t k = 1000; k < 2000; ++k) mean += log.f[k] / 1000.0;
  EXPECT_NEAR(mean, friction, 20.0);
  EXPECT_THROW(record_open_loop(m, 0, {1.0, 1.0}, 0.0, 1), Refused);
}

TEST(DriveModes, AnAxisFileForAnotherCommandIsRefused) {
  std::vector<AxisKnowledge> known(2);
  const Machine plain = table(Way::kForce, false);
  const Machine velocity = table(Way::kVelocity, false);
  CompareSpec spec;
  spec.travels = {test::circle(3e-3, 1.0)};
  spec.trials = 1;
  spec.controllers = {{"a", "none", FrictionUse::kNone, control::Observer::kNone}};
  for (auto& k : known) {
    k.conventional = friction::AxisModel{57650.0, 0.0, {}};
    k.conventional->drive_loop = table(Way::kPosition, false).axes[0].second.plant.drive_loop->loop;
  }
  EXPECT_THROW(compare(plain, known, spec), Refused);
  EXPECT_THROW(compare(velocity, known, spec), Refused);
}

}  // namespace
}  // namespace stribeck::sim::drive_modes_test
