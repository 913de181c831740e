// A machine of one's own, from nothing to a safe excitation.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "command.hpp"

namespace stribeck::test::machine_test {
namespace {

using ::testing::HasSubstr;

const std::string kGantry = std::string(STRIBECK_SOURCE_DIR) + "/examples/own-machine/gantry.toml";
const std::string kVirtual = std::string(STRIBECK_SOURCE_DIR) + "/examples/own-machine/gantry-virtual.toml";

TEST(OwnMachine, InitWritesAFileThatMachineReads) {
  Folder f;
  const Said init = command({"init",
                             "--name",
                             "mine",
                             "--axes",
                             "x",
                             "--sample-time",
                             "1 ms",
                             "--set",
                             "x.limits.travel_min=-60 mm",
                             "--set",
                             "x.limits.travel_max=60 mm",
                             "--set",
                             "x.limits.speed=6 m/min",
                             "--set",
                             "x.limits.acceleration=1 m/s2",
                             "--set",
                             "x.drive.rated_torque=1 N m",
                             "--set",
                             "x.drive.lead=10 mm",
                             "--set",
                             "x.commissioning.mass=[\"30 kg\", \"60 kg\"]",
                             "--set",
                             "x.commissioning.friction=40 N",
                             "-o",
                             f / "mine.toml",
                             "--json",
                             f / "init.json"});
  ASSERT_EQ(init.code, 0) << init.err;
  EXPECT_TRUE(nlohmann::json::parse(text_of(f / "init.json"))["fill_in"].empty());
  const Said machine = command({"machine", f / "mine.toml"});
  ASSERT_EQ(machine.code, 0) << machine.err;
  EXPECT_THAT(machine.out, HasSubstr("628.3 N"));
  EXPECT_THAT(machine.out, HasSubstr("30 to 60 kg"));
  const Said bad = command({"init", "--name", "mine", "--axes", "x", "--sample-time", "1 ms", "--set",
                            "x.limits.speed=6 kg", "-o", f / "bad.toml"});
  EXPECT_EQ(bad.code, 2);
  EXPECT_THAT(bad.err, HasSubstr("x.limits.speed"));
}

TEST(OwnMachine, IsExcitedWithoutATruthAndSimulatedOnlyWithOne) {
  Folder f;
  const Said jog =
      command({"excite", kGantry, "--axis", "y", "--method", "constant-acceleration", "-o", f / "jog.csv"});
  ASSERT_EQ(jog.code, 0) << jog.err;
  const std::string head = text_of(f / "jog.csv").substr(0, 1000);
  for (const char* key : {"# start: ", "# direction: ", "# room: ", "# abort: "})
    EXPECT_THAT(head, HasSubstr(key));
  const Said simulate =
      command({"simulate", kGantry, "--reference", f / "jog.csv", "--axis", "y", "-o", f / "log.csv"});
  EXPECT_EQ(simulate.code, 2);
  EXPECT_THAT(simulate.err, HasSubstr("axes.x.plant: missing, expected the truth"));
}

TEST(OwnMachine, AnAxisThatMayFallGetsNoForcesInOpenLoop) {
  Folder f;
  for (const std::string& machine : {kGantry, kVirtual}) {
    const Said pulses = command({"excite", machine, "--axis", "z", "--method", "pulses", "-o", f / "z.csv"});
    EXPECT_NE(pulses.code, 0);
    EXPECT_THAT(pulses.err, HasSubstr("the axis may fall"));
    EXPECT_EQ(f.files(), 0U);
  }
}

// The weight that the file keeps quiet about drives the axis into its end.
TEST(OwnMachine, RunningIntoAnEndStopEndsTheRun) {
  Folder f;
  std::string text = text_of(kVirtual);
  const std::string load = "load = \"176 N\"  # the weight, less the counterbalance\n";
  ASSERT_NE(text.find(load), std::string::npos);
  text.erase(text.find(load), load.size());
  const std::string machine = f.write("quiet.toml", text);
  ASSERT_EQ(command({"excite", machine, "--axis", "z", "--method", "pulses", "-o", f / "z.csv"}).code, 0);
  const Said run = command({"simulate", machine, "--reference", f / "z.csv", "--axis", "z", "-o",
                            f / "log.csv", "--json", f / "j.json"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("axis z ran into its end stop at -150 mm"));
  const auto json = nlohmann::json::parse(text_of(f / "j.json"));
  EXPECT_EQ(json["end_stop"]["position_mm"], -150.0);
  EXPECT_EQ(json["duration_s"], json["end_stop"]["time_s"]);
}

TEST(OwnMachine, AReferenceOfAnotherAxisIsNoticed) {
  Folder f;
  ASSERT_EQ(
      command({"excite", kVirtual, "--axis", "x", "--method", "constant-acceleration", "-o", f / "x.csv"})
          .code,
      0);
  const Said run =
      command({"simulate", kVirtual, "--reference", f / "x.csv", "--axis", "y", "-o", f / "log.csv"});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("the file is for axis \"x\", but --axis says \"y\""));
}

TEST(OwnMachine, OnlyKnowsTheControllersThereAre) {
  const Said said = command({"compare", kMachine, "--only", "f,zz"});
  EXPECT_EQ(said.code, 2);
  EXPECT_THAT(said.err, HasSubstr("--only"));
  EXPECT_THAT(said.err, HasSubstr("\"zz\""));
}

}  // namespace
}  // namespace stribeck::test::machine_test
