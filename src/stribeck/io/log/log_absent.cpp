// Tables with blank cells or NaN: a few damaged rows, or channels of different rates in one table.
#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <utility>

namespace stribeck::io::detail {
namespace {

/// A column with more absent samples is one of another rate.
constexpr double kFewAbsent = 0.05;

std::size_t absent_in(const Column& c) {
  return static_cast<std::size_t>(
      std::count_if(c.values.begin(), c.values.end(), [](double x) { return std::isnan(x); }));
}

template <class T>
void keep_rows(std::vector<T>& values, const std::vector<char>& absent) {
  if (values.empty()) return;
  std::size_t to = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (absent[k] != 0) continue;
    if (to != k) values[to] = std::move(values[k]);
    ++to;
  }
  values.resize(to);
}

/// Leaves out the rows in which one of these columns has no number.
void leave_out_rows(Log& log, const std::vector<std::size_t>& columns, const Problem& first) {
  std::vector<char> absent(log.rows, 0);
  std::string names;
  for (const std::size_t c : columns) {
    const Column& column = log.columns[c];
    for (std::size_t k = 0; k < column.values.size(); ++k) {
      if (std::isnan(column.values[k])) absent[k] = 1;
    }
    if (absent_in(column) > 0) names += (names.empty() ? "" : ", ") + in_quotes(column.header);
  }
  const auto rows = static_cast<std::size_t>(std::count(absent.begin(), absent.end(), 1));
  if (rows == 0) return;
  for (Column& c : log.columns) {
    keep_rows(c.values, absent);
    keep_rows(c.texts, absent);
  }
  log.notes.push_back(std::to_string(rows) + " of " + std::to_string(log.rows) +
                      " rows were left out: a cell of " + names + " holds no number (the first in line " +
                      std::to_string(first.line) + ")");
  log.rows -= rows;
  if (log.rows < 2)
    throw InputError(Problem{
        log.source, 0, "",
        "has " + std::to_string(log.rows) + " rows with a number in each cell, expected at least two"});
}

/// Index of the column with the times of the samples of a channel that are not absent.
std::size_t own_times(Log& log, std::vector<std::size_t>& made, std::vector<double> t, const std::string& of,
                      const Column& time) {
  for (const std::size_t i : made) {
    if (log.columns[i].values == t) return i;
  }
  Column c;
  c.name = time.name + " of " + of;
  c.header = c.name;
  c.unit_text = time.unit_text;
  c.values = std::move(t);
  made.push_back(log.columns.size());
  log.columns.push_back(std::move(c));
  return made.back();
}

}  // namespace

bool is_absent(std::string_view cell) {
  cell = trimmed(cell);
  if (cell.size() > 12) return false;
  const std::string word = lower_case(unquoted(cell));
  // Older programs of Windows write "-1.#IND00", "1.#QNAN0".
  std::string_view bare = word;
  if (bare.starts_with('-')) bare.remove_prefix(1);
  if (bare.starts_with("1.#ind") || bare.starts_with("1.#qnan")) return true;
  constexpr std::array<std::string_view, 12> kWords{"",    "nan",  "-nan", "+nan", "nan(ind)", "-nan(ind)",
                                                    "n/a", "#n/a", "#nv",  "na",   "null",     "none"};
  return std::find(kWords.begin(), kWords.end(), word) != kWords.end();
}

Samples present(const std::vector<double>& t, const std::vector<double>& values) {
  Samples out;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (std::isnan(values[k])) continue;
    out.t.push_back(t[k]);
    out.values.push_back(values[k]);
  }
  return out;
}

void leave_out_absent(Log& log, int time, const Problem& first) {
  if (time < 0) throw InputError(first);
  if (const Column& stamps = log.columns[static_cast<std::size_t>(time)];
      stamps.values.size() != log.rows || absent_in(stamps) == log.rows)
    throw InputError(first);
  auto at = static_cast<std::size_t>(time);
  std::vector<std::size_t> few{at};
  for (std::size_t c = log.columns.size(); c-- > 0;) {
    const Column& column = log.columns[c];
    const std::size_t absent = absent_in(column);
    if (c == at || absent == 0) continue;
    if (absent == column.values.size()) {
      log.notes.push_back("column " + in_quotes(column.header) + " was left out: it holds no number");
      log.columns.erase(log.columns.begin() + static_cast<std::ptrdiff_t>(c));
      if (c < at) --at;
      for (std::size_t& i : few) i -= i > c ? 1 : 0;
    } else if (static_cast<double>(absent) <= kFewAbsent * static_cast<double>(log.rows)) {
      few.push_back(c);
    }
  }
  leave_out_rows(log, few, first);

  std::vector<std::size_t> made;
  const std::size_t columns = log.columns.size();
  for (std::size_t c = 0; c < columns; ++c) {
    const std::size_t absent = absent_in(log.columns[c]);
    if (absent == 0) continue;
    Samples own = present(log.columns[at].values, log.columns[c].values);
    log.notes.push_back("column " + in_quotes(log.columns[c].header) + " has numbers in " +
                        std::to_string(own.values.size()) + " of " + std::to_string(log.rows) +
                        " rows, and times of its own");
    const std::size_t times = own_times(log, made, std::move(own.t), log.columns[c].header, log.columns[at]);
    log.columns[c].values = std::move(own.values);
    log.columns[c].time = static_cast<int>(times);
  }
  if (made.empty()) return;
  for (std::size_t c = 0; c < columns; ++c) {
    if (log.columns[c].time < 0) log.columns[c].time = static_cast<int>(at);
  }
  for (const std::size_t c : made) log.columns[c].time = static_cast<int>(c);
}

}  // namespace stribeck::io::detail
