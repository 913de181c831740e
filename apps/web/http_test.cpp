#include <gmock/gmock.h>

#include <apps/web/guard.hpp>
#include <apps/web/http.hpp>
#include <apps/web/json_request.hpp>
#include <apps/web/what_if.hpp>

namespace stribeck::web::http_test {
namespace {

using testing::HasSubstr;

TEST(Http, PercentEncoding) {
  EXPECT_EQ(percent_decoded("a%20b%2Fc"), "a b/c");
  EXPECT_EQ(percent_decoded("%C3%A4"), "\xC3\xA4");
  for (const char* broken : {"%", "%2", "%zz", "a%0", "%00", "%0a", "a\nb"})
    EXPECT_FALSE(percent_decoded(broken)) << broken;
}

TEST(Http, Query) {
  EXPECT_EQ(path_of("/a/b?c=d"), "/a/b");
  EXPECT_EQ(query_value("/a?x=1&name=my%20log.csv", "name"), "my log.csv");
  EXPECT_EQ(query_value("/a?name=", "name"), "");
  for (const char* none : {"/a", "/a?", "/a?name", "/a?names=1", "/a?x=name=1", "/a?&&"})
    EXPECT_FALSE(query_value(none, "name")) << none;
}

Request asked(std::string method, std::string host) {
  Request r;
  r.method = std::move(method);
  r.target = "/";
  r.host = std::move(host);
  return r;
}

TEST(Guard, OnlyNamesOfThisComputer) {
  const Guard guard("");
  for (const char* host : {"127.0.0.1:80", "127.0.0.2", "localhost:8080", "localhost", "[::1]:80"})
    EXPECT_FALSE(guard.check(asked("GET", host))) << host;
  for (const char* host : {"", "evil.example", "127.0.0.1.evil.example", "127.evil.example:80",
                           "localhost.evil.example:80", "[::2]"})
    EXPECT_EQ(guard.check(asked("GET", host)).value_or(Response{}).status, 403) << host;
}

TEST(Guard, PostsComeFromThisSite) {
  const Guard guard("");
  Request r = asked("POST", "127.0.0.1:80");
  EXPECT_FALSE(guard.check(r));  // no browser
  r.origin = "http://127.0.0.1:80";
  EXPECT_FALSE(guard.check(r));
  for (const char* origin : {"http://127.0.0.1:81", "null", "http://evil.example"}) {
    r.origin = origin;
    EXPECT_EQ(guard.check(r).value_or(Response{}).status, 403) << origin;
  }
}

TEST(Guard, Token) {
  const Guard guard("0123456789abcdef");
  Request r = asked("GET", "machine.example:80");
  const auto status = [&] { return guard.check(r).value_or(Response{}).status; };
  EXPECT_EQ(status(), 401);
  for (const char* cookie :
       {"stribeck-80=", "stribeck-80=0123456789abcde", "stribeck-80=0123456789abcdef0",
        "xstribeck-80=0123456789abcdef", "stribeck-81=0123456789abcdef", "stribeck=0123456789abcdef"}) {
    r.cookie = cookie;
    EXPECT_EQ(status(), 401) << cookie;
  }
  r.cookie = "a=b; stribeck-80=0123456789abcdef";
  EXPECT_FALSE(guard.check(r));
  r.cookie.clear();
  r.authorization = "Bearer 0123456789abcdef";
  EXPECT_FALSE(guard.check(r));
  r.authorization.clear();
  r.target = "//evil.example/?token=0123456789abcdef";
  const auto moved = guard.check(r);
  ASSERT_TRUE(moved);
  EXPECT_EQ(moved->status, 303);
  EXPECT_EQ(moved->headers.front().second, "/");  // and to no other site
  r.method = "POST";
  EXPECT_EQ(status(), 401);
}

TEST(Guard, TokensThatCanBeGuessed) {
  EXPECT_EQ(Guard::problem("0123456789abcdef"), "");
  for (const char* bad : {"", "0123456789abcde", "0123456789abcde;", "0123456789 abcdef"})
    EXPECT_NE(Guard::problem(bad), "") << bad;
}

std::string refusal(std::string_view text) {
  try {
    read_request<WhatIfRequest>(text);
    return {};
  } catch (const io::InputError& e) {
    return e.what();
  }
}

TEST(JsonRequest, IsReadAsAFileIs) {
  const auto r = read_request<WhatIfRequest>(
      R"({"machine":"m","controllers":["a","f"],"seed":7,"changes":[{"key":"x.mass","scale":1.5}],"identify_changed":true})");
  EXPECT_EQ(r.machine, "m");
  EXPECT_EQ(r.controllers.size(), 2U);
  EXPECT_EQ(r.seed, 7U);
  EXPECT_EQ(r.changes.front().scale, 1.5);
  EXPECT_TRUE(r.identify_changed);
}

TEST(JsonRequest, Refusals) {
  EXPECT_THAT(refusal("{"), HasSubstr("no JSON"));
  EXPECT_THAT(refusal("[1]"), HasSubstr("object"));
  EXPECT_THAT(refusal(R"({"controllers":["a"]})"), HasSubstr("machine"));
  EXPECT_THAT(refusal(R"({"machine":"m","controllers":["a"],"sped":"1 mm/s"})"),
              HasSubstr("meant \"speed\"?"));
  EXPECT_THAT(refusal(R"({"machine":1,"controllers":["a"]})"), HasSubstr("machine"));
  EXPECT_THAT(refusal(R"({"machine":null,"controllers":["a"]})"), HasSubstr("null"));
  EXPECT_THAT(refusal(R"({"machine":"m","controllers":[]})"), HasSubstr("controllers"));
  EXPECT_THAT(refusal(R"({"machine":"m","controllers":["a"],"seed":-1})"), HasSubstr("seed"));
  EXPECT_THAT(refusal(R"({"machine":"m","controllers":["a"],"seed":18446744073709551615})"),
              HasSubstr("seed"));
  EXPECT_THAT(refusal(R"({"machine":"m","controllers":["a"],"changes":[{"key":"x.mass"}]})"),
              HasSubstr("scale and value"));
  EXPECT_THAT(refusal(R"({"machine":"m","controllers":["a"],"changes":[{"key":"x.mass","scale":1e9}]})"),
              HasSubstr("scale"));
  EXPECT_THAT(refusal(std::string(3000, '[') + std::string(3000, ']')), HasSubstr("nested"));
}

}  // namespace
}  // namespace stribeck::web::http_test
