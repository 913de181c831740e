#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/file.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <string>

namespace stribeck::workflow::parameters_test {
namespace {

TEST(Parameters, AnAxisWithoutItsKalmanObserverIsSaidOnce) {
  sim::CompareResult result;
  result.period = 4e-3;
  result.axes = {"y"};
  for (const std::size_t travel : {0, 1}) {
    sim::CompareRow row;
    row.controller.id = "h";
    row.controller.friction = sim::FrictionUse::kWhole;
    row.travel = travel;
    row.calmed = {0};
    result.rows.push_back(row);
  }
  Parameters parameters;
  parameters.knowledge.resize(1);
  parameters.knowledge[0].whole.emplace().delay = 8e-3;
  const auto said = check_coverage(result, {0}, parameters);
  ASSERT_THAT(said, testing::SizeIs(1));
  EXPECT_THAT(said[0], testing::HasSubstr("axis y: with a delay of 2 control periods"));
  EXPECT_THAT(said[0], testing::HasSubstr("so (h) has a disturbance observer there"));
  result.rows.clear();
  EXPECT_THAT(check_coverage(result, {0}, parameters), testing::IsEmpty());
}

// The tip of a tool errs by a length also where axes turn.
TEST(Parameters, SayWhatAMicrometreOfAnAxisThatTurnsIs) {
  const std::string machine_file = std::string(STRIBECK_SOURCE_DIR) + "/machines/biaxial-table.toml";
  sim::Machine machine = read_virtual_machine(machine_file);
  machine.axes[1].second.rotary = true;
  sim::CompareSpec spec;
  ParameterOptions options;
  options.source = "thesis";
  const auto said = [&](std::vector<std::size_t> axes) {
    spec.axes = std::move(axes);
    std::string all;
    for (const std::string& one : get_parameters(machine, machine_file, options, spec).assumed) all += one;
    return all;
  };
  EXPECT_THAT(said({1}), testing::HasSubstr("so um stands for urad and mm/s for mrad/s"));
  EXPECT_THAT(said({0, 1}), testing::HasSubstr("in a contour error a urad of this axis counts as a um"));
  spec.travels.resize(1);
  spec.travels[0].path = path::ConeFrustum{};
  EXPECT_THAT(said({0, 1}), testing::AllOf(testing::HasSubstr("lengths at the tip of the tool"),
                                           testing::Not(testing::HasSubstr("urad"))));
}

// A file that changes nothing is said to, or its axis would seem to have been judged.
TEST(Parameters, AFileOfAnAxisThatRestsHasNoEffect) {
  const test::Folder folder;
  const std::string machine_file = std::string(STRIBECK_SOURCE_DIR) + "/machines/biaxial-table.toml";
  const std::string model = folder.write("m.toml", R"(mass = "60000 kg"
load = "0 N"
[friction]
eccentric = []
places = []
[friction.steady]
kind = "conventional"
alpha0 = "1000 N"
alpha2 = "100 N s/mm"
[friction.dynamics]
kind = "static"
)");
  const sim::Machine machine = read_virtual_machine(machine_file);
  sim::CompareSpec spec;
  spec.axes = {0};
  ParameterOptions options;
  options.source = "thesis";
  const auto said = [&](const std::string& axis) {
    options.axis_files = {axis + "=" + model};
    return get_parameters(machine, machine_file, options, spec).assumed;
  };
  EXPECT_THAT(said("y"), testing::ElementsAre(
                             testing::HasSubstr("m.toml has no effect: the path does not move axis y")));
  EXPECT_THAT(said("x"), testing::IsEmpty());
}

// The file of an axis that rests, and of a drive with a loop of its own, was blamed for the delay that it does not say.
TEST(Parameters, ADelayWithoutEffectIsNotMissed) {
  const std::string machine_file = std::string(STRIBECK_SOURCE_DIR) + "/machines/biaxial-table.toml";
  sim::Machine machine = read_virtual_machine(machine_file);
  sim::CompareSpec spec;
  spec.axes = {0};
  Parameters p;
  p.files = {"x.toml", "y.toml"};
  p.knowledge.resize(2);
  for (sim::AxisKnowledge& known : p.knowledge) known.whole.emplace().mass = 60.0;
  EXPECT_THAT(unknown_delays(machine, spec, p),
              testing::ElementsAre(testing::HasSubstr("x.toml does not say the delay of the drive")));
  EXPECT_THAT(uncounted_delays(machine, spec), testing::IsEmpty());
  machine.axes[0].second.drive_loop.emplace();
  EXPECT_THAT(unknown_delays(machine, spec, p), testing::IsEmpty());
}

// The same margins came out with 0, 4 and 8 periods on the way to a velocity drive; with 8 its gains oscillate.
TEST(Parameters, TheWayOfACommandToALoopOfTheDriveIsSaidNotToCount) {
  const std::string machine_file = std::string(STRIBECK_SOURCE_DIR) + "/machines/biaxial-table.toml";
  sim::Machine machine = read_virtual_machine(machine_file);
  sim::CompareSpec spec;
  spec.axes = {0};
  machine.axes[0].second.drive_loop.emplace();
  EXPECT_THAT(uncounted_delays(machine, spec),
              testing::ElementsAre(testing::HasSubstr("often take 2 to 4 control periods")));
  machine.axes[0].second.plant.delay_periods = 4;
  EXPECT_THAT(uncounted_delays(machine, spec),
              testing::ElementsAre(
                  testing::AllOf(testing::StartsWith("axis x: "), testing::HasSubstr("4 periods here"))));
}

// The axis is simulated as this model: an identification from simulated logs would find it again, after half a minute.
TEST(Parameters, TheModelThatIsSimulatedIsNotIdentifiedAgain) {
  const test::Folder folder;
  const std::string machine_file = std::string(STRIBECK_SOURCE_DIR) + "/examples/own-machine/gantry.toml";
  const std::string model = folder.write("x.toml", R"(axis = "x"
mass = "42 kg"
load = "0 N"
delay = "0 ms"
[friction]
eccentric = []
places = []
[friction.steady]
kind = "gaussian"
velocity_range = ["-100 mm/s", "100 mm/s"]
[friction.steady.positive]
eta0 = "40 N"
eta1 = "0.1 N s/mm"
gaussians = [{a = "5 N", b = "3 mm/s", c = "2 mm/s"}]
[friction.steady.negative]
eta0 = "-50 N"
eta1 = "0.1 N s/mm"
gaussians = []
[friction.dynamics]
kind = "static"
)");
  ParameterOptions options;
  options.axis_files = {"x=" + model};
  const sim::Machine machine =
      read_virtual_machine(machine_file, options.axis_files, AxisWithoutTruth::kLeftOut);
  const sim::CompareSpec spec = experiment_spec(kOwn, {}, {}, machine, machine_file);
  const Parameters p = get_parameters(machine, machine_file, options, spec);
  EXPECT_TRUE(p.axes.at(0).logs.empty());
  for (const auto* known : {&p.knowledge[0].conventional, &p.knowledge[0].gaussian, &p.knowledge[0].whole}) {
    ASSERT_TRUE(known->has_value());
    EXPECT_DOUBLE_EQ((*known)->mass, 42.0);
    const auto slow = (*known)->friction.parts(50e-3, 0.0);
    EXPECT_NEAR(slow.level + slow.viscous, 45.0, 0.2);  // 40 N + 0.1 N s/mm · 50 mm/s
  }
  // The straight line through each side has no hill at 3 mm/s.
  EXPECT_NEAR(p.knowledge[0].gaussian->friction.parts(3e-3, 0.0).level, 45.0, 0.1);
  EXPECT_NEAR(p.knowledge[0].conventional->friction.parts(3e-3, 0.0).level, 40.0, 0.3);
  EXPECT_THAT(p.assumed, testing::Contains(testing::HasSubstr("axis y does not move here")));
  EXPECT_THAT(unknown_delays(machine, spec, p), testing::IsEmpty());
  EXPECT_THAT(p.assumed, testing::Not(testing::Contains(testing::HasSubstr("says that it is of axis"))));
  std::string without = io::read_text(model);
  without.erase(without.find("delay"), std::string("delay = \"0 ms\"\n").size());
  options.axis_files = {"x=" + folder.write("no-delay.toml", without.c_str())};
  EXPECT_THAT(
      unknown_delays(machine, spec, get_parameters(machine, machine_file, options, spec)),
      testing::ElementsAre(testing::AllOf(testing::StartsWith("axis x: "),
                                          testing::HasSubstr("does not say the delay of the drive"))));
  std::string other = io::read_text(model);
  other.replace(other.find("\"x\""), 3, "\"z\"");
  options.axis_files = {"x=" + folder.write("z.toml", other.c_str())};
  const sim::Machine swapped =
      read_virtual_machine(machine_file, options.axis_files, AxisWithoutTruth::kLeftOut);
  EXPECT_THAT(get_parameters(swapped, machine_file, options, spec).assumed,
              testing::Contains(testing::HasSubstr("says that it is of axis z, and is used for axis x")));
}

// The model stands for the machine: without a word, its errors at speeds that no log has would look like promises.
TEST(Parameters, AFileSaysFromWhichSpeedItsLogsTellTheFriction) {
  sim::CompareResult result;
  result.axes = {"x"};
  result.spec.travels.resize(1);
  result.rows.resize(1);
  result.rows[0].trace.resize(100);
  for (std::size_t k = 0; k < 100; ++k)
    result.rows[0].trace[k].velocity[0] = 1e-4 * (static_cast<double>(k) - 50.0);
  Parameters parameters;
  parameters.knowledge.resize(1);
  parameters.files = {"x.toml"};
  parameters.told_from = {0.5e-3};  // 9 of 99 rows are slower
  EXPECT_THAT(check_coverage(result, {0}, parameters), testing::IsEmpty());
  parameters.told_from = {2.5e-3};  // 49 of 99 rows
  EXPECT_THAT(
      check_coverage(result, {0}, parameters),
      testing::ElementsAre(testing::HasSubstr(
          "48 % of its motion is slower than 2.5 mm/s, where the logs behind x.toml do not tell the friction")));
}

// tune and study keep no traces: one run of each travel tells the same.
TEST(Parameters, WorkWithoutTracesSaysTheSame) {
  const std::string machine_file = std::string(STRIBECK_SOURCE_DIR) + "/machines/biaxial-table.toml";
  const sim::Machine machine = read_virtual_machine(machine_file);
  sim::CompareSpec spec;
  spec.axes = {0, 1};
  spec.travels.resize(1);
  spec.travels[0].path = path::Curve{path::Shape::kCircle, 10e-3};
  spec.travels[0].speed = 3e-3;
  spec.travels[0].laps = 0.3;
  spec.controllers = sim::biaxial_controllers();
  spec.controllers.resize(1);
  ParameterOptions options;
  options.source = "thesis";
  Parameters parameters = get_parameters(machine, machine_file, options, spec);
  parameters.files = {"x.toml", ""};
  EXPECT_THAT(coverage_of(machine, spec, parameters), testing::IsEmpty());
  parameters.told_from = {1.0, 0.0};
  parameters.assumed = {"said already"};
  EXPECT_THAT(coverage_of(machine, spec, parameters),
              testing::Each(testing::HasSubstr("where the logs behind x.toml do not tell the friction")));
  EXPECT_THAT(coverage_of(machine, spec, parameters), testing::SizeIs(spec.travels.size()));
}

}  // namespace
}  // namespace stribeck::workflow::parameters_test
