// A machine of one's own, from nothing to a safe excitation.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

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
  // A file that was filled in is not replaced; one with the same contents may be.
  const std::vector<std::string> again{"init",          "--name", "mine", "--axes",       "x",
                                       "--sample-time", "1 ms",   "-o",   f / "mine.toml"};
  const std::string before = text_of(f / "mine.toml");
  const Said refused = command(again);
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("mine.toml: exists, and what was filled in there would be lost"));
  EXPECT_EQ(text_of(f / "mine.toml"), before);
  std::vector<std::string> elsewhere = again;
  elsewhere.back() = f / "new.toml";
  EXPECT_EQ(command(elsewhere).code, 0);
  EXPECT_EQ(command(elsewhere).code, 0);
  for (const char* name : {"x y", "x.y", "ä", "x=1"}) {
    const Said axes =
        command({"init", "--name", "mine", "--axes", name, "--sample-time", "1 ms", "-o", f / "names.toml"});
    EXPECT_EQ(axes.code, 2);
    EXPECT_THAT(axes.err, HasSubstr("expected names of 1 to 16 letters and digits, e.g. --axes x y c2"));
  }
  const Said bad = command({"init", "--name", "mine", "--axes", "x", "--sample-time", "1 ms", "--set",
                            "x.limits.speed=6 kg", "-o", f / "bad.toml"});
  EXPECT_EQ(bad.code, 2);
  EXPECT_THAT(bad.err, HasSubstr("x.limits.speed"));
  const Said twice = command(
      {"init", "--name", "mine", "--axes", "x", "x", "--sample-time", "1 ms", "-o", f / "twice.toml"});
  EXPECT_EQ(twice.code, 2);
  EXPECT_THAT(twice.err, HasSubstr("--axes: got \"x\" twice"));
}

TEST(OwnMachine, InitTakesARangeWithoutQuotesAndAKeyOnce) {
  Folder f;
  const std::vector<std::string> some{"init",
                                      "--name",
                                      "mine",
                                      "--axes",
                                      "x",
                                      "--sample-time",
                                      "1 ms",
                                      "-o",
                                      f / "mine.toml",
                                      "--set",
                                      "x.commissioning.mass=[30 kg, 60 kg]"};
  ASSERT_EQ(command(some).code, 0);
  EXPECT_THAT(text_of(f / "mine.toml"), HasSubstr("mass = [\"30 kg\", \"60 kg\"]"));
  std::vector<std::string> twice = some;
  twice.insert(twice.end(), {"--set", "x.commissioning.mass=40 kg"});
  const Said refused = command(twice);
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--set: x.commissioning.mass is given twice, as \"[30 kg, 60 kg]\" and "
                                     "\"40 kg\" (leave one out)"));
  std::vector<std::string> wrong = some;
  wrong.back() = "x.commissioning.mass=[30 kg, 60 N]";
  const Said unit = command(wrong);
  EXPECT_EQ(unit.code, 2);
  EXPECT_THAT(unit.err, HasSubstr("60 N"));
}

TEST(OwnMachine, InitTakesAnUnbalance) {
  Folder f;
  const Said init = command({"init", "--name", "tilt", "--axes", "a", "--sample-time", "1 ms", "--set",
                             "a.limits.speed=20 rpm", "--set",
                             "a.commissioning.unbalance={ torque = \"80 N m\", hangs_at = \"10 deg\" }", "-o",
                             f / "tilt.toml"});
  ASSERT_EQ(init.code, 0) << init.err;
  EXPECT_THAT(text_of(f / "tilt.toml"),
              HasSubstr("unbalance = { torque = \"80 N m\", hangs_at = \"10 deg\" }"));
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

// A virtual axis needs no such care, but what it allows the real one must allow too: the load of 60 N lies between the least friction
// that the file permits, a third of 100 N, and the 85 % that a virtual one has at least.
TEST(OwnMachine, WhatMayFallMayNotMoveFreelyOnItsVirtualMachineEither) {
  Folder f;
  std::string text = text_of(kVirtual);
  const std::string load = "load = \"176 N\"  # the weight, less the counterbalance\n";
  ASSERT_NE(text.find(load), std::string::npos);
  text.replace(text.find(load), load.size(), "load = \"60 N\"\n");
  const std::string machine = f.write("lighter.toml", text);
  const Said pulses = command({"excite", machine, "--axis", "z", "--method", "pulses", "-o", f / "z.csv"});
  EXPECT_EQ(pulses.code, 1);
  EXPECT_THAT(pulses.err,
              HasSubstr("the axis may fall: its load of 60 N is not below the least friction, 33.33 N"));
}

// A weight that the file denies drives the axis into its end; where it only keeps quiet, the brake tells.
TEST(OwnMachine, RunningIntoAnEndStopEndsTheRun) {
  Folder f;
  std::string text = text_of(kVirtual);
  const std::string load = "load = \"176 N\"  # the weight, less the counterbalance\n";
  ASSERT_NE(text.find(load), std::string::npos);
  std::string denied = text;
  denied.replace(text.find(load), load.size(), "load = \"0 N\"\n");
  text.erase(text.find(load), load.size());
  const std::string quiet = f.write("quiet.toml", text), machine = f.write("denied.toml", denied);
  const Said asked = command({"excite", quiet, "--axis", "z", "--method", "pulses", "-o", f / "no.csv"});
  EXPECT_EQ(asked.code, 1);
  EXPECT_THAT(asked.err, HasSubstr("Write commissioning.load (0 N where nothing pulls)"));
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

// Described, excited, simulated, identified and verified in degrees and newton metres: 4.2 kg m2, 25 N m, 6 N m s.
TEST(OwnMachine, ARotaryTableGoesTheWholeWay) {
  Folder f;
  const std::string table =
      std::string(STRIBECK_SOURCE_DIR) + "/examples/own-machine/rotary-table-virtual.toml";
  for (const std::string method : {"sine", "constant-acceleration", "pulses"}) {
    const std::string motion = f / (method + ".csv");
    ASSERT_EQ(command({"excite", table, "--axis", "c", "--method", method, "-o", motion}).code, 0);
    EXPECT_THAT(text_of(motion), HasSubstr(method == "pulses" ? "f [N m]" : "r [deg]"));
    const Said run =
        command({"simulate", table, "--axis", "c", "--reference", motion, "-o", f / (method + "-log.csv")});
    ASSERT_EQ(run.code, 0) << run.err;
  }
  const Said found = command({"identify", table, f / "sine-log.csv", f / "constant-acceleration-log.csv",
                              "-o", f / "axes", "--json", f / "c.json"});
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr("a rotary axis"));
  const auto json = nlohmann::json::parse(text_of(f / "c.json"));
  EXPECT_NEAR(json[0]["mass_kg"].get<double>(), 4.2, 0.05);
  EXPECT_THAT(text_of(f / "axes/c.toml"), HasSubstr("axis = \"c\"\nrotary = true\n"));
  const Said good = command({"verify", f / "axes/c.toml", f / "pulses-log.csv"});
  // 5.5 %: pulses have the reversals that the sine hardly shows.
  EXPECT_EQ(good.code, 0) << good.out << good.err;
  // What a file holds of it says so; what has no place for it refuses it.
  ASSERT_EQ(
      command({"export", f / "axes/c.toml", "--to", "csv", "--speed", "100 deg/s", "-o", f / "c.csv"}).code,
      0);
  EXPECT_THAT(text_of(f / "c.csv"), HasSubstr("Axis c is a rotary axis: angles are taken as arcs"));
  const Said refused = command({"export", f / "axes/c.toml", "--to", "mujoco", "-o", f / "c.xml"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("mujoco has no place for a rotary axis"));
  EXPECT_EQ(command({"excite", table, "--axis", "c", "--method", "jog", "--speeds", "10 deg/s", "--lead",
                     "20 deg", "-o", f / "jog.csv"})
                .code,
            0);
  // A turn of the table, in the units of the axis.
  const std::string log = f / "sine-log.csv";
  EXPECT_EQ(command({"identify", table, log, "--method", "position-map", "--turn", "360 deg"}).code, 0);
  const Said tiny = command({"identify", table, log, "--method", "position-map", "--turn", "0.001 deg"});
  EXPECT_EQ(tiny.code, 2);
  EXPECT_THAT(tiny.err, HasSubstr("deg for the travel of"));
  // An arc at a radius of 1 m too, as in the commands that health proposes.
  EXPECT_EQ(command({"excite", table, "--axis", "c", "--method", "jog", "--speeds", "100 mm/s", "--lead",
                     "400 mm", "-o", f / "arc.csv"})
                .code,
            0);
}

const std::string kSlide =
    "name = \"slide\"\nsample_time = \"2 ms\"\n[axes.x.limits]\ntravel_min = \"-60 mm\"\ntravel_max = \"60 mm\"\n"
    "speed = \"100 mm/s\"\nacceleration = \"1 m/s2\"\n[axes.x.drive]\nrated_force = \"200 N\"\n"
    "[axes.x.commissioning]\nmass = \"50 kg\"\nfriction = \"60 N\"\nencoder_resolution = \"100 nm\"\n";
const std::string kSlideModel =
    "axis = \"x\"\nmass = \"60 kg\"\ndelay = \"3 ms\"\n[friction.steady]\nkind = \"conventional\"\n"
    "alpha0 = \"50 N\"\nalpha2 = \"200 N s/m\"\n";

// A real machine has no truth: what was identified of it is simulated.
TEST(OwnMachine, IsSimulatedAsItsIdentifiedModel) {
  Folder f;
  const std::string machine = f.write("slide.toml", kSlide);
  const std::string model = f.write("x.toml", kSlideModel);
  const std::string motion = f / "motion.csv";
  ASSERT_EQ(
      command({"excite", machine, "--axis", "x", "--method", "constant-acceleration", "-o", motion}).code, 0);
  const std::vector<std::string> run{"simulate", machine, "--reference", motion,
                                     "--axis",   "x",     "-o",          f / "log.csv"};
  const Said alone = command(run);
  EXPECT_EQ(alone.code, 2);
  EXPECT_THAT(alone.err, HasSubstr("--axis-file x=FILE"));
  std::vector<std::string> with_model = run;
  with_model.insert(with_model.end(), {"--axis-file", "x=" + model});
  ASSERT_EQ(command(with_model).code, 0);
  // The log tells the parameters of the model again.
  ASSERT_EQ(command({"identify", f / "log.csv", "--json", f / "x.json"}).code, 0);
  const auto found = nlohmann::json::parse(text_of(f / "x.json"));
  EXPECT_NEAR(found["mass_kg"].get<double>(), 60.0, 1.5);
  const Said compared = command({"compare", machine, "--axis-file", "x=" + model, "--only", "a", "--trials",
                                 "1", "--json", f / "c.json"});
  ASSERT_EQ(compared.code, 0) << compared.err;
  EXPECT_THAT(compared.out, HasSubstr("is simulated as the model in"));
  EXPECT_THAT(text_of(f / "c.json"), HasSubstr("has no plant"));

  const std::string turning = f.write("c.toml", "rotary = true\n" + kSlideModel.substr(11));
  const Said other = command({"compare", machine, "--axis-file", "x=" + turning, "--only", "a"});
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err, HasSubstr("the file is of a rotary axis, but axis x of"));
  std::string strong = kSlideModel;
  strong.replace(strong.find("50 N"), 4, "500 N");
  const Said stuck =
      command({"compare", machine, "--axis-file", "x=" + f.write("strong.toml", strong), "--only", "a"});
  EXPECT_EQ(stuck.code, 2);
  EXPECT_THAT(stuck.err, HasSubstr("need more than the 200 N of the drive"));
  std::string late = kSlideModel;
  late.replace(late.find("3 ms"), 4, "30 ms");
  const Said delayed =
      command({"compare", machine, "--axis-file", "x=" + f.write("late.toml", late), "--only", "a"});
  EXPECT_EQ(delayed.code, 2);
  EXPECT_THAT(delayed.err, HasSubstr("delay: got 30 ms, expected at most 16 ms"));
}

// Of a trunnion behind a worm gear: 10.4 kg m2, 110 N m out of balance, which hangs down at 12 degrees.
TEST(OwnMachine, ATrunnionIsIdentifiedWithItsUnbalance) {
  Folder f;
  const std::string table = std::string(STRIBECK_SOURCE_DIR) + "/examples/own-machine/trunnion-virtual.toml";
  for (const std::string method : {"pulses", "ramp"}) {
    const Said refused = command({"excite", table, "--axis", "a", "--method", method, "-o", f / "no.csv"});
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(refused.err, HasSubstr("the axis may fall: its load with the unbalance of 132.4 N m"));
  }
  for (const std::string method : {"sine", "constant-acceleration", "position-sine"}) {
    const std::string motion = f / (method + ".csv");
    const Said made = command({"excite", table, "--axis", "a", "--method", method, "-o", motion});
    ASSERT_EQ(made.code, 0) << made.err;
    EXPECT_THAT(made.out, HasSubstr(" N m of its 1440 N m"));
    const Said run =
        command({"simulate", table, "--axis", "a", "--reference", motion, "-o", f / (method + "-log.csv")});
    ASSERT_EQ(run.code, 0) << run.err;
  }
  const Said found = command({"identify", f / "constant-acceleration-log.csv", f / "position-sine-log.csv",
                              "--axis", "a", "-o", f / "a.toml", "--json", f / "a.json"});
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr("kg m2"));
  EXPECT_THAT(found.out, HasSubstr("the heavy side hangs down at"));
  const auto json = nlohmann::json::parse(text_of(f / "a.json"));
  const auto parameter = [&](const std::string& name) {
    for (const auto& p : json["parameters"]) {
      if (p["name"] == name) return p;
    }
    return nlohmann::json();
  };
  const auto mass = parameter("mass");
  EXPECT_LE(mass["ci95"][0].get<double>(), 10.4);
  EXPECT_GE(mass["ci95"][1].get<double>(), 10.4);
  // 3 %: the interval of a log of half a minute.
  EXPECT_NEAR(parameter("unbalance")["value"].get<double>(), 110.0, 3.3);
  EXPECT_THAT(text_of(f / "a.toml"), HasSubstr("rotary = true"));
  EXPECT_THAT(text_of(f / "a.toml"), HasSubstr("\"additive\""));
  const Said good = command({"verify", f / "a.toml", f / "sine-log.csv"});
  EXPECT_EQ(good.code, 0) << good.out << good.err;
}

}  // namespace
}  // namespace stribeck::test::machine_test
