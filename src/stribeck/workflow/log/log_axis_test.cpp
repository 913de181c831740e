#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/inspect.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <string>
#include <vector>

namespace stribeck::test::log_axis_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// A CSV log of an axis with friction, one row per millisecond; columns as the header says.
std::string csv(const std::string& header, const std::vector<std::string>& what, std::size_t rows = 3000) {
  std::string out = header + "\n";
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = 1e-3 * static_cast<double>(k);
    const double w = 2.0 * std::numbers::pi;
    const double x = 0.05 * std::sin(w * t);
    const double v = 0.05 * w * std::cos(w * t);
    const double f = -50.0 * w * w * x + 30.0 * v + (v > 0.0 ? 10.0 : -10.0) + 0.3 * std::sin(997.0 * t * t);
    for (std::size_t c = 0; c < what.size(); ++c) {
      double value = 0.0;
      if (what[c] == "t") value = t;
      if (what[c] == "x_mm") value = 1e3 * x;
      if (what[c] == "v_mm_min") value = 6e4 * v;
      if (what[c] == "turns_deg") value = 360.0 * x / 0.005;
      if (what[c] == "rpm") value = 60.0 * v / 0.005;
      if (what[c] == "f") value = f;
      if (what[c] == "volts") value = f / 1048.0;
      if (what[c] == "torque") value = f * 0.005 / (2.0 * std::numbers::pi);
      if (what[c] == "percent") value = 100.0 * f / 500.0;
      if (what[c] == "part") value = static_cast<double>(k / 1000);
      out += (c > 0 ? "," : "") + std::to_string(value);
    }
    out += "\n";
  }
  return out;
}

io::Log log_of(const std::string& text) { return io::parse_log(text, "log.csv"); }

ident::log::RawLog axis_of(const std::string& text, const workflow::LogOptions& options = {}) {
  return workflow::logged_axis(log_of(text), options).runs.at(0);
}

std::string refusal(const std::string& text, const workflow::LogOptions& options = {}) {
  try {
    static_cast<void>(workflow::logged_axis(log_of(text), options));
  } catch (const io::InputError& e) {
    return e.problems().front().text();
  }
  ADD_FAILURE() << "accepted";
  return {};
}

constexpr std::size_t kRow = 123;
double x_at() { return 0.05 * std::sin(2.0 * std::numbers::pi * 0.123); }

// Many controls record the command and how far the axis lags behind it.
TEST(LogAxis, APositionMayBeACommandLessItsFollowingError) {
  const std::string text =
      csv("t [s],Position command [mm],Following error [um],Force [N]", {"t", "x_mm", "f", "f"});
  EXPECT_THAT(refusal(text), HasSubstr("--map x=\"Position command mm - Following error um\""));
  workflow::LogOptions options;
  for (const double sign : {-1.0, 1.0}) {
    options.maps = {sign < 0.0 ? "x=Position command mm - Following error um"
                               : "x=Position command mm + Following error um"};
    const ident::log::RawLog raw = axis_of(text, options);
    for (const std::size_t k : {0U, 100U, 1777U})
      EXPECT_NEAR(raw.x.y[k], 1e-3 * log_of(text).columns[1].values[k] + sign * 1e-6 * raw.f.y[k], 1e-12);
  }
  options.maps = {"x=Position command mm - Force N"};
  EXPECT_THAT(refusal(text, options), HasSubstr("cannot be added"));
  options.maps = {"x=Position command mm"};
  EXPECT_THAT(workflow::logged_axis(log_of(text), options).notes,
              Contains(HasSubstr("is a commanded position")));
}

// A first word that stands before several quantities is the name of an axis, whatever it is.
TEST(LogAxis, AnyWordMayBeTheNameOfAnAxis) {
  for (const char* header : {"t [s],L1_cmd [mm],L1_act [mm],L1_force [N]",
                             "t [s],Strut3 cmd [mm],Strut3 pos [mm],Strut3 force [N]",
                             "t [s],gantry_ref [mm],gantry_enc [mm],gantry_force [N]",
                             "t [s],Stössel_soll [mm],Stössel_ist [mm],Stössel_Kraft [N]"}) {
    const ident::log::RawLog raw = axis_of(csv(header, {"t", "x_mm", "x_mm", "f"}));
    EXPECT_EQ(raw.x.y.size(), 3000U) << header;
    EXPECT_EQ(raw.r.y.size(), 3000U) << header;
  }
  // Words of other things.
  for (const char* header : {"t [s],x [mm],f [N],spindle speed [rpm],spindle current [A]",
                             "t [s],x_act [mm],x_force [N],plc_pos [mm],plc_vel [mm/s]",
                             "t [s],actual position [mm],force [N],laser pos [mm],laser vel [mm/s]"}) {
    const ident::log::RawLog raw = axis_of(csv(header, {"t", "x_mm", "f", "f", "f"}));
    EXPECT_EQ(raw.x.y.size(), 3000U) << header;
    EXPECT_TRUE(raw.v.y.empty()) << header;
    EXPECT_NEAR(raw.x.y[100], 0.05 * std::sin(0.2 * std::numbers::pi), 1e-6) << header;
  }
  const std::string two =
      csv("t [s],el_pos [mm],az_pos [mm],el_force [N],az_force [N]", {"t", "x_mm", "f", "f", "x_mm"});
  EXPECT_THAT(refusal(two), HasSubstr("a log of several axes: el, az"));
  workflow::LogOptions options;
  options.axis = "az";
  EXPECT_EQ(axis_of(two, options).f.y[100], log_of(two).columns[4].values[100]);
}

// The command is called by its unit alone, the two encoders by their places.
TEST(LogAxis, TheCommandBesideTwoEncodersIsTheReference) {
  workflow::LogOptions options;
  options.axis = "X";
  options.maps = {"motor=X motor mm", "scale=X scale mm"};
  const std::string two = csv("t [s],X cmd [mm],Y cmd [mm],X motor [mm],X scale [mm],X force [N]",
                              {"t", "x_mm", "f", "x_mm", "x_mm", "f"});
  EXPECT_EQ(axis_of(two, options).r.y.size(), 3000U);
  const std::string one = csv("t [s],X cmd [mm],X pos [mm],X force [N]", {"t", "x_mm", "x_mm", "f"});
  EXPECT_EQ(axis_of(one).r.y.size(), 3000U);
  const std::string other = csv("t [s],Y cmd [mm],X pos [mm],X force [N]", {"t", "x_mm", "x_mm", "f"});
  EXPECT_TRUE(axis_of(other).r.y.empty());
}

// What drives a motor of 24 V is no force: its turning induces a voltage.
TEST(LogAxis, TheVoltageOfAMotorIsNoForce) {
  for (const char* name : {"pwm [%]", "Duty cycle [%]", "Motor voltage [V]"}) {
    const io::Log log = log_of(csv(std::string("t [s],x [mm],") + name, {"t", "x_mm", "f"}));
    EXPECT_THAT(workflow::logged_axis(log, {}).notes, Contains(HasSubstr("is the voltage of the motor")))
        << name;
  }
  for (const char* name : {"u [V]", "Motor current [A]", "motor current monitor [V]"}) {
    const io::Log log = log_of(csv(std::string("t [s],x [mm],") + name, {"t", "x_mm", "f"}));
    EXPECT_THAT(workflow::logged_axis(log, {}).notes, Not(Contains(HasSubstr("voltage of the motor"))))
        << name;
  }
}

// What may be one part of an axis, or commanded, is no axis.
TEST(LogAxis, NumbersOfMotorsAndLettersOfCommandsAreNoAxes) {
  EXPECT_THAT(refusal(csv("t [s],x [mm],Motor1 Current [A],Motor2 Current [A]", {"t", "x_mm", "f", "f"})),
              HasSubstr("2 columns have the unit A"));
  EXPECT_THAT(refusal(csv("t [s],cPos [mm],f [N]", {"t", "x_mm", "f"})),
              HasSubstr("no column for the position"));
  const std::string two = csv("t [s],x_cmd [mm],x_error [mm],y_cmd [mm],y_error [mm],x_force [N],y_force [N]",
                              {"t", "x_mm", "x_mm", "x_mm", "x_mm", "f", "f"});
  workflow::LogOptions options;
  options.axis = "y";
  EXPECT_THAT(refusal(two, options), HasSubstr("--map x=\"y_cmd mm - y_error mm\""));
  // A name with a sign in it.
  options = {};
  options.maps = {"x=Axis 1 - Actual position mm"};
  EXPECT_EQ(
      axis_of(csv("t [s],Axis 1 - Actual position [mm],Force [N]", {"t", "x_mm", "f"}), options).x.y.size(),
      3000U);
  // A unit that scales that of the file is noted.
  options.maps = {"x=Cmd um - Err um"};
  EXPECT_THAT(workflow::logged_axis(log_of(csv("t [s],Cmd [mm],Err [um],Force [N]", {"t", "x_mm", "f", "f"})),
                                    options)
                  .notes,
              Contains(HasSubstr("has the unit mm in the file")));
}

TEST(LogAxis, ColumnsOfTwoAxesByLetterAndNumber) {
  for (const auto& [header, axis] :
       {std::pair{"t [s],x [mm],y [mm],Fx [N],Fy [N]", "y"},
        {"t [s],X [mm],Z [mm],IX [A],IZ [A]", "Z"},
        {"t [s],pos1 [mm],pos2 [mm],cur1 [A],cur2 [A]", "2"},
        {"t [s],v_act [mm],u_act [mm],v_force [N],u_force [N]", "u"},
        {"t [s],Achse1 Ist [mm],Achse2 Ist [mm],Achse1 Strom [A],Achse2 Strom [A]", "2"},
        {"t [s],J1_pos [mm],J2_pos [mm],J1_torque [Nm],J2_torque [Nm]", "J2"},
        {"t [s],x_act [mm],x2_act [mm],x_force [N],x2_force [N]", "x2"}}) {
    const std::string text = csv(header, {"t", "v_mm_min", "x_mm", "percent", "f"});
    workflow::LogOptions options;
    options.axis = axis;
    const ident::log::RawLog raw = axis_of(text, options);
    EXPECT_NEAR(raw.x.y[100], 1e-3 * log_of(text).columns[2].values[100], 1e-12) << header;
    EXPECT_EQ(raw.f.y[100], log_of(text).columns[4].values[100]) << header;
  }
}

// The names of a log of one axis, x_act and x_cmd, are those of the axis X where there is another axis.
TEST(LogAxis, AnAxisHasItsOwnColumns) {
  for (const std::string form : {"_act", "_cmd+_act", "_ref+_act", "_soll+_ist", " act", "_pos", "_fb",
                                 "-cmd+-act", "_actual", "_enc", "/pos", "_des+_meas"}) {
    for (const std::string other : {"Y", "Z", "C"}) {
      std::string header = "t [s]";
      std::vector<std::string> what{"t"};
      const auto plus = form.find('+');
      const std::string measured = plus == std::string::npos ? form : form.substr(plus + 1);
      for (const std::string& axis : {std::string("X"), other}) {
        const std::string value = axis == "X" ? "x_mm" : "v_mm_min";
        if (plus != std::string::npos) {
          header += fmt::format(",{}{} [mm]", axis, form.substr(0, plus));
          what.push_back(value);
        }
        header += fmt::format(",{}{} [mm],{}_force [N]", axis, measured, axis);
        what.insert(what.end(), {value, "f"});
      }
      const std::string text = csv(header, what);
      workflow::LogOptions options;
      options.axis = "X";
      EXPECT_LT(std::abs(axis_of(text, options).x.y[100]), 0.06) << header;
      options.axis = other;
      EXPECT_GT(std::abs(axis_of(text, options).x.y[100]), 1.0) << header;
      options.axis.clear();
      EXPECT_THAT(refusal(text, options), HasSubstr("--axis NAME")) << header;
    }
  }
}

TEST(LogAxis, NamesOfTheControls) {
  struct Case {
    std::string header;
    std::string axis;
  };
  for (const Case& c : {Case{"t [s],x [mm],f [N]", ""},
                        {"t [s],x_y [mm],f_y [N]", "y"},
                        {"t_s,pos_act_mm,force_N", ""},
                        {"t [s],s ist/Y [mm],Kraft/Y [N]", ""},
                        {"t [s],Istposition [mm],Kraft [N]", "x"},
                        {"t [s],Y1_ActualPosition [mm],Y1_Force [N]", "y"},
                        {"t [s],ActPos [mm],F [N]", ""}}) {
    const ident::log::RawLog raw = axis_of(csv(c.header, {"t", "x_mm", "f"}), {.axis = c.axis});
    ASSERT_EQ(raw.x.y.size(), 3000U) << c.header;
    EXPECT_NEAR(raw.x.y[kRow], x_at(), 1e-8) << c.header;
    EXPECT_EQ(raw.force_unit, "N") << c.header;
    EXPECT_EQ(raw.position_unit, "m") << c.header;
  }
}

TEST(LogAxis, TwoCandidatesAreRefused) {
  EXPECT_THAT(
      refusal(csv("t [s],x [mm],pos [mm],f [N]", {"t", "x_mm", "x_mm", "f"})),
      AllOf(HasSubstr("2 columns"), HasSubstr("x [mm]"), HasSubstr("pos [mm]"), HasSubstr("--map x=")));
  EXPECT_THAT(
      refusal(csv("t [s],X1_ActualPosition [mm],Y1_ActualPosition [mm],f [N]", {"t", "x_mm", "x_mm", "f"})),
      AllOf(HasSubstr("several axes"), HasSubstr("x1, y1"), HasSubstr("--axis")));
  const std::string two = csv("t [s],x [mm],pos [mm],f [N]", {"t", "part", "x_mm", "f"});
  EXPECT_NEAR(axis_of(two, {.maps = {"x=pos"}}).x.y[kRow], x_at(), 1e-8);
  EXPECT_NEAR(axis_of(two, {.maps = {"x=pos cm"}}).x.y[kRow], 10.0 * x_at(), 1e-7);
}

// A unit may be put right, but not make another quantity of a column whose unit stands in the file.
TEST(LogAxis, UnitsOfMaps) {
  const std::string text = csv("t [s],x [mm],f [N]", {"t", "x_mm", "f"});
  EXPECT_THAT(refusal(text, {.maps = {"x=x N s/mm"}}),
              AllOf(HasSubstr("--map"), HasSubstr("has the unit mm in the file")));
  EXPECT_THAT(refusal(text, {.maps = {"force=x N"}}), HasSubstr("cannot be converted to N"));
  EXPECT_NEAR(axis_of(text, {.maps = {"x=x m"}}).x.y[kRow], 1e3 * x_at(), 1e-5);
  // Units that the file does not hold, and a letter that may be the axis.
  const std::string capture = csv("CYCLE,ENC_POS|1,CURRENT|1", {"t", "x_mm", "f"});
  EXPECT_EQ(workflow::logged_axis(io::parse_log(capture, "log.csv", {.sample_time = 1e-3}),
                                  {.maps = {"x=ENC_POS|1 deg"}})
                .runs[0]
                .position_unit,
            "rad");
  EXPECT_EQ(
      axis_of(csv("t [s],x [mm],Kraft_A", {"t", "x_mm", "f"}), {.maps = {"force=Kraft_A N"}}).force_unit,
      "N");
}

TEST(LogAxis, ScalesOfTheForce) {
  const double f = axis_of(csv("t [s],x [mm],f [N]", {"t", "x_mm", "f"})).f.y[kRow];
  const std::string volts = csv("t [s],x [mm],u [V]", {"t", "x_mm", "volts"});
  EXPECT_NEAR(axis_of(volts, {.gain = "1048 N/V"}).f.y[kRow], f, 1e-2);  // six decimals in the file
  const workflow::LoggedAxis own = workflow::logged_axis(log_of(volts), {});
  EXPECT_EQ(own.runs[0].force_unit, "V");
  EXPECT_NEAR(own.runs[0].f.y[kRow], f / 1048.0, 1e-6);
  EXPECT_THAT(own.notes, Contains(AllOf(HasSubstr("scale of the force is not known"), HasSubstr("--gain"))));
  EXPECT_THAT(refusal(volts, {.gain = "10 N/A"}),
              AllOf(HasSubstr("--gain"), HasSubstr("10 N/A"), HasSubstr("N/V")));
  const std::string torque = csv("t [s],x [mm],torque [Nm]", {"t", "x_mm", "torque"});
  EXPECT_EQ(axis_of(torque).force_unit, "N m");
  EXPECT_NEAR(axis_of(torque, {.lead = "5 mm"}).f.y[kRow], f, 1e-3);
  EXPECT_NEAR(axis_of(torque, {.gain = "1256.637061 1/m"}).f.y[kRow], f, 1e-3);
  const std::string percent = csv("t [s],x [mm],torque [%]", {"t", "x_mm", "percent"});
  EXPECT_EQ(axis_of(percent).force_unit, "%");
  EXPECT_NEAR(axis_of(percent).f.y[kRow], f / 5.0, 1e-5);
  EXPECT_NEAR(axis_of(percent, {.gain = "500 N"}).f.y[kRow], f, 1e-4);  // at 100 %
  // Two sources: the unit of the gain chooses.
  const std::string both = csv("t [s],x [mm],i [A],u [V]", {"t", "x_mm", "f", "volts"});
  EXPECT_NEAR(axis_of(both, {.gain = "1048 N/V"}).f.y[kRow], f, 1e-2);
  EXPECT_EQ(axis_of(both).force_unit, "A");
}

// A TwinCAT log whose row of units is empty: the torque of a drive is a whole number of per mille.
TEST(LogAxis, WholeNumbersWithoutAUnitMayBePerMille) {
  std::string whole = "t [s],x [mm],Torque\n", broken = whole;
  for (int k = 0; k < 400; ++k) {
    const double x = 10.0 * std::sin(0.05 * k);
    whole += fmt::format("{:.3f},{:.5f},{}\n", 1e-3 * k, x, k % 90 - 45);
    broken += fmt::format("{:.3f},{:.5f},{:.2f}\n", 1e-3 * k, x, 0.37 * (k % 90) - 45.0);
  }
  const auto notes = [](const std::string& text) { return workflow::logged_axis(log_of(text), {}).notes; };
  EXPECT_THAT(notes(whole), Contains(HasSubstr("mostly per mille of the rated torque")));
  EXPECT_THAT(notes(broken),
              Contains(AllOf(HasSubstr("percent=\"Torque ‰\""), Not(HasSubstr("mostly per mille")))));
}

// 8 N at a radius of 1 m are 8 N m to whoever reads it.
TEST(LogAxis, TheScaleOfAnAxisThatTurnsIsATorque) {
  workflow::LogOptions options;
  options.drive.rotary = true;
  options.drive.lead = "360 deg";
  options.drive.at_100_percent = "8 N";
  options.drive.per_ampere = "2.5 N/A";
  const std::string percent = csv("t [s],x [deg],torque [%]", {"t", "x_mm", "percent"});
  EXPECT_THAT(workflow::logged_axis(log_of(percent), options).notes,
              Contains(HasSubstr("with 8 N m at 100 %")));
  const std::string ampere = csv("t [s],x [deg],i [A]", {"t", "x_mm", "f"});
  EXPECT_THAT(workflow::logged_axis(log_of(ampere), options).notes, Contains(HasSubstr("with 2.5 N m/A")));
  options.drive.rotary = false;
  const std::string straight = csv("t [s],x [mm],torque [%]", {"t", "x_mm", "percent"});
  EXPECT_THAT(workflow::logged_axis(log_of(straight), options).notes,
              Contains(HasSubstr("with 8 N at 100 %")));
}

TEST(LogAxis, TurningAxes) {
  const std::string text =
      csv("t [s],pos [deg],velocity [rpm],torque [Nm]", {"t", "turns_deg", "rpm", "torque"});
  const ident::log::RawLog angle = axis_of(text);
  EXPECT_EQ(angle.position_unit, "rad");
  EXPECT_EQ(angle.force_unit, "N m");
  EXPECT_NEAR(angle.x.y[kRow], x_at() / 0.005 * 2.0 * std::numbers::pi, 1e-6);
  const ident::log::RawLog straight = axis_of(text, {.lead = "5 mm"});
  EXPECT_EQ(straight.position_unit, "m");
  EXPECT_EQ(straight.force_unit, "N");
  EXPECT_NEAR(straight.x.y[kRow], x_at(), 1e-8);
  EXPECT_NEAR(straight.v.y[kRow], 0.05 * 2.0 * std::numbers::pi * std::cos(2.0 * std::numbers::pi * 0.123),
              1e-8);
  EXPECT_THAT(refusal(csv("t [s],x [mm],velocity [rpm],f [N]", {"t", "x_mm", "rpm", "f"})),
              HasSubstr("--lead"));
}

// A table that turns 4 degrees in a turn of its motor: arcs at a radius of 1 m, the torque at the table.
TEST(LogAxis, RotaryAxes) {
  const std::string text = csv("t [s],pos [deg],torque [Nm]", {"t", "turns_deg", "torque"});
  const ident::log::RawLog motor = axis_of(text);
  const workflow::LoggedAxis direct = workflow::logged_axis(log_of(text), {.lead = "360 deg"});
  EXPECT_EQ(direct.runs[0].position_unit, "m");
  EXPECT_EQ(direct.runs[0].force_unit, "N");
  EXPECT_NEAR(direct.runs[0].x.y[kRow], motor.x.y[kRow], 1e-12);
  EXPECT_NEAR(direct.runs[0].f.y[kRow], motor.f.y[kRow], 1e-12);
  EXPECT_THAT(direct.notes, Contains(HasSubstr("N stands for N m, kg for kg m2 and mm for mrad")));
  const ident::log::RawLog geared = axis_of(text, {.lead = "4 deg"});
  EXPECT_NEAR(geared.x.y[kRow], motor.x.y[kRow] / 90.0, 1e-12);
  EXPECT_NEAR(geared.f.y[kRow], motor.f.y[kRow] * 90.0, 1e-9);
  EXPECT_THAT(refusal(text, {.lead = "0 deg"}), HasSubstr("expected the travel per turn"));
  EXPECT_THAT(refusal(text, {.lead = "5 %"}), HasSubstr("--lead"));
  EXPECT_THAT(refusal(text, {.lead = "5"}), HasSubstr("--lead"));
}

// Controls write turns per minute as 1/min; 1/s says too little, and --map may tell what it is.
TEST(LogAxis, TurnsPerMinuteInOtherWords) {
  const auto with_unit = [](const std::string& unit) {
    return csv("t [s],x [mm],Drehzahl [" + unit + "],f [N]", {"t", "x_mm", "rpm", "f"});
  };
  const std::vector<double> v = axis_of(with_unit("rpm"), {.lead = "5 mm"}).v.y;
  for (const char* unit : {"1/min", "min-1", "min^-1", "U/min"})
    EXPECT_EQ(axis_of(with_unit(unit), {.lead = "5 mm"}).v.y, v) << unit;
  for (const char* unit : {"1/s", "Hz"})
    EXPECT_THAT(refusal(with_unit(unit), {.lead = "5 mm"}),
                AllOf(HasSubstr("may be turns or radians"), HasSubstr("--map v=\"Drehzahl rpm\"")));
  const workflow::LoggedAxis told =
      workflow::logged_axis(log_of(with_unit("1/s")), {.maps = {"v=Drehzahl rpm"}, .lead = "5 mm"});
  EXPECT_EQ(told.runs[0].v.y, v);
  EXPECT_THAT(told.notes, Contains(HasSubstr("has the unit 1/s in the file; --map gives rpm instead")));
}

// The one column with a unit of a force need not be one.
TEST(LogAxis, WhatIsOfTheSupplyIsNoForce) {
  for (const char* name :
       {"Feed override [%]", "Motor utilization [%]", "DC link voltage [V]", "Bus voltage [V]"})
    EXPECT_THAT(refusal(csv(std::string("t [s],x [mm],") + name, {"t", "x_mm", "percent"})),
                HasSubstr("no column for the force"))
        << name;
  EXPECT_EQ(axis_of(csv("t [s],x [mm],DC motor [A]", {"t", "x_mm", "percent"})).force_unit, "A");
}

// A drive with two encoders.
TEST(LogAxis, OfTwoEncodersTheMotorIsThePosition) {
  const io::Log log = log_of(csv("t [s],Z motor [mm],Z scale [mm],f [N]", {"t", "x_mm", "x_mm", "f"}));
  EXPECT_THAT(workflow::logged_axis(log, {}).notes,
              Contains(HasSubstr("the position is that of column \"Z motor")));
  EXPECT_THAT(workflow::inspect(log, {}).text,
              AllOf(HasSubstr("lost motion: backlash and wind-up"), HasSubstr("Z scale")));
}

// A log in counts of the encoder needs the length of one, in --map or in the side file.
TEST(LogAxis, IncrementsOfTheEncoder) {
  const std::string text = csv("t [s],r [Inkr],x [Inkr],f [N]", {"t", "x_mm", "x_mm", "f"});
  EXPECT_THAT(refusal(text), AllOf(HasSubstr("is in increments"), HasSubstr("--map x=\"x 0.001 mm\""),
                                   HasSubstr("0.001 mm is one count")));
  EXPECT_THAT(refusal(csv("t [s],Istposition (Inkr),f [N]", {"t", "x_mm", "f"})),
              HasSubstr("is in increments"));
  const workflow::LoggedAxis mapped = workflow::logged_axis(log_of(text), {.maps = {"x=x 0.5 mm"}});
  EXPECT_NEAR(mapped.runs[0].x.y[kRow], 0.5 * x_at(), 1e-8);
  EXPECT_THAT(mapped.notes, Contains(HasSubstr("is in counts and is not used")));
  EXPECT_NEAR(axis_of(text, {.maps = {"x=x [Inkr] 0.5 mm"}}).x.y[kRow], 0.5 * x_at(), 1e-8);
  EXPECT_THAT(refusal(csv("t [s],x [mm],torque [counts]", {"t", "x_mm", "f"})),
              AllOf(HasSubstr("is in counts"), HasSubstr("--map percent=\"torque 0.1 %\"")));
  // A velocity in increments beside it is left out, or mapped.
  const std::string rate = csv("t [s],x [cnt],v [cnt/sec],f [N]", {"t", "x_mm", "v_mm_min", "f"});
  EXPECT_THAT(workflow::logged_axis(log_of(rate), {.maps = {"x=x 1 mm"}}).notes,
              Contains(HasSubstr("is in counts and is not used")));
  EXPECT_THAT(workflow::logged_axis(log_of(rate), {.maps = {"x=x 1 mm", "v=v 1 mm/min"}}).columns,
              Contains(testing::Pair("v", "v [cnt/sec] [1 mm/min]")));
  const io::Log named = io::parse_log(text, "log.csv", {.names = {"t s", "r 0.5 mm", "x 0.5 mm", "f N"}});
  const workflow::LoggedAxis side = workflow::logged_axis(named, {});
  EXPECT_NEAR(side.runs[0].x.y[kRow], 0.5 * x_at(), 1e-8);
  EXPECT_NEAR(side.runs[0].r.y[kRow], 0.5 * x_at(), 1e-8);
}

// Controls call an axis otherwise than the machine file does.
TEST(LogAxis, AxesThatTheLogCallsOtherwise) {
  const std::string rockwell =
      csv("t [s],Axis_Z.ActualPosition [mm],Axis_Z.TorqueReference [N m]", {"t", "x_mm", "torque"});
  EXPECT_NEAR(axis_of(rockwell, {.axis = "z", .lead = "5 mm"}).x.y[kRow], x_at(), 1e-8);
  const std::string omron =
      csv("t [s],MC_Axis000.Act.Pos [mm],MC_Axis000.Act.Trq [N m]", {"t", "x_mm", "torque"});
  EXPECT_THAT(
      refusal(omron, {.axis = "z", .lead = "5 mm"}),
      AllOf(HasSubstr("\"MC_Axis000.Act.Pos [mm]\" is of axis \"mc_axis000\""), HasSubstr("--map x=")));
  // The position that --map names tells how the log calls the axis: the torque is found by that.
  const workflow::LogOptions told{.axis = "z", .maps = {"x=MC_Axis000.Act.Pos"}, .lead = "5 mm"};
  EXPECT_NEAR(axis_of(omron, told).f.y[kRow], axis_of(rockwell, {.axis = "z", .lead = "5 mm"}).f.y[kRow],
              1e-8);
}

// "s_ist/mm", as German tables write path and unit.
TEST(LogAxis, QuantityOverUnit) {
  const workflow::LoggedAxis axis = workflow::logged_axis(
      log_of(csv("t/s,s_ist/mm,M_ist/Nm", {"t", "x_mm", "torque"})), {.axis = "z", .lead = "5 mm"});
  EXPECT_NEAR(axis.runs[0].x.y[kRow], x_at(), 1e-8);
}

// Galil counts samples of 1/1024 s.
TEST(LogAxis, ATimeMayHaveAFactor) {
  const test::Folder folder;
  const std::string file = folder.write("galil.csv", "TIME,x [mm],f [N]\n0,1,5\n2,2,6\n4,3,7\n");
  const workflow::LogOptions options{.maps = {"t=TIME 0.25 s"}};
  const workflow::LoggedAxis axis = workflow::logged_axis(workflow::read_log(file, options), options);
  ASSERT_EQ(axis.runs.at(0).x.t.size(), 3U);
  EXPECT_DOUBLE_EQ(axis.runs[0].x.t[2], 1.0);
}

// A command that is in the log, but not that of this motion.
TEST(LogAxis, AColumnCanBeLeftOut) {
  const test::Folder folder;
  const std::string file =
      folder.write("log.csv", "t [s],x [mm],r [mm],f [N]\n0,1,1,5\n0.1,2,2,6\n0.2,3,3,7\n");
  workflow::LogOptions options;
  EXPECT_EQ(workflow::logged_axis(workflow::read_log(file, options), options).runs.at(0).r.y.size(), 3U);
  options.maps = {"none=r"};
  const workflow::LoggedAxis axis = workflow::logged_axis(workflow::read_log(file, options), options);
  EXPECT_TRUE(axis.runs.at(0).r.y.empty());
  EXPECT_EQ(axis.runs.at(0).x.y.size(), 3U);
  options.maps = {"none=soll"};
  EXPECT_THAT([&] { workflow::read_log(file, options); }, ThrowsMessage<io::InputError>(HasSubstr("soll")));
}

// Every other row has no force; the named time is that of all rows.
TEST(LogAxis, AChannelOfAnotherRateKeepsItsTimes) {
  std::string text = "stamp,x_mm,f_N\n";
  for (int k = 0; k < 3000; ++k)
    text += std::to_string(2 * k) + "," + std::to_string(k % 700) + "," + (k % 2 == 0 ? "5" : "") + "\n";
  const test::Folder folder;
  const std::string file = folder.write("joined.csv", text);
  const workflow::LogOptions options{.maps = {"t=stamp ms"}};
  const workflow::LoggedAxis read = workflow::logged_axis(workflow::read_log(file, options), options);
  const ident::log::RawLog& axis = read.runs.at(0);
  ASSERT_EQ(axis.x.y.size(), 3000U);
  ASSERT_EQ(axis.f.y.size(), 1500U);
  EXPECT_DOUBLE_EQ(axis.f.t.at(1), 0.004);
}

// A log of the force that the drive makes shows no delay of its command.
TEST(LogAxis, ANameTellsThatAForceIsMeasured) {
  const auto measured = [](const std::string& force) {
    return axis_of("t [ms],x [mm]," + force + "\n0,1,2\n1,2,3\n2,3,4\n").measured;
  };
  for (const char* name :
       {"x force actual [N]", "ActualTorque [N m]", "Drehmomentistwert [N m]", "TorqueFeedback [N m]"})
    EXPECT_TRUE(measured(name)) << name;
  for (const char* name : {"f [N]", "torque [N m]", "Force command [N]", "Iq [A]"})
    EXPECT_FALSE(measured(name)) << name;
}

// SPiiPlus of ACS: reference and feedback.
TEST(LogAxis, ReferenceAndFeedbackOfAcs) {
  const ident::log::RawLog axis =
      axis_of("Time(us)\tX_RPOS(mm)\tX_FPOS(mm)\tX_CURR(Arms)\n0\t1\t2\t3\n1000\t2\t3\t4\n2000\t3\t4\t5\n");
  EXPECT_DOUBLE_EQ(axis.x.y.at(0), 0.002);
  EXPECT_DOUBLE_EQ(axis.r.y.at(0), 0.001);
}

// Two motors on the two sides of a gantry, one of which carries more.
TEST(LogAxis, MotorsOfOneAxisAreAdded) {
  std::string text = "t [s],y [mm],Y1 Current (Arms),Y2 Current (Arms)\n";
  for (int k = 0; k < 10; ++k) text += fmt::format("{},{},3,1\n", 0.001 * k, k);
  workflow::LogOptions options{.axis = "y"};
  options.drive.per_ampere = "20 N/A";  // of both
  options.drive.motors = 2;
  const auto force = [&](const workflow::LogOptions& o) {
    const workflow::LoggedAxis axis = workflow::logged_axis(log_of(text), o);
    return std::pair(axis.runs.at(0).f.y.at(0), axis.notes);
  };
  const auto [both, notes] = force(options);
  EXPECT_DOUBLE_EQ(both, 40.0);  // 10 N/A of each
  EXPECT_THAT(notes,
              Contains(HasSubstr("the axis has 2 motors; \"Y1 Current (Arms)\" and the same columns")));
  options.maps = {"current=Y1 Current"};
  const auto [one, hint] = force(options);
  EXPECT_DOUBLE_EQ(one, 60.0);  // the first stands for both
  EXPECT_THAT(hint, Contains(HasSubstr("--map current=\"Y1 Current (Arms) + Y2 Current (Arms)\"")));
  options.maps = {"current=Y1 Current (Arms) + Y2 Current (Arms)"};
  EXPECT_DOUBLE_EQ(force(options).first, 40.0);
  options.maps = {"current=Y2 Current + Y1 Current A"};
  EXPECT_DOUBLE_EQ(force(options).first, 40.0);
  options.drive.motors = 3;
  EXPECT_THAT(refusal(text, options), HasSubstr("a sum of 2 columns, the axis has 3 motors"));
  options.maps = {"x=y + Y1 Current"};
  EXPECT_THAT(refusal(text, options), HasSubstr("cannot be added: expected two columns of one kind of unit"));
  options.maps = {"current=y + Y1 Current"};
  EXPECT_THAT(refusal(text, options), HasSubstr("cannot be added"));
}

// The second motor of a gantry is mounted the other way round: the sum would be their difference. Both are preloaded against each other.
TEST(LogAxis, AMotorThatIsMountedTheOtherWayRoundIsSubtracted) {
  workflow::LogOptions options{.axis = "y"};
  options.drive.per_ampere = "20 N/A";
  options.drive.motors = 2;
  for (const bool mirrored : {true, false}) {
    std::string text = "t [s],y [mm],Y1 Current (Arms),Y2 Current (Arms)\n";
    for (int k = 0; k < 20; ++k)
      text +=
          fmt::format("{},{},{},{}\n", 0.001 * k, k, k % 7 + 5.0, (mirrored ? -1.0 : 1.0) * (k % 7) - 5.0);
    const workflow::LoggedAxis axis = workflow::logged_axis(log_of(text), options);
    // 10 N/A of each; the preload stays where it is added, and counts double where it is subtracted.
    EXPECT_DOUBLE_EQ(axis.runs.at(0).f.y.at(3) - axis.runs.at(0).f.y.at(0), 60.0);
    EXPECT_THAT(
        axis.notes,
        Contains(HasSubstr(mirrored ? "the mean of columns \"Y1 Current (Arms)\", less \"Y2 Current (Arms)\""
                                    : "the mean of columns \"Y1 Current (Arms)\", \"Y2 Current (Arms)\"")));
    if (mirrored)
      EXPECT_THAT(axis.notes, Contains(HasSubstr("\"Y2 Current (Arms)\" is subtracted: it runs against")));
    else
      EXPECT_THAT(axis.notes, Not(Contains(HasSubstr("runs against"))));
    workflow::LogOptions summed = options;
    summed.maps = {"current=Y1 Current (Arms) + Y2 Current (Arms)"};
    const auto said = Contains(HasSubstr("their sum leaves little of either"));
    if (mirrored)
      EXPECT_THAT(workflow::logged_axis(log_of(text), summed).notes, said);
    else
      EXPECT_THAT(workflow::logged_axis(log_of(text), summed).notes, Not(said));
  }
}

// Half of the force makes half of the mass, and nothing else shows it.
TEST(LogAxis, ASecondMotorThatIsNotUsedIsNamed) {
  std::string text = "t [s],y [mm],Y1 Torque (%),Y2 Torque (%)\n";
  for (int k = 0; k < 10; ++k) text += fmt::format("{},{},3,1\n", 0.001 * k, k);
  workflow::LogOptions options{.axis = "y"};
  options.gain = "20 N/%";
  EXPECT_THAT(workflow::logged_axis(log_of(text), options).notes,
              Contains(HasSubstr("\"Y2 Torque (%)\" of another one is not used")));
  options.maps = {"percent=Y1 Torque (%) % + Y2 Torque (%) %"};
  EXPECT_THAT(workflow::logged_axis(log_of(text), options).notes, Not(Contains(HasSubstr("is not used"))));
  options.gain.clear();
  options.drive.at_100_percent = "2000 N";
  EXPECT_THAT(workflow::logged_axis(log_of(text), options).notes, Contains(HasSubstr("the sum of columns ")));
  // The sides of a gantry may be called axes.
  std::string gantry = "t [s],Y1 Position [mm],Y2 Position [mm],Y1 Current [A],Y2 Current [A]\n";
  for (int k = 0; k < 10; ++k) gantry += fmt::format("{},{},{},3,1\n", 0.001 * k, k, k);
  workflow::LogOptions side{.axis = "y1"};
  side.gain = "50 N/A";
  EXPECT_THAT(workflow::logged_axis(log_of(gantry), side).notes,
              Contains(HasSubstr("\"Y2 Current [A]\" of another one is not used")));
}

// Here the numbers are those of axes: nothing is added.
TEST(LogAxis, AnotherAxisIsNoSecondMotor) {
  std::string text = "t [s],pos_1 [mm],pos_2 [mm],current_1 [A],current_2 [A]\n";
  for (int k = 0; k < 10; ++k) text += fmt::format("{},{},{},3,1\n", 0.001 * k, k, k);
  workflow::LogOptions options{.axis = "1"};
  options.drive.per_ampere = "20 N/A";
  options.drive.motors = 2;
  const workflow::LoggedAxis axis = workflow::logged_axis(log_of(text), options);
  EXPECT_DOUBLE_EQ(axis.runs.at(0).f.y.at(0), 60.0);
  EXPECT_THAT(axis.notes, Contains(HasSubstr("each is taken to give as much")));
  EXPECT_THAT(axis.notes, Contains(HasSubstr("the preload then counts as a load")));
  // Named by the user it is still that of one motor.
  options.maps = {"current=current_1 A"};
  EXPECT_THAT(workflow::logged_axis(log_of(text), options).notes,
              Contains(HasSubstr("the preload then counts as a load")));
}

// The sum was doubled: mass and friction came out twice as large, and a held-out log agreed.
TEST(LogAxis, AColumnThatIsNamedASumIsThatOfAllMotors) {
  for (const char* name : {"Y Drehmoment Summe [A]", "Y_TotalCurrent [A]", "Y Gesamtstrom [A]"}) {
    std::string text = fmt::format("t [s],y [mm],{}\n", name);
    for (int k = 0; k < 10; ++k) text += fmt::format("{},{},3\n", 0.001 * k, k);
    workflow::LogOptions options{.axis = "y"};
    options.drive.per_ampere = "20 N/A";
    options.drive.motors = 2;
    const workflow::LoggedAxis axis = workflow::logged_axis(log_of(text), options);
    EXPECT_DOUBLE_EQ(axis.runs.at(0).f.y.at(0), 30.0) << name;
    EXPECT_THAT(axis.notes, Contains(HasSubstr("is taken for the sum of what they give"))) << name;
  }
  // What one drive calls the total of its own setpoint.
  std::string text = "t [s],y [mm],Y Current setpoint total [A]\n";
  for (int k = 0; k < 10; ++k) text += fmt::format("{},{},3\n", 0.001 * k, k);
  workflow::LogOptions options{.axis = "y"};
  options.drive.per_ampere = "20 N/A";
  options.drive.motors = 2;
  EXPECT_DOUBLE_EQ(workflow::logged_axis(log_of(text), options).runs.at(0).f.y.at(0), 60.0);
}

TEST(LogAxis, AllThatIsMissingIsProposedAtOnce) {
  const std::string told = refusal("time,y_cmd,y_act,y_force\n0,1,1,5\n0.001,2,2,6\n0.002,3,3,7\n");
  EXPECT_THAT(
      told,
      HasSubstr("--map t=\"time s\" --map x=\"y_act mm\" --map r=\"y_cmd mm\" --map force=\"y_force N\""));
  // Of the axis that is asked for.
  workflow::LogOptions y;
  y.axis = "y";
  EXPECT_THAT(refusal("t [s],x_pos,x_current,y_pos,y_current\n0,1,1,5,2\n0.001,2,2,6,2\n0.002,3,3,7,2\n", y),
              HasSubstr("--map x=\"y_pos mm\" --map current=\"y_current A\""));
  // Steps of 125 are microseconds rather than milliseconds; the unit that the file has stays.
  EXPECT_THAT(refusal("time,pos [um],Motor Current\n0,1,5\n125,2,6\n250,3,7\n"),
              HasSubstr("--map t=\"time us\" --map x=\"pos um\" --map current=\"Motor Current A\""));
  // A time that was made of two columns has no name that could be typed.
  const std::string ros =
      refusal("stamp.sec,stamp.nanosec,pos,force\n1,0,1,5\n1,2000000,2,6\n1,4000000,3,7\n");
  EXPECT_THAT(ros, HasSubstr("--map x=\"pos mm\" --map force=\"force N\""));
  // ROS counts in SI units; a name with quotes stands between the other ones.
  EXPECT_THAT(refusal("%time,field.position0,field.effort0\n0,1,5\n1000000,2,6\n2000000,3,7\n"),
              HasSubstr("--map x=\"field.position0 m\" --map force=\"field.effort0 N\""));
  EXPECT_THAT(refusal("Timestamp;\"Axis_1\".ActualPosition;\"Axis_1\".Torque\n0;1;5\n1;2;6\n2;3;7\n"),
              HasSubstr("--map x='\"Axis_1\".ActualPosition mm'"));
  EXPECT_THAT(ros, testing::Not(HasSubstr("--map t=")));
}

TEST(LogAxis, RowsAndRuns) {
  const std::string text = csv("t [s],part,x [mm],f [N]", {"t", "part", "x_mm", "f"});
  const ident::log::RawLog one = axis_of(text, {.where = {"part=1"}});
  EXPECT_EQ(one.x.y.size(), 1000U);
  EXPECT_EQ(one.row.front(), 1001U);
  EXPECT_NEAR(one.x.t.front(), 1.0, 1e-9);
  const workflow::LoggedAxis runs = workflow::logged_axis(log_of(text), {.runs = {"part"}});
  ASSERT_EQ(runs.runs.size(), 3U);
  EXPECT_THAT(runs.runs[2].source, HasSubstr("part=2"));
  EXPECT_EQ(runs.runs[2].x.y.size(), 1000U);
  EXPECT_THAT(refusal(text, {.where = {"part=7"}}), AllOf(HasSubstr("--where"), HasSubstr("no row")));
  EXPECT_THAT(refusal(text, {.where = {"teil=1"}}), AllOf(HasSubstr("--where"), HasSubstr("teil")));
  EXPECT_THAT(refusal(text, {.where = {"part=one"}}), HasSubstr("a number"));
  EXPECT_THAT(refusal(text, {.runs = {"parts"}}), AllOf(HasSubstr("--runs"), HasSubstr("part")));
}

TEST(LogAxis, MapFileSaysTheSame) {
  const Folder folder;
  const std::string map = folder.write("map.toml",
                                       "map = [\"x=weg mm\", \"current=i_motor A\"]\ngain = \"2 N/A\"\n"
                                       "keep = [\"unsigned\"]\n");
  const std::string text = csv("t [s],weg,i_motor", {"t", "x_mm", "f"});
  workflow::LogOptions options;
  const auto with = [&](const std::string& file) { return workflow::with_map_file(options, file); };
  const ident::log::RawLog raw = axis_of(text, with(map));
  EXPECT_NEAR(raw.x.y[kRow], x_at(), 1e-8);
  const double f = axis_of(csv("t [s],x [mm],f [N]", {"t", "x_mm", "f"})).f.y[kRow];
  EXPECT_NEAR(raw.f.y[kRow], 2.0 * f, 1e-4);
  options.gain = "3 N/A";  // the command line goes first
  EXPECT_NEAR(axis_of(text, with(map)).f.y[kRow], 3.0 * f, 1e-4);
  const std::string bad = folder.write("bad.toml", "maps = [\"x=weg mm\"]\n");
  try {
    static_cast<void>(with(bad));
    ADD_FAILURE() << "accepted";
  } catch (const io::InputError& e) {
    EXPECT_THAT(e.problems().front().text(), AllOf(HasSubstr("maps"), HasSubstr("map")));
  }
}

TEST(Inspect, SaysWhatALogHolds) {
  std::string text = csv("t [s],x [mm],u [V]", {"t", "x_mm", "volts"});
  const workflow::Inspection good = workflow::inspect(log_of(text), {});
  EXPECT_TRUE(good.usable);
  EXPECT_THAT(good.text, AllOf(HasSubstr("CSV, 3000 rows"), HasSubstr("x         x [mm]"),
                               HasSubstr("1 ms between rows"), HasSubstr("none: the log is used as it is"),
                               HasSubstr("Can be identified")));
  EXPECT_EQ(good.json["schema"], "stribeck.inspect/1");
  EXPECT_EQ(good.json["records"].size(), 1U);
  EXPECT_EQ(good.json["motion"]["force_unit"], "V");
  EXPECT_TRUE(good.json["refused"].is_null());
  // A gap is found with its row, and the log is used in two pieces.
  std::size_t from = 0;
  for (int line = 0; line <= 1000; ++line) from = text.find('\n', from) + 1;
  std::size_t to = from;
  for (int line = 0; line < 200; ++line) to = text.find('\n', to) + 1;
  text.erase(from, to - from);
  const workflow::Inspection gap = workflow::inspect(log_of(text), {});
  EXPECT_THAT(gap.text, AllOf(HasSubstr("gap: row 1001"), HasSubstr("2 records")));
  EXPECT_EQ(gap.json["findings"][0]["row"], 1001);
  EXPECT_EQ(gap.json["findings"][0]["repaired"], true);
  // What cannot be used is no error but an answer.
  const workflow::Inspection none =
      workflow::inspect(log_of(csv("t [s],a [K],b [N]", {"t", "x_mm", "f"})), {});
  EXPECT_FALSE(none.usable);
  EXPECT_THAT(none.text, AllOf(HasSubstr("Cannot be used"), HasSubstr("--map x=")));
  EXPECT_FALSE(none.json["refused"].is_null());
}

TEST(LogAxis, PressureIsAForceWithAGain) {
  const std::string text = csv("t [s],x [mm],dp [bar]", {"t", "x_mm", "percent"});
  const double percent_to_newton = 5.0;
  workflow::LogOptions options;
  options.maps = {"pressure=dp bar"};
  options.gain = "5 N/bar";
  const ident::log::RawLog raw = axis_of(text, options);
  const ident::log::RawLog force = axis_of(csv("t [s],x [mm],f [N]", {"t", "x_mm", "f"}));
  for (const std::size_t k : {0U, 700U, 2500U})
    EXPECT_NEAR(raw.f.y.at(k), force.f.y.at(k), 1e-5 * percent_to_newton);
  // It is never taken by itself, and the way out is named.
  EXPECT_THAT(refusal(text), HasSubstr("pressure"));
  options.maps = {"force=dp bar"};
  EXPECT_THAT(refusal(text, options), HasSubstr("--map pressure=\"dp bar\""));
}

TEST(LogAxis, TorqueWithoutAUnitSaysWhatToGive) {
  const auto logged = workflow::logged_axis(log_of(csv("t [s],x [mm],torque", {"t", "x_mm", "percent"})), {});
  EXPECT_THAT(logged.notes, Contains(HasSubstr("--map torque=\"torque N m\"")));
}

// Names that no tool of a drive has: of each kind of unit there is one column.
TEST(LogAxis, AColumnWithTheOnlyUnitOfItsKindIsTaken) {
  const std::string text = csv("sec,load_coord_mm,i_q_A", {"t", "x_mm", "f"});
  const workflow::LoggedAxis axis = workflow::logged_axis(log_of(text), {});
  EXPECT_NEAR(axis.runs.at(0).x.y[100], 1e-3 * log_of(text).columns[1].values[100], 1e-12);
  EXPECT_EQ(axis.runs.at(0).f.y[100], log_of(text).columns[2].values[100]);
  EXPECT_THAT(
      axis.notes,
      Contains(HasSubstr(
          "column \"load_coord_mm\" is taken as the position: no other has a unit of length or angle")));
  // Neither two of them nor a command or an error by its name.
  EXPECT_THAT(refusal(csv("sec,load_coord_mm,head_coord_mm,out_N", {"t", "x_mm", "x_mm", "f"})),
              HasSubstr("no column for the position"));
  EXPECT_THAT(refusal(csv("sec,cmd_mm,out_N", {"t", "x_mm", "f"})), HasSubstr("no column for the position"));
  for (const char* name : {"following error", "FollowingError", "x_err", "Lageabweichung", "TrajPos", "temp"})
    EXPECT_THAT(refusal(csv(std::string("sec,") + name + " [mm],out_N", {"t", "x_mm", "f"})),
                HasSubstr("no column for the position"))
        << name;
  workflow::LogOptions of_x;
  of_x.axis = "x";
  EXPECT_THAT(refusal(csv("sec,y table [mm],out_N", {"t", "x_mm", "f"}), of_x),
              HasSubstr("no column for the position"));
}

}  // namespace
}  // namespace stribeck::test::log_axis_test
