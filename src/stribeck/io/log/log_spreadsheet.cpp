#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/io/log/head/table_rows.hpp>
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

std::vector<char> blank_columns(std::string_view body, char separator, std::size_t columns) {
  std::vector<char> blank(columns, 1);
  for (int row = 0; row < 100; ++row) {
    const std::string_view line = row_of_table(body, separator, columns);
    if (line.empty()) break;
    body.remove_prefix(static_cast<std::size_t>(line.data() + line.size() - body.data()));
    const auto cells = split(line, separator);
    for (std::size_t c = 0; c < std::min(columns, cells.size()); ++c) {
      if (!unquoted(cells[c]).empty()) blank[c] = 0;
    }
  }
  return blank;
}

std::string_view take_unended_row(std::string_view& body) {
  const auto end = body.find_last_of('\n');
  const auto row = body.substr(end == std::string_view::npos ? 0 : end + 1);
  if (trimmed(row).empty() || is_comment(row)) return {};
  body.remove_suffix(row.size());
  return row;
}

std::optional<double> grouped_number(std::string_view cell, char decimal) {
  std::string text = unquoted(trimmed(cell));
  for (const std::string_view blank : {"\u00A0", "\u202F"}) {
    for (auto at = text.find(blank); at != std::string::npos; at = text.find(blank, at))
      text.replace(at, blank.size(), " ");
  }
  const auto mark = std::min(text.find(decimal), text.size());
  const std::string_view separators = mark == text.size() ? "' " : decimal == ',' ? ".' " : ",' ";
  std::string digits;
  std::size_t group = 0;
  char separator = '\0';
  for (std::size_t i = text[0] == '-' || text[0] == '+' ? 1 : 0; i < mark; ++i) {
    if (is_digit(text[i])) {
      ++group;
      digits += text[i];
      if (group > 3) return std::nullopt;
      continue;
    }
    const bool first = separator == '\0' && separators.find(text[i]) != std::string_view::npos;
    if ((!first && text[i] != separator) || group == 0 || (!first && group != 3)) return std::nullopt;
    separator = text[i];
    group = 0;
  }
  if (separator == '\0' || group != 3) return std::nullopt;
  return cell_number((text[0] == '-' ? "-" : "") + digits + text.substr(mark), decimal);
}

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

bool is_row_of_types(std::string_view row, char separator) {
  constexpr std::array<std::string_view, 36> kTypes{
      "lreal",  "real",   "int",     "dint",    "udint", "sint",  "usint", "uint",   "lint",
      "ulint",  "bool",   "byte",    "word",    "dword", "lword", "time",  "ltime",  "string",
      "float",  "double", "float32", "float64", "int8",  "int16", "int32", "int64",  "uint16",
      "uint32", "uint64", "boolean", "s16",     "s32",   "u16",   "u32",   "moment", "single"};
  bool any = false;
  for (const std::string_view cell : split(row, separator)) {
    const std::string text = lower_case(unquoted(cell));
    if (text.empty()) continue;
    if (std::find(kTypes.begin(), kTypes.end(), text) == kTypes.end()) return false;
    any = true;
  }
  return any;
}

const char* why_no_number(std::string_view cell, char decimal) {
  constexpr std::array<std::string_view, 17> kMonths{"jan", "feb", "mar", "m\u00E4r", "mrz", "apr",
                                                     "may", "mai", "jun", "jul",      "aug", "sep",
                                                     "oct", "okt", "nov", "dec",      "dez"};
  const std::string text = lower_case(as_utf8(unquoted(trimmed(cell))));
  const bool digit = std::any_of(text.begin(), text.end(), is_digit);
  const bool month = std::any_of(kMonths.begin(), kMonths.end(),
                                 [&](std::string_view m) { return text.find(m) != std::string::npos; });
  if (digit && month && text.size() < 16)
    return " (a spreadsheet made a date of a number, which is lost: export again and open the file as text)";
  return decimal == ',' && cell.find('.') != std::string_view::npos
             ? " with a decimal comma, as in other cells"
             : "";
}

std::optional<double> time_of_day(std::string_view text) {
  text = without_iec_date(trimmed(text));
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
  if (take(text, '.') || take(text, ',') || take(text, ':') || take(text, ';')) {
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

std::optional<double> minutes_and_seconds(std::string_view text) {
  text = trimmed(text);
  const auto minute = take_two(text, 60);
  if (!minute || !take(text, ':')) return std::nullopt;
  const auto mark = text.find_first_of(".,");
  if (mark != 2 || text.size() < 4 || !is_digit(text[0])) return std::nullopt;
  const auto second = cell_number(text, text[mark]);
  if (!second || !(*second < 60.0)) return std::nullopt;
  return 60.0 * *minute + *second;
}

std::optional<double> duration(std::string_view text) {
  text = trimmed(text);
  if (const auto seconds = iec_duration(text)) return seconds;
  const auto blank = text.find(' ');
  if (blank == std::string_view::npos) return std::nullopt;
  const auto number = cell_number(text.substr(0, blank), '.');
  const std::string_view unit = trimmed(text.substr(blank));
  if (!number || !(*number >= 0.0)) return std::nullopt;
  if (unit == "sec") return *number;
  const std::size_t behind = unit.starts_with("days ") ? 5 : unit.starts_with("day ") ? 4 : 0;
  const auto time = behind > 0 ? time_of_day(unit.substr(behind)) : std::nullopt;
  return time ? std::optional(86400.0 * *number + *time) : std::nullopt;
}

bool is_time_name(const std::string& header) {
  const std::string name = lower_case(header.substr(0, header.find_first_of(" [(")));
  return name == "time" || name == "timestamp" || name == "zeit" || name == "t";
}

bool drop_same_times(Log& log, const std::string& first, const std::string& again) {
  const auto called = [&](const std::string& name) {
    return std::find_if(log.columns.begin(), log.columns.end(),
                        [&](const Column& c) { return c.header == name; });
  };
  const auto a = called(first), b = called(again);
  if (a == log.columns.end() || b == log.columns.end()) return true;
  if (a->texts.empty() && !b->texts.empty() && !read_times_of_day(*b)) return false;
  if (a->values != b->values || a->texts != b->texts) return false;
  log.columns.erase(b);
  return true;
}

void take_comment(std::string_view line, std::vector<std::pair<std::string, std::string>>& metadata) {
  const auto text = trimmed(line.substr(std::min(line.find_first_not_of("#% \t"), line.size())));
  const auto colon = text.find(':');
  if (colon == std::string_view::npos || colon == 0) return;
  metadata.emplace_back(as_utf8(trimmed(text.substr(0, colon))), as_utf8(trimmed(text.substr(colon + 1))));
}

void drop_blank_columns(Log& log) {
  std::erase_if(log.columns, [&](const Column& column) {
    const bool blank = !column.texts.empty() && std::all_of(column.texts.begin(), column.texts.end(),
                                                            [](const std::string& t) { return t.empty(); });
    if (blank)
      log.notes.push_back("column " + in_quotes(column.header) + " is blank in every row and was left out");
    return blank;
  });
}

bool below_the_table(std::string_view rest, char separator) {
  constexpr std::size_t kMostLines = 20;
  std::size_t lines = 0;
  while (!rest.empty()) {
    const std::string_view line = trimmed(take_line(rest));
    if (line.empty()) continue;
    const std::string cell = unquoted(line.substr(0, line.find(separator)));
    const bool word = !cell.empty() && std::isalpha(static_cast<unsigned char>(cell.front())) != 0;
    const bool digit = std::any_of(cell.begin(), cell.end(), is_digit);
    if (!word || digit || cell_number(cell, '.') || ++lines > kMostLines) return false;  // nan is a number
  }
  return true;
}

bool read_times_of_day(Column& column) {
  if (!column.texts.empty() && time_of_day(column.texts.front())) fill_milliseconds(column.texts);
  // A clock does not go on after 24 h.
  const bool hours = std::any_of(column.texts.begin(), column.texts.end(), [](const std::string& text) {
    return !time_of_day(text) && hours_minutes_and_seconds(text);
  });
  const bool short_times = !column.texts.empty() && minutes_and_seconds(column.texts.front()).has_value();
  const bool durations = !column.texts.empty() && duration(column.texts.front()).has_value();
  const double whole = durations || hours ? std::numeric_limits<double>::infinity()
                       : short_times      ? 3600.0
                                          : 86400.0;
  std::vector<double> values;
  values.reserve(column.texts.size());
  double before = 0.0;
  double last = 0.0;
  for (const std::string& text : column.texts) {
    const auto t = hours         ? hours_minutes_and_seconds(text)
                   : durations   ? duration(text)
                   : short_times ? minutes_and_seconds(text)
                                 : time_of_day(text);
    if (!t) return false;
    if (!values.empty() && *t < last - 0.5 * whole) before += whole;
    last = *t;
    values.push_back(*t + before);
  }
  // A stamp that stays the same, such as the begin of a query, is no time of the rows.
  if (values.empty() || (values.size() > 1 && values.back() == values.front())) return false;
  const double first = values.front();
  for (double& t : values) t -= first;
  column.values = std::move(values);
  column.texts.clear();
  column.unit_text = "s";
  column.unit_assumed = false;
  return true;
}

}  // namespace stribeck::io::detail
