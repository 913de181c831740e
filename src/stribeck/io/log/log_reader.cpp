#include <fast_float/fast_float.h>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <stribeck/io/units.hpp>
#include <utility>

namespace stribeck::io::detail {

void make_names_unique(Log& log) {
  for (const bool headers : {false, true}) {
    std::map<std::string, std::size_t> seen;
    for (auto& c : log.columns) {
      std::string& name = headers ? c.header : c.name;
      const std::size_t n = ++seen[name];
      if (n == 1) continue;
      std::string fresh = name + " #" + std::to_string(n);
      while (seen.count(fresh) > 0) fresh += '\'';
      ++seen[fresh];
      if (headers) {
        log.notes.push_back("column " + in_quotes(name) + " stands more than once, one is called " +
                            in_quotes(fresh));
      }
      name = std::move(fresh);
    }
  }
}

void Reader::fail(std::size_t line, std::string message) const {
  throw InputError(Problem{log_.source, line, "", std::move(message)});
}

void Reader::add_metadata(std::string_view key, std::string_view value) {
  log_.metadata.emplace_back(as_utf8(trimmed(key)), as_utf8(unquoted(trimmed(value))));
}

std::optional<std::size_t> Reader::count(std::string_view text) {
  text = trimmed(text);
  std::size_t n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return n;
}

double Reader::number(std::string_view cell, std::size_t row, std::size_t column, std::string_view name) {
  if (marks_.size() <= column) marks_.resize(column + 1, 0);
  char& mark = marks_[column];
  const auto found = cell.find_first_of(".,");
  if (found != std::string_view::npos && mark == 0) mark = cell[found];
  const auto value = cell_number(cell, mark == ',' ? ',' : '.');
  if (value && std::isfinite(*value)) return *value;
  const std::string place = "row " + std::to_string(row) + ", column " + in_quotes(name) + ": ";
  if (unquoted(cell).empty()) {
    fail(lines_.number(), place + "the cell is blank, expected a number (remove the row or the column)");
  }
  fail(lines_.number(),
       place + "got " + in_quotes(as_utf8(cell)) + ", expected a " + (value ? "finite number" : "number") +
           (found != std::string_view::npos && cell[found] != mark
                ? std::string(" with a decimal ") + (mark == ',' ? "comma" : "point") + ", as in other cells"
                : ""));
}

double Reader::number_or_absent(std::string_view cell, std::size_t row, std::size_t column,
                                std::string_view name) {
  if (is_absent(cell)) return std::numeric_limits<double>::quiet_NaN();
  return number(cell, row, column, name);
}

bool Reader::cut(std::size_t row) {
  if (lines_.ended()) return false;
  note("the last row (row " + std::to_string(row) + ", line " + std::to_string(lines_.number()) +
       ") was left out: it has no line end and may be cut off");
  return true;
}

void Reader::read_table(char separator) {
  const std::size_t n = log_.columns.size();
  std::vector<double> row(n);
  while (lines_.next()) {
    const auto line = trimmed(lines_.text());
    if (line.empty()) continue;
    if (cut(log_.rows + 1)) break;
    auto cells = split_exactly(line, separator);
    while (cells.size() > n && cells.back().empty()) cells.pop_back();  // a separator at the end of the line
    const std::string where = "row " + std::to_string(log_.rows + 1);
    if (cells.size() < n && lines_.last()) {
      note("the last row (" + where + ", line " + std::to_string(lines_.number()) +
           ") was left out: it has " + std::to_string(cells.size()) + " of " + std::to_string(n) + " cells");
      break;
    }
    if (cells.size() != n) {
      fail(lines_.number(), where + ": got " + std::to_string(cells.size()) +
                                (cells.size() == 1 ? " cell" : " cells") + ", expected " + std::to_string(n) +
                                " as in the header (cut the log there, or export it again)");
    }
    for (std::size_t c = 0; c < n; ++c) row[c] = number(cells[c], log_.rows + 1, c, log_.columns[c].name);
    for (std::size_t c = 0; c < n; ++c) log_.columns[c].values.push_back(row[c]);
    ++log_.rows;
  }
}

void Reader::finish() {
  if (log_.rows < 2) {
    fail(0, log_.rows == 0 ? "has a header but no data rows, expected at least two"
                           : "has one data row, expected at least two");
  }
  make_names_unique(log_);
}

void add_groups(Log& log, std::vector<Group> groups, const std::string& time_unit) {
  const std::size_t first = log.columns.size();
  std::vector<std::size_t> times;
  const auto add_time = [&](const std::vector<double>& t) {
    for (const std::size_t i : times) {
      if (log.columns[i].values == t) return static_cast<int>(i);
    }
    Column c;
    c.name = times.empty() ? "t" : "t" + std::to_string(times.size() + 1);
    c.header = c.name;
    c.unit_text = time_unit;
    c.values = t;
    times.push_back(log.columns.size());
    log.columns.push_back(std::move(c));
    return static_cast<int>(times.back());
  };
  for (Group& group : groups) {
    for (Column& channel : group.channels) {
      Samples own;
      const bool whole =
          std::none_of(channel.values.begin(), channel.values.end(), [](double x) { return std::isnan(x); });
      if (!whole) {
        own = present(group.t, channel.values);
        log.notes.push_back("column " + in_quotes(channel.name) + ": " +
                            std::to_string(channel.values.size() - own.values.size()) + " of " +
                            std::to_string(channel.values.size()) + " samples are absent");
        channel.values = std::move(own.values);
      }
      if (channel.values.empty()) {
        log.notes.push_back("column " + in_quotes(channel.name) + " was left out: it holds no samples");
        continue;
      }
      channel.time = add_time(whole ? group.t : own.t);
      log.columns.push_back(std::move(channel));
    }
  }
  for (std::size_t c = first; c < log.columns.size(); ++c) {
    log.rows = std::max(log.rows, log.columns[c].values.size());
    if (times.size() < 2) log.columns[c].time = -1;
  }
  if (times.size() < 2) return;
  for (const std::size_t i : times) log.columns[i].time = static_cast<int>(i);
  log.notes.push_back("the channels have " + std::to_string(times.size()) + " different sampling times");
}

void note_times(Log& log) {
  std::vector<bool> is_time(log.columns.size(), false);
  for (const Column& c : log.columns) {
    if (c.time >= 0) is_time[static_cast<std::size_t>(c.time)] = true;
  }
  if (std::none_of(is_time.begin(), is_time.end(), [](bool b) { return b; })) {
    const int t = time_column(log);
    if (t >= 0) is_time[static_cast<std::size_t>(t)] = true;
  }
  for (std::size_t i = 0; i < log.columns.size(); ++i) {
    const Column& c = log.columns[i];
    if (!is_time[i] || c.values.size() < 2) continue;
    const std::string of = c.name == "t" ? "" : "column " + in_quotes(c.name) + ": ";
    try {
      for (const Note& note : check_time(c.values, "", c.name, c.unit_text).notes)
        log.notes.emplace_back(of + note.text, note.about);
    } catch (const InputError& e) {
      const auto first = std::adjacent_find(c.values.begin(), c.values.end(),
                                            [](double before, double after) { return !(after > before); });
      const bool back = first != c.values.end() && *std::next(first) < *first;
      log.notes.emplace_back("column " + in_quotes(c.name) + ": " + e.problems().front().message,
                             back ? Note::About::kTimeBack : Note::About::kOther);
    }
  }
}

void add_time(Log& log, std::vector<double> values, const std::string& unit) {
  Column t;
  t.name = "t";
  t.header = "t";
  t.unit_text = unit;
  t.values = std::move(values);
  for (Column& c : log.columns) {
    if (c.time >= 0) ++c.time;
  }
  log.columns.insert(log.columns.begin(), std::move(t));
}

}  // namespace stribeck::io::detail
