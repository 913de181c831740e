#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <stribeck/workflow/reproduce/robustness.hpp>

namespace stribeck::test::robustness_test {
namespace {

sim::RobustRun run_of(double maximum, bool lost = false) {
  sim::RobustRun r;
  r.metrics.max_contour_error = maximum;
  r.metrics.input_variation = 0.05;
  r.lost = lost;
  return r;
}

/// A reference at 5 µm on every machine, and a controller at 1, 2 and 3 µm that loses the fourth machine.
sim::RobustnessResult invented() {
  sim::RobustnessResult result;
  result.machine = "biaxial table";
  result.spec = sim::robust_biaxial();
  result.spec.travels.resize(1);
  result.spec.machines = 4;
  sim::ControllerSpec reference;
  reference.id = "f";
  sim::ControllerSpec other;
  other.id = "g";
  result.spec.controllers = {reference, other};
  result.rows.resize(2);
  result.rows[0].controller = reference;
  result.rows[1].controller = other;
  for (auto& row : result.rows) row.nominal = run_of(4e-6);
  for (int i = 0; i < 4; ++i) {
    result.rows[0].runs.push_back(run_of(5e-6));
    result.rows[1].runs.push_back(run_of((i + 1) * 1e-6, i == 3));
  }
  return result;
}

TEST(RobustnessSection, ShowsQuantilesChangesAndWhatIsLost) {
  const report::ReproducedSection s = workflow::robustness_section(invented());
  EXPECT_EQ(s.id, "robustness");
  ASSERT_EQ(s.table.rows.size(), 2U);
  const auto& row = s.table.rows[1];
  EXPECT_EQ(row[3].text, "2.50");  // median of 1, 2, 3, lost
  EXPECT_EQ(row[6].text, "lost");
  EXPECT_EQ(row[7].text, "50");  // median of 20, 40, 60 %, lost
  EXPECT_EQ(row.back().text, "1");
  EXPECT_EQ(s.table.rows[0].back().text, "0");
  // Of the reference two figures, of the other one two more, against it.
  ASSERT_EQ(s.figures.size(), 6U);
  EXPECT_EQ(s.figures[4].against, "(f)");
  EXPECT_NEAR(s.figures[4].ours, -50.0, 1e-9);
  // Three machines of four below 3 µm, and no step for the lost one.
  const report::Series& drawn = s.plots.front().first.front().series[1];
  ASSERT_EQ(drawn.x.size(), 3U);
  EXPECT_NEAR(drawn.y.back(), 75.0, 1e-9);
  EXPECT_NE(s.remarks.front().find("friction level and viscous part ± 30 %"), std::string::npos);
}

TEST(RobustnessSection, NamesWhatIsVariedAndNothingElse) {
  sim::RobustnessResult result = invented();
  result.spec.variation = sim::Variation::none();
  EXPECT_NE(workflow::robustness_section(result).remarks.front().find("all factors together: nothing."),
            std::string::npos);
  result.spec.variation.mass = 0.1;
  EXPECT_NE(workflow::robustness_section(result).remarks.front().find("all factors together: mass ± 10 %."),
            std::string::npos);
}

TEST(RobustnessSection, NeedsWhatItsControllersNeed) {
  sim::RobustnessSpec spec = sim::robust_biaxial();
  spec.controllers.resize(1);
  spec.controllers.push_back(sim::biaxial_controllers().front());
  const sim::Experiment e = workflow::robustness_experiment(spec);
  ASSERT_EQ(e.settings.size(), 1U);
  ASSERT_EQ(e.settings[0].spec.controllers.size(), 2U);
  EXPECT_EQ(e.settings[0].spec.controllers[1].id, "a");
}

}  // namespace
}  // namespace stribeck::test::robustness_test
