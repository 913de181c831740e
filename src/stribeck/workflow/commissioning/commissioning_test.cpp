#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/commissioning/commissioning.hpp>
#include <stribeck/workflow/commissioning/originals.hpp>
#include <stribeck/workflow/commissioning/test_machine.hpp>

namespace stribeck::workflow::commissioning::commissioning_test {
namespace {

constexpr const char* kMachine = R"(
name = "a table"
sample_time = "1 ms"
[axes.x.limits]
travel_min = "-50 mm"
travel_max = "50 mm"
speed = "100 mm/s"
acceleration = "1000 mm/s2"
force = "1000 N"
[axes.x.commissioning]
mass = "100 kg"
friction = "120 N"
encoder_resolution = "100 nm"
)";

struct Session {
  test::Folder folder;
  FakeMachine machine;
  Options options;
  std::vector<std::string> said;
  bool agrees = true;

  Session() {
    options.machine = folder.write("machine.toml", kMachine);
    options.ini = folder.write("mill.ini", "[HAL]\nHALFILE = mill.hal\n");
    options.output = folder / "out";
    options.stage = "check";
  }
  Outcome go() {
    Dialogue dialogue;
    dialogue.say = [this](const std::string& text) { said.push_back(text); };
    dialogue.agree = [this](const std::string&) { return agrees; };
    return run(machine, options, dialogue);
  }
  /// Why it stops; empty: it does not.
  std::string stops() {
    try {
      go();
      return {};
    } catch (const Stopped& e) {
      return e.what();
    }
  }
  [[nodiscard]] bool done(const std::string& stage) const {
    return std::filesystem::exists(options.output + '/' + stage);
  }
  [[nodiscard]] long asked(const std::string& what) const {
    return std::count_if(machine.log.begin(), machine.log.end(),
                         [&](const std::string& line) { return line.starts_with(what); });
  }
};

TEST(Commissioning, CheckFindsTheSign) {
  Session s;
  EXPECT_EQ(s.stops(), "");
  EXPECT_TRUE(s.done("check"));
  EXPECT_LT(s.machine.farthest, 0.06e-3);
  EXPECT_TRUE(s.machine.on);
}

TEST(Commissioning, WrongSignIsFoundBeforeATenthOfAMillimetre) {
  for (const double friction : {40.0, 100.0, 400.0}) {
    Session s;
    s.machine.sign = -1.0;
    s.machine.friction = friction;
    EXPECT_NE(s.stops().find("moves against its command"), std::string::npos) << friction;
    EXPECT_LT(s.machine.farthest, 0.1e-3) << friction;
    EXPECT_FALSE(s.machine.on);
    EXPECT_FALSE(s.done("check"));
  }
}

TEST(Commissioning, ValuesAreGivenBack) {
  Session s;
  const auto before = s.machine.values;
  s.go();
  EXPECT_EQ(s.machine.values, before);
  s.machine.sign = -1.0;
  s.stops();
  EXPECT_EQ(s.machine.values, before);
}

TEST(Commissioning, ValuesOfACommandThatWasKilledAreGivenBack) {
  Session s;
  std::filesystem::create_directory(s.options.output);
  s.folder.write("out/changed-for-a-while.json",
                 R"([{"name": "ax.x.ferror-limit", "before": "1", "now": "0.08"},
                     {"name": "ax.x.omega", "before": "5", "now": "7"}])");
  s.machine.values["ax.x.ferror-limit"] = "0.08";
  s.go();
  EXPECT_EQ(s.machine.values["ax.x.ferror-limit"], "1");
  EXPECT_EQ(s.machine.values["ax.x.omega"], "300") << "somebody else has set it since";
}

// The full force was given back to a loop that was closed with a sign nobody had proven.
TEST(Commissioning, TheFullForceIsGivenBackToAMachineThatIsOff) {
  Session s;
  const auto before = s.machine.values;
  s.machine.broken_record = true;
  EXPECT_THROW(s.go(), std::exception);
  EXPECT_EQ(s.machine.values, before);
  EXPECT_FALSE(s.machine.on);
}

// The joint was narrower than the machine file, and the axis was compared with the joint.
TEST(Commissioning, AJointMayBeNarrowerThanItsAxis) {
  Session s;
  s.machine.keys["JOINT_0 MAX_VELOCITY"] = {"50"};
  s.machine.keys["AXIS_X MAX_VELOCITY"] = {"100"};
  EXPECT_EQ(s.stops(), "");
  s.machine.keys["AXIS_X MAX_VELOCITY"] = {"101"};
  s.options.output = s.folder / "another";
  const std::string why = s.stops();
  EXPECT_NE(why.find("[AXIS_X]MAX_VELOCITY is 101.00 mm/s, speed of the machine file 100.00 mm/s"),
            std::string::npos)
      << why;
}

// With an unclear sign the next try released the emergency stop that somebody had just pressed.
TEST(Commissioning, AnEmergencyStopEndsTheStageAndStays) {
  for (const std::string hand : {"estop", "off"}) {
    Session s;
    s.machine.pressed_after = hand;
    const std::string why = s.stops();
    EXPECT_NE(why.find(hand == "estop" ? "the emergency stop was pressed" : "the machine was switched off"),
              std::string::npos)
        << why;
    EXPECT_EQ(s.machine.estop, hand == "estop");
    EXPECT_FALSE(s.machine.on);
    EXPECT_EQ(s.asked("jog"), 1) << hand;
    EXPECT_EQ(s.asked("release"), 0);
  }
}

// Pressed when an axis had run away: the fault of the controller explained the stop, and the next try released it.
TEST(Commissioning, AnEmergencyStopBesideAFaultStays) {
  Session s;
  s.machine.pressed_after = "estop";
  s.machine.fault_after = "5";
  s.stops();
  EXPECT_TRUE(s.machine.estop);
  EXPECT_FALSE(s.machine.on);
  EXPECT_EQ(s.asked("release"), 0);
  EXPECT_EQ(s.asked("jog"), 1);
}

TEST(Commissioning, AnEmergencyStopIsReleasedAfterAQuestionAlone) {
  Session s;
  s.machine.estop = true;
  s.agrees = false;
  EXPECT_NE(s.stops().find("not agreed"), std::string::npos);
  EXPECT_TRUE(s.machine.estop);
  EXPECT_NE(s.said.back().find("Releases the emergency stop"), std::string::npos);
  s.agrees = true;
  EXPECT_EQ(s.stops(), "");
  EXPECT_EQ(s.asked("release"), 1);
}

// Programs went elsewhere by the work offset of the last part.
TEST(Commissioning, NothingMovesWhileOffsetsAreActive) {
  Session s;
  s.machine.offsets = "work offset X12.5";
  EXPECT_NE(s.stops().find("offsets are active (work offset X12.5)"), std::string::npos);
  EXPECT_EQ(s.asked("jog") + s.asked("on"), 0);
}

TEST(Commissioning, AnAxisThatDoesNotMoveIsSaid) {
  Session s;
  s.machine.stiffness = 2e9;
  s.machine.friction = 1e6;
  EXPECT_NE(s.stops().find("it did not move"), std::string::npos);
}

std::string with_weight(const std::string& brake, const std::string& load) {
  return std::string(kMachine) + load + "[axes.x.drive]\nbrake = " + brake + "\n";
}

// The axis fell by 35 mm in each of seven tries, and the stage said that it did not move.
TEST(Commissioning, AnAxisThatFallsIsNotTriedAgain) {
  Session s;
  s.options.machine = s.folder.write("machine.toml", with_weight("false", ""));
  s.machine.weight = 1000.0;
  const std::string why = s.stops();
  EXPECT_NE(why.find("axis x: it fell: it stands"), std::string::npos) << why;
  EXPECT_NE(why.find("mm to -x of where it was"), std::string::npos) << why;
  EXPECT_EQ(s.asked("on"), 1);
  EXPECT_FALSE(s.machine.on);
}

TEST(Commissioning, ABrakeWithoutAWeightIsRefusedBeforeAnythingMoves) {
  Session s;
  s.options.machine = s.folder.write("machine.toml", with_weight("true", ""));
  s.machine.weight = 1000.0;
  const std::string why = s.stops();
  EXPECT_NE(why.find("axes.x.commissioning.load"), std::string::npos) << why;
  EXPECT_EQ(s.asked("on") + s.asked("jog"), 0);
  s.options.machine = s.folder.write("machine.toml", with_weight("true", "load = \"0 N\"\n"));
  s.machine.weight = 0.0;
  EXPECT_EQ(s.stops(), "");
}

// A new configuration has no load in its controller yet.
TEST(Commissioning, TheLoadOfTheMachineFileIsCarriedWhileTheSignIsTried) {
  Session s;
  s.options.machine = s.folder.write("machine.toml", with_weight("true", "load = \"700 N\"\n"));
  s.machine.weight = 700.0;
  const auto before = s.machine.values;
  EXPECT_EQ(s.stops(), "");
  EXPECT_EQ(s.machine.values, before);
  // A file that says none leaves the controller its own.
  Session own;
  own.machine.weight = 700.0;
  own.machine.values["ax.x.load"] = "700";
  EXPECT_EQ(own.stops(), "");
}

TEST(Commissioning, NothingMovesWithoutConsent) {
  Session s;
  s.agrees = false;
  EXPECT_NE(s.stops().find("not agreed"), std::string::npos);
  EXPECT_TRUE(s.machine.log.empty() || s.asked("jog") + s.asked("on") + s.asked("home") == 0);
}

TEST(Commissioning, LimitsOfLinuxCncBeyondTheMachineAreRefused) {
  Session s;
  s.machine.keys["JOINT_0 MAX_LIMIT"] = {"60"};
  EXPECT_NE(s.stops().find("[JOINT_0]MAX_LIMIT is 60"), std::string::npos);
  EXPECT_EQ(s.asked("jog"), 0);
}

TEST(Commissioning, AnotherServoPeriodIsRefused) {
  Session s;
  s.machine.keys["EMCMOT SERVO_PERIOD"] = {"2000000"};
  EXPECT_NE(s.stops().find("SERVO_PERIOD is 2 ms"), std::string::npos);
}

TEST(Commissioning, HomesWhereItIsNotHomed) {
  Session s;
  s.machine.is_homed = false;
  s.go();
  EXPECT_EQ(s.asked("home"), 1);
}

TEST(Commissioning, MovesGrowThreefold) {
  Session s;
  s.go();
  s.options.stage = "moves";
  s.machine.log.clear();
  EXPECT_EQ(s.stops(), "");
  std::vector<double> distances;
  for (const std::string& line : s.machine.log) {
    if (line.starts_with("jog ") && std::stod(line.substr(4)) > 0.0)
      distances.push_back(std::stod(line.substr(4)));
  }
  ASSERT_GE(distances.size(), 5U);
  EXPECT_DOUBLE_EQ(distances.front(), 0.05);
  for (std::size_t i = 1; i < distances.size(); ++i) EXPECT_LE(distances[i], 3.001 * distances[i - 1]);
  EXPECT_LE(distances.back(), 15.001);
}

TEST(Commissioning, MovesStopAtAnObstacleAndAtAMessage) {
  Session s;
  s.go();
  s.options.stage = "moves";
  s.machine.blocked_at = 0.3e-3;
  EXPECT_NE(s.stops().find("axis x: "), std::string::npos);
  EXPECT_LT(s.machine.farthest, 0.31e-3);
  EXPECT_EQ(s.machine.values["ax.x.ferror-limit"], "1") << "given back";
  EXPECT_FALSE(s.done("moves"));

  Session other;
  other.go();
  other.options.stage = "moves";
  other.machine.message_after = "joint 0 following error";
  EXPECT_NE(other.stops().find("joint 0 following error"), std::string::npos);
  EXPECT_GE(other.asked("stop"), 1);
}

TEST(Commissioning, FrictionOfAnotherSizeThanTheFileSaysStopsIt) {
  Session s;
  s.machine.friction = 380.0;  // three times 120 N are 360 N, and the fake has viscous friction
  s.go();
  s.options.stage = "moves";
  EXPECT_NE(s.stops().find("The scale of the force or the machine file is wrong"), std::string::npos);
}

TEST(Commissioning, AStageNeedsThoseBeforeIt) {
  Session s;
  s.options.stage = "record";
  EXPECT_NE(s.stops().find("needs check first"), std::string::npos);
  EXPECT_TRUE(s.machine.log.empty() || s.asked("jog") == 0);
}

TEST(Commissioning, RecordAsksForEachMotionAndWritesALogOfEach) {
  Session s;
  s.go();
  s.options.stage = "moves";
  s.go();
  s.options.stage = "record";
  s.machine.log.clear();
  EXPECT_EQ(s.stops(), "");
  EXPECT_EQ(s.asked("run "), 3);
  for (const std::string name : {"x-constant-acceleration", "x-sine", "x-verify"}) {
    const std::string program = test::text_of(s.options.output + "/record/" + name + ".ngc");
    EXPECT_NE(program.find("X"), std::string::npos) << name;
    EXPECT_EQ(std::count_if(s.machine.log.begin(), s.machine.log.end(),
                            [&](const std::string& line) { return line.ends_with('/' + name + ".ngc"); }),
              1)
        << name;
    const std::string log = test::text_of(s.options.output + "/record/logs/" + name + ".csv");
    EXPECT_EQ(log.substr(0, log.find('\n')), "t [s],r [mm],x [mm],f [N]") << name;
    EXPECT_GT(std::count(log.begin(), log.end(), '\n'), 50) << name;
  }
  EXPECT_NE(test::text_of(s.options.output + "/record/result.json").find("x-verify.csv"), std::string::npos);
  // Without consent nothing runs.
  s.agrees = false;
  s.machine.log.clear();
  EXPECT_NE(s.stops(), "");
  EXPECT_EQ(s.asked("run "), 0);
}

TEST(Commissioning, ARecordThatIsBrokenIsNoLog) {
  Session s;
  s.go();
  s.options.stage = "moves";
  s.go();
  s.options.stage = "record";
  s.machine.broken_record = true;
  EXPECT_ANY_THROW(s.go());
  EXPECT_FALSE(s.done("record"));
}

// The fake machine does not run programs: its axis stands in all logs.
TEST(Commissioning, LogsOfAnAxisThatStandsGiveNoModel) {
  Session s;
  for (const char* stage : {"check", "moves", "record"}) {
    s.options.stage = stage;
    ASSERT_EQ(s.stops(), "") << stage;
  }
  s.options.stage = "identify";
  EXPECT_ANY_THROW(s.go());
  EXPECT_FALSE(s.done("identify/x.toml"));
  s.options.stage = "before";
  EXPECT_NE(s.stops().find("needs identify first"), std::string::npos);
}

TEST(Commissioning, NothingIsOnWhileForcesAreMadeWeak) {
  Session s;
  s.machine.on = true;
  s.go();
  EXPECT_EQ(s.machine.log.front(), "off");
}

TEST(Commissioning, UndoGivesBackFilesAndValues) {
  Session s;
  std::filesystem::create_directory(s.options.output);
  replace_files(s.options.output, {{s.options.ini, "changed"}});
  s.folder.write("out/changed-model.json", R"([{"name": "ax.x.omega", "before": "300", "now": "40"}])");
  s.machine.values["ax.x.omega"] = "40";
  s.machine.on = true;
  EXPECT_EQ(undo(&s.machine, s.options.output).size(), 2U);
  EXPECT_EQ(test::text_of(s.options.ini), "[HAL]\nHALFILE = mill.hal\n");
  EXPECT_EQ(s.machine.values["ax.x.omega"], "300");
  EXPECT_FALSE(s.machine.on);
  EXPECT_TRUE(undo(&s.machine, s.options.output).empty());
}

}  // namespace
}  // namespace stribeck::workflow::commissioning::commissioning_test
