#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/run/comparison.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow::comparison_test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

std::vector<std::string> ids_of(const ComparisonOptions& options) {
  std::vector<std::string> ids;
  for (const sim::ControllerSpec& c :
       plan_comparison(options, read_virtual_machine(options.machine)).spec.controllers)
    ids.push_back(c.id);
  return ids;
}

// A controller that was added is wanted.
TEST(Comparison, OnlyChoosesAmongTheControllersOfTheExperiment) {
  ComparisonOptions o;
  o.machine = std::string(STRIBECK_SOURCE_DIR) + "/machines/biaxial-table.toml";
  o.only = {"f", "a"};
  EXPECT_THAT(ids_of(o), ElementsAre("a", "f"));
  o.controllers = {"cascade", "pid"};
  EXPECT_THAT(ids_of(o), ElementsAre("a", "f", "cascade", "pid"));
  o.only = {"pid"};
  EXPECT_THAT(ids_of(o), ElementsAre("cascade", "pid"));
  o.only = {"q"};
  EXPECT_THAT([&] { ids_of(o); },
              ThrowsMessage<io::InputError>(HasSubstr("got \"q\", expected one of a, b")));
}

// They stood on the page alone.
TEST(Comparison, HasTheWarningsOfTheIdentification) {
  ComparisonOptions o;
  o.machine = std::string(STRIBECK_SOURCE_DIR) + "/machines/uniaxial-drive.toml";
  o.only = {"a"};
  o.trials = 1;
  ComparisonPlan plan = plan_comparison(o, read_virtual_machine(o.machine));
  o.parameters.source = "thesis";
  Parameters parameters = get_parameters(plan.machine, o.machine, o.parameters, plan.spec);
  EXPECT_THAT(run_plan(plan, parameters, {}).warnings, Not(Contains(HasSubstr("seen once"))));
  CommissionedAxis axis;
  for (const char* kind : {"conventional", "gaussian"}) {
    CommissionedModel model;
    model.kind = model.result.model = kind;
    model.result.warnings = {"one speed was seen once"};
    axis.models.push_back(model);
  }
  parameters.axes = {axis};
  const std::string name = plan.machine.axes[0].first;
  const std::string words =
      "one speed was seen once (axis " + name + ", conventional model; axis " + name + ", gaussian model)";
  const Comparison with = run_plan(plan, parameters, {});
  EXPECT_THAT(with.warnings, Contains(words));
  EXPECT_THAT(to_json(with)["warnings"].get<std::vector<std::string>>(), Contains(words));
}

TEST(Comparison, SaysWhereCompensationDoesHarm) {
  sim::CompareResult result;
  result.spec.travels.resize(2);
  result.spec.travels[0].speed = 5e-3;
  result.spec.travels[1].speed = 50e-3;
  const auto add = [&](const char* id, std::size_t travel, sim::FrictionUse friction, double error) {
    sim::CompareRow row;
    row.controller.id = id;
    row.controller.friction = friction;
    row.travel = travel;
    row.mean.max_contour_error = error;
    result.rows.push_back(row);
  };
  using enum sim::FrictionUse;
  add("a", 0, kNone, 14.7e-6);
  add("b", 0, kConventional, 24.5e-6);
  add("i", 0, kWhole, 48.6e-6);
  add("a", 1, kNone, 40e-6);
  add("b", 1, kConventional, 41e-6);
  add("i", 1, kWhole, 3e-6);
  EXPECT_THAT(
      harmful_speeds(result),
      ElementsAre(AllOf(HasSubstr("at 5 mm/s every compensation does harm: (a) leaves 14.7 um without any"),
                        HasSubstr("(b), the best of the others, 24.5 um"))));
  result.rows[1].mean.max_contour_error = 14e-6;
  EXPECT_THAT(
      harmful_speeds(result),
      ElementsAre(
          "at 5 mm/s some compensation does harm: (i) 48.6 um, where (a) leaves 14.7 um without any"));
  result.rows[2].mean.max_contour_error = 15e-6;
  EXPECT_THAT(harmful_speeds(result), testing::IsEmpty());
}

}  // namespace
}  // namespace stribeck::workflow::comparison_test
