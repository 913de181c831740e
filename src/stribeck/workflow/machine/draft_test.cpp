#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>

#include <stribeck/io/error.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>

namespace stribeck::workflow::draft_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::StartsWith;

const Asked& asked(std::string_view key) {
  return *std::find_if(asked_keys().begin(), asked_keys().end(),
                       [&](const Asked& a) { return a.key == key; });
}

std::string refusal(const MachineDraft& draft, const std::string& option, const std::string& key,
                    const std::string& value) {
  try {
    check_value(draft, option, key, value);
    return {};
  } catch (const io::InputError& e) {
    return e.problems().front().text();
  }
}

// What is on every data sheet is asked for, and what an answer rules out is not.
TEST(MachineDraft, AsksForWhatTheAnswersLeaveRoomFor) {
  MachineDraft draft{"m", "1 ms", {"x"}, {}};
  const auto asks = [&](std::string_view key) { return worth_asking(draft, "x", asked(key)); };
  EXPECT_TRUE(asks("rated_torque") && asks("rated_force") && asks("lead") && asks("brake"));
  EXPECT_FALSE(asks("peak_torque") || asks("rotor_inertia") || asks("gear"));
  draft.values.emplace_back("x.drive.rated_torque", "11 N m");
  EXPECT_TRUE(asks("peak_torque") && asks("rotor_inertia") && asks("lead") && asks("travel_per_turn"));
  EXPECT_FALSE(asks("rated_force"));
  draft.values.emplace_back("x.drive.lead", "10 mm");
  EXPECT_TRUE(asks("gear"));
  EXPECT_FALSE(asks("travel_per_turn"));
  draft.values = {{"x.drive.rated_force", "300 N"}};
  EXPECT_FALSE(asks("rated_torque") || asks("lead") || asks("travel_per_turn") || asks("gear"));
  // Another axis has a drive of its own.
  EXPECT_TRUE(worth_asking(draft, "z", asked("lead")));
}

TEST(MachineDraft, TakesOneOfTorqueAndForceAndOneTravelPerTurn) {
  const MachineDraft draft{
      "m", "1 ms", {"x"}, {{"x.drive.rated_torque", "11 N m"}, {"x.drive.lead", "10 mm"}}};
  EXPECT_EQ(
      refusal(draft, "--set", "x.drive.rated_force", "300 N"),
      "--set: x.drive.rated_force: got \"300 N\" beside x.drive.rated_torque = \"11 N m\": expected one of both (leave one out)");
  EXPECT_EQ(
      refusal(draft, "--set", "x.drive.travel_per_turn", "15 mm"),
      "--set: x.drive.travel_per_turn: got \"15 mm\" beside x.drive.lead = \"10 mm\": expected one of both (leave one out)");
  EXPECT_EQ(refusal(draft, "--set", "x.drive.peak_torque", "35 N m"), "");
}

// The arm of an unbalance is a length, and the axis turns all the same.
TEST(MachineDraft, TakesAnUnbalanceByMassAndDistance) {
  const MachineDraft draft{"m", "1 ms", {"a"}, {{"a.limits.speed", "90 deg/s"}}};
  EXPECT_EQ(
      refusal(draft, "--set", "a.commissioning.unbalance", "{ mass = \"40 kg\", distance = \"110 mm\" }"),
      "");
}

// On a terminal the key stands in place of the option; it stood there twice.
TEST(MachineDraft, NamesTheKeyOnceAndNoQuotes) {
  const MachineDraft draft{"m", "1 ms", {"x"}, {{"x.limits.travel_max", "100 mm"}}};
  const std::string key = "x.drive.torque_limit";
  EXPECT_THAT(refusal(draft, key, key, "3 mm"), StartsWith(key + ": got"));
  EXPECT_EQ(refusal(draft, "x.drive.motors", "x.drive.motors", "two"),
            "x.drive.motors: got \"two\", expected a whole number");
  EXPECT_THAT(refusal(draft, "x.limits.speed", "x.limits.speed", "20 rpm"),
              StartsWith("x.limits.speed: got \"20 rpm\" beside"));
  EXPECT_THAT(refusal(draft, "--set", "x.drive.brake", "maybe"), Not(testing::HasSubstr("quotes")));
}

// Without these lines the file lacked a gain, of which nobody had told.
TEST(MachineDraft, HasLinesForTheLoopOfADriveThatIsBegun) {
  MachineDraft draft{"m", "1 ms", {"x", "y"}, {{"x.drive_loop.mode", "position"}}};
  EXPECT_THAT(draft_text(draft), HasSubstr("\n# FILL IN: gain = \"20 N s/mm\"  # gain of the velocity loop"));
  EXPECT_THAT(draft_text(draft), HasSubstr("\n# FILL IN: velocity_feedforward = 1  # "));
  EXPECT_THAT(open_keys(draft), IsSupersetOf({"x.drive_loop.gain", "x.drive_loop.position_gain"}));
  EXPECT_THAT(open_keys(draft), Not(Contains("y.drive_loop.gain")));
  EXPECT_THAT(open_keys(draft), Not(Contains("x.drive_loop.mode")));

  draft.values = {{"x.drive_loop.gain", "5 N s/mm"}, {"x.limits.travel_max", "600 mm"}};
  EXPECT_THAT(open_keys(draft), Contains("x.drive_loop.mode"));
  EXPECT_THAT(open_keys(draft), Not(Contains("x.drive_loop.position_gain")));
  EXPECT_THAT(draft_text(draft), HasSubstr("\n# integral_time = \"10 ms\""));

  draft.values = {{"x.drive_loop.position_gain", "50 1/s"}};
  EXPECT_THAT(open_keys(draft), IsSupersetOf({"x.drive_loop.mode", "x.drive_loop.velocity_feedforward"}));
  EXPECT_THAT(draft_text(draft), HasSubstr("\n# FILL IN: mode = \"position\""));

  draft.values = {{"x.limits.travel_max", "600 mm"}};
  EXPECT_THAT(draft_text(draft), Not(HasSubstr("drive_loop")));
}

TEST(MachineDraft, TakesYesAndNo) {
  for (const char* yes : {"yes", "Y", "ja", "true"}) EXPECT_EQ(as_answered(asked("brake"), yes), "true");
  for (const char* no : {"no", "N", "nein", "false"}) EXPECT_EQ(as_answered(asked("brake"), no), "false");
  EXPECT_EQ(as_answered(asked("brake"), "maybe"), "maybe");
  EXPECT_EQ(as_answered(asked("gear"), "n"), "n");
}

}  // namespace
}  // namespace stribeck::workflow::draft_test
