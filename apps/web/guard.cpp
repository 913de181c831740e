#include <algorithm>

#include <apps/web/guard.hpp>

namespace stribeck::web {
namespace {

/// A host without its port.
std::string_view name_of(std::string_view host) {
  if (host.starts_with('[')) return host.substr(0, host.find(']') + 1);
  return host.substr(0, host.find(':'));
}

bool is_this_computer(std::string_view host) {
  const std::string_view name = name_of(host);
  // Every address of 127.0.0.0/8; a name that only begins so has other letters.
  const bool loopback =
      name.starts_with("127.") && name.find_first_not_of("0123456789.") == std::string_view::npos;
  return loopback || name == "localhost" || name == "[::1]";
}

/// Browsers keep one set of cookies for all ports of a host: each dashboard has its own name.
std::string cookie_name(std::string_view host) {
  std::string_view port = host.substr(name_of(host).size());
  port.remove_prefix(std::min(port.size(), std::size_t{1}));
  const bool is_number = !port.empty() && port.find_first_not_of("0123456789") == std::string_view::npos;
  return "stribeck" + (is_number ? '-' + std::string(port) : std::string()) + "=";
}

std::string_view cookie_of(std::string_view cookies, std::string_view name) {
  while (!cookies.empty()) {
    const std::size_t end = std::min(cookies.find(';'), cookies.size());
    std::string_view one = cookies.substr(0, end);
    cookies.remove_prefix(std::min(end + 1, cookies.size()));
    one.remove_prefix(std::min(one.find_first_not_of(' '), one.size()));
    if (one.starts_with(name)) return one.substr(name.size());
  }
  return {};
}

}  // namespace

std::string_view Guard::problem(std::string_view token) {
  constexpr std::string_view kPermitted = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
  if (token.size() < kShortest || token.size() > 200)
    return "expected 16 to 200 characters, e.g. what `openssl rand -hex 16` prints";
  if (token.find_first_not_of(kPermitted) != std::string_view::npos)
    return "expected letters, digits, - and _ only";
  return {};
}

bool Guard::is_token(std::string_view given) const {
  // As long for every wrong one, so that the time tells nothing.
  unsigned difference = given.size() == token_.size() ? 0 : 1;
  for (std::size_t i = 0; i < token_.size(); ++i) {
    const char c = i < given.size() ? given[i] : '\0';
    difference |= static_cast<unsigned char>(c ^ token_[i]);
  }
  return difference == 0;
}

std::optional<Response> Guard::check(const Request& r) const {
  if (r.method != "GET" && r.method != "POST")
    return Response{405, "text/plain; charset=utf-8", "GET and POST only\n", {{"Allow", "GET, POST"}}};
  if (token_.empty() && !is_this_computer(r.host))
    return error_response(
        403, "this address is not one of this computer (use the one that stribeck serve printed)");
  const bool foreign = !r.origin.empty() && r.origin != "http://" + r.host && r.origin != "https://" + r.host;
  if (r.method == "POST" && foreign) return error_response(403, "the request comes from another site");
  if (token_.empty()) return {};
  constexpr std::string_view kBearer = "Bearer ";
  if (r.authorization.starts_with(kBearer) &&
      is_token(std::string_view(r.authorization).substr(kBearer.size())))
    return {};
  if (is_token(cookie_of(r.cookie, cookie_name(r.host)))) return {};
  if (const auto given = query_value(r.target, "token"); r.method == "GET" && given && is_token(*given)) {
    // Out of the address line, the history and what a page could see.
    return Response{303,
                    "text/plain; charset=utf-8",
                    "",
                    {{"Location", "/"},
                     {"Set-Cookie", cookie_name(r.host) + token_ + "; HttpOnly; SameSite=Strict; Path=/"}}};
  }
  return error_response(401,
                        "the token is missing or wrong (open the whole address that stribeck serve printed)");
}

}  // namespace stribeck::web
