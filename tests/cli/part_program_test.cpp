// G-code as a path: the verbs with the interpreter in a script's place, and with LinuxCNC's own where it is installed.

#include <sys/stat.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "command.hpp"

namespace stribeck::test::part_program_test {
namespace {

const std::string kHead = "SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, 0.020000)\nSET_FEED_RATE(300.0000)\n";

class PartProgram : public testing::Test {
 protected:
  PartProgram() : path_(getenv("PATH")) { setenv("PATH", ((f / "bin") + ":/usr/bin:/bin").c_str(), 1); }
  ~PartProgram() override { setenv("PATH", path_.c_str(), 1); }

  /// An rs274 that prints these calls, and a program for it.
  std::string program(const std::string& calls, const std::string& text = "M2\n") {
    std::filesystem::create_directory(f / "bin");
    std::string canonical;
    std::istringstream in(calls + "PROGRAM_END()\n");
    for (std::string call; std::getline(in, call);) canonical += "    1 N..... " + call + "\n";
    f.write("bin/calls", canonical);
    f.write("bin/rs274", "#!/bin/sh\ncat \"" + (f / "bin/calls") + "\"\n");
    chmod((f / "bin/rs274").c_str(), 0700);
    return f.write("part.ngc", text);
  }
  static std::string to(const std::string& x, const std::string& y, const std::string& z = "0.0000",
                        const std::string& how = "FEED") {
    return "STRAIGHT_" + how + "(" + x + ", " + y + ", " + z + ", 0.0000, 0.0000, 0.0000)\n";
  }
  Said simulate(const std::string& part, std::vector<std::string> more = {}) {
    std::vector<std::string> words{"simulate", kMachine,       "--path", part, "--controller",
                                   "f",        "--parameters", "thesis", "-o", f / "trace.csv",
                                   "--json",   f / "run.json"};
    words.insert(words.end(), more.begin(), more.end());
    return command(words);
  }
  void expect_refused(const Said& said, const std::vector<std::string>& parts) {
    EXPECT_EQ(said.code, 2) << said.out << said.err;
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
    for (const auto& part : parts)
      EXPECT_NE(said.err.find(part), std::string::npos) << "no \"" << part << "\" in: " << said.err;
    EXPECT_FALSE(std::filesystem::exists(f / "trace.csv"));
    EXPECT_FALSE(std::filesystem::exists(f / "run.json"));
  }
  Folder f;
  std::string path_;
};

TEST_F(PartProgram, IsSimulatedAndSaysHowFarItsCornersAreRounded) {
  const std::string part = program(kHead + to("5.0000", "0.0000") + to("5.0000", "5.0000"));
  const Said said = simulate(part);
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_NE(said.out.find("Part part.ngc: 2 moves"), std::string::npos) << said.out;
  EXPECT_NE(said.out.find("1 corner rounded by at most 20.000 um"), std::string::npos) << said.out;
  EXPECT_NE(said.out.find("distance from the rounded path"), std::string::npos) << said.out;
  const auto json = nlohmann::json::parse(text_of(f / "run.json"));
  EXPECT_EQ(json["schema"], "stribeck.simulate/1");
  EXPECT_EQ(json["part"]["moves"], 2);
  EXPECT_EQ(json["part"]["stops"], 0);
  EXPECT_NEAR(json["part"]["rounding_um"].get<double>(), 20.0, 1e-6);
  EXPECT_GT(json["part"]["duration_s"].get<double>(), 2.0);
  EXPECT_TRUE(json["rows"][0]["speed_mm_per_s"].is_null());
  // The rounding of 20 µm is no error of the loop.
  EXPECT_LT(json["rows"][0]["max_contour_error_um"].get<double>(), 15.0);
  const std::string trace = text_of(f / "trace.csv");
  EXPECT_NE(trace.find("contour_error"), std::string::npos);
  // Byte by byte the same again.
  ASSERT_EQ(simulate(part).code, 0);
  EXPECT_EQ(text_of(f / "trace.csv"), trace);
}

TEST_F(PartProgram, ComparesControllers) {
  const std::string part = program(kHead + to("3.0000", "0.0000") +
                                   "ARC_FEED(3.0000, 4.0000, 3.0000, 2.0000, 1, 0.0000, 0.0000, 0.0000, "
                                   "0.0000)\nDWELL(0.1000)\n" +
                                   to("0.0000", "4.0000"));
  const Said said = command({"compare", kMachine, "--path", part, "--parameters", "thesis", "--trials", "1",
                             "--json", f / "all.json", "--report", f / "report"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_NE(said.out.find("its programmed feed"), std::string::npos) << said.out;
  const auto json = nlohmann::json::parse(text_of(f / "all.json"));
  EXPECT_EQ(json["rows"].size(), 6U);
  EXPECT_EQ(json["part"]["stops"], 1);
  EXPECT_GT(json["rows"][0]["rms_um"].get<double>(), json["rows"][5]["rms_um"].get<double>());
  EXPECT_NE(text_of(f / "report/index.html").find("place φ on the path"), std::string::npos);
}

// G18 turns from z to x: the arc that bulges to the outside is clockwise.
TEST_F(PartProgram, RunsOnALathe) {
  std::string text = text_of(kMachine);
  for (auto at = text.find("axes.y"); at != std::string::npos; at = text.find("axes.y", at))
    text[at + 5] = 'z';
  const std::string lathe = f.write("lathe.toml", text);
  const auto farthest = [&](const std::string& rotation) {
    const std::string part =
        program("SELECT_PLANE(CANON_PLANE_XZ)\n" + kHead + to("3.0000", "0.0000") +
                "ARC_FEED(4.0000, 3.0000, 2.0000, 3.0000, " + rotation +
                ", 0.0000, 0.0000, 0.0000, 0.0000)\n" + to("0.0000", "0.0000", "4.0000"));
    const Said said =
        command({"simulate", lathe, "--path", part, "--controller", "f", "-o", f / "lathe.csv"});
    EXPECT_EQ(said.code, 0) << said.err;
    std::istringstream rows(text_of(f / "lathe.csv"));
    std::string row;
    std::size_t column = 0;
    double most = 0.0;
    while (std::getline(rows, row)) {
      std::vector<std::string> cells;
      std::istringstream in(row);
      for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
      const auto named =
          std::find_if(cells.begin(), cells.end(), [](const auto& c) { return c.starts_with("r_x"); });
      if (named != cells.end())
        column = static_cast<std::size_t>(named - cells.begin());
      else if (column > 0 && cells.size() > column)
        most = std::max(most, std::stod(cells[column]));
    }
    return most;
  };
  EXPECT_NEAR(farthest("-1"), 5.0, 0.01);
  EXPECT_NEAR(farthest("1"), 3.0, 0.05);
  expect_refused(command({"simulate", lathe, "--path", program(kHead + to("1.0000", "5.0000")),
                          "--controller", "f", "-o", f / "other.csv"}),
                 {"part.ngc", "move 1", "y = 5 mm", "no axis y"});
}

TEST_F(PartProgram, WithoutTheInterpreterTellsHowToGetIt) {
  const std::string part = f.write("part.ngc", "G1 X1 F60\nM2\n");
  setenv("PATH", (f / "nothing").c_str(), 1);
  expect_refused(simulate(part),
                 {"part.ngc", "rs274", "tools/install-dependencies --linuxcnc", "linuxcnc-uspace"});
}

TEST_F(PartProgram, BadInputGetsOneLine) {
  expect_refused(simulate(f / "no.ngc"), {"no.ngc"});
  expect_refused(simulate("squircle"), {"--path", "squircle", "circle"});
  expect_refused(simulate(program("")), {"part.ngc", "no motion"});
  expect_refused(simulate(program(to("0.0000", "0.0000", "0.0000", "TRAVERSE"))), {"part.ngc", "no motion"});
  expect_refused(simulate(program(kHead + to("5.0000", "0.0000") + to("5.0000", "80.0000"))),
                 {"part.ngc", "axis y", "-75 to 75 mm", "75", "G92"});
  expect_refused(simulate(program(kHead + to("5.0000", "0.0000", "-1.0000"))),
                 {"part.ngc", "move 1", "no axis z"});
  expect_refused(simulate(program(kHead + "NURBS_FEED(3, ...)\n")), {"part.ngc", "NURBS_FEED"});
  expect_refused(simulate(program(kHead + to("5.0000", "0.0000")), {"--laps", "3"}), {"--path", "--laps"});
  expect_refused(simulate(program(kHead + to("5.0000", "0.0000")), {"--speed", "3 mm/s"}),
                 {"--speed", "feed"});
  expect_refused(simulate(program(kHead + to("5.0000", "0.0000")), {"--jerk", "0 mm/s3"}), {"--jerk"});
  expect_refused(simulate(program(kHead + to("5.0000", "0.0000")), {"--corner-tolerance", "10"}),
                 {"--corner-tolerance"});
  expect_refused(simulate("circle", {"--jerk", "1000 mm/s3"}), {"--jerk", "G-code"});
  const std::string part = program(kHead + to("5.0000", "0.0000"));
  expect_refused(command({"simulate", kMachine, "--path", part, "-o", part}), {"part.ngc"});
  const std::string slow = program("SET_FEED_RATE(0.0010)\n" + to("50.0000", "0.0000"));
  expect_refused(simulate(slow), {"--path", "control periods"});
}

TEST_F(PartProgram, SaysWhatItCannotKnow) {
  const Said said =
      simulate(program("USE_LENGTH_UNITS(CANON_UNITS_INCHES)\nCHANGE_TOOL(1)\nSET_FEED_RATE(40.0000)\n" +
                       to("0.2000", "0.1000")));
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_NE(said.out.find("2.54 um"), std::string::npos) << said.out;
  EXPECT_NE(said.out.find("length and radius 0"), std::string::npos) << said.out;
  const auto warnings = nlohmann::json::parse(text_of(f / "run.json"))["warnings"];
  ASSERT_GE(warnings.size(), 2U) << warnings;
  EXPECT_NE(warnings[0].get<std::string>().find("2.54 um"), std::string::npos);
  EXPECT_NE(warnings[1].get<std::string>().find("length and radius 0"), std::string::npos);
  // 40 inches in a minute are 16.9 mm/s, the axes do 10.
  EXPECT_NE(said.out.find("1 move slower than programmed"), std::string::npos) << said.out;
}

TEST_F(PartProgram, FeedOfTheOtherUnitIsSaid) {
  // As rs274 prints G20 F10: the feed first.
  const std::string line = "SET_FEED_RATE(10.0000)\nUSE_LENGTH_UNITS(CANON_UNITS_INCHES)\n";
  const std::string move = to("0.0200", "0.0000");
  const Said said = simulate(program(line + move));
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_NE(said.out.find("Warning: a feed of 10 mm/min remains in force under G20, as 0.393701 in/min"),
            std::string::npos)
      << said.out;
  // With the feed given again before the first move nothing is to be said.
  const Said again = simulate(program(line + "SET_FEED_RATE(10.0000)\n" + move));
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(again.out.find("a feed of"), std::string::npos) << again.out;
}

TEST_F(PartProgram, AxisWithoutTheOriginBeginsAtHome) {
  std::string machine = text_of(std::string(STRIBECK_SOURCE_DIR) + "/machines/biaxial-table.toml");
  const auto put = [&](const std::string& key, const std::string& value) {
    const auto at = machine.find(key, machine.find("[axes.y.limits]"));
    machine.replace(at, machine.find('\n', at) - at, key + " = \"" + value + "\"");
  };
  put("travel_min", "10 mm");
  put("travel_max", "30 mm");
  const std::string file = f.write("away.toml", machine);
  const auto run = [&](const std::string& calls) {
    std::filesystem::remove(f / "trace.csv");
    std::filesystem::remove(f / "run.json");
    return command({"simulate", file, "--path", program(kHead + calls), "--controller", "f", "--parameters",
                    "thesis", "-o", f / "trace.csv", "--json", f / "run.json"});
  };
  // x alone, then y from 20 mm to 21 mm: 3 mm, not 2 + 21.
  const Said said = run(to("2.0000", "0.0000") + to("2.0000", "21.0000"));
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_NE(said.out.find("axis y begins at 20 mm, the middle of its travel"), std::string::npos) << said.out;
  const auto json = nlohmann::json::parse(text_of(f / "run.json"));
  EXPECT_NEAR(json["part"]["length_mm"].get<double>(), 3.0, 0.05);
  EXPECT_EQ(json["warnings"].size(), 1U);
  // Once moved, 0 is a place as others.
  expect_refused(run(to("0.0000", "21.0000") + to("0.0000", "0.0000")), {"axis y", "10 to 30 mm"});
  expect_refused(run("ARC_FEED(0.0000, 20.0000, 0.0000, 10.0000, 1, 0.0000, 0.0000, 0.0000, 0.0000)\n"),
                 {"part.ngc", "arc", "y = 0", "G0"});
}

TEST_F(PartProgram, WhatIsNoProgramIsSaid) {
  const std::string good = program(kHead + to("5.0000", "0.0000"));
  expect_refused(simulate(f.write("empty.ngc", " \r\n\n")), {"empty.ngc", "is empty"});
  expect_refused(simulate(f.write("bom.ngc", "\xef\xbb\xbfG1 X1 F60\nM2\n")),
                 {"bom.ngc:1", "byte order mark"});
  expect_refused(simulate(f.write("nul.ngc", std::string("G1 X1\nG1 X2 \0 Y3\nM2\n", 19))),
                 {"nul.ngc:2", "byte 0", "G-code"});
  std::filesystem::create_directory(f / "folder.ngc");
  expect_refused(simulate(f / "folder.ngc"), {"folder.ngc", "directory"});
  ASSERT_EQ(mkfifo((f / "pipe.ngc").c_str(), 0600), 0);
  expect_refused(simulate(f / "pipe.ngc"), {"pipe.ngc", "pipe"});
  // Line ends of all systems are text.
  EXPECT_EQ(simulate(f.write("crlf.ngc", "G1 X1 F60\r\n\tM2\r\n")).code, 0);
}

TEST_F(PartProgram, LimitsOfTheOptionsCount) {
  const std::string part = program("SET_FEED_RATE(300.0000)\nDWELL(1.0000)\n" + to("1.0000", "0.0000"));
  const auto seconds = [&](std::vector<std::string> more) {
    const Said said = simulate(part, more);
    EXPECT_EQ(said.code, 0) << said.err;
    return nlohmann::json::parse(text_of(f / "run.json"))["part"]["duration_s"].get<double>();
  };
  // 1 mm at 5 mm/s: T = s/v + v/a + a/j, or s/v + 2·√(v/j) where v < a²/j.
  EXPECT_NEAR(seconds({}), 0.2 + 2.0 * std::sqrt(0.005 / 2.0), 1e-9);
  EXPECT_NEAR(seconds({"--acceleration", "50 mm/s2"}), 0.2 + 0.1 + 0.1, 1e-9);
  EXPECT_NEAR(seconds({"--acceleration", "50 mm/s2", "--jerk", "5000 mm/s3"}), 0.2 + 0.1 + 0.01, 1e-9);
}

TEST_F(PartProgram, ExampleThroughLinuxCnc) {
  setenv("PATH", path_.c_str(), 1);
  if (std::system("command -v rs274 >/dev/null") != 0) GTEST_SKIP() << "LinuxCNC's rs274 is not installed";
  const std::string part = std::string(STRIBECK_SOURCE_DIR) + "/examples/part.ngc";
  const Said said = simulate(part);
  ASSERT_EQ(said.code, 0) << said.err;
  const auto json = nlohmann::json::parse(text_of(f / "run.json"));
  EXPECT_EQ(json["part"]["moves"], 12);
  EXPECT_LE(json["part"]["rounding_um"].get<double>(), 50.0001);
  EXPECT_LT(json["rows"][0]["max_contour_error_um"].get<double>(), 15.0);
  const Said bad = simulate(f.write("bad.ngc", "G21\nG1 X1 F100\nG1 X1Q\nM2\n"));
  EXPECT_EQ(bad.code, 2);
  EXPECT_NE(bad.err.find("bad.ngc:3: "), std::string::npos) << bad.err;
}

}  // namespace
}  // namespace stribeck::test::part_program_test
