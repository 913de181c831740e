#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/core/numbers.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <stribeck/workflow/log/logs_by_axis.hpp>
#include <string>
#include <vector>

namespace stribeck::test::logs_by_axis_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

workflow::MachineDescription two_axes() {
  workflow::MachineDescription m;
  m.name = "table";
  m.axes.resize(2);
  m.axes[0].first = "x";
  m.axes[1].first = "y";
  return m;
}

std::string rows(const std::string& header, int columns) {
  std::string text = header + "\n";
  for (int k = 0; k < 20; ++k) {
    text += std::to_string(0.001 * k);
    for (int c = 1; c < columns; ++c) text += "," + std::to_string(0.1 * k * c);
    text += "\n";
  }
  return text;
}
const std::string kPlain = rows("t [s],x [mm],f [N]", 3);

TEST(LogsByAxis, FindsTheAxisByWhatALogSaysItsColumnsOrItsName) {
  const Folder folder;
  const std::string said = folder.write("a.csv", "# axis: y\n" + kPlain);
  const std::string both = folder.write("b.csv", rows("t [s],x_x [mm],f_x [N],x_y [mm],f_y [N]", 5));
  const std::string one = folder.write("c.csv", rows("t [s],x_y [mm],f_y [N]", 3));
  const std::string named = folder.write("sine-X-log.csv", kPlain);
  const auto all = workflow::logs_by_axis(two_axes(), {said, both, one, named}, {});
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].axis, "x");
  EXPECT_EQ(all[0].options.axis, "x");
  EXPECT_THAT(all[1].logs, ElementsAre(said, both, one));
  EXPECT_THAT(all[0].logs, ElementsAre(both, named));
  workflow::LogOptions only_y;
  only_y.axis = "y";
  EXPECT_EQ(workflow::logs_by_axis(two_axes(), {said, named}, only_y).size(), 1u);
}

TEST(LogsByAxis, WhatTheFileSaysOfALoadGoesWithTheLog) {
  const Folder folder;
  const std::string log = folder.write("x.csv", kPlain);
  workflow::MachineDescription m = two_axes();
  const auto drive = [&] { return workflow::logs_by_axis(m, {log}, {}).front().options.drive; };
  EXPECT_FALSE(drive().balanced);
  EXPECT_FALSE(drive().weighted);
  m.axes[0].second.commissioning.load = workflow::Rough(0.0);
  EXPECT_TRUE(drive().balanced);
  EXPECT_FALSE(drive().weighted);
  m.axes[0].second.commissioning.load = workflow::Rough(-40.0);
  EXPECT_FALSE(drive().balanced);
  EXPECT_TRUE(drive().weighted);
}

TEST(LogsByAxis, AnAxisThatRestsWhileAnotherMovesHasNoPartInALog) {
  const Folder folder;
  std::string text = "t [s],x_x [mm],f_x [N],x_y [mm],f_y [N]\n";
  for (int k = 0; k < 20; ++k) text += fmt::format("{},12.5,{},{},{}\n", 0.001 * k, k % 3, 0.1 * k, k);
  const std::string log = folder.write("both.csv", text);
  const auto all = workflow::logs_by_axis(two_axes(), {log}, {});
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].axis, "y");
  // Asked for by name it is taken, and reading it says what is wrong.
  workflow::LogOptions only_x;
  only_x.axis = "x";
  ASSERT_EQ(workflow::logs_by_axis(two_axes(), {log}, only_x).size(), 1u);
  EXPECT_EQ(workflow::logs_by_axis(two_axes(), {log}, only_x)[0].axis, "x");
}

// One step of the encoder to and fro made an axis that rests one that moves: the log had "only 0 rows of sliding" then.
TEST(LogsByAxis, AnAxisWhoseEncoderGoesToAndFroByAStepRests) {
  const Folder folder;
  const auto axes = [&](double resting, double moving) {
    std::string text = "t [s],x_x [mm],f_x [N],x_y [mm],f_y [N]\n";
    for (int k = 0; k < 20; ++k)
      text += fmt::format("{},{},{},{},{}\n", 0.001 * k, 12.5 + (k % 7 == 3 ? resting : 0.0), k % 3,
                          moving * k, k);
    return workflow::logs_by_axis(two_axes(), {folder.write("both.csv", text)}, {}).size();
  };
  EXPECT_EQ(axes(0.0005, 0.1), 1u);
  EXPECT_EQ(axes(0.0005, 0.001), 2u) << "beside an axis that moves little it may be a motion";
}

TEST(LogsByAxis, TakesTheAxisThatIsGivenWhereTheLogSaysNone) {
  const Folder folder;
  const std::string log = folder.write("log.csv", kPlain);
  workflow::LogOptions only_y;
  only_y.axis = "y";
  const auto all = workflow::logs_by_axis(two_axes(), {log}, only_y);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].axis, "y");
  EXPECT_THAT(all[0].logs, ElementsAre(log));
}

TEST(LogsByAxis, RefusesALogThatCouldBeOfAnyAxis) {
  const Folder folder;
  const std::string log = folder.write("log.csv", kPlain);
  try {
    workflow::logs_by_axis(two_axes(), {log}, {});
    FAIL() << "accepted";
  } catch (const io::InputError& e) {
    EXPECT_THAT(e.problems().front().text(),
                AllOf(HasSubstr("log.csv"), HasSubstr("# axis: x"), HasSubstr("--axis")));
  }
  // A machine of one axis has no other.
  workflow::MachineDescription single = two_axes();
  single.axes.resize(1);
  EXPECT_THAT(workflow::logs_by_axis(single, {log}, {}).front().logs, ElementsAre(log));
}

// "Temperature C" made a log of x, in mm and N, one of the rotary axis c, which was ready then with 300 kg m2.
TEST(LogsByAxis, TheSymbolOfAUnitIsNoAxis) {
  const Folder folder;
  workflow::MachineDescription m = two_axes();
  for (const char* name : {"a", "c"}) {
    m.axes.emplace_back(name, m.axes[0].second);
    m.axes.back().second.rotary = true;
  }
  const auto axis_of = [&](const std::string& name, const std::string& header, int columns) {
    const auto all = workflow::logs_by_axis(m, {folder.write(name, rows(header, columns))}, {});
    return all.size() == 1 ? all.front().axis : std::to_string(all.size());
  };
  EXPECT_EQ(axis_of("x-1.csv", "Time [s],Position [mm],Force [N],Temperature C", 4), "x");
  EXPECT_EQ(axis_of("y-1.csv", "t_s,pos_mm,current_a", 3), "y");
  // Where a position carries the letter too, it is the axis.
  EXPECT_EQ(axis_of("1.csv", "t [s],pos_a [deg],current_a [A]", 3), "a");
  EXPECT_EQ(axis_of("2.csv", "t [s],x_c [deg],f_c [N m]", 3), "c");
  workflow::LogOptions told;
  told.axis = "y";
  const std::string plain =
      folder.write("log.csv", rows("Time [s],Position [mm],Force [N],Temperature C", 4));
  EXPECT_EQ(workflow::logs_by_axis(m, {plain}, told).at(0).axis, "y");
}

TEST(LogsByAxis, ALengthIsNoPositionOfAnAxisThatTurns) {
  const Folder folder;
  workflow::MachineDescription m = two_axes();
  m.axes.resize(1);
  m.axes[0].second.rotary = true;
  const auto last = [&](const std::string& text) {
    const std::string log = folder.write("log.csv", text);
    const workflow::LogOptions options = workflow::logs_by_axis(m, {log}, {}).front().options;
    return workflow::logged_axis(workflow::read_log(log, options), options).runs.front().x.y.back();
  };
  EXPECT_THAT([&] { last(kPlain); },
              ::testing::ThrowsMessage<io::InputError>(
                  AllOf(HasSubstr("is a length (mm), and axis x turns"), HasSubstr("# rotary: arcs"))));
  // Simulated logs say that their lengths are arcs.
  EXPECT_NEAR(last("# rotary: arcs\n" + kPlain), 1.9e-3, 1e-12);
}

// Screw of 10 mm behind a gear of 2, 1.5 N m at 100 %: one turn of the motor is 5 mm, 100 % are 1.5·2π/5e-3 N.
// Also on a machine of one axis: the log is of another machine, or the name in one of them is wrong.
TEST(LogsByAxis, RefusesALogThatSaysAnotherAxisUnlessItIsTold) {
  const Folder folder;
  const std::string log = folder.write("strut-log.csv", "# axis: l1\n" + kPlain);
  workflow::MachineDescription single = two_axes();
  single.axes.resize(1);
  try {
    workflow::logs_by_axis(single, {log}, {});
    FAIL() << "accepted";
  } catch (const io::InputError& e) {
    EXPECT_THAT(e.problems().front().text(), AllOf(HasSubstr("strut-log.csv"), HasSubstr("axis l1"),
                                                   HasSubstr("table has x"), HasSubstr("--axis x")));
  }
  workflow::LogOptions told;
  told.axis = "x";
  const auto all = workflow::logs_by_axis(single, {log}, told);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_THAT(all.front().logs, ElementsAre(log));
  EXPECT_THAT(all.front().notes, ElementsAre(HasSubstr("l1")));
}

TEST(LogsByAxis, TakesTheDriveOfTheMachineFileForUnitsOfTheMotor) {
  const Folder folder;
  workflow::MachineDescription m = two_axes();
  m.axes[0].second.drive.emplace();
  workflow::DriveData& drive = *m.axes[0].second.drive;
  drive.rated_torque = 1.5;
  drive.rated_current = 3.0;
  drive.lead = 0.01;
  drive.gear = 2.0;
  const double rated = 1.5 * 2.0 * kPi / 5e-3;
  const auto axis_of = [&](const std::string& name, const std::string& header, int columns = 4) {
    const std::string log = folder.write(name, rows(header, columns));
    const auto all = workflow::logs_by_axis(m, {log}, {});
    EXPECT_EQ(all.size(), 1u);
    const workflow::LogOptions& options = all.front().options;
    return workflow::logged_axis(workflow::read_log(log, options), options);
  };
  const workflow::LoggedAxis percent = axis_of("x-1.csv", "t [s],x [um],v [rpm],torque [%]");
  const auto& run = percent.runs.front();
  EXPECT_EQ(run.force_unit, "N");
  EXPECT_EQ(run.position_unit, "m");
  EXPECT_NEAR(run.f.y[10], 3.0 / 100.0 * rated, 1e-9);  // 3 %
  EXPECT_NEAR(run.v.y[10], 2.0 / 60.0 * 5e-3, 1e-12);   // 2 rpm
  EXPECT_THAT(percent.notes,
              ElementsAre(HasSubstr("with 1884.96 N at 100 %, from the drive of the machine file"),
                          HasSubstr("one turn of the motor is 5 mm of travel")));
  const workflow::LoggedAxis ampere = axis_of("x-2.csv", "t [s],x [rev],v [rpm],current [A]");
  EXPECT_EQ(ampere.runs.front().position_unit, "m");
  EXPECT_NEAR(ampere.runs.front().x.y[10], 1.0 * 5e-3, 1e-12);
  EXPECT_NEAR(ampere.runs.front().f.y[10], rated, 1e-9);  // 3 A
  EXPECT_NEAR(axis_of("x-3.csv", "t [s],x [mm],v [mm/s],torque [Nm]").runs.front().f.y[10], 2.0 * rated,
              1e-9);  // 3 N m
  // A log in newtons and millimetres needs nothing of it, the other axis has no drive.
  EXPECT_THAT(axis_of("x-4.csv", "t [s],x [mm],v [mm/s],f [N]").notes, ElementsAre());
  EXPECT_EQ(axis_of("y-1.csv", "t [s],x [mm],v [mm/s],torque [%]").runs.front().force_unit, "%");
  // CiA 402 has tenths of a percent.
  EXPECT_NEAR(axis_of("x-5.csv", "t [s],x [mm],v [mm/s],torque [0.1 %]").runs.front().f.y[10],
              3.0 / 1000.0 * rated, 1e-9);
  EXPECT_NEAR(axis_of("x-6.csv", "t [s],x [mm],v [mm/s],torque [0.1%]").runs.front().f.y[10],
              3.0 / 1000.0 * rated, 1e-9);
  // The torque of one of two motors: all columns give one force.
  drive.motors = 2;
  EXPECT_NEAR(axis_of("x-7.csv", "t [s],x [mm],v [mm/s],torque [Nm]").runs.front().f.y[10], 4.0 * rated,
              1e-9);
  EXPECT_NEAR(axis_of("x-8.csv", "t [s],x [mm],v [mm/s],torque [%]").runs.front().f.y[10],
              3.0 / 100.0 * 2.0 * rated, 1e-9);
  // The drive gives no scale for the current, but one for the torque beside it.
  drive.rated_current.reset();
  const workflow::LoggedAxis two = axis_of("x-9.csv", "t [s],x [mm],current [A],torque [%]");
  EXPECT_EQ(two.runs.front().force_unit, "N");
  EXPECT_NEAR(two.runs.front().f.y[10], 3.0 / 100.0 * 2.0 * rated, 1e-9);
  // A force with a scale needs no choice between two currents beside it.
  EXPECT_EQ(
      axis_of("x-10.csv", "t [s],x [mm],force [N],current [A],current_ref [A]", 5).runs.front().force_unit,
      "N");
}

// The step of the encoder and the time between rows are in the machine file; what the log tells goes first.
TEST(LogsByAxis, CountsAndRowsWithoutTimesTakeTheMachineFile) {
  const Folder folder;
  workflow::MachineDescription m = two_axes();
  m.sample_time = 2e-3;
  workflow::DriveData& drive = m.axes[0].second.drive.emplace();
  drive.rated_torque = 1.5;
  drive.travel_per_turn = 0.04;
  drive.encoder_counts = 4000;
  const auto axis_of = [&](const std::string& name, const std::string& text) {
    const std::string log = folder.write(name, text);
    const auto all = workflow::logs_by_axis(m, {log}, {});
    const workflow::LogOptions& options = all.at(0).options;
    const io::Log read = workflow::read_log(log, options);
    return std::pair{workflow::logged_axis(read, options), read.notes};
  };
  std::string text = "Counter,x [counts],x_ref [counts],f [N]\n";
  for (int k = 0; k < 20; ++k)
    text += fmt::format("{},{},{},{}\n", 100 + k + (k > 9 ? 3 : 0), 10 * k, 10 * k, 0.1 * k);
  const auto [counted, notes] = axis_of("x-1.csv", text);
  const auto& run = counted.runs.front();
  EXPECT_EQ(run.position_unit, "m");
  EXPECT_NEAR(run.x.y[10], 100.0 * 0.04 / 4000.0, 1e-12);
  EXPECT_NEAR(run.r.y[10], 100.0 * 0.04 / 4000.0, 1e-12);
  EXPECT_NEAR(run.x.t[10] - run.x.t[0], 13 * 2e-3, 1e-12);  // three rows are missing
  EXPECT_THAT(counted.notes, ::testing::Contains(HasSubstr("is 0.01 mm, as encoder_counts")));
  EXPECT_THAT(notes, ::testing::Contains(HasSubstr("the sample time of the machine file")));
  // Times of the log go first.
  const auto timed = axis_of("x-2.csv", rows("t [s],x [counts],f [N]", 3)).first;
  EXPECT_NEAR(timed.runs.front().x.t[10] - timed.runs.front().x.t[0], 10e-3, 1e-12);
  // The other axis has no encoder in the file.
  EXPECT_THAT([&] { axis_of("y-1.csv", rows("t [s],x [counts],f [N]", 3)); },
              ::testing::ThrowsMessage<io::InputError>(HasSubstr("is in increments")));
}

// A worm gear of 90, 2 N m at 100 %: degrees are those of the table, turns those of the motor, torques those of the motor.
TEST(LogsByAxis, ARotaryAxisIsReadInItsOwnDegrees) {
  const Folder folder;
  workflow::MachineDescription m = two_axes();
  m.axes.resize(1);
  workflow::AxisDescription& axis = m.axes[0].second;
  axis.rotary = true;
  const auto run_of = [&](const std::string& name, const std::string& header) {
    const std::string log = folder.write(name, rows(header, 4));
    const workflow::LogOptions options = workflow::logs_by_axis(m, {log}, {}).front().options;
    return workflow::logged_axis(workflow::read_log(log, options), options);
  };
  constexpr double kDegree = kPi / 180.0;
  const workflow::LoggedAxis plain = run_of("p.csv", "t [s],x [deg],v [deg/s],f [N m]");
  EXPECT_TRUE(plain.rotary);
  EXPECT_EQ(plain.runs.front().force_unit, "N");
  EXPECT_EQ(plain.runs.front().position_unit, "m");
  EXPECT_NEAR(plain.runs.front().x.y[10], 1.0 * kDegree, 1e-12);
  EXPECT_NEAR(plain.runs.front().f.y[10], 3.0, 1e-12);
  EXPECT_THAT(plain.notes, ElementsAre(HasSubstr("a rotary axis: its table is in deg, N m and kg m2")));
  axis.drive.emplace();
  axis.drive->rated_torque = 2.0;
  axis.drive->lead = 2.0 * kPi;
  axis.drive->gear = 90.0;
  const workflow::LoggedAxis geared = run_of("g.csv", "t [s],x [deg],v [rpm],torque [%]");
  EXPECT_NEAR(geared.runs.front().x.y[10], 1.0 * kDegree, 1e-12);
  EXPECT_NEAR(geared.runs.front().v.y[10], 2.0 / 60.0 * 2.0 * kPi / 90.0, 1e-12);
  EXPECT_NEAR(geared.runs.front().f.y[10], 0.03 * 2.0 * 90.0, 1e-9);
  EXPECT_THAT(geared.notes, ::testing::Contains(HasSubstr("one turn of the motor is 4 deg of travel")));
  EXPECT_NEAR(run_of("m.csv", "t [s],x [deg],v [deg/s],torque [Nm]").runs.front().f.y[10], 3.0 * 90.0, 1e-9);
  // Rotations a second are turns of the motor too, whatever their name.
  EXPECT_NEAR(run_of("r.csv", "t [s],x [deg],v [1/min],torque [%]").runs.front().v.y[10],
              2.0 / 60.0 * 2.0 * kPi / 90.0, 1e-12);
  // --lead goes before the drive for turns and torques; degrees stay those of the table.
  const std::string log = folder.write("l.csv", rows("t [s],x [deg],v [rpm],torque [Nm]", 4));
  workflow::LogOptions own = workflow::logs_by_axis(m, {log}, {}).front().options;
  own.lead = "8 deg";
  const workflow::LoggedAxis other = workflow::logged_axis(workflow::read_log(log, own), own);
  EXPECT_NEAR(other.runs.front().x.y[10], 1.0 * kDegree, 1e-12);
  EXPECT_NEAR(other.runs.front().v.y[10], 2.0 / 60.0 * 2.0 * kPi / 45.0, 1e-12);
  EXPECT_NEAR(other.runs.front().f.y[10], 3.0 * 45.0, 1e-9);
}

}  // namespace
}  // namespace stribeck::test::logs_by_axis_test
