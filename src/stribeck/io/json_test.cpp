#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/json.hpp>

namespace stribeck::io {
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

}  // namespace
}  // namespace stribeck::io
