#include <gtest/gtest.h>

#include <limits>
#include <stribeck/report/text.hpp>

namespace stribeck::report::text_test {
namespace {

TEST(Text, BecomesCleanUtf8) {
  EXPECT_EQ(clean_text("a\tb\nc\x7f"), "a b c ");
  EXPECT_EQ(clean_text("a\nb", true), "a\nb");
  EXPECT_EQ(clean_text("\xC2\x85|"), " |");  // next line, a control character of two bytes
  EXPECT_EQ(clean_text("µ ε π 😀"), "µ ε π 😀");
  // Not UTF-8: a lone byte, an overlong slash, a surrogate, a sequence that is cut off.
  EXPECT_EQ(clean_text("\xff|"), "\uFFFD|");
  EXPECT_EQ(clean_text("\xC0\xAF|"), "\uFFFD\uFFFD|");
  EXPECT_EQ(clean_text("\xED\xA0\x80|"), "\uFFFD\uFFFD\uFFFD|");
  EXPECT_EQ(clean_text("\xE0\x80\xAF|"), "\uFFFD\uFFFD\uFFFD|");
  EXPECT_EQ(clean_text("\xE2\x82"), "\uFFFD\uFFFD");
}

TEST(Text, AlignsByLetters) {
  EXPECT_EQ(text_width("±µm"), 3u);
  EXPECT_EQ(left_aligned("µm", 4), "µm  ");
  EXPECT_EQ(right_aligned("µm", 4), "  µm");
  EXPECT_EQ(left_aligned("µmµmµ", 4), "µmµ…");
  EXPECT_EQ(left_aligned("abc", 0), "");
}

TEST(Text, RoundsForReading) {
  EXPECT_EQ(decimals(1.005e3, 1), "1005.0");
  EXPECT_EQ(decimals(-0.004, 2), "0.00");
  EXPECT_EQ(decimals(-0.006, 2), "-0.01");
  EXPECT_EQ(with_sign(-0.4, 0), "0");
  EXPECT_EQ(with_sign(0.4, 0), "0");
  EXPECT_EQ(with_sign(1.5, 1), "+1.5");
  EXPECT_EQ(with_sign(-1.5, 1), "-1.5");
  EXPECT_EQ(with_sign(std::numeric_limits<double>::quiet_NaN(), 1), "–");
  EXPECT_EQ(decimals(std::numeric_limits<double>::quiet_NaN(), 2), "–");
  EXPECT_EQ(significant(0.0234567, 3), "0.0235");
  EXPECT_EQ(significant(57650.123, 3), "57650");
  EXPECT_EQ(significant(-1.26, 2), "-1.3");
  EXPECT_EQ(significant(0.0, 3), "0");
  EXPECT_EQ(short_number(9.5), "9.5");
  EXPECT_EQ(short_number(3.0), "3");
}

TEST(Text, ListsWords) {
  EXPECT_EQ(listed({}), "");
  EXPECT_EQ(listed({"a"}), "a");
  EXPECT_EQ(listed({"a", "b"}), "a and b");
  EXPECT_EQ(listed({"a", "b", "c"}), "a, b and c");
}

}  // namespace
}  // namespace stribeck::report::text_test
