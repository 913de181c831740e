// export and evaluate: every option, bad input, the same bytes, nothing half-written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <tests/cli/command.hpp>

namespace stribeck::test::export_test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::string kSource = STRIBECK_SOURCE_DIR;

constexpr const char* kAxis = R"(mass = "1 N s2/mm"
load = "10 N"
[friction]
steady = { kind = "conventional", alpha0 = "18 N", alpha2 = "4.5 N s/mm", stribeck = { alpha1 = "33 N", v0 = "0.6 mm/s", delta = 2 } }
eccentric = [{ amplitude = "4.2 N", period = "2 mm", phase = "0.28 rad", form = "additive" }]
)";

std::string uniaxial() { return text_of(kSource + "/machines/uniaxial-drive.toml"); }

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

std::map<std::string, std::string> texts_in(const std::string& folder) {
  std::map<std::string, std::string> texts;
  for (const auto& entry : fs::directory_iterator(folder))
    texts[entry.path().filename().string()] = text_of(entry.path().string());
  return texts;
}

std::vector<std::string> to_linuxcnc(std::vector<std::string> words) {
  words.insert(words.begin(), "export");
  words.insert(words.end(), {"--to", "linuxcnc"});
  return words;
}

/// Exit code 2 and one line that holds the text; nothing written in the folder.
void expect_refused(const Folder& f, std::vector<std::string> words, const std::string& text) {
  const std::size_t before = f.files();
  const Said said = command(std::move(words));
  EXPECT_EQ(said.code, 2) << said.out;
  EXPECT_THAT(said.err, AllOf(StartsWith("stribeck: "), HasSubstr(text)));
  EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
  EXPECT_EQ(f.files(), before) << text;
}

TEST(Export, ControllersOfAxisFiles) {
  const Folder f;
  const std::string x = f.write("x.toml", kAxis);
  const Said said = command(to_linuxcnc(
      {x, x, "--omega", "60 rad/s", "--feedforward", "steady", "--json", f / "e.json", "-o", f / "a.hal"}));
  ASSERT_EQ(said.code, 0) << said.err;
  const std::string hal = text_of(f / "a.hal");
  for (const char* line :
       {"# loadrt stribeck_axis names=ax.x,ax.y\n", "setp ax.x.omega 60\n",
        "setp ax.y.feedforward 1  # steady (0 none, 1 steady, 2 dynamic, 3 reversal)\n",
        "setp ax.x.law 0  # contouring (0 contouring, 1 sliding-mode, 2 predictive, 3 learning)\n",
        "setp ax.x.observer 0  # none (0 none, 1 disturbance, 2 kalman, 3 adaptive)\n",
        "setp ax.x.adaptation.enabled 0  # ", "setp ax.x.mass 1000\n", "setp ax.x.load 10\n",
        "setp ax.y.friction.conventional.alpha0 18\n", "setp ax.x.friction.conventional.stribeck.v0 0.0006\n",
        "setp ax.x.friction.eccentric.0.amplitude 4.2\n"}) {
    EXPECT_THAT(hal, HasSubstr(line));
  }
  EXPECT_EQ(nlohmann::json::parse(text_of(f / "e.json"))["file"], f / "a.hal");
  EXPECT_THAT(hal, testing::Not(HasSubstr("position-unit")));
  // LinuxCNC counts rotary axes in degrees.
  const std::string rotary = f.write("rotary.toml", "rotary = true\n" + text_of(x));
  ASSERT_EQ(command(to_linuxcnc({rotary, "--name", "ax.c", "-o", f / "c.hal", "--quiet"})).code, 0);
  EXPECT_THAT(text_of(f / "c.hal"), HasSubstr("setp ax.c.position-unit 0.0174532"));
  // Without bristles the feed-forward is the reversal logic; 40 rad/s are the default.
  ASSERT_EQ(command(to_linuxcnc({x, "--name", "ct.0", "-o", f / "b.hal", "--quiet"})).code, 0);
  EXPECT_THAT(text_of(f / "b.hal"),
              AllOf(HasSubstr("setp ct.0.feedforward 3  # reversal"), HasSubstr("setp ct.0.omega 40\n")));
}

TEST(Export, DrivesOfAMachine) {
  const Folder f;
  const Said said = command(to_linuxcnc({kSource + "/machines/uniaxial-drive.toml", "-o", f / "p.hal"}));
  ASSERT_EQ(said.code, 0) << said.err;
  const std::string hal = text_of(f / "p.hal");
  EXPECT_THAT(hal, HasSubstr("setp pl.x.current.gain 1\n"));
  EXPECT_THAT(hal, HasSubstr("setp pl.x.noise.distribution 1  # uniform\n"));
  // Left out in the file, because uniform noise has none; a zero would be refused.
  EXPECT_THAT(hal, Not(HasSubstr("correlation-time")));
  EXPECT_THAT(hal, Not(HasSubstr("ax.")));
}

/// The table in a HAL file, by name.
std::vector<std::pair<double, double>> table_in(const std::string& hal, const std::string& name) {
  std::vector<std::pair<double, double>> points;
  for (int i = 0; i < 16; ++i) {
    const auto value = [&](const char* axis) -> double {
      const std::string key = name + "." + axis + "-val-" + (i < 10 ? "0" : "") + std::to_string(i) + " ";
      const auto at = hal.find(key);
      return at == std::string::npos ? NAN : std::stod(hal.substr(at + key.size()));
    };
    points.emplace_back(value("x"), value("y"));
  }
  return points;
}

TEST(Export, LincurveTableAndItsError) {
  const Folder f;
  const std::string x = f.write("x.toml", kAxis);
  const Said said = command(
      to_linuxcnc({x, "--lincurve", "--speed", "16 mm/s", "-o", f / "l.hal", "--json", f / "l.json"}));
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, AllOf(HasSubstr("ff.x: 16 points from -16 to 16 mm/s:"),
                              HasSubstr("4.20 N periodic in position")));
  const std::string hal = text_of(f / "l.hal");
  EXPECT_THAT(hal, AllOf(HasSubstr("# loadrt lincurve names=ff.x personality=16\n"),
                         HasSubstr("pid.bias for the load: 10")));
  const auto points = table_in(hal, "ff.x");
  // The component's own arithmetic against the law of the file, written down here once more on purpose.
  const auto table = [&](double v) -> double {
    for (std::size_t i = 1; i < points.size(); ++i) {
      const auto& [a, fa] = points[i - 1];
      const auto& [b, fb] = points[i];
      if (v <= b) return fa + (fb - fa) * (v - a) / (b - a);
    }
    return NAN;
  };
  double worst = 0.0;
  double square = 0.0;
  constexpr int kSteps = 40000;
  for (int i = 0; i < kSteps; ++i) {
    const double v = -16.0 + 32.0 * (i + 0.5) / kSteps;
    const double level = 18.0 + 15.0 * std::exp(-(v / 0.6) * (v / 0.6));
    const double e = table(v) - (std::copysign(level, v) + 4.5 * v);
    worst = std::max(worst, std::abs(e));
    square += e * e / kSteps;
  }
  const auto json = nlohmann::json::parse(text_of(f / "l.json"))["lincurve"][0];
  EXPECT_NEAR(json["max_error_N"].get<double>(), worst, 1e-3);
  EXPECT_NEAR(json["rms_error_N"].get<double>(), std::sqrt(square), 1e-3);
  // 65 N of steady friction in 16 points, 15 of them in the Stribeck part.
  EXPECT_LT(worst, 0.1);
  EXPECT_GT(worst, 0.05);
  // The jump at zero: both limits side by side, and no Coulomb force at rest.
  EXPECT_NEAR(table(1e-5), 33.0, 0.1);
  EXPECT_NEAR(table(-1e-5), -33.0, 0.1);
  EXPECT_NEAR(table(0.0), 0.0, 0.1);
  for (std::size_t i = 1; i < points.size(); ++i) EXPECT_GT(points[i].first, points[i - 1].first);
}

// By direction, and over the range that was identified when no speed is given.
TEST(Export, LincurveOfAnAsymmetricMap) {
  const Folder f;
  const std::string x = f.write("x.toml", R"(mass = "57 N s2/mm"
[friction.steady]
kind = "gaussian"
velocity_range = ["-9.5 mm/s", "8 mm/s"]
positive = { eta0 = "700 N", eta1 = "100 N s/mm", gaussians = [{ a = "500 N", b = "3 mm/s", c = "2 mm/s" }] }
negative = { eta0 = "-500 N", eta1 = "100 N s/mm" }
)");
  ASSERT_EQ(command(to_linuxcnc({x, "--lincurve", "-o", f / "l.hal"})).code, 0);
  const auto points = table_in(text_of(f / "l.hal"), "ff.x");
  EXPECT_DOUBLE_EQ(points.front().first, -8.0);
  EXPECT_DOUBLE_EQ(points.back().first, 8.0);
  // The straight side needs two points, all others are where it bends.
  EXPECT_LT(points[1].first, 0.0);
  EXPECT_GT(points[2].first, 0.0);
  EXPECT_NEAR(points[1].second, -500.0, 1.0);
}

// A conventional model has no range of its own; identify writes it beside the model.
TEST(Export, TakesTheSpeedOfTheIdentification) {
  const Folder f;
  const std::string axis = R"([friction]
steady = { kind = "conventional", alpha0 = "18 N", alpha2 = "4.5 N s/mm" }
dynamics = { kind = "lugre", sigma0 = "20000 N/mm" }
)";
  const std::string mass = "mass = \"1 N s2/mm\"\n";
  const std::string x = f.write("x.toml", mass + "velocity_range = [\"-9 mm/s\", \"8 mm/s\"]\n" + axis);
  const Said table = command(to_linuxcnc({x, "--lincurve", "-o", f / "l.hal"}));
  EXPECT_EQ(table.code, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("from -8 to 8 mm/s"));
  const Said csv = command({"export", x, "--to", "csv", "-o", f / "x.csv"});
  EXPECT_EQ(csv.code, 0) << csv.err;
  EXPECT_THAT(csv.out, HasSubstr("to 8.000 mm/s"));
  const Said pulse = command({"export", x, x, "--to", "tnc", "-o", f / "x.txt"});
  EXPECT_EQ(pulse.code, 0) << pulse.err;
  EXPECT_THAT(pulse.out, HasSubstr("at 8.000 mm/s"));
  // The range changes nothing that does not depend on a speed.
  const std::string old = f.write("old.toml", mass + axis);
  for (const auto& [from, to] : {std::pair{x, "new.hal"}, {old, "old.hal"}})
    ASSERT_EQ(command(to_linuxcnc({from, "-o", f / to})).code, 0);
  EXPECT_EQ(replaced(replaced(text_of(f / "new.hal"), "x.toml", ""), "new.hal", ""),
            replaced(replaced(text_of(f / "old.hal"), "old.toml", ""), "old.hal", ""));
  const std::string asked = "--speed: missing: " + old + " does not say how fast the axis goes";
  expect_refused(f, to_linuxcnc({old, "--lincurve", "-o", f / "n.hal"}), asked);
  const std::string reversed =
      f.write("r.toml", mass + "velocity_range = [\"8 mm/s\", \"-9 mm/s\"]\n" + axis);
  expect_refused(f, to_linuxcnc({reversed, "-o", f / "n.hal"}),
                 "velocity_range: expected a lowest velocity below zero and a highest above zero");
}

// A straight line on each side takes two points each, and the component is told so.
TEST(Export, LincurveWithFewPoints) {
  const Folder f;
  const std::string x = f.write("x.toml",
                                "mass = \"1 N s2/mm\"\nfriction.steady = { kind = \"conventional\", alpha0 "
                                "= \"18 N\", alpha2 = \"2 N s/mm\" }\n");
  ASSERT_EQ(command(to_linuxcnc({x, x, "--lincurve", "--speed", "10 mm/s", "-o", f / "l.hal"})).code, 0);
  const std::string hal = text_of(f / "l.hal");
  EXPECT_THAT(hal, HasSubstr("# loadrt lincurve names=ff.x,ff.y personality=4,4\n"));
  EXPECT_THAT(hal, Not(HasSubstr("x-val-04")));
  const auto at = hal.find("setp ff.x.y-val-03 ");
  ASSERT_NE(at, std::string::npos);
  EXPECT_NEAR(std::stod(hal.substr(at + 19)), 38.0, 1e-3);
}

TEST(Export, TheExamplesAreWhatExportWrites) {
  const std::map<std::string, std::pair<std::string, std::vector<std::string>>> examples{
      {"triaxial", {"triaxial-tool", {"x", "y", "z"}}}, {"biaxial", {"biaxial-table", {"x", "y"}}}};
  for (const auto& [name, made_of] : examples) {
    const Folder f;
    const std::string folder = kSource + "/hal/examples/" + name;
    std::vector<std::string> words{kSource + "/machines/" + made_of.first + ".toml", "--quiet", "-o",
                                   f / "c"};
    for (const std::string& axis : made_of.second)
      words.insert(words.end(), {"--axis-file", axis + "=" + folder + "/" + axis + ".toml"});
    const Said said = command(to_linuxcnc(words));
    ASSERT_EQ(said.code, 0) << said.err;
    EXPECT_EQ(said.out, "");
    for (const auto& [file, text] : texts_in(f / "c"))
      EXPECT_EQ(text, text_of(folder + "/" + file)) << name << "/" << file << ": export it anew";
    EXPECT_EQ(text_of(f / "c/play.py"), text_of(kSource + "/hal/play.py"));
    EXPECT_NE(fs::status(f / "c/play.py").permissions() & fs::perms::owner_exec, fs::perms::none);
  }
}

TEST(Export, AWholeMachine) {
  const Folder f;
  const std::string mill = kSource + "/machines/five-axis-mill.toml";
  const std::vector<std::string> words = to_linuxcnc(
      {mill, "--parameters", "commissioning", "--omega", "50 rad/s", "--json", f / "m.json", "-o", f / "m"});
  const Said said = command(words);
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("machine.ini"));
  const auto texts = texts_in(f / "m");
  const std::string ini = texts.at("machine.ini");
  for (const char* line : {"DISPLAY = axis\n", "SERVO_PERIOD = 1000000\n",
                           "KINEMATICS = trivkins coordinates=xyzac\nJOINTS = 5\n",
                           "COORDINATES = X Y Z A C\n", "[JOINT_3]\nTYPE = ANGULAR\n"}) {
    EXPECT_THAT(ini, HasSubstr(line));
  }
  // Commissioning knows Coulomb friction alone.
  EXPECT_THAT(texts.at("control-lincurve.hal"), HasSubstr("personality=4,4,4,4,4\n"));
  EXPECT_THAT(texts.at("headless.ini"), HasSubstr("DISPLAY = ./play.py\n"));
  // 57.3 degrees are 100 mm; A goes to 120 mm.
  EXPECT_THAT(ini, HasSubstr("MAX_LIMIT = 68.7549354\n"));
  EXPECT_THAT(texts.at("drives.hal"), HasSubstr("setp pl.a.position-unit 0.00174532925"));
  // stock pid in N and mm: 0.85 N s2/mm at 50 rad/s.
  EXPECT_THAT(texts.at("control-pid.hal"), HasSubstr("setp pid.x.Pgain 2125\n"));
  // Supervision of everything, with the limits of the machine file in SI.
  for (const char* line :
       {"setp ax.x.supervision.checks 2  # all (0 none, 1 lost, 2 all)\n",
        "setp ax.x.supervision.speed-limit 0.03\n", "setp ax.x.supervision.acceleration-limit 0.2\n",
        "setp ax.c.supervision.speed-limit 0.08\n", "setp ax.a.encoder-resolution 5e-08\n"}) {
    EXPECT_THAT(texts.at("control-axis.hal"), HasSubstr(line));
  }
  // It follows from omega and the model.
  EXPECT_THAT(texts.at("control-axis.hal"), testing::Not(HasSubstr("following-error")));
  // Five axes are no path of stribeck_contour.
  EXPECT_EQ(texts.count("control-contour.hal"), 0u);
  EXPECT_THAT(ini, HasSubstr("# Or control-pid.hal, control-lincurve.hal.\n"));
  EXPECT_THAT(texts.at("control-lincurve.hal"), HasSubstr(" deg/s: "));
  // Degrees of the log are arcs of the machine file, for identify.
  EXPECT_THAT(texts.at("run.log.toml"), HasSubstr("\"a-cmd mm*1.74532925\""));
  // Circles in every plane: each linear axis is excited at twice as many speeds as in one.
  for (const char* plane : {"\nG17\nG1 X12 ", "\nG18\nG1 X12 ", "\nG19\nG1 Y"})
    EXPECT_THAT(texts.at("identify.ngc"), HasSubstr(plane));
  const auto json = nlohmann::json::parse(text_of(f / "m.json"));
  EXPECT_EQ(json["files"].size(), texts.size());
  // The same command again: the same bytes over the old ones.
  ASSERT_EQ(command(words).code, 0);
  EXPECT_EQ(texts_in(f / "m"), texts);
}

/// The value of a key in the n-th section [JOINT_n] of an INI file.
double of_joint(const std::string& ini, int joint, const std::string& key) {
  const auto section = ini.find("[JOINT_" + std::to_string(joint) + "]");
  const auto at = ini.find('\n' + key + " = ", section);
  return section == std::string::npos || at == std::string::npos ? NAN
                                                                 : std::stod(ini.substr(at + key.size() + 4));
}

// 250 N of the drive: friction at the largest speed, the term periodic in position, load, and mass times acceleration, by hand from the
// machine file. The Stribeck parts have faded there, and are below it at rest.
TEST(Export, LimitsThatTheDriveCanFollow) {
  const Folder f;
  const std::string mill = kSource + "/machines/five-axis-mill.toml";
  ASSERT_EQ(command(to_linuxcnc({mill, "--parameters", "commissioning", "--quiet", "-o", f / "m"})).code, 0);
  const std::string ini = text_of(f / "m/machine.ini");
  const auto acceleration = [&](int joint) { return of_joint(ini, joint, "MAX_ACCELERATION"); };
  EXPECT_NEAR(acceleration(1), (225.0 - 24.0 - 4.5 * 30.0 - 5.0) / 1.1, 0.1);
  EXPECT_NEAR(acceleration(2), (225.0 - 22.0 - 4.0 * 30.0 - 3.0 - 15.0) / 0.8, 0.1);
  EXPECT_NEAR(acceleration(3) * 1.74532925, (225.0 - 25.0 - 3.0 * 40.0 - 6.0) / 0.8, 0.1);
  for (const int joint : {0, 1, 2}) EXPECT_EQ(of_joint(ini, joint, "MAX_VELOCITY"), 30.0);
  EXPECT_THAT(ini, HasSubstr("MAX_LINEAR_ACCELERATION = 89.9\n"));
  EXPECT_THAT(ini, HasSubstr("# Of the drive's 250 N, friction takes 164 N at most"));
  EXPECT_THAT(ini, HasSubstr("The machine file has 200 mm/s2"));
  // C has force enough: as in the machine file.
  EXPECT_NEAR(acceleration(4) * 1.74532925, 400.0, 1e-5);
}

// The C interface derives the largest following error from omega and the model, so that a slow loop needs no line of its own.
TEST(Export, ASlowLoopMayFollowLater) {
  const Folder f;
  const std::string mill = kSource + "/machines/five-axis-mill.toml";
  ASSERT_EQ(command(to_linuxcnc({mill, "--parameters", "commissioning", "--quiet", "--omega", "25 rad/s",
                                 "-o", f / "m"}))
                .code,
            0);
  const std::string hal = text_of(f / "m/control-axis.hal");
  EXPECT_THAT(hal, HasSubstr("setp ax.x.omega 25\n"));
  EXPECT_THAT(hal, testing::Not(HasSubstr("following-error")));
}

TEST(Export, WarnsOfALoopThatIsUnfit) {
  const Folder f;
  const std::string mode =
      "[axes.x.plant.axial_mode]\nfrequency = \"30 Hz\"\ndamping_ratio = 0.05\ntable_share = 0.4\n\n"
      "[axes.x.plant.converter]";
  const std::string ringing = f.write("m.toml", replaced(uniaxial(), "[axes.x.plant.converter]", mode));
  const auto said = [&](const std::string& machine, const char* omega) {
    const Said s = command(to_linuxcnc(
        {machine, "--parameters", "commissioning", "--omega", omega, "-o", f / "m", "--json", f / "m.json"}));
    EXPECT_EQ(s.code, 0) << s.err;
    const auto warnings = nlohmann::json::parse(text_of(f / "m.json")).at("warnings");
    for (const auto& w : warnings) EXPECT_THAT(s.out, HasSubstr("warning: " + w.get<std::string>() + "\n"));
    return warnings;
  };
  // At 5 ms a loop of 90 rad/s feeds the mode; one of 10 rad/s is far below it.
  const auto unstable = said(ringing, "90 rad/s");
  ASSERT_EQ(unstable.size(), 1u);
  EXPECT_EQ(unstable[0],
            "x: a loop of 90 rad/s is unstable with the axial mode of 30 Hz that the machine file has (lower "
            "--omega)");
  EXPECT_EQ(said(ringing, "10 rad/s").size(), 0u);
  // 0.65 N over 55 kg: 1.3 N move a loop of 1 rad/s by 24 mm, and 20 mm/s last 20 mm.
  const std::string rigid = f.write("r.toml", uniaxial());
  const auto soft = said(rigid, "1 rad/s");
  ASSERT_EQ(soft.size(), 1u);
  EXPECT_EQ(
      soft[0],
      "x: at a reversal of friction a loop of 1 rad/s leaves its command by up to 24 mm; supervision of the following error "
      "allows for it (raise --omega)");
  EXPECT_EQ(said(rigid, "30 rad/s").size(), 0u);
}

// 10 N and 0.045 N s2/mm: with 1 N s/mm friction leaves a fifth for the acceleration up to 6.4 mm/s.
TEST(Export, AWeakDriveIsSlower) {
  const Folder f;
  const std::string slow =
      f.write("m.toml", replaced(uniaxial(), "alpha2 = \"0.10 N s/mm\"", "alpha2 = \"1 N s/mm\""));
  ASSERT_EQ(command(to_linuxcnc({slow, "--parameters", "commissioning", "--quiet", "-o", f / "m"})).code, 0);
  const std::string ini = text_of(f / "m/machine.ini");
  // Rounded down to 0.01 mm/s, from just below.
  EXPECT_NEAR(of_joint(ini, 0, "MAX_VELOCITY"), (9.0 - 2.0 - 0.6) / 1.0, 0.011);
  EXPECT_NEAR(of_joint(ini, 0, "MAX_ACCELERATION"), 2.0 / 0.045, 0.3);
  EXPECT_THAT(ini, HasSubstr("The machine file has 20 mm/s and 100 mm/s2"));
  const std::string stuck =
      f.write("s.toml", replaced(uniaxial(), "alpha0 = \"0.60 N\"", "alpha0 = \"7.5 N\""));
  expect_refused(f, to_linuxcnc({stuck, "--parameters", "commissioning", "-o", f / "s"}),
                 "s.toml: axes.x: the drive's 10 N are too little for friction");
}

// A voltage amplifier with 100 N at rest: 1 ohm, 0.1 V s/rad and 1000 rad/m take 20 N of it at 20 mm/s.
TEST(Export, LimitsWithBackEmf) {
  const Folder f;
  const std::string machine = f.write(
      "m.toml",
      replaced(
          replaced(
              uniaxial(), "kind = \"current\"\ngain = \"1 N/V\"",
              "kind = \"voltage\"\nresistance = \"1 ohm\"\ninductance = \"1 mH\"\ntorque_constant = \"0.01 "
              "N m/A\"\nback_emf = \"0.1 V s/rad\"\nlead = \"6.283185307179586 mm\""),
          "mass = \"0.045 N s2/mm\"", "mass = \"1 N s2/mm\""));
  ASSERT_EQ(command(to_linuxcnc({machine, "--parameters", "commissioning", "--quiet", "-o", f / "m"})).code,
            0);
  const std::string ini = text_of(f / "m/machine.ini");
  EXPECT_NEAR(of_joint(ini, 0, "MAX_ACCELERATION"), 0.9 * 80.0 - 0.6 - 2.0, 0.1);
  EXPECT_THAT(ini, HasSubstr("# Of the drive's 80 N, friction takes 2.60 N"));
}

TEST(Export, WritesOverNothingThatWasEdited) {
  const Folder f;
  const auto words = [&](const std::string& omega) {
    return to_linuxcnc({kSource + "/machines/uniaxial-drive.toml", "--parameters", "commissioning", "--omega",
                        omega, "--json", f / "e.json", "-o", f / "m"});
  };
  ASSERT_EQ(command(words("30 rad/s")).code, 0);
  const auto first = texts_in(f / "m");
  // Not of export: left alone.
  f.write("m/mine.ngc", "M2\n");
  const std::string ini = replaced(first.at("machine.ini"), "FERROR = 2", "FERROR = 5");
  f.write("m/machine.ini", ini);
  // What would be written is what was written before: the edit stays, and it is said.
  const Said again = command(words("30 rad/s"));
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("Kept, because edited since the last export: machine.ini (remove"));
  EXPECT_EQ(nlohmann::json::parse(text_of(f / "e.json"))["kept"].size(), 1u);
  EXPECT_EQ(text_of(f / "m/machine.ini"), ini);
  EXPECT_EQ(text_of(f / "m/written.txt"), first.at("written.txt"));
  // Something else would be: nothing is written, twice as well.
  f.write("m/tool.tbl", "T1 P1 Z10\n");
  const auto before = texts_in(f / "m");
  for (int i = 0; i < 2; ++i) {
    expect_refused(f, words("25 rad/s"), "m: machine.ini is not as export left it, and would be overwritten");
    EXPECT_EQ(texts_in(f / "m"), before);
  }
  // Out of the way, all is written anew, but for the tools.
  fs::remove(f / "m/machine.ini");
  ASSERT_EQ(command(words("25 rad/s")).code, 0);
  EXPECT_THAT(text_of(f / "m/control-axis.hal"), HasSubstr("setp ax.x.omega 25\n"));
  EXPECT_EQ(text_of(f / "m/tool.tbl"), "T1 P1 Z10\n");
  EXPECT_EQ(text_of(f / "m/mine.ngc"), "M2\n");
  // Without the record nothing tells what is whose; files that would not change do not matter.
  fs::remove(f / "m/written.txt");
  expect_refused(f, words("25 rad/s"), "m: tool.tbl is not as export left it");
  fs::remove(f / "m/tool.tbl");
  ASSERT_EQ(command(words("25 rad/s")).code, 0);
  fs::remove(f / "m/written.txt");
  expect_refused(f, words("30 rad/s"), " are not as export left them");
}

TEST(Export, OffersWhatItTakes) {
  const Said help = command({"export", "--help"});
  EXPECT_THAT(help.out, AllOf(HasSubstr("--json"), Not(HasSubstr("--report"))));
}

TEST(Export, IdentifiesWhatNobodyGives) {
  const Folder f;
  const std::string machine = kSource + "/machines/uniaxial-drive.toml";
  ASSERT_EQ(command(to_linuxcnc({machine, "--quiet", "-o", f / "a"})).code, 0);
  ASSERT_EQ(command(to_linuxcnc({machine, "--quiet", "-o", f / "b"})).code, 0);
  EXPECT_EQ(texts_in(f / "a"), texts_in(f / "b"));
  const std::string hal = text_of(f / "a/control-axis.hal");
  const auto at = hal.find("setp ax.x.mass ");
  ASSERT_NE(at, std::string::npos);
  // The truth is 45 kg, commissioning has 55; the plant itself is in drives.hal alone.
  EXPECT_NEAR(std::stod(hal.substr(at + 15)), 45.0, 1.0);
  EXPECT_THAT(hal, Not(HasSubstr("setp ax.x.mass 45\n")));
}

// A travel that does not hold zero: homed, and at work, in its middle.
TEST(Export, TravelWithoutZero) {
  const Folder f;
  const std::string machine =
      f.write("m.toml", replaced(replaced(uniaxial(), "travel_min = \"-75 mm\"", "travel_min = \"100 mm\""),
                                 "travel_max = \"75 mm\"", "travel_max = \"150 mm\""));
  ASSERT_EQ(command(to_linuxcnc({machine, "--parameters", "commissioning", "-o", f / "m"})).code, 0);
  EXPECT_THAT(text_of(f / "m/machine.ini"), HasSubstr("HOME = 125\nHOME_OFFSET = 125\n"));
  EXPECT_THAT(text_of(f / "m/drives.hal"), HasSubstr("setp pl.x.start 125\n"));
  EXPECT_THAT(text_of(f / "m/demo.ngc"), AllOf(HasSubstr("G0 X125\n"), HasSubstr("G1 X135 F120\nG1 X115\n")));
}

TEST(Export, RefusesInOneLine) {
  const Folder f;
  const std::string x = f.write("x.toml", kAxis);
  const std::string machine = f.write("m.toml", uniaxial());
  const std::string out = f / "out.hal";
  const std::string folder = f / "out";
  const auto refused = [&](std::vector<std::string> words, const std::string& text) {
    expect_refused(f, to_linuxcnc(std::move(words)), text);
  };
  refused({x}, "--output is required");
  expect_refused(f, {"export", x, "-o", out}, "--to is required");
  expect_refused(f, {"export", x, "--to", "heidenhain", "-o", out},
                 "--to: got \"heidenhain\", expected one of linuxcnc, csv, json, c, ");
  expect_refused(f, {"export", "--to", "linuxcnc", "-o", out}, "files is required");
  refused({f / "none.toml", "-o", out}, "none.toml: no such file");
  refused({x, "-o", ""}, "got \"\"");
  refused({x, "-o", f / "no/out.hal"}, "no folder");
  refused({x, "-o", x}, "would be overwritten");
  refused({machine, "-o", machine}, "would be overwritten");
  refused({x, machine, "-o", out}, "expected one machine file");
  refused({machine, x, "-o", out}, "expected one machine file");
  refused({x, "--report", f / "page", "-o", out}, "--report");
  // names
  refused({x, "--name", "seven-l", "-o", out}, "expected 1 to 6 letters");
  refused({x, "--name", "a b", "-o", out}, "expected 1 to 6 letters");
  refused({x, "--name", "a", "--name", "b", "-o", out}, "got 2, expected 1");
  refused({x, x, "--name", "a", "--name", "a", "-o", out}, "expected names that differ");
  refused({machine, "--name", "a", "-o", folder}, "--name");
  // numbers
  for (const char* omega : {"60", "nan rad/s", "-1 rad/s", "0 rad/s", "60 mm"})
    refused({x, "--omega", omega, "-o", out}, "--omega");
  refused({x, "--lincurve", "-o", out}, "--speed: missing");
  for (const char* speed : {"0 mm/s", "-1 mm/s", "nan mm/s", "10"})
    refused({x, "--lincurve", "--speed", speed, "-o", out}, "--speed");
  // what would change nothing
  refused({x, "--speed", "10 mm/s", "-o", out}, "--speed: does not apply");
  refused({x, "--lincurve", "--omega", "60 rad/s", "--speed", "10 mm/s", "-o", out},
          "--omega: does not apply");
  refused({x, "--parameters", "commissioning", "-o", out}, "--parameters: does not apply");
  refused({x, "--axis-file", "x=" + x, "-o", out}, "--axis-file: does not apply");
  refused({machine, "--lincurve", "-o", folder}, "--lincurve: does not apply");
  refused({machine, "--omega", "60 rad/s", "-o", out}, "--omega: does not apply");
  refused({machine, "--feedforward", "none", "-o", out}, "--feedforward: does not apply");
  // axis files of a machine
  refused({machine, "--axis-file", x, "-o", folder}, "expected AXIS=FILE");
  refused({machine, "--axis-file", "y=" + x, "-o", folder}, "no axis \"y\"");
  refused({machine, "--axis-file", "x=" + x, "--axis-file", "x=" + x, "-o", folder}, "given twice");
  // content
  refused({f.write("nan.toml", replaced(kAxis, "18 N", "nan N")), "-o", out}, "alpha0");
  refused({f.write("load.toml", replaced(kAxis, "\"10 N\"", "10")), "-o", out}, "load");
  refused({f.write("lod.toml", replaced(kAxis, "load", "lod")), "-o", out}, "meant \"load\"?");
}

// No load in the file is a load of zero, as identify means it; said in the lines.
TEST(Export, MissingLoadIsZero) {
  const Folder f;
  const std::string x = f.write("x.toml", replaced(kAxis, "load = \"10 N\"\n", ""));
  ASSERT_EQ(command(to_linuxcnc({x, "-o", f / "a.hal"})).code, 0);
  EXPECT_THAT(text_of(f / "a.hal"), HasSubstr("setp ax.x.load 0\n"));
}

TEST(Export, AxesThatLinuxCncDoesNotKnow) {
  const Folder f;
  const std::string named = f.write("c2.toml", replaced(uniaxial(), "axes.x", "axes.c2"));
  expect_refused(f, to_linuxcnc({named, "-o", f / "out"}), "axes.c2: expected one of LinuxCNC's letters");
  // The drives alone may be called anything.
  ASSERT_EQ(command(to_linuxcnc({named, "--quiet", "-o", f / "p.hal"})).code, 0);
  const std::string text = uniaxial();
  const std::string both =
      f.write("both.toml", text + replaced(text.substr(text.find("[axes.x.plant]")), "axes.x", "axes.X"));
  expect_refused(f, to_linuxcnc({both, "-o", f / "out"}), "a second axis x");
  const std::string twice = f.write("twice.toml", text + text.substr(text.find("[axes.x.plant]")));
  expect_refused(f, to_linuxcnc({twice, "-o", f / "out"}), "twice.toml");
}

TEST(Export, NothingHalfWritten) {
  const Folder f;
  const std::string machine = kSource + "/machines/uniaxial-drive.toml";
  const std::vector<std::string> words =
      to_linuxcnc({machine, "--parameters", "commissioning", "-o", f / "m"});
  // A file where the folder should be.
  f.write("m", "mine");
  expect_refused(f, words, "is a file, expected a folder");
  EXPECT_EQ(text_of(f / "m"), "mine");
  fs::remove(f / "m");
  // One of the files cannot be written: none is.
  fs::create_directories(f / "m/machine.ini");
  EXPECT_EQ(command(words).code, 2);
  EXPECT_EQ(std::distance(fs::directory_iterator(f / "m"), fs::directory_iterator()), 1);
}

// ---- evaluate -------------------------------------------------------------------------------------------

/// Two revolutions, the second the other way, `error` [mm] outside.
std::string circle_log(double error) {
  std::string text = "t [s],x [mm],y [mm],rx [mm],ry [mm],line\n";
  for (int i = 0; i < 800; ++i) {
    const double phi = 2.0 * M_PI * (i < 400 ? i : 800 - i) / 399.0;
    const double c = std::cos(phi);
    const double s = std::sin(phi);
    text += std::to_string(0.001 * i) + "," + std::to_string((10.0 + error) * c) + "," +
            std::to_string((10.0 + error) * s) + "," + std::to_string(10.0 * c) + "," +
            std::to_string(10.0 * s) + "," + (i < 400 ? "7" : "9") + "\n";
  }
  return text;
}

TEST(Evaluate, TwoLogsSideBySide) {
  const Folder f;
  const std::string a = f.write("a.csv", circle_log(0.005));
  const std::string b = f.write("b.csv", circle_log(-0.001));
  const std::vector<std::string> words{"evaluate",
                                       a,
                                       b,
                                       "--map",
                                       "rx=rx mm",
                                       "--map",
                                       "ry=ry",
                                       "--where",
                                       "line=7",
                                       "--where",
                                       "line=9",
                                       "--label",
                                       "<pid>",
                                       "--label",
                                       "axis",
                                       "--beside",
                                       "servo time [clocks]=10,20",
                                       "--json",
                                       f / "e.json",
                                       "--report",
                                       f / "page"};
  const Said said = command(words);
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, AllOf(HasSubstr("counter-clockwise"), HasSubstr("servo time")));
  const auto json = nlohmann::json::parse(text_of(f / "e.json"));
  EXPECT_EQ(json["schema"], "stribeck.evaluate/1");
  EXPECT_EQ(json["logs"][0]["beside"]["servo time [clocks]"], "10");
  // Coordinates have six decimals, a nanometre.
  EXPECT_NEAR(json["logs"][0]["circles"][0]["max_contour_error_um"].get<double>(), 5.0, 2e-3);
  EXPECT_NEAR(json["logs"][1]["circles"][1]["rms_um"].get<double>(), 1.0, 2e-3);
  EXPECT_EQ(json["logs"][1]["circles"][1]["direction"], "clockwise");
  const std::string page = text_of(f / "page/index.html");
  EXPECT_THAT(page, AllOf(HasSubstr("from 5.00 µm (&lt;pid&gt;) to 1.00 µm (axis)"), HasSubstr("<svg"),
                          EndsWith("</html>\n")));
  ASSERT_EQ(command(words).code, 0);
  EXPECT_EQ(text_of(f / "page/index.html"), page);
}

// All rows: the directions are taken apart, and compared. The form is 5 um out and 1 um in; coordinates have six decimals.
TEST(Evaluate, DirectionsApart) {
  const Folder f;
  std::string text = circle_log(0.005);
  const std::string back = circle_log(-0.001);
  const auto half = [](const std::string& all) { return all.find("0.401000,"); };
  text = text.substr(0, half(text)) + back.substr(half(back));
  const std::string log = f.write("both.csv", text);
  ASSERT_EQ(command({"evaluate", log, "--map", "rx=rx", "--map", "ry=ry", "--json", f / "e.json"}).code, 0);
  const auto json = nlohmann::json::parse(text_of(f / "e.json"))["logs"][0];
  ASSERT_EQ(json["circles"].size(), 2U);
  EXPECT_EQ(json["circles"][0]["direction"], "counter-clockwise");
  EXPECT_EQ(json["circles"][1]["direction"], "clockwise");
  const auto& test = json["circular_test"];
  EXPECT_NEAR(test["directions"][0]["radial_deviation_max_um"].get<double>(), 5.0, 2e-3);
  EXPECT_NEAR(test["directions"][1]["radial_deviation_min_um"].get<double>(), -1.0, 2e-3);
  EXPECT_NEAR(test["directions"][0]["circular_deviation_um"].get<double>(), 0.0, 2e-3);
  EXPECT_NEAR(test["bidirectional_circular_deviation_um"].get<double>(), 6.0, 2e-3);
  EXPECT_NEAR(test["hysteresis_um"].get<double>(), 6.0, 2e-3);
  EXPECT_NEAR(test["mean_radial_deviation_um"].get<double>(), 2.0, 0.02);
  // One log with one direction beside one with two: nothing to compare.
  const std::string one = f.write("one.csv", text.substr(0, half(text)));
  expect_refused(f, {"evaluate", log, one}, "has 1 circles, one for each direction");
}

/// Both directions of a circle of 10 mm with a backlash of x [mm]: x is behind the motion by half of it.
std::string backlash_log(double backlash, double step_s) {
  std::string text = "t [s],x [mm],y [mm],rx [mm],ry [mm]\n";
  constexpr int kRows = 2400;
  for (int i = 0; i < 2 * kRows; ++i) {
    const int k = i < kRows ? i : 2 * kRows - i;
    const double phi = 2.0 * M_PI * (k + 0.5) / 2000;
    const double way = i < kRows ? 1.0 : -1.0;
    const double behind = std::sin(phi) * way > 0.0 ? 0.5 * backlash : -0.5 * backlash;
    text += std::to_string(step_s * i) + "," + std::to_string(10.0 * std::cos(phi) + behind) + "," +
            std::to_string(10.0 * std::sin(phi)) + "," + std::to_string(10.0 * std::cos(phi)) + "," +
            std::to_string(10.0 * std::sin(phi)) + "\n";
  }
  return text;
}

// Causes in text, JSON and page; several feeds together, or each log by itself.
TEST(Evaluate, CausesOfTheError) {
  const Folder f;
  const std::string slow = f.write("slow.csv", backlash_log(0.004, 0.002));
  const std::string fast = f.write("fast.csv", backlash_log(0.004, 0.001));
  std::vector<std::string> words{"evaluate", slow,     fast,         "--map",    "rx=rx",   "--map",
                                 "ry=ry",    "--json", f / "e.json", "--report", f / "page"};
  const Said apart = command(words);
  ASSERT_EQ(apart.code, 0) << apart.err;
  EXPECT_THAT(apart.out, HasSubstr("Causes of fast: backlash x (4.00 µm)"));
  auto json = nlohmann::json::parse(text_of(f / "e.json"));
  EXPECT_TRUE(json["diagnosis"].is_null());
  EXPECT_EQ(json["logs"][1]["diagnosis"]["causes"][0]["cause"], "backlash");
  words.emplace_back("--together");
  const Said together = command(words);
  ASSERT_EQ(together.code, 0) << together.err;
  EXPECT_THAT(together.out, AllOf(HasSubstr("Causes of all logs together"),
                                  HasSubstr("Next: do not enter it as backlash")));
  json = nlohmann::json::parse(text_of(f / "e.json"));
  EXPECT_TRUE(json["logs"][0]["diagnosis"].is_null());
  const auto& cause = json["diagnosis"]["causes"][0];
  EXPECT_EQ(cause["cause"], "backlash");
  EXPECT_EQ(cause["axis"], "x");
  EXPECT_EQ(cause["rank"], 1);
  EXPECT_TRUE(cause["parameter_cures"]);
  // Coordinates have six decimals.
  EXPECT_NEAR(cause["size_um"].get<double>(), 4.0, 0.01);
  EXPECT_EQ(json["diagnosis"]["peaks"].size(), 16U);
  EXPECT_NEAR(json["diagnosis"]["peaks"][0]["feed_mm_per_min"].get<double>() / 1e3, 0.95, 0.2);
  EXPECT_THAT(text_of(f / "page/index.html"),
              AllOf(HasSubstr("Causes of all logs together"), HasSubstr("Quadrant peaks")));
}

// A ball-bar: angle and radius, no times. It stands 3 um off the centre, and the circle is 2 um too large.
TEST(Evaluate, BallBarTable) {
  const Folder f;
  const auto table = [](const std::string& head) {
    std::string text = head + "\n";
    for (int i = 0; i <= 3000; ++i) {
      const int k = i <= 1500 ? i : 3000 - i;
      const double degrees = 0.25 * k - 5.0;
      text += std::to_string(degrees) + "," +
              std::to_string(100.002 + 0.003 * std::cos(degrees * M_PI / 180.0)) + "\n";
    }
    return text;
  };
  const std::string log = f.write("bar.csv", table("angle [deg],radius [mm]"));
  const Said said = command({"evaluate", log, "--size", "100 mm", "--json", f / "e.json"});
  ASSERT_EQ(said.code, 0) << said.err;
  const auto json = nlohmann::json::parse(text_of(f / "e.json"))["logs"][0];
  ASSERT_EQ(json["circles"].size(), 2U);
  EXPECT_NEAR(json["circles"][0]["max_contour_error_um"].get<double>(), 5.0, 2e-3);
  EXPECT_NEAR(json["circular_test"]["mean_radial_deviation_um"].get<double>(), 2.0, 2e-3);
  EXPECT_THAT(said.out, HasSubstr("centre offset"));
  const auto& peak = json["diagnosis"]["peaks"][0];
  EXPECT_TRUE(peak["feed_mm_per_min"].is_null() && peak["width_ms"].is_null());
  const std::string other = f.write("other.csv", table("W,R [mm]"));
  EXPECT_EQ(
      command({"evaluate", other, "--size", "100 mm", "--map", "angle=W deg", "--map", "radius=R"}).code, 0);
  expect_refused(f, {"evaluate", other, "--size", "100 mm", "--map", "angle=W", "--map", "radius=R"},
                 "--map angle=");
  expect_refused(f, {"evaluate", other, "--map", "angle=W deg"}, "expected both or none");
  expect_refused(f, {"evaluate", other, "--map", "angle=W deg", "--map", "radius=R", "--map", "x=R"},
                 "expected one or the other");
}

TEST(Evaluate, RefusesInOneLine) {
  const Folder f;
  const std::string a = f.write("a.csv", circle_log(0.005));
  const auto refused = [&](std::vector<std::string> words, const std::string& text) {
    words.insert(words.begin(), {"evaluate", a});
    expect_refused(f, std::move(words), text);
  };
  refused({"--path", "eight"}, "--path: got \"eight\", expected one of circle and indicator");
  refused({"--size", "10"}, "--size");
  refused({"--size", "nan mm"}, "--size");
  refused({"--map", "z=x"}, "expected x, y (positions)");
  refused({"--map", "x"}, "expected QUANTITY=COLUMN");
  refused({"--map", "x=x", "--map", "x=y"}, "given twice");
  refused({"--map", "rx=rx"}, "expected both or none");
  refused({"--map", "x=nothing"}, "nothing");
  // A unit replaces that of the file, as everywhere: such a circle is too flat to be one.
  refused({"--map", "x=x um"}, "no circle");
  refused({"--map", "x=x N"}, "which cannot be converted to N");
  refused({"--map", "x=line"}, "line");
  refused({"--where", "line=seven"}, "expected a number");
  refused({"--where", "line=8"}, "a.csv: --where: no row has \"line=8\"");
  refused({"--where", "lime=7"}, "lime");
  refused({"--label", "a", "--label", "b"}, "got 2, expected 1");
  refused({"--beside", "clocks=1,2"}, "got 2 values, expected 1");
  refused({"--json", a}, "would be overwritten");
  refused({"--size", "20 mm", "--where", "line=7"}, "a circle with a radius of 10 mm, expected 20 mm");
  refused({"--where", "line=7", "--json", f / "nowhere/e.json"}, "no folder");
  expect_refused(f, {"evaluate", f / "none.csv"}, "no such file");
  // What cannot be written is told before logs are read.
  expect_refused(f, {"evaluate", f / "none.csv", "--json", f / "nowhere/e.json"}, "no folder");
}

TEST(Evaluate, FindsPositionsByTheirNames) {
  const Folder f;
  std::string text = "t [s],x_x [mm],x_y [mm],r_x [mm],r_y [mm]\n";
  for (int i = 0; i <= 400; ++i) {
    const double phi = 2.0 * M_PI * i / 400;
    const std::string x = std::to_string(10.003 * std::cos(phi));
    const std::string y = std::to_string(10.003 * std::sin(phi));
    text += std::to_string(0.001 * i) + "," + x + "," + y + ",0,0\n";
  }
  const std::string log = f.write("trace.csv", text);
  ASSERT_EQ(command({"evaluate", log, "--json", f / "e.json"}).code, 0);
  const auto json = nlohmann::json::parse(text_of(f / "e.json"));
  EXPECT_NEAR(json["logs"][0]["circles"][0]["max_contour_error_um"].get<double>(), 3.0, 2e-3);
  expect_refused(f, {"evaluate", f.write("q.csv", "t [s],q [mm]\n0,1\n1,2\n")}, "--map x=");
  expect_refused(f, {"evaluate", f.write("x.csv", "t [s],x [mm]\n0,1\n1,2\n")}, "--map y=");
  // Times are not needed.
  std::string timeless = "x [mm],y [mm]\n";
  for (int i = 0; i <= 100; ++i)
    timeless +=
        std::to_string(10 * std::cos(0.0631 * i)) + "," + std::to_string(10 * std::sin(0.0631 * i)) + "\n";
  EXPECT_EQ(command({"evaluate", f.write("timeless.csv", timeless)}).code, 0);
  // Many controls write the names of axes in upper case.
  std::string upper = timeless;
  upper.replace(0, timeless.find('\n'), "X [mm],Y [mm]");
  EXPECT_EQ(command({"evaluate", f.write("upper.csv", upper)}).code, 0);
  // A quarter says how much of a circle it is.
  const std::string quarter = f.write("quarter.csv", text.substr(0, text.find("0.101000")));
  expect_refused(f, {"evaluate", quarter},
                 "one of 90 deg, expected at least 175 deg, better a revolution; got 101 rows");
}

}  // namespace
}  // namespace stribeck::test::export_test
