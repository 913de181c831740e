#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/study/results_file.hpp>

namespace stribeck::workflow::results_file_test {
namespace {

using test::Folder;
using test::text_of;
using testing::HasSubstr;

const ResultsLayout kLayout{"run,a,b", 2, 5};

std::string rows(std::uint64_t run) {
  const std::string n = std::to_string(run);
  return n + ",1.5," + n + "\n" + n + ",,x\n";
}

/// Goes on to the end.
void finish(const Folder& f) {
  ResultsFile file(f / ".", "inputs\n", kLayout);
  while (file.finished() < kLayout.runs) file.add(rows(file.finished()));
}

std::string refused(const Folder& f, const std::string& inputs = "inputs\n",
                    const ResultsLayout& layout = kLayout) {
  try {
    const ResultsFile file(f / ".", inputs, layout);
  } catch (const io::InputError& e) {
    return e.problems().front().text();
  }
  return "nothing";
}

// Wherever the file was cut off, and with zeros behind it, the same bytes come out.
TEST(ResultsFile, GoesOnFromAnyByte) {
  Folder whole;
  finish(whole);
  const std::string text = text_of(whole / "results.csv");
  EXPECT_EQ(text, "run,a,b\n" + rows(0) + rows(1) + rows(2) + rows(3) + rows(4));
  for (std::size_t n = 0; n <= text.size(); ++n) {
    for (const std::string& behind : {std::string(), std::string(1, '\0'), std::string("\0\0\n2,", 5)}) {
      if (n < kLayout.head.size() + 1 && !behind.empty()) continue;
      Folder f;
      f.write("results.csv", text.substr(0, n) + behind);
      f.write("inputs.txt", "inputs\n");
      finish(f);
      EXPECT_EQ(text_of(f / "results.csv"), text) << n;
      EXPECT_EQ(text_of(f / "inputs.txt"), "inputs\n");
    }
  }
}

TEST(ResultsFile, CountsFinishedRunsAlone) {
  Folder f;
  f.write("inputs.txt", "inputs\n");
  f.write("results.csv", "run,a,b\n" + rows(0) + "1,1.5,1\n");
  EXPECT_EQ(ResultsFile(f / ".", "inputs\n", kLayout).finished(), 1U);
  EXPECT_EQ(text_of(f / "results.csv"), "run,a,b\n" + rows(0));
}

TEST(ResultsFile, OtherRowsAreNotTakenUp) {
  Folder f;
  finish(f);
  const std::string text = text_of(f / "results.csv");
  EXPECT_THAT(refused(f, "other\n"),
              HasSubstr("results.csv: holds the runs of another study, machine or version, "
                        "first difference \"other\""));
  EXPECT_THAT(refused(f, "inputs\n", {"run,a,c", 2, 5}), HasSubstr("is no head of this study"));
  EXPECT_THAT(refused(f, "inputs\n", {"run,a,b", 2, 4}), HasSubstr("holds 5 runs, the study asks for 4"));
  f.write("results.csv", "run,a,b\n0,1.5,0\n0,,x\n2,1.5,1\n1,,x\n");
  EXPECT_THAT(refused(f), HasSubstr("results.csv:4: is no row that this study writes"));
  f.write("results.csv", "run,a,b\n0,1.5,0,7\n0,,x\n");
  EXPECT_THAT(refused(f), HasSubstr("results.csv:2: is no row that this study writes"));
  f.write("results.csv", "t,x\n1,2\n");
  EXPECT_THAT(refused(f), HasSubstr("is no head of this study"));
  EXPECT_EQ(text_of(f / "results.csv"), "t,x\n1,2\n");
  std::filesystem::remove(f / "inputs.txt");
  f.write("results.csv", text);
  EXPECT_THAT(refused(f), HasSubstr("is there without the inputs.txt"));
  EXPECT_EQ(text_of(f / "results.csv"), text);
}

TEST(ResultsFile, OneProgramAtATime) {
  Folder f;
  const ResultsFile first(f / ".", "inputs\n", kLayout);
  EXPECT_THAT(refused(f), HasSubstr("another program adds runs to it at the moment"));
}

TEST(ResultsFile, RowsAreReadAsWritten) {
  Folder f;
  finish(f);
  std::vector<std::string> read;
  for_each_row(f / "results.csv", [&](std::uint64_t line, const std::vector<std::string_view>& cells) {
    read.push_back(std::to_string(line) + ":");
    for (const std::string_view cell : cells) read.back() += std::string(cell) + '|';
  });
  ASSERT_EQ(read.size(), 10U);
  EXPECT_EQ(read[0], "2:0|1.5|0|");
  EXPECT_EQ(read[9], "11:4||x|");
  // Longer than what is read at once.
  const std::string longer(200000, '7');
  f.write("long.csv", "a,b\n" + longer + ",1\n2,3\n");
  std::size_t sizes = 0;
  for_each_row(f / "long.csv",
               [&](std::uint64_t, const std::vector<std::string_view>& cells) { sizes += cells[0].size(); });
  EXPECT_EQ(sizes, 200001U);
}

}  // namespace
}  // namespace stribeck::workflow::results_file_test
