#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/io/printable.hpp>

namespace stribeck::io::json_test {
namespace {

TEST(Json, KeepsOrderAndWritesNull) {
  Json j;
  j["z"] = number_or_null(0.1);
  j["a"] = number_or_null(std::numeric_limits<double>::quiet_NaN());
  j["list"] = numbers({1.5, std::numeric_limits<double>::infinity()});
  j["none"] = number_or_null(std::optional<double>());
  EXPECT_EQ(
      dump(j),
      "{\n  \"z\": 0.1,\n  \"a\": null,\n  \"list\": [\n    1.5,\n    null\n  ],\n  \"none\": null\n}\n");
  EXPECT_EQ(dump(Json("\xB5m")), "\"\xEF\xBF\xBDm\"\n");
}

TEST(Error, OneLineEach) {
  EXPECT_EQ((Problem{"a.toml", 3, "x.y", "got 1"}.text()), "a.toml:3: x.y: got 1");
  EXPECT_EQ((Problem{"a.toml", 0, "", "got\n1"}.text()), "a.toml: got 1");
  EXPECT_EQ((Problem{"", 0, "x", "got 1"}.text()), "x: got 1");
  Problems all("f");
  all.throw_if_any();
  all.add(9, "b", "late");
  all.add(2, "a", "early");
  try {
    all.throw_if_any();
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "f:2: a: early (and 1 more)");
    EXPECT_EQ(e.problems()[1].text(), "f:9: b: late");
  }
}

TEST(Error, NearestKeyAndQuotedValues) {
  const std::vector<std::string_view> keys{"mass", "load", "friction"};
  EXPECT_EQ(nearest("masss", keys), "mass");
  EXPECT_EQ(nearest("frction", keys), "friction");
  EXPECT_EQ(nearest("velocity", keys), "");
  EXPECT_EQ(nearest("", keys), "");
  EXPECT_EQ(in_quotes("a\tb"), "\"a b\"");
  EXPECT_LT(in_quotes(std::string(1000, 'x')).size(), 80u);
}

TEST(Error, NoTerminalIsCommanded) {
  EXPECT_EQ(printable("\u001b[31m\a\x7f"), " [31m  ");
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a b");
  // C1 controls, and marks that turn the direction of writing.
  EXPECT_EQ(printable("a\u009bb\u202ec\u2066d\u200fe\u061cf"), "a b c d e f");
  EXPECT_EQ(printable("\u00b5m \u2026 \u4e2d \U0001f600"), "\u00b5m \u2026 \u4e2d \U0001f600");
  // Bytes that are no UTF-8, cut off or overlong.
  EXPECT_EQ(printable("a\xff\xc0\x80z\xe2\x80"), "a\ufffd\ufffd\ufffdz\ufffd\ufffd");
  EXPECT_EQ((Problem{"f\u202eg", 1, "k\u009b", "m\xff"}.text()), "f g:1: k : m\ufffd");
}

TEST(Printable, LinesAndLengths) {
  EXPECT_EQ(printable_lines("a\nb\rc\u2028d"), "a\nb c d");
  // RFC 3629: overlong forms, surrogates and code points beyond U+10FFFF are no UTF-8.
  EXPECT_EQ(printable("\xED\xA0\x80|\xE0\x80\xAF|\xF4\x90\x80\x80"),
            "\uFFFD\uFFFD\uFFFD|\uFFFD\uFFFD\uFFFD|\uFFFD\uFFFD\uFFFD\uFFFD");
  EXPECT_EQ(shortened("abc", 3), "abc");
  EXPECT_EQ(shortened("abcdefghijkl", 11), "abcdef…kl");
  EXPECT_LE(shortened(std::string(500, 'x'), 100).size(), 100u);
  EXPECT_EQ(one_line("a\nb\\ \\"), "a b");
  EXPECT_EQ(one_line("\\"), "");
  EXPECT_EQ(comment_lines(""), "# \n");
  EXPECT_EQ(comment_lines("a\nb"), "# a b\n");
  EXPECT_EQ(comment_lines(std::string(200, 'x')), "# " + std::string(196, 'x') + "\n# xxxx\n");
  EXPECT_EQ(comment_lines(std::string(195, 'x') + "\\y"), "# " + std::string(195, 'x') + "\\…\n# y\n");
}

TEST(Error, StaysReadableWhateverIsRepeatedInIt) {
  const std::string text =
      Problem{std::string(20000, 'f'), 7, std::string(20000, 'k'), std::string(20000, 'm')}.text();
  EXPECT_LT(text.size(), 2000u);
  EXPECT_NE(text.find("f:7: k"), std::string::npos);
  const std::string many = Problem{"", 0, "",
                                   [] {
                                     std::string s;
                                     for (int i = 0; i < 5000; ++i) s += "\u00b5";
                                     return s;
                                   }()}
                               .text();
  EXPECT_EQ(printable(many), many) << "no character is cut in two";
}

}  // namespace
}  // namespace stribeck::io::json_test
