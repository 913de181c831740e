#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/friction/unbalance.hpp>
#include <stribeck/sim/experiments_beyond.hpp>
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

/// The table with a delay of its second axis, in periods, which the model tells.
struct Late {
  explicit Late(int periods) : machine(test::biaxial_table()), knowledge(2) {
    for (std::size_t i = 0; i < 2; ++i) {
      const plant::AxisParams& truth = machine.axes[i].second.plant;
      knowledge[i].whole = friction::AxisModel{truth.mass, truth.load, truth.friction};
    }
    machine.axes[1].second.plant.delay_periods = periods;
    knowledge[1].whole->delay = periods * machine.sample_time;
  }
  [[nodiscard]] control::Setup<2> setup(const ControllerSpec& c) const {
    return make_setup<2>(machine, knowledge, {0, 1}, c);
  }
  Machine machine;
  std::vector<AxisKnowledge> knowledge;
};

/// (g), (h) and (i) of the table.
std::vector<ControllerSpec> observing() {
  std::vector<ControllerSpec> all = beyond_controllers(biaxial_controllers().back());
  all.resize(3);
  return all;
}

TEST(Machine, ALateAxisOfTheDefaultHasNoKalmanObserver) {
  using enum control::Observer;
  const std::vector<ControllerSpec> c = observing();
  Late late(2);
  auto setup = late.setup(c[1]);
  EXPECT_THAT(calm<2>(setup, c[1]), testing::ElementsAre(1));
  EXPECT_EQ(setup.compensation[0].observer, kKalman);
  EXPECT_EQ(setup.compensation[1].observer, kDisturbance);
  // A third of the bandwidth of 60 rad/s, as after an oscillation.
  EXPECT_DOUBLE_EQ(setup.compensation[1].observer_pole, 20.0);
  // The loop bears 0.93 periods (docs/theory/feedforward.md): a third of a period leaves more than a quarter of one.
  late.knowledge[1].whole->delay = late.machine.sample_time / 3.0;
  setup = late.setup(c[1]);
  EXPECT_TRUE(calm<2>(setup, c[1]).empty());
  EXPECT_EQ(setup.compensation[1].observer, kKalman);
  // (i) does what it is told.
  late.knowledge[1].whole->delay = 2.0 * late.machine.sample_time;
  setup = late.setup(c[2]);
  EXPECT_TRUE(calm<2>(setup, c[2]).empty());
}

TEST(Machine, TheDefaultWithAKnownDelayIsNotWorseThanOneWithoutAdaptation) {
  const Late late(2);
  CompareSpec spec;
  spec.travels = {test::circle(3e-3), test::circle(9.5e-3)};
  spec.controllers = observing();
  spec.trials = 1;
  const CompareResult r = compare(late.machine, late.knowledge, spec);
  for (std::size_t travel = 0; travel < 2; ++travel) {
    const CompareRow* row = &r.rows[3 * travel];
    EXPECT_THAT(row[1].calmed, testing::ElementsAre(1));
    // 10 %: what is asked of the default against the best of the others. With its Kalman observer it oscillates first.
    EXPECT_LT(row[1].mean.max_contour_error, 1.1 * row[0].mean.max_contour_error) << travel;
    EXPECT_EQ(row[1].status.count(Status::kOscillation), 0U) << travel;
  }
}

TEST(Machine, ControllersUseLimitsAndCommissioningDataNotThePlant) {
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

// The weight of an arm is no friction that a controller without periodic terms does not know.
TEST(Machine, AControllerWithoutPeriodicTermsKnowsTheUnbalance) {
  friction::AxisModel m;
  m.mass = 100.0;
  m.friction.steady = friction::Conventional<double>{20.0, 100.0, {}};
  m.friction.eccentric.push_back({5.0, 0.01, 0.0, friction::EccentricForm::kAdditive});
  m.friction.eccentric.push_back(friction::Unbalance{40.0, 0.3}.term());
  AxisKnowledge known;
  known.conventional = known.eccentric = m;
  for (const FrictionUse use : {FrictionUse::kViscous, FrictionUse::kNominal}) {
    const auto terms = known.model(use, "c").friction.eccentric;
    ASSERT_EQ(terms.size(), 1U);
    EXPECT_EQ(terms[0].amplitude, 40.0);
  }
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
