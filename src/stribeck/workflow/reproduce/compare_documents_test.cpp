#include <gtest/gtest.h>

#include <stribeck/workflow/reproduce/compare_documents.hpp>
#include <string>

namespace stribeck::test::compare_documents_test {
namespace {

using workflow::first_difference;

/// A table of printed figures: name, printed value, source, computed value, interval.
std::string figures(const std::string& name, const std::string& printed, const std::string& ours) {
  return "| figure | of | thesis | ours | range |\n|---|---|---|---|---|\n| " + name + " | x | " + printed +
         " | " + ours + " | 1 … 2 |\n";
}

TEST(CompareDocuments, EqualTextsDoNotDiffer) {
  EXPECT_EQ(first_difference("", ""), "");
  EXPECT_EQ(first_difference(figures("mass", "57.65", "57.80"), figures("mass", "57.65", "57.80")), "");
}

TEST(CompareDocuments, MeasuredNumbersMayDifferByRoundingOnly) {
  const std::string there = figures("mass", "57.65", "57.80");
  EXPECT_EQ(first_difference(there, figures("mass", "57.65", "57.95")), "");
  // By more than 6 % and 1.6 units of the last decimal.
  EXPECT_EQ(first_difference(there, figures("mass", "57.65", "65.00")).substr(0, 11), "3: expected");
  // Near zero the sign may change.
  EXPECT_EQ(first_difference(figures("bias", "0", "0.01"), figures("bias", "0", "-0.00")), "");
  EXPECT_NE(first_difference(figures("bias", "0", "1.01"), figures("bias", "0", "-1.01")), "");
}

TEST(CompareDocuments, WhatWasPrintedIsComparedToTheLetter) {
  const std::string there = figures("mass", "57.65", "57.80");
  EXPECT_NE(first_difference(there, figures("mass", "57.66", "57.80")), "");
  EXPECT_NE(first_difference(there, figures("Mass", "57.65", "57.80")), "");
}

TEST(CompareDocuments, NamesTheFirstLineThatIsMissing) {
  EXPECT_EQ(first_difference("a\nb\n", "a\n"), "2: expected \"b\", got \"\"");
  EXPECT_EQ(first_difference("a\n", "a\nc\n"), "2: expected \"\", got \"c\"");
}

}  // namespace
}  // namespace stribeck::test::compare_documents_test
