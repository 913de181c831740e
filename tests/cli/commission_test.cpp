#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <tests/cli/command.hpp>

namespace stribeck::test::commission_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A sine of two frequencies, with the force that a rigid axis of 100 kg with 20 N and 200 N·s/m needs. The axis is `behind` its
/// reference by this time [s].
std::string log_text(double omega, double coulomb, std::uint32_t seed, double behind = 0.01) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise(0.0, 0.2);
  std::string text = "t [s],r [mm],x [mm],f [N]\n";
  for (int k = 0; k < 6000; ++k) {
    const double t = 0.002 * k, middle = t + 0.001;
    const auto x_at = [&](double s) {
      return 15.0 * (1.0 - std::cos(omega * s)) + 4.0 * (1.0 - std::cos(2.7 * omega * s));
    };
    const double v =
        1e-3 * (15.0 * omega * std::sin(omega * middle) + 4.0 * 2.7 * omega * std::sin(2.7 * omega * middle));
    const double a = 1e-3 * omega * omega *
                     (15.0 * std::cos(omega * middle) + 4.0 * 2.7 * 2.7 * std::cos(2.7 * omega * middle));
    const double f = 100.0 * a + 200.0 * v + (v > 0.0 ? coulomb : -coulomb) + noise(generator);
    text += fmt::format("{:.3f},{:.6f},{:.6f},{:.4f}\n", t, x_at(t + behind), x_at(t), f);
  }
  return text;
}

/// The machine file of a real axis x, without the truth of a virtual one.
std::string real_machine(const std::string& drive) {
  return R"(name = "gantry"
sample_time = "2 ms"
[axes.x.limits]
travel_min = "-100 mm"
travel_max = "100 mm"
speed = "500 mm/s"
acceleration = "2000 mm/s2"
force = "3000 N"
[axes.x.commissioning]
mass = "100 kg"
friction = "20 N"
)" + drive;
}
/// A folder with logs/, and the command on it.
struct Stages {
  Folder folder;

  std::string machine = folder.write("machine.toml", real_machine(""));

  Stages() { std::filesystem::create_directory(folder / "logs"); }
  void log(const std::string& name, const std::string& text) const { folder.write("logs/" + name, text); }
  [[nodiscard]] Said run(std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"commission", machine,         "--logs", folder / "logs",
                                   "-o",         folder / "axes", "--axis", "x"};
    words.insert(words.end(), more.begin(), more.end());
    return command(words);
  }
};

TEST(Commission, SaysWhatToRecordNext) {
  const Stages stages;
  const Said nothing = stages.run();
  EXPECT_EQ(nothing.code, 1) << nothing.err;
  EXPECT_THAT(nothing.out, AllOf(HasSubstr("Axis x: no log"), HasSubstr("--axis x --method sine -o"),
                                 Not(HasSubstr("first: "))));
  // A log that lacks a unit is mended, not recorded again.
  stages.log("x.csv", "time,x_act,torque\n0,1,2\n0.001,2,3\n");
  const std::string skipped = stages.run().out;
  EXPECT_THAT(skipped, HasSubstr("--map x=\"x_act mm\""));
  EXPECT_LT(skipped.find("skipped: "), skipped.find("first: mend what was skipped"));
  EXPECT_LT(skipped.find("first: mend"), skipped.find("next: stribeck excite"));
  std::filesystem::remove(stages.folder / "logs/x.csv");
  stages.log("x-sine.csv", log_text(3.0, 20.0, 1));
  const Said one = stages.run();
  EXPECT_EQ(one.code, 1) << one.err;
  EXPECT_THAT(one.out, AllOf(HasSubstr("Axis x: not verified"), HasSubstr("--method position-sine"),
                             HasSubstr("x-verify.csv")));
  EXPECT_FALSE(std::filesystem::exists(stages.folder / "axes/x.toml"));
}

// The command was logged as the position: mass and friction were those of the command, "ready" on another such log.
TEST(Commission, PromotesNothingFromALogOfTheCommand) {
  const Stages stages;
  stages.log("x-sine.csv", log_text(3.0, 20.0, 1, 0.0));
  stages.log("x-verify.csv", log_text(2.0, 20.0, 2, 0.0));
  const Said said = stages.run();
  EXPECT_EQ(said.code, 1) << said.err;
  EXPECT_THAT(said.out,
              AllOf(HasSubstr("x-sine.csv: the position is its command"),
                    HasSubstr("x-verify.csv: the position is its command"),
                    HasSubstr("record the position of the encoder"), HasSubstr("--keep commanded")));
  EXPECT_FALSE(std::filesystem::exists(stages.folder / "axes/x.toml"));
  EXPECT_EQ(stages.run({"--keep", "commanded"}).code, 0);
  const Said identified = command({"identify", stages.folder / "logs/x-sine.csv"});
  EXPECT_THAT(identified.out + identified.err,
              HasSubstr("the position is the command, so that all numbers and their intervals"));
}

// A list of rows is a log; a result of this program beside the logs is none.
TEST(Commission, TakesLogsInJson) {
  const Stages stages;
  stages.log(
      "x.json",
      "[{\"time [s]\": 0, \"x_act\": 1, \"torque\": 2}, {\"time [s]\": 0.001, \"x_act\": 2, \"torque\": 3}]\n");
  stages.log("result.json", "{\n  \"schema\": \"stribeck.identify/1\",\n  \"axis\": \"x\"\n}\n");
  const std::string said = stages.run().out;
  EXPECT_THAT(said, AllOf(HasSubstr("skipped: "), HasSubstr("x.json"), HasSubstr("x_act"),
                          Not(HasSubstr("result.json"))));
}

TEST(Commission, PromotesAVerifiedModelAndDoesNothingTwice) {
  const Stages stages;
  stages.log("x-sine.csv", log_text(3.0, 20.0, 1));
  stages.log("x-verify.csv", log_text(2.0, 20.0, 2));
  stages.log("notes.txt", "measured on a Monday\n");
  const Said said = stages.run({"--json", stages.folder / "c.json"});
  ASSERT_EQ(said.code, 0) << said.err << said.out;
  EXPECT_THAT(said.out,
              AllOf(HasSubstr("Axis x: ready"), HasSubstr("x-verify.csv: good"), HasSubstr("stribeck export"),
                    HasSubstr("skipped: "), Not(HasSubstr("unchanged"))));
  const auto json = nlohmann::json::parse(text_of(stages.folder / "c.json"));
  EXPECT_EQ(json["axes"][0]["stage"], "ready");
  EXPECT_NEAR(json["axes"][0]["mass_kg"].get<double>(), 100.0, 2.0);
  const std::string state = text_of(stages.folder / "axes/commission.json");
  const Said again = stages.run();
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.out, HasSubstr("inputs unchanged"));
  EXPECT_EQ(text_of(stages.folder / "axes/commission.json"), state);
  // Another log, other limits: computed again.
  EXPECT_THAT(stages.run({"--usable", "14"}).out, Not(HasSubstr("unchanged")));
  stages.log("x-verify.csv", log_text(2.0, 20.0, 3));
  EXPECT_THAT(stages.run().out, Not(HasSubstr("unchanged")));
}

// Verified on a copy of the log that it was identified from, a model is verified on itself.
TEST(Commission, ACopyOfALogVerifiesNothing) {
  const Stages stages;
  stages.log("x-sine.csv", log_text(3.0, 20.0, 1));
  stages.log("x-verify.csv", log_text(3.0, 20.0, 1));
  const Said said = stages.run();
  EXPECT_EQ(said.code, 1) << said.err;
  EXPECT_THAT(said.out,
              AllOf(HasSubstr("Axis x: not verified"), HasSubstr("x-verify.csv holds the same rows as ")));
  const std::string sine = stages.folder / "logs/x-sine.csv", verify = stages.folder / "logs/x-verify.csv";
  const auto mass = [&](const std::vector<std::string>& logs) {
    std::vector<std::string> words{"identify", "--json", stages.folder / "i.json"};
    words.insert(words.end(), logs.begin(), logs.end());
    EXPECT_EQ(command(words).code, 0);
    return nlohmann::json::parse(text_of(stages.folder / "i.json"))["mass_ci95_kg"];
  };
  EXPECT_EQ(mass({sine, verify}), mass({sine}));
}

TEST(Commission, DoesNotPromoteAModelThatFails) {
  const Stages stages;
  stages.log("x-sine.csv", log_text(3.0, 20.0, 1));
  stages.log("x-verify.csv", log_text(2.0, 20.0, 2));
  ASSERT_EQ(stages.run().code, 0);
  const std::string good = text_of(stages.folder / "axes/x.toml");
  stages.log("x-verify.csv", log_text(2.0, 45.0, 2));  // another friction
  const Said said = stages.run();
  EXPECT_EQ(said.code, 1);
  EXPECT_THAT(said.out, AllOf(HasSubstr("Axis x: refused"), HasSubstr("not usable"),
                              HasSubstr("is still that of earlier logs")));
  EXPECT_EQ(text_of(stages.folder / "axes/x.toml"), good);
  // With the right log again, its own file may be replaced.
  stages.log("x-verify.csv", log_text(2.0, 20.0, 4));
  EXPECT_EQ(stages.run().code, 0);
}

// Verified on a log with the same wrong scale, such a model was "good" and "ready".
TEST(Commission, AScaleThatTheMachineContradictsIsNotPromoted) {
  const Stages stages;
  for (const int k : {1, 2}) {
    std::string text = log_text(1.0 + k, 20.0, static_cast<std::uint32_t>(k));
    for (const char* column : {"r [mm]", "x [mm]"})
      text.replace(text.find(column), 6, std::string(column, 2) + "[dm]");
    stages.log(fmt::format("x-{}.csv", k), text);
  }
  const Said said = stages.run();
  EXPECT_THAT(said.out, AllOf(HasSubstr("Axis x: refused"), HasSubstr("the axis has a travel of"),
                              HasSubstr("no axis file was written")));
  EXPECT_FALSE(std::filesystem::exists(stages.folder / "axes/x.toml"));
}

TEST(Commission, DoesNotReplaceAFileThatIsNotItsOwn) {
  const Stages stages;
  stages.log("x-sine.csv", log_text(3.0, 20.0, 1));
  stages.log("x-verify.csv", log_text(2.0, 20.0, 2));
  std::filesystem::create_directory(stages.folder / "axes");
  stages.folder.write("axes/x.toml", "mine\n");
  const Said said = stages.run();
  EXPECT_EQ(said.code, 2);
  EXPECT_THAT(said.err, HasSubstr("x.toml: was not written by this command"));
  EXPECT_EQ(text_of(stages.folder / "axes/x.toml"), "mine\n");
}

const std::string kRealDrive = R"([axes.x.drive]
rated_torque = "1.5 N m"
lead = "10 mm"
gear = 2
)";

/// The log as a drive shows it: position in um, speed of the motor in rpm, torque in percent of 1.5 N m.
std::string drive_log(double omega, double coulomb, std::uint32_t seed) {
  std::istringstream rows(log_text(omega, coulomb, seed));
  std::string text = "t [s],r [um],x [um],v [rpm],torque [%]\n";
  std::string row;
  std::getline(rows, row);
  double before = 0.0;
  constexpr double kTurn = 5.0;                                   // [mm] of travel per turn of the motor
  constexpr double kRated = 1.5 * 2.0 * 3.14159265358979 / 5e-3;  // [N] at 100 %
  while (std::getline(rows, row)) {
    double t = 0.0, r = 0.0, x = 0.0, f = 0.0;
    EXPECT_EQ(std::sscanf(row.c_str(), "%lf,%lf,%lf,%lf", &t, &r, &x, &f), 4);
    text += fmt::format("{:.3f},{:.3f},{:.3f},{:.4f},{:.5f}\n", t, 1e3 * r, 1e3 * x,
                        60.0 * (x - before) / 0.002 / kTurn, 100.0 * f / kRated);
    before = x;
  }
  return text;
}

// A scale of the force that is four times too large is in the held-out log too: the model was "ready", and the next command an export.
TEST(Commission, AMassThatTheMachineContradictsIsNotPromoted) {
  const Stages stages;
  std::string drive = kRealDrive;
  drive.replace(drive.find("1.5 N m"), 7, "6.0 N m");
  const std::string machine = stages.folder.write("real.toml", real_machine(drive));
  stages.log("x-sine.csv", drive_log(3.0, 20.0, 1));
  stages.log("x-verify.csv", drive_log(2.0, 20.0, 2));
  const auto run = [&] {
    return command({"commission", machine, "--logs", stages.folder / "logs", "-o", stages.folder / "axes"});
  };
  const Said said = run();
  EXPECT_EQ(said.code, 1) << said.err;
  EXPECT_THAT(said.out, AllOf(HasSubstr("Axis x: refused"), HasSubstr("contradicts the machine file"),
                              HasSubstr("next: correct "), Not(HasSubstr("export")),
                              Not(HasSubstr("warning: the mass"))));
  EXPECT_FALSE(std::filesystem::exists(stages.folder / "axes/x.toml"));
}

// The file says nothing of a load, which contradicts none: a press with a weight of 900 N was refused though all of its numbers were right.
TEST(Commission, ALoadOfWhichTheFileSaysNothingIsAWarning) {
  const Stages stages;
  const auto hanging = [](double omega, std::uint32_t seed) {
    std::istringstream rows(log_text(omega, 20.0, seed));
    std::string text, row;
    std::getline(rows, row);
    text = row + "\n";
    while (std::getline(rows, row)) {
      const std::size_t comma = row.rfind(',');
      text += fmt::format("{},{:.6f}\n", row.substr(0, comma), std::stod(row.substr(comma + 1)) + 150.0);
    }
    return text;
  };
  stages.log("x-sine.csv", hanging(3.0, 1));
  stages.log("x-verify.csv", hanging(2.0, 2));
  const auto run = [&](const std::string& machine) {
    return command({"commission", machine, "--logs", stages.folder / "logs", "-o", stages.folder / "axes"});
  };
  std::string text = real_machine("");
  const Said silent = run(stages.folder.write("silent.toml", text));
  EXPECT_THAT(silent.out, AllOf(HasSubstr("Axis x: ready"), HasSubstr("the log shows a load of")));
  const std::size_t key = text.find("friction = ");
  ASSERT_NE(key, std::string::npos);
  text.insert(key, "load = \"0 N\"\n");
  const Said told = run(stages.folder.write("told.toml", text));
  EXPECT_THAT(told.out, HasSubstr("Axis x: refused")) << told.err;
}

/// The machine of Stages with an axis y of the same data.
std::string two_axes() {
  std::string two = real_machine("");
  two += two.substr(two.find("[axes.x.limits]"));
  for (std::size_t at = two.rfind("axes.x"), n = 0; n < 2; ++n, at = two.rfind("axes.x")) two[at + 5] = 'y';
  return two;
}

// y moves in one direction alone, which no axis file holds: the whole command ended with that, and x got nothing.
TEST(Commission, AnAxisWithUnusableLogsDoesNotEndTheOthers) {
  const Stages stages;
  const std::string machine = stages.folder.write("two.toml", two_axes());
  stages.log("x-sine.csv", log_text(3.0, 20.0, 1));
  stages.log("x-verify.csv", log_text(2.0, 20.0, 2));
  for (const int n : {1, 2}) {
    std::mt19937 generator(static_cast<std::uint32_t>(n));
    std::normal_distribution<double> noise(0.0, 0.2);
    std::string text = "t [s],x [mm],f [N]\n";
    for (int k = 0; k < 4000; ++k) {  // v = 20 + 10 (1 - cos w t) mm/s
      const double w = 2.0 * n, t = 0.002 * k, m = t + 0.001,
                   x = 30.0 * t - 10.0 / w * std::sin(w * t) - 90.0;
      const double f = 100.0 * 0.01 * w * std::sin(w * m) + 200.0 * (0.03 - 0.01 * std::cos(w * m)) + 20.0;
      text += fmt::format("{:.3f},{:.6f},{:.4f}\n", t, x, f + noise(generator));
    }
    stages.log(fmt::format("y-{}.csv", n), text);
  }
  std::filesystem::create_directory(stages.folder / "axes");
  stages.folder.write("axes/y.toml", "of earlier logs\n");
  const Said said =
      command({"commission", machine, "--logs", stages.folder / "logs", "-o", stages.folder / "axes"});
  EXPECT_EQ(said.code, 1) << said.err;
  EXPECT_THAT(said.out, AllOf(HasSubstr("Axis x: ready"), HasSubstr("Axis y: refused"),
                              HasSubstr("y.toml is still that of earlier logs")));
  // 77 of 500 mm/s.
  EXPECT_THAT(said.out, HasSubstr("mm/s is not known, and the axis may move at 500 mm/s"));
}

// Without a log too: an old file was left there without a word.
TEST(Commission, AnOldAxisFileIsNamedAtEveryStage) {
  Stages stages;
  stages.machine = stages.folder.write("two.toml", two_axes());
  stages.log("x-sine.csv", log_text(3.0, 20.0, 1));
  stages.log("x-verify.csv", log_text(2.0, 20.0, 2));
  ASSERT_EQ(stages.run().code, 0);
  std::filesystem::remove(stages.folder / "logs/x-verify.csv");
  EXPECT_THAT(stages.run().out,
              AllOf(HasSubstr("Axis x: not verified"), HasSubstr("is still that of earlier logs")));
  std::filesystem::remove(stages.folder / "logs/x-sine.csv");
  stages.log("y-sine.csv", log_text(3.0, 20.0, 1));
  EXPECT_THAT(stages.run().out,
              AllOf(HasSubstr("Axis x: no log"), HasSubstr("is still that of earlier logs")));
}

// A file named after x holds y too, which moved slowly meanwhile: its own motions were taken as recorded.
TEST(Commission, AMotionOfAnotherAxisIsNotRecordedForThisOne) {
  const Stages stages;
  const std::string machine = stages.folder.write("two.toml", two_axes());
  std::istringstream rows(log_text(3.0, 20.0, 1));
  std::string text = "t [s],x_x [mm],f_x [N],x_y [mm],f_y [N]\n", row;
  std::getline(rows, row);
  for (int k = 0; std::getline(rows, row); ++k) {
    double t = 0.0, r = 0.0, x = 0.0, f = 0.0;
    EXPECT_EQ(std::sscanf(row.c_str(), "%lf,%lf,%lf,%lf", &t, &r, &x, &f), 4);
    text +=
        fmt::format("{:.3f},{:.6f},{:.4f},{:.6f},{:.4f}\n", t, x, f, 2.0 * std::sin(t), 20.0 + 0.1 * (k % 3));
  }
  stages.log("x-constant-acceleration.csv", text);
  const Said said =
      command({"commission", machine, "--logs", stages.folder / "logs", "-o", stages.folder / "axes"});
  EXPECT_THAT(said.out, HasSubstr("--axis y --method constant-acceleration")) << said.err;
}

TEST(Commission, TakesTheDriveOfTheMachineFileForLogsOfTheDrive) {
  const Stages stages;
  const std::string machine = stages.folder.write("real.toml", real_machine(kRealDrive));
  stages.log("x-sine.csv", drive_log(3.0, 20.0, 1));
  stages.log("x-verify.csv", drive_log(2.0, 20.0, 2));
  const std::vector<std::string> words{"commission", machine,
                                       "--logs",     stages.folder / "logs",
                                       "-o",         stages.folder / "axes",
                                       "--json",     stages.folder / "c.json"};
  const Said said = command(words);
  ASSERT_EQ(said.code, 0) << said.err << said.out;
  const auto json = nlohmann::json::parse(text_of(stages.folder / "c.json"));
  EXPECT_NEAR(json["axes"][0]["mass_kg"].get<double>(), 100.0, 2.0);
  // The command that is printed works as it is.
  const std::string axis = stages.folder / "axes/x.toml";
  EXPECT_THAT(said.out, HasSubstr("stribeck export " + axis + " --to all -o exports-x"));
  const Said table =
      command({"export", axis, "--to", "linuxcnc", "--lincurve", "-o", stages.folder / "x.hal"});
  EXPECT_EQ(table.code, 0) << table.err;
}

TEST(Commission, TheAxisFileKnowsTheDriveSoThatAnExportNeedsNoOption) {
  const Stages stages;
  const std::string loop =
      "motors = 2\nencoder_counts = 20000\n[axes.x.drive_loop]\nmode = \"velocity\"\ngain = \"12 N s/mm\"\n"
      "integral_time = \"12 ms\"\n";
  const std::string machine = stages.folder.write("real.toml", real_machine(kRealDrive + loop));
  stages.log("x-sine.csv", log_text(3.0, 20.0, 1));
  stages.log("x-verify.csv", log_text(2.0, 20.0, 2));
  const Said said =
      command({"commission", machine, "--logs", stages.folder / "logs", "-o", stages.folder / "axes"});
  ASSERT_EQ(said.code, 0) << said.err << said.out;
  const std::string axis = stages.folder / "axes/x.toml";
  // 1.5 N m of each of two motors, geared 2:1 to 10 mm per turn.
  const std::string text = text_of(axis);
  EXPECT_THAT(text, AllOf(HasSubstr("control_period = \"2 ms\""), HasSubstr("motors = 2"),
                          HasSubstr("encoder_resolution = \"250 nm\""), HasSubstr("mode = \"velocity\"")));
  const Said offset = command({"export", axis, "--to", "cia402", "-o", stages.folder / "x.st"});
  ASSERT_EQ(offset.code, 0) << offset.err;
  EXPECT_THAT(offset.out,
              AllOf(HasSubstr("x: 3770 N for 100 % of the rated torque, from the drive in " + axis),
                    HasSubstr("force of 2 motors together")));
  EXPECT_THAT(text_of(stages.folder / "x.st"), HasSubstr("F := F / 3.769911184e+00;"));
  ASSERT_EQ(command({"export", axis, "--to", "pid", "-o", stages.folder / "x.hal"}).code, 0);
  EXPECT_THAT(text_of(stages.folder / "x.hal"), HasSubstr("setp pid.x.FF1 1 "));
}

TEST(Commission, SaysWhatALogOfADriveLacks) {
  const Stages stages;
  const std::string machine = stages.folder.write("real.toml", real_machine(""));
  std::string log = drive_log(3.0, 20.0, 1);
  log.replace(0, log.find('\n'), "t [s],r [um],x [um],speed,torque [%]");
  stages.log("x-sine.csv", log);
  const Said said = command(
      {"commission", machine, "--logs", stages.folder / "logs", "-o", stages.folder / "axes", "--axis", "x"});
  EXPECT_EQ(said.code, 1) << said.err;
  EXPECT_THAT(said.out, AllOf(HasSubstr("Axis x: not determined"), HasSubstr("the force of the logs is in %"),
                              HasSubstr("[axes.x.drive]"), HasSubstr("--gain"), Not(HasSubstr("mass 0"))));
}

// No verb that reads logs needs the truth of a virtual machine.
TEST(Commission, IdentifyTakesTheSameMachineFile) {
  const Stages stages;
  const std::string machine = stages.folder.write("real.toml", real_machine(kRealDrive));
  stages.log("x-sine.csv", drive_log(3.0, 20.0, 1));
  const Said said = command({"identify", machine, stages.folder / "logs/x-sine.csv", "--axis", "x", "-o",
                             stages.folder / "models", "--json", stages.folder / "i.json"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_TRUE(std::filesystem::exists(stages.folder / "models/x.toml"));
  const auto json = nlohmann::json::parse(text_of(stages.folder / "i.json"));
  EXPECT_NEAR(json[0]["mass_kg"].get<double>(), 100.0, 2.0);
  EXPECT_THAT(said.out, HasSubstr("from the drive of the machine file"));
}

TEST(Commission, RefusesWhatIsThere) {
  const Stages stages;
  EXPECT_THAT(
      command({"commission", kMachine, "--logs", stages.folder / "none", "-o", stages.folder / "axes"}).err,
      HasSubstr("none: cannot be read"));
  EXPECT_THAT(command({"commission", kMachine, "--logs", stages.folder / "logs", "-o", stages.folder / "axes",
                       "--axis", "w"})
                  .err,
              HasSubstr("--axis: got \"w\", which "));
  std::filesystem::create_directory(stages.folder / "axes");
  stages.folder.write("axes/commission.json", "{");
  EXPECT_THAT(stages.run().err, HasSubstr("is no state of stribeck commission"));
}

TEST(Commission, OptionsOfARunningMachineAreForItAlone) {
  const Folder folder;
  const auto refused = [&](std::vector<std::string> more, const char* why) {
    std::vector<std::string> words{"commission", kMachine, "-o", folder / "out"};
    words.insert(words.end(), more.begin(), more.end());
    const Said said = command(words);
    EXPECT_EQ(said.code, 2);
    EXPECT_THAT(said.err, HasSubstr(why));
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  };
  refused({}, "--logs: or --linuxcnc is missing");
  refused({"--logs", folder / "logs", "--linuxcnc", "mill.ini"}, "--linuxcnc: and --logs exclude each other");
  refused({"--logs", folder / "logs", "--stage", "check"}, "--stage: belongs to --linuxcnc");
  refused({"--logs", folder / "logs", "--yes"}, "--yes: belongs to --linuxcnc");
  refused({"--logs", folder / "logs", "--undo"}, "--undo: belongs to --linuxcnc");
  refused({"--linuxcnc", "mill.ini", "--gain", "3 N/V"}, "belong to --logs");
  refused({"--linuxcnc", folder / "none.ini", "--yes"}, "none.ini");
  refused({"--linuxcnc", "mill.ini", "--stage", "chekc"}, "check");
}

}  // namespace
}  // namespace stribeck::test::commission_test
