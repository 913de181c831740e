#pragma once
/// Numbers from texts, whatever the locale of the program: a library also lives in programs that write a decimal comma.
/// Real time: no.

#include <charconv>
#include <cstddef>
#include <stribeck/core/numbers.hpp>
#include <string_view>

namespace stribeck {

struct NumberAt {
  double value = kNaN;
  std::size_t length = 0;  ///< characters that were read, with the blanks before the number; 0: there is none
};

/// The number with which a text begins, after blanks and a plus sign.
inline NumberAt number_at(std::string_view text) noexcept {
  std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return {};
  if (text[begin] == '+') ++begin;
  NumberAt out;
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data() + begin, text.data() + text.size(), value);
  if (error != std::errc()) return {};
  out.value = value;
  out.length = static_cast<std::size_t>(end - text.data());
  return out;
}

/// The same without its length; NaN: there is none.
inline double number_in(std::string_view text) noexcept { return number_at(text).value; }

}  // namespace stribeck
