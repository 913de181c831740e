#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/plant/axis.hpp>
#include <stribeck/plant/drive_loop.hpp>

namespace stribeck::plant::drive_loop_test {
namespace {

constexpr double kPeriod = 1e-3;
constexpr double kMost = 1e4;

DriveLoop velocity_loop() {
  DriveLoop d;
  d.loop = {friction::DriveMode::kVelocity, 2e4, 10e-3, {}, {}, false, false};
  d.cycle = 250e-6;
  return d;
}

TEST(RunningLoop, OnABlockedAxisTheForceGrowsWithTime) {
  RunningLoop loop(velocity_loop(), kPeriod, kMost);
  loop.start(0.3, 0.0, false);
  EXPECT_EQ(loop.cycles(), 4);
  double last = 0.0;
  for (int k = 0; k < 10; ++k) {
    loop.command(0.01, 0.0);
    for (int i = 0; i < 4; ++i) last = loop.force(i, 0.3);
  }
  // K·v·(1 + t/T_n) after 10 ms
  EXPECT_NEAR(last, 2e4 * 0.01 * (1.0 + 10e-3 / 10e-3), 1e-9);
}

TEST(RunningLoop, LeavesItsLimitAtOnceWhenTheErrorTurns) {
  RunningLoop loop(velocity_loop(), kPeriod, 500.0);
  loop.start(0.0, 0.0, false);
  for (int k = 0; k < 1000; ++k) {
    loop.command(0.02, 0.0);
    for (int i = 0; i < 4; ++i) EXPECT_LE(loop.force(i, 0.0), 500.0);
  }
  loop.command(-0.02, 0.0);
  EXPECT_LT(loop.force(0, 0.0), 200.0);
}

TEST(RunningLoop, HoldsTheLoadFromTheStartAndDelaysByItsCycles) {
  DriveLoop d = velocity_loop();
  d.delay_cycles = 3;
  RunningLoop loop(d, kPeriod, kMost);
  loop.start(0.0, 176.0, false);
  loop.command(0.01, 0.0);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(loop.force(i, 0.0), 176.0);
  EXPECT_NEAR(loop.force(3, 0.0), 176.0 + 2e4 * 0.01 * (1.0 + 0.025), 1e-9);
}

TEST(RunningLoop, GoesToACommandedPositionInAStraightLine) {
  DriveLoop d = velocity_loop();
  d.loop.mode = friction::DriveMode::kPosition;
  d.loop.integral_time.reset();
  d.loop.position_gain = 50.0;
  d.loop.velocity_feedforward = 1.0;
  RunningLoop loop(d, kPeriod, kMost);
  loop.start(0.1, 0.0, false);
  loop.command(0.1 + 40e-6, 0.0);
  for (int i = 0; i < 4; ++i) {
    // 40 mm/s, and the distance to the middle of the cycle
    EXPECT_NEAR(loop.force(i, 0.1), 2e4 * (0.04 + 50.0 * 10e-6 * (i + 0.5)), 1e-9);
  }
}

TEST(RunningLoop, RoundsCommandsAndOffsetsToTheirSteps) {
  DriveLoop d = velocity_loop();
  d.loop.integral_time.reset();
  d.loop.force_offset = true;
  d.velocity_resolution = 1e-3;
  d.offset_resolution = 10.0;
  RunningLoop loop(d, kPeriod, kMost);
  loop.start(0.0, 0.0, true);
  loop.command(2.4e-3, 14.0);
  EXPECT_NEAR(loop.force(0, 0.0), 2e4 * 2e-3 + 10.0, 1e-9);
}

AxisParams vertical() {
  AxisParams p;
  p.mass = 18.0;
  p.load = 176.0;
  p.drive = CurrentDrive{100.0, {}};
  p.encoder.resolution = 1e-7;
  p.friction.steady = friction::Conventional<double>{30.0, 100.0, {}};
  p.friction.dynamics = friction::LuGre<double>{1e7, 1e3, {}};
  p.drive_loop = velocity_loop();
  return p;
}

TEST(AxisWithLoop, AVerticalAxisStandsAndMovesAsCommanded) {
  Axis axis(vertical(), kPeriod, 0.1);
  axis.start(0.05, {8, false, false}, {1, 0, 0});
  for (int k = 0; k < 500; ++k) axis.step(0.0);
  EXPECT_NEAR(axis.position(), 0.05, 1e-7);
  for (int k = 0; k < 500; ++k) axis.step(0.02);
  EXPECT_NEAR(axis.velocity(), 0.02, 1e-5);
  // The force of the drive balances load and friction.
  EXPECT_NEAR(100.0 * axis.voltage(), 176.0 + axis.friction_force(), 0.5);
}

// Nothing holds the weight but the error of the velocity: 176 N at 2e4 N s/m are 8.8 mm/s.
TEST(AxisWithLoop, WithoutAnIntegralPartAVerticalAxisSinks) {
  AxisParams p = vertical();
  p.drive_loop->loop.integral_time.reset();
  p.friction.steady = friction::Conventional<double>{1.0, 0.0, {}};
  Axis axis(p, kPeriod, 0.1);
  axis.start(0.05, {8, false, false}, {1, 0, 0});
  for (int k = 0; k < 500; ++k) axis.step(0.0);
  EXPECT_NEAR(axis.velocity(), -175.0 / 2e4, 1e-4);
}

TEST(AxisWithLoop, TwoDrivesTogetherAreTwoDrivesAlone) {
  const auto make = [] {
    Axis a(vertical(), kPeriod, 0.1);
    a.start(0.0, {4, true, false}, {1, 0, 0});
    return a;
  };
  Axis a = make();
  Axis b = make();
  Axis c = make();
  for (int k = 0; k < 50; ++k) {
    Axis::step_together(a, 0.01, b, -0.01, 5.0, -5.0);
    c.step(0.01, 5.0);
  }
  EXPECT_EQ(a.position(), c.position());
  EXPECT_LT(b.position(), 0.0);
}

}  // namespace
}  // namespace stribeck::plant::drive_loop_test
