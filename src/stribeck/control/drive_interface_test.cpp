#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stribeck/control/drive_interface.hpp>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/control/pd.hpp>
#include <vector>

namespace stribeck::control::drive_interface_test {
namespace {

using friction::DriveLoop;
using friction::DriveMode;

constexpr double kPeriod = 1e-3;

DriveLoop velocity_loop() { return {DriveMode::kVelocity, 2e4, 10e-3, {}, {}, false, false}; }
DriveLoop position_loop(double feedforward) {
  return {DriveMode::kPosition, 2e4, 10e-3, 50.0, feedforward, false, false};
}

/// The loops of a drive on an axis that cannot move, integrated in 400 steps per period.
class BlockedDrive {
 public:
  BlockedDrive(const DriveLoop& loop, double holds) : loop_(loop), integral_(holds) {}

  /// Mean force over one period [N].
  double run(double command, double offset) {
    constexpr int kSteps = 400;
    const double dt = kPeriod / kSteps;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const bool by_position = loop_.mode == DriveMode::kPosition;
      const double at = last_ + (command - last_) * (i + 0.5) / kSteps;
      const double speed = (command - last_) / kPeriod;
      const double wanted =
          by_position ? *loop_.position_gain * at + *loop_.velocity_feedforward * speed : command;
      integral_ += 0.5 * dt * loop_.gain / *loop_.integral_time * wanted;
      sum += loop_.gain * wanted + integral_ + offset;
      integral_ += 0.5 * dt * loop_.gain / *loop_.integral_time * wanted;
    }
    last_ = command;
    return sum / kSteps;
  }

 private:
  DriveLoop loop_;
  double integral_;
  double last_ = 0.0;
};

/// Largest difference between the force that is wanted and the one that a blocked drive makes, as a share of its amplitude.
double worst(const DriveLoop& loop) {
  const DriveCommand command(loop, 0.0, 0.0, kPeriod);
  DriveCommand::State s;
  BlockedDrive drive(loop, 300.0);
  double most = 0.0;
  for (int k = 0; k < 400; ++k) {
    const double wanted = 300.0 + 100.0 * std::sin(2.0 * kPi * 5.0 * kPeriod * k);
    command.step(s, wanted, 0.0, {});
    most = std::max(most, std::abs(drive.run(s.command, s.offset) - wanted));
  }
  return most / 100.0;
}

TEST(DriveCommand, ADriveWithAVelocityLoopMakesTheForceThatIsWanted) {
  EXPECT_LT(worst(velocity_loop()), 1e-6);
}

TEST(DriveCommand, ADriveThatTakesAnOffsetMakesTheForceThatIsWanted) {
  DriveLoop loop = velocity_loop();
  loop.force_offset = true;
  EXPECT_LT(worst(loop), 1e-12);
}

TEST(DriveCommand, ADriveWithAPositionLoopMakesItWithinThePeriodOfItsStraightLine) {
  // The position moves in a straight line, half a period late without feed-forward: 2π·5 Hz·T/2 is 1.6 %.
  EXPECT_LT(worst(position_loop(1.0)), 0.02);
  EXPECT_LT(worst(position_loop(0.5)), 0.03);
  EXPECT_LT(worst(position_loop(0.0)), 0.03);
}

TEST(DriveCommand, NothingJumpsWhenTheDriveAlreadyHoldsTheLoad) {
  for (const bool offset : {false, true}) {
    DriveLoop loop = velocity_loop();
    loop.force_offset = offset;
    const DriveCommand command(loop, 0.0, 0.0, kPeriod);
    DriveCommand::State s;
    for (int k = 0; k < 3; ++k) {
      command.step(s, 1760.0, 0.0, {});
      EXPECT_EQ(s.command, 0.0);
      EXPECT_EQ(s.offset, 0.0);
    }
  }
}

TEST(DriveCommand, IntegratesTheAccelerationOfTheLawFromTheDelayedStart) {
  constexpr double kDelay = 0.4e-3;
  constexpr DriveCommand::Start kStart{0.1, 0.02, 3.0};
  const DriveCommand velocity(velocity_loop(), 0.0, kDelay, kPeriod);
  DriveCommand::State s;
  velocity.step(s, 50.0, 3.0, kStart);
  EXPECT_NEAR(s.command, 0.02 + 3.0 * 0.9e-3, 1e-15);
  velocity.step(s, 50.0, -1.0, kStart);
  EXPECT_NEAR(s.command, 0.02 + 3.0 * 1.4e-3 - 0.5e-3, 1e-15);
  const DriveCommand position(position_loop(1.0), 0.0, kDelay, kPeriod);
  DriveCommand::State p;
  position.step(p, 50.0, 3.0, kStart);
  // The end of the hold; the part 3.0·delay²/2 = 0.24 µm before it is left out.
  EXPECT_NEAR(p.command, 0.1 + 0.02 * 1.4e-3 + 1.5 * 1.4e-3 * 1.4e-3, 0.3e-6);
}

TEST(DriveCommand, WithoutFeedforwardTheDriveIsLedByItsLag) {
  const DriveCommand position(position_loop(0.0), 0.0, 0.0, kPeriod);
  DriveCommand::State s;
  position.step(s, 50.0, 0.0, {0.1, 0.02, 0.0});
  EXPECT_NEAR(s.command - (0.1 + 0.02 * kPeriod), 0.02 / 50.0, 1e-15);
}

TEST(DriveCommand, StopsWithConstantDeceleration) {
  const DriveCommand velocity(velocity_loop(), 0.0, 0.0, kPeriod);
  const DriveCommand position(position_loop(1.0), 0.0, 0.0, kPeriod);
  DriveCommand::State v;
  DriveCommand::State p;
  velocity.step(v, 0.0, 0.0, {0.0, 0.05, 0.0});
  position.step(p, 0.0, 0.0, {0.0, 0.05, 0.0});
  const double begun = p.command;
  for (int k = 1; k <= 50; ++k) {
    velocity.stop(v, 50, false);
    position.stop(p, 50, false);
    EXPECT_NEAR(v.command, 0.05 * (50 - k) / 50.0, 1e-12);
  }
  EXPECT_NEAR(p.command - begun, 0.5 * 0.05 * 50e-3, 1e-12);
  velocity.stop(v, 50, false);
  EXPECT_EQ(v.command, 0.0);
}

// A weight stays carried where the drive has no integral that could do it; friction and inertia of the last period do not stay.
TEST(DriveCommand, AStopTakesTheForceOffsetAway) {
  constexpr double kLoad = 176.0;
  friction::DriveLoop loop = velocity_loop();
  loop.force_offset = true;
  const auto offset_after = [&](bool integral, bool cut, int periods) {
    if (!integral) loop.integral_time.reset();
    const DriveCommand drive(loop, kLoad, 0.0, kPeriod);
    DriveCommand::State s;
    drive.step(s, 200.0, 0.0, {0.0, 0.05, 0.0});
    drive.step(s, 1200.0, 1.0, {0.0, 0.05, 0.0});
    for (int k = 0; k < periods; ++k) drive.stop(s, 50, cut);
    return s.offset;
  };
  EXPECT_NEAR(offset_after(true, false, 25), 500.0, 1e-9);
  EXPECT_EQ(offset_after(true, false, 50), 0.0);
  EXPECT_EQ(offset_after(false, true, 1), 0.0);
  EXPECT_NEAR(offset_after(false, false, 50), kLoad, 1e-12);
}

Setup<1> setup_with(std::optional<DriveLoop> loop, Observer observer) {
  Setup<1> setup;
  setup.period = kPeriod;
  setup.compensation[0].model.mass = 50.0;
  setup.compensation[0].model.drive_loop = loop;
  setup.compensation[0].observer = observer;
  return setup;
}

TEST(DriveInterface, AnAxisWithoutLoopKeepsTheForceOfTheLaw) {
  const DriveInterface<1> drives(setup_with({}, Observer::kNone));
  DriveInterface<1>::State s{};
  drives.command(s, {}, {}, {}, {{123.0}});
  EXPECT_EQ(s[0].command, 123.0);
  EXPECT_FALSE(drives.present(0));
}

TEST(DriveInterface, AReferenceThatIsNotFiniteLeavesTheCommand) {
  const DriveInterface<1> drives(setup_with(velocity_loop(), Observer::kNone));
  DriveInterface<1>::State s{};
  path::PathPoint<1> r;
  r.velocity[0] = 0.02;
  drives.command(s, {}, r, {}, {{0.0}});
  r.velocity[0] = std::numeric_limits<double>::quiet_NaN();
  drives.command(s, {}, r, {}, {{7.0}});
  EXPECT_EQ(s[0].command, 0.02);
}

/// A drive whose velocity loop is perfect: the axis moves as the law wants.
TEST(DriveInterface, AnErrorDiesOutAsTheLawSaysAndLeavesNothing) {
  const auto setup = setup_with(velocity_loop(), Observer::kNone);
  const Contouring<1> law(ContouringParams::critical(40.0, 40.0), setup);
  const DriveInterface<1> drives(setup);
  Contouring<1>::State s;
  DriveInterface<1>::State commands{};
  double x = 1e-3;
  double before = 0.0;
  std::vector<double> seen;
  for (int k = 0; k < 1000; ++k) {
    const Vec<double, 1> force = law.step(s, {}, {{x}});
    drives.command(commands, s, {}, {{x}}, force);
    x += 0.5 * kPeriod * (before + commands[0].velocity);
    before = commands[0].velocity;
    seen.push_back(x);
  }
  // Double pole: e = e0·(1 + w·t)·exp(−w·t), sampled at w·T = 0.04.
  EXPECT_NEAR(seen[49], 1e-3 * 3.0 * std::exp(-2.0), 0.06e-3);
  EXPECT_NEAR(seen.back(), 0.0, 1e-12);
}

/// Estimates of a Kalman observer while a mass at rest is held by a drive of which nothing is known but, perhaps, its force.
double estimate_after(const DriveLoop& loop) {
  const Setup<1> setup = setup_with(loop, Observer::kKalman);
  const Contouring<1> law(ContouringParams::critical(40.0, 40.0), setup);
  const DriveInterface<1> drives(setup);
  Contouring<1>::State s;
  DriveInterface<1>::State commands{};
  for (int k = 0; k < 2000; ++k) {
    drives.admit(commands, s, {{75.0}});
    const Vec<double, 1> force = law.step(s, {}, {{0.0}});
    drives.command(commands, s, {}, {{0.0}}, force);
  }
  return s.compensation[0].estimate;
}

TEST(DriveInterface, TheObserverSeesTheForceThatTheDriveReports) {
  DriveLoop loop = velocity_loop();
  loop.force_feedback = true;
  EXPECT_NEAR(estimate_after(loop), 75.0, 0.1);
}

TEST(DriveInterface, ObserverEstimateStaysZeroWithoutForceFeedback) {
  EXPECT_EQ(estimate_after(velocity_loop()), 0.0);
}

/// A machine of three kinds of drives: forces alone; a position loop that reports nothing; a velocity loop that reports its force.
Setup<3> three_kinds() {
  Setup<3> setup;
  setup.period = kPeriod;
  for (std::size_t i = 0; i < 3; ++i) {
    setup.compensation[i].model.mass = 50.0 + 30.0 * static_cast<double>(i);
    setup.compensation[i].model.load = 20.0 * static_cast<double>(i);
    setup.compensation[i].model.delay = 0.2e-3 * static_cast<double>(i);
  }
  setup.compensation[1].model.drive_loop = position_loop(0.5);
  setup.compensation[2].model.drive_loop = velocity_loop();
  setup.compensation[2].model.drive_loop->force_feedback = true;
  return setup;
}

/// Axis i of the same machine.
Setup<1> kind(std::size_t i) {
  Setup<1> setup;
  setup.period = kPeriod;
  setup.compensation[0] = three_kinds().compensation[i];
  return setup;
}

TEST(DriveInterface, EachAxisOfAMachineIsTheAxisAlone) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  // In any order of the axes: the first one has a loop or has none.
  for (std::size_t shift = 0; shift < 3; ++shift) {
    auto setup = three_kinds();
    for (std::size_t i = 0; i < 3; ++i) setup.compensation[i] = three_kinds().compensation[(i + shift) % 3];
    const DriveInterface<3> machine(setup);
    DriveInterface<3>::State s{};
    Common<3>::State law;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t k = (i + shift) % 3;
      const DriveInterface<1> axis(kind(k));
      DriveInterface<1>::State t{};
      Common<1>::State law1;
      s = {};
      law = {};
      for (int n = 0; n < 40; ++n) {
        path::PathPoint<3> r;
        Vec<double, 3> x, force, acted;
        for (std::size_t j = 0; j < 3; ++j) {
          const double size = 1.0 + static_cast<double>((j + shift) % 3);
          r.position[j] = 1e-3 * size * n;
          r.velocity[j] = 1e-3 * size;
          r.acceleration[j] = 0.1 * size * (n % 3);
          x[j] = n < 3 ? kNan : r.position[j] + 1e-6 * size;
          if (n == 1) r.position[j] = 0.5 * size;
          if (n == 20) x[j] = kNan;
          force[j] = 10.0 * size * n;
          acted[j] = n % 5 == 4 ? kNan : 7.0 * size + n;
          law.compensation[j].balance = 3.0 * size;
        }
        path::PathPoint<1> r1;
        r1.position[0] = r.position[i];
        r1.velocity[0] = r.velocity[i];
        r1.acceleration[0] = r.acceleration[i];
        law1.compensation[0].balance = law.compensation[i].balance;
        law.compensation[i].force[0] = law1.compensation[0].force[0] = -5.0;
        machine.admit(s, law, acted);
        axis.admit(t, law1, {{acted[i]}});
        EXPECT_EQ(law.compensation[i].force[0], law1.compensation[0].force[0]) << i << ' ' << n;
        // What the drive reports is taken once the axis has begun, where there is such a report.
        const bool reports = k == 2 && n > 3 && n % 5 != 4;
        EXPECT_EQ(law.compensation[i].force[0] != -5.0, reports) << i << ' ' << n;
        if (n < 30) {
          machine.command(s, law, r, x, force);
          axis.command(t, law1, r1, {{x[i]}}, {{force[i]}});
        } else {
          machine.stop(s, r, x, force, {8, 8, 8}, n > 35);
          axis.stop(t, r1, {{x[i]}}, {{force[i]}}, {8}, n > 35);
        }
        EXPECT_EQ(s[i].command, t[0].command) << i << ' ' << n;
        EXPECT_EQ(s[i].offset, t[0].offset) << i << ' ' << n;
      }
      EXPECT_EQ(machine.present(i), axis.present(0));
    }
  }
}

TEST(DriveInterface, BeforeItsFirstSampleAnAxisIsToldToStayWhereItIsOrShouldBe) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const bool stops : {false, true}) {
    for (const bool position : {false, true}) {
      const DriveInterface<1> drives(
          setup_with(position ? position_loop(0.5) : velocity_loop(), Observer::kNone));
      DriveInterface<1>::State s{};
      path::PathPoint<1> r;
      r.position[0] = 0.25;
      r.velocity[0] = kNan;
      const auto tell = [&](double measured) {
        if (stops) {
          drives.stop(s, r, {{measured}}, {}, {50}, false);
        } else {
          drives.command(s, {}, r, {{measured}}, {});
        }
        return s[0].command;
      };
      EXPECT_EQ(tell(kNan), position ? 0.25 : 0.0);
      EXPECT_EQ(tell(0.3), position ? 0.3 : 0.0);
      r.position[0] = kNan;
      EXPECT_EQ(tell(kNan), position ? 0.3 : 0.0) << "nothing new is known";
    }
  }
}

// A fault before the encoders have spoken: each axis waits where it is, or should be.
TEST(DriveInterface, AStopBeforeTheFirstSampleLeavesEveryAxisAtItsOwnPlace) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  control::Setup<2> setup;
  setup.period = kPeriod;
  for (auto& axis : setup.compensation) {
    axis.model.mass = 50.0;
    axis.model.drive_loop = position_loop(0.5);
  }
  const DriveInterface<2> drives(setup);
  DriveInterface<2>::State s{};
  path::PathPoint<2> r;
  r.position = {{0.25, -0.75}};
  drives.stop(s, r, {{kNan, kNan}}, {}, {50, 50}, false);
  EXPECT_EQ(s[0].command, 0.25);
  EXPECT_EQ(s[1].command, -0.75);
  drives.stop(s, r, {{0.3, -0.6}}, {}, {50, 50}, false);
  EXPECT_EQ(s[0].command, 0.3);
  EXPECT_EQ(s[1].command, -0.6);
}

// Each axis within its own stop time; the set points are at rest when the last one is.
TEST(DriveInterface, EveryAxisStopsWithinItsOwnTime) {
  control::Setup<2> setup;
  setup.period = kPeriod;
  for (auto& axis : setup.compensation) {
    axis.model.mass = 50.0;
    axis.model.drive_loop = velocity_loop();
  }
  const DriveInterface<2> drives(setup);
  DriveInterface<2>::State s{};
  path::PathPoint<2> r;
  r.velocity = {{0.1, 0.1}};
  drives.command(s, {}, r, {}, {});
  EXPECT_FALSE(drives.at_rest(s));
  for (int k = 1; k <= 100; ++k) {
    drives.stop(s, r, {}, {}, {20, 100}, false);
    EXPECT_NEAR(s[0].command, 0.1 * std::max(20 - k, 0) / 20.0, 1e-12) << k;
    EXPECT_NEAR(s[1].command, 0.1 * (100 - k) / 100.0, 1e-12) << k;
    EXPECT_EQ(drives.at_rest(s), k == 100) << k;
  }
  // An axis that takes forces is none of them.
  setup.compensation[1].model.drive_loop.reset();
  const DriveInterface<2> one(setup);
  DriveInterface<2>::State t{};
  for (int k = 1; k <= 20; ++k) one.stop(t, r, {}, {}, {20, 100}, false);
  EXPECT_TRUE(one.at_rest(t));
}

// Held, the set point of a drive that takes a position would stop dead: 3000 N for 100 kg at 0.1 m/s.
TEST(DriveInterface, OverMissingSamplesAPositionCommandGoesOn) {
  const DriveInterface<1> drives(setup_with(position_loop(1.0), Observer::kNone));
  DriveInterface<1>::State s{};
  path::PathPoint<1> r;
  r.velocity[0] = 0.1;
  double last = 0.0;
  for (int k = 0; k < 100; ++k) {
    r.position[0] = 0.1 * kPeriod * k;
    const bool lost = k >= 50 && k < 55;
    drives.command(s, {}, r, {{lost ? std::numeric_limits<double>::quiet_NaN() : r.position[0]}}, {{0.0}});
    if (k > 10) {
      EXPECT_NEAR(s[0].command - last, 0.1 * kPeriod, 1e-9) << k;
    }
    last = s[0].command;
  }
}

// The force that the drive reports is that of a command of a delay ago.
TEST(DriveInterface, TheReportedForceStandsWhereItsCommandDoes) {
  for (const int delay : {0, 1, 4}) {
    auto setup = setup_with(velocity_loop(), Observer::kDisturbance);
    setup.compensation[0].model.drive_loop->force_feedback = true;
    setup.compensation[0].model.delay = delay * kPeriod;
    const DriveInterface<1> drives(setup);
    DriveInterface<1>::State s{};
    drives.command(s, {}, {}, {}, {{0.0}});
    Common<1>::State law;
    law.compensation[0].force.fill(-1.0);
    drives.admit(s, law, {{7.0}});
    for (int k = 0; k < 6; ++k)
      EXPECT_EQ(law.compensation[0].force[static_cast<std::size_t>(k)],
                k == delay || k == delay + 1 ? 7.0 : -1.0)
          << delay << ' ' << k;
  }
}

TEST(DriveInterface, TheForceOffsetStaysWithinTheLimit) {
  auto loop = velocity_loop();
  loop.force_offset = true;
  auto setup = setup_with(loop, Observer::kNone);
  setup.force_limit[0] = 200.0;
  const DriveInterface<1> drives(setup);
  DriveInterface<1>::State s{};
  drives.command(s, {}, {}, {}, {{-200.0}});
  drives.command(s, {}, {}, {}, {{200.0}});
  EXPECT_EQ(s[0].offset, 200.0);
}

TEST(DriveCommand, InOtherUnitsTheCommandsAreTheSame) {
  // The unit of force a million times as large: a drive of newtons per metre is a soft one then, and its integral still one.
  for (const bool position : {false, true}) {
    for (const bool offset : {false, true}) {
      for (const bool integral : {false, true}) {
        DriveLoop loop = position ? position_loop(0.5) : velocity_loop();
        loop.force_offset = offset;
        if (!integral) loop.integral_time.reset();
        DriveLoop soft = loop;
        soft.gain *= 1e-7;
        const DriveCommand si(loop, 176.0, 0.3e-3, kPeriod);
        const DriveCommand other(soft, 176e-7, 0.3e-3, kPeriod);
        DriveCommand::State a, b;
        for (int k = 0; k < 60; ++k) {
          const double force = 300.0 + 100.0 * std::sin(0.1 * k);
          if (k < 40) {
            si.step(a, force, 0.2 * std::cos(0.2 * k), {0.1, 0.02, 3.0});
            other.step(b, 1e-7 * force, 0.2 * std::cos(0.2 * k), {0.1, 0.02, 3.0});
          } else {
            si.stop(a, 15, false);
            other.stop(b, 15, false);
          }
          ASSERT_NEAR(a.command, b.command, 1e-12) << k;
          ASSERT_NEAR(1e-7 * a.offset, b.offset, 1e-18) << k;
        }
      }
    }
  }
}

TEST(DriveCommand, AnAxisAtRestIsNotMovedByItsStart) {
  for (const double feedforward : {0.0, 0.5, 1.0}) {
    const DriveCommand position(position_loop(feedforward), 0.0, 0.3e-3, kPeriod);
    DriveCommand::State s;
    for (int k = 0; k < 3; ++k) {
      position.step(s, 1760.0, 0.0, {0.1, 0.0, 0.0});
      EXPECT_EQ(s.command, 0.1) << feedforward;
    }
  }
}

}  // namespace
}  // namespace stribeck::control::drive_interface_test
