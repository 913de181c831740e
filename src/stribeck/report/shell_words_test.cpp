#include <gtest/gtest.h>

#include <stribeck/report/shell_words.hpp>
#include <string>
#include <vector>

namespace stribeck::report::shell_words_test {
namespace {

TEST(ShellWords, AWordThatAShellWouldSplitIsQuoted) {
  EXPECT_EQ(shell_quoted("logs/x-1.csv"), "logs/x-1.csv");
  EXPECT_EQ(shell_quoted("my machine.toml"), "'my machine.toml'");
  EXPECT_EQ(shell_quoted("it's; rm"), "'it'\\''s; rm'");
  EXPECT_EQ(shell_quoted(""), "''");
  EXPECT_EQ(shell_quoted(std::vector<std::string>{"a.csv", "b c.csv"}), "a.csv 'b c.csv'");
}

}  // namespace
}  // namespace stribeck::report::shell_words_test
