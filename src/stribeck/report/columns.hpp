#pragma once
/// Columns of text for a terminal.
/// Real time: no.

#include <algorithm>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

/// Length of the longest id of a controller: other text refers to it, so it is not cut.
inline constexpr std::size_t kLongestId = 16;

/// A column with its heads; it is wide enough for its longest entry.
struct TextColumn {
  std::string head;
  std::string unit;
  std::vector<std::string> entries;
  bool number = true;
  std::string group = {};  ///< above the head
  std::size_t most = kTableWidth;
  std::size_t least = 7;  ///< smallest width of a column of text where the table is too wide

  [[nodiscard]] std::size_t width() const {
    std::size_t w = std::max({text_width(group), text_width(head), text_width(unit)});
    for (const std::string& e : entries) w = std::max(w, text_width(e));
    return std::min(w, most);
  }
};

/// Heads and rows of all columns; if the table is wider than a terminal, text columns are shortened.
std::string lay_out(std::vector<TextColumn> columns);

}  // namespace stribeck::report
