#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/targets/steady/approximation.hpp>
#include <stribeck/targets/steady/test_export.hpp>
#include <string>

namespace stribeck::test::steady_target_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

using Export = SteadyExport;
constexpr const char* kAxis = kSteadyAxis;

TEST(SteadyTarget, TheCSourceGivesTheFrictionWithinTheErrorThatIsPrinted) {
  Export x(std::string(kAxis) + kItsSpring);
  x.request.output = x.folder / "x.h";
  const targets::Exported written = x.to("c");
  const std::string main = x.folder.write(
      "main.c",
      "#include <stdio.h>\n#include \"x.h\"\nint main(void) {\n  double v, p;\n"
      "  while (scanf(\"%lf %lf\", &v, &p) == 2) printf(\"%.15g %.15g\\n\", x_friction(v, p), x_force(2.0, v, p));\n  return 0;\n}\n");
  const std::string program = x.folder / "program";
  ASSERT_EQ(
      std::system(("cc -std=c99 -Wall -Wextra -Werror -o '" + program + "' '" + main + "' -lm").c_str()), 0);
  std::string input;
  std::vector<std::array<double, 2>> points;
  for (int i = -19; i <= 19; ++i) {
    points.push_back({5e-3 * i + (i == 0 ? 0.0 : 1e-4), 1e-3 * i});
    input += std::to_string(points.back()[0]) + " " + std::to_string(points.back()[1]) + "\n";
  }
  const std::string in = x.folder.write("in.txt", input.c_str());
  const std::string out = x.folder / "values.txt";
  ASSERT_EQ(std::system(("'" + program + "' < '" + in + "' > '" + out + "'").c_str()), 0);
  std::istringstream values(text_of(out));
  for (const auto& [v, p] : points) {
    double friction = 0.0;
    double force = 0.0;
    ASSERT_TRUE(values >> friction >> force);
    const double ripple =
        v == 0.0 ? 0.0 : 7.0 * std::sin(2.0 * 3.14159265358979 * p / 5e-3 - 0.4) * (v < 0.0 ? -1.0 : 1.0);
    const double truth = spring_of(p) + (v == 0.0 ? 0.0 : friction_of(v) + ripple);
    EXPECT_NEAR(friction, truth, error_of(written) + 1e-6) << v;
    EXPECT_NEAR(force, 1600.0 + friction + 30.0, 1e-6) << v;
  }
  EXPECT_LT(error_of(written), 0.1);
}

TEST(SteadyTarget, ASpringIsInStructuredTextAndElsewhereSaidToBeLeftOut) {
  Export x(std::string(kAxis) + kItsSpring);
  EXPECT_THAT(x.text("structured-text"),
              HasSubstr("other := other + 1.500000000e+03 * (LIMIT(-1.200000000e-02, position, "
                        "1.500000000e-02) - 4.000000000e-03);"));
  x.request.gain = "12 N/%";
  x.request.lead = "10 mm";
  EXPECT_THAT(x.to("keba").text, HasSubstr("a spring of 1.5 N/mm"));
  Export c(std::string(kAxis) + kItsSpring);
  EXPECT_THAT(c.to("c").text, Not(HasSubstr("spring")));
}

TEST(SteadyTarget, FewerPointsMakeALargerErrorAndItIsPrinted) {
  Export x;
  x.request.gain = "12 N/%";
  const double many = error_of(x.to("isg"));
  const double one = error_of(x.to("pmac"));
  x.request.lead = "10 mm";
  const double few = error_of(x.to("keba"));
  x.request.lead.clear();
  EXPECT_LT(many, 0.3);  // 12 N in steps of a thousandth, and 20 points
  EXPECT_LT(many, few);
  EXPECT_LT(few, one);
  // The mean level against the largest friction of the range.
  EXPECT_GT(one, 20.0);
  EXPECT_THAT(x.to("pmac").text, HasSubstr("beside the friction of"));
}

TEST(SteadyTarget, TorqueOffsetCountsInPerMille) {
  Export x;
  x.request.gain = "12.5 N/%";
  EXPECT_THAT(x.text("cia402"), HasSubstr("F := F / 1.250000000e+00;"));
  EXPECT_LT(error_of(x.to("cia402")), 0.625 + 0.1);
  x.request.gain = "1.25 N/per_mille";
  EXPECT_THAT(x.text("cia402"), HasSubstr("F := F / 1.250000000e+00;"));
}

TEST(SteadyTarget, SharesOfTheRatedTorqueTakeNoOtherUnit) {
  Export x;
  for (const char* name : {"cia402", "mitsubishi", "indradrive"}) {
    x.request.gain = "140 N/A";
    EXPECT_THAT(x.refusal(name),
                HasSubstr("got the force of one A, but " + std::string(name) + " counts in "));
    x.request.gain = "12.5 N/%";
    const std::string per_cent = x.text(name);
    x.request.gain = "1.25 N/‰";
    EXPECT_EQ(x.text(name), per_cent) << name;
    EXPECT_THAT(x.to(name).text, Not(HasSubstr("check --gain")));
    x.request.gain = "0.5 N/%";
    EXPECT_THAT(x.to(name).text, HasSubstr("check --gain"));
  }
}

// Motors of different axes have different gains and leads; one for all was taken without a word.
TEST(SteadyTarget, EveryAxisMayHaveItsOwnGainAndLead) {
  Export x;
  x.request.files.push_back(x.request.files.front());
  x.request.gain = "x=12 N/%, y=24 N/%";
  x.request.lead = "x=10 mm,y=5 mm";
  const targets::Exported own = x.to("keba");
  const std::string text = text_of(x.request.output);
  EXPECT_THAT(text, HasSubstr("Axis y"));
  EXPECT_THAT(own.text, Not(HasSubstr("counts for all axes")));
  const auto of_axis = [](const char* gain, const char* lead) {
    Export one;
    one.request.gain = gain;
    one.request.lead = lead;
    const std::string all = one.text("keba");
    return all.substr(all.find("index 0"), all.find("index 4") - all.find("index 0"));
  };
  EXPECT_THAT(text, HasSubstr(of_axis("12 N/%", "10 mm")));
  EXPECT_THAT(text, HasSubstr(of_axis("24 N/%", "5 mm")));
  x.request.gain = "12 N/%";
  EXPECT_THAT(x.to("keba").text, HasSubstr("One --gain counts for all axes"));
  x.request.gain = "x=12 N/%";
  EXPECT_THAT(x.refusal("keba"), HasSubstr("which says nothing of axis y (write y=… for each axis)"));
  x.request.gain = "x=12 N/%,y=24 N/%,z=24 N/%";
  EXPECT_THAT(x.refusal("keba"), HasSubstr("got \"24 N/%\" for \"z\", expected axes of this export: x, y"));
  // A target that cannot count in the unit of one axis is left out of all.
  x.request.output = x.folder / "all";
  x.request.gain = "x=140 N/A,y=12 N/%";
  x.request.lead.clear();
  EXPECT_THAT(x.to("all").text, HasSubstr("cia402 (--gain in % or ‰)"));
}

// A table that began at a thousandth of the top speed would not hold a rise of friction below it.
TEST(SteadyTarget, ANarrowRiseTowardsStandstillIsInTheTable) {
  Export x(
      "mass = \"80 kg\"\nvelocity_range = [\"-500 mm/s\", \"500 mm/s\"]\n[friction.steady]\nkind = \"conventional\"\n"
      "alpha0 = \"300 N\"\nalpha2 = \"0 N s/mm\"\nstribeck = { alpha1 = \"450 N\", v0 = \"0.1 mm/s\" }\n");
  x.request.speed.clear();
  const targets::Exported e = x.to("json");
  EXPECT_LT(error_of(e), 3.0);
  const auto table = nlohmann::json::parse(text_of(x.request.output))["axes"][0];
  const auto& v = table["velocity_mm_per_s"];
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double s = v[i].get<double>();
    const double truth = std::copysign(300.0 + 150.0 * std::exp(-s * s / 0.01), s);
    EXPECT_NEAR(table["friction_N"][i].get<double>(), truth, 3.0) << s;
  }
  EXPECT_THAT(e.text, HasSubstr("from 0.0050 to 500.0 mm/s"));
}

TEST(SteadyTarget, ANarrowTermAtSpeedCountsForTheError) {
  Export x(
      "mass = \"80 kg\"\n[friction.steady]\nkind = \"gaussian\"\nvelocity_range = [\"-500 mm/s\", \"500 mm/s\"]\n"
      "[friction.steady.positive]\neta0 = \"300 N\"\neta1 = \"0 N s/mm\"\n"
      "gaussians = [{ a = \"150 N\", b = \"300.4 mm/s\", c = \"0.1 mm/s\" }]\n"
      "[friction.steady.negative]\neta0 = \"-300 N\"\neta1 = \"0 N s/mm\"\n");
  x.request.speed.clear();
  x.request.gain = "1 N/bit";
  EXPECT_NEAR(error_of(x.to("pmac")), 150.0, 2.0);
  x.request.gain.clear();
  EXPECT_LT(error_of(x.to("c")), 10.0);
}

TEST(SteadyTarget, SaysWhatOneDirectionHasMore) {
  Export x(
      "mass = \"80 kg\"\nvelocity_range = [\"-100 mm/s\", \"300 mm/s\"]\n[friction.steady]\nkind = \"conventional\"\n"
      "alpha0 = \"300 N\"\nalpha2 = \"0 N s/mm\"\n");
  x.request.speed.clear();
  EXPECT_THAT(x.to("c").text,
              HasSubstr("what was identified beyond 100 mm/s in one direction, up to 300 mm/s"));
}

TEST(SteadyTarget, LostMotionIsTwiceTheFrictionByDirection) {
  Export x(
      "mass = \"800 kg\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"60 N\"\nalpha2 = \"0 N s/mm\"\n");
  x.request.gain = "3 N/%";
  EXPECT_THAT(x.text("mitsubishi"), HasSubstr("SV016 = 40\nSV041 = 0\n"));
  EXPECT_LT(error_of(x.to("mitsubishi")), 1e-9);
  // 32 767 bits are 100 % of the output: 60 N are 20 %.
  EXPECT_THAT(x.text("pmac"), HasSubstr("Ixx68 = 6553\n"));
  x.request.gain = "30 N/V";
  EXPECT_THAT(x.text("pmac"), HasSubstr("Ixx68 = 6553\n"));
  x.request.gain.clear();
  EXPECT_THAT(x.text("mujoco"), HasSubstr("frictionloss=\"60\" damping=\"0\""));
}

TEST(SteadyTarget, AUnitThatLeavesNothingIsRefused) {
  Export x(
      "mass = \"8 kg\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"9 N\"\nalpha2 = \"0 N s/mm\"\n");
  x.request.gain = "48 N/A";
  EXPECT_THAT([&] { x.to("pmac"); },
              ThrowsMessage<io::InputError>(HasSubstr("counts in bits of a 16-bit output")));
  x.request.gain = "48 N/bit";
  EXPECT_THAT([&] { x.to("pmac"); },
              ThrowsMessage<io::InputError>(HasSubstr("friction of 9 N RMS becomes 0")));
  x.request.gain = "0.5 N/bit";
  EXPECT_THAT(x.text("pmac"), HasSubstr("Ixx68 = 18\n"));
}

// What grows with the speed has no place in a number that acts at a reversal: over all speeds to 300 mm/s SV016 was 116.
TEST(SteadyTarget, NumbersForAReversalHaveTheCoulombFrictionAtAnySpeed) {
  Export x(
      "mass = \"800 kg\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"350 N\"\nalpha2 = \"2.5 N s/mm\"\n"
      "stribeck = { alpha1 = \"500 N\", v0 = \"5 mm/s\", delta = 1 }\n");
  x.request.gain = "12.5 N/%";
  for (const char* speed : {"100 mm/s", "300 mm/s"}) {
    x.request.speed = speed;
    const std::string text = x.text("mitsubishi");
    const auto at = text.find("SV016 = ");
    ASSERT_NE(at, std::string::npos);
    EXPECT_NEAR(std::stod(text.substr(at + 8)), 2.0 * 350.0 / 12.5, 6.0) << speed;
  }
  EXPECT_THAT(x.text("indradrive"), HasSubstr("S-0-0155 = 2"));
}

TEST(SteadyTarget, WhatTheLogsDidNotTellIsSaid) {
  Export x(std::string("velocity_range = [\"-100 mm/s\", \"100 mm/s\"]\n") + kAxis +
           "[uncertainty]\nrise_speed = \"5 mm/s\"\ntold_from = \"4 mm/s\"\ndeviations = []\n");
  const targets::Exported e = x.to("c");
  EXPECT_THAT(e.text, HasSubstr("below 4 mm/s the logs do not tell the friction"));
  EXPECT_THAT(text_of(x.request.output), HasSubstr("the logs do not tell the friction"));
  EXPECT_NEAR(e.json["axes"][0]["told_from_mm_per_s"].get<double>(), 4.0, 1e-9);
  Export told;
  EXPECT_THAT(told.to("c").text, Not(HasSubstr("do not tell")));
  EXPECT_TRUE(told.to("c").json["axes"][0]["told_from_mm_per_s"].is_null());
}

TEST(SteadyTarget, TheGainOfAnAxisThatTurnsIsATorque) {
  Export x(
      "rotary = true\nmass = \"8 kg\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"9 N\"\nalpha2 = \"0 N s/mm\"\n");
  x.request.gain = "2.5 N m/%";
  EXPECT_THAT(x.text("cia402"), HasSubstr("F := F / 2.500000000e-01;"));
  x.request.gain = "2.5 kg/%";
  EXPECT_THAT([&] { x.to("cia402"); }, ThrowsMessage<io::InputError>(HasSubstr("--gain")));
}

TEST(SteadyTarget, SpeedsOfTheServoOneAreThoseOfTheMotor) {
  Export x;
  x.request.gain = "12 N/%";
  x.request.lead = "10 mm";
  // 100 mm/s at 10 mm per turn.
  EXPECT_THAT(x.text("keba"), HasSubstr(": 600.0 rpm, "));
}

// A tenth of a turn per minute is a coarse step of a long lead: the error is that of the speeds as they are written.
TEST(SteadyTarget, TheErrorOfTheServoOneIsThatOfItsRoundedSpeeds) {
  Export x(
      "mass = \"80 kg\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"60 N\"\nalpha2 = \"0 N s/mm\"\n"
      "stribeck = { alpha1 = \"100 N\", v0 = \"1 mm/s\", delta = 1 }\n");
  x.request.gain = "1 N/%";
  x.request.lead = "1000 mm";
  const targets::Exported e = x.to("keba");
  std::istringstream lines(text_of(x.request.output));
  std::vector<std::pair<double, double>> points;  // mm/s, N
  for (std::string line; std::getline(lines, line);) {
    double rpm = 0.0, force = 0.0;
    int index = 0;
    if (std::sscanf(line.c_str(), "index %d: %lf rpm, %lf", &index, &rpm, &force) == 3)
      points.emplace_back(rpm * 1000.0 / 60.0, force);
  }
  ASSERT_EQ(points.size(), 5U);
  double largest = 0.0;
  for (double v = 0.05; v <= 100.0; v += 0.05) {
    double written = points.back().second;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const auto [v0, f0] = points[i - 1];
      const auto [v1, f1] = points[i];
      EXPECT_GT(v1, v0);
      if (v < v0 || v > v1) continue;
      written = f0 + (f1 - f0) * (v - v0) / (v1 - v0);
      break;
    }
    largest = std::max(largest, std::abs(written - (60.0 + 40.0 * std::exp(-v))));
  }
  EXPECT_NEAR(error_of(e), largest, 0.02 * largest);
}

TEST(SteadyTarget, ViscousFrictionAtTheMotor) {
  Export x(
      "mass = \"800 kg\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"1e-6 N\"\nalpha2 = \"0.5 N s/mm\"\n");
  x.request.lead = "62.83185307 mm";  // a radius of 10 mm: 500 N s/m · (10 mm)²
  EXPECT_THAT(x.text("ax8000"), HasSubstr("3144:03 = 0.05 "));
  EXPECT_LT(error_of(x.to("ax8000")), 1e-3);
}

TEST(SteadyTarget, SimulatorsComeAsNearAsTheirFormPermits) {
  Export x;
  EXPECT_LT(error_of(x.to("modelica")), 1.0);
  const double simscape = x.to("simscape").json["axes"][0]["rms_error_N"].get<double>();
  EXPECT_LT(simscape, 4.0);
  EXPECT_LT(simscape, x.to("mujoco").json["axes"][0]["rms_error_N"].get<double>());
}

/// The number behind `mark` in a text.
double number_behind(const std::string& text, const std::string& mark) {
  const std::size_t at = text.find(mark);
  EXPECT_NE(at, std::string::npos) << mark;
  return std::stod(text.substr(at + mark.size()));
}

TEST(SteadyTarget, WhatSimulatorsReadHasTheErrorThatIsPrinted) {
  Export x;
  const std::string mjcf = x.text("mujoco");
  const double loss = number_behind(mjcf, "frictionloss=\"");
  const double damping = number_behind(mjcf, "damping=\"");
  EXPECT_EQ(number_behind(mjcf, "mass=\""), 800.0);
  const auto joint = [&](double v) { return v < 0.0 ? damping * v - loss : damping * v + loss; };
  EXPECT_NEAR(largest_off(joint), error_of(x.to("mujoco")), 1e-9);

  const std::string block = x.text("simscape");
  const double breakaway = number_behind(block, "brkwy_frc = ");
  const double coulomb = number_behind(block, "Col_frc = ");
  const double speed = number_behind(block, "brkwy_vel = ");
  const double viscous = number_behind(block, "visc_coef = ");
  // The block's equation as its documentation has it.
  const auto simscape = [&](double v) {
    const double stribeck = v / (speed * std::sqrt(2.0));
    return std::sqrt(2.0 * std::exp(1.0)) * (breakaway - coulomb) * std::exp(-stribeck * stribeck) *
               stribeck +
           coulomb * std::tanh(10.0 * v / speed) + viscous * v;
  };
  // Below its breakaway velocity the block passes through zero.
  const targets::Exported written = x.to("simscape");
  EXPECT_NEAR(largest_off(simscape, speed), error_of(written), 1e-2 * error_of(written));
  EXPECT_NEAR(written.json["axes"][0]["slowest_mm_per_s"].get<double>(), 1e3 * speed, 1e-9);
}

// 190 N that fall to 118 within 5 mm/s, of an axis that goes to 630 mm/s: of evenly spaced speeds the slowest one decided, and the fall was gone.
TEST(SteadyTarget, SimscapeKeepsAStribeckPartOfSlowMotion) {
  Export x(R"(axis = "x"
mass = "80 kg"
load = "0 N"
delay = "0 ms"
[friction]
eccentric = []
places = []
[friction.steady]
kind = "conventional"
alpha0 = "118 N"
alpha2 = "0.2 N s/mm"
stribeck = { alpha1 = "190 N", v0 = "5 mm/s", delta = 2 }
[friction.dynamics]
kind = "static"
)");
  x.request.speed = "630 mm/s";
  const std::string block = x.text("simscape");
  const double speed = number_behind(block, "brkwy_vel = ");
  EXPECT_GT(speed, 0.5e-3);
  EXPECT_LT(speed, 8e-3);
  EXPECT_GT(number_behind(block, "brkwy_frc = "), 160.0);
  EXPECT_LT(error_of(x.to("simscape")), 25.0);
}

/// Rows of the matrix behind `mark`: "[0, 1; 2, 3]".
std::vector<std::array<double, 2>> rows_behind(const std::string& text, const std::string& mark) {
  const std::size_t begin = text.find(mark) + mark.size();
  std::string matrix = text.substr(begin, text.find(']', begin) - begin);
  std::replace_if(
      matrix.begin(), matrix.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
  std::istringstream in(matrix);
  std::vector<std::array<double, 2>> rows;
  for (std::array<double, 2> row{}; in >> row[0] >> row[1];) rows.push_back(row);
  return rows;
}

TEST(SteadyTarget, ModelicasTableHasTheErrorThatIsPrintedAtTheAxisAndAtTheMotor) {
  Export x;
  for (const char* lead : {"", "10 mm"}) {
    x.request.lead = lead;
    const double radius = *lead == '\0' ? 1.0 : 0.01 / (2.0 * 3.14159265358979);
    const std::string text = x.text("modelica");
    const auto rows = rows_behind(
        text, *lead == '\0' ? "SupportFriction x_friction(f_pos=[" : "BearingFriction x_friction(tau_pos=[");
    ASSERT_GE(rows.size(), 5U);
    ASSERT_LE(rows.size(), 20U);
    EXPECT_EQ(rows.front()[0], 0.0);
    const double off = largest_off([&](double v) {
      const double s = std::abs(v) / radius;
      std::size_t i = 1;
      while (i + 1 < rows.size() && s > rows[i][0]) ++i;
      const double share = (s - rows[i - 1][0]) / (rows[i][0] - rows[i - 1][0]);
      const double force = (rows[i - 1][1] + share * (rows[i][1] - rows[i - 1][1])) / radius;
      return v < 0.0 ? -force : force;
    });
    EXPECT_NEAR(off, error_of(x.to("modelica")), 1e-6) << lead;
    EXPECT_LT(off, 1.0);
    EXPECT_NEAR(number_behind(text, *lead == '\0' ? "x_mass(m=" : "x_inertia(J="), 800.0 * radius * radius,
                1e-6);
  }
}

// MuJoCo itself, where Debian's libmujoco-dev is installed: force that the joints need at constant velocities.
TEST(SteadyTarget, MuJoCoNeedsTheForceThatIsWritten) {
  Export x;
  x.request.output = x.folder / "axes.xml";
  const std::string mjcf = x.text("mujoco");
  const std::string main = x.folder.write(
      "main.c",
      "#include <mujoco/mujoco.h>\n#include <stdio.h>\nint main(int n, char **a) {\n  char error[500] = \"\";\n"
      "  mjModel *m = mj_loadXML(a[n - 1], NULL, error, 500);\n  if (!m) return puts(error), 1;\n  mjData *d = mj_makeData(m);\n"
      "  for (int i = -5; i <= 5; ++i) {\n    const double v = 0.02 * i;\n    if (i == 0) continue;\n    mj_resetData(m, d);\n    d->qvel[0] = v;\n    mj_forward(m, d);\n"
      "    printf(\"%.15g %.15g\\n\", v, -d->qfrc_passive[0] - d->qfrc_constraint[0]);\n  }\n  return 0;\n}\n");
  const std::string program = x.folder / "program";
  if (std::system(("cc -std=c99 -w -o '" + program + "' '" + main + "' -lmujoco 2> /dev/null").c_str()) != 0)
    GTEST_SKIP() << "libmujoco-dev is not installed";
  const std::string out = x.folder / "values.txt";
  ASSERT_EQ(std::system(("'" + program + "' '" + x.request.output + "' > '" + out + "'").c_str()), 0)
      << text_of(out);
  std::istringstream values(text_of(out));
  int read = 0;
  for (double v = 0.0, force = 0.0; values >> v >> force; ++read) {
    const double written =
        number_behind(mjcf, "frictionloss=\"") + number_behind(mjcf, "damping=\"") * std::abs(v);
    EXPECT_NEAR(std::abs(force), written, 1e-6 * written) << v;
    EXPECT_GT(force * v, 0.0);
  }
  EXPECT_EQ(read, 10);
}

TEST(SteadyTarget, WhatAFormCannotHoldIsSaid) {
  Export x;
  EXPECT_THAT(x.to("mujoco").text, HasSubstr("not in it: 7.00 N periodic in position, the load of 30.00 N"));
  EXPECT_THAT(x.to("structured-text").text, Not(HasSubstr("not in it")));
}

TEST(SteadyTarget, TheTableIsWithinItsRowsOfTheFriction) {
  Export x;
  const targets::Exported written = x.to("csv");
  EXPECT_LT(error_of(written), 0.002);
  EXPECT_GT(error_of(written), 0.0);
  EXPECT_LT(written.json["axes"][0]["rms_error_N"].get<double>(), 0.001);
  // --output and the like stay as they were typed.
  x.request.command = "stribeck export x.toml --to csv";
  EXPECT_THAT(x.text("csv"), HasSubstr("# Written by: stribeck export x.toml --to csv\n"));
}

TEST(SteadyTarget, AllSideBySide) {
  Export x;
  x.request.output = x.folder / "all";
  const targets::Exported written = x.to("all");
  EXPECT_TRUE(std::filesystem::exists(x.folder / "all/structured-text.txt"));
  EXPECT_FALSE(std::filesystem::exists(x.folder / "all/cia402.txt"));
  EXPECT_THAT(written.text, HasSubstr("cia402 (--gain)"));
  EXPECT_THAT(written.text, HasSubstr("keba (--gain, --lead)"));
  EXPECT_TRUE(std::filesystem::exists(x.folder / "all/fmu.fmu"));
  EXPECT_EQ(written.json["targets"].size(), 10U);
  EXPECT_TRUE(std::filesystem::exists(x.folder / "all/friction_feedforward.cpp"));
}

// A target that has no place for the friction of an axis keeps none of the others from it.
TEST(SteadyTarget, AllButTheOneThatWouldHoldNothing) {
  Export x(
      "mass = \"800 kg\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"20 N\"\nalpha2 = \"0 N s/mm\"\n"
      "stribeck = { alpha1 = \"50 N\", v0 = \"20 mm/s\", delta = 1 }\n");
  x.request.lead = "10 mm";
  EXPECT_THAT(x.refusal("ax8000"), HasSubstr("would hold nothing of this friction"));
  x.request.output = x.folder / "all";
  x.request.gain = "12.5 N/%";
  EXPECT_THAT(x.to("all").text, HasSubstr("Not written: ax8000, because of "));
  EXPECT_FALSE(std::filesystem::exists(x.folder / "all/ax8000.txt"));
  EXPECT_TRUE(std::filesystem::exists(x.folder / "all/cia402.txt"));
}

// All files of --to all are written, or none.
TEST(SteadyTarget, AllThatFailsLeavesTheFolderAsItWas) {
  Export x;
  x.request.output = x.folder / "all";
  x.request.gain = "12 kg/%";
  EXPECT_THAT(x.refusal("all"), HasSubstr("--gain"));
  EXPECT_FALSE(std::filesystem::exists(x.request.output));
  // Without pre-sliding there are no pulses, and all else.
  x.request.gain.clear();
  x.request.controller = "cascade";
  EXPECT_THAT(x.to("all").text, HasSubstr("Not written: sinumerik, tnc and fanuc, because of "));
  EXPECT_TRUE(std::filesystem::exists(x.folder / "all/csv.txt"));
  std::filesystem::remove_all(x.folder / "all");
  // The last file cannot be written.
  x.request.controller.clear();
  std::filesystem::create_directories(x.folder / "all/fmu.fmu/in-the-way");
  static_cast<void>(x.folder.write("all/csv.txt", "mine\n"));
  EXPECT_NE(x.refusal("all"), "accepted");
  EXPECT_EQ(text_of(x.folder / "all/csv.txt"), "mine\n");
  EXPECT_FALSE(std::filesystem::exists(x.folder / "all/c.txt"));
}

TEST(SteadyTarget, NoNameLeavesItsComment) {
  Export x;
  x.request.files = {x.folder.write("a\n*) evil := 1; (*.toml", kAxis)};
  x.request.command = "export a\n*) evil := 2; (*.toml --> */";
  const std::string text = x.text("structured-text");
  const std::string head = text.substr(0, text.find("FUNCTION"));
  // Two comments of one line each.
  EXPECT_EQ(std::count(head.begin(), head.end(), '\n'), 2);
  std::istringstream lines(head);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_EQ(line.find("*)"), line.size() - 2) << line;
    EXPECT_EQ(line.rfind("(*"), 0U) << line;
  }
}

// In C and Modelica a backslash at the end of a line continues its comment; and no line is longer than programs read.
TEST(SteadyTarget, NoNameTakesInTheNextLine) {
  Export x;
  x.request.command = "export a\\ \\\u2028b" + std::string(5000, 'c') + "\\";
  for (const char* target : {"modelica", "simscape", "csv"}) {
    std::istringstream lines(x.text(target));
    for (std::string line; std::getline(lines, line);) {
      EXPECT_FALSE(line.ends_with('\\')) << line;
      EXPECT_LT(line.size(), 1100U) << target;
    }
  }
}

TEST(SteadyTarget, RefusesWithAWayOut) {
  Export x;
  EXPECT_THAT(x.refusal("isg"), HasSubstr("--gain: missing"));
  x.request.gain = "12 N";
  EXPECT_THAT(x.refusal("isg"), HasSubstr("expected the force of one unit of the control"));
  x.request.gain = "12 N/\n%";
  EXPECT_THAT(x.refusal("isg"), HasSubstr("expected letters, digits, % or ‰"));
  x.request.gain = "0 N/%";
  EXPECT_THAT(x.refusal("isg"), HasSubstr("--gain"));
  x.request.gain = "12 N/%";
  EXPECT_THAT(x.refusal("keba"), HasSubstr("--lead: missing"));
  x.request.omega = "40 rad/s";
  EXPECT_THAT(x.refusal("isg"), HasSubstr("applies to --to linuxcnc alone"));
  x.request.omega.clear();
  EXPECT_THAT(x.refusal("csv"), HasSubstr("--gain: does not apply to --to csv"));
  x.request.gain.clear();
  x.request.lead = "10 mm";
  EXPECT_THAT(x.refusal("c"), HasSubstr("--lead: does not apply to --to c"));
  x.request.lead.clear();
  x.request.names = {"x y"};
  EXPECT_THAT(x.refusal("csv"), HasSubstr("expected a letter, then letters, digits and underscores"));
  x.request.names.clear();
  x.request.speed.clear();
  EXPECT_THAT(x.refusal("csv"), HasSubstr("--speed: missing"));
}

TEST(Approximation, ALineIsFoundAgain) {
  targets::Axis axis;
  axis.model.friction.steady = friction::Conventional<double>{20.0, 400.0, {}};
  axis.slowest = 1e-4;
  axis.fastest = 0.1;
  const targets::Line line = targets::nearest_line(axis);
  EXPECT_NEAR(line.level, 20.0, 1e-9);
  EXPECT_NEAR(line.viscous, 400.0, 1e-7);
  // Friction that falls with the speed has no slope below zero, but a level.
  axis.model.friction.steady =
      friction::Conventional<double>{20.0, 0.0, friction::Stribeck<double>{30.0, 0.05, 1.0}};
  const targets::Line falling = targets::nearest_line(axis);
  EXPECT_EQ(falling.viscous, 0.0);
  EXPECT_GT(falling.level, 20.0);
  EXPECT_LT(falling.level, 30.0);
}

}  // namespace
}  // namespace stribeck::test::steady_target_test
