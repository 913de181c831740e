// The interpreter as a separate program, with scripts in its place.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stribeck/io/error.hpp>
#include <stribeck/io/gcode/interpreter.hpp>

namespace stribeck::io::interpreter_test {
namespace {

using testing::ThrowsMessage;

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class Interpreter : public testing::Test {
 protected:
  Interpreter() {
    std::string name = (std::filesystem::temp_directory_path() / "stribeck-rs274-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~Interpreter() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  [[nodiscard]] PartProgram read(const std::string& program, const std::string& script,
                                 double seconds = 60.0) const {
    InterpreterOptions options;
    options.command = write("interpreter", "#!/bin/sh\n" + script);
    chmod(options.command.c_str(), 0700);
    options.seconds = seconds;
    return read_part_program(write("part.ngc", program), options);
  }
  [[nodiscard]] std::string refusal(const std::string& program, const std::string& script,
                                    double seconds = 60.0) const {
    try {
      static_cast<void>(read(program, script, seconds));
    } catch (const InputError& e) {
      EXPECT_EQ(e.problems().size(), 1U);
      return e.problems().front().text();
    }
    ADD_FAILURE() << "accepted";
    return {};
  }
  std::filesystem::path folder_;
};

TEST_F(Interpreter, IsGivenTheFileAndItsCallsAreRead) {
  // The last argument is the program, not a word of a shell; calls may come in pieces.
  const auto part = read(
      "G1 X1 F60\nM2\n",
      "for last; do :; done\n"
      "[ \"$1\" = -g ] && [ \"$2\" = -t ] && grep -q '^T999 P999$' \"$3\" && grep -q X1 \"$last\" || exit "
      "3\n"
      "echo hello\n"
      "printf '    1 N..... SET_FEED_RATE(60.0000)\\n    2 N..... STRAIGHT_'\n"
      "printf 'FEED(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\\n    3 N..... CHANGE_TOOL(1)\\n'\n"
      "echo '    4 N..... PROGRAM_END()'\necho executing >&2\n");
  ASSERT_EQ(part.moves.size(), 1U);
  EXPECT_DOUBLE_EQ(part.moves[0].to[0], 1e-3);
  EXPECT_TRUE(part.tools);
  EXPECT_FALSE(part.inches);
}

TEST_F(Interpreter, OffsetsOfToolsAreSeenInTheProgram) {
  // As the interpreter prints them, they are no calls.
  const auto tools = [&](const std::string& program) { return read(program + "\nM2\n", "exit 0\n").tools; };
  for (const char* program : {"G41 D5", "g42d1", "G0 X1 G43 H2", "G 0 4 1", "G90G41", "(a) G43"})
    EXPECT_TRUE(tools(program)) << program;
  for (const char* program : {"G40", "G49", "G43.1 Z2", "G41.1 D3", "(G41)", "G1 X1 ; G43", "G4 P41",
                              "o<bag41> call", "G410 X1", "X41", "G1 X41 Y42 Z43"})
    EXPECT_FALSE(tools(program)) << program;
}

// The interpreter prints the end as the start, and the arc would be a full circle of 32 mm.
TEST_F(Interpreter, AnArcTooShortForItsDecimalsIsRefused) {
  const std::string head = "G20 G17 G90\nF10\nG0 X0 Y0\nG1 X.2\n";
  const std::string script =
      "echo '1 N..... USE_LENGTH_UNITS(CANON_UNITS_INCHES)'\necho '2 N..... SET_FEED_RATE(10.0000)'\n"
      "echo '3 N..... STRAIGHT_FEED(0.2000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)'\n"
      "echo '4 N..... ARC_FEED(0.2000, 0.0000, 0.0000, 0.0000, 1, 0.0000, 0.0000, 0.0000, 0.0000)'\n";
  EXPECT_THAT(refusal(head + "G3 X.20000 Y0.00004 I-.2 J0\nM2\n", script),
              AllOf(HasSubstr("part.ngc:5: an arc ends 4e-05 of its unit from its start"), HasSubstr("G21")));
  EXPECT_THAT(refusal(head + "g 2 x .2 y-.00004 (back) i-.2 ; short\nM2\n", script),
              HasSubstr("part.ngc:5:"));
  EXPECT_THAT(refusal(head + "G3 Y0.00004 R.2\nM2\n", script), HasSubstr("part.ngc:5:"));
  EXPECT_THAT(refusal(head + "G3 X0 Y.2 I-.2\nX.2 Y0 J-.2\nX.2 Y.00003 I-.2\nM2\n", script),
              HasSubstr("part.ngc:7:"));
  EXPECT_THAT(refusal("G20 G18\nG0 X.2 Z0\nG3 X.2 Z-0.00004 I-.2\nM2\n", script), HasSubstr("part.ngc:3:"));
  // Full circles, arcs that go nearly around, and what is not told by plain numbers.
  for (const char* arc : {"G3 X.2 Y0 I-.2", "G3 I-.2", "G3 X.20000 Y-0.00004 I-.2", "G2 X.2 Y0.00004 I-.2",
                          "G3 Y0.00004 R-.2", "G91 G3 Y.00004 I-.2", "G3 X[.2] Y.00004 I-.2",
                          "(G3 Y.00004 I-.2)", "G3 Y0.00004 I-.2 P2", "G1 Y0.00004", "G3 Y0.0001 I-.2"})
    EXPECT_EQ(read(head + arc + "\nM2\n", script).moves.size(), 2U) << arc;
  // Another frame: where the arc begins is not told.
  EXPECT_EQ(read(head + "G55\nG3 X.2 Y.00004 I-.2\nM2\n", script).moves.size(), 2U);
}

TEST_F(Interpreter, ItsRefusalNamesTheLine) {
  const std::string script = "echo executing >&2; echo 'Bad character used' >&2; echo 'G1 X1Q' >&2; exit 1\n";
  EXPECT_THAT(refusal("G21\n  G1 X1Q  \nM2\n", script),
              AllOf(HasSubstr("part.ngc:2: Bad character used"), HasSubstr("\"G1 X1Q\""),
                    Not(HasSubstr("executing"))));
  EXPECT_THAT(refusal("G1 X1Q\nG21\nG1 X1Q\n", script), AllOf(HasSubstr("part.ngc:1:"), HasSubstr("line 3")));
  EXPECT_THAT(refusal("G1 X2\n", script), HasSubstr("part.ngc: Bad character used"));
  EXPECT_THAT(refusal("G1 X2\n", "exit 1\n"), HasSubstr("refuses"));
  // Its place is the end, whatever line reads like the last.
  EXPECT_THAT(
      refusal("G1 X2\nG1 X3\nG1 X2\n",
              "echo 'File ended with no percent sign or program end' >&2; echo 'G1 X2' >&2; exit 1\n"),
      AllOf(HasSubstr("part.ngc:3: "), HasSubstr("M2 or M30"), Not(HasSubstr("reads the same"))));
}

TEST_F(Interpreter, EndsWhenItTakesTooLongOrPrintsTooMuch) {
  EXPECT_THAT(refusal("M2\n", "sleep 600\n", 0.05), HasSubstr("within 0.05 s"));
  EXPECT_THAT(refusal("M2\n", "head -c 200000 /dev/zero | tr '\\0' x\nsleep 600\n"), HasSubstr("64 KiB"));
  // A move that is refused ends it too.
  EXPECT_THAT(refusal("M2\n", "echo '1 N..... NURBS_FEED(3, ...)'\nsleep 600\n"), HasSubstr("NURBS_FEED"));
}

TEST_F(Interpreter, WithoutEndAndMotionIsRefused) {
  EXPECT_THAT(
      refusal("M2\n", "while :; do echo '   11 N..... DWELL(0.0000)'; done\n"),
      AllOf(HasSubstr("200000 calls of the interpreter without a motion"), HasSubstr("loop without end")));
  InterpreterOptions silent;
  silent.command = write("silent", "#!/bin/sh\nsleep 600\n");
  chmod(silent.command.c_str(), 0700);
  silent.silent_seconds = 0.1;
  EXPECT_THAT([&] { static_cast<void>(read_part_program(write("part.ngc", "M2\n"), silent)); },
              ThrowsMessage<InputError>(HasSubstr("said nothing for 0.1 s")));
}

// However the program ends that asked: nothing runs on, and no file is left.
TEST_F(Interpreter, DoesNotOutliveWhatRunsIt) {
  const std::string tools = (folder_ / "tmp").string();
  std::filesystem::create_directory(tools);
  for (const int signal : {SIGTERM, SIGHUP, SIGINT, SIGKILL}) {
    const std::string told = (folder_ / ("pid" + std::to_string(signal))).string();
    const pid_t runner = fork();
    if (runner == 0) {
      setenv("TMPDIR", tools.c_str(), 1);
      InterpreterOptions endless;
      endless.command = write("endless", "#!/bin/sh\necho $$ >" + told + ".part; mv " + told + ".part " +
                                             told + "\nwhile :; do :; done\n");
      chmod(endless.command.c_str(), 0700);
      try {
        static_cast<void>(read_part_program(write("part.ngc", "M2\n"), endless));
      } catch (...) {
      }
      _exit(0);
    }
    for (int i = 0; i < 1000 && !std::filesystem::exists(told); ++i) usleep(10'000);
    pid_t interpreter = 0;
    std::ifstream(told) >> interpreter;
    ASSERT_GT(interpreter, 0);
    kill(runner, signal);
    waitpid(runner, nullptr, 0);
    const auto runs = [&] {
      std::ifstream status("/proc/" + std::to_string(interpreter) + "/stat");
      std::string id, name, state;
      return status >> id >> name >> state && state != "Z";
    };
    for (int i = 0; i < 500 && runs(); ++i) usleep(10'000);
    EXPECT_FALSE(runs()) << signal;
    if (runs()) kill(interpreter, SIGKILL);
  }
  EXPECT_TRUE(std::filesystem::is_empty(tools));
}

TEST_F(Interpreter, KilledIsNoEnd) { EXPECT_THAT(refusal("G1 X1\n", "kill -9 $$\n"), HasSubstr("signal 9")); }

TEST_F(Interpreter, MissingTellsHowToGetIt) {
  InterpreterOptions options;
  options.command = (folder_ / "none").string();
  try {
    static_cast<void>(read_part_program(write("part.ngc", "M2\n"), options));
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("part.ngc"), HasSubstr("install-dependencies --linuxcnc"),
                                HasSubstr("linuxcnc-uspace")));
  }
  EXPECT_THAT([&] { static_cast<void>(read_part_program((folder_ / "no.ngc").string())); },
              ThrowsMessage<InputError>(HasSubstr("no such file")));
}

}  // namespace
}  // namespace stribeck::io::interpreter_test
