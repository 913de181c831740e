#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include <stribeck/workflow/machine/machine_file.hpp>

namespace stribeck::workflow::explain_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// What `machine` says beside the acceleration of an axis with 250 mm of travel.
std::string said_of(const std::string& speed, const std::string& acceleration) {
  const MachineDescription m = parse_description(
      fmt::format(
          "name = \"m\"\nsample_time = \"2 ms\"\n[axes.x]\nlimits = {{ travel_min = \"0 mm\", travel_max = \"250 mm\", "
          "speed = \"{}\", acceleration = \"{}\" }}\ncommissioning = {{ mass = \"1500 kg\", friction = \"500 N\" }}\n",
          speed, acceleration),
      "m.toml");
  const ExplainedAxis x = explain(m, 0);
  const auto line = std::find_if(x.lines.begin(), x.lines.end(),
                                 [](const Explained& e) { return e.what == "acceleration"; });
  return line == x.lines.end() ? std::string() : line->note;
}

/// The same of an axis that turns.
std::string said_of_turns(const std::string& travel_max) {
  const MachineDescription m = parse_description(
      fmt::format("name = \"m\"\nsample_time = \"2 ms\"\n[axes.c]\nrotary = true\n"
                  "limits = {{ travel_min = \"0 deg\", travel_max = \"{}\", speed = \"200 rpm\", "
                  "acceleration = \"300 deg/s2\" }}\n"
                  "commissioning = {{ mass = \"2 kg m2\", friction = \"5 N m\" }}\n",
                  travel_max),
      "m.toml");
  const ExplainedAxis c = explain(m, 0);
  const auto line = std::find_if(c.lines.begin(), c.lines.end(),
                                 [](const Explained& e) { return e.what == "acceleration"; });
  return line == c.lines.end() ? std::string() : line->note;
}

// A turntable that turns without end reaches every speed, though its travel is written as one turn.
TEST(Explain, ATurntableHasNoTravelThatIsTooShort) {
  EXPECT_THAT(said_of_turns("360 deg"), AllOf(HasSubstr("2400 deg"), Not(HasSubstr("Attention"))));
  EXPECT_THAT(said_of_turns("220 deg"), HasSubstr("Attention: the travel is 220 deg, so that"));
}

TEST(Explain, LimitsThatNoMachineHasAreMarked) {
  EXPECT_EQ(said_of("30 m/min", "4 m/s2"), "top speed after 0.125 s and 31.2 mm");
  EXPECT_THAT(said_of("30 m/min", "4 mm/s2"),
              HasSubstr("31250 mm. Attention: the travel is 250 mm, so that"));
  EXPECT_THAT(
      said_of("30 mm/min", "4 m/s2"),
      HasSubstr(
          "top speed after 0.000125 s and 0.0000313 mm. Attention: that is less than one control period, 2 ms"));
  EXPECT_THAT(said_of("30 m/min", "20000 m/s2"), HasSubstr("Attention: that is 2039 times gravity"));
  EXPECT_THAT(said_of("5 m/s", "200 m/s2"), AllOf(HasSubstr("62.5 mm"), Not(HasSubstr("Attention"))));
}

}  // namespace
}  // namespace stribeck::workflow::explain_test
