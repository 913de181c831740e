#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/control/compensation/compensation.hpp>
#include <stribeck/control/drive_interface.hpp>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/core/scalar.hpp>

// The set point of a drive that takes a position: it does not run away from a drive at its force limit, and lives through resets and
// missed periods.
namespace stribeck::control::held_set_point_test {
namespace {

constexpr double kPeriod = 1e-3;
constexpr double kMass = 800.0, kLimit = 500.0, kGain = 2e5, kPositionGain = 60.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

friction::DriveLoop position_loop() {
  friction::DriveLoop loop;
  loop.mode = friction::DriveMode::kPosition;
  loop.gain = kGain;
  loop.position_gain = kPositionGain;
  loop.velocity_feedforward = 1.0;
  return loop;
}

Setup<1> setup_of(double limit) {
  Setup<1> setup;
  setup.period = kPeriod;
  setup.force_limit[0] = limit;
  setup.compensation[0].model.mass = kMass;
  setup.compensation[0].model.drive_loop = position_loop();
  return setup;
}

/// A mass behind a drive with a position loop that makes at most kLimit.
struct Driven {
  double x = 0.0, v = 0.0, from = 0.0;

  void move(double command, double push) {
    constexpr int kSteps = 8;
    const double h = kPeriod / kSteps, rate = (command - from) / kPeriod;
    for (int k = 0; k < kSteps; ++k) {
      const double wanted = from + rate * h * (k + 1);
      const double force = std::clamp(kGain * (kPositionGain * (wanted - x) + rate - v), -kLimit, kLimit);
      v += h * (force + push) / kMass;
      x += h * v;
    }
    from = command;
  }
};

/// Errors on a sine of 10 mm with a push of 600 N for 50 ms in its middle: the largest, and that of the last second [m].
struct Errors {
  double largest = 0.0, last = 0.0;
};
Errors pushed(double first_sample_off = 0.0) {
  const Setup<1> setup = setup_of(kLimit);
  const Contouring<1> law(ContouringParams::critical(60.0, 60.0), setup);
  const DriveInterface<1> drives(setup);
  Contouring<1>::State s;
  DriveInterface<1>::State commands{};
  Driven axis;
  Errors out;
  constexpr double kRate = 2.0, kSize = 10e-3;
  for (int k = 0; k < 8000; ++k) {
    path::PathPoint<1> r;
    const double t = k * kPeriod;
    // From rest: the sine grows over half a second.
    const double grown = std::min(t / 0.5, 1.0), size = kSize * grown * grown * grown;
    r.position[0] = size * std::sin(kRate * t);
    r.velocity[0] = size * kRate * std::cos(kRate * t);
    r.acceleration[0] = -size * kRate * kRate * std::sin(kRate * t);
    const Vec<double, 1> x{{axis.x + (k == 0 ? first_sample_off : 0.0)}};
    drives.command(commands, s, r, x, law.step(s, r, x));
    if (k > 0) {
      const double error = std::abs(axis.x - r.position[0]);
      out.largest = std::max(out.largest, error);
      if (k >= 7000) out.last = std::max(out.last, error);
    }
    axis.move(commands[0].command, k >= 3000 && k < 3050 ? 600.0 : 0.0);
  }
  return out;
}

TEST(HeldSetPoint, ADriveThatWasAtItsLimitIsBackOnThePath) {
  const Errors e = pushed();
  EXPECT_LT(e.largest, 3e-3);  // nothing but the drive stops it: there is no friction
  EXPECT_LT(e.last, 20e-6);
}

// Far behind its set point, because forces act late, and braking for a reversal and for the end of a motion: nothing may be held.
TEST(HeldSetPoint, ATableThatIsLateIsNotHeld) {
  constexpr int kLate = 8;
  const double lag = kLate * kPeriod;
  friction::DriveLoop loop = position_loop();
  loop.gain = 4e5;
  loop.position_gain = 150.0;
  const DriveCommand held(loop, 0.0, lag, kPeriod, 200.0, 300.0);
  const DriveCommand free(loop, 0.0, lag, kPeriod);
  DriveCommand::State a, b;
  const auto reference = [](double t) {
    constexpr double kSize = 0.1, kRate = 3.0, kEnd = 3.0 * kPi / kRate;  // out of full deceleration
    const double phase = kRate * std::clamp(t, 0.0, kEnd);
    const bool moves = t > 0.0 && t < kEnd;
    return DriveCommand::Start{-kSize * std::cos(phase), moves ? kSize * kRate * std::sin(phase) : 0.0,
                               moves ? kSize * kRate * kRate * std::cos(phase) : 0.0};
  };
  // Until 39 ms after the end; by then the table has come. Nothing corrects the sum of accelerations here.
  for (int k = 0; k < 3180; ++k) {
    const double t = k * kPeriod;
    DriveCommand::Start now = reference(t);
    now.position = reference(t - lag).position;  // the encoder, behind what is commanded
    const double a_next = reference(t + 0.5 * kPeriod).acceleration;
    held.step(a, 0.0, a_next, now);
    free.step(b, 0.0, a_next, now);
    ASSERT_EQ(a.command, b.command) << k;
  }
}

TEST(HeldSetPoint, AFirstSampleThatWasWrongLeavesNothing) { EXPECT_LT(pushed(1e-3).last, 20e-6); }

TEST(HeldSetPoint, ASingleWildSampleMovesItLittle) {
  const DriveCommand drive(position_loop(), 0.0, 0.0, kPeriod, kMass, kLimit);
  DriveCommand::State s;
  const auto tell = [&](double x) {
    drive.step(s, 0.0, 0.0, {x, 0.02, 0.0});
    return s.command;
  };
  double x = 0.0, before = 0.0;
  for (int k = 0; k < 10; ++k, x += 0.02 * kPeriod) before = tell(x);
  EXPECT_NEAR(tell(1.0) - before, 0.02 * kPeriod, 60e-6);
}

TEST(HeldSetPoint, WithoutAKnownLimitItIsFree) {
  const DriveCommand drive(position_loop(), 0.0, 0.0, kPeriod);
  DriveCommand::State s;
  for (int k = 0; k < 100; ++k) drive.step(s, 0.0, 1.0, {});
  EXPECT_NEAR(s.command, 0.5 * 0.1 * 0.1, 1e-9);
}

TEST(HeldSetPoint, AfterAResetItBeginsWhereTheDriveIs) {
  const auto begun = [](double resumed, double x, double speed) {
    const DriveCommand drive(position_loop(), 0.0, 0.0, kPeriod, kMass, kLimit);
    DriveCommand::State s;
    s.resumed = resumed;
    drive.step(s, 0.0, 0.0, {x, speed, 0.0});
    return s.command - speed * kPeriod;
  };
  EXPECT_NEAR(begun(0.30002, 0.3, 0.02), 0.30002, 1e-12) << "ahead by the lag of the drive";
  EXPECT_NEAR(begun(0.31, 0.3, 0.02), 0.3, 1e-12) << "the axis was moved";
  EXPECT_NEAR(begun(kNan, 0.3, 0.02), 0.3, 1e-12);
}

TEST(HeldSetPoint, GoesOnWithItsVelocityOverMissedPeriods) {
  const DriveInterface<1> drives(setup_of(std::numeric_limits<double>::infinity()));
  const auto after = [&](int periods) {
    DriveInterface<1>::State s{};
    Common<1>::State law{};
    path::PathPoint<1> r;
    r.velocity[0] = 0.05;
    drives.command(s, law, r, {{0.0}}, {{0.0}});
    law.periods = periods;
    drives.command(s, law, r, {{0.05 * kPeriod * periods}}, {{0.0}});
    return s[0].command;
  };
  EXPECT_NEAR(after(1), 2.0 * 0.05 * kPeriod, 1e-15);
  EXPECT_NEAR(after(4), 5.0 * 0.05 * kPeriod, 1e-15);
}

// A host in C++ may give a period or a delay that is no number: no memory beyond that of the delays is read.
TEST(HeldSetPoint, ADelayThatIsNoNumberIsNone) {
  EXPECT_EQ(Compensation::whole_periods(kNan, kPeriod), 0u);
  EXPECT_EQ(Compensation::whole_periods(kPeriod, kNan), 0u);
  EXPECT_EQ(Compensation::whole_periods(0.0, 0.0), 0u);
  EXPECT_EQ(Compensation::whole_periods(-kPeriod, kPeriod), 0u);
  EXPECT_EQ(Compensation::whole_periods(kPeriod, 0.0), kMostDelay);
  EXPECT_EQ(Compensation::whole_periods(2.5 * kPeriod, kPeriod), 2u);
}

}  // namespace
}  // namespace stribeck::control::held_set_point_test
