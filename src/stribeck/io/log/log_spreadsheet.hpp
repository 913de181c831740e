#pragma once
/// What spreadsheets and drive tools put into CSV beside numbers: the separator in a line of its own, units in the
/// row below the names, times of day.
/// Internal to io. Real time: no.

#include <optional>
#include <stribeck/io/log/log.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::io::detail {

/// The separator that a first line `sep=;` tells, as Excel writes it; the text moves behind it.
std::optional<char> take_separator_line(std::string_view& text);

/// First line of the text that is neither blank nor comment.
std::string_view first_row(std::string_view text);

/// The separator under which header and first row have the same number of cells; else one that both contain.
char best_separator(std::string_view header, std::string_view row);

/// Whether all cells are numbers, whatever separates them.
bool is_data(std::string_view line);

/// Units in the row below the names, one for each column, "" where it has none; nothing where the row is another one.
std::vector<std::string> units_in_row(std::string_view row, char separator, std::size_t columns,
                                      Notes& notes);

/// What to say of a table whose cells are all text; `row` is one of its rows.
const char* why_no_numbers(const std::vector<std::string_view>& row);

/// Seconds since midnight of `07:15:23.123`, also with a date before and a zone behind, which are not looked at.
std::optional<double> time_of_day(std::string_view text);

/// Makes a column of times of day one of seconds since its first row; false where a cell is none. Past midnight it goes on.
bool read_times_of_day(Column& column);

}  // namespace stribeck::io::detail
