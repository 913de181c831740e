#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/plan/excitation_plan.hpp>
#include <stribeck/workflow/run/axis_excitation.hpp>
#include <string>
#include <vector>

namespace stribeck::test::excitation_plan_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using workflow::Wanted;

/// A light belt axis: nothing but what its data sheet says.
constexpr const char* kBelt = R"(
name = "belt"
sample_time = "5 ms"
[axes.x.limits]
travel_min = "0 mm"
travel_max = "400 mm"
speed = "0.5 m/s"
acceleration = "3 m/s2"
force = "150 N"
[axes.x.commissioning]
mass = "6 kg"
friction = "20 N"
encoder_resolution = "1 um"
)";

class ExcitationPlanTest : public ::testing::Test {
 protected:
  std::string file_ = folder().write("belt.toml", kBelt);

  static const Folder& folder() {
    static const Folder one;
    return one;
  }
  /// Everything is wanted and there is time.
  static const workflow::ExcitationPlan& whole() {
    static const workflow::ExcitationPlan plan = workflow::plan_excitation(
        {folder().write("belt.toml", kBelt), "x", {Wanted::kMass, Wanted::kFriction}, 60.0, ""});
    return plan;
  }
};

TEST_F(ExcitationPlanTest, ChoosesWhatTellsEverythingThatIsWanted) {
  const workflow::ExcitationPlan& plan = whole();
  ASSERT_THAT(plan.chosen, Not(IsEmpty()));
  EXPECT_TRUE(plan.together.good(Wanted::kMass)) << plan.together[Wanted::kMass];
  EXPECT_TRUE(plan.together.good(Wanted::kFriction)) << plan.together[Wanted::kFriction];
  EXPECT_LE(plan.duration(), 60.0);
  EXPECT_THAT(workflow::text_of(plan), HasSubstr("Record: "));
  EXPECT_EQ(workflow::to_json(plan)["chosen"].size(), plan.chosen.size());
  // No other single log that tells as much is shorter.
  if (plan.chosen.size() == 1) {
    for (const workflow::CandidateLog& c : plan.candidates) {
      if (!c.refused.empty() || !c.expected.good(Wanted::kMass) || !c.expected.good(Wanted::kFriction))
        continue;
      EXPECT_GE(c.duration, plan.duration()) << enum_name(c.method);
    }
  }
}

TEST_F(ExcitationPlanTest, SaysWhatStaysOpen) {
  double shortest = 1e9;
  for (const workflow::CandidateLog& c : whole().candidates) {
    if (c.refused.empty()) shortest = std::min(shortest, c.duration);
  }
  std::vector<std::size_t> steps;
  const workflow::ExcitationPlan brief = workflow::plan_excitation({file_, "x", {}, 1.01 * shortest, ""},
                                                                   [&](std::size_t done, std::size_t all) {
                                                                     EXPECT_LE(done, all);
                                                                     steps.push_back(done);
                                                                   });
  EXPECT_THAT(steps, testing::ElementsAre(1, 2, 3, 4, 5));  // each method alone; there is no time for two
  EXPECT_EQ(brief.chosen.size(), 1u);
  EXPECT_LE(brief.duration(), 1.01 * shortest);
  const std::string text = workflow::text_of(brief);
  EXPECT_THAT(text, HasSubstr("s of motion, more than there is time for"));
  EXPECT_THAT(text, HasSubstr("s: bristles.\n"));
  try {
    workflow::plan_excitation({file_, "x", {}, 0.5 * shortest, ""});
    ADD_FAILURE() << "there is no time for any";
  } catch (const ident::Refused& why) {
    EXPECT_THAT(why.what(), HasSubstr("axis x: no excitation fits: "));
  }
}

TEST_F(ExcitationPlanTest, ExpectsWhatAnotherAxisThenTells) {
  // The prediction knows the rough values alone. The axis that is then measured has 20 % more mass, 25 % less friction, the same in both directions
  // but for a tenth, and a screw of 4 %.
  workflow::MachineDescription other = workflow::read_description(file_);
  auto& axis = other.axes[0].second;
  friction::Gaussian<double> map;
  map.positive.eta0 = 15.8;
  map.positive.eta1 = 9.0;
  map.positive.gaussians.push_back({4.0, 0.0, 0.008});
  map.negative.eta0 = -14.2;
  map.negative.eta1 = 7.0;
  map.negative.gaussians.push_back({-2.0, 0.0, 0.012});
  map.velocity_range = {-0.5, 0.5};
  sim::AxisFile truth;
  truth.model.mass = 7.2;
  truth.model.friction.steady = map;
  truth.model.friction.eccentric.push_back({0.6, 0.02, 1.0});
  axis.plant = workflow::model_as_truth(axis, "x", other.sample_time, file_, file_, truth);
  axis.plant->noise = plant::ForceNoise{0.3, 0.02};
  const workflow::CandidateLog& best = whole().candidates[whole().chosen.front()];
  workflow::ExcitationOptions what;
  what.method = best.method;
  const ident::excitation::Excitation e = workflow::excite_axis(what, file_, "x").excitation;
  workflow::AxisRecords records;
  records.records.push_back(
      workflow::as_record(workflow::play(workflow::as_machine(other), 0, e.r, e.force, 7), "log"));
  records.runs = 1;
  const ident::Result r = workflow::identify(records, {}).result;
  EXPECT_NEAR(r.mass, 7.2, 0.02 * 7.2);
  const double half = 0.5 * (r.mass_interval.high - r.mass_interval.low) / r.mass;
  // Within a factor of four: its noise and its friction are others.
  EXPECT_LT(half, 4.0 * best.expected[Wanted::kMass]);
  EXPECT_GT(half, best.expected[Wanted::kMass] / 4.0);
}

}  // namespace
}  // namespace stribeck::test::excitation_plan_test
