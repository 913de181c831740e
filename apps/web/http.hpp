#pragma once
/// A request and its answer, without the library that carries them: what the site is asked and what it says.
/// Real time: no.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::web {

struct Request {
  std::string method;
  std::string target;  ///< as sent: path and query, percent-encoded
  std::string host;
  std::string origin;
  std::string authorization;
  std::string cookie;
  std::string body;
};

struct Response {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers = {};  ///< further ones
  /// Of an answer without an end, in place of the body: its next piece, asked for again when the last one has been taken and a moment
  /// has passed; empty: nothing yet; absent: the end. Called on the carrying thread; must not take long.
  std::function<std::optional<std::string>()> next = {};
};

/// To be called once, from any thread.
using Reply = std::function<void(Response)>;

/// What the head of a request is allowed: a body of so many bytes, or an answer at once.
struct Admission {
  std::uint64_t body_limit = 0;
  std::optional<Response> refused;
};

/// A text without its percent encoding; absent where that is broken or holds a control character.
std::optional<std::string> percent_decoded(std::string_view text);

/// Path of a target, before its query.
std::string_view path_of(std::string_view target);

/// A value of the query of a target, decoded; absent where there is none or it is broken.
std::optional<std::string> query_value(std::string_view target, std::string_view name);

/// {"error": message}
Response error_response(int status, std::string_view message);

Response json_response(std::string body, int status = 200);

}  // namespace stribeck::web
