#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <stribeck/targets/steady/test_export.hpp>

namespace stribeck::test::gain_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kDrive =
    "[drive]\nrated_force = \"1250 N\"\nforce_per_ampere = \"140 N/A\"\ntravel_per_turn = \"10 mm\"\nmotors = 2\n";

SteadyExport with_drive() { return SteadyExport(std::string(kSteadyAxis) + kDrive); }

TEST(Gain, ThatOfTheAxisFileGivesTheSameTextAsTheOption) {
  SteadyExport given;
  given.request.gain = "12.5 N/%";
  for (const char* target : {"cia402", "mitsubishi", "indradrive", "isg"}) {
    SteadyExport known = with_drive();
    EXPECT_EQ(known.text(target).substr(known.text(target).find('\n', 200)),
              given.text(target).substr(given.text(target).find('\n', 200)))
        << target;
  }
  SteadyExport known = with_drive();
  EXPECT_THAT(
      known.to("cia402").text,
      HasSubstr("x: 1250 N for 100 % of the rated torque, from the drive in " + known.request.files[0] +
                " (force of 2 motors together: write the number into each drive)."));
  // The full output of a converter is mostly the peak of the drive.
  EXPECT_THAT(known.refusal("pmac"), HasSubstr("--gain: missing"));
}

TEST(Gain, ANumberOfTheMotorIsThatOfOneMotor) {
  const auto factor = [](SteadyExport& x) {
    const std::string text = x.text("ax8000");
    return std::stod(text.substr(text.find("3144:03 = ") + 10));
  };
  SteadyExport one;
  one.request.lead = "10 mm";
  SteadyExport two = with_drive();
  EXPECT_NEAR(factor(two), 0.5 * factor(one), 1e-6);
}

// Data sheets of motors give torques.
TEST(Gain, ATorqueOfTheMotorNeedsTheLead) {
  SteadyExport force, torque;
  force.request.gain = "12.566370614359172 N/%";
  torque.request.gain = "0.02 N m/%";
  EXPECT_THAT(torque.refusal("mitsubishi"), HasSubstr("a torque of the motor, expected the force of axis x"));
  torque.request.lead = "10 mm";
  EXPECT_EQ(torque.text("mitsubishi").substr(torque.text("mitsubishi").find("SV027")),
            force.text("mitsubishi").substr(force.text("mitsubishi").find("SV027")));
  force.request.lead = "10 mm";
  EXPECT_THAT(force.refusal("mitsubishi"), HasSubstr("--lead: does not apply to --to mitsubishi"));
}

TEST(Gain, TheOptionGoesBeforeTheAxisFile) {
  SteadyExport x = with_drive();
  x.request.gain = "20 N/%";
  EXPECT_THAT(x.text("cia402"), HasSubstr("F := F / 2.000000000e+00;"));
  EXPECT_THAT(x.to("cia402").text, Not(HasSubstr("from the drive in")));
}

TEST(Gain, TheTravelPerTurnComesFromTheAxisFile) {
  SteadyExport given;
  given.request.gain = "12.5 N/%";
  given.request.lead = "10 mm";
  SteadyExport known = with_drive();
  EXPECT_EQ(known.text("keba").substr(known.text("keba").find("index")),
            given.text("keba").substr(given.text("keba").find("index")));
  EXPECT_THAT(known.to("keba").text, HasSubstr("10 mm per turn of the motor"));
}

TEST(Gain, AmperesServeWhereTheTargetTakesAnyUnit) {
  SteadyExport x(std::string(kSteadyAxis) + "[drive]\nforce_per_ampere = \"140 N/A\"\n");
  EXPECT_THAT(x.to("isg").text, HasSubstr("x: 140 N for 1 A, from the drive in"));
  EXPECT_THAT(x.refusal("cia402"), HasSubstr("--gain: missing: cia402 counts in a unit of its own"));
}

TEST(Gain, OneFileWithoutADriveIsMissing) {
  SteadyExport x = with_drive();
  x.request.files.push_back(x.folder.write("y.toml", kSteadyAxis));
  EXPECT_THAT(x.refusal("cia402"), HasSubstr("--gain: missing"));
  EXPECT_THAT(x.refusal("keba"), HasSubstr("--gain: missing"));
}

TEST(Gain, AllTargetsAreWrittenWithTheDriveOfTheFile) {
  SteadyExport x = with_drive();
  x.request.output = x.folder / "all";
  const std::string words = x.to("all").text;
  for (const char* target : {"cia402", "keba", "mitsubishi", "indradrive", "ax8000"})
    EXPECT_TRUE(std::filesystem::exists(x.folder / (std::string("all/") + target + ".txt"))) << target;
  EXPECT_THAT(words, Not(HasSubstr("because an option is missing: cia402")));
}

}  // namespace
}  // namespace stribeck::test::gain_test
