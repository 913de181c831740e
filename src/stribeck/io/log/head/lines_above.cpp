// Lines above the names of the columns.
#include <algorithm>
#include <cctype>
#include <optional>
#include <stribeck/io/log/log_spreadsheet.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <utility>

namespace stribeck::io::detail {
namespace {

/// Rows that must have the same number of cells before they count as a table; a head of keys and numbers has fewer.
constexpr std::size_t kRowsOfATable = 20;
constexpr std::size_t kLongestHead = 200;

/// A line of a file that is neither blank nor a comment.
struct HeadLine {
  std::size_t number;  ///< lines above it
  std::string_view text;
};

std::vector<HeadLine> first_lines(std::string_view text) {
  std::vector<HeadLine> lines;
  for (std::size_t n = 0; !text.empty() && lines.size() < kLongestHead + kRowsOfATable; ++n) {
    const auto line = take_line(text);
    // A row of separators alone is none of the table, and does not end it.
    if (line.find_first_not_of(" \t;,\"") != std::string_view::npos && !is_comment(line))
      lines.push_back({n, line});
  }
  return lines;
}

/// A row of at least two cells, at least half of them numbers.
bool is_row(std::string_view line, char separator, std::size_t cells) {
  const auto row = split(line, separator);
  if (row.size() < 2 || (cells > 0 && row.size() != cells)) return false;
  const auto numbers = std::count_if(row.begin(), row.end(), [](std::string_view cell) {
    return looks_like_number(cell) || grouped_number(cell, ',').has_value() ||
           grouped_number(cell, '.').has_value();
  });
  return 2 * static_cast<std::size_t>(numbers) >= row.size();
}

/// A name and a number, "P0012;1.5". A time of day and a number are a row of a log.
bool is_key_and_number(std::string_view line, char separator) {
  const auto cells = split(line, separator);
  if (cells.size() != 2) return false;
  const std::string key = unquoted(cells.front());
  return !key.empty() && std::isalpha(static_cast<unsigned char>(key.front())) != 0 &&
         !looks_like_number(key);
}

/// Index of the line with the names of the first table from line `from` on, of at least `least` cells; nothing where there is no table or
/// no names above it. Many lines of a key and a number (parameters of the drive) above a wider table are its head.
std::optional<std::size_t> names_of_table(const std::vector<HeadLine>& lines, char separator,
                                          std::size_t from = 1, std::size_t least = 2) {
  for (std::size_t first = from; first + 2 <= lines.size() && first <= kLongestHead; ++first) {
    const std::size_t cells = split(lines[first].text, separator).size();
    if (cells < least) continue;
    std::size_t end = first;
    while (end < lines.size() && end < first + kRowsOfATable && is_row(lines[end].text, separator, cells))
      ++end;
    // The last line may be cut.
    const bool to_the_end = end + 1 >= lines.size() && lines.size() < kLongestHead + kRowsOfATable;
    if (end < first + 2 || (end < first + kRowsOfATable && !to_the_end)) continue;
    std::size_t keys = first;
    while (keys < lines.size() && is_key_and_number(lines[keys].text, separator)) ++keys;
    if (keys >= end) {
      if (const auto wider = names_of_table(lines, separator, keys + 1, cells + 1)) return wider;
    }
    std::size_t names = first - 1;
    Notes ignored;
    if (names > 0 && !units_in_row(lines[names].text, separator, cells, ignored).empty() &&
        split_exactly(lines[names - 1].text, separator).size() >= cells)
      --names;
    const auto row = split(lines[names].text, separator);
    if (row.size() + 1 < cells || row.size() > cells || is_row(lines[names].text, separator, 0))
      return std::nullopt;
    return names;
  }
  return std::nullopt;
}

/// Lines above the names in a measurement file of LabVIEW, whose head has two parts; 0 for other files. A third part belongs to a second
/// segment.
std::size_t lines_of_labview(std::string_view text) {
  if (!begins_with(text, "LabVIEW Measurement")) return 0;
  constexpr int kParts = 2;
  std::size_t above = 0;
  int parts = 0;
  for (std::size_t n = 1; n <= kLongestHead && !text.empty() && parts < kParts; ++n) {
    if (!begins_with(take_line(text), kEndOfLabViewHead)) continue;
    above = n;
    ++parts;
  }
  return above;
}

/// Cells of a row without the empty ones at its end, with which spreadsheets fill a row up to the width of the table.
std::size_t filled_cells(const std::vector<std::string_view>& row) {
  std::size_t filled = row.size();
  while (filled > 0 && unquoted(trimmed(row[filled - 1])).empty()) --filled;
  return filled;
}

/// 0 where the first line has the names, or where there is no table.
std::size_t lines_of_head(std::string_view text) {
  if (const std::size_t lines = lines_of_labview(text); lines > 0) return lines;
  const std::vector<HeadLine> lines = first_lines(text);
  if (lines.size() < 3) return 0;
  std::size_t most = 0;
  std::size_t above = 0;
  for (const char separator : {'\t', ';', ','}) {
    const auto names = names_of_table(lines, separator);
    if (!names) continue;
    const auto row = split(lines[*names].text, separator);
    const std::size_t cells = row.size();
    if (cells <= most) continue;
    most = cells;
    // As many cells in the first line as in the table: it is no head, but where it is a key and its value.
    const auto first = split(lines.front().text, separator);
    const bool told = first.size() == 2 && !unquoted(first[1]).empty() &&
                      std::isdigit(static_cast<unsigned char>(unquoted(first[1]).front())) != 0 &&
                      !looks_like_number(first[0]);
    const bool filled_up = filled_cells(first) < filled_cells(row);
    above = *names > 0 && (first.size() != cells || filled_up || told) ? lines[*names].number : 0;
  }
  return above;
}

}  // namespace

std::size_t take_head(std::string_view& text, std::vector<std::pair<std::string, std::string>>& metadata) {
  const std::size_t lines = lines_of_head(text);
  for (std::size_t i = 0; i < lines; ++i) {
    std::string_view line = take_line(text);
    line.remove_prefix(std::min(line.find_first_not_of("#% \t"), line.size()));
    const auto mark = line.find_first_of(";,\t:=");
    if (mark == std::string_view::npos) continue;
    std::string key = as_utf8(unquoted(trimmed(line.substr(0, mark))));
    if (!key.empty()) metadata.emplace_back(std::move(key), as_utf8(trimmed(line.substr(mark + 1))));
  }
  return lines;
}

bool names_in_comment(std::string_view comment, std::string_view row) {
  for (const char separator : {'\t', ';', ','}) {
    const auto names = split(comment, separator);
    if (names.size() < 2 || !is_row(row, separator, names.size())) continue;
    return !is_row(comment, separator, 0);
  }
  return false;
}

}  // namespace stribeck::io::detail
