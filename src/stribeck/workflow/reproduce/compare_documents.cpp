#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <stribeck/core/number_text.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/workflow/reproduce/compare_documents.hpp>

namespace stribeck::workflow {
namespace {

/// Splits a text into words and numbers.
struct Token {
  std::string text;
  double value = std::nan("");
};
std::vector<Token> tokens(const std::string& text) {
  std::vector<Token> all;
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i;
    if (digit(text[i])) {
      while (end < text.size() && (digit(text[end]) || text[end] == '.')) ++end;
      all.push_back({text.substr(i, end - i), number_in(std::string_view(text).substr(i))});
    } else {
      while (end < text.size() && !digit(text[end])) ++end;
      all.push_back({text.substr(i, end - i)});
    }
    i = end;
  }
  return all;
}

/// Whether two cells of measured numbers differ no more than rounding of another processor explains. A loop that switches by sign
/// carries the last bit of a sine into the third digit of a figure, so numbers may differ by some per cent. Near zero the sign may
/// change.
bool alike(const std::string& expected, const std::string& got) {
  constexpr double kRelative = 0.06;
  constexpr double kDecimals = 1.6;  // units of the last decimal
  const auto a = tokens(expected);
  const auto b = tokens(got);
  if (a.size() != b.size()) return false;
  bool may_change_sign = false;
  for (std::size_t i = a.size(); i-- > 0;) {
    if (!std::isfinite(a[i].value) || !std::isfinite(b[i].value)) {
      const auto without_sign = [](std::string t) {
        if (!t.empty() && t.back() == '-') t.pop_back();
        return t;
      };
      const bool same =
          a[i].text == b[i].text || (may_change_sign && without_sign(a[i].text) == without_sign(b[i].text));
      if (!same) return false;
      continue;
    }
    const auto point = a[i].text.find('.');
    const double unit =
        point == std::string::npos ? 1.0 : std::pow(10.0, -static_cast<double>(a[i].text.size() - point - 1));
    const double decimals = point == std::string::npos ? 0.0 : kDecimals * unit;
    if (std::abs(a[i].value - b[i].value) > std::max(kRelative * std::abs(a[i].value), decimals))
      return false;
    may_change_sign = std::abs(a[i].value) <= decimals && std::abs(b[i].value) <= decimals;
  }
  return true;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == at) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

}  // namespace

std::string first_difference(const std::string& expected, const std::string& got) {
  const auto a = split(expected, '\n');
  const auto b = split(got, '\n');
  bool printed = false;  // a table of printed figures: the fourth and fifth cells are computed
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const std::string line = i < a.size() ? a[i] : std::string();
    const std::string other = i < b.size() ? b[i] : std::string();
    if (line == other && i < a.size() && i < b.size()) {
      if (line.rfind("| figure |", 0) == 0) printed = true;
      if (line.empty()) printed = false;
      continue;
    }
    const auto x = split(line, '|');
    const auto y = split(other, '|');
    bool same = x.size() == y.size() && i < a.size() && i < b.size();
    for (std::size_t k = 0; same && k < x.size(); ++k) {
      const bool ours = x.size() == 1 ? line.rfind("- Cutting force", 0) == 0
                        : printed     ? k == 4 || k == 5
                                      : k > 1;
      same = x[k] == y[k] || (ours && alike(x[k], y[k]));
    }
    if (!same)
      return fmt::format("{}: expected {}, got {}", i + 1, io::in_quotes(line.substr(0, 120)),
                         io::in_quotes(other.substr(0, 120)));
  }
  return {};
}

}  // namespace stribeck::workflow
