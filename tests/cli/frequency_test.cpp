// The frequency response of a virtual axis, through files only: excite, simulate, frequency.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stribeck/io/file.hpp>
#include <string>

#include "command.hpp"

namespace stribeck::test::frequency_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// The x axis of the biaxial table with a mode at 35 Hz, resonance at 45.18 Hz, and 2 ms of delay.
std::string table_with_mode() {
  std::string text = text_of(kMachine);
  const auto put = [&](const std::string& before, const std::string& what) {
    text.insert(text.find(before), what);
  };
  put("[axes.x.plant.drive]",
      "delay_fraction = 0.4\n[axes.x.plant.axial_mode]\nfrequency = \"35 Hz\"\ndamping_ratio = 0.02\n"
      "table_share = 0.4\n\n");
  const auto at = text.find("omega = \"40 rad/s\"");
  return text.replace(at, 18, "omega = \"20 rad/s\"");
}

bool holds(const nlohmann::json& v, double truth) { return v["low"] <= truth && truth <= v["high"]; }

TEST(Frequency, OfAVirtualAxisIsFoundFromItsLog) {
  Folder f;
  io::write_atomically(f / "table.toml", table_with_mode());
  const Said excite = command(
      {"excite", f / "table.toml", "--method", "multisine", "--axis", "x", "-o", f / "multisine.csv"});
  ASSERT_EQ(excite.code, 0) << excite.err;
  EXPECT_THAT(excite.out, AllOf(HasSubstr("never below 2.00 mm/s"), HasSubstr("abort outside -75 to 75 mm")));
  ASSERT_EQ(command({"simulate", f / "table.toml", "--reference", f / "multisine.csv", "--axis", "x", "-o",
                     f / "log.csv"})
                .code,
            0);
  const Said said = command({"frequency", f / "table.toml", f / "log.csv", "--axis", "x", "--json",
                             f / "f.json", "-o", f / "lines.csv", "--report", f / "page"});
  ASSERT_EQ(said.code, 0) << said.err;
  const auto a = nlohmann::json::parse(text_of(f / "f.json"))["axes"][0];
  EXPECT_EQ(a["structure"], "two-mass-drive");
  EXPECT_TRUE(holds(a["mass_kg"], 57650.0)) << a["mass_kg"];
  EXPECT_TRUE(holds(a["resonance_Hz"], 45.1848)) << a["resonance_Hz"];  // 35·√(1 + 0.4/0.6)
  EXPECT_TRUE(holds(a["antiresonance_Hz"], 35.0)) << a["antiresonance_Hz"];
  EXPECT_NEAR(a["resonance_Hz"]["value"], 45.1848, 0.45);
  EXPECT_NEAR(a["antiresonance_Hz"]["value"], 35.0, 0.35);
  EXPECT_NEAR(a["delay_s"]["value"], 2e-3, 0.5e-3);  // a tenth of a period
  EXPECT_EQ(a["present"]["omega_rad_per_s"], 20.0);
  EXPECT_GT(a["with_notch"]["omega_rad_per_s"], a["proposed"]["omega_rad_per_s"]);
  EXPECT_THAT(said.out, AllOf(HasSubstr("The loop may go to"), HasSubstr("The first resonance is at 45.2"),
                              HasSubstr("Coulomb friction is no linear response")));
  EXPECT_THAT(text_of(f / "lines.csv"), HasSubstr("frequency"));
  EXPECT_THAT(text_of(f / "page/index.html"), HasSubstr("Nyquist plane of the open loop"));
}

// A drive logs the force that it makes, a row after the command: without its hold the loop that was proposed is unstable.
TEST(Frequency, AForceWithoutItsHoldIsSaidAndCountedWithOne) {
  Folder f;
  ASSERT_EQ(command({"excite", kMachine, "--method", "multisine", "--axis", "x", "-o", f / "m.csv"}).code, 0);
  ASSERT_EQ(
      command({"simulate", kMachine, "--reference", f / "m.csv", "--axis", "x", "-o", f / "told.csv"}).code,
      0);
  const std::string told = text_of(f / "told.csv");
  std::string made, before;
  for (std::size_t at = 0; at < told.size();) {
    const std::size_t end = told.find('\n', at);
    std::string line = told.substr(at, end - at);
    at = end + 1;
    const bool is_row = !line.empty() && line.front() >= '0' && line.front() <= '9';
    if (is_row) {
      // t, r, x, u: the force of the row before.
      std::size_t comma = 0;
      for (int k = 0; k < 3; ++k) comma = line.find(',', comma) + 1;
      const std::string own = line.substr(comma);
      if (!before.empty()) line.replace(comma, std::string::npos, before);
      before = own;
    }
    made += line + "\n";
  }
  io::write_atomically(f / "made.csv", made);
  const auto proposed = [&](const char* log) {
    const Said said = command({"frequency", f / log, "--axis", "x", "--json", f / "f.json"});
    EXPECT_EQ(said.code, 0) << said.err;
    const bool warns = (said.out + said.err).find("the force that the drive makes") != std::string::npos;
    EXPECT_EQ(warns, log == std::string("made.csv"));
    return nlohmann::json::parse(text_of(f / "f.json"))["axes"][0]["proposed"]["omega_rad_per_s"]
        .get<double>();
  };
  const double of_command = proposed("told.csv");
  EXPECT_NEAR(proposed("made.csv") / of_command, 1.0, 0.15);
}

// A log of another machine, or with another scale: margins of the gains in the file would be those of a loop that does not exist.
TEST(Frequency, WhatContradictsTheMachineFileIsSaidFirst) {
  Folder f;
  ASSERT_EQ(command({"excite", kMachine, "--method", "multisine", "--axis", "x", "-o", f / "m.csv"}).code, 0);
  ASSERT_EQ(
      command({"simulate", kMachine, "--reference", f / "m.csv", "--axis", "x", "-o", f / "log.csv"}).code,
      0);
  const Said scale = command({"frequency", kMachine, f / "log.csv", "--gain", "5 N/V"});
  ASSERT_EQ(scale.code, 0) << scale.err;
  EXPECT_THAT(scale.out + scale.err,
              AllOf(HasSubstr("contradicts the machine file"),
                    HasSubstr("margins of the gains in the machine file are not given")));
  EXPECT_EQ(scale.out.find("The present"), std::string::npos);
  std::string other = text_of(kMachine);
  const auto put = [&](const std::string& from, const std::string& to) {
    for (auto at = other.find(from); at != std::string::npos; at = other.find(from, at + to.size()))
      other.replace(at, from.size(), to);
  };
  put("[axes.x", "[axes.a");
  put("[axes.y", "[axes.b");
  put("sample_time = \"5 ms\"", "sample_time = \"2 ms\"");
  io::write_atomically(f / "other.toml", other);
  const Said stranger = command({"frequency", f / "other.toml", f / "log.csv", "--axis", "a"});
  EXPECT_THAT(stranger.out + stranger.err, HasSubstr("axis")) << stranger.code;
  EXPECT_EQ(stranger.out.find("The present"), std::string::npos);
  const Said period = command({"frequency", kMachine, f / "log.csv", "--period", "2.003 s"});
  EXPECT_EQ(period.code, 1);
  EXPECT_THAT(period.err, HasSubstr("fit into its strokes, expected 3 or more (leave the period out"));
}

/// Every `n`th row of a log.
std::string every_nth_row(const std::string& log, int n) {
  std::string out;
  int row = 0;
  for (std::size_t at = 0; at < log.size();) {
    const std::size_t end = std::min(log.find('\n', at), log.size());
    const bool is_row = log[at] >= '0' && log[at] <= '9';
    if (!is_row || row++ % n == 0) out += log.substr(at, end - at) + "\n";
    at = end + 1;
  }
  return out;
}

// Every fourth row of a good log: its lines came back folded, with "first resonance 13.5 Hz" of a machine that has none there.
TEST(Frequency, ALogThatFoldsItsLinesIsRefusedWithTheCause) {
  Folder f;
  const auto log_of = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words{"excite", kMachine, "--method", "multisine",
                                   "--axis", "x",      "-o",       f / "m.csv"};
    words.insert(words.end(), more.begin(), more.end());
    ASSERT_EQ(command(words).code, 0);
    ASSERT_EQ(command({"simulate", kMachine, "--reference", f / "m.csv", "--axis", "x", "-o", f / name}).code,
              0);
    io::write_atomically(f / name, every_nth_row(text_of(f / name), 2));
  };
  log_of("folded.csv", {});
  const Said folded = command({"frequency", kMachine, f / "folded.csv", "--axis", "x"});
  EXPECT_EQ(folded.code, 2);
  EXPECT_THAT(folded.err, AllOf(HasSubstr("rows are 10 ms apart"), HasSubstr("expected rows every 5 ms"),
                                HasSubstr("50 Hz, half the row rate"), HasSubstr("record every period")));
  EXPECT_EQ(folded.out.find("The loop may go"), std::string::npos);
  // Lines below half of the slower rate are as good as before.
  log_of("slow.csv", {"--highest", "12 Hz"});
  const Said slow = command({"frequency", kMachine, f / "slow.csv", "--axis", "x", "--json", f / "f.json"});
  ASSERT_EQ(slow.code, 0) << slow.err;
  EXPECT_THAT(slow.out + slow.err, HasSubstr("rows of the log are 10 ms apart"));
  EXPECT_NEAR(nlohmann::json::parse(text_of(f / "f.json"))["axes"][0]["mass_kg"]["value"], 57650.0,
              0.03 * 57650.0);
}

TEST(Frequency, GainsThatTheMachineFileDoesNotHoldAreCalledProposed) {
  Folder f;
  ASSERT_EQ(command({"excite", kMachine, "--method", "multisine", "--axis", "x", "-o", f / "m.csv"}).code, 0);
  ASSERT_EQ(
      command({"simulate", kMachine, "--reference", f / "m.csv", "--axis", "x", "-o", f / "log.csv"}).code,
      0);
  std::string text = text_of(kMachine);
  EXPECT_THAT(command({"frequency", kMachine, f / "log.csv", "--axis", "x"}).out,
              HasSubstr("The present ω = 40.0 rad/s of the machine file has"));
  for (auto at = text.find("\nomega = "); at != std::string::npos; at = text.find("\nomega = ", at))
    text.erase(at + 1, text.find('\n', at + 1) - at);
  io::write_atomically(f / "without.toml", text);
  const Said said = command({"frequency", f / "without.toml", f / "log.csv", "--axis", "x"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(
      said.out,
      HasSubstr(
          "that the program proposes for recording, because the machine file has no commissioning.omega"));
  EXPECT_EQ(said.out.find("The present"), std::string::npos);
}

TEST(Frequency, OfALogWithoutExcitationIsRefusedWithTheCure) {
  Folder f;
  ASSERT_EQ(command({"excite", kMachine, "--method", "jog", "--axis", "x", "-o", f / "jog.csv"}).code, 0);
  ASSERT_EQ(
      command({"simulate", kMachine, "--reference", f / "jog.csv", "--axis", "x", "-o", f / "log.csv"}).code,
      0);
  const Said said = command({"frequency", f / "log.csv", "--json", f / "f.json"});
  EXPECT_NE(said.code, 0);
  EXPECT_THAT(said.err, HasSubstr("stribeck excite MACHINE.toml --method multisine"));
  EXPECT_FALSE(std::filesystem::exists(f / "f.json"));
}

TEST(Frequency, OfMultisineTakesOneSpeedAndAFrequencyBelowHalfTheRate) {
  Folder f;
  const auto said = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"excite", kMachine, "--method", "multisine",
                                   "--axis", "x",      "-o",       f / "m.csv"};
    words.insert(words.end(), more.begin(), more.end());
    const Said s = command(words);
    EXPECT_EQ(s.code, 2);
    return s.err;
  };
  EXPECT_THAT(said({"--speeds", "1 mm/s", "2 mm/s"}), HasSubstr("--speeds"));
  EXPECT_THAT(said({"--speeds", "9 mm/s"}), HasSubstr("expected at most 6.00 mm/s"));
  EXPECT_THAT(said({"--highest", "120 Hz"}), HasSubstr("--highest"));
  EXPECT_FALSE(std::filesystem::exists(f / "m.csv"));
}

}  // namespace
}  // namespace stribeck::test::frequency_test
