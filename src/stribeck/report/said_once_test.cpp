#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/report/said_once.hpp>
#include <string>
#include <vector>

namespace stribeck::report::said_once_test {
namespace {

using ::testing::ElementsAre;

TEST(SaidOnce, TheSameOfSeveralLogsStandsBehindTheirNamesWhereTheFirstStood) {
  EXPECT_THAT(said_once({"a.csv: rounded", "whole: late", "b.csv: rounded", "b.csv: short", "whole: late",
                         "b.csv: rounded"},
                        {"a.csv", "b.csv"}),
              ElementsAre("a.csv, b.csv: rounded", "whole: late", "b.csv: short"));
}

TEST(SaidOnce, ManyLogsAreCounted) {
  const std::vector<std::string> logs{"1", "2", "3", "4", "5"};
  std::vector<std::string> notes;
  for (const std::string& log : logs) notes.push_back(log + ": rounded");
  EXPECT_THAT(said_once(notes, logs), ElementsAre("1, 2 and 3 other logs: rounded"));
  notes.pop_back();
  EXPECT_THAT(said_once(notes, logs), ElementsAre("1, 2, 3, 4: rounded"));
}

// What names its log in another way, or another log, is left as it is.
TEST(SaidOnce, OtherNotesStay) {
  EXPECT_THAT(said_once({"a.csv and b.csv are the same", "c.csv: rounded", "rounded"}, {"a.csv", "b.csv"}),
              ElementsAre("a.csv and b.csv are the same", "c.csv: rounded", "rounded"));
  EXPECT_TRUE(said_once({}, {"a.csv"}).empty());
}

}  // namespace
}  // namespace stribeck::report::said_once_test
