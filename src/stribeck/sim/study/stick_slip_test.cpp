#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <stribeck/sim/compare.hpp>
#include <stribeck/sim/study/stick_slip.hpp>
#include <stribeck/sim/test_machine.hpp>
#include <vector>

namespace stribeck::sim::stick_slip_test {
namespace {

/// Coulomb 90 N with bristles of 10 um; `dip`: static friction of 150 N that falls within 4 mm/s.
friction::Model friction_of(bool dip) {
  friction::Model f;
  friction::Conventional<double> map{90.0, 500.0, {}};
  if (dip) map.stribeck = friction::Stribeck<double>{150.0, 4e-3, 2.0};
  f.steady = map;
  friction::LuGre<double> bristles;
  bristles.sigma0 = 9e6;
  bristles.sigma1 = 300.0;
  bristles.damping_velocity = 1e-4;
  f.dynamics = bristles;
  return f;
}

/// A light table with this friction on both axes.
struct Table {
  Machine machine = test::biaxial_table();
  std::vector<AxisKnowledge> known{2};

  explicit Table(const friction::Model& f) {
    machine.sample_time = 1e-3;
    for (auto& [name, axis] : machine.axes) {
      axis.plant.mass = 18.0;
      axis.plant.rotor_inertia.reset();
      axis.plant.load = 0.0;
      axis.plant.drive = plant::CurrentDrive{816.8, std::nullopt};
      axis.plant.encoder.resolution = 1e-8;
      axis.plant.noise.reset();
      axis.plant.friction = f;
    }
    for (AxisKnowledge& k : known) {
      friction::AxisModel model;
      model.mass = 18.0;
      model.friction = f;
      k.whole = k.conventional = k.gaussian = model;
    }
  }

  /// Of axis x under PD with a double pole at omega [rad/s].
  SmoothSpeed slowest(double omega) {
    const ControllerSpec c = biaxial_controllers(control::ContouringParams::critical(omega, omega)).front();
    const auto setup = make_setup<2>(machine, known, {0, 1}, c);
    const auto loops = loop_responses<2>(c.law, setup);
    const AnyController<2> controller = make_controller<2>(c.law, setup);
    Drives drives(machine, {0, 1}, 0.05);
    SmoothSpeed out;
    const friction::Model& f = machine.axes[0].second.plant.friction;
    out.predicted = slowest_smooth(1.0, [&](double v) { return !oscillates(loops[0], 18.0, f, v); });
    out.simulated = slowest_smooth(1.0, [&](double v) { return !sticks<2>(drives, controller, {}, 0, v); });
    return out;
  }
};

// A hand would say: the slope where friction is viscous or falls, 4F/(πa) where it switches, 1/(jω) times the stiffness of bristles.
TEST(StickSlip, TheResistanceIsThatOfTheLaw) {
  friction::Model viscous;
  viscous.steady = friction::Conventional<double>{1e-6, 700.0, {}};
  const auto sigma = friction_resistance(viscous, 0.01, 0.004, 20.0);
  EXPECT_NEAR(sigma.real(), 700.0, 0.1);
  EXPECT_NEAR(sigma.imag(), 0.0, 0.1);

  friction::Model falling = friction_of(true);
  falling.dynamics = friction::Static{};
  const double v0 = 3e-3, step = 1e-6;
  const double slope = (falling.parts(v0 + step, 0.0).level + falling.parts(v0 + step, 0.0).viscous -
                        falling.parts(v0 - step, 0.0).level - falling.parts(v0 - step, 0.0).viscous) /
                       (2.0 * step);
  ASSERT_LT(slope, -5000.0);
  EXPECT_NEAR(friction_resistance(falling, v0, 0.01 * v0, 20.0).real(), slope, 0.01 * std::abs(slope));

  friction::Model switching = friction_of(false);
  switching.dynamics = friction::Static{};
  const double amplitude = 0.02;
  EXPECT_NEAR(friction_resistance(switching, 1e-9, amplitude, 20.0).real(),
              500.0 + 4.0 * 90.0 / (kPi * amplitude), 60.0);

  // 0.1 um about rest: elastic.
  const double omega = 50.0;
  const auto spring = friction_resistance(friction_of(false), 1e-12, 1e-7 * omega, omega);
  EXPECT_NEAR(spring.imag(), -9e6 / omega, 0.05 * 9e6 / omega);
}

TEST(StickSlip, PredictionAndSimulationAgree) {
  Table table(friction_of(true));
  for (const double omega : {20.0, 80.0}) {
    const SmoothSpeed slowest = table.slowest(omega);
    ASSERT_TRUE(slowest.predicted && slowest.simulated) << omega;
    EXPECT_NEAR(std::log(*slowest.predicted / *slowest.simulated), 0.0, std::log(2.0)) << omega;
    EXPECT_GT(*slowest.simulated, 4e-3);
    EXPECT_LT(*slowest.simulated, 15e-3);
  }
}

TEST(StickSlip, TheSpeedsEndAtTheSlowestOne) {
  const auto always = [](double) { return true; };
  // 13.3 mm/s: the limit of an axis is no round number.
  for (const double fastest : {13.3e-3, 20e-3, 1.0})
    EXPECT_DOUBLE_EQ(slowest_smooth(fastest, always).value_or(0.0), kSlowestLooked) << fastest;
  EXPECT_FALSE(slowest_smooth(13.3e-3, [](double) { return false; }));
  EXPECT_NEAR(slowest_smooth(1.0, [](double v) { return v > 1e-3; }).value_or(0.0), 1.12e-3, 0.02e-3);
}

// Coulomb and viscous friction do not fall: nothing drives an oscillation.
TEST(StickSlip, WithoutAFallingCurveThereIsNone) {
  Table table(friction_of(false));
  const SmoothSpeed slowest = table.slowest(80.0);
  ASSERT_TRUE(slowest.predicted && slowest.simulated);
  EXPECT_LT(*slowest.predicted, 1.01 * kSlowestLooked);
  EXPECT_LT(*slowest.simulated, 1e-3);
}

}  // namespace
}  // namespace stribeck::sim::stick_slip_test
