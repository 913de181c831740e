#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stribeck/io/error.hpp>
#include <stribeck/io/process/outside_program.hpp>
#include <stribeck/io/test_folder.hpp>
#include <thread>

namespace stribeck::io::outside_program_test {
namespace {

using stribeck::test::Folder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Limits that a test can wait for.
ProgramLimits short_limits() {
  ProgramLimits l;
  l.seconds = 0.3;
  l.first_answer = 0.3;
  l.answer = 0.3;
  return l;
}

std::string failure_of(const std::vector<std::string>& words, const ProgramLimits& limits = short_limits()) {
  try {
    run_to_end(words, limits);
  } catch (const ProgramFailed& e) {
    return e.what();
  }
  return "none";
}

std::string silence_of(const std::string& script, const std::string& line = "a line\n", int answers = 1) {
  try {
    Conversation talk({"sh", "-c", script}, short_limits());
    talk.say(line);
    for (int i = 0; i < answers; ++i) static_cast<void>(talk.answer());
  } catch (const ProgramFailed& e) {
    return e.what();
  }
  return "none";
}

TEST(SplitCommand, SplitsAtBlanksAndKeepsQuotedWords) {
  EXPECT_THAT(split_command("python3  'my fit.py' --name=\"a b\" \t\"\"", "--identifier"),
              ElementsAre("python3", "my fit.py", "--name=a b", ""));
  // No shell: what a shell would obey is a word.
  EXPECT_THAT(split_command("echo $HOME;rm *", "--identifier"), ElementsAre("echo", "$HOME;rm", "*"));
}

TEST(SplitCommand, RefusesAnOpenQuoteAndNothing) {
  for (const auto& [text, part] :
       {std::pair{"fit 'a", "a quote is not closed"}, std::pair{"  ", "got nothing"}}) {
    try {
      static_cast<void>(split_command(text, "--identifier"));
      ADD_FAILURE() << text;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr(part));
      EXPECT_THAT(e.what(), HasSubstr("--identifier"));
    }
  }
}

TEST(RunToEnd, RunsInItsFolder) {
  const Folder f;
  ProgramLimits limits;
  limits.folder = f / ".";
  run_to_end({"sh", "-c", "echo done > here"}, limits);
  EXPECT_TRUE(std::filesystem::exists(f / "here"));
}

TEST(RunToEnd, TellsHowAProgramFailed) {
  EXPECT_EQ(failure_of({"true"}), "none");
  EXPECT_EQ(failure_of({"sh", "-c", "echo why >&2; exit 3"}), "ended with exit code 3; it says: why");
  EXPECT_THAT(failure_of({"sh", "-c", "kill -SEGV $$"}), HasSubstr("was ended by signal 11"));
  EXPECT_THAT(failure_of({"no-such-program"}), HasSubstr("\"no-such-program\" cannot be run: No such file"));
  EXPECT_EQ(failure_of({"sleep", "60"}), "did not end within 0.3 s");
  // A flood of text is no reason to wait or to grow.
  EXPECT_THAT(failure_of({"sh", "-c", "yes"}), HasSubstr("did not end within 0.3 s"));
}

/// Whether a process of this number exists; one that was killed may still be on its way out.
bool is_gone(int id) {
  for (int i = 0; i < 200; ++i) {
    std::ifstream status("/proc/" + std::to_string(id) + "/stat");
    std::string text;
    std::getline(status, text);
    // Nobody in a container may collect it: then it stays as a zombie, which runs nothing.
    if (text.empty() || text.find(") Z") != std::string::npos) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

TEST(RunToEnd, LeavesNoChildOfTheProgramRunning) {
  const Folder f;
  for (const char* script : {"sleep 60 & echo $! > child; wait", "sleep 60 & echo $! > child"}) {
    ProgramLimits limits = short_limits();
    limits.folder = f / ".";
    static_cast<void>(failure_of({"sh", "-c", script}, limits));
    int id = 0;
    std::ifstream(f / "child") >> id;
    ASSERT_GT(id, 1);
    EXPECT_TRUE(is_gone(id)) << script;
  }
}

TEST(Conversation, AnswersLineByLine) {
  Conversation talk({"sh", "-c", "while read a b; do echo $b $a; done"}, short_limits());
  talk.say("1 2\n3 4\n");
  EXPECT_EQ(talk.answer(), "2 1");
  EXPECT_EQ(talk.answer(), "4 3");
  talk.say("5 6\n");
  EXPECT_EQ(talk.answer(), "6 5");
}

TEST(Conversation, TellsWhyThereIsNoAnswer) {
  EXPECT_EQ(silence_of("sleep 60"), "did not answer within 0.3 s");
  EXPECT_EQ(silence_of("echo broken >&2; exit 4"), "ended with exit code 4; it says: broken");
  EXPECT_THAT(silence_of("kill -SEGV $$"), HasSubstr("was ended by signal 11"));
  EXPECT_EQ(silence_of("read a; exec >&- <&-; sleep 60"), "closed its output");
  // It answers once, then never again.
  EXPECT_EQ(silence_of("read a; echo ok; sleep 60", "a\n", 2), "did not answer within 0.3 s");
  EXPECT_THAT(silence_of("head -c 200000 /dev/zero | tr '\\0' x; sleep 60"),
              HasSubstr("said more than 64 KiB"));
}

// It never reads: what is said fills the pipe, and the program is not waited for without end.
TEST(Conversation, IsNotBlockedByAProgramThatDoesNotRead) {
  EXPECT_EQ(silence_of("sleep 60", std::string(1 << 22, 'x') + "\n"), "did not answer within 0.3 s");
}

// Writing to a pipe whose reader is gone must not end this program (SIGPIPE).
TEST(Conversation, SurvivesAProgramThatHasEnded) {
  Conversation talk({"true"}, short_limits());
  std::string why;
  try {
    for (int i = 0; i < 200; ++i) {
      talk.say("a line\n");
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  } catch (const ProgramFailed& e) {
    why = e.what();
  }
  EXPECT_EQ(why, "closed its input");
}

}  // namespace
}  // namespace stribeck::io::outside_program_test
