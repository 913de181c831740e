#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/sim/study/variation.hpp>
#include <stribeck/sim/test_machine.hpp>

namespace stribeck::sim::machine_test {
namespace {

control::Setup<2> setup_of(const Machine& machine) {
  return make_setup<2>(machine, test::printed(), {0, 1}, biaxial_controllers().back());
}

TEST(Machine, ControllersKnowWhatThePlatesOfDriveAndEncoderSay) {
  const Machine m = test::biaxial_table();
  const auto setup = setup_of(m);
  // 1048 N/V at 10 V, and the encoder's step: nothing else is said.
  EXPECT_DOUBLE_EQ(setup.force_limit[0], 10480.0);
  EXPECT_EQ(setup.compensation[0].encoder_resolution, 25e-9);
}

TEST(Machine, ControllersGetEverySettingOfTheirAdaptation) {
  ControllerSpec c = biaxial_controllers().back();
  c.feedforward = control::Feedforward::kDynamic;
  c.adaptation.enabled = true;
  c.adaptation.memory = 5.0;
  const auto setup = make_setup<2>(test::biaxial_table(), test::printed(), {0, 1}, c);
  EXPECT_TRUE(setup.compensation[1].adaptation.enabled);
  EXPECT_EQ(setup.compensation[1].adaptation.memory, 5.0);
}

// A model without bristles: what adapts goes by distance after a reversal. What was asked for by name stays.
TEST(Machine, ADefaultWithoutBristlesGoesByDistance) {
  using enum control::Feedforward;
  ControllerSpec c = biaxial_controllers().back();
  c.feedforward = kDynamic;
  c.adaptation.enabled = true;
  std::vector<AxisKnowledge> knowledge = test::printed();
  knowledge[0].gaussian->friction.dynamics = friction::Static{};
  knowledge[1].gaussian->friction.dynamics = friction::LuGre<double>{3e8, 600e3, 0.05e-3};
  const auto setup = make_setup<2>(test::biaxial_table(), knowledge, {0, 1}, c);
  EXPECT_EQ(setup.compensation[0].feedforward, kReversal);
  EXPECT_EQ(setup.compensation[1].feedforward, kDynamic);
  c.adaptation.enabled = false;
  EXPECT_EQ(make_setup<2>(test::biaxial_table(), knowledge, {0, 1}, c).compensation[0].feedforward, kDynamic);
}

TEST(Machine, ControllersBelieveLimitsAndCommissioningMoreThanTheTruth) {
  Machine m = test::biaxial_table();
  MachineAxis& x = m.axes[0].second;
  x.limits.force = 4000.0;
  x.commissioning.encoder_resolution = 1e-6;
  const auto setup = setup_of(m);
  EXPECT_EQ(setup.force_limit[0], 4000.0);
  EXPECT_EQ(setup.compensation[0].encoder_resolution, 1e-6);
  EXPECT_DOUBLE_EQ(setup.force_limit[1], 10480.0);
  // A truth that changes is not seen.
  x.plant.encoder.resolution = 1e-3;
  x.plant.drive = plant::CurrentDrive{2000.0, {}};
  const auto later = setup_of(m);
  EXPECT_EQ(later.force_limit[0], 4000.0);
  EXPECT_EQ(later.compensation[0].encoder_resolution, 1e-6);
}

TEST(Machine, OtherMachinesOfTheKindCarryTheSamePlates) {
  const Machine nominal = test::biaxial_table();
  const Machine other = vary(nominal, vary_only("encoder"), 3, 1);
  EXPECT_GT(other.axes[0].second.plant.encoder.resolution, 25e-9);
  EXPECT_EQ(setup_of(other).compensation[0].encoder_resolution, 25e-9);
}

TEST(Machine, NoPlateSaysMoreThanTheDriveCan) {
  MachineAxis x = test::biaxial_table().axes[0].second;
  x.limits.force = 20e3;
  std::string said;
  x.validate([&](std::string_view key, std::string_view what) {
    said += std::string(key) + ": " + std::string(what);
  });
  EXPECT_THAT(said, testing::HasSubstr("limits.force: above what plant.drive makes"));
}

}  // namespace
}  // namespace stribeck::sim::machine_test
