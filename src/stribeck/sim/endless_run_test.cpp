#include <gtest/gtest.h>

#include <stribeck/sim/endless_run.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/sim/test_machine.hpp>

namespace stribeck::sim::endless_run_test {
namespace {

CompareSpec circle(double laps) {
  CompareSpec spec = find_experiment(experiments(), "bi-table")->settings.front().spec;
  spec.travels.resize(1);
  spec.travels.front().laps = laps;
  spec.controllers = {biaxial_controllers()[5]};
  spec.accuracy = 1e-7;
  return spec;
}

// Bit for bit, over more periods than are kept: until the run of compare brakes.
TEST(EndlessRun, IsTheRunOfCompare) {
  const Machine machine = test::biaxial_table();
  const CompareSpec spec = circle(3.0);
  const CompareResult whole = run_once(machine, test::printed(), spec, 0);
  const auto& trace = whole.rows.front().trace;
  const auto run = EndlessRun::make(machine, test::printed(), spec);
  std::size_t scored = 0;
  for (const ContourSample& expected : trace) {
    const ContourSample s = run->step();
    if (expected.scored) ++scored;
    if (scored > 0 && !expected.scored) break;
    ASSERT_EQ(s.time, expected.time);
    ASSERT_EQ(s.contour_error, expected.contour_error) << s.time;
    for (std::size_t i = 0; i < 2; ++i) {
      ASSERT_EQ(s.encoder[i], expected.encoder[i]) << s.time;
      ASSERT_EQ(s.force[i], expected.force[i]) << s.time;
    }
  }
  EXPECT_GT(scored, 3000U);  // more than a block of old points
}

TEST(EndlessRun, NeedsAClosedPath) {
  CompareSpec spec = circle(1.0);
  spec.travels.front().cutting.emplace();
  EXPECT_THROW(EndlessRun::make(test::biaxial_table(), test::printed(), spec), Refused);
}

}  // namespace
}  // namespace stribeck::sim::endless_run_test
