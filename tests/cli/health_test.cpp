#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <tests/cli/command.hpp>

namespace stribeck::test::health_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Jogs over 0 … 40 mm at two speeds, then a sine, with the force that a rigid axis of 100 kg needs.
std::string log_of(double coulomb, std::uint32_t seed, double top = 0.04, const std::string& head = "") {
  constexpr double kPeriod = 0.002;
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise(0.0, 0.5);
  std::string text = head + "t [s],r [mm],x [mm],f [N]\n";
  int k = 0;
  const auto add = [&](double x, double v, double a) {
    const double f = 100.0 * a + 300.0 * v + (v > 0.0 ? coulomb : -coulomb) + noise(generator);
    text += fmt::format("{:.3f},{:.7f},{:.7f},{:.4f}\n", kPeriod * k++, 1e3 * x, 1e3 * x, f);
  };
  for (const double v : {0.25 * top, top}) {
    for (const double direction : {1.0, -1.0}) {
      for (double t = 0.0; t < 0.04 / v; t += kPeriod)
        add(direction > 0.0 ? v * t : 0.04 - v * t, direction * v, 0.0);
    }
  }
  const double w = top / 0.02;
  for (double t = 0.0; t < 12.5663706 / w; t += kPeriod) {
    const double middle = t + 0.5 * kPeriod;
    add(0.02 - 0.02 * std::cos(w * t), 0.02 * w * std::sin(w * middle), 0.02 * w * w * std::cos(w * middle));
  }
  return text;
}

Said test_of(const Folder& folder, int day, double coulomb, std::vector<std::string> more = {}) {
  const std::string log =
      folder.write(fmt::format("x-{}.csv", day), log_of(coulomb, static_cast<std::uint32_t>(day)));
  std::vector<std::string> words{"health",           kMachine, log,
                                 "--axis",           "x",      "--archive",
                                 folder / "archive", "--date", fmt::format("2026-11-{:02}", day)};
  words.insert(words.end(), more.begin(), more.end());
  return command(words);
}

TEST(Health, FindsAStepAndNamesItsCause) {
  const Folder folder;
  for (int day = 1; day <= 8; ++day) {
    const Said said = test_of(folder, day, 100.0);
    ASSERT_EQ(said.code, 0) << said.err << said.out;
  }
  Said said;
  for (int day = 9; day <= 11; ++day) {
    said = test_of(folder, day, 75.0, {"--json", folder / "h.json", "--report", folder / "page"});
    ASSERT_EQ(said.code, day < 11 ? 0 : 1) << "three tests are needed; day " << day << said.err << said.out;
  }
  EXPECT_THAT(said.out, AllOf(HasSubstr("changed beyond its limits"), HasSubstr("2026-11-09: step"),
                              HasSubstr("likely: preload lost")));
  const auto json = nlohmann::json::parse(text_of(folder / "h.json"));
  EXPECT_EQ(json["schema"], "stribeck.health/1");
  EXPECT_TRUE(json["changed"]);
  EXPECT_EQ(json["axes"][0]["changes"][0]["date"], "2026-11-09");
  EXPECT_EQ(json["added"], nlohmann::json::array({folder / "archive/2026-11-11-x.toml"}));
  EXPECT_THAT(text_of(folder / "page/index.html"), AllOf(HasSubstr("preload lost"), HasSubstr("<svg")));
  // The archive alone says the same; after the repair, --since begins anew.
  EXPECT_EQ(command({"health", kMachine, "--archive", folder / "archive"}).code, 1);
  const Said anew = command({"health", kMachine, "--archive", folder / "archive", "--since", "2026-11-09"});
  EXPECT_EQ(anew.code, 0);
  EXPECT_THAT(anew.out, AllOf(HasSubstr("3 tests from 2026-11-09"),
                              HasSubstr("8 tests before 2026-11-09 do not count")));
}

TEST(Health, TheArchiveIsOnlyEverAddedTo) {
  const Folder folder;
  ASSERT_EQ(test_of(folder, 3, 100.0).code, 0);
  const std::string file = folder / "archive/2026-11-03-x.toml";
  const std::string before = text_of(file);
  // The same log again is not added; another one of the same day gets the next name.
  EXPECT_THAT(test_of(folder, 3, 100.0).out, HasSubstr("already in the archive"));
  const std::string other = folder.write("x-again.csv", log_of(101.0, 77));
  const Said said =
      command({"health", kMachine, other, "--archive", folder / "archive", "--date", "2026-11-03"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("2026-11-03-x-2.toml"));
  EXPECT_EQ(text_of(file), before);
  EXPECT_THAT(said.out, HasSubstr("Motion to repeat"));
}

TEST(Health, TheFirstTestShowsTheMotionToRepeat) {
  const Folder folder;
  const Said said = test_of(folder, 1, 100.0);
  const std::string begin = "  stribeck excite " + kMachine + " --axis x --method ";
  EXPECT_THAT(said.out, AllOf(HasSubstr(begin + "jog --speeds \"0.949 mm/s\""),
                              HasSubstr(begin + "constant-acceleration")));
  const Said designed =
      command({"excite", kMachine, "--axis", "x", "--method", "jog", "--speeds", "0.949 mm/s", "2.37 mm/s",
               "4.75 mm/s", "9.49 mm/s", "--lead", "28 mm", "-o", folder / "jog.csv"});
  EXPECT_EQ(designed.code, 0) << designed.err;
  EXPECT_THAT(designed.out, HasSubstr("At 4 of them the travel is a whole number of turns"));
}

// One turn of a pulley is a turn as that of a screw: its ripple is measured, and the motion to repeat covers whole turns.
TEST(Health, ATurnOfAPulleyIsATurn) {
  const Folder folder;
  const std::string log = folder.write("x.csv", log_of(100.0, 1, 0.04));
  const auto with = [&](const std::string& drive) {
    const std::string machine = folder.write(
        "m.toml",
        "name = \"m\"\nsample_time = \"2 ms\"\n[axes.x.limits]\ntravel_min = \"0 mm\"\ntravel_max = \"40 mm\"\n"
        "speed = \"50 mm/s\"\nacceleration = \"1000 mm/s2\"\nforce = \"2000 N\"\n[axes.x.commissioning]\n"
        "mass = \"100 kg\"\nfriction = \"100 N\"\n[axes.x.drive]\nrated_torque = \"1 N m\"\n" +
            drive + "\n");
    const std::string archive = folder / std::to_string(drive.size());
    const Said said = command({"health", machine, log, "--archive", archive, "--date", "2026-11-01"});
    EXPECT_EQ(said.code, 0) << said.err;
    return said.out;
  };
  for (const char* drive : {"travel_per_turn = \"6.283185307 mm\"", "pulley_diameter = \"2 mm\""})
    EXPECT_THAT(with(drive), AllOf(HasSubstr("periodic, 6.283 mm"), HasSubstr("--lead \"6.28319 mm\"")))
        << drive;
}

TEST(Health, TakesTheDayFromTheLog) {
  const Folder folder;
  const std::string log = folder.write("x.csv", log_of(100.0, 1, 0.04, "# date: 2026-03-04T10:11\n"));
  const Said said = command({"health", kMachine, log, "--axis", "x", "--archive", folder / "archive"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("archive/2026-03-04-x.toml"));
}

std::string refusal(const Folder& folder, std::vector<std::string> words) {
  words.insert(words.begin(), {"health", kMachine});
  words.insert(words.end(), {"--archive", folder / "archive"});
  const Said said = command(words);
  EXPECT_EQ(said.code, 2) << said.out;
  return said.err;
}

TEST(Health, RefusesWhatCannotBeCompared) {
  const Folder folder;
  ASSERT_EQ(test_of(folder, 1, 100.0).code, 0);
  const std::string slow = folder.write("x-slow.csv", log_of(100.0, 2, 0.02));
  EXPECT_THAT(refusal(folder, {slow, "--axis", "x", "--date", "2026-11-02"}),
              HasSubstr("x-slow.csv: got 0 rows near 40 mm/s"));
  const std::string log = folder.write("x-2.csv", log_of(100.0, 2));
  EXPECT_THAT(refusal(folder, {log, "--axis", "x"}), HasSubstr("--date: missing, and "));
  EXPECT_THAT(refusal(folder, {log, "--axis", "x", "--date", "23.11.2026"}),
              HasSubstr("--date: got \"23.11.2026\", expected a day as 2026-11-23"));
  EXPECT_THAT(refusal(folder, {"--date", "2026-11-02"}), HasSubstr("--date: goes with logs"));
  EXPECT_THAT(refusal(folder, {"--gain", "12 N/%"}), HasSubstr("--gain: goes with logs"));
  EXPECT_THAT(refusal(folder, {"--sample-time", "1 ms"}), HasSubstr("--sample-time: goes with logs"));
  EXPECT_THAT(refusal(folder, {"--circle", log}), HasSubstr("--size: missing"));
  EXPECT_EQ(folder.files(), 4U) << "nothing was left behind";
}

TEST(Health, RefusesAnArchiveThatIsNoArchive) {
  const Folder folder;
  ASSERT_EQ(test_of(folder, 1, 100.0).code, 0);
  const std::string file = folder / "archive/2026-11-01-x.toml";
  const std::string whole = text_of(file);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    text.replace(text.find(from), from.size(), to);
    folder.write("archive/2026-11-01-x.toml", text);
    return refusal(folder, {});
  };
  EXPECT_THAT(
      with("biaxial table", "another one"),
      HasSubstr("machine: got \"another one\", expected \"biaxial table\" (one archive holds one machine)"));
  EXPECT_THAT(with("2026-11-01", "yesterday"), HasSubstr("date: expected a day as 2026-11-23"));
  EXPECT_THAT(with("stribeck health 1", "stribeck health 2"),
              HasSubstr("format: expected \"stribeck health 1\""));
  folder.write("archive/2026-11-01-x.toml", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(refusal(folder, {}), HasSubstr("2026-11-01-x.toml"));
}

// The first test fixes the motion of the archive: its commands are wanted before it.
TEST(Health, PrintsTheMotionWhereNoArchiveIs) {
  const Folder folder;
  const Said said = command({"health", kMachine, "--archive", folder / "none"});
  EXPECT_EQ(said.code, 0) << "the answer of step 1 of the guide";
  EXPECT_EQ(said.err, "");
  EXPECT_THAT(said.out, HasSubstr("none is not there yet."));
  for (const std::string axis : {"x", "y"})
    EXPECT_THAT(said.out, HasSubstr("--axis " + axis + " --method constant-acceleration -o " + axis +
                                    "-health-mass.csv --gcode " + axis + "-health-mass.ngc"));
}

// A trend that is wanted as a file, or from a day on, is not there.
TEST(Health, RefusesATrendOfNoArchive) {
  const Folder folder;
  for (const std::vector<std::string>& wanted : {std::vector<std::string>{"--json", folder / "trend.json"},
                                                 {"--report", folder / "page"},
                                                 {"--since", "2026-01-01"},
                                                 {"--quiet"}}) {
    std::vector<std::string> line{"health", kMachine, "--archive", folder / "none"};
    line.insert(line.end(), wanted.begin(), wanted.end());
    const Said said = command(line);
    EXPECT_EQ(said.code, 2) << wanted.front();
    EXPECT_THAT(said.err, HasSubstr("no such folder")) << wanted.front();
  }
  folder.write("file", "");
  const Said said = command({"health", kMachine, "--archive", folder / "file"});
  EXPECT_EQ(said.code, 2);
  EXPECT_THAT(said.err, HasSubstr("no such folder"));
}

}  // namespace
}  // namespace stribeck::test::health_test
