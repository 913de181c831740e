#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <stribeck/ident/digits.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

/// First `width` code points.
std::string_view head(std::string_view text, std::size_t width) noexcept {
  std::size_t at = 0;
  for (std::size_t n = 0; at < text.size(); ++at) {
    if ((static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U) continue;
    if (n++ == width) break;
  }
  return text.substr(0, at);
}

std::string cut(std::string_view text, std::size_t width) {
  if (text_width(text) <= width) return std::string(text);
  return std::string(head(text, width > 0 ? width - 1 : 0)) + (width > 0 ? "…" : "");
}

}  // namespace

std::string clean_text(std::string_view text, bool keep_newlines) {
  return keep_newlines ? io::printable_lines(text) : io::printable(text);
}

std::size_t text_width(std::string_view text) noexcept {
  std::size_t n = 0;
  for (const char c : text) n += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1 : 0;
  return n;
}

std::string left_aligned(std::string_view text, std::size_t width) {
  std::string out = cut(text, width);
  return out.append(width - text_width(out), ' ');
}

std::string right_aligned(std::string_view text, std::size_t width) {
  const std::string out = cut(text, width);
  return std::string(width - text_width(out), ' ') + out;
}

std::string decimals(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  std::string text = fmt::format("{:.{}f}", value, digits);
  if (text[0] == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string with_sign(double value, int digits) {
  const std::string text = decimals(value, digits);
  const bool positive =
      std::isfinite(value) && value > 0.0 && text.find_first_not_of("0.") != std::string::npos;
  return positive ? '+' + text : text;
}

std::string short_number(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "–"; }

std::string significant(double value, int digits) { return ident::digits(value, digits); }

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  return fmt::format("{}", fmt::join(words, between));
}

std::string printed_unit(std::string_view unit) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  std::string out;
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const char before = i > 0 ? unit[i - 1] : ' ';
    const bool ends = i + 2 >= unit.size() || !letter(unit[i + 2]);
    if (unit[i] == 'u' && unit.substr(i, 2) == "um" && !letter(before) && ends) {
      out += "µ";
    } else if (unit[i] == '2' && letter(before)) {
      out += "²";
    } else if (unit[i] == '3' && letter(before)) {
      out += "³";
    } else {
      out += unit[i];
    }
  }
  return out;
}

std::string listed(const std::vector<std::string>& words) {
  if (words.size() < 2) return joined(words, "");
  return joined({words.begin(), words.end() - 1}, ", ") + " and " + words.back();
}

}  // namespace stribeck::report
