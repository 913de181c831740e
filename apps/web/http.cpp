#include <nlohmann/json.hpp>

#include <apps/web/http.hpp>
#include <stribeck/io/printable.hpp>

namespace stribeck::web {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

std::optional<std::string> percent_decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '%') {
      const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
      const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
      if (high < 0 || low < 0) return {};
      c = static_cast<char>(16 * high + low);
      i += 2;
    }
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return {};
    out += c;
  }
  return out;
}

std::string_view path_of(std::string_view target) { return target.substr(0, target.find('?')); }

std::optional<std::string> query_value(std::string_view target, std::string_view name) {
  const std::size_t mark = target.find('?');
  std::string_view rest = mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1);
  while (!rest.empty()) {
    const std::string_view one = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(one.size() + 1, rest.size()));
    if (one.substr(0, one.find('=')) != name || one.size() <= name.size()) continue;
    return percent_decoded(one.substr(name.size() + 1));
  }
  return {};
}

Response error_response(int status, std::string_view message) {
  nlohmann::ordered_json json;
  json["error"] = io::printable(message);
  return json_response(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace), status);
}

Response json_response(std::string body, int status) {
  return {status, "application/json", std::move(body), {}};
}

}  // namespace stribeck::web
