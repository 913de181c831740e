#include <algorithm>
#include <cmath>
#include <stribeck/io/log/head/table_rows.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <string>

namespace stribeck::io::detail {
namespace {

/// "#N/A", "#NV", "#DIV/0!", "#NAME?", or "####" where a column of a spreadsheet is too narrow for its number.
bool is_spreadsheet_word(std::string_view cell) {
  const std::string word = unquoted(trimmed(cell));
  if (word.size() < 2 || word.front() != '#') return false;
  if (is_absent(word) || word.find_first_not_of('#') == std::string::npos) return true;
  const bool capitals = word.find_first_not_of("#ABCDEFGHIJKLMNOPQRSTUVWXYZ0/!?") == std::string::npos;
  return capitals && (word.back() == '!' || word.back() == '?');
}

std::string_view first_line_that(std::string_view text, std::size_t columns, char separator,
                                 bool text_first) {
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    if (trimmed(line).empty()) continue;
    if (!is_comment(line) || is_row_with_hash(line, separator, columns, text_first)) return line;
  }
  return {};
}

}  // namespace

bool is_row_with_hash(std::string_view line, char separator, std::size_t columns, bool text_first) {
  if (columns < 2 || line.empty() || line.front() != '#') return false;
  const auto cells = split(line, separator);
  const std::size_t blank_last = separator != ' ' && line.ends_with(separator) ? 1 : 0;
  if (cells.size() != columns && cells.size() + blank_last != columns) return false;
  if (is_spreadsheet_word(cells.front())) return true;
  return text_first && separator != ' ' &&
         std::any_of(cells.begin() + 1, cells.end(), [](std::string_view c) { return looks_like_number(c); });
}

std::string_view row_of_table(std::string_view text, char separator, std::size_t columns) {
  const std::string_view row = first_line_that(text, columns, separator, false);
  return row.empty() ? first_line_that(text, columns, separator, true) : row;
}

std::vector<std::string_view> first_present_cells(std::string_view body, char separator,
                                                  std::size_t columns) {
  constexpr int kRows = 1000;
  std::vector<std::string_view> present(columns);
  std::vector<char> found(columns, 0);
  std::size_t open = columns;
  for (int row = 0; row < kRows && open > 0; ++row) {
    const std::string_view line = row_of_table(body, separator, columns);
    if (line.empty()) break;
    body.remove_prefix(static_cast<std::size_t>(line.data() + line.size() - body.data()));
    const auto cells = split(line, separator);
    for (std::size_t c = 0; c < std::min(columns, cells.size()); ++c) {
      if (found[c] != 0 || is_absent(cells[c])) continue;
      present[c] = cells[c];
      found[c] = 1;
      --open;
    }
  }
  return present;
}

namespace {

/// Whether numbers may be the thousandths of whole ones of up to six digits; those below 1 begin with "0.", which no group does.
bool may_be_thousandths(const std::vector<double>& values) {
  bool any = false;
  for (const double x : values) {
    const double size = std::abs(x);
    if (std::isnan(x) || x == 0.0) continue;
    const double whole = 1000.0 * size;
    if (size < 1.0 || size >= 1000.0 || std::abs(whole - std::round(whole)) > 1e-6) return false;
    any = any || size != std::floor(size);
  }
  return any;
}

bool is_digits(std::string_view text, std::size_t most) {
  return !text.empty() && text.size() <= most &&
         text.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

bool proves_mark(std::string_view body, char separator, char decimal) {
  while (!body.empty()) {
    const std::string_view line = take_line(body);
    if (is_comment(line)) continue;
    for (const std::string_view cell : split(line, separator)) {
      const std::string text = unquoted(trimmed(cell));
      std::string_view digits = text;
      if (digits.starts_with('-') || digits.starts_with('+')) digits.remove_prefix(1);
      const auto mark = digits.find(decimal);
      if (mark == std::string_view::npos) continue;
      const std::string_view before = digits.substr(0, mark), behind = digits.substr(mark + 1);
      constexpr std::size_t kAny = 20;
      if (!is_digits(before, kAny) || !is_digits(behind, kAny)) continue;
      if (before.front() == '0' || before.size() > 3 || behind.size() != 3) return true;
    }
  }
  return false;
}

std::optional<std::string> maybe_thousands(const std::vector<double>& values, std::string_view body,
                                           char separator, std::size_t column, char decimal) {
  if ((separator != ';' && separator != '\t') || !may_be_thousandths(values)) return std::nullopt;
  bool whole = false;
  std::optional<std::string> marked;
  while (!body.empty()) {
    const std::string_view line = take_line(body);
    if (is_comment(line)) continue;
    const auto cells = split(line, separator);
    if (column >= cells.size()) continue;
    const std::string cell = unquoted(trimmed(cells[column]));
    std::string_view digits = cell;
    if (digits.starts_with('-') || digits.starts_with('+')) digits.remove_prefix(1);
    const auto mark = digits.find(decimal);
    if (mark == std::string_view::npos) {
      whole = whole || is_digits(digits, 3);
      continue;
    }
    if (!is_digits(digits.substr(0, mark), 3) || digits.front() == '0' || digits.size() != mark + 4 ||
        !is_digits(digits.substr(mark + 1), 3))
      return std::nullopt;
    if (!marked) marked = cell;
  }
  return whole ? marked : std::nullopt;
}

}  // namespace stribeck::io::detail
