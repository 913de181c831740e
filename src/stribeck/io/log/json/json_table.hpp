#pragma once
/// Tables that programs write as JSON.
///
///   {"t": 0.0, "x": 1.2}            one object in each line (JSON Lines)
///   [{"t": 0.0, "x": 1.2}, …]       a list of objects
///   {"t": [0.0, …], "x": [1.2, …]}  a list for each column
///
/// An object inside a row gives "name.key", a list inside a row "name_0", "name_1". Of an object that holds one of these, its other texts and
/// numbers are metadata; where it holds several, the longest is the table. The result is the same table as CSV, for one reader of names, units and times.
/// Internal to io. Real time: no. Errors: InputError with the line of a row that is no JSON, or columns of different length.

#include <optional>
#include <string>
#include <string_view>

namespace stribeck::io::detail {

/// Nothing where the text is no such table; a capture of a SINUMERIK is none.
std::optional<std::string> csv_of_json(std::string_view text, const std::string& source);

/// Whether a text that begins with '{' or '[' can be JSON at all: "[SERVO GUIDE]" is the first line of another file.
bool may_be_json(std::string_view text);

}  // namespace stribeck::io::detail
