#pragma once
/// Who may ask. A browser sends requests to this computer for any page that it shows, so an address alone proves nothing:
///
///   Host      without a token only names of this computer: a foreign name that leads here is somebody else's page
///   Origin    a request that changes or computes something comes from a page of this site
///   token     where one is set, every request brings it: `Authorization: Bearer TOKEN`, a cookie, or once `?token=TOKEN`, which sets
///             the cookie
///
/// Real time: no.

#include <apps/web/http.hpp>
#include <string>
#include <string_view>

namespace stribeck::web {

class Guard {
 public:
  /// An empty token: none is asked for.
  explicit Guard(std::string token) : token_(std::move(token)) {}

  /// An answer for those who may not ask, or who brought the token in the address; absent: go on.
  [[nodiscard]] std::optional<Response> check(const Request& request) const;

  static constexpr std::size_t kShortest = 16;
  /// What is wrong with a token; empty: nothing.
  static std::string_view problem(std::string_view token);

 private:
  [[nodiscard]] bool is_token(std::string_view given) const;

  std::string token_;
};

}  // namespace stribeck::web
