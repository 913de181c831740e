#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <stribeck/io/file.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow::machine_file_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

const std::string kExamples = std::string(STRIBECK_SOURCE_DIR) + "/examples/own-machine/";

DriveData drive(const std::string& text) { return io::read_toml_text<DriveData>(text, "d.toml"); }

std::string problem(const std::string& text) {
  try {
    drive(text);
  } catch (const io::InputError& e) {
    return e.what();
  }
  return "accepted";
}

// 2.4 N m on 120 mm per turn: 2π·2.4/0.12 N.
TEST(DriveData, ForceFollowsFromTorqueAndTravelPerTurn) {
  const DriveData belt =
      drive("rated_torque = \"2.4 N m\"\ntravel_per_turn = \"120 mm\"\ntorque_limit = \"300 %\"");
  EXPECT_NEAR(*belt.rated(), 2.0 * kPi * 2.4 / 0.12, 1e-9);
  EXPECT_NEAR(*belt.peak(), 3.0 * *belt.rated(), 1e-9);
  const DriveData pulley = drive("rated_torque = \"2.4 N m\"\npulley_diameter = \"40 mm\"");
  EXPECT_NEAR(*pulley.rated(), 2.4 / 0.02, 1e-9);
  EXPECT_FALSE(pulley.peak().has_value());
}

TEST(DriveData, GearsMotorsAndCurrentsMultiply) {
  const DriveData one = drive("rated_torque = \"1 N m\"\nlead = \"10 mm\"");
  EXPECT_NEAR(*drive("rated_torque = \"1 N m\"\nlead = \"10 mm\"\ngear = 3").rated(), 3.0 * *one.rated(),
              1e-9);
  EXPECT_NEAR(*drive("rated_torque = \"1 N m\"\nlead = \"10 mm\"\nmotors = 2").rated(), 2.0 * *one.rated(),
              1e-9);
  EXPECT_NEAR(*drive("torque_constant = \"0.5 N m/A\"\nrated_current = \"2 A\"\nlead = \"10 mm\"").rated(),
              *one.rated(), 1e-9);
  // Enough for logs in amperes.
  const DriveData constant = drive("torque_constant = \"0.5 N m/A\"\nlead = \"10 mm\"");
  EXPECT_FALSE(constant.rated().has_value());
  EXPECT_NEAR(*constant.per_ampere(), 0.5 * 2.0 * kPi / 0.01, 1e-9);
  EXPECT_NEAR(*drive("force_constant = \"50 N/A\"\nrated_current = \"6 A\"\npeak_force = \"900 N\"").peak(),
              900.0, 1e-9);
}

// The peak current was left out beside a rated torque: 1885 N, "the file says no peak", in place of 5655 N.
TEST(DriveData, APeakCurrentGivesThePeakThroughTheRatedValues) {
  const DriveData d =
      drive("rated_torque = \"3 N m\"\nrated_current = \"5 A\"\npeak_current = \"15 A\"\nlead = \"10 mm\"");
  EXPECT_NEAR(*d.peak(), 9.0 * 2.0 * kPi / 0.01, 1e-9);
  EXPECT_THAT(
      problem("rated_torque = \"3 N m\"\nrated_current = \"5 A\"\npeak_current = \"4 A\"\nlead = \"10 mm\""),
      HasSubstr("below the rated value"));
}

// Twice the constant is twice the mass, with an interval of 0.2 %.
TEST(DriveData, AConstantThatContradictsTheRatedValuesIsSaid) {
  const std::string rated = "rated_torque = \"3 N m\"\nrated_current = \"5 A\"\nlead = \"10 mm\"\n";
  EXPECT_THAT(drive(rated + "torque_constant = \"1.2 N m/A\"").constant_doubt(),
              HasSubstr("rated_torque over rated_current is 0.6 N m/A, and torque_constant 1.2 N m/A"));
  EXPECT_EQ(drive(rated + "torque_constant = \"0.66 N m/A\"").constant_doubt(), "");
  EXPECT_EQ(drive(rated).constant_doubt(), "");
}

TEST(DriveData, TellsMassSpeedAndStepOfTheMotor) {
  const DriveData d = drive(
      "rated_torque = \"1 N m\"\nlead = \"10 mm\"\nrotor_inertia = \"1e-4 kg m2\"\nmotor_speed = \"3000 rpm\"\n"
      "encoder_counts = 10000");
  EXPECT_NEAR(*d.reflected_mass(), 1e-4 * std::pow(2.0 * kPi / 0.01, 2), 1e-9);
  EXPECT_NEAR(*d.top_speed(), 0.5, 1e-9);
  EXPECT_NEAR(*d.resolution(), 1e-6, 1e-15);
}

TEST(DriveData, RefusesWhatContradictsItself) {
  EXPECT_THAT(problem("rated_torque = \"1 N m\""), HasSubstr("needs the travel per turn"));
  EXPECT_THAT(problem("rated_torque = \"1 N m\"\nlead = \"5 mm\"\npulley_diameter = \"5 mm\""),
              HasSubstr("expected one of them"));
  EXPECT_THAT(problem("rated_force = \"1 N\"\nlead = \"5 mm\""), HasSubstr("a linear motor has no lead"));
  EXPECT_THAT(problem("rated_force = \"1 N\"\ngear = 3"),
              HasSubstr("has no effect without the travel per turn"));
  EXPECT_THAT(problem("lead = \"5 mm\""), HasSubstr("missing, expected rated_torque or rated_force"));
  EXPECT_THAT(problem("rated_torque = \"2 N m\"\npeak_torque = \"1 N m\"\nlead = \"5 mm\""),
              HasSubstr("below the rated value"));
}

TEST(RoughAxis, IsOneValueOrARange) {
  const auto read = [](const std::string& mass) {
    return io::read_toml_text<RoughAxis>("friction = \"40 N\"\nmass = " + mass, "a.toml");
  };
  const RoughAxis one = read("\"45 kg\"");
  EXPECT_EQ(one.mass.middle(), 45.0);
  EXPECT_EQ(one.mass.low(), 15.0);
  EXPECT_EQ(one.mass.high(), 135.0);
  const RoughAxis range = read("[\"30 kg\", \"60 kg\"]");
  EXPECT_EQ(range.mass.middle(), 45.0);
  EXPECT_EQ(range.mass.low(), 30.0);
  EXPECT_EQ(range.mass.high(), 60.0);
  EXPECT_THAT([&] { read("[\"60 kg\", \"30 kg\"]"); },
              ThrowsMessage<io::InputError>(HasSubstr("the smaller value first")));
  EXPECT_THAT([&] { read("[]"); },
              ThrowsMessage<io::InputError>(HasSubstr("got a list of 0, expected 1 to 2")));
  EXPECT_THAT([&] { read("[\"1 kg\", \"2 kg\", \"3 kg\"]"); },
              ThrowsMessage<io::InputError>(HasSubstr("got a list of 3, expected 1 to 2")));
  EXPECT_THAT([&] { read("45"); }, ThrowsMessage<io::InputError>(HasSubstr("missing unit")));
}

TEST(RoughAxis, PolesMayBeGivenInEveryUnitForThem) {
  const auto a = io::read_toml_text<RoughAxis>(
      "mass = \"45 kg\"\nfriction = \"40 N\"\nomega = \"10 Hz\"\nobserver_pole = \"20 rad/s\"", "a.toml");
  EXPECT_NEAR(*a.omega, 20.0 * kPi, 1e-12);
  EXPECT_EQ(*a.observer_pole, 20.0);
}

TEST(MachineFile, ARealMachineHasNoTruth) {
  const MachineDescription m = read_description(kExamples + "gantry.toml");
  ASSERT_EQ(m.axes.size(), 3U);
  const AxisDescription& x = m.axes[0].second;
  EXPECT_FALSE(x.plant.has_value());
  EXPECT_NEAR(x.force_limit(), 3.0 * 2.0 * kPi * 2.4 / 0.12, 1e-9);
  EXPECT_EQ(x.name_plate().encoder_resolution, 1e-6);
  EXPECT_THAT([] { read_virtual_machine(kExamples + "gantry.toml"); },
              ThrowsMessage<io::InputError>(HasSubstr("axes.x.plant: missing, expected the truth")));
}

// A geared servo press: two rotors of 0.012 kg m2 at a screw of 10 mm behind a gear of 5 weigh 2·0.012·(2π·5/0.01)² kg.
TEST(MachineFile, ATableWithoutItsRotorIsRefused) {
  const auto read = [](const std::string& mass) {
    return io::read_toml_text<AxisDescription>(
        "limits = { travel_min = \"0 mm\", travel_max = \"300 mm\", speed = \"20 mm/s\", acceleration = \"50 mm/s2\" }\n"
        "commissioning = { mass = \"" +
            mass +
            "\", friction = \"4000 N\" }\n"
            "drive = { rated_torque = \"18 N m\", lead = \"10 mm\", gear = 5, motors = 2, rotor_inertia = \"0.012 kg m2\" }\n",
        "press.toml");
  };
  EXPECT_THAT([&] { read("3 t"); },
              ThrowsMessage<io::InputError>(AllOf(HasSubstr("commissioning.mass"),
                                                  HasSubstr("less than the rotor alone, 2.369e+05 kg"),
                                                  HasSubstr("with the table 2.399e+05 kg"))));
  EXPECT_EQ(read("240 t").commissioning.mass.middle(), 240e3);
}

// What the shipped files say is what the simulation gets, to the last bit.
TEST(MachineFile, AVirtualMachineIsWhatItsFileSays) {
  const std::string file = std::string(STRIBECK_SOURCE_DIR) + "/machines/biaxial-table.toml";
  const sim::Machine read = read_virtual_machine(file);
  const auto direct = io::read_toml<sim::Machine>(file);
  EXPECT_EQ(io::write_toml(read), io::write_toml(direct));
}

// ω is the least of what period, encoder and elasticity allow.
TEST(MachineFile, ProposesALoopFromTheNumbers) {
  const MachineDescription m = read_description(kExamples + "gantry.toml");
  const Proposal y = propose(m.axes[1].second, m.sample_time);
  // 0.15·F·T/(2·m·q) = 0.15·30·1e-3/(2·25·1e-6).
  EXPECT_NEAR(y.omega.value, std::min(0.15 * 30.0 * 1e-3 / (2.0 * 25.0 * 1e-6), 80.0), 1e-9);
  EXPECT_EQ(y.observer_pole.value, 0.5 * y.omega.value);
  EXPECT_EQ(y.sine_offset.value, 0.0);
  const double top = y.sine_amplitude.value * y.sine_frequency.value;
  EXPECT_LE(top, 0.9 * 0.5 + 1e-12);
  EXPECT_LE(top * y.sine_frequency.value, 0.5 * 2.0 + 1e-12);
}

TEST(MachineFile, IsExplainedInDerivedNumbers) {
  const MachineDescription m = read_description(kExamples + "gantry.toml");
  const ExplainedAxis z = explain(m, 2);
  EXPECT_NEAR(z.numbers["force_at_100_percent_N"].get<double>(), 2.0 * kPi * 1.3 / 0.01, 1e-9);
  EXPECT_TRUE(z.numbers["may_fall"].get<bool>());
  EXPECT_FALSE(explain(m, 0).numbers["may_fall"].get<bool>());
  EXPECT_THAT(z.drawing, HasSubstr("screw 10 mm"));
  ASSERT_FALSE(z.lacks.empty());
  EXPECT_THAT(z.lacks.front(), HasSubstr("simulate, compare, tune"));
}

TEST(MachineFile, ADraftCanBeReadOnceItIsFilledIn) {
  MachineDraft draft{"gantry", "1 ms", {"x"}, {}};
  EXPECT_EQ(open_keys(draft).size(), 6U);
  EXPECT_THAT(draft_text(draft), HasSubstr("# FILL IN: mass = \"45 kg\""));
  for (const Asked& a : asked_keys()) {
    const std::string key = "x." + std::string(a.group) + '.' + std::string(a.key);
    if (a.key == "rated_force" || a.key == "travel_per_turn") continue;
    check_value(draft, "--set", key, std::string(a.example));
    draft.values.emplace_back(key, a.example);
  }
  EXPECT_TRUE(open_keys(draft).empty());
  const auto read = io::read_toml_text<MachineDescription>(draft_text(draft), "draft.toml");
  EXPECT_EQ(read.axes.front().second.limits.speed, 0.5);
  EXPECT_TRUE(read.axes.front().second.drive->brake);
  EXPECT_EQ(*read.axes.front().second.drive->torque_limit, 3.0);
}

TEST(MachineFile, AValueThatNoFileCouldHoldIsRefused) {
  const MachineDraft draft{"gantry", "1 ms", {"x"}, {}};
  const auto refused = [&](const std::string& key, const std::string& value) -> std::string {
    try {
      check_value(draft, "--set", key, value);
    } catch (const io::InputError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refused("x.limits.sped", "1 mm/s"), HasSubstr("x.limits.speed"));
  EXPECT_THAT(refused("x.limits.speed", "1 kg"), HasSubstr("expected a unit like mm/s"));
  EXPECT_THAT(refused("x.commissioning.mass", "-4 kg"), HasSubstr("above 0"));
  EXPECT_EQ(refused("x.commissioning.mass", "[\"4 kg\", \"5 kg\"]"), "accepted");
}

// Every key of the groups that init writes, not only those that it asks for.
TEST(MachineFile, ADraftTakesEveryKeyOfTheFile) {
  MachineDraft draft{"m", "2 ms", {"z"}, {}};
  for (const auto& [key, value] :
       std::vector<std::pair<std::string, std::string>>{{"z.limits.travel_min", "-100 mm"},
                                                        {"z.limits.travel_max", "100 mm"},
                                                        {"z.limits.speed", "10 m/min"},
                                                        {"z.limits.acceleration", "2 m/s2"},
                                                        {"z.limits.jerk", "50 m/s3"},
                                                        {"z.drive.torque_constant", "0.5 N m/A"},
                                                        {"z.drive.rated_current", "2 A"},
                                                        {"z.drive.peak_torque", "3 N m"},
                                                        {"z.drive.pulley_diameter", "40 mm"},
                                                        {"z.drive.encoder_counts", "65536"},
                                                        {"z.drive.rotor_inertia", "1e-4 kg m2"},
                                                        {"z.drive_loop.mode", "position"},
                                                        {"z.drive_loop.gain", "60 N s/m"},
                                                        {"z.drive_loop.position_gain", "2.5 (m/min)/mm"},
                                                        {"z.drive_loop.velocity_feedforward", "0"},
                                                        {"z.commissioning.mass", "45 kg"},
                                                        {"z.commissioning.friction", "40 N"},
                                                        {"z.commissioning.omega", "30 rad/s"}}) {
    check_value(draft, "--set", key, value);
    draft.values.emplace_back(key, value);
  }
  const auto read = io::read_toml_text<MachineDescription>(draft_text(draft), "m.toml");
  const AxisDescription& z = read.axes.front().second;
  EXPECT_EQ(*z.drive->encoder_counts, 65536);
  EXPECT_NEAR(*z.drive->rated(), 1.0 / 0.02, 1e-9);
  EXPECT_NEAR(*z.limits.jerk, 50.0, 1e-12);
  ASSERT_TRUE(z.drive_loop.has_value());
  EXPECT_EQ(z.drive_loop->mode, friction::DriveMode::kPosition);
  EXPECT_NEAR(z.drive_loop->gain, 60.0, 1e-12);
  EXPECT_NEAR(*z.commissioning.omega, 30.0, 1e-12);
  // What is left out stands as a comment only where init asks for it.
  EXPECT_THAT(draft_text({"m", "2 ms", {"z"}, {}}), Not(HasSubstr("encoder_counts = ")));
  EXPECT_THAT([&] { check_value(draft, "--set", "z.drive.torque", "1 N m"); },
              ThrowsMessage<io::InputError>(
                  AllOf(HasSubstr("expected a key of drive: rated_torque, "), HasSubstr("encoder_counts"))));
  EXPECT_THAT([&] { check_value(draft, "--set", "w.drive.gear", "1"); },
              ThrowsMessage<io::InputError>(HasSubstr("with one of the axes of --axes")));
}

// An axis of which nothing is known does not keep the others from moving, where that is wanted.
TEST(MachineFile, AnAxisWithoutATruthIsRefusedOrLeftOut) {
  const MachineDescription description = read_description(kExamples + "gantry-virtual.toml");
  const test::Folder folder;
  // The same without the plant of y.
  std::string text = io::read_text(kExamples + "gantry-virtual.toml");
  const auto plant = text.find("[axes.y.plant");
  ASSERT_NE(plant, std::string::npos);
  const auto next = text.find("[axes.z", plant);
  ASSERT_NE(next, std::string::npos);
  const std::string file = folder.write("m.toml", text.substr(0, plant) + text.substr(next));
  EXPECT_THAT([&] { read_virtual_machine(file); },
              ThrowsMessage<io::InputError>(HasSubstr("axes.y.plant: missing")));
  const sim::Machine machine = read_virtual_machine(file, {}, AxisWithoutTruth::kLeftOut);
  ASSERT_EQ(machine.axes.size(), 2U);
  EXPECT_EQ(machine.axes[0].first, "x");
  EXPECT_EQ(machine.axes[1].first, "z");
  EXPECT_GT(machine.axes[1].second.plant.mass, 0.0);
  EXPECT_THAT(machine.left_out, ::testing::ElementsAre("y"));
  EXPECT_THAT([&] { axis_index(machine, file, "y"); },
              ThrowsMessage<io::InputError>(HasSubstr("axes.y.plant: missing")));
  EXPECT_THAT([&] { read_virtual_machine(kExamples + "gantry.toml", {}, AxisWithoutTruth::kLeftOut); },
              ThrowsMessage<io::InputError>(HasSubstr("axes.x.plant: missing")));
  EXPECT_THAT([&] { read_virtual_machine(kExamples + "gantry.toml", {"q=q.toml"}); },
              ThrowsMessage<io::InputError>(HasSubstr("no axis \"q\", the machine has x, y, z")));
}

TEST(MachineFile, ARotaryAxisTakesAnglesTorquesAndInertias) {
  const MachineDescription m = read_description(kExamples + "rotary-table.toml");
  const AxisDescription& c = m.axes.front().second;
  EXPECT_NEAR(c.limits.travel_max, 170.0 * kPi / 180.0, 1e-12);
  EXPECT_NEAR(c.limits.speed, 20.0 * 2.0 * kPi / 60.0, 1e-12);
  EXPECT_NEAR(c.limits.acceleration, 500.0 * kPi / 180.0, 1e-12);
  EXPECT_NEAR(*c.drive->rated(), 2.4 * 90.0, 1e-9);  // at the table
  EXPECT_NEAR(*c.drive->reflected_mass(), 2.1e-4 * 90.0 * 90.0, 1e-9);
  EXPECT_EQ(c.commissioning.mass.middle(), 4.5);
  EXPECT_EQ(c.commissioning.friction.middle(), 30.0);
  EXPECT_NEAR(*c.commissioning.encoder_resolution, 1e-4 * kPi / 180.0, 1e-15);
  const ExplainedAxis said = explain(m, 0);
  EXPECT_THAT(said.drawing, AllOf(HasSubstr("table c, 4.5 kg m2"), HasSubstr("-170 deg … 170 deg")));
  EXPECT_THAT(said.lines[1].value, HasSubstr("-170 deg to 170 deg"));
  EXPECT_THAT(said.lines[2].value, HasSubstr("120 deg/s"));
  EXPECT_THAT(said.lines[2].note, HasSubstr("20 rpm"));
}

TEST(MachineFile, AnglesWithoutARotaryAxisAreRefusedWithTheWayOut) {
  const std::string text =
      "name = \"m\"\nsample_time = \"1 ms\"\n[axes.c.limits]\ntravel_min = \"-170 deg\"\n";
  EXPECT_THAT([&] { parse_description(text, "m.toml"); },
              ThrowsMessage<io::InputError>(AllOf(HasSubstr("m.toml:4: axes.c.limits.travel_min"),
                                                  HasSubstr("write rotary = true below [axes.c]"))));
  // Below rotary = true lengths are refused, and a wrong kind of that key is said by the reader.
  const auto refused = [](const std::string& what, const std::string& by) {
    std::string file = io::read_text(kExamples + "rotary-table.toml");
    file.replace(file.find(what), what.size(), by);
    try {
      parse_description(file, "m.toml");
    } catch (const io::InputError& e) {
      return e.problems().front().text();
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refused("170 deg\"\nspeed", "170 mm\"\nspeed"),
              HasSubstr("axes.c.limits.travel_max: got \"170 mm\", expected a unit like deg"));
  EXPECT_THAT(refused("travel_max = \"170 deg\"", ""),
              HasSubstr("write travel_max = \"5 deg\", with your value"));
  EXPECT_THAT(refused("\nrotary = true", "\nrotary = \"true\""),
              HasSubstr("axes.c.rotary: got \"true\", expected true or false"));
  EXPECT_THAT(refused("gear = 90", "gear = 90\npulley_diameter = \"60 mm\""),
              HasSubstr("a rotary axis has none"));
  // A force of a linear axis stays a force.
  EXPECT_THAT([] { io::read_toml_text<RoughAxis>("mass = \"4 kg\"\nfriction = \"3 N m\"", "m.toml"); },
              ThrowsMessage<io::InputError>(HasSubstr("another kind of quantity")));
}

TEST(MachineFile, ADraftOfARotaryAxisCanBeRead) {
  MachineDraft draft{"table", "1 ms", {"x", "c"}, {}};
  EXPECT_FALSE(draft.rotary("c"));
  for (const Asked& a : asked_keys()) {
    if (a.key == "rated_force" || a.key == "travel_per_turn") continue;
    for (const std::string axis : {"x", "c"}) {
      const std::string key = fmt::format("{}.{}.{}", axis, a.group, a.key);
      const std::string_view value = axis == "c" && !a.rotary_example.empty() ? a.rotary_example : a.example;
      check_value(draft, "--set", key, std::string(value));
      draft.values.emplace_back(key, value);
    }
  }
  EXPECT_TRUE(draft.rotary("c"));
  EXPECT_FALSE(draft.rotary("x"));
  const MachineDescription read = parse_description(draft_text(draft), "draft.toml");
  EXPECT_FALSE(read.axes[0].second.rotary);
  EXPECT_TRUE(read.axes[1].second.rotary);
  EXPECT_NEAR(read.axes[1].second.limits.travel_max, kPi, 1e-12);
  EXPECT_EQ(read.axes[1].second.commissioning.load_force(), 5.0);
}

// One typing error must not make a rotary axis of a linear one.
TEST(MachineFile, ADraftRefusesAValueOfTheOtherKindOfAxis) {
  MachineDraft draft{"m", "1 ms", {"x"}, {{"x.limits.travel_max", "600 mm"}, {"x.drive.gear", "3"}}};
  EXPECT_THAT([&] { check_value(draft, "--set", "x.commissioning.friction", "40 N m"); },
              ThrowsMessage<io::InputError>(AllOf(HasSubstr("x.commissioning.friction: got \"40 N m\""),
                                                  HasSubstr("x.limits.travel_max = \"600 mm\""))));
  check_value(draft, "--set", "x.commissioning.friction", "40 N");
}

TEST(MachineFile, AnIdentifiedMassMayContradictIt) {
  AxisDescription a;
  a.commissioning.mass = Rough(38.0, 45.0);
  EXPECT_THAT(mass_contradiction(a, 48.6, 49.9), HasSubstr("which allows 38 to 45 kg"));
  EXPECT_EQ(mass_contradiction(a, 44.0, 49.9), "");
  EXPECT_EQ(mass_contradiction(a, kNaN, kNaN), "");
  a.commissioning.mass = Rough(45.0);  // a guess: a factor of three either way
  EXPECT_EQ(mass_contradiction(a, 48.6, 49.9), "");
  EXPECT_THAT(mass_contradiction(a, 1.2, 2.7), HasSubstr("contradicts the machine file"));
}

TEST(MachineFile, AVirtualMachineThatIsWrittenCanBeRead) {
  const test::Folder folder;
  const std::string written = folder / "machine.toml";
  for (const std::string name : {"gantry-virtual", "rotary-table-virtual", "trunnion-virtual"}) {
    const sim::Machine machine = read_virtual_machine(kExamples + name + ".toml");
    io::write_atomically(written, machine_text(machine, name));
    const sim::Machine again = read_virtual_machine(written);
    ASSERT_EQ(again.axes.size(), machine.axes.size()) << name;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      const sim::MachineAxis& before = machine.axes[i].second;
      const sim::MachineAxis& after = again.axes[i].second;
      EXPECT_EQ(after.rotary, before.rotary) << name;
      EXPECT_NEAR(after.plant.mass / before.plant.mass, 1.0, 1e-12) << name;
      EXPECT_NEAR(after.limits.travel_max / before.limits.travel_max, 1.0, 1e-12) << name;
      EXPECT_NEAR(after.plant.force_gain() / before.plant.force_gain(), 1.0, 1e-12) << name;
      EXPECT_EQ(after.plant.unbalance.has_value(), before.plant.unbalance.has_value()) << name;
    }
  }
}

TEST(MachineFile, AMassBelowThatOfTheRotorIsAWrongScale) {
  AxisDescription a;
  a.commissioning.mass = Rough(2200.0);
  a.drive.emplace();
  a.drive->lead = 5e-3;
  a.drive->rotor_inertia = 1.2e-3;  // 1895 kg behind a screw of 5 mm
  EXPECT_THAT(mass_contradiction(a, 1121.0, 1126.0), HasSubstr("less than that of the rotor alone, 1895 kg"));
  EXPECT_EQ(mass_contradiction(a, 2240.0, 2250.0), "");
}

TEST(MachineFile, ALogThatMovesFartherThanTheAxisContradictsIt) {
  AxisDescription a;
  a.limits.travel_min = -10e-3;
  a.limits.travel_max = 160e-3;
  ident::log::Record log;
  log.x = {36.7e-3, 263.3e-3};
  EXPECT_THAT(travel_contradiction(a, {log}), HasSubstr("moves over 226.6 mm"));
  log.x = {100e-3, 265e-3};  // another zero is none
  EXPECT_EQ(travel_contradiction(a, {log}), "");
  EXPECT_EQ(travel_contradiction(a, {}), "");
  log.x = {0.0, 9.0};
  a.rotary = true;
  a.limits.travel_min = -4.0;
  a.limits.travel_max = 4.0;
  EXPECT_EQ(travel_contradiction(a, {log}), "") << "turns are counted on";
  a.limits.travel_min = -1.0;
  a.limits.travel_max = 1.0;
  EXPECT_THAT(travel_contradiction(a, {log}), HasSubstr("moves over 515.7 deg")) << "behind a gear";
}

TEST(MachineFile, ALogThatMovesFasterThanTheAxisContradictsIt) {
  AxisDescription a;
  a.limits.speed = 0.6;
  ident::log::Record log;
  log.sample_time = 1e-3;
  for (int k = 0; k < 200; ++k) {
    log.t.push_back(1e-3 * k);
    log.x.push_back(1e-3 * k);  // 1 m/s
  }
  EXPECT_THAT(speed_contradiction(a, {log}),
              HasSubstr("moves at up to 1000 mm/s, and the machine file allows 600"));
  a.limits.speed = 0.9;
  EXPECT_EQ(speed_contradiction(a, {log}), "");
  // A jump of the zero is no speed.
  a.limits.speed = 1.5;
  for (int k = 100; k < 200; ++k) log.x[static_cast<std::size_t>(k)] += 2.0;
  EXPECT_EQ(speed_contradiction(a, {log}), "");
}

TEST(MachineFile, ALoadThatTheFileDoesNotKnowIsSaid) {
  AxisDescription a;
  a.commissioning.friction = Rough(300.0, 520.0);
  EXPECT_THAT(load_contradiction(a, 1526.0), HasSubstr("the machine file says none"));
  EXPECT_EQ(load_contradiction(a, 200.0), "") << "friction that differs by direction";
  a.commissioning.load = Rough(-1526.0);
  EXPECT_THAT(load_contradiction(a, 1526.0), HasSubstr("says one of -1526 N"));
  EXPECT_EQ(load_contradiction(a, -1500.0), "");
}

TEST(MachineFile, FrictionThatTheFileDoesNotAllowIsSaid) {
  AxisDescription a;
  a.commissioning.friction = Rough(100.0, 300.0);
  ident::Result r;
  r.force_unit = "N";
  const auto with = [&](double coulomb, double highest) {
    r.parameters = {{"coulomb_positive", coulomb, "N", "N"},
                    {"coulomb_negative", -coulomb, "N", "N"},
                    {"static_negative", -highest, "N", "N"}};
    return friction_unlike_file(a, r);
  };
  EXPECT_THAT(with(12.0, 15.0), HasSubstr("12 to 15 N, is not what the machine file allows, 100 to 300 N"));
  EXPECT_THAT(with(310.0, 400.0), HasSubstr("310 to 400 N"));
  EXPECT_EQ(with(80.0, 120.0), "");
  EXPECT_EQ(with(290.0, 400.0), "");
  a.commissioning.friction = Rough(100.0);  // a third to three times
  EXPECT_EQ(with(290.0, 290.0), "");
  EXPECT_NE(with(320.0, 320.0), "");
  r.force_unit = "A";
  EXPECT_EQ(with(12.0, 15.0), "");
}

TEST(MachineFile, AMassAboveThatOfTheFileMayBeTheRotor) {
  AxisDescription a;
  a.commissioning.mass = Rough(4.0, 6.0);
  a.drive.emplace();
  a.drive->lead = 5e-3;
  EXPECT_THAT(mass_contradiction(a, 80.9, 81.3),
              HasSubstr("the rotor of the motor, which would have 4.8e-05 kg m2"));
  EXPECT_THAT(mass_contradiction(a, 1.0, 1.1), testing::Not(HasSubstr("rotor")));
}

std::string trunnion(const std::string& known, const std::string& brake = "false") {
  return R"(name = "t"
sample_time = "1 ms"
[axes.a]
rotary = true
[axes.a.limits]
travel_min = "-110 deg"
travel_max = "30 deg"
speed = "15 rpm"
acceleration = "300 deg/s2"
[axes.a.drive]
rated_torque = "4.8 N m"
gear = 120
brake = )" +
         brake + "\n[axes.a.commissioning]\nmass = \"11 kg m2\"\nfriction = \"60 N m\"\n" + known + "\n";
}

TEST(MachineFile, AnUnbalanceIsATorqueOrAMassAtADistance) {
  const auto known = [](const std::string& text) {
    return parse_description(trunnion(text), "t.toml").axes.front().second.commissioning.unbalance;
  };
  const auto torque = known(R"(unbalance = { torque = "110 N m", hangs_at = "10 deg" })");
  ASSERT_TRUE(torque);
  EXPECT_EQ(torque->middle(), 110.0);
  EXPECT_EQ(torque->high(), 330.0);  // one value may be wrong by a factor of three
  EXPECT_NEAR(*torque->hangs_at, kPi / 18.0, 1e-12);
  const auto mass = known(R"(unbalance = { mass = ["20 kg", "30 kg"], distance = "450 mm" })");
  ASSERT_TRUE(mass);
  EXPECT_NEAR(mass->high(), 30.0 * 9.80665 * 0.45, 1e-9);
  EXPECT_FALSE(mass->hangs_at.has_value());
  const auto refuses = [](const std::string& text) { parse_description(text, "t.toml"); };
  EXPECT_THAT([&] { refuses(trunnion(R"(unbalance = { mass = "20 kg" })")); },
              ThrowsMessage<io::InputError>(HasSubstr("distance = \"450 mm\"")));
  EXPECT_THAT([&] { refuses(trunnion(R"(unbalance = { hangs_at = "3 deg" })")); },
              ThrowsMessage<io::InputError>(HasSubstr("expected torque, or mass with distance")));
}

TEST(MachineFile, AnUnbalanceBelongsToAnAxisThatTurns) {
  std::string text = io::read_text(kExamples + "gantry.toml");
  const auto at = text.find("[axes.x.commissioning]");
  ASSERT_NE(at, std::string::npos);
  text.insert(text.find('\n', at) + 1, "unbalance = { torque = \"5 N m\" }\n");
  EXPECT_THAT([&] { parse_description(text, "g.toml"); },
              ThrowsMessage<io::InputError>(HasSubstr("write rotary = true, or load")));
}

TEST(MachineFile, ALoadMayBeARange) {
  const auto known = [](const std::string& load) {
    return io::read_toml_text<RoughAxis>("mass = \"40 kg\"\nfriction = \"30 N\"\nload = " + load, "m.toml");
  };
  const RoughAxis range = known(R"(["120 N", "300 N"])");
  EXPECT_DOUBLE_EQ(range.load_force(), 210.0);
  EXPECT_DOUBLE_EQ(range.load_spread(), 90.0);
  EXPECT_DOUBLE_EQ(known(R"("-176 N")").load_force(), -176.0);
  EXPECT_DOUBLE_EQ(known(R"("-176 N")").load_spread(), 0.0);
  EXPECT_DOUBLE_EQ(known(R"(["-20 N", "20 N"])").load_spread(), 20.0);
  EXPECT_THAT([&] { known(R"(["300 N", "120 N"])"); },
              ThrowsMessage<io::InputError>(HasSubstr("smaller value first")));
}

TEST(MachineFile, ABrakeWithoutAWeightIsAQuestion) {
  const auto axis = [](const std::string& known, const char* brake) {
    return parse_description(trunnion(known, brake), "t.toml").axes.front().second;
  };
  EXPECT_TRUE(axis("", "true").weight_unsaid());
  EXPECT_FALSE(axis("", "false").weight_unsaid());
  EXPECT_FALSE(axis("load = \"0 N m\"", "true").weight_unsaid());
  EXPECT_FALSE(axis("unbalance = { torque = \"110 N m\" }", "true").weight_unsaid());
}

TEST(MachineFile, LimitsHaveOrdersOfMagnitude) {
  const auto refuses = [](const std::string& from, const std::string& to) {
    std::string text = trunnion("");
    text.replace(text.find(from), from.size(), to);
    return [text] { parse_description(text, "t.toml"); };
  };
  EXPECT_THAT(refuses("\"15 rpm\"", "\"1e300 rpm\""),
              ThrowsMessage<io::InputError>(AllOf(HasSubstr("1e300 rpm"), HasSubstr("at most"))));
  EXPECT_THAT(refuses("\"300 deg/s2\"", "\"1e30 deg/s2\""),
              ThrowsMessage<io::InputError>(HasSubstr("axes.a.limits.acceleration")));
}

// A printer: 10 µm, 1.1 kg, 5 N over 220 mm. By the encoder alone the loop would be at 34 rad/s, where friction holds the axis
// 3.9 mm off.
TEST(MachineFile, ALightAxisGetsALoopThatHoldsItAgainstFriction) {
  AxisDescription a;
  a.limits = {0.0, 0.22, 0.3, 5.0, {}, 60.0};
  a.commissioning.mass = 1.1;
  a.commissioning.friction = 5.0;
  a.commissioning.encoder_resolution = 10e-6;
  const Proposed omega = propose(a, 1e-3).omega;
  EXPECT_NEAR(omega.value, std::sqrt(5.0 / (1.1 * 1.1e-3)), 1e-9);
  EXPECT_THAT(omega.reason, HasSubstr("friction alone would hold the axis more than 1.1 mm off"));
  // A heavy axis with a fine encoder keeps what that allows.
  a.commissioning.mass = 100.0;
  a.commissioning.friction = 60.0;
  a.commissioning.encoder_resolution = 1e-6;
  EXPECT_NEAR(propose(a, 1e-3).omega.value, 0.15 * 60.0 * 1e-3 / (2.0 * 100.0 * 1e-6), 1e-9);
}

TEST(MachineFile, ALogWithMoreForceThanTheDriveMakesIsSaidToBeADemand) {
  AxisDescription a;
  a.limits = {0.0, 1.0, 1.0, 5.0, {}, 1100.0};
  ident::log::Record r;
  r.force_unit = "N";
  r.f = {100.0, -1150.0, 900.0};
  EXPECT_EQ(force_contradiction(a, {r}), "");
  r.f[2] = -5000.0;
  EXPECT_EQ(force_contradiction(a, {r}), "");  // one spike
  r.f.insert(r.f.end(), {2000.0, 3000.0});
  EXPECT_THAT(force_contradiction(a, {r}),
              HasSubstr("goes up to 5000 N, and the drive makes at most 1100 N (3 of 5 rows are beyond it)"));
  r.force_unit = "A";
  EXPECT_EQ(force_contradiction(a, {r}), "");
  // A servo drive makes more than its rated force for a short time; a file with that alone says no most.
  r.force_unit = "N";
  a.limits.force.reset();
  a.drive = drive("rated_torque = \"3 N m\"\nlead = \"10 mm\"");
  EXPECT_EQ(force_contradiction(a, {r}), "");
  a.drive = drive("rated_torque = \"0.5 N m\"\nlead = \"10 mm\"");
  EXPECT_THAT(
      force_contradiction(a, {r}),
      HasSubstr("goes up to 5000 N, and the drive makes hardly more than five times its rated 314.2 N"));
}

// A faster control is no reason for a slower loop: a step of the force that lasts 125 us moves an axis as an eighth of it over 1 ms does.
TEST(MachineFile, AShortPeriodLeavesTheLoopAsFast) {
  AxisDescription a;
  a.limits = {0.0, 1.0, 1.0, 5.0, {}, 2000.0};
  a.commissioning.mass = 100.0;
  a.commissioning.friction = 60.0;
  a.commissioning.encoder_resolution = 1e-6;
  const Proposed omega = propose(a, 125e-6).omega;
  EXPECT_NEAR(omega.value, 45.0, 1e-9);
  EXPECT_THAT(omega.reason, HasSubstr("more than 15 % of the friction, as a mean over 1 ms"));
  EXPECT_NEAR(propose(a, 1e-3).omega.value, 45.0, 1e-9);
  // Where that step would be a tenth of the largest force, it ends there: 0.1·400·125e-6/(2·100·1e-6).
  a.limits.force = 400.0;
  const Proposed weak = propose(a, 125e-6).omega;
  EXPECT_NEAR(weak.value, 25.0, 1e-9);
  EXPECT_THAT(weak.reason, HasSubstr("more than 10 % of its limit"));
}

// With 80 rad/s, 2 ms and three periods of delay the loop had a phase margin of -0.1 degrees.
TEST(MachineFile, ADelayOfTheDriveMakesTheLoopSlower) {
  AxisDescription a;
  a.limits = {0.0, 1.0, 1.0, 5.0, {}, 2000.0};
  a.commissioning.mass = 100.0;
  a.commissioning.friction = 600.0;
  a.commissioning.encoder_resolution = 1e-7;
  a.plant.emplace();
  EXPECT_NEAR(propose(a, 2e-3).omega.value, 80.0, 1e-9);
  a.plant->delay_periods = 3;
  const Proposed omega = propose(a, 2e-3).omega;
  EXPECT_NEAR(omega.value, 0.3 / 9e-3, 1e-9);
  EXPECT_THAT(omega.reason, HasSubstr("the delay of 6 ms"));
}

// 3 m at 10 mm/s: a third of the travel would take 700 s a period.
TEST(MachineFile, ASlowAxisOfLongTravelGetsAShortSine) {
  AxisDescription a;
  a.limits = {0.0, 3.0, 0.010, 0.1, {}, 1e4};
  a.commissioning.mass = 1e3;
  a.commissioning.friction = 100.0;
  const Proposal p = propose(a, 1e-3);
  EXPECT_NEAR(2.0 * kPi / p.sine_frequency.value, 30.0, 1e-9);
  EXPECT_NEAR(p.sine_amplitude.value * p.sine_frequency.value, 0.9 * 0.010, 1e-12);
}

}  // namespace
}  // namespace stribeck::workflow::machine_file_test
