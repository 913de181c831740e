#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log_formats.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::io::detail {

namespace {

constexpr std::string_view kStart = "Starttime of export";
constexpr std::string_view kEnd = "Endtime of export";

/// The separator after a key at the start of a line; 0 when the line does not begin with the key.
char separator_behind(std::string_view line, std::string_view key) {
  const std::size_t quote = !line.empty() && line[0] == '"' ? 1 : 0;
  if (!begins_with(line.substr(quote), key)) return 0;
  const std::size_t at = key.size() + 2 * quote;
  if (line.size() <= at) return 0;
  constexpr std::string_view kSeparators = "\t;, :";
  return kSeparators.find(line[at]) == std::string_view::npos ? '\0' : line[at];
}

class TwinCatReader : Reader {
 public:
  TwinCatReader(std::string_view text, const std::string& source) : Reader(text, source, "TwinCAT Scope") {}

  Log read() {
    read_head();
    read_keys();
    read_rows();
    check_ends();
    add_groups(log_, std::move(groups_), "ms");
    finish();
    return std::move(log_);
  }

 private:
  struct KeyRow {
    std::string key;
    std::vector<std::string_view> cells;
    std::size_t line;
  };

  void read_head() {
    bool ended = false;
    while (!ended && lines_.next()) {
      const auto line = trimmed(lines_.text());
      if (const char s = separator_behind(line, kStart); s != 0) {
        separator_ = s;
        start_ = ticks(line);
        add_metadata(kStart, line.substr(std::min(line.size(), kStart.size() + 1)));
      } else if (separator_behind(line, kEnd) != 0) {
        end_ = ticks(line);
        add_metadata(kEnd, line.substr(std::min(line.size(), kEnd.size() + 1)));
        ended = true;
      }
    }
    if (!ended) fail(lines_.number(), "is cut off in its head: no \"Endtime of export\" (export it again)");
  }

  /// Time in 100 ns since 1601, the second cell of a line.
  [[nodiscard]] std::optional<std::int64_t> ticks(std::string_view line) const {
    const auto cells = split_exactly(line, separator_);
    std::int64_t value = 0;
    if (cells.size() < 2) return std::nullopt;
    const auto [end, error] = std::from_chars(cells[1].data(), cells[1].data() + cells[1].size(), value);
    if (error != std::errc() || end != cells[1].data() + cells[1].size() || value < 0) return std::nullopt;
    return value;
  }

  void read_keys() {
    std::vector<KeyRow> rows;
    while (lines_.next()) {
      const auto line = lines_.text();
      if (trimmed(line).empty()) {
        if (rows.empty()) continue;
        break;
      }
      auto cells = split_exactly(line, separator_);
      if (cells.size() > 4 * kMaxColumns) fail(lines_.number(), "has too many columns");
      std::string key = unquoted(cells[0]);
      rows.push_back({std::move(key), std::move(cells), lines_.number()});
      if (rows.size() > 100) fail(lines_.number(), "has no blank line between the keys and the data");
    }
    const KeyRow* names = find(rows, "Name");
    if (names == nullptr) fail(lines_.number(), "has no row \"Name\" (export it with its header)");
    // A channel may be called "Name"; no data type is called "Data-Type".
    const KeyRow* layout = find(rows, "Data-Type");
    if (layout == nullptr) layout = names;
    std::vector<std::string_view> cells = layout->cells;
    if (cells.size() > 1 && cells.back().empty()) cells.pop_back();
    if (cells.size() > kMaxColumns) fail(layout->line, "has too many columns");
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (unquoted(cells[i]) == layout->key) {
        group_of_.push_back(static_cast<int>(groups_.size()));
        is_time_.push_back(1);
        first_.push_back(i);
        groups_.emplace_back();
      } else {
        group_of_.push_back(static_cast<int>(groups_.size()) - 1);
        is_time_.push_back(0);
        groups_.back().channels.emplace_back();
      }
    }
    std::size_t named = names->cells.size();
    if (named > cells.size() && names->cells.back().empty()) --named;
    if (named != cells.size()) {
      fail(names->line, "names " + std::to_string(named) + " columns, expected " +
                            std::to_string(cells.size()) + " as in row " + in_quotes(layout->key) +
                            " (is the separator part of a name? export it with tabs)");
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (is_time_[i] != 0) continue;
      Column& c = groups_[static_cast<std::size_t>(group_of_[i])].channels[channel(i)];
      c.name = as_utf8(unquoted(names->cells[i]));
      if (c.name.empty()) c.name = "column " + std::to_string(i + 1);
      if (!is_utf8(names->cells[i]))
        note("column " + in_quotes(c.name) + " is not UTF-8, read as Windows-1252");
      c.header = c.name;
    }
    for (const KeyRow& row : rows) check_keys(row, cells.size());
    for (const KeyRow& row : rows) read_key(row);
    if (rows.size() > 1 && find(rows, "Unit") == nullptr)
      note("the header has no row \"Unit\": no column has a unit");
    if (!scaled_.empty()) {
      std::string names_of;
      for (const auto& name : scaled_) names_of += (names_of.empty() ? "" : ", ") + in_quotes(name);
      note("the header names scale factors and offsets of " + names_of +
           "; the values are used as they are (in all known files the factors are already applied)");
    }
    sample_times_.resize(groups_.size());
    if (const KeyRow* times = find(rows, "SampleTime[ms]")) read_sample_times(*times);
  }

  /// Every row repeats its key before every group.
  void check_keys(const KeyRow& row, std::size_t n) const {
    // Decimal commas that look like separators.
    if (row.cells.size() > n + 1 || (row.cells.size() == n + 1 && !row.cells.back().empty())) return;
    for (std::size_t i = 0; i < std::min(n, row.cells.size()); ++i) {
      const bool key = unquoted(row.cells[i]) == row.key;
      if (key == (is_time_[i] != 0) || (key && row.key == "Name")) continue;
      fail(row.line, "row " + in_quotes(row.key) + ", column " + std::to_string(i + 1) +
                         ": does not agree with the groups of the other rows (damaged? export it again)");
    }
  }

  static const KeyRow* find(const std::vector<KeyRow>& rows, std::string_view key) {
    for (const auto& row : rows) {
      if (row.key == key) return &row;
    }
    return nullptr;
  }

  /// Values of a key for the channels of each group; empty where their number does not fit. With commas as separator, a
  /// decimal comma ("0,2") makes two cells of one.
  [[nodiscard]] std::vector<std::vector<std::string>> values_of(const KeyRow& row) const {
    std::vector<std::vector<std::string>> values;
    for (const auto cell : row.cells) {
      std::string text = as_utf8(unquoted(cell));
      if (text == row.key) {
        values.emplace_back();
      } else if (!values.empty()) {
        values.back().push_back(std::move(text));
      }
    }
    if (values.size() != groups_.size()) return {};
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const std::size_t wanted = groups_[g].channels.size();
      auto& v = values[g];
      while (v.size() > wanted && v.back().empty()) v.pop_back();
      if (separator_ == ',' && wanted > 0 && v.size() == 2 * wanted) {
        std::vector<std::string> joined;
        for (std::size_t i = 0; i < v.size(); i += 2) joined.push_back(v[i] + "," + v[i + 1]);
        v = std::move(joined);
      }
      if (v.size() > wanted) return {};
      v.resize(wanted);
    }
    return values;
  }

  void read_key(const KeyRow& row) {
    if (row.key == "Name") return;
    const auto values = values_of(row);
    if (values.empty()) {
      note("row " + in_quotes(row.key) + " of the header does not fit the columns and is not used");
      return;
    }
    const bool factor = row.key == "ScaleFactor" || row.key == "Unit ScaleFactor";
    const bool offset = row.key == "Offset" || row.key == "Unit Offset";
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      for (std::size_t i = 0; i < values[g].size(); ++i) {
        Column& c = groups_[g].channels[i];
        const std::string& value = values[g][i];
        if (row.key == "Unit") c.unit_text = plain_unit(value == "(None)" ? "" : value, c.name, log_.notes);
        if (value.empty() || (factor && value == "1") || (offset && value == "0")) continue;
        for (const std::string_view kept : {"SymbolName", "SymbolComment", "Data-Type", "SampleTime[ms]"}) {
          if (row.key == kept) add_metadata(c.name + " " + row.key, value);
        }
        if (!factor && !offset) continue;
        add_metadata(c.name + " " + row.key, value);
        if (std::find(scaled_.begin(), scaled_.end(), c.name) == scaled_.end()) scaled_.push_back(c.name);
      }
    }
  }

  void read_sample_times(const KeyRow& row) {
    const auto values = values_of(row);
    for (std::size_t g = 0; g < values.size(); ++g) {
      if (values[g].empty()) continue;
      const std::string& text = values[g].front();
      const auto ms = cell_number(text, text.find(',') == std::string::npos ? '.' : ',');
      if (ms && std::isfinite(*ms) && *ms > 0.0) sample_times_[g] = *ms;
    }
    if (sample_times_.size() == 1 && sample_times_[0])
      add_metadata("sample time", number_text(*sample_times_[0]) + " ms");
  }

  void read_rows() {
    constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
    const std::size_t n = is_time_.size();
    std::vector<double> row(n);
    std::vector<char> there(groups_.size());
    std::size_t rows = 0;
    while (lines_.next()) {
      const auto line = lines_.text();
      const auto bare = trimmed(line);
      if (bare.empty()) continue;
      if (bare == "EOF") {
        if (!lines_.last()) fail(lines_.number(), "goes on behind its EOF (two exports in one file? cut it)");
        break;
      }
      ++rows;
      if (cut(rows)) break;
      const auto cells = split_exactly(line, separator_);
      for (std::size_t i = n; i < cells.size(); ++i) {
        if (cells[i].empty()) continue;
        fail(lines_.number(),
             "row " + std::to_string(rows) + ": got " + std::to_string(cells.size()) + " cells, expected " +
                 std::to_string(n) + " as in the header" +
                 (separator_ == ',' ? " (decimal comma and comma as separator? export it with tabs)" : ""));
      }
      std::fill(there.begin(), there.end(), '\0');
      for (std::size_t i = 0; i < n; ++i) {
        const auto g = static_cast<std::size_t>(group_of_[i]);
        const auto cell = i < cells.size() ? cells[i] : std::string_view();
        if (is_time_[i] != 0) {
          row[i] = cell.empty() ? kAbsent : time(cell, rows, i);
          there[g] = cell.empty() ? '\0' : '\1';
          continue;
        }
        const std::size_t k = channel(i);
        const std::string& name = groups_[g].channels[k].name;
        if (there[g] == 0) {
          if (cell.empty()) continue;
          fail(lines_.number(), "row " + std::to_string(rows) + ", column " + in_quotes(name) +
                                    ": got a value without a time in its group (export it again)");
        }
        if (i >= cells.size()) {
          if (lines_.last()) {
            note("the last row (row " + std::to_string(rows) + ", line " + std::to_string(lines_.number()) +
                 ") was left out: it ends inside a group of channels");
            return;
          }
          fail(lines_.number(),
               "row " + std::to_string(rows) + ": got " + std::to_string(cells.size()) +
                   " cells, which end inside a group of channels (damaged? export it again)");
        }
        if (cell == "True" || cell == "False") {
          row[i] = cell == "True" ? 1.0 : 0.0;
        } else {
          row[i] = number_or_absent(cell, rows, i, name);
        }
      }
      for (std::size_t i = 0; i < n; ++i) {
        const auto g = static_cast<std::size_t>(group_of_[i]);
        if (there[g] == 0) continue;
        auto& to = is_time_[i] != 0 ? groups_[g].t : groups_[g].channels[channel(i)].values;
        to.push_back(row[i]);
      }
    }
  }

  /// Index of column i in its group.
  [[nodiscard]] std::size_t channel(std::size_t i) const {
    return i - first_[static_cast<std::size_t>(group_of_[i])] - 1;
  }

  /// [ms] since the start; as a double, an absolute time in 100 ns would lose digits.
  double time(std::string_view cell, std::size_t row, std::size_t column) {
    std::int64_t absolute = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), absolute);
    constexpr std::int64_t kNoTimeInMs = 1'000'000'000'000'000;
    if (error == std::errc() && end == cell.data() + cell.size() && absolute > kNoTimeInMs && start_)
      return 1e-4 * static_cast<double>(absolute - *start_);
    return number(cell, row, column, "time");
  }

  /// Start and end of the export give the length of each group.
  void check_ends() {
    if (!start_ || !end_) return;
    const double duration_ms = 1e-4 * static_cast<double>(*end_ - *start_);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const auto& t = groups_[g].t;
      const double last = t.empty() ? 0.0 : t.back();
      const double step = sample_times_[g] ? *sample_times_[g] : t.size() > 1 ? t[1] - t[0] : 0.0;
      if (last + step * 1.01 >= duration_ms) continue;
      note("column " + in_quotes(groups_[g].channels.empty() ? "t" : groups_[g].channels[0].name) +
           " ends at " + number_text(last) + " ms of " + number_text(duration_ms) +
           " ms of the export: the file is cut off");
    }
  }

  char separator_ = '\t';
  std::optional<std::int64_t> start_;
  std::optional<std::int64_t> end_;
  std::vector<int> group_of_;       ///< of each cell of a row
  std::vector<char> is_time_;       ///< of each cell of a row
  std::vector<std::size_t> first_;  ///< time cell of each group
  std::vector<Group> groups_;
  std::vector<std::string> scaled_;
  std::vector<std::optional<double>> sample_times_;
};

}  // namespace

bool is_twincat(std::string_view text) {
  if (!begins_with(text, "Name") && !begins_with(text, "\"Name\"")) return false;
  Lines lines(text.substr(0, 1 << 16));
  for (int i = 0; i < 8 && lines.next(); ++i) {
    if (separator_behind(trimmed(lines.text()), kStart) != 0) return true;
  }
  return false;
}

Log read_twincat(std::string_view text, const std::string& source) {
  return TwinCatReader(text, source).read();
}

}  // namespace stribeck::io::detail
