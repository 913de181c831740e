#pragma once
/// Text for pages, drawings and terminals: valid UTF-8 without control characters, numbers
/// rounded for reading.
/// Real time: no.

#include <string>
#include <string_view>
#include <vector>

namespace stribeck::report {

/// io::printable(), or with `keep_newlines` io::printable_lines().
std::string clean_text(std::string_view text, bool keep_newlines = false);

/// Number of code points, which is the number of columns in a terminal for the letters used here.
std::size_t text_width(std::string_view text) noexcept;

/// Padded with blanks on the left or on the right; longer text is cut and ends in an ellipsis.
std::string left_aligned(std::string_view text, std::size_t width);
std::string right_aligned(std::string_view text, std::size_t width);

/// With this many decimals; "–" where the value is not finite, never "-0.0".
std::string decimals(double value, int digits);
/// Decimals of an error in micrometres: machines with nanometre encoders leave errors that two would show as 0.00.
inline int decimals_of_micrometres(double metres) { return metres > 0.0 && metres < 0.05e-6 ? 4 : 2; }
/// A length [m] in micrometres, without the unit.
inline std::string micrometres(double metres) {
  return decimals(metres * 1e6, decimals_of_micrometres(metres));
}

/// The same with its sign, "+" too; "0" has none.
std::string with_sign(double value, int digits);

/// A number that a user chose, with the digits that it needs, at most six: 9.5, 3, 0.475.
std::string short_number(double value);

/// With about this many significant digits, and without an exponent where that is readable: 57.65, 1255,
/// 0.00042.
std::string significant(double value, int digits);

/// A unit of fields() as it is printed: "um" → "µm", "N s2/mm" → "N s²/mm".
std::string printed_unit(std::string_view unit);

/// "a", "a and b", "a, b and c".
std::string listed(const std::vector<std::string>& words);
std::string joined(const std::vector<std::string>& words, std::string_view between);

}  // namespace stribeck::report
