#pragma once
/// Which lines of a table are rows.
/// Internal to io. Real time: no.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::io::detail {

/// Whether a line that begins with `#` is a row of the table and no comment. It has as many cells as the table, and its first cell is
/// the word of a spreadsheet for a cell without a number (`#N/A`, `#DIV/0!`, `####`). In a column of text (`text_first`) the first cell
/// may be any word, as in `#1;0.5;3`; another cell is a number then.
bool is_row_with_hash(std::string_view line, char separator, std::size_t columns, bool text_first);

/// The first row of a text below the names. Where all lines begin with `#`, the first that can be a row; "" where there is none.
std::string_view row_of_table(std::string_view text, char separator, std::size_t columns);

/// For each column its first cell that is not absent; "" where the first thousand rows have none.
std::vector<std::string_view> first_present_cells(std::string_view body, char separator, std::size_t columns);

/// Whether a number of the table tells that this is its decimal mark: 0.5, 12.34, 1234.567. No group of thousands looks so.
bool proves_mark(std::string_view body, char separator, char decimal);

/// A cell of a column in which the decimal mark may as well stand between thousands, so that 1,759 is 1.759 or 1759; nothing for other
/// columns. In such a column each mark has one to three digits before it, which do not begin with 0, and three behind it, and there are
/// whole numbers without a mark, all below 1000. `values` are the numbers of the column as they were read.
std::optional<std::string> maybe_thousands(const std::vector<double>& values, std::string_view body,
                                           char separator, std::size_t column, char decimal);

}  // namespace stribeck::io::detail
