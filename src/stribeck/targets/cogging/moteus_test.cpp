#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <sstream>
#include <stribeck/core/scalar.hpp>
#include <stribeck/targets/steady/test_export.hpp>
#include <vector>

namespace stribeck::test::moteus_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kRipple =
    "mass = \"80 kg\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"60 N\"\nalpha2 = \"0.5 N s/mm\"\n"
    "[[friction.eccentric]]\namplitude = \"8 N\"\nperiod = \"1 mm\"\nphase = \"0.4 rad\"\nform = \"additive\"\n"
    "[[friction.eccentric]]\namplitude = \"3 N\"\nperiod = \"10 mm\"\nphase = \"-1 rad\"\nform = \"additive\"\n"
    "[[friction.eccentric]]\namplitude = \"2 N\"\nperiod = \"5 mm\"\nphase = \"0 rad\"\nform = \"proportional\"\n"
    "[[friction.eccentric]]\namplitude = \"1 N\"\nperiod = \"7 mm\"\nphase = \"0 rad\"\nform = \"additive\"\n";

struct CoggingExport : SteadyExport {
  explicit CoggingExport(const char* axis = kRipple) : SteadyExport(axis) {
    request.speed.clear();
    request.gain = "140 N/A";
    request.lead = "10 mm";
  }
};

/// What the firmware adds at this share of a turn, from the lines of the file [A]: between two cells a straight line.
struct Board {
  double scale = 0.0;
  std::vector<int> cells = std::vector<int>(1024, 1000);
  std::string last;

  explicit Board(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line); last = line) {
      std::istringstream words(line);
      std::string conf, set, key;
      if (line.rfind("conf set ", 0) != 0) continue;
      words >> conf >> set >> key;
      if (key == "motor.cogging_dq_scale") words >> scale;
      const std::string cell = "motor.cogging_dq_comp.";
      if (key.rfind(cell, 0) == 0) words >> cells.at(std::stoul(key.substr(cell.size())));
    }
  }
  [[nodiscard]] double current(double turn) const {
    const double at = (turn - std::floor(turn)) * 1024.0;
    const auto left = static_cast<std::size_t>(at);
    const double share = at - static_cast<double>(left);
    return scale * (cells[left] + share * (cells[(left + 1) % 1024] - cells[left]));
  }
};

/// The terms that a table over a turn of 10 mm can hold [N].
double ripple(double x) {
  constexpr double kTurn = 2.0 * 3.14159265358979;
  return 8.0 * std::sin(kTurn * x / 1e-3 - 0.4) + 3.0 * std::sin(kTurn * x / 10e-3 + 1.0);
}

TEST(Moteus, TheTableGivesThePeriodicForceWithinTheErrorThatIsPrinted) {
  for (const double zero : {0.0, 1.3e-3}) {
    CoggingExport x;
    if (zero > 0.0) x.request.zero = "1.3 mm";
    const targets::Exported written = x.to("moteus");
    const Board board(text_of(x.request.output));
    EXPECT_EQ(board.last, "conf write");
    for (const int c : board.cells) EXPECT_LE(std::abs(c), 127);
    double largest = 0.0;
    // Over three turns: the encoder sees each of them alike.
    for (int i = 0; i < 3000; ++i) {
      const double position = 1e-5 * i + 3e-6;
      const double off = 140.0 * board.current((position - zero) / 10e-3) - ripple(position);
      largest = std::max(largest, std::abs(off));
    }
    // Half a step of 11 N / 127, and the bend between two cells.
    EXPECT_LT(largest, 0.06);
    EXPECT_LE(largest, error_of(written) + 1e-9);
    EXPECT_GT(largest, 0.5 * error_of(written));
    EXPECT_NEAR(written.json["axes"][0]["rms_periodic_N"], std::sqrt(0.5 * (64.0 + 9.0)), 1e-3);
  }
}

TEST(Moteus, WhatATurnCannotHoldIsSaid) {
  CoggingExport x;
  const std::string said = x.to("moteus").text;
  EXPECT_THAT(said, HasSubstr("friction over velocity"));
  EXPECT_THAT(said, HasSubstr("2 N with a period of 5 mm, which changes its sign with the velocity"));
  EXPECT_THAT(said, HasSubstr("1 N with a period of 7 mm, of which the lead is no whole number of periods"));
  EXPECT_THAT(said, Not(HasSubstr("8 N with a period")));
}

// 9.96 mm beside a lead of 10 mm is within what an interval leaves open; at 500 mm a phase counted from 0 would be two tenths of a period off.
TEST(Moteus, ThePhaseHoldsAtTheZeroOfTheEncoder) {
  const std::string plain = std::string(kRipple).substr(0, std::string(kRipple).find("[[friction"));
  CoggingExport x((plain + "[[friction.eccentric]]\namplitude = \"8 N\"\nperiod = \"9.96 mm\"\nphase = \"0.3 "
                           "rad\"\nform = \"additive\"\n")
                      .c_str());
  x.request.zero = "500 mm";
  const targets::Exported written = x.to("moteus");
  const Board board(text_of(x.request.output));
  const auto force = [](double position) { return 8.0 * std::sin(2.0 * kPi * position / 9.96e-3 - 0.3); };
  for (const double turn : {0.0, 0.05, 0.1}) {
    const double off = 140.0 * board.current(turn) - force(0.5 + turn * 10e-3);
    EXPECT_LT(std::abs(off), 0.06) << turn;
    EXPECT_LE(std::abs(off), error_of(written) + 1e-9);
  }
  EXPECT_THAT(written.text, HasSubstr("are 145 deg apart after 1000 mm"));
}

TEST(Moteus, RefusesWithAWayOut) {
  CoggingExport x;
  x.request.gain = "12 N/%";
  EXPECT_THAT(x.refusal("moteus"), HasSubstr("--gain: got the unit \"%\", expected A"));
  x.request.gain.clear();
  EXPECT_THAT(x.refusal("moteus"), HasSubstr("--gain: missing: moteus counts amperes"));
  x.request.gain = "140 N/A";
  x.request.lead.clear();
  EXPECT_THAT(x.refusal("moteus"), HasSubstr("--lead: missing"));
  x.request.lead = "10 mm";
  x.request.speed = "10 mm/s";
  EXPECT_THAT(x.refusal("moteus"), HasSubstr("--speed: does not apply"));
  x.request.zero = "1 mm";
  x.request.gain.clear();
  x.request.lead.clear();
  EXPECT_THAT(x.refusal("csv"), HasSubstr("--zero: applies only to --to moteus and --to all"));
  CoggingExport without(kSteadyAxis);
  EXPECT_THAT(without.refusal("moteus"), HasSubstr("friction.eccentric: no additive term"));
  without.request.files.push_back(without.request.files.front());
  EXPECT_THAT(without.refusal("moteus"), HasSubstr("AXIS.toml: got 2, expected one"));
}

TEST(Moteus, TermsThatCancelOrAreNothingAreNoTable) {
  const auto term = [](const char* amplitude, const char* phase) {
    return std::string("[[friction.eccentric]]\namplitude = \"") + amplitude +
           "\"\nperiod = \"1 mm\"\nphase = \"" + phase + "\"\nform = \"additive\"\n";
  };
  const std::string plain = std::string(kRipple).substr(0, std::string(kRipple).find("[[friction"));
  CoggingExport cancel((plain + term("8 N", "0 rad") + term("8 N", "3.14159265358979312 rad")).c_str());
  EXPECT_THAT(cancel.refusal("moteus"), HasSubstr("friction.eccentric: no additive term"));
  CoggingExport nothing((plain + term("1e-320 N", "0 rad")).c_str());
  EXPECT_THAT(nothing.refusal("moteus"), HasSubstr("friction.eccentric: no additive term"));
  CoggingExport far;
  far.request.zero = "1e300 mm";
  EXPECT_THAT(far.refusal("moteus"), HasSubstr("--zero: got 1e300 mm, expected at most 1 km"));
}

TEST(Moteus, IsAmongAllWhereThereIsATermForIt) {
  CoggingExport x;
  x.request.speed = "100 mm/s";
  x.request.output = x.folder / "all";
  EXPECT_THAT(x.to("all").text, HasSubstr("moteus: x: over a turn of the motor"));
  EXPECT_TRUE(std::filesystem::exists(x.folder / "all/moteus.txt"));
  CoggingExport without(kSteadyAxis);
  without.request.speed = "100 mm/s";
  without.request.output = without.folder / "all";
  EXPECT_THAT(without.to("all").text,
              HasSubstr("Not written: moteus, which needs a term periodic in the motor's turn."));
  EXPECT_FALSE(std::filesystem::exists(without.folder / "all/moteus.txt"));
}

}  // namespace
}  // namespace stribeck::test::moteus_test
