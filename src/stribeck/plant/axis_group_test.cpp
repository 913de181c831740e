#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <stribeck/friction/test_maps.hpp>
#include <stribeck/plant/axis_group.hpp>
#include <stribeck/plant/packed/instruction_sets.hpp>

namespace stribeck::plant::axis_group_test {
namespace {

constexpr double kPeriod = 5e-3;

double random_in(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

/// A drive of V2's size, with other mass, friction and bristles each time.
AxisParams any_drive(std::mt19937_64& random, bool voltage, bool mode, bool fades) {
  AxisParams p;
  p.mass = random_in(random, 3e4, 9e4);
  p.drive = CurrentDrive{1048.0, {}};
  if (voltage) {
    // amplifier, resistance, inductance, torque constant, back-EMF, lead
    p.drive = VoltageDrive{2.5, random_in(random, 1.0, 2.0), random_in(random, 5e-3, 2e-2), 0.5, 0.5, 5e-3};
  }
  if (mode) p.axial_mode = AxialMode{random_in(random, 40.0, 90.0), 0.02, 0.4};
  p.encoder.resolution = 25e-9;
  p.friction.steady = friction::test::table_2_3_x().scaled(random_in(random, 0.5, 1.5));
  friction::LuGre<double> bristles{random_in(random, 1e8, 9e8), 600e3, {}};
  if (fades) bristles.damping_velocity = 0.05e-3;
  p.friction.dynamics = bristles;
  p.noise = ForceNoise{20.0, 47e-3};
  return p;
}

/// Runs some drives along a sine with a loop closed, alone and in a group; the states must be the same bits. `push` [V] drives them
/// away for some periods, which needs sub-steps that are divided.
void expect_same_bits(const std::vector<AxisParams>& params, const InstructionSet& with,
                      std::size_t expected_packed, double push = 0.0) {
  std::vector<Axis> alone;
  std::vector<Axis> together;
  std::vector<Axis*> members;
  for (std::uint32_t i = 0; i < params.size(); ++i) {
    for (std::vector<Axis>* axes : {&alone, &together}) {
      axes->emplace_back(params[i], kPeriod, 9.5e-3);
      // Not all drives need the same number of sub-steps.
      axes->back().start(0.01 * i, {i % 3 == 0 ? 6 : 3, true, true}, {7, 1, i});
    }
  }
  for (Axis& a : together) members.push_back(&a);
  AxisGroup group(members, &with);
  EXPECT_EQ(group.packed(), expected_packed);
  std::vector<AxisInput> inputs(params.size());
  for (int k = 0; k < 850; ++k) {
    for (std::size_t i = 0; i < params.size(); ++i) {
      const double t = k * kPeriod;
      const double r = 0.01 * static_cast<double>(i) + 6e-3 * std::sin(1.5 * t);
      const double v = 9e-3 * std::cos(1.5 * t);
      const double force = 55e3 * (900.0 * (r - alone[i].encoder())) + std::copysign(1000.0, v) + 1e5 * v;
      inputs[i] = {force / 1048.0 + (k % 400 < 8 ? push : 0.0), 5.0 * std::sin(t), 0.0};
      alone[i].step(inputs[i].command, inputs[i].cutting);
    }
    group.step(inputs);
    for (std::size_t i = 0; i < params.size(); ++i) {
      const auto same = [](double a, double b) {
        return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
      };
      ASSERT_TRUE(same(alone[i].position(), together[i].position()) &&
                  same(alone[i].velocity(), together[i].velocity()) &&
                  same(alone[i].friction_force(), together[i].friction_force()) &&
                  same(alone[i].voltage(), together[i].voltage()))
          << with.name << ", drive " << i << ", tick " << k;
    }
  }
}

TEST(AxisGroup, MovesEachDriveAsAlone) {
  for (const InstructionSet& set : instruction_sets()) {
    for (const bool voltage : {false, true}) {
      for (const bool mode : {false, true}) {
        std::mt19937_64 random(11);
        std::vector<AxisParams> drives;
        for (int i = 0; i < 21; ++i) drives.push_back(any_drive(random, voltage, mode, i % 4 != 0));
        expect_same_bits(drives, set, 21);
      }
    }
  }
}

TEST(AxisGroup, SubStepsThatMustBeDividedAreTheSameToo) {
  // 8 V for 40 ms bring a drive to five times the speed of its map and back: bristles decay within a tenth of a sub-step.
  for (const InstructionSet& set : instruction_sets()) {
    std::mt19937_64 random(12);
    std::vector<AxisParams> drives;
    for (int i = 0; i < 20; ++i) {
      drives.push_back(any_drive(random, false, false, true));
      drives.back().mass = i % 2 == 0 ? 60.0 : 500.0;
    }
    expect_same_bits(drives, set, 20, 8.0);
  }
}

TEST(AxisGroup, DrivesThatDoNotFitMoveAlone) {
  for (const InstructionSet& set : instruction_sets()) {
    std::mt19937_64 random(13);
    std::vector<AxisParams> drives;
    for (int i = 0; i < 12; ++i) drives.push_back(any_drive(random, false, false, true));
    drives[1].friction.eccentric.push_back({});
    drives[1].friction.eccentric[0].amplitude = 30.0;
    drives[5].delay_fraction = 0.3;
    drives[6].warming = Warming{-0.2, 60.0};
    drives[7].friction.spring = friction::Spring{4e4, 0.0};
    friction::Gms<double> gms;
    for (const double stiffness : {2e8, 1e8}) gms.elements.push_back({stiffness, 0.5});
    gms.attraction = 5e4;
    drives[3].friction.dynamics = gms;
    // Three voltage drives are too few for a pack.
    for (int i = 0; i < 3; ++i) drives.push_back(any_drive(random, true, false, true));
    expect_same_bits(drives, set, 7);
  }
}

TEST(AxisGroup, RefusesDrivesOfOtherPeriods) {
  std::mt19937_64 random(15);
  Axis one(any_drive(random, false, false, true), kPeriod, 9.5e-3);
  Axis other(any_drive(random, false, false, true), 0.5 * kPeriod, 9.5e-3);
  EXPECT_THROW(AxisGroup({&one, &other}), std::invalid_argument);
}

TEST(AxisGroup, WithoutPacksAllMoveAlone) {
  std::mt19937_64 random(14);
  std::vector<Axis> axes;
  for (std::uint32_t i = 0; i < 8; ++i) {
    axes.emplace_back(any_drive(random, false, false, true), kPeriod, 9.5e-3);
    axes.back().start(0.0, {3, true, false}, {1, 1, i});
  }
  std::vector<Axis*> members;
  for (Axis& a : axes) members.push_back(&a);
  AxisGroup group(members, nullptr);
  EXPECT_EQ(group.packed(), 0U);
  group.step(std::vector<AxisInput>(8, {2.0, 0.0, 0.0}));
  EXPECT_GT(axes[7].velocity(), 0.0);
}

}  // namespace
}  // namespace stribeck::plant::axis_group_test
