/// What the controllers beyond the thesis must reach, on seeds that were not used for tuning.

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <stribeck/sim/study/robustness.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/commission.hpp>
#include <vector>

#include "../cli/command.hpp"

namespace stribeck::test::quadrant_test {
namespace {

using Rows = std::map<std::pair<double, std::string>, nlohmann::json>;

/// Rows by speed (0 where the path has none) and controller.
Rows rows_of(const std::string& machine, const std::string& experiment, const std::string& trials) {
  Folder f;
  const Said said =
      command({"compare", std::string(STRIBECK_SOURCE_DIR) + "/machines/" + machine + ".toml", "--experiment",
               experiment, "--seed", "1000", "--trials", trials, "--json", f / "o.json", "--quiet"});
  EXPECT_EQ(said.code, 0) << said.err;
  Rows rows;
  const auto json = nlohmann::json::parse(text_of(f / "o.json"));
  for (const auto& row : json["rows"]) {
    const auto& speed = row["speed_mm_per_s"];
    rows[{speed.is_null() ? 0.0 : speed.get<double>(), row["controller"].get<std::string>()}] = row;
  }
  return rows;
}

double get(const Rows& rows, double speed, const std::string& controller, const char* key) {
  return rows.at({speed, controller})[key].get<double>();
}

TEST(Quadrant, OnTheCircleOfTheBiaxialTableIsNoLongerToBeSeen) {
  const Rows rows = rows_of("biaxial-table", "bi-table", "10");
  for (const double speed : {3.0, 9.5}) {
    for (const char* c : {"g", "h", "i"}) {
      const auto of = [&](const char* key) { return get(rows, speed, c, key); };
      const auto of_f = [&](const char* key) { return get(rows, speed, "f", key); };
      EXPECT_LE(of("max_contour_error_um"), 0.7) << c << speed;
      EXPECT_GE(of("max_contour_error_um"), 0.1) << c << speed;  // noise alone
      EXPECT_LE(of("rms_um"), 0.2) << c << speed;
      EXPECT_LE(of("quadrant_ratio"), 1.3) << c << speed;
      EXPECT_GE(of("quadrant_ratio"), 0.7) << c << speed;
      EXPECT_LE(of("input_variation_V"), of_f("input_variation_V")) << c << speed;
      // Friction takes what it takes: to a thousandth, the work is the path's.
      EXPECT_LE(of("mechanical_power_W"), 1.001 * of_f("mechanical_power_W")) << c << speed;
      EXPECT_GT(of("mechanical_power_W"), 0.1) << c << speed;
      EXPECT_LE(7.0 * of("max_contour_error_um"), of_f("max_contour_error_um")) << c << speed;
      EXPECT_GE(of_f("quadrant_ratio"), 5.0);
    }
  }
}

TEST(Quadrant, NorOnEightAndTrifolium) {
  for (const char* experiment : {"bi-eight", "bi-trifolium"}) {
    const Rows rows = rows_of("biaxial-table", experiment, "10");
    for (const double speed : {3.0, 9.5}) {
      for (const char* c : {"g", "h", "i"})
        EXPECT_LE(get(rows, speed, c, "max_contour_error_um"), 0.8) << experiment << c << speed;
    }
  }
}

TEST(Quadrant, OnTheTriaxialToolTheMeanFallsBelowTheThesis) {
  for (const auto& [machine, share] :
       {std::pair{"triaxial-tool", 0.4}, std::pair{"triaxial-tool-5ms", 0.5}}) {
    for (const char* experiment : {"tri-circle", "tri-free", "smc-circle", "smc-free"}) {
      const Rows rows = rows_of(machine, experiment, "4");
      double thesis = 1e9;
      for (const char* c : {"a", "b", "c"}) {
        if (rows.count({0.0, c}) != 0) thesis = std::min(thesis, get(rows, 0.0, c, "mean_abs_um"));
      }
      EXPECT_LE(get(rows, 0.0, "i", "mean_abs_um"), share * thesis) << machine << experiment;
      EXPECT_GE(get(rows, 0.0, "i", "mean_abs_um"), 0.01);
    }
  }
}

TEST(Quadrant, WhatAdaptationFoundIsSaid) {
  const Rows rows = rows_of("biaxial-table", "bi-table", "1");
  const auto& drift = rows.at({9.5, "h"})["drift"];
  for (const char* axis : {"x", "y"}) {
    EXPECT_LT(std::abs(drift[axis]["level_percent"].get<double>()), 6.0);
    EXPECT_EQ(drift[axis]["verdict"], "as commissioned");
  }
  EXPECT_FALSE(rows.at({9.5, "g"}).contains("drift"));
}

TEST(Quadrant, AModelHalfAgainTooHighIsTakenDownShownAndDrivesNoLimitCycle) {
  const sim::Machine machine = workflow::built_in_machine("biaxial-table");
  const sim::RobustnessSpec drawn = sim::robust_biaxial();
  sim::CompareSpec spec;
  spec.travels = drawn.travels;
  spec.trials = 3;
  spec.seed = 1000;
  for (const sim::ControllerSpec& c : drawn.controllers) {
    if (c.id == "g" || c.id == "h") spec.controllers.push_back(c);
  }
  std::vector<sim::AxisKnowledge> knowledge;
  for (std::size_t i = 0; i < machine.axes.size(); ++i)
    knowledge.push_back(
        workflow::commission_axis(machine, i, workflow::Needs::of(spec.controllers), 1000).knowledge);
  for (sim::AxisKnowledge& k : knowledge) {
    auto& map = std::get<friction::Gaussian<double>>(k.whole->friction.steady);
    for (auto* branch : {&map.positive, &map.negative}) {
      branch->eta0 *= 1.5;
      branch->eta1 *= 1.5;
      for (auto& term : branch->gaussians) term.a *= 1.5;
    }
  }
  const sim::CompareResult result = sim::compare(machine, knowledge, spec);
  for (std::size_t i = 0; i + 1 < result.rows.size(); i += 2) {
    const sim::CompareRow& fixed = result.rows[i];
    const sim::CompareRow& adapting = result.rows[i + 1];
    // Nothing oscillates, the input stays as calm as with the fixed model, and the third lap is as if nothing had been wrong.
    EXPECT_EQ(adapting.status.count(Status::kOscillation), 0U);
    EXPECT_LE(adapting.mean.input_variation, 1.1 * fixed.mean.input_variation);
    EXPECT_GE(fixed.mean.max_contour_error, 3e-6);
    EXPECT_LE(adapting.mean.max_contour_error, 0.8e-6);
    ASSERT_EQ(adapting.drift.size(), 2U);
    for (const control::Drift& d : adapting.drift) {
      EXPECT_NEAR(d.level, -1.0 / 3.0, 0.04);
      EXPECT_EQ(d.verdict, control::DriftVerdict::kMuchLess);
    }
  }
}

TEST(Robustness, TheDefaultStaysFarBelowTheThesisOnMachinesThatAreNotTheOneIdentified) {
  const sim::Machine machine = workflow::built_in_machine("biaxial-table");
  sim::RobustnessSpec spec = sim::robust_biaxial();
  std::erase_if(spec.controllers, [](const sim::ControllerSpec& c) { return c.id != "f" && c.id != "h"; });
  ASSERT_EQ(spec.controllers.size(), 2U);
  spec.machines = 60;
  spec.seed = 1000;
  std::vector<sim::AxisKnowledge> knowledge;
  for (std::size_t i = 0; i < machine.axes.size(); ++i)
    knowledge.push_back(
        workflow::commission_axis(machine, i, workflow::Needs::of(spec.controllers), spec.seed).knowledge);
  const sim::RobustnessResult result = sim::robustness(machine, knowledge, spec);
  for (std::size_t i = 0; i + 1 < result.rows.size(); i += 2) {
    const auto f = sim::quantiles(sim::figures(result.rows[i], &sim::Metrics::max_contour_error));
    const auto h = sim::quantiles(sim::figures(result.rows[i + 1], &sim::Metrics::max_contour_error));
    EXPECT_EQ(sim::lost(result.rows[i + 1]), 0U);
    EXPECT_LE(h.median, 0.4 * f.median);
    EXPECT_GE(h.median, 0.02 * f.median);
    EXPECT_LE(h.p99, 0.7 * f.p99);
  }
}

}  // namespace
}  // namespace stribeck::test::quadrant_test
