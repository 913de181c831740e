#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/sim/study/machine_runs.hpp>
#include <stribeck/sim/study/robustness.hpp>
#include <stribeck/sim/study/variation.hpp>
#include <stribeck/sim/test_machine.hpp>

namespace stribeck::sim::machine_runs_test {
namespace {

MachineRuns two_controllers(const Machine& nominal) {
  return {nominal,
          test::printed(),
          {test::circle(9.5e-3, 0.3)},
          {0, 1},
          {biaxial_controllers()[5], biaxial_controllers()[0]},
          1};
}

TEST(MachineRuns, TogetherGiveTheBitsOfEachAlone) {
  const Machine nominal = test::biaxial_table();
  const MachineRuns runs = two_controllers(nominal);
  Variation rigid;
  rigid.axial_mode.reset();
  rigid.periodic = 0.0;
  rigid.warming = 0.0;
  std::vector<MachineTrial> machines;
  // Drives that move in packs, and drives that vary too much for them.
  for (std::uint32_t m = 0; m < 19; ++m)
    machines.push_back({vary(nominal, m % 4 == 3 ? Variation{} : rigid, 5, m), m});
  const std::vector<RunsOfMachine> together = runs.run_together(machines);
  ASSERT_EQ(together.size(), machines.size());
  for (const MachineTrial& m : machines) {
    const std::vector<RobustRun> alone = runs.run(m.machine, m.trial);
    const std::vector<RobustRun>& other = together[m.trial].runs;
    ASSERT_EQ(other.size(), alone.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
      for_each_number([&](auto get) {
        // Unknown figures are not equal to themselves.
        EXPECT_EQ(std::bit_cast<std::uint64_t>(get(alone[i].metrics)),
                  std::bit_cast<std::uint64_t>(get(other[i].metrics)))
            << "machine " << m.trial;
      });
      EXPECT_EQ(alone[i].limited, other[i].limited);
      EXPECT_EQ(alone[i].lost, other[i].lost);
    }
  }
  EXPECT_NE(together[0].runs[0].metrics.rms, together[1].runs[0].metrics.rms);
}

// compare() and a study with the same controllers differed.
TEST(MachineRuns, LateAxesHaveTheObserverThatCompareGivesThem) {
  Machine late = test::biaxial_table();
  late.axes[1].second.plant.delay_periods = 2;
  std::vector<AxisKnowledge> knowledge = test::printed();
  for (AxisKnowledge& k : knowledge) k.whole = k.gaussian;
  knowledge[1].whole->delay = 2.0 * late.sample_time;
  CompareSpec spec;
  spec.travels = {test::circle(3e-3, 0.3), test::circle(9.5e-3, 0.3)};
  spec.controllers = robust_controllers();
  spec.trials = 1;
  const CompareResult compared = compare(late, knowledge, spec);
  const MachineRuns runs(late, knowledge, spec.travels, {0, 1}, spec.controllers, spec.seed);
  std::size_t calmed = 0;
  for (const CompareRow& row : compared.rows) calmed += row.travel == 0 ? row.calmed.size() : 0;
  ASSERT_GT(calmed, 0U);
  ASSERT_EQ(runs.calmed().size(), calmed);
  for (const MachineRuns::Calmed& c : runs.calmed()) {
    EXPECT_EQ(compared.rows[c.controller].calmed, std::vector<std::size_t>{c.axis});
    EXPECT_EQ(c.axis, 1U);
  }
  // 1 %: the two take other numbers of sub-steps.
  const std::vector<RobustRun> nominal = runs.run(late, 0);
  ASSERT_EQ(nominal.size(), compared.rows.size());
  for (std::size_t i = 0; i < nominal.size(); ++i)
    EXPECT_NEAR(nominal[i].metrics.rms, compared.rows[i].mean.rms, 0.01 * compared.rows[i].mean.rms)
        << compared.rows[i].controller.id;
  EXPECT_TRUE(two_controllers(test::biaxial_table()).calmed().empty());
}

TEST(MachineRuns, AMachineThatIsRefusedDoesNotStopTheOthers) {
  const Machine nominal = test::biaxial_table();
  const MachineRuns runs = two_controllers(nominal);
  Machine stiff = nominal;
  stiff.axes[0].second.plant.friction.dynamics = friction::LuGre<double>{3e16, 600e3, 0.05e-3};
  const std::vector<MachineTrial> machines{{nominal, 0}, {stiff, 1}, {nominal, 2}};
  const std::vector<RunsOfMachine> results = runs.run_together(machines);
  EXPECT_TRUE(results[1].refused);
  EXPECT_TRUE(results[1].runs.empty());
  EXPECT_EQ(results[0].runs.size(), 2U);
  EXPECT_EQ(results[2].runs[0].metrics.rms, runs.run(nominal, 2)[0].metrics.rms);
  EXPECT_THROW((void)runs.run(stiff, 1), Refused);
}

}  // namespace
}  // namespace stribeck::sim::machine_runs_test
