#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <sstream>
#include <stribeck/targets/steady/test_export.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::test::controls_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// The text behind a key of a list of the ISG kernel; empty: it is not there.
std::string value_of(const std::string& text, const std::string& key) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, value;
    if (words >> name >> value && name == key) return value;
  }
  return {};
}

/// The friction that the kernel makes of its list: straight lines between whole numbers, times the scaling factor in 0.1 % [control's unit].
double isg_friction(const std::string& text, double v) {
  std::vector<std::pair<double, double>> points;
  for (int i = 0; i < std::stoi(value_of(text, "frict_comp.table_entries")); ++i) {
    const std::string entry = "frict_comp.table[" + std::to_string(i) + "]";
    const std::string force = value_of(text, entry + ".out");
    EXPECT_EQ(force.find('.'), std::string::npos) << force;
    points.emplace_back(1e-6 * std::stod(value_of(text, entry + ".in")), std::stod(force));
  }
  double out = v <= points.front().first ? points.front().second : points.back().second;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const auto& [v0, f0] = points[i - 1];
    const auto& [v1, f1] = points[i];
    if (v >= v0 && v <= v1) out = f0 + (f1 - f0) * (v - v0) / (v1 - v0);
  }
  return 1e-3 * std::stod(value_of(text, "frict_comp.scaling_factor")) * out;
}

// Without mode 3 and the number of entries the control compensates nothing.
TEST(Isg, TheListActsAndHasTheErrorThatIsPrinted) {
  for (const auto& [gain, newtons] : std::vector<std::pair<std::string, double>>{
           {"12.5 N/%", 12.5}, {"140 N/A", 140.0}, {"0.02 N/bit", 0.02}}) {
    SteadyExport x;
    x.request.gain = gain;
    const std::string text = x.text("isg");
    EXPECT_EQ(value_of(text, "frict_comp.mode"), "3");
    EXPECT_EQ(value_of(text, "frict_comp.table_entries"), "20");
    EXPECT_EQ(value_of(text, "frict_comp.table[20].out"), "");
    const auto at = [&, force = newtons](double v) {
      return (v < 0.0 ? -force : force) * isg_friction(text, std::abs(v));
    };
    EXPECT_LE(largest_off(at), error_of(x.to("isg")) + 1e-6) << gain;
    EXPECT_LT(error_of(x.to("isg")), 0.5) << gain;  // of 100 N
    EXPECT_THAT(x.to("isg").text,
                AllOf(HasSubstr("compensation value list"), HasSubstr("lr_param.frict_comp 1")));
  }
}

// The pages of the maker permit 0 to 4 cycles and 0 to 10 tenths of a micrometre.
TEST(Isg, NumbersAtTheReversalAreWithinTheRangesOrSaidToBeBeyond) {
  for (const char* stiffness : {"8000 N/mm", "200000 N/mm"}) {
    SteadyExport x(std::string(kSteadyAxis) + "[friction.dynamics]\nkind = \"lugre\"\nsigma0 = \"" +
                   stiffness + "\"\nsigma1 = \"80 N s/mm\"\ndamping_velocity = \"0.05 mm/s\"\n");
    x.request.gain = "12 N/%";
    x.request.speed = "10 mm/s";
    x.request.controller = "cascade";
    const std::string text = x.text("isg");
    EXPECT_LE(std::stod(value_of(text, "frict_comp.reversal_lookahead")), 4.0);
    const bool beyond = std::stod(value_of(text, "frict_comp.position_delay")) > 10.0;
    EXPECT_EQ(text.find("permit 0 to 10") != std::string::npos, beyond) << text;
    EXPECT_THAT(x.to("isg").text, HasSubstr("the pages of the maker permit 0 to 10"));
  }
}

TEST(Isg, RefusesAUnitThatNoWholeNumberHolds) {
  SteadyExport x;
  x.request.gain = "1e-9 N/bit";
  EXPECT_THAT(x.refusal("isg"), HasSubstr("--gain: friction would be frict_comp.table[].out = "));
}

TEST(Ax8000, TheOtherObjectsAreNamed) {
  SteadyExport x;
  x.request.lead = "62.83185307 mm";  // a radius of 10 mm
  const std::string words = x.to("ax8000").text;
  EXPECT_THAT(words, Not(HasSubstr("holds viscous friction alone")));
  EXPECT_THAT(words, AllOf(HasSubstr("3144:02"), HasSubstr("3144:01")));
  // Newtons that do not grow with the speed, and their torque at 10 mm.
  double level = 0.0, torque = 0.0;
  const std::size_t at = words.find("The ", words.find("grows with the speed"));
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(std::sscanf(words.c_str() + at, "The %lf N", &level), 1);
  EXPECT_EQ(std::sscanf(words.c_str() + words.find("static friction torque: "), "static friction torque: %lf",
                        &torque),
            1);
  EXPECT_NEAR(torque, 0.01 * level, 0.005 * torque);
}

TEST(ServoOne, CountsInPercentOfTheRatedTorque) {
  SteadyExport x;
  x.request.lead = "10 mm";
  x.request.gain = "140 N/A";
  EXPECT_THAT(x.refusal("keba"), HasSubstr("but keba counts in % of the rated torque or current"));
  x.request.gain = "1.25 N/‰";
  const std::string per_mille = x.text("keba");
  x.request.gain = "12.5 N/%";
  EXPECT_EQ(per_mille.substr(per_mille.find("index 0")),
            x.text("keba").substr(x.text("keba").find("index 0")));
  EXPECT_THAT(x.to("keba").text, HasSubstr("CON_SCON_TFric (ID 386) in %"));
}

TEST(Ax8000, SaysThatTheFactorIsThatOfOneMotor) {
  SteadyExport x(std::string(kSteadyAxis) + "[drive]\nmotors = 2\n");
  x.request.lead = "10 mm";
  EXPECT_THAT(x.to("ax8000").text,
              AllOf(HasSubstr("each of the 2 motors"), HasSubstr("The factor is that of one motor too")));
}

// The manual has 0 to 200; SV041 = 0 is the value of SV016.
TEST(Mitsubishi, NumbersAreThoseThatTheManualPermits) {
  const auto axis = [](const std::string& forward, const std::string& backward) {
    return "mass = \"800 kg\"\n[friction.steady]\nkind = \"gaussian\"\nvelocity_range = [\"-100 mm/s\", \"100 mm/s\"]\n"
           "positive = { eta0 = \"" +
           forward + " N\", eta1 = \"0.1 N s/mm\" }\nnegative = { eta0 = \"-" + backward +
           " N\", eta1 = \"0.1 N s/mm\" }\n";
  };
  const auto text = [](const std::string& file) {
    SteadyExport x(file);
    x.request.gain = "1 N/%";
    return x.text("mitsubishi");
  };
  EXPECT_THAT(text(axis("30", "30")), HasSubstr("SV016 = 60\nSV041 = 0\n"));
  EXPECT_THAT(text(axis("0.001", "30")), HasSubstr("SV016 = 30\nSV041 = 0\n"));
  // At either reversal the force changes by the friction of both directions.
  EXPECT_THAT(text(axis("10", "30")), HasSubstr("SV016 = 40\nSV041 = 0\n"));
  SteadyExport unlike(axis("10", "30"));
  unlike.request.gain = "1 N/%";
  EXPECT_THAT(unlike.to("mitsubishi").text,
              HasSubstr("is 10 forward and 30 backward: the step at either reversal is their sum"));
  SteadyExport strong(axis("130", "130"));
  strong.request.gain = "1 N/%";
  EXPECT_THAT(strong.text("mitsubishi"), HasSubstr("SV016 = 200\nSV041 = 0\n"));
  EXPECT_THAT(strong.to("mitsubishi").text, HasSubstr("would need 260, and the parameter takes at most 200"));
}

// A force has no place in the command of a drive that takes a velocity.
TEST(DriveWords, SayWhereTheForceGoesOfADriveThatTakesAVelocityOrAPosition) {
  const std::string loop = "[drive_loop]\nmode = \"velocity\"\ngain = \"20 N s/mm\"\n";
  SteadyExport force, velocity(kSteadyAxis + loop), offset(kSteadyAxis + loop + "force_offset = true\n"),
      position(
          kSteadyAxis +
          std::string("[drive_loop]\nmode = \"position\"\ngain = \"20 N s/mm\"\nposition_gain = \"60 1/s\"\n"
                      "velocity_feedforward = 1\n"));
  for (SteadyExport* x : {&force, &velocity, &offset, &position}) x->request.output = x->folder / "out.yaml";
  for (const char* target : {"c", "structured-text", "ros2_control", "isg"}) {
    for (SteadyExport* x : {&force, &velocity, &offset, &position})
      x->request.gain = std::string(target) == "isg" ? "12 N/%" : "";
    EXPECT_THAT(force.to(target).text, Not(HasSubstr("drive_loop"))) << target;
    const std::string words = velocity.to(target).text;
    EXPECT_THAT(words,
                AllOf(HasSubstr("takes a velocity (drive_loop): a force must not be added to that command"),
                      HasSubstr("no such offset"), HasSubstr("--to pid")))
        << target;
    EXPECT_THAT(words, Not(HasSubstr("the force of the"))) << target;
    EXPECT_THAT(offset.to(target).text,
                AllOf(HasSubstr("takes a velocity"), Not(HasSubstr("no such offset"))))
        << target;
    EXPECT_THAT(position.to(target).text, AllOf(HasSubstr("takes a position"), Not(HasSubstr("--to pid"))))
        << target;
  }
}

}  // namespace
}  // namespace stribeck::test::controls_test
