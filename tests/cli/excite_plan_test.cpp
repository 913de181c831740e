#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <stribeck/io/test_folder.hpp>
#include <string>
#include <tests/cli/command.hpp>
#include <vector>

namespace stribeck::test::excite_plan_test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

void expect_refused(const Said& said, const std::string& what) {
  EXPECT_EQ(said.code, 2);
  EXPECT_THAT(said.err, HasSubstr(what));
}

std::vector<std::string> excite(std::initializer_list<std::string> more, const std::string& output) {
  std::vector<std::string> words{"excite", kMachine, "--axis", "x", "-o", output};
  words.insert(words.end(), more);
  return words;
}

TEST(ExcitePlan, WritesTheLogsThatTellWhatIsWanted) {
  const Folder folder;
  // Half a minute leaves pulses and constant acceleration.
  const Said out = command(excite(
      {"--for", "mass,bristles", "--minutes", "0.5", "--json", folder / "plan.json"}, folder / "logs"));
  EXPECT_EQ(out.code, 0) << out.err;
  EXPECT_THAT(out.out, HasSubstr("What a log of axis x is expected to tell"));
  EXPECT_THAT(out.out, ContainsRegex("Not jog: [0-9]+ s of motion, more than there is time for"));
  EXPECT_THAT(text_of(folder / "plan.json"), HasSubstr("\"schema\": \"stribeck.plan/1\""));
  std::size_t files = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder / "logs")) {
    ++files;
    EXPECT_THAT(text_of(file.path().string()), HasSubstr("start"));
  }
  EXPECT_GE(files, 1u);
}

/// A machine of two axes with these names.
std::string machine_with(const std::string& one, const std::string& other) {
  std::string text = "name = \"m\"\nsample_time = \"2 ms\"\n";
  for (const std::string& axis : {one, other})
    text += "[axes." + axis + "]\nlimits.travel_min = \"0 mm\"\nlimits.travel_max = \"250 mm\"\n" +
            "limits.speed = \"200 mm/s\"\nlimits.acceleration = \"4 m/s2\"\nlimits.force = \"8000 N\"\n" +
            "commissioning.mass = \"800 kg\"\ncommissioning.friction = \"500 N\"\n";
  return text;
}

// Pulses were "in the worst case of friction and mass" on an axis that may be vertical.
TEST(ExcitePlan, PulsesSayThatNoWeightMayPullTheAxis) {
  const Folder folder;
  const auto pulses = [&](const std::string& text) {
    return command({"excite", folder.write("m.toml", text), "--axis", "z", "--method", "pulses", "-o",
                    folder / "z.csv"});
  };
  const std::string plain = machine_with("x", "z");
  const Said unsaid = pulses(plain);
  EXPECT_EQ(unsaid.code, 0) << unsaid.err;
  EXPECT_THAT(unsaid.out, HasSubstr("no weight may pull the axis"));
  EXPECT_THAT(unsaid.out, HasSubstr("axes.z.commissioning.load, 0 N where nothing pulls"));
  EXPECT_THAT(text_of(folder / "z.csv"), HasSubstr("no weight may pull the axis"));
  EXPECT_THAT(pulses(plain + "commissioning.load = \"0 N\"\n").out, testing::Not(HasSubstr("no weight")));
  EXPECT_THAT(
      command({"excite", folder / "m.toml", "--axis", "z", "--method", "jog", "-o", folder / "j.csv"}).out,
      testing::Not(HasSubstr("no weight")));
}

TEST(ExcitePlan, AMotorThatIsSlowerThanTheAxisIsSaid) {
  const Folder folder;
  const auto jog = [&](const std::string& speed) {
    const std::string machine = folder.write(
        "m.toml",
        machine_with("x", "z") +
            "drive.rated_torque = \"3 N m\"\ndrive.lead = \"10 mm\"\ndrive.peak_torque = \"20 N m\"\n" +
            "drive.motor_speed = \"" + speed + "\"\n");
    return command({"excite", machine, "--axis", "z", "--method", "jog", "-o", folder / "j.csv"}).out;
  };
  EXPECT_THAT(jog("600 rpm"),
              HasSubstr("(drive.motor_speed) the motor moves the axis by 100 mm/s: lower limits.speed"));
  EXPECT_THAT(jog("1200 rpm"), testing::Not(HasSubstr("motor_speed")));
}

// SINUMERIK calls axes X1, Z1, Y2; two may have one letter.
TEST(ExciteGcode, OfAxesWithNumbersAndOfALathe) {
  const Folder folder;
  const auto gcode = [&](const std::string& machine, const std::string& axis) {
    return command({"excite", machine, "--axis", axis, "--method", "jog", "-o", folder / "r.csv", "--gcode",
                    folder / "r.mpf"});
  };
  const std::string two = folder.write("two.toml", machine_with("X1", "X2"));
  const Said said = gcode(two, "X2");
  EXPECT_EQ(said.code, 0) << said.err;
  const std::string program = text_of(folder / "r.mpf");
  EXPECT_THAT(program, HasSubstr("G710 G90 G94 G64\nG0 X2=125.000000\nG4 F1\nG1 X2="));
  EXPECT_THAT(program, HasSubstr("\n; begins at 125 mm, at rest\n"));
  EXPECT_THAT(program, HasSubstr("\n; counts in the coordinates of the machine: no work offset,"));
  EXPECT_THAT(said.out, HasSubstr("counts in the coordinates of the machine: no work offset,"));
  EXPECT_THAT(text_of(folder / "r.csv"),
              HasSubstr("# coordinates: counts in the coordinates of the machine"));
  EXPECT_THAT(said.out, testing::Not(HasSubstr("lathe")));
  EXPECT_THAT(gcode(folder.write("lathe.toml", machine_with("x", "z")), "x").out,
              HasSubstr("A lathe may count X in diameter"));
  expect_refused(gcode(folder.write("named.toml", machine_with("x", "ram")), "ram"),
                 "rename the axis in the machine file");
}

// Controls count A in degrees; the file of the five-axis mill has arcs at a radius of 100 mm, of which 120 mm are 68.75 degrees.
TEST(ExciteGcode, OfARotaryLetterIsInDegrees) {
  const Folder folder;
  const Said said =
      command({"excite", std::string(STRIBECK_SOURCE_DIR) + "/machines/five-axis-mill.toml", "--axis", "a",
               "--method", "jog", "-o", folder / "r.csv", "--gcode", folder / "a.ngc"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("one degree is 1.745 mm of the file"));
  std::istringstream program(text_of(folder / "a.ngc"));
  double most = 0.0;
  for (std::string line; std::getline(program, line);) {
    double at = 0.0;
    if (std::sscanf(line.c_str(), "G1 A%lf F", &at) == 1) most = std::max(most, std::abs(at));
  }
  EXPECT_GT(most, 60.0);
  EXPECT_LT(most, 68.755);
  EXPECT_THAT(text_of(folder / "a.ngc"), HasSubstr("degrees per minute"));
}

TEST(ExcitePlan, IsProposedForWhatALogLeavesOpen) {
  const Folder folder;
  // One period of a sine: its force of inertia is small, and a spring would look the same.
  ASSERT_EQ(command({"excite", kMachine, "--axis", "x", "--method", "sine", "--strokes", "0", "--periods",
                     "1", "-o", folder / "r.csv", "--quiet"})
                .code,
            0);
  ASSERT_EQ(command({"simulate", kMachine, "--axis", "x", "--reference", folder / "r.csv", "-o",
                     folder / "log.csv", "--quiet"})
                .code,
            0);
  const Said found = command({"identify", kMachine, folder / "log.csv", "--axis", "x", "-o", folder / "axes",
                              "--json", folder / "i.json"});
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr("plan the next log:\n  stribeck excite " + kMachine + " --axis x --for "));
  EXPECT_THAT(found.out, HasSubstr(" --known " + folder / "axes/x.toml"));
  EXPECT_THAT(text_of(folder / "i.json"), HasSubstr("\"not_yet\": [\n"));
}

// Open-loop pulses were written for an axis that falls, because the file of another axis knew no load.
TEST(ExcitePlan, AnAxisFileThatContradictsTheMachineMovesNothing) {
  const Folder folder;
  const std::string model =
      "mass = \"57000 kg\"\nload = \"{} N\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"1000 N\"\nalpha2 = \"0 N s/m\"\n";
  const auto known = [&](const std::string& axis, const std::string& load) {
    std::string text = "axis = \"" + axis + "\"\n" + model;
    text.replace(text.find("{}"), 2, load);
    const std::string file = folder.write(axis + load + ".toml", text);
    return command(excite({"--method", "pulses", "--known", file}, folder / "r.csv"));
  };
  expect_refused(known("y", "0"), "says that it is of axis y, expected the axis file of x");
  const Said heavy = known("x", "4000");
  EXPECT_EQ(heavy.code, 1);
  EXPECT_THAT(heavy.err, HasSubstr("without force the axis may fall"));
  EXPECT_EQ(known("x", "100").code, 0);
}

TEST(ExcitePlan, RefusesWhatItCannotPlan) {
  const Folder folder;
  const std::string out = folder / "logs";
  expect_refused(command(excite({}, out)),
                 "--method: expected either --method, or --for with what is wanted");
  expect_refused(command(excite({"--for", "mass", "--method", "sine"}, out)),
                 "--method: expected either --method, or --for");
  expect_refused(command(excite({"--for", "weight"}, out)), "--for: got \"weight\"");
  expect_refused(command(excite({"--for", "mass", "--periods", "4"}, out)),
                 "--periods: does not go with --for");
  expect_refused(command(excite({"--for", "mass", "--minutes", "0"}, out)), "--minutes: got \"0\"");
  expect_refused(command(excite({"--method", "sine", "--minutes", "3"}, out)), "--minutes: goes with --for");
  expect_refused(command(excite({"--for", "mass", "--plots", folder / "figures"}, out)),
                 "--plots: does not go with --for");
  const Said none = command(excite({"--for", "mass", "--minutes", "0.1"}, out));
  EXPECT_NE(none.code, 0);
  EXPECT_THAT(none.err, HasSubstr("no excitation fits"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace stribeck::test::excite_plan_test
