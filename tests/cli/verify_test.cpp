#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <tests/cli/command.hpp>

namespace stribeck::test::verify_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kAxis =
    "mass = \"100 kg\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"20 N\"\nalpha2 = \"200 N "
    "s/m\"\n";
const std::string kController =
    "[controller]\nkind = \"pd\"\nstiffness = \"400000 N/m\"\ndamping = \"12000 N s/m\"\n";

/// x = A·(1 − cos wt) with the force that a rigid axis with this friction needs, read as a control would log it.
/// `backward`: friction in that direction, where it differs; `ripple`: a force with a period of 5 mm [N].
std::string log_text(double coulomb, double spring = 0.0, double backward = 0.0, double ripple = 0.0) {
  std::string text = "t [s],r [mm],x [mm],f [N]\n";
  for (int k = 0; k < 2000; ++k) {
    const double w = 3.0;
    const double t = 0.002 * k;
    const double mid = t + 0.001;  // the force is held: that of the middle of the sample
    const double v = 0.02 * w * std::sin(w * mid);
    const double f = 100.0 * 0.02 * w * w * std::cos(w * mid) + 200.0 * v +
                     (v > 0 ? coulomb : -(backward > 0.0 ? backward : coulomb));
    const double x = 20.0 * (1.0 - std::cos(w * t));
    const double pull = spring * (x - 20.0) + ripple * std::sin(2.0 * std::numbers::pi * x / 5.0);
    text += std::to_string(t) + ',' + std::to_string(x) + ',' + std::to_string(x) + ',' +
            std::to_string(f + pull) + '\n';
  }
  return text;
}

TEST(Verify, ComparesAxisFilesOnALog) {
  const Folder folder;
  const std::string right = folder.write("right.toml", kAxis);
  std::string text = kAxis;
  text.replace(text.find("20 N"), 4, "26 N");
  const std::string wrong = folder.write("wrong.toml", text);
  const std::string log = folder.write("log.csv", log_text(20.0));
  const std::string controller = folder.write("controller.toml", kController);
  const Said said = command({"verify", right, wrong, log, "--controller", controller, "--json",
                             folder / "v.json", "--report", folder / "page"});
  ASSERT_EQ(said.code, 0) << said.err;
  const auto json = nlohmann::json::parse(text_of(folder / "v.json"));
  EXPECT_EQ(json["schema"], "stribeck.verify/1");
  const auto& models = json["parts"][0]["models"];
  const auto open = [&](int i) { return models[i]["open_loop"]["velocity_relative_percent"].get<double>(); };
  EXPECT_LT(open(0), 1.0);
  EXPECT_GT(open(1), 5.0);
  EXPECT_TRUE(models[0]["closed_loop"]["force_relative_percent"].is_number());
  EXPECT_THAT(said.out, HasSubstr("right.toml"));
  EXPECT_THAT(text_of(folder / "page/index.html"), HasSubstr("the best of 2 models"));
  // Same input, same bytes.
  const std::string before = result_of(folder / "v.json");
  command({"verify", right, wrong, log, "--controller", controller, "--json", folder / "v.json", "--quiet"});
  EXPECT_EQ(result_of(folder / "v.json"), before);
}

// A model fits the log that it comes from, and its verdict on that log is no promise.
TEST(Verify, SaysThatALogIsOneThatTheModelWasIdentifiedFrom) {
  const Folder folder;
  const std::string axis = folder.write(
      "axis.toml",
      "# Axis x: conventional, identified from a.csv, logs/b.csv by stribeck 0.1.0 (auto).\n" + kAxis);
  const std::string own = folder.write("b.csv", log_text(20.0));
  const std::string other = folder.write("c.csv", log_text(20.0));
  EXPECT_THAT(command({"verify", axis, own}).out,
              HasSubstr("its first line names b.csv among the logs that it was identified from"));
  EXPECT_THAT(command({"verify", axis, other}).out, testing::Not(HasSubstr("its first line names")));
  // Without --axis it is the file that is of another axis.
  const std::string of_y = folder.write("y.toml", "axis = \"y\"\n" + kAxis);
  const std::string of_x = folder.write("x-log.csv", "# axis: x\n" + log_text(20.0));
  EXPECT_THAT(
      command({"verify", kMachine, of_y, of_x}).err,
      AllOf(HasSubstr("y.toml"), HasSubstr("axis: is of axis \"y\", and not every log is one of that axis")));
}

TEST(Verify, GivesAVerdictAndAnExitCode) {
  const Folder folder;
  const std::string axis = folder.write("axis.toml", kAxis);
  const std::string log = folder.write("log.csv", log_text(20.0));
  const std::string other = folder.write("other.csv", log_text(20.5));
  const Said good = command({"verify", axis, log, other, "--json", folder / "v.json"});
  EXPECT_EQ(good.code, 0) << good.err;
  EXPECT_THAT(good.out, AllOf(HasSubstr("axis.toml is good: error of the force"), HasSubstr("part 2 of 2")));
  const auto json = nlohmann::json::parse(text_of(folder / "v.json"));
  EXPECT_EQ(json["verdicts"][0]["verdict"], "good");
  EXPECT_EQ(json["parts"].size(), 2u);
  // The force ten times too large, as with a wrong --gain.
  std::string text = log_text(20.0);
  text.replace(text.find("f [N]"), 5, "u [V]");
  const std::string volts = folder.write("volts.csv", text);
  const Said bad = command({"verify", axis, volts, "--gain", "10 N/V"});
  EXPECT_EQ(bad.code, 1);
  EXPECT_THAT(bad.out, HasSubstr("axis.toml is not usable"));
  EXPECT_EQ(command({"verify", axis, volts, "--gain", "10 N/V", "--usable", "1000"}).code, 0);
  EXPECT_EQ(command({"verify", axis, log, "--good", "20", "--usable", "10"}).code, 2);
}

// A run in open loop that leaves the speeds of the model needs more steps than there are: it ended the command in place of a verdict.
TEST(Verify, ARunThatNeedsTooManyStepsIsLeftOut) {
  const Folder folder;
  const std::string axis =
      folder.write("axis.toml", kAxis + "[friction.dynamics]\nkind = \"lugre\"\nsigma0 = \"1e12 N/mm\"\n");
  const std::string log = folder.write("log.csv", log_text(20.0));
  const Said said = command({"verify", axis, log});
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out,
              AllOf(HasSubstr("no run in open loop is shown: replay: bristles of this stiffness need"),
                    HasSubstr("good")));
}

// Half the mass was "good" on slow jogs, and backward friction four times too large on a log that moves forward alone.
TEST(Verify, SaysWhatALogCannotTest) {
  const Folder folder;
  const auto log_with = [&](double slow, double one_way) {
    std::string text = "t [s],x [mm],f [N]\n";
    for (int k = 0; k < 4000; ++k) {
      const double w = 3.0 * slow, t = 0.002 * k, mid = t + 0.001;
      const double v = 0.02 * w * std::sin(w * mid) + one_way;
      const double f = 100.0 * 0.02 * w * w * std::cos(w * mid) + 200.0 * v + (v > 0 ? 20.0 : -20.0);
      text += std::to_string(t) + ',' + std::to_string(20.0 * (1.0 - std::cos(w * t)) + 1e3 * one_way * t) +
              ',' + std::to_string(f) + '\n';
    }
    return folder.write("log.csv", text);
  };
  const std::string axis = folder.write("axis.toml", kAxis);
  const auto said = [&](double slow, double one_way) {
    return command({"verify", axis, log_with(slow, one_way)}).out;
  };
  EXPECT_THAT(said(0.3, 0.0),
              AllOf(HasSubstr("hardly tests the mass"), testing::Not(HasSubstr("alone: friction"))));
  EXPECT_THAT(said(1.0, 0.0), testing::Not(HasSubstr("hardly tests the mass")));
  EXPECT_THAT(said(1.0, 0.08), HasSubstr("moves towards + alone: friction towards - is not tested"));
}

TEST(Verify, NamesASpringThatTheModelHasNoPlaceFor) {
  const Folder folder;
  const std::string axis = folder.write("axis.toml", kAxis);
  const Said pulled = command({"verify", axis, folder.write("spring.csv", log_text(20.0, 2.0))});
  EXPECT_THAT(pulled.out + pulled.err,
              HasSubstr("100 % of what the model misses grows with position, by 1.98 N/mm"));
  // Nor is a wrong model taken for a late force.
  EXPECT_THAT(pulled.out + pulled.err, ::testing::Not(HasSubstr("the force stands")));
  const Said level = command({"verify", axis, folder.write("level.csv", log_text(26.0))});
  EXPECT_THAT(level.out + level.err, HasSubstr("friction that does not depend on the speed, 5.92 N more"));
  EXPECT_THAT(level.out + level.err, ::testing::Not(HasSubstr("grows with position")));
}

// A wrong gain was "another lubrication or preload".
TEST(Verify, NamesAWrongScaleOfTheForce) {
  const Folder folder;
  const std::string axis = folder.write("axis.toml", kAxis);
  std::istringstream rows(log_text(20.0));
  std::string text, row;
  std::getline(rows, row);
  text = row + "\n";
  while (std::getline(rows, row)) {
    const auto comma = row.rfind(',');
    text += row.substr(0, comma + 1) + std::to_string(0.64 * std::stod(row.substr(comma + 1))) + "\n";
  }
  EXPECT_THAT(command({"verify", axis, folder.write("log.csv", text)}).out,
              HasSubstr("the same share of all its forces, 36 % less than in the file: a wrong --gain"));
}

TEST(Verify, NamesFrictionOfOneDirectionAndWhatRepeats) {
  const Folder folder;
  const std::string axis = folder.write("axis.toml", kAxis);
  const Said one = command({"verify", axis, folder.write("one.csv", log_text(20.0, 0.0, 26.0))});
  EXPECT_THAT(one.out + one.err, HasSubstr("friction of one direction, 5.9"));
  EXPECT_THAT(one.out + one.err, HasSubstr("N more backward"));
  const Said wave = command({"verify", axis, folder.write("wave.csv", log_text(20.0, 0.0, 0.0, 5.0))});
  EXPECT_THAT(wave.out + wave.err, HasSubstr("of what the model misses repeats with the position"));
  EXPECT_THAT(wave.out + wave.err, HasSubstr("every 5 mm"));
}

// The mass makes most of the force, so that the error of the force is small: 14 N beside 35 N of friction were "good".
TEST(Verify, AnOffsetThatALargePartOfFrictionIsCounts) {
  const Folder folder;
  std::string heavy = kAxis;
  heavy.replace(heavy.find("100 kg"), 6, "1500 kg");
  const std::string axis = folder.write("axis.toml", heavy);
  const auto log_with = [&](double offset) {
    std::string text = "t [s],r [mm],x [mm],f [N]\n";
    for (int k = 0; k < 4000; ++k) {
      const double w = 6.0, t = 0.002 * k, mid = t + 0.001, v = 0.02 * w * std::sin(w * mid);
      const double x = 20.0 * (1.0 - std::cos(w * t));
      text += std::to_string(t) + ',' + std::to_string(x) + ',' + std::to_string(x) + ',' +
              std::to_string(1500.0 * 0.02 * w * w * std::cos(w * mid) + 200.0 * v + (v > 0 ? 20.0 : -20.0) +
                             offset) +
              '\n';
    }
    return folder.write("log.csv", text);
  };
  EXPECT_EQ(command({"verify", axis, log_with(0.0)}).code, 0);
  EXPECT_THAT(command({"verify", axis, log_with(0.0)}).out, HasSubstr("axis.toml is good"));
  const Said off = command({"verify", axis, log_with(14.0)});
  EXPECT_EQ(off.code, 1);
  EXPECT_THAT(off.out, AllOf(HasSubstr("axis.toml is not usable"),
                             HasSubstr("the constant force, a load or an offset, is 13")));
}

TEST(Verify, NoticesAnotherAxisAndAnotherController) {
  const Folder folder;
  const std::string axis = folder.write("x.toml", "axis = \"x\"\n" + kAxis);
  const std::string log = folder.write("log.csv", "# axis: y\n" + log_text(20.0));
  const std::string controller = folder.write("controller.toml", kController);
  const Said said = command({"verify", axis, log, "--controller", controller});
  EXPECT_THAT(said.out,
              AllOf(HasSubstr("x.toml was identified for axis x, but"), HasSubstr("is a log of axis y")));
  // x = r in this log: no controller made its force.
  EXPECT_THAT(said.out, HasSubstr("does not make the logged command out of the logged positions"));
  const std::string same = folder.write("same.csv", "# axis: X\n" + log_text(20.0));
  EXPECT_THAT(command({"verify", axis, same}).out, ::testing::Not(HasSubstr("was identified for axis")));
}

TEST(Verify, SaysWhatIsWrong) {
  const Folder folder;
  const std::string axis = folder.write("axis.toml", kAxis);
  const std::string log = folder.write("log.csv", log_text(20.0));
  const auto said = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "verify");
    return command(words);
  };
  EXPECT_EQ(said({log}).code, 2);
  EXPECT_THAT(said({log}).err, HasSubstr("one or more axis files and then the log"));
  EXPECT_EQ(said({folder / "none.toml", log}).code, 2);
  const std::string controller = folder.write("c.toml", "[controller]\nkind = \"pdd\"\n");
  const Said wrong = said({axis, log, "--controller", controller});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("c.toml:2"));
  EXPECT_THAT(wrong.err, HasSubstr("cascade"));
  // Another kind of file: many keys are wrong, which is one problem.
  const Said machine = said({kMachine, log});
  EXPECT_EQ(machine.code, 2);
  EXPECT_EQ(std::count(machine.err.begin(), machine.err.end(), '\n'), 1) << machine.err;
  EXPECT_THAT(machine.err,
              AllOf(HasSubstr("biaxial-table.toml"), HasSubstr("is a machine file"), HasSubstr("axis file")));
  EXPECT_EQ(said({axis, log, "--json", axis}).code, 2);  // would overwrite an input
  EXPECT_EQ(text_of(axis), kAxis);
  EXPECT_EQ(said({axis, log, "--force-shift", "3"}).code, 2);
  EXPECT_EQ(said({axis, log, "--force-shift", "1 ms"}).code, 0);
  EXPECT_THAT(said({axis, log, "--force-shift", "1e9 s"}).err,
              AllOf(HasSubstr("--force-shift"), HasSubstr("198 ms")));
  EXPECT_THAT(said({log, axis}).err, AllOf(HasSubstr("log.csv:1"), HasSubstr("the log comes last")));
  std::string runaway = kAxis;
  runaway.replace(runaway.find("100 kg"), 6, "0.1 ug");
  EXPECT_NE(said({folder.write("light.toml", runaway), log}).code,
            2);  // the answer may be no, the input is good
}

/// The log above as a drive has it: turns of a motor with a lead of 10 mm, and percent of its rated torque of 2 N m.
std::string log_of_the_motor(double coulomb) {
  std::istringstream rows(log_text(coulomb));
  std::string row;
  std::getline(rows, row);
  std::string text = "t [s],r [turns],x [turns],f [%]\n";
  while (std::getline(rows, row)) {
    std::array<double, 4> v{};
    std::istringstream numbers(row);
    for (double& one : v) {
      numbers >> one;
      numbers.ignore();
    }
    const double percent = 100.0 * v[3] * 0.010 / (2.0 * 3.14159265358979 * 2.0);
    text += std::to_string(v[0]) + ',' + std::to_string(v[1] / 10.0) + ',' + std::to_string(v[2] / 10.0) +
            ',' + std::to_string(percent) + '\n';
  }
  return text;
}

/// A machine file of the axis above with a control of this period.
std::string machine_text(const std::string& period) {
  return "name = \"own\"\nsample_time = \"" + period +
         "\"\n[axes.x.limits]\ntravel_min = \"-5 mm\"\ntravel_max = \"200 mm\"\n"
         "speed = \"500 mm/s\"\nacceleration = \"2 m/s2\"\n[axes.x.drive]\n"
         "rated_torque = \"2 N m\"\npeak_torque = \"4 N m\"\nlead = \"10 mm\"\n"
         "[axes.x.commissioning]\nmass = \"100 kg\"\nfriction = \"20 N\"\n";
}

// Every fourth row of a control of 2 ms: a command stands for a quarter of a row, which the machine file tells. The force of a right
// axis file was "3 ms later than in the model", and the run in open loop had it 3 ms late.
TEST(Verify, ACommandStandsForOnePeriodOfTheControl) {
  const Folder folder;
  std::string text = "t [s],r [mm],x [mm],f [N]\n";
  for (int k = 0; k < 3000; ++k) {
    const double w = 3.0, t = 0.008 * k, mid = t + 0.001;
    const double v = 0.02 * w * std::sin(w * mid) + 0.004 * 3.1 * w * std::sin(3.1 * w * mid);
    const double a = 0.02 * w * w * std::cos(w * mid) + 0.004 * 9.61 * w * w * std::cos(3.1 * w * mid);
    const double x = 20.0 * (1.0 - std::cos(w * t)) + 4.0 * (1.0 - std::cos(3.1 * w * t));
    text += std::to_string(t) + ',' + std::to_string(x + 0.01) + ',' + std::to_string(x) + ',' +
            std::to_string(100.0 * a + 200.0 * v + (v > 0 ? 20.0 : -20.0)) + '\n';
  }
  const std::string log = folder.write("x-fourth.csv", text);
  const std::string axis = folder.write("x.toml", kAxis);
  const std::string machine = folder.write("machine.toml", machine_text("2 ms"));
  const Said said = command({"verify", machine, axis, log, "--json", folder / "v.json"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, ::testing::Not(HasSubstr("than in the model")));
  const auto json = nlohmann::json::parse(text_of(folder / "v.json"));
  EXPECT_LT(json["parts"][0]["models"][0]["open_loop"]["velocity_relative_percent"].get<double>(), 2.0);
  // An axis file may tell it, as identify writes it with a machine file.
  const std::string told = folder.write("told.toml", std::string("control_period = \"2 ms\"\n") + kAxis);
  EXPECT_THAT(command({"verify", told, log}).out, ::testing::Not(HasSubstr("than in the model")));
  // Without both nothing tells it.
  EXPECT_THAT(command({"verify", axis, log}).out,
              HasSubstr("ms later than in the model, or the log has every n-th command: the machine file"));
}

TEST(Verify, ReadsTheScaleOfALogFromTheMachineFile) {
  const Folder folder;
  const std::string machine = folder.write("machine.toml", machine_text("2 ms"));
  const std::string axis = folder.write("x.toml", kAxis);
  const std::string log = folder.write("x-log.csv", log_of_the_motor(20.0));
  const Said alone = command({"verify", axis, log});
  EXPECT_EQ(alone.code, 2);
  EXPECT_THAT(alone.err, HasSubstr("machine file"));
  const Said said = command({"verify", machine, axis, log, "--json", folder / "v.json"});
  ASSERT_EQ(said.code, 0) << said.err;
  const std::string plain = folder.write("plain.csv", log_text(20.0));
  ASSERT_EQ(command({"verify", axis, plain, "--json", folder / "plain.json"}).code, 0);
  const auto error = [&](const char* file) {
    const auto json = nlohmann::json::parse(text_of(folder / file));
    return json["verdicts"][0]["force_error_percent"].get<double>();
  };
  EXPECT_NEAR(error("v.json"), error("plain.json"), 0.05);

  const std::string turns = folder.write("turns.toml", "rotary = true\n" + kAxis);
  const Said rotary = command({"verify", machine, turns, log});
  EXPECT_EQ(rotary.code, 2);
  EXPECT_THAT(rotary.err, HasSubstr("a rotary axis, but axis x of"));
  const Said other = command({"verify", machine, axis, log, "--axis", "y"});
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err, HasSubstr("expected an axis of"));
}

}  // namespace
}  // namespace stribeck::test::verify_test
