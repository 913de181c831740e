// The decimal mark of a table, and what to say of tables whose numbers cannot be read.
#include <algorithm>
#include <cctype>
#include <stribeck/io/log/log_spreadsheet.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::io::detail {
namespace {

/// The cell of a text around this place.
std::string_view cell_at(std::string_view text, std::size_t at, char separator) {
  const std::string ends{separator, '\n'};
  const auto begin = text.find_last_of(ends, at) + 1;  // npos + 1 is 0
  return trimmed(text.substr(begin, std::min(text.find_first_of(ends, at), text.size()) - begin));
}

/// Whether a cell has a comma that may be a decimal one. "10:15:23,124" may stand beside "0.75", and "moving, fast" is a word.
bool has_comma(std::string_view text, char separator) {
  for (auto at = text.find(','); at != std::string_view::npos; at = text.find(',', at + 1)) {
    const std::string_view cell = cell_at(text, at, separator);
    const auto before = cell.substr(0, cell.find(','));
    const char first = cell.substr(std::min(cell.find_first_not_of("\" "), cell.size() - 1)).front();
    if (before.find(':') == std::string_view::npos && std::isalpha(static_cast<unsigned char>(first)) == 0)
      return true;
  }
  return false;
}

/// Whether a cell is a number with a decimal point; a date has points too.
bool has_number_with_point(std::string_view text, char separator) {
  for (auto at = text.find('.'); at != std::string_view::npos; at = text.find('.', at + 1)) {
    const std::string_view cell = cell_at(text, at, separator);
    if (cell_number(cell, '.')) return true;
  }
  return false;
}

}  // namespace

char decimal_mark(std::string_view body, char separator) {
  if (separator == ',') return '.';
  std::string_view rest = body;
  for (int k = 0; k < 100 && !rest.empty(); ++k) {
    const auto line = take_line(rest);
    if (!is_comment(line) && has_comma(line, separator)) return ',';
  }
  // An axis at rest may have whole zeros only.
  return has_comma(body, separator) && !has_number_with_point(body, separator) ? ',' : '.';
}

const char* why_no_numbers(const std::vector<std::string_view>& row, char separator) {
  // "0.5 mm"
  const bool units = std::any_of(row.begin(), row.end(), [](std::string_view cell) {
    const std::string text = unquoted(trimmed(cell));
    const auto blank = text.find(' ');
    return blank != std::string::npos && looks_like_number(std::string_view(text).substr(0, blank)) &&
           is_unit(trimmed(std::string_view(text).substr(blank)));
  });
  if (units)
    return "has a unit behind each number, expected numbers alone (export the units in the names: \"x [mm]\")";
  const auto number = [&](char decimal) {
    return std::any_of(row.begin(), row.end(),
                       [&](std::string_view cell) { return cell_number(cell, decimal).has_value(); });
  };
  if (separator == ',' && number(',') && !number('.'))
    return "has decimal commas in quotes, and commas between its columns (export it with ; or tabs between the columns, or with decimal points)";
  return std::any_of(row.begin(), row.end(), looks_like_number)
             ? "mixes point and comma in its numbers (export it with one decimal mark and without thousands separators)"
             : "has no column of numbers";
}

}  // namespace stribeck::io::detail
