#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/study/shared_runs.hpp>
#include <string>
#include <thread>
#include <vector>

namespace stribeck::workflow::shared_runs_test {
namespace {

using namespace std::chrono_literals;
using test::Folder;
using testing::ElementsAre;
using testing::IsEmpty;

/// Of a thousand runs, in a folder.
struct Shared {
  std::vector<std::string> said;
  SharedRuns runs;

  explicit Shared(const std::string& folder, SharedRuns::Pace pace = {1ms, 1h}, const char* inputs = "study",
                  std::uint64_t count = 1000)
      : runs(
            folder, inputs, count, [this](const std::string& text) { said.push_back(text); }, pace) {}
};

std::vector<std::string> files_in(const Folder& f) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(f / ""))
    names.push_back(entry.path().filename().string());
  return names;
}

TEST(SharedRuns, EachBlockIsClaimedOnce) {
  const Folder f;
  Shared a(f / ""), b(f / "");
  EXPECT_EQ(a.runs.claim(), std::nullopt);  // no leader yet
  EXPECT_FALSE(b.runs.open());
  a.runs.share_from(2);
  EXPECT_TRUE(b.runs.open());
  // A thousand runs are dealt in threes.
  EXPECT_EQ(a.runs.begin_of(2), 6U);
  EXPECT_EQ(a.runs.end_of(2), 9U);
  EXPECT_EQ(a.runs.end_of(333), 1000U);
  EXPECT_EQ(a.runs.block_of(8), 2U);
  EXPECT_EQ(a.runs.claim(), 2U);
  EXPECT_EQ(b.runs.claim(), 3U);
  EXPECT_EQ(b.runs.rows(2), std::nullopt);
  a.runs.finish(2, "6,\n7,\n8,\n");
  EXPECT_EQ(b.runs.rows(2), "6,\n7,\n8,\n");
  EXPECT_EQ(a.runs.claim(), 4U);
  // What is taken over is not computed again, and leaves no file.
  a.runs.share_from(3);
  EXPECT_EQ(b.runs.rows(2), std::nullopt);
  b.runs.finish(3, "9,\n10,\n11,\n");
  EXPECT_EQ(b.runs.claim(), 5U);
  // Damaged rows are nobody's.
  a.runs.discard(3);
  a.runs.finish(4, "x");
  EXPECT_EQ(a.runs.claim(), 3U);
  a.runs.close();
  EXPECT_EQ(b.runs.claim(), std::nullopt);
  b.runs.finish(5, "y");
  EXPECT_FALSE(b.runs.open());
}

TEST(SharedRuns, TheLastBlockIsTheEnd) {
  const Folder f;
  Shared a(f / "", {1ms, 1h}, "study", 5);
  a.runs.share_from(4);
  EXPECT_EQ(a.runs.claim(), 4U);
  a.runs.finish(4, "4,\n");
  EXPECT_EQ(a.runs.claim(), std::nullopt);
}

TEST(SharedRuns, WhatADeadProcessHasClaimedIsFreeAgain) {
  const Folder f;
  Shared a(f / "", {1ms, 20ms});
  a.runs.share_from(0);
  const std::filesystem::path folder = *std::filesystem::directory_iterator(f / "");
  const auto write = [&](const char* name, const char* text) {
    f.write((folder.filename() / name).string(), text);
  };
  write("0.claim", "ghost-1-0");
  write("alive-ghost-1-0", "17");
  EXPECT_EQ(a.runs.claim(), 1U);  // it is seen for the first time, and may live
  a.runs.finish(1, "r");
  std::optional<std::uint64_t> got;
  for (std::uint64_t k = 2; got != 0U && k < 300; ++k) {
    std::this_thread::sleep_for(5ms);
    got = a.runs.claim();
    if (got && got != 0U) a.runs.finish(*got, "r");
  }
  EXPECT_EQ(got, 0U);
  EXPECT_THAT(a.said,
              ElementsAre("process ghost-1-0 does not answer any more: runs 0 to 2 are computed again"));
  // Rows that it finished before stay.
  write("1.claim", "ghost-1-0");
  std::this_thread::sleep_for(50ms);
  EXPECT_NE(a.runs.claim(), 1U);
  EXPECT_EQ(a.runs.rows(1), "r");
}

// However long it is looked away: what counts is that the number is another one at each look.
TEST(SharedRuns, AProcessThatCountsIsAlive) {
  const Folder f;
  Shared a(f / "", {1ms, 5ms});
  a.runs.share_from(0);
  const std::filesystem::path folder = *std::filesystem::directory_iterator(f / "");
  const auto count = [&](int n) {
    f.write((folder.filename() / "alive-ghost-1-0").string(), std::to_string(n).c_str());
  };
  f.write((folder.filename() / "0.claim").string(), "ghost-1-0");
  for (int k = 0; k < 30; ++k) {
    count(k);
    std::this_thread::sleep_for(10ms);
    const auto got = a.runs.claim();
    ASSERT_TRUE(got);
    EXPECT_NE(*got, 0U);
    a.runs.finish(*got, "r");
  }
  EXPECT_THAT(a.said, IsEmpty());
}

// It gives back what it has; here two blocks.
TEST(SharedRuns, AProcessThatEndsFreesItsBlocks) {
  const Folder f;
  Shared a(f / "");
  a.runs.share_from(0);
  {
    Shared b(f / "");
    EXPECT_EQ(b.runs.claim(), 0U);
    EXPECT_EQ(b.runs.claim(), 1U);
    EXPECT_EQ(a.runs.claim(), 2U);
  }
  EXPECT_EQ(a.runs.claim(), 0U);
  EXPECT_EQ(a.runs.claim(), 1U);
}

TEST(SharedRuns, AFolderThatCannotBeWrittenIsSaid) {
  const Folder f;
  f.write("no", "a file");
  Shared a(f / "no");
  EXPECT_THROW(a.runs.share_from(0), io::InputError);
}

// While its processes count; what they left is none, and a leader takes it away.
TEST(SharedRuns, AnotherStudyInTheFolderIsSeen) {
  const Folder f;
  Shared b(f / "", {1h, 1h}, "another");
  EXPECT_FALSE(b.runs.others());
  std::optional<Shared> a;
  a.emplace(f / "", SharedRuns::Pace{1ms, 1h});
  a->runs.share_from(0);
  bool seen = false;
  for (int k = 0; k < 5000 && !seen; ++k) {
    seen = b.runs.others();
    std::this_thread::sleep_for(2ms);
  }
  EXPECT_TRUE(seen);
  EXPECT_FALSE(b.runs.open());
  a.reset();
  EXPECT_FALSE(b.runs.others());
  b.runs.clear_others();
  EXPECT_THAT(files_in(f), IsEmpty());
}

// More samples of the same study are other blocks.
TEST(SharedRuns, AnotherNumberOfRunsIsAnotherFolder) {
  const Folder f;
  Shared few(f / "", {1ms, 1h}, "study", 511), many(f / "", {1ms, 1h}, "study", 1000);
  few.runs.share_from(0);
  EXPECT_TRUE(few.runs.open());
  EXPECT_FALSE(many.runs.open());
}

}  // namespace
}  // namespace stribeck::workflow::shared_runs_test
