#include <algorithm>
#include <array>
#include <cctype>
#include <stribeck/io/log/log_spreadsheet.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::io::detail {
namespace {

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// Takes one or two digits below `limit`; nothing where there are none.
std::optional<int> take_two(std::string_view& text, int limit) {
  std::size_t n = 0;
  int value = 0;
  while (n < 2 && n < text.size() && is_digit(text[n])) value = 10 * value + (text[n++] - '0');
  if (n == 0 || value >= limit) return std::nullopt;
  text.remove_prefix(n);
  return value;
}

bool take(std::string_view& text, char c) {
  if (text.empty() || text.front() != c) return false;
  text.remove_prefix(1);
  return true;
}

/// `Z`, `+01:00`, `+0100`; empty too.
bool is_zone(std::string_view text) {
  if (text.empty() || text == "Z" || text == "z") return true;
  if (text[0] != '+' && text[0] != '-') return false;
  text.remove_prefix(1);
  return text.size() >= 2 && text.size() <= 5 &&
         std::all_of(text.begin(), text.end(), [](char c) { return is_digit(c) || c == ':'; });
}

/// A date in digits with `-`, `.` or `/` between.
bool is_date(std::string_view text) {
  if (text.empty()) return true;
  int marks = 0;
  for (const char c : text) {
    if (is_digit(c)) continue;
    if (c != '-' && c != '.' && c != '/') return false;
    ++marks;
  }
  return marks == 2 && is_digit(text.front());
}

/// The text of a cell without brackets around it.
std::string bare_unit(std::string_view cell) {
  std::string text = unquoted(trimmed(cell));
  if (text.size() >= 2 &&
      ((text.front() == '[' && text.back() == ']') || (text.front() == '(' && text.back() == ')')))
    text = std::string(trimmed(std::string_view(text).substr(1, text.size() - 2)));
  return text;
}

}  // namespace

std::optional<char> take_separator_line(std::string_view& text) {
  std::string_view rest = text;
  const std::string line = unquoted(trimmed(take_line(rest)));
  std::string_view after = line;
  if (!begins_with(line, "sep=")) return std::nullopt;
  after.remove_prefix(4);
  // A tab is lost where the line was trimmed.
  const char separator = after.empty() ? '\t' : after.front();
  if (after.size() > 1 || (separator != '\t' && separator != ';' && separator != ',')) return std::nullopt;
  text = rest;
  return separator;
}

std::string_view first_row(std::string_view text) {
  while (!text.empty()) {
    const auto line = take_line(text);
    if (!trimmed(line).empty() && !is_comment(line)) return line;
  }
  return {};
}

char best_separator(std::string_view header, std::string_view row) {
  constexpr std::array kSeparators{'\t', ';', ',', ' '};
  for (const char s : kSeparators) {
    const auto n = split(header, s).size();
    if (n > 1 && n == split(row, s).size()) return s;
  }
  for (const char s : kSeparators) {
    if (split(header, s).size() > 1 && split(row, s).size() > 1) return s;
  }
  for (const char s : {'\t', ';', ','}) {
    if (split(header, s).size() > 1) return s;
  }
  return ',';
}

bool is_data(std::string_view line) {
  for (const char separator : {'\t', ';', ',', ' '}) {
    const auto cells = split(line, separator);
    if (std::all_of(cells.begin(), cells.end(), looks_like_number)) return true;
  }
  return false;
}

std::vector<std::string> units_in_row(std::string_view row, char separator, std::size_t columns,
                                      Notes& notes) {
  std::vector<std::string_view> cells =
      separator == ' ' ? split(row, separator) : split_exactly(row, separator);
  while (cells.size() > columns && cells.back().empty()) cells.pop_back();
  if (cells.size() != columns) return {};
  std::vector<std::string> units;
  Notes said;
  std::size_t known = 0;
  for (const std::string_view cell : cells) {
    if (looks_like_number(cell) || time_of_day(unquoted(cell))) return {};
    const std::string text = bare_unit(cell);
    units.push_back(plain_unit(text, text, said));
    if (!units.back().empty()) ++known;
  }
  // Words alone are a run or a state, not units.
  if (2 * known < columns || known == 0) return {};
  notes.insert(notes.end(), said.begin(), said.end());
  return units;
}

const char* why_no_numbers(const std::vector<std::string_view>& row) {
  return std::any_of(row.begin(), row.end(), looks_like_number)
             ? "mixes point and comma in its numbers (export it with one decimal mark and without thousands separators)"
             : "has no column of numbers";
}

std::optional<double> time_of_day(std::string_view text) {
  text = trimmed(text);
  const auto date_end = text.find_first_of("T ");
  if (date_end != std::string_view::npos && text.find(':') > date_end) {
    if (!is_date(text.substr(0, date_end))) return std::nullopt;
    text = trimmed(text.substr(date_end + 1));
  }
  const auto hour = take_two(text, 24);
  if (!hour || !take(text, ':')) return std::nullopt;
  const auto minute = take_two(text, 60);
  if (!minute || !take(text, ':')) return std::nullopt;
  const auto second = take_two(text, 61);
  if (!second) return std::nullopt;
  double part = 0.0;
  if (take(text, '.') || take(text, ',') || take(text, ':')) {
    // Digits as a whole number and one division: 0.123 is then the double nearest to it.
    double scale = 1.0;
    while (!text.empty() && is_digit(text.front())) {
      if (scale < 1e12) {
        part = 10.0 * part + (text.front() - '0');
        scale *= 10.0;
      }
      text.remove_prefix(1);
    }
    part /= scale;
  }
  text = trimmed(text);
  int half = 0;
  if (begins_with(text, "pm") && text.size() == 2) half = *hour % 12 + 12;
  if (begins_with(text, "am") && text.size() == 2) half = *hour % 12;
  const bool twelve = text.size() == 2 && (begins_with(text, "pm") || begins_with(text, "am"));
  if (!twelve && !is_zone(text)) return std::nullopt;
  return 3600.0 * (twelve ? half : *hour) + 60.0 * *minute + *second + part;
}

bool read_times_of_day(Column& column) {
  constexpr double kDay = 86400.0;
  std::vector<double> values;
  values.reserve(column.texts.size());
  double days = 0.0;
  double last = 0.0;
  for (const std::string& text : column.texts) {
    const auto t = time_of_day(text);
    if (!t) return false;
    if (!values.empty() && *t < last - 0.5 * kDay) days += kDay;
    last = *t;
    values.push_back(*t + days);
  }
  if (values.empty()) return false;
  const double first = values.front();
  for (double& t : values) t -= first;
  column.values = std::move(values);
  column.texts.clear();
  column.unit_text = "s";
  column.unit_assumed = false;
  return true;
}

}  // namespace stribeck::io::detail
