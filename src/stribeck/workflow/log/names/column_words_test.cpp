#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stribeck/io/error.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>
#include <string>
#include <tuple>
#include <vector>

namespace stribeck::test::column_words_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using workflow::LogOptions;
using workflow::LogQuantity;
using workflow::meaning_of;

TEST(ColumnWords, NamesOfDriveTools) {
  const std::vector<std::tuple<std::string, LogQuantity, std::string>> all{
      {"Position Actual", LogQuantity::kPosition, ""},
      {"Actual_Position", LogQuantity::kPosition, ""},
      {"Lageistwert", LogQuantity::kPosition, ""},
      {"Istposition X", LogQuantity::kPosition, "x"},
      {"Istwinkel", LogQuantity::kPosition, ""},
      {"Angle setpoint C", LogQuantity::kReference, "c"},
      {"MC_Axis.ActPos", LogQuantity::kPosition, "mc_axis"},
      {"xist", LogQuantity::kPosition, ""},
      {"PosCmdX", LogQuantity::kReference, "x"},
      {"xActPos", LogQuantity::kPosition, "x"},
      {"CurY", LogQuantity::kCurrent, "y"},
      {"Cur2", LogQuantity::kCurrent, "2"},
      {"J1 pos cmd", LogQuantity::kReference, "j1"},
      {"Quota comandata", LogQuantity::kReference, ""},
      {"Quota reale", LogQuantity::kPosition, ""},
      {"Istweg", LogQuantity::kPosition, ""},
      {"Sollweg", LogQuantity::kReference, ""},
      {"Goal Position", LogQuantity::kReference, ""},
      {"Present Position", LogQuantity::kPosition, ""},
      {"TrqZ", LogQuantity::kTorque, "z"},
      {"r0482[0]", LogQuantity::kPosition, ""},
      {"Lagesollwert", LogQuantity::kReference, ""},
      {"Position Setpoint", LogQuantity::kReference, ""},
      {"xsoll", LogQuantity::kReference, ""},
      {"Motor Speed", LogQuantity::kVelocity, ""},
      {"Drehzahlistwert", LogQuantity::kVelocity, ""},
      {"r0063", LogQuantity::kVelocity, ""},
      {"Velocity command", LogQuantity::kReferenceVelocity, ""},
      {"Motor Current", LogQuantity::kCurrent, ""},
      {"Stromistwert", LogQuantity::kCurrent, ""},
      {"Strom Motor X", LogQuantity::kCurrent, "x"},
      {"iq", LogQuantity::kCurrent, ""},
      {"r0078", LogQuantity::kCurrent, ""},
      {"TorqueFeedback", LogQuantity::kTorque, ""},
      {"Drehmoment", LogQuantity::kTorque, ""},
      {"Momentenistwert", LogQuantity::kTorque, ""},
      {"Kraftistwert", LogQuantity::kForce, ""},
      {"Spannungsistwert", LogQuantity::kVoltage, ""},
      {"AktPos", LogQuantity::kPosition, ""},
      {"axis0.encoder.pos_estimate", LogQuantity::kPosition, "axis0"},
      {"PL.FB", LogQuantity::kPosition, ""},
      {"PL.CMD", LogQuantity::kReference, ""},
      {"VL.FB", LogQuantity::kVelocity, ""},
      {"IL.CMD", LogQuantity::kCurrent, ""},
      {"axis0.controller.pos_setpoint", LogQuantity::kReference, "axis0"},
      {"/joint_states/joint_z/effort", LogQuantity::kForce, "/joint_states/joint_z"},
      {"/joint_states/position[0]", LogQuantity::kPosition, "0"},
      {"MC_Axis000.Act.Pos", LogQuantity::kPosition, "mc_axis000"},
      {"MC_Axis000.Cmd.Pos", LogQuantity::kReference, "mc_axis000"},
      {"MC_Axis000.Act.Trq", LogQuantity::kTorque, "mc_axis000"},
      {"Position Feedback (PL.FB)", LogQuantity::kPosition, ""},
      {"Current Feedback (IL.FB)", LogQuantity::kCurrent, ""},
      {"Pos_fb", LogQuantity::kPosition, ""},
      {"Achse X Istgeschw.", LogQuantity::kVelocity, "x"},
      {"r0063 Drehzahlistwert", LogQuantity::kVelocity, ""},
      {"r0063[0] Speed actual value", LogQuantity::kVelocity, ""},
      {"r0080 Drehmomentistwert", LogQuantity::kTorque, ""},
      {"r0078 Stromistwert momentenbildend", LogQuantity::kCurrent, ""},
      {"r0025 Lageistwert", LogQuantity::kPosition, ""},
      {"Lageistwert Geber 1", LogQuantity::kPosition, ""},
      {"S-0-0051, Position feedback value 1", LogQuantity::kPosition, ""},
      {"P-0-0434, Position command value of controller", LogQuantity::kReference, ""},
      {"S-0-0040", LogQuantity::kVelocity, ""},
      {"S-0-0084, Torque/force feedback value", LogQuantity::kTorque, ""},
      {"PositionActualValue 6064h", LogQuantity::kPosition, ""},
      {"TorqueActualValue 6077h", LogQuantity::kTorque, ""},
      {"stage_position", LogQuantity::kPosition, ""},
      {"control_force", LogQuantity::kForce, ""},
      {"Xaxis_motor_amps", LogQuantity::kCurrent, "x"}};
  for (const auto& [name, what, axis] : all) {
    const auto found = meaning_of(name);
    ASSERT_TRUE(found) << name;
    EXPECT_EQ(found->what, what) << name;
    EXPECT_EQ(found->axis, axis) << name;
  }
}

TEST(ColumnWords, VariablesOfControls) {
  const std::vector<std::tuple<std::string, LogQuantity, std::string>> all{
      {"FPOS(0)", LogQuantity::kPosition, "0"},
      {"RPOS(0)", LogQuantity::kReference, "0"},
      {"FVEL(0)", LogQuantity::kVelocity, "0"},
      {"PFB", LogQuantity::kPosition, ""},
      {"PCMD", LogQuantity::kReference, ""},
      {"VFB", LogQuantity::kVelocity, ""},
      {"ICMD", LogQuantity::kCurrent, ""},
      {"MPOS AXIS(0)", LogQuantity::kPosition, "0"},
      {"DPOS AXIS(0)", LogQuantity::kReference, "0"},
      {"gAxis01, ParID 111: PCTRL_S_ACT", LogQuantity::kPosition, "gaxis01"},
      {"gAxis01, ParID 113: PCTRL_S_SET", LogQuantity::kReference, "gaxis01"},
      {"gAxis01, ParID 277: TORQUE_ACT", LogQuantity::kTorque, "gaxis01"}};
  for (const auto& [name, quantity, axis] : all) {
    const auto found = meaning_of(name, "");
    ASSERT_TRUE(found) << name;
    EXPECT_EQ(found->what, quantity) << name;
    EXPECT_EQ(found->axis, axis) << name;
  }
}

TEST(ColumnWords, NamesInOtherLanguages) {
  const std::vector<std::tuple<std::string, LogQuantity, std::string>> all{
      {"位置フィードバック", LogQuantity::kPosition, ""},
      {"X軸位置指令", LogQuantity::kReference, "x"},
      {"モータ回転速度", LogQuantity::kVelocity, ""},
      {"トルク指令", LogQuantity::kTorque, ""},
      {"X轴实际位置", LogQuantity::kPosition, "x"},
      {"电机电流", LogQuantity::kCurrent, ""},
      {"实际转矩", LogQuantity::kTorque, ""},
      {"Vitesse réelle", LogQuantity::kVelocity, ""},
      {"Couple moteur", LogQuantity::kTorque, ""},
      {"Posición real", LogQuantity::kPosition, ""},
      {"Velocità motore", LogQuantity::kVelocity, ""},
      {"Corrente asse Y", LogQuantity::kCurrent, "y"},
      {"Position de consigne Z", LogQuantity::kReference, "z"},
      {"POSITION RÉELLE", LogQuantity::kPosition, ""},
      {"Valore di velocità motore", LogQuantity::kVelocity, ""},
      {"Posição de referência eixo X", LogQuantity::kReference, "x"},
      {"Werkelijke positie", LogQuantity::kPosition, ""},
      {"Pozycja zadana", LogQuantity::kReference, ""},
      {"ŽÁDANÁ POLOHA", LogQuantity::kReference, ""},
      {"Скорость", LogQuantity::kVelocity, ""},
      {"Заданное положение", LogQuantity::kReference, ""},
      {"Фактический момент", LogQuantity::kTorque, ""},
      {"X축 실제 위치", LogQuantity::kPosition, "x"},
      {"토크 지령", LogQuantity::kTorque, ""},
      {"0x6064:000: Position actual value", LogQuantity::kPosition, ""}};
  for (const auto& [name, what, axis] : all) {
    const auto found = meaning_of(name, "");
    ASSERT_TRUE(found) << name;
    EXPECT_EQ(found->what, what) << name;
    EXPECT_EQ(found->axis, axis) << name;
  }
  // The type in front of a name of a PLC program.
  EXPECT_EQ(meaning_of("ST_X.fActTorque", "")->what, LogQuantity::kTorque);
  EXPECT_EQ(meaning_of("ST_X.lrSetPos", "")->what, LogQuantity::kReference);
  EXPECT_EQ(meaning_of("nAct", "")->what, LogQuantity::kVelocity);
  // A deviation is no position.
  EXPECT_FALSE(meaning_of("位置偏差", "mm"));
}

// "Z act" is what its unit says.
TEST(ColumnWords, UnitTellsTheQuantityOfActualAndCommanded) {
  const std::vector<std::tuple<std::string, std::string, LogQuantity, std::string>> all{
      {"Z act", "mm", LogQuantity::kPosition, "z"},
      {"Z set", "mm", LogQuantity::kReference, "z"},
      {"setpoint", "deg", LogQuantity::kReference, ""},
      {"actual", "mm/s", LogQuantity::kVelocity, ""},
      {"Istwert", "rpm", LogQuantity::kVelocity, ""},
      {"C actual", "N m", LogQuantity::kTorque, "c"},
      {"feedback", "A", LogQuantity::kCurrent, ""},
      {"z soll", "mm/s", LogQuantity::kReferenceVelocity, "z"}};
  for (const auto& [name, unit, what, axis] : all) {
    const auto found = meaning_of(name, unit);
    ASSERT_TRUE(found) << name;
    EXPECT_EQ(found->what, what) << name;
    EXPECT_EQ(found->axis, axis) << name;
  }
  for (const char* unit : {"", "V", "degC", "%", "1"}) EXPECT_FALSE(meaning_of("actual", unit)) << unit;
  EXPECT_FALSE(meaning_of("motor", "mm"));
}

TEST(ColumnWords, OtherNamesHaveNoMeaning) {
  for (const char* name :
       {"", "PosError", "following error", "Position Velocity", "actual", "motor", "x", "state", "r0002",
        "run", "temperature", "current limit", "...", "Position Present", "Speed Active"})
    EXPECT_FALSE(meaning_of(name)) << name;
  EXPECT_FALSE(meaning_of(std::string(100000, 'v')));
}

/// A log of three columns whose law is known: 50 kg, 10 N; one sine alone would look like a spring.
std::string log_with(const std::string& header, double scale = 1.0) {
  std::string out = header + "\n";
  for (int k = 0; k < 4000; ++k) {
    const double t = 1e-3 * k, w = 2.0 * std::numbers::pi, u = 3.3 * w;
    const double x = 0.05 * std::sin(w * t) + 0.006 * std::sin(u * t);
    const double v = 0.05 * w * std::cos(w * t) + 0.006 * u * std::cos(u * t);
    const double a = -0.05 * w * w * std::sin(w * t) - 0.006 * u * u * std::sin(u * t);
    const double f = 50.0 * a + (v > 0.0 ? 10.0 : -10.0) + 0.3 * std::sin(997.0 * t * t);
    out += std::to_string(t) + "," + std::to_string(1e3 * x) + "," + std::to_string(scale * f) + "\n";
  }
  return out;
}

double mass_of(const std::string& text, const LogOptions& options,
               std::vector<std::string>* notes = nullptr) {
  return workflow::condition_log(io::parse_log(text, "log.csv"), options, notes).rough.mass;
}

TEST(ColumnWords, LogsAreReadWithoutMap) {
  for (const char* header :
       {"Time (s),Position Actual (mm),Motor Force (N)", "Zeit [s],Lageistwert [mm],Kraftistwert [N]",
        "t [s],Z act (mm),Z act (N)", "Time [s],MC_Axis.ActPos [mm],MC_Axis.Force [N]"})
    EXPECT_NEAR(mass_of(log_with(header), {}), 50.0, 1.0) << header;
  LogOptions gain;
  gain.gain = "10 N/A";
  for (const char* header : {"t [s],xist [mm],iq [A]", "t [s],r0482 [mm],r0078 [A]",
                             "Zeit [s],Istposition X (mm),Strom Motor X (A)"})
    EXPECT_NEAR(mass_of(log_with(header, 0.1), gain), 50.0, 1.0) << header;
}

/// The columns that are taken for the axis, by quantity.
std::vector<std::string> taken(const std::string& header, const std::string& axis = "",
                               const std::string& lead = "") {
  LogOptions o;
  o.axis = axis;
  o.lead = lead;
  std::string text = header + "\n";
  const auto columns = std::count(header.begin(), header.end(), ',') + 1;
  for (int k = 0; k < 50; ++k) {
    for (int c = 0; c < columns; ++c)
      text += (c == 0 ? "" : ",") + std::to_string(c == 0 ? 1e-3 * k : 0.1 * k * c);
    text += "\n";
  }
  std::vector<std::string> out;
  for (const auto& [quantity, column] : workflow::logged_axis(io::parse_log(text, "log.csv"), o).columns)
    out.push_back(quantity + "=" + column.substr(0, column.find(" [")));
  return out;
}

// Of two forces the one that is known in newtons, and one with a unit before one without.
TEST(ColumnWords, TheForceWhoseScaleIsKnownIsTaken) {
  using ::testing::Contains;
  EXPECT_THAT(taken("t [s],Lageistwert [mm],Strom,Drehmomentistwert [Nm]"),
              Contains("torque=Drehmomentistwert"));
  EXPECT_THAT(taken("t [s],Lageistwert [mm],Strom [A],Drehmomentistwert [Nm]"), Contains("current=Strom"));
  EXPECT_THAT(taken("t [s],Lageistwert [mm],Strom [A],Drehmomentistwert [Nm]", "", "10 mm"),
              Contains("torque=Drehmomentistwert"));
}

TEST(ColumnWords, SignalsOfHalAreDividedByHyphens) {
  using ::testing::UnorderedElementsAre;
  EXPECT_THAT(taken("t [s],x-cmd [mm],x [mm],u [V]"), UnorderedElementsAre("r=x-cmd", "x=x", "voltage=u"));
  EXPECT_THAT(taken("t [ms],pos [um],cmd [um],current [A]"),
              UnorderedElementsAre("r=cmd", "x=pos", "current=current"));
  EXPECT_THAT(taken("t [s],z-pos-cmd [mm],z-pos-act [mm],z-force [N]"),
              UnorderedElementsAre("r=z-pos-cmd", "x=z-pos-act", "force=z-force"));
}

TEST(ColumnWords, NumbersOfAxesAndObjectsOfCia402) {
  using ::testing::ElementsAre;
  EXPECT_THAT(taken("t [s],Axis 1 ActPos [mm],Axis 1 Torque [%]"),
              ElementsAre("x=Axis 1 ActPos", "percent=Axis 1 Torque"));
  EXPECT_THAT(taken("t [s],POSF(1) [mm],VCMD(1) [mm/s],TCMD(1) [%]", "1"),
              ElementsAre("x=POSF(1)", "v_ref=VCMD(1)", "percent=TCMD(1)"));
  EXPECT_THAT(taken("t [s],6064h [mm],606Ch [mm/s],6077h [per mille]"),
              ElementsAre("x=6064h", "v=606Ch", "percent=6077h"));
  EXPECT_THAT(taken("t [s],0x6064:00 [mm],0x6062:00 [mm],0x6078:00 [A]"),
              ElementsAre("x=0x6064:00", "r=0x6062:00", "current=0x6078:00"));
  // Torque and current are per mille of the rated ones, by definition of the object; their names may stand behind the index.
  EXPECT_THAT(taken("t [s],0x6064:00 Position actual value [mm],0x6077:00 Torque actual value"),
              ElementsAre("x=0x6064:00 Position actual value", "percent=0x6077:00 Torque actual value"));
  EXPECT_THAT(taken("t [s],Y.6064h [mm],Y.6077h", "y"), ElementsAre("x=Y.6064h", "percent=Y.6077h"));
  for (const char* name : {"6064", "6064h:01", "0x60640", "0x1234", "h", "0x", "606gh"})
    EXPECT_FALSE(meaning_of(name)) << name;
}

// What the unit alone tells does no harm to a log that calls its columns by name.
TEST(ColumnWords, ForeignColumnsAreLeftAlone) {
  using ::testing::ElementsAre;
  EXPECT_THAT(taken("t [s],x [mm],F [N],S1 act [rpm],S2 act [rpm]"), ElementsAre("x=x", "force=F"));
  EXPECT_THAT(taken("t [s],x [mm],F [N],C set [deg]"), ElementsAre("x=x", "force=F"));
  EXPECT_THAT(taken("t [s],x [mm],F [N],Target 1 [mm],Target 2 [mm]"), ElementsAre("x=x", "force=F"));
  EXPECT_THAT(taken("t [s],Axis position [mm],Motor angle [deg],Motor force [N]"),
              ElementsAre("x=Axis position", "force=Motor force"));
  EXPECT_THAT(taken("t [s],Position (X) [mm],Position (Y) [mm],Force (X) [N],Force (Y) [N]", "y"),
              ElementsAre("x=Position (Y)", "force=Force (Y)"));
  // A column with the name of the axis is its position, though x is also the name of any position.
  EXPECT_THAT(taken("t [s],x [mm],y [mm],X force [N],Y force [N]", "y"), ElementsAre("x=y", "force=Y force"));
}

TEST(ColumnWords, UnitAloneTellsTheForce) {
  std::vector<std::string> notes;
  EXPECT_NEAR(mass_of(log_with("t [s],x [mm],AI3 [N]"), {}, &notes), 50.0, 1.0);
  EXPECT_THAT(notes, Contains(HasSubstr("\"AI3 [N]\" is taken as the force")));
}

TEST(ColumnWords, SharesOfTheRatedTorque) {
  // 100 % are 500 N.
  LogOptions o;
  for (const char* gain : {"500 N", "5 N/%", "0.5 N/\u2030"}) {
    o.gain = gain;
    EXPECT_NEAR(mass_of(log_with("t [s],x [mm],torque [%]", 0.2), o), 50.0, 1.0) << gain;
    EXPECT_NEAR(mass_of(log_with("t [s],x [mm],torque [\u2030]", 2.0), o), 50.0, 1.0) << gain;
  }
  // 2.5 N m at 100 % behind 5 mm per turn are 3141.6 N.
  o.gain = "2.5 N m";
  o.lead = "5 mm";
  const double percent = 100.0 / (2.5 * 2.0 * std::numbers::pi / 5e-3);
  std::string text = log_with("t [s],x [deg],torque [%]", percent);
  // The numbers of x are those of millimetres; a degree is 5 mm / 360, which makes the motion 72 times smaller.
  EXPECT_NEAR(mass_of(text, o), 72.0 * 50.0, 72.0);
}

TEST(ColumnWords, OtherScaleOfMapIsSaid) {
  LogOptions o;
  o.maps = {"x=x m"};
  std::vector<std::string> notes;
  const io::Log log = io::parse_log(log_with("t [s],x [mm],f [N]"), "log.csv");
  notes = workflow::logged_axis(log, o).notes;
  EXPECT_THAT(notes, Contains(HasSubstr("has the unit mm in the file; --map gives m instead, 1000 times")));
}

TEST(ColumnWords, MapWithoutItsColumnNamesTheSideFile) {
  LogOptions o;
  o.maps = {"r=ref mm"};
  EXPECT_THAT([&] { workflow::logged_axis(io::parse_log(log_with("t [s],x [mm],f [N]"), "log.csv"), o); },
              ::testing::ThrowsMessage<io::InputError>(HasSubstr("log.csv.toml with columns")));
}

}  // namespace
}  // namespace stribeck::test::column_words_test
