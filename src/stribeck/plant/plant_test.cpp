#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/friction/table.hpp>
#include <stribeck/friction/test_maps.hpp>
#include <stribeck/plant/axis.hpp>
#include <stribeck/plant/mechanics.hpp>

namespace stribeck::plant::plant_test {
namespace {

constexpr double kPeriod = 5e-3;

/// V2, x axis, without noise.
AxisParams biaxial_x() {
  AxisParams p;
  p.mass = 57650.0;
  p.drive = CurrentDrive{1048.0, {}};
  p.encoder.resolution = 25e-9;
  p.friction.steady = friction::test::table_2_3_x();
  p.friction.dynamics = friction::LuGre<double>{3e8, 600e3, 0.05e-3};
  return p;
}

/// A drive with next to no friction: 1e-6 N.
AxisParams frictionless(double mass) {
  AxisParams p;
  p.mass = mass;
  p.drive = CurrentDrive{10.0, {}};
  p.encoder.resolution = 1e-9;
  p.friction.steady = friction::Conventional<double>{1e-6, 0.0, {}};
  p.friction.dynamics = friction::LuGre<double>{1e-3, 0.0, {}};
  return p;
}

constexpr Fidelity kExact{16, false, false};

TEST(Axis, WithoutFrictionIsADoubleIntegrator) {
  Axis axis(frictionless(2.0), kPeriod, 1.0);
  axis.start(0.1, kExact, {});
  for (int k = 0; k < 100; ++k) axis.step(0.3);
  EXPECT_NEAR(axis.velocity(), 3.0 / 2.0 * 0.5, 1e-6);
  EXPECT_NEAR(axis.position(), 0.1 + 0.5 * 1.5 * 0.25, 1e-6);
}

TEST(Axis, ReachesTheSpeedAtWhichFrictionBalancesTheForce) {
  Axis axis(biaxial_x(), kPeriod, 9.5e-3);
  axis.start(0.0, kExact, {});
  const double force = friction::steady_force(friction::test::table_2_3_x(), 2e-3);
  for (int k = 0; k < 4000; ++k) axis.step(force / 1048.0);
  EXPECT_NEAR(axis.velocity(), 2e-3, 1e-8);
  EXPECT_NEAR(axis.friction_force(), force, 1e-3);
}

TEST(Axis, FullForceFromRestStaysFiniteWithFewSubSteps) {
  // Bristles of 2 um at 60 m/s2: within one period of 5 ms the speed goes from rest to 0.3 m/s, at which bristles decay within 7 us. The
  // count of sub-steps at the beginning of the period knows nothing of that; the position became NaN.
  AxisParams p;
  p.mass = 100.0;
  p.drive = CurrentDrive{1000.0, {}};
  p.friction.steady =
      friction::Conventional<double>{200.0, 500.0, friction::Stribeck<double>{250.0, 2e-3, 2.0}};
  p.friction.dynamics = friction::LuGre<double>{1e8, 50e3, 0.5e-3};
  const auto run = [&](int substeps) {
    Axis axis(p, kPeriod, 1.0);
    axis.start(0.0, {substeps, false, false}, {});
    double farthest = 0.0;
    for (int k = 0; k < 200; ++k) {
      axis.step(k % 8 < 4 ? 6.0 : -6.0);
      farthest = std::max(farthest, std::abs(axis.position()));
      if (!std::isfinite(axis.position())) return axis.position();
    }
    return farthest;
  };
  const double fine = run(4096);
  EXPECT_GT(fine, 5e-3);
  // Six sub-steps are as few as the fastest rate of this axis allows. What they cost is accuracy, some percent at most.
  EXPECT_NEAR(run(6), fine, 0.05 * fine);
}

TEST(Axis, StaysWithinMicrometresBelowBreakAway) {
  Axis axis(biaxial_x(), kPeriod, 9.5e-3);
  axis.start(0.0, kExact, {});
  for (int k = 0; k < 2000; ++k) axis.step(std::min(1.0, k / 400.0) * 800.0 / 1048.0);  // a ramp of 2 s
  EXPECT_NEAR(axis.velocity(), 0.0, 1e-10);
  EXPECT_GT(axis.position(), 800.0 / 3e8);
  EXPECT_LT(axis.position(), 10e-6);
}

// 1000 N at the start against 250 N of static friction; at rest the spring pulls with no more than that.
TEST(Axis, ASpringPullsItBackUntilFrictionHoldsIt) {
  auto p = biaxial_x();
  p.mass = 100.0;
  p.drive = CurrentDrive{1000.0, {}};
  p.friction.steady =
      friction::Conventional<double>{200.0, 500.0, friction::Stribeck<double>{250.0, 2e-3, 2.0}};
  p.friction.dynamics = friction::LuGre<double>{1e8, 50e3, 0.5e-3};
  p.friction.spring = friction::Spring{20e3, 0.1};
  Axis axis(p, kPeriod, 1.0);
  axis.start(0.15, kExact, {});
  for (int k = 0; k < 5000; ++k) axis.step(0.0);
  EXPECT_NEAR(axis.velocity(), 0.0, 1e-9);
  EXPECT_LE(std::abs(axis.position() - 0.1), 250.0 / 20e3 + 1e-5);
  EXPECT_GT(std::abs(axis.position() - 0.15), 0.03);
}

TEST(Axis, MirrorsUnderSignForAMirroredMap) {
  auto p = biaxial_x();
  auto& map = std::get<friction::Gaussian<double>>(p.friction.steady);
  map.negative = friction::test::branch(
      -768.6, 102.48, {{-517.4, -1.763, 3.091}, {-509.3, -5.806, 1.825}, {-1995.9, -10.668, 1.876}});
  Axis plus(p, kPeriod, 9.5e-3);
  Axis minus(p, kPeriod, 9.5e-3);
  plus.start(0.0, kExact, {});
  minus.start(0.0, kExact, {});
  for (int k = 0; k < 400; ++k) {
    const double u = 2.0 * std::sin(0.05 * k);
    plus.step(u);
    minus.step(-u);
  }
  EXPECT_EQ(plus.position(), -minus.position());
}

TEST(Axis, TwoTogetherMoveAsEachAlone) {
  auto slow = biaxial_x();
  slow.friction.steady = friction::test::table_2_3_y();
  Axis a(biaxial_x(), kPeriod, 9.5e-3);
  Axis b(slow, kPeriod, 9.5e-3);
  Axis c(biaxial_x(), kPeriod, 9.5e-3);
  Axis d(slow, kPeriod, 9.5e-3);
  for (Axis* axis : {&a, &b, &c, &d}) axis->start(0.0, {3, true, false}, {});
  for (int k = 0; k < 600; ++k) {
    const double u = 2.5 * std::sin(0.02 * k);
    const double w = 2.5 * std::cos(0.02 * k);
    a.step(u);
    b.step(w);
    Axis::step_together(c, u, d, w);
  }
  EXPECT_EQ(a.position(), c.position());
  EXPECT_EQ(b.position(), d.position());
}

TEST(Mechanics, MovesOnTheTableAsOnTheMapItself) {
  // The way there: two periods of a sine that reaches beyond the identified range, where the curve has a
  // kink.
  using Law = friction::LuGre<double>;
  const auto p = biaxial_x();
  const auto map = friction::test::table_2_3_x();
  const Law law{3e8, 600e3, 0.05e-3};
  using Exact = friction::Composed<friction::Gaussian<double>>;
  using Tabled = friction::Composed<friction::Table>;
  Mechanics<Exact, Law, false, false> exact(p, {map, {}}, law);
  Mechanics<Tabled, Law, false, false> tabled(p, {friction::Table::build(map, 12e-3), {}}, law);
  exact.reset(0.0);
  tabled.reset(0.0);
  double fastest = 0.0;
  for (int k = 0; k < 4000; ++k) {
    const Held held{3.2 * std::sin(2 * kPi * k / 2000.0), 0.0, 0.0};
    exact.advance(held, kPeriod, 24);
    tabled.advance(held, kPeriod, 24);
    fastest = std::max(fastest, std::abs(exact.drive_velocity()));
    // Open loop: nothing pulls an error back. 40 mm of travel.
    ASSERT_NEAR(tabled.drive_position(), exact.drive_position(), 2e-9) << k;
  }
  EXPECT_GT(fastest, 9.6e-3);
}

TEST(Axis, GmsBreaksAwayAndSlidesOnTheSameCurve) {
  auto p = biaxial_x();
  friction::Gms<double> law;
  for (const double k : {1.6e8, 0.8e8, 0.4e8, 0.2e8}) law.elements.push_back({k, 0.25});
  law.attraction = 1e5;
  law.damping_coefficient = 600e3;
  law.damping_velocity = 0.05e-3;
  p.friction.dynamics = law;
  Axis axis(p, kPeriod, 9.5e-3);
  axis.start(0.0, kExact, {});
  const double force = friction::steady_force(friction::test::table_2_3_x(), 2e-3);
  for (int k = 0; k < 4000; ++k) axis.step(force / 1048.0);
  EXPECT_NEAR(axis.velocity(), 2e-3, 1e-8);
}

// ---- drive

AxisParams voltage_drive() {
  AxisParams p = frictionless(2.0);
  p.drive = VoltageDrive{2.0, 1.5, 3e-3, 0.05, 0.05, 5e-3};
  return p;
}

TEST(VoltageDrive, StallCurrentAndForceAreThoseOfOhm) {
  auto p = voltage_drive();
  p.friction.dynamics = friction::LuGre<double>{1e9, 1e4, {}};  // holds it
  p.friction.steady = friction::Conventional<double>{1e9, 0.0, {}};
  Axis axis(p, kPeriod, 1.0);
  axis.start(0.0, {400, false, false}, {});
  for (int k = 0; k < 200; ++k) axis.step(1.0);
  EXPECT_NEAR(axis.current(), 2.0 * 1.0 / 1.5, 1e-6);
  EXPECT_NEAR(p.force_gain(), 2.0 / 1.5 * 0.05 * 2 * kPi / 5e-3, 1e-9);
}

TEST(VoltageDrive, RunsUntilBackEmfBalancesTheVoltage) {
  // No friction: i = 0, so k_u u = K_e r_g v. This is the extra viscous friction of (2.4), here through the
  // armature alone.
  Axis axis(voltage_drive(), kPeriod, 1.0);
  axis.start(0.0, kExact, {});
  for (int k = 0; k < 3000; ++k) axis.step(1.0);
  EXPECT_NEAR(axis.velocity(), 2.0 / (0.05 * 2 * kPi / 5e-3), 1e-6);
}

// The force that acts, not that of a motor that stands: the voltage alone would say 1.5·6 V/2 Ω·K_t·r_g at any speed.
TEST(VoltageDrive, TellsTheForceThatActs) {
  auto p = voltage_drive();
  Axis axis(p, kPeriod, 1.0);
  axis.start(0.0, kExact, {});
  EXPECT_EQ(axis.force(), 0.0);
  // Force is mass times acceleration, and friction, over every period.
  double worst = 0.0;
  double worst_now = 0.0;
  for (int k = 0; k < 3000; ++k) {
    const double v = axis.velocity();
    const double before = axis.friction_force();
    axis.step(k < 1500 ? 6.0 : -3.0);
    const double net = p.mass * (axis.velocity() - v) / kPeriod + 0.5 * (before + axis.friction_force());
    if (k % 1500 > 20) worst = std::max(worst, std::abs(axis.force() - net));
    if (k == 1499 || k == 2999)
      worst_now = std::max(worst_now, std::abs(axis.force() - axis.friction_force()));
  }
  EXPECT_LT(worst, 0.01 * p.force_gain() * 6.0);
  EXPECT_LT(worst_now, 1e-3 * p.force_gain() * 6.0) << "in balance with friction at the end";
}

TEST(CurrentDrive, TellsTheForceThatActs) {
  auto p = biaxial_x();
  p.delay_periods = 2;
  p.delay_fraction = 0.25;
  Axis axis(p, kPeriod, 0.02);
  axis.start(0.0, kExact, {});
  const double gain = p.force_gain();
  std::vector<double> told;
  for (const double u : {1.0, -2.0, 3.0, 0.5, 0.0, 0.0}) {
    axis.step(u);
    told.push_back(axis.force() / gain);
  }
  const std::array expected{0.0, 0.0, 0.75, -1.25, 1.75, 1.125};
  for (std::size_t k = 0; k < told.size(); ++k) EXPECT_NEAR(told[k], expected[k], 1e-12) << k;
}

TEST(VoltageDrive, RotorInertiaComesOnTopThroughTheScrew) {
  auto p = voltage_drive();
  p.rotor_inertia = 1e-5;
  const double ratio = 2 * kPi / 5e-3;
  EXPECT_NEAR(p.total_mass(), 2.0 + 1e-5 * ratio * ratio, 1e-9);
}

// ---- axial mode

TEST(AxialMode, TableRingsAtItsFrequencyOverAHeavyDrive) {
  auto p = frictionless(100.0);
  p.axial_mode = AxialMode{40.0, 0.0, 0.001};  // a light table on a heavy drive: the drive hardly moves
  Axis axis(p, 1e-4, 1.0);
  axis.start(0.0, kExact, {});
  for (int k = 0; k < 10; ++k) axis.step(10.0);
  // Count the sign changes of table minus drive, detrended by the drive's own motion: use velocity of the
  // spring force.
  double last = 0.0;
  int crossings = 0;
  double x0 = axis.position();
  double v0 = 0.0;
  for (int k = 0; k < 10000; ++k) {
    axis.step(0.0);
    const double v = axis.position() - x0;
    x0 = axis.position();
    const double a = v - v0;
    v0 = v;
    if (k > 1 && a * last < 0.0) ++crossings;
    last = a;
  }
  EXPECT_NEAR(crossings / 2.0, 40.0, 1.0);  // in one second
}

TEST(AxialMode, StiffModeMovesAsTheRigidAxis) {
  auto p = biaxial_x();
  Axis rigid(p, kPeriod, 9.5e-3);
  p.axial_mode = AxialMode{400.0, 0.05, 0.4};
  Axis flexible(p, kPeriod, 9.5e-3);
  rigid.start(0.0, {64, false, false}, {});
  flexible.start(0.0, {64, false, false}, {});
  for (int k = 0; k < 400; ++k) {
    rigid.step(2.0);
    flexible.step(2.0);
  }
  EXPECT_NEAR(flexible.position(), rigid.position(), 2e-6);
  EXPECT_GT(std::abs(flexible.position() - rigid.position()), 1e-12);
}

// ---- lost motion

/// A table of 500 kg behind 10 µm of backlash and 20 N/µm, with 60 % of the friction.
AxisParams with_lost_motion() {
  AxisParams p = biaxial_x();
  p.mass = 2000.0;
  p.friction.dynamics = friction::LuGre<double>{3e8, 100e3, 0.05e-3};
  p.lost_motion = LostMotion{10e-6, 0.0, 20e6, 0.2, 0.25, 0.6};
  p.second_encoder = SecondEncoder{1e-9};
  return p;
}

/// How far the drive side is ahead of the table after sliding at 2 mm/s in one direction.
double ahead(const AxisParams& p, double direction) {
  Axis axis(p, 1e-3, 9.5e-3);
  axis.start(0.0, {64, false, false}, {});
  const double force = friction::steady_force(friction::test::table_2_3_x(), direction * 2e-3);
  for (int k = 0; k < 8000; ++k) axis.step((p.load + force) / 1048.0);
  EXPECT_NEAR(axis.velocity(), direction * 2e-3, 1e-7);
  return axis.encoder() - axis.second_encoder();
}

TEST(LostMotion, TableFollowsByHalfTheBacklashAndTheWindUpOfItsFriction) {
  const AxisParams p = with_lost_motion();
  const auto map = friction::test::table_2_3_x();
  EXPECT_NEAR(ahead(p, 1.0), 5e-6 + 0.6 * friction::steady_force(map, 2e-3) / 20e6, 1e-9);
  EXPECT_NEAR(ahead(p, -1.0), -5e-6 + 0.6 * friction::steady_force(map, -2e-3) / 20e6, 1e-9);
}

TEST(LostMotion, BacklashFollowsItsSlopeAlongTheTravel) {
  AxisParams p = with_lost_motion();
  const double even = ahead(p, 1.0);  // the table is then at nearly 16 mm
  p.lost_motion->backlash_slope = 1e-4;
  EXPECT_NEAR(ahead(p, 1.0) - even, 0.5 * 1e-4 * 16e-3, 2e-8);
}

TEST(LostMotion, WeightKeepsTheTableOnOneSide) {
  AxisParams p = with_lost_motion();
  p.load = 1000.0;  // more than the friction of the table
  EXPECT_GT(ahead(p, 1.0), 5e-6);
  EXPECT_GT(ahead(p, -1.0), 5e-6);
}

TEST(LostMotion, WithoutBacklashAndTableFrictionItIsTheAxialMode) {
  AxisParams p = with_lost_motion();
  p.lost_motion->backlash = 0.0;
  p.lost_motion->table_friction = 0.0;
  AxisParams q = p;
  q.lost_motion.reset();
  q.axial_mode = AxialMode{std::sqrt(20e6 / 500.0) / (2.0 * kPi), 0.2, 0.25};
  Axis one(p, 1e-3, 9.5e-3);
  Axis other(q, 1e-3, 9.5e-3);
  one.start(0.0, {16, false, false}, {});
  other.start(0.0, {16, false, false}, {});
  for (int k = 0; k < 2000; ++k) {
    one.step(1.5 * std::sin(0.01 * k));
    other.step(1.5 * std::sin(0.01 * k));
    ASSERT_NEAR(one.position(), other.position(), 1e-12) << k;
  }
}

TEST(LostMotion, ConvergesWithTheSubStepsAndBeginsAgain) {
  // 50 N/µm on a table of 50 kg: 160 Hz, with gaps that open and close at every reversal.
  AxisParams p = with_lost_motion();
  p.lost_motion = LostMotion{40e-6, 0.0, 50e6, 0.1, 0.025, 0.3};
  Axis axis(p, 1e-3, 9.5e-3);
  const auto run = [&](int substeps) {
    axis.start(0.0, {substeps, false, false}, {});
    std::vector<double> gap;
    for (int k = 0; k < 4000; ++k) {
      axis.step(1.2 * std::sin(2 * kPi * k / 1000.0));
      gap.push_back(axis.encoder() - axis.second_encoder());
    }
    return gap;
  };
  const auto fine = run(256);
  const auto coarse = run(32);
  EXPECT_EQ(run(32), coarse);
  double widest = 0.0;
  double most = 0.0;
  for (std::size_t k = 0; k < fine.size(); ++k) {
    widest = std::max(widest, fine[k]);
    most = std::max(most, std::abs(fine[k] - coarse[k]));
  }
  EXPECT_GT(widest, 20e-6);
  EXPECT_LT(most, 0.2e-6);  // the instant of contact lies between two sub-steps
}

TEST(LostMotion, FeedbackAndSecondEncoderChangeSides) {
  AxisParams p = with_lost_motion();
  const double motor_first = ahead(p, 1.0);
  p.encoder.side = EncoderSide::kTable;
  EXPECT_NEAR(ahead(p, 1.0), -motor_first, 1e-12);
  p.second_encoder.reset();
  Axis axis(p, 1e-3, 9.5e-3);
  EXPECT_TRUE(std::isnan(axis.second_encoder()));
}

// ---- warming up

/// V2, x axis, with a third part of friction that keeps its sign: 50 N everywhere.
AxisParams biaxial_x_that_warms(bool gms = false) {
  AxisParams p = biaxial_x();
  p.friction.eccentric.push_back({50.0, 1e9, -0.5 * kPi, friction::EccentricForm::kAdditive});
  if (gms) {
    friction::Gms<double> law;
    for (const double k : {1.6e8, 0.8e8, 0.4e8, 0.2e8}) law.elements.push_back({k, 0.25});
    law.attraction = 1e5;
    law.damping_coefficient = 600e3;
    law.damping_velocity = 0.05e-3;
    p.friction.dynamics = law;
  }
  p.warming = Warming{-0.2, 0.5};
  return p;
}

TEST(Warming, ScalesLevelAndViscousPartAndLeavesTheRest) {
  // A force of 80 % of cold friction, and what does not change, holds the speed once the axis is warm: after 40 time constants.
  const double force = 0.8 * friction::steady_force(friction::test::table_2_3_x(), 2e-3) + 50.0;
  for (const bool mode : {false, true}) {
    for (const bool gms : {false, true}) {
      auto p = biaxial_x_that_warms(gms);
      if (mode) p.axial_mode = AxialMode{80.0, 0.05, 0.3};
      Axis axis(p, kPeriod, 9.5e-3);
      axis.start(0.0, kExact, {});
      for (int k = 0; k < 4000; ++k) axis.step(force / 1048.0);
      EXPECT_NEAR(axis.velocity(), 2e-3, 1e-8) << mode << gms;
      EXPECT_NEAR(axis.friction_force(), force, 1e-3) << mode << gms;
    }
  }
}

TEST(Warming, FollowsItsTimeConstant) {
  // Viscous friction and little mass: v = f/(c·share(t)), late by m/c = 1 ms of a τ of 2 s, 0.05 % of 50 %.
  auto p = frictionless(1.0);
  p.friction.steady = friction::Conventional<double>{1e-6, 1000.0, {}};
  p.warming = Warming{-0.5, 2.0};
  Axis axis(p, kPeriod, 1.0);
  axis.start(0.0, {32, false, false}, {});
  for (int k = 0; k < 1200; ++k) {
    axis.step(1.0);
    const double t = kPeriod * (k + 1);
    if (k >= 10) {
      EXPECT_NEAR(axis.velocity(), 0.01 / (0.5 + 0.5 * std::exp(-t / 2.0)), 0.01 * 2e-3) << t;
    }
  }
}

TEST(Warming, WithoutChangeIsTheAxisWithout) {
  auto p = biaxial_x_that_warms();
  p.warming->change = 0.0;
  Axis warm(p, kPeriod, 9.5e-3);
  p.warming.reset();
  Axis without(p, kPeriod, 9.5e-3);
  warm.start(0.0, kExact, {});
  without.start(0.0, kExact, {});
  for (int k = 0; k < 400; ++k) {
    warm.step(2.0 * std::sin(0.05 * k));
    without.step(2.0 * std::sin(0.05 * k));
  }
  EXPECT_EQ(warm.position(), without.position());
}

TEST(Warming, BeginsAgainWithEveryRunAndMirrors) {
  auto p = biaxial_x_that_warms();
  p.friction.eccentric = {};
  auto& map = std::get<friction::Gaussian<double>>(p.friction.steady);
  map.negative = friction::test::branch(
      -768.6, 102.48, {{-517.4, -1.763, 3.091}, {-509.3, -5.806, 1.825}, {-1995.9, -10.668, 1.876}});
  Axis axis(p, kPeriod, 9.5e-3);
  const auto run = [&](double direction) {
    axis.start(0.0, kExact, {});
    for (int k = 0; k < 400; ++k) axis.step(direction * 2.0 * std::sin(0.05 * k));
    return axis.position();
  };
  const double first = run(1.0);
  EXPECT_EQ(run(1.0), first);
  EXPECT_EQ(run(-1.0), -first);
}

// ---- converter, encoder, delay, noise

TEST(Axis, EncoderAndConverterRound) {
  Axis axis(biaxial_x(), kPeriod, 9.5e-3);
  axis.start(13e-9, {8, true, false}, {});
  EXPECT_EQ(axis.encoder(), 25e-9);
  axis.step(1.00001);
  EXPECT_NEAR(axis.voltage() / (20.0 / 65536), std::round(1.00001 / (20.0 / 65536)), 1e-9);
  axis.step(99.0);
  EXPECT_NEAR(axis.voltage(), 10.0 - 20.0 / 65536, 1e-12);
  axis.step(-99.0);
  EXPECT_EQ(axis.voltage(), -10.0);
}

TEST(Axis, DelayShiftsTheMotionByWholePeriods) {
  auto p = biaxial_x();
  Axis prompt(p, kPeriod, 9.5e-3);
  p.delay_periods = 2;
  Axis late(p, kPeriod, 9.5e-3);
  prompt.start(0.0, kExact, {});
  late.start(0.0, kExact, {});
  std::vector<double> first;
  for (int k = 0; k < 300; ++k) {
    prompt.step(1.5 + std::sin(0.1 * k));
    first.push_back(prompt.position());
    late.step(1.5 + std::sin(0.1 * k));
    if (k >= 2) {
      EXPECT_EQ(late.position(), first[k - 2]) << k;
    }
  }
}

TEST(Axis, AFractionOfADelayLiesBetweenWholePeriods) {
  auto p = biaxial_x();
  std::array<double, 3> end{};
  for (int i = 0; i < 3; ++i) {
    p.delay_fraction = 0.5 * i;
    Axis axis(p, kPeriod, 9.5e-3);
    axis.start(0.0, kExact, {});
    for (int k = 0; k < 300; ++k) axis.step(1.5 + std::sin(0.1 * k));
    end[static_cast<std::size_t>(i)] = axis.position();
  }
  p.delay_fraction.reset();
  p.delay_periods = 1;
  Axis whole(p, kPeriod, 9.5e-3);
  whole.start(0.0, kExact, {});
  for (int k = 0; k < 300; ++k) whole.step(1.5 + std::sin(0.1 * k));
  EXPECT_NEAR(end[2], whole.position(), 1e-12);
  EXPECT_GT(std::abs(end[0] - end[2]), 1e-6);
  EXPECT_NEAR(end[1], 0.5 * (end[0] + end[2]), 0.1 * std::abs(end[0] - end[2]));
}

TEST(Axis, FrictionAlongTheTravelIsThatOfThePlace) {
  auto p = biaxial_x();
  // The crest of the wave is at the start: 20 % more level there.
  p.friction_along_travel = FrictionAlongTravel{0.2, 0.3, 10.0, 0.5 * kPi};
  auto places = biaxial_x();
  places.friction.places.push_back({0.0, 1.2, 1.3});
  Axis wave(p, kPeriod, 9.5e-3), placed(places, kPeriod, 9.5e-3), plain(biaxial_x(), kPeriod, 9.5e-3);
  for (Axis* axis : {&wave, &placed, &plain}) {
    axis->start(0.0, kExact, {});
    for (int k = 0; k < 400; ++k) axis->step(1.8);
  }
  // 5 mm from the crest of a wave of 10 m the share is off by 5e-6 of 0.2.
  EXPECT_NEAR(wave.position(), placed.position(), 1e-5 * placed.position());
  EXPECT_LT(wave.position(), 0.95 * plain.position());
}

TEST(Axis, TorqueRippleActsWithTheForceOnly) {
  auto p = biaxial_x();
  p.torque_ripple = TorqueRipple{0.05, 10.0, 0.5 * kPi};  // 5 % more at the start, on a wave of 10 m
  Axis rippled(p, kPeriod, 9.5e-3), plain(biaxial_x(), kPeriod, 9.5e-3);
  for (Axis* axis : {&rippled, &plain}) axis->start(0.0, kExact, {});
  for (int k = 0; k < 200; ++k) {
    rippled.step(1.8);
    plain.step(1.05 * 1.8);
  }
  EXPECT_NEAR(rippled.position(), plain.position(), 1e-4 * plain.position());
}

TEST(Axis, AnEncoderErrorIsReadAndNotDriven) {
  auto p = biaxial_x();
  p.encoder_error = EncoderError{30e-9, 20e-6};
  Axis axis(p, kPeriod, 9.5e-3);
  axis.start(5e-6, {8, false, false}, {});
  EXPECT_NEAR(axis.encoder() - axis.position(), 30e-9, 1e-15);
  EXPECT_EQ(axis.position(), 5e-6);
}

TEST(Axis, AViscousExponentKeepsTheForceAtItsSpeed) {
  auto p = biaxial_x();
  p.viscous_exponent = ViscousExponent{0.75, 4e-3};
  EXPECT_DOUBLE_EQ(p.viscous_exponent->share(-4e-3), 1.0);
  EXPECT_NEAR(p.viscous_exponent->share(8e-3) * 8e-3, std::pow(2.0, 0.75) * 4e-3, 1e-15);
  // At 9.5 mm/s the viscous part is smaller than in proportion: the same force gives a higher speed.
  Axis bent(p, kPeriod, 12e-3), plain(biaxial_x(), kPeriod, 12e-3);
  for (Axis* axis : {&bent, &plain}) {
    axis->start(0.0, kExact, {});
    for (int k = 0; k < 2000; ++k) axis->step(2.2);
  }
  EXPECT_GT(bent.velocity(), plain.velocity());
}

TEST(NoiseSource, HasTheDeviationAndCorrelationAskedFor) {
  NoiseSource noise({20.0, 47e-3}, kPeriod, {1, 0, 0});
  constexpr int kCount = 400000;
  double square = 0.0;
  double lagged = 0.0;
  double last = noise.next();
  for (int i = 0; i < kCount; ++i) {
    const double n = noise.next();
    square += n * n;
    lagged += n * last;
    last = n;
  }
  // About 21 000 independent samples: 0.7 % (one sigma) on the variance.
  EXPECT_NEAR(std::sqrt(square / kCount), 20.0, 0.3);
  EXPECT_NEAR(lagged / square, std::exp(-5.0 / 47.0), 0.005);
}

TEST(NoiseSource, UniformNoiseStaysWithinItsBoundsWithoutMemory) {
  NoiseSource noise({0.2 / std::sqrt(3.0), 0.0, NoiseKind::kUniform}, kPeriod, {1, 0, 0});
  double square = 0.0, neighbours = 0.0, last = 0.0, largest = 0.0;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const double now = noise.next();
    square += now * now / kDraws;
    neighbours += now * last / kDraws;
    largest = std::max(largest, std::abs(now));
    last = now;
  }
  EXPECT_LE(largest, 0.2);
  EXPECT_GE(largest, 0.199);
  EXPECT_NEAR(square, 0.04 / 3.0, 0.0003);  // three standard errors
  EXPECT_NEAR(neighbours / square, 0.0, 0.022);
}

TEST(NoiseSource, StreamsAreReproducibleAndTheirOwn) {
  const auto first = [](const Stream& s) { return NoiseSource({20.0, 47e-3}, kPeriod, s).next(); };
  EXPECT_EQ(first({1, 2, 0}), first({1, 2, 0}));
  EXPECT_NE(first({1, 2, 0}), first({1, 2, 1}));
  EXPECT_NE(first({1, 2, 0}), first({1, 3, 0}));
  EXPECT_NE(first({1, 2, 0}), first({2, 2, 0}));
}

TEST(Axis, StartBeginsTheSameRunAgain) {
  auto p = biaxial_x();
  p.noise = ForceNoise{20.0, 47e-3};
  Axis axis(p, kPeriod, 9.5e-3);
  double ends[2];
  for (double& end : ends) {
    axis.start(0.0, {4, true, true}, {7, 1, 0});
    for (int k = 0; k < 200; ++k) axis.step(1.8);
    end = axis.position();
  }
  EXPECT_EQ(ends[0], ends[1]);
}

TEST(AxisParams, ComplainAboutWhatCannotBeSimulated) {
  auto p = biaxial_x();
  p.friction.dynamics = friction::Static{};
  p.rotor_inertia = 1e-5;
  std::vector<std::string> keys;
  p.validate([&](std::string_view key, std::string_view) { keys.emplace_back(key); });
  EXPECT_EQ(keys, (std::vector<std::string>{"friction.dynamics", "rotor_inertia"}));
  AxisParams both = with_lost_motion();
  both.axial_mode = AxialMode{40.0, 0.02, 0.3};
  keys.clear();
  both.validate([&](std::string_view key, std::string_view) { keys.emplace_back(key); });
  EXPECT_EQ(keys, (std::vector<std::string>{"axial_mode"}));
}

// ---- unbalance

// The small pendulum: ω² = M/J about the angle at which it hangs.
TEST(Unbalance, SwingsAsAPendulum) {
  AxisParams p = frictionless(2.0);
  p.unbalance = friction::Unbalance{8.0, 0.3};
  Axis axis(p, kPeriod, 1.0);
  axis.start(0.31, kExact, {});
  constexpr int kQuarter = 157;  // of the period: π/2/√(8/2) s
  for (int k = 0; k < kQuarter; ++k) axis.step(0.0);
  EXPECT_NEAR(axis.position(), 0.3, 1e-4);    // half a step of time: 0.25 ms times 0.02 m/s
  EXPECT_NEAR(axis.velocity(), -0.02, 2e-4);  // A·ω
  for (int k = 0; k < kQuarter; ++k) axis.step(0.0);
  EXPECT_NEAR(axis.position(), 0.29, 1e-4);
}

TEST(Unbalance, IsHeldByTheForceThatItNeeds) {
  AxisParams p = frictionless(2.0);
  p.unbalance = friction::Unbalance{8.0, 0.3};
  Axis axis(p, kPeriod, 1.0);
  axis.start(1.0, kExact, {});
  for (int k = 0; k < 50; ++k) axis.step(8.0 * std::sin(0.7) / 10.0);
  EXPECT_NEAR(axis.position(), 1.0, 1e-6);  // the friction of 1e-6 N
}

}  // namespace
}  // namespace stribeck::plant::plant_test
