#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log_formats.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <stribeck/io/units.hpp>

namespace stribeck::io::detail {

namespace {

class DriveReader : protected Reader {
 protected:
  using Reader::Reader;

  void check_count(std::optional<std::size_t> expected) {
    if (!expected || *expected == log_.rows) return;
    note("the header says " + std::to_string(*expected) + " samples, the file has " +
         std::to_string(log_.rows) + ": it is cut off or was edited");
  }

  /// `tolerance` of the step, because headers round it.
  void check_step(const std::string& said, const char* unit, double tolerance) {
    if (said.empty()) return;
    add_metadata("sample time", said + " " + unit);
    const auto expected = cell_number(said, said.find(',') == std::string::npos ? '.' : ',');
    if (!expected || log_.rows < 2) return;
    const auto& t = log_.columns[0].values;
    const double step = t[1] - t[0];
    if (std::abs(step - *expected) <= tolerance * std::abs(*expected)) return;
    note("the rows are " + number_text(step) + " " + unit + " apart, the header says " + said + " " + unit);
  }
};

class EposReader : DriveReader {
 public:
  EposReader(std::string_view text, const std::string& source) : DriveReader(text, source, "EPOS Studio") {}

  Log read() {
    read_header();
    read_rows();
    check_count(recorded_);
    check_step(period_, "ms", 1e-3);
    finish();
    return std::move(log_);
  }

 private:
  /// The line as EPOS Studio wrote it. A spreadsheet that saved the file again has added commas after it, and
  /// quotes around it where it contained commas. Text after that is a remark of a user.
  std::string original(std::string& remark) {
    const auto line = lines_.text();
    remark.clear();
    if (!resaved_) return std::string(trimmed(line));
    const auto cells = split_exactly(line, ',');
    for (std::size_t i = 1; i < cells.size(); ++i) remark += unquoted(cells[i]);
    return unquoted(cells[0]);
  }

  void read_header() {
    std::string remark;
    std::string names;
    while (names.empty() && lines_.next()) {
      if (lines_.number() == 1) resaved_ = trimmed(lines_.text()).back() == ',';
      std::string line = original(remark);
      if (line.empty()) continue;
      if (line[0] == ';') {
        names = std::move(line);
        break;
      }
      const auto colon = line.find(":;");
      if (colon == std::string::npos) {
        fail(lines_.number(),
             "got " + in_quotes(as_utf8(line)) + ", expected KEY:;VALUE or the names of the columns");
      }
      const std::string key = line.substr(0, colon);
      const std::string value = line.substr(colon + 2);
      add_metadata(key, value);
      if (key == "Recorded samples") recorded_ = count(value);
      if (key == "Sampling period") period_ = std::string(trimmed(value));
    }
    if (names.empty() || !lines_.next()) fail(lines_.number(), "is cut off in its header (export it again)");
    const std::string units = original(remark);
    const auto name_cells = split_exactly(names, ';');
    const auto unit_cells = split_exactly(units, ';');
    if (name_cells.size() != unit_cells.size() || name_cells.size() > kMaxColumns) {
      fail(lines_.number(), "got " + std::to_string(unit_cells.size()) + " units for " +
                                std::to_string(name_cells.size()) + " columns (export it again)");
    }
    for (std::size_t i = 0; i < name_cells.size(); ++i) {
      std::string name = as_utf8(unquoted(name_cells[i]));
      if (!is_utf8(name_cells[i])) note("column " + in_quotes(name) + " is not UTF-8, read as Windows-1252");
      if (name.empty()) name = i == 0 ? "t" : "column " + std::to_string(i + 1);
      std::string unit = plain_unit(unit_cells[i], name, log_.notes);
      log_.columns.push_back({name, std::move(unit), {}, name});
    }
    if (log_.columns[0].unit_text.empty()) {
      fail(lines_.number(),
           "unknown unit of time: got " + in_quotes(as_utf8(unit_cells[0])) + ", expected s, ms or us");
    }
  }

  void read_rows() {
    const std::size_t n = log_.columns.size();
    std::string remark;
    std::vector<double> row(n);
    while (lines_.next()) {
      const std::string line = original(remark);
      if (line.empty()) continue;
      const std::string where = "row " + std::to_string(log_.rows + 1);
      if (cut(log_.rows + 1)) break;
      if (!remark.empty()) {
        note(where + " (line " + std::to_string(lines_.number()) + ") carries the remark " +
             in_quotes(as_utf8(remark)) + ": a value there may have been edited by hand");
      }
      auto cells = split_exactly(line, ';');
      while (cells.size() > n && cells.back().empty()) cells.pop_back();
      if (cells.size() < n && lines_.last()) {
        note("the last row (" + where + ", line " + std::to_string(lines_.number()) +
             ") was left out: it has " + std::to_string(cells.size()) + " of " + std::to_string(n) +
             " cells");
        break;
      }
      if (cells.size() != n) {
        fail(lines_.number(), where + ": got " + std::to_string(cells.size()) + " cells, expected " +
                                  std::to_string(n) + " as in the header");
      }
      for (std::size_t c = 0; c < n; ++c) row[c] = number(cells[c], log_.rows + 1, c, log_.columns[c].name);
      for (std::size_t c = 0; c < n; ++c) log_.columns[c].values.push_back(row[c]);
      ++log_.rows;
    }
  }

  bool resaved_ = false;
  std::optional<std::size_t> recorded_;
  std::string period_;
};

/// Quantities that MR Configurator2 shows beside the curve; its export has no units. Source: MR-J4 servo amplifier manual, signals
/// of the graph function.
constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kMrUnits{{
    {"Servo motor speed", "rpm"},
    {"Motor speed", "rpm"},
    {"Speed command", "rpm"},
    {"Torque", "%"},
    {"Torque command", "%"},
    {"Instantaneous torque", "%"},
    {"Effective load ratio", "%"},
    {"Current command", "%"},
    {"Regenerative load ratio", "%"},
    {"Peak load ratio", "%"},
    {"Bus voltage", "V"},
    {"Droop pulses", "count"},
}};

class MrReader : DriveReader {
 public:
  MrReader(std::string_view text, const std::string& source)
      : DriveReader(text, source, "MR Configurator2") {}

  Log read() {
    read_header();
    read_table(',');
    check_count(samples_);
    check_step(interval_, "ms", 2e-3);
    leave_out_unused();
    finish();
    return std::move(log_);
  }

 private:
  void read_header() {
    std::vector<std::string_view> kinds;
    while (kinds.empty()) {
      if (!lines_.next()) fail(lines_.number(), "is cut off in its header (export it again)");
      const auto line = trimmed(lines_.text());
      if (line.empty()) continue;
      const auto cells = split_exactly(line, ',');
      if (begins_with(line, "Number of sampling data") && cells.size() > 1) {
        samples_ = count(cells[1]);
      } else if (begins_with(line, "Sampling time interval") && cells.size() > 1) {
        interval_ = std::string(cells[1]);
      } else if (begins_with(line, "Time,")) {
        kinds = cells;
      } else {
        add_metadata("axis", line);
      }
      if (lines_.number() > 50) fail(lines_.number(), "has no line of names that begins with \"Time,\"");
    }
    if (!lines_.next()) fail(lines_.number(), "is cut off in its header (export it again)");
    const auto names = split_exactly(trimmed(lines_.text()), ',');
    if (names.size() != kinds.size() || names.size() > kMaxColumns) {
      fail(lines_.number(), "got " + std::to_string(names.size()) + " names, expected " +
                                std::to_string(kinds.size()) + " as there are channels");
    }
    if (plain_unit(names[0], "time", log_.notes) != "ms")
      fail(lines_.number(), "got " + in_quotes(as_utf8(names[0])) + " for the time, expected ms");
    log_.columns.push_back({"t", "ms", {}, "t"});
    std::string known;
    for (std::size_t i = 1; i < names.size(); ++i) {
      std::string header = as_utf8(names[i]);
      if (!is_utf8(names[i])) note("column " + in_quotes(header) + " is not UTF-8, read as Windows-1252");
      if (header.empty()) header = "column " + std::to_string(i + 1);
      unused_.push_back(header == "Not selected");
      if (unused_.back()) header += " " + std::string(kinds[i]);
      Column c{header, "", {}, header};
      // "Droop pulses (by 100 pls.)": the name contains the scale.
      std::string scale;
      if (const auto open = header.find(" (by "); open != std::string::npos) {
        c.name = header.substr(0, open);
        const auto digits = std::string_view(header).substr(open + 5);
        const auto blank = std::min(digits.find(' '), digits.size());
        if (const auto by = count(digits.substr(0, blank)); by && *by > 1) scale = std::to_string(*by) + " ";
      }
      for (const auto& [name, unit] : kMrUnits) {
        if (c.name != name) continue;
        c.unit_text = scale + std::string(unit);
        c.unit_assumed = true;
        known += (known.empty() ? "" : ", ") + c.name + " in " + c.unit_text;
      }
      log_.columns.push_back(std::move(c));
    }
    if (!known.empty()) note("units are not in the file; taken as MR Configurator2 shows them: " + known);
  }

  void leave_out_unused() {
    const auto n = static_cast<std::size_t>(std::count(unused_.begin(), unused_.end(), true));
    for (std::size_t i = unused_.size(); i-- > 0;) {
      if (unused_[i]) log_.columns.erase(log_.columns.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
    if (n > 0) note(std::to_string(n) + " channels that were not selected are left out");
    if (log_.columns.size() < 2) fail(0, "has no selected channel (select signals and record again)");
  }

  std::optional<std::size_t> samples_;
  std::string interval_;
  std::vector<bool> unused_;
};

class NiReader : Reader {
 public:
  NiReader(std::string_view text, const std::string& source) : Reader(text, source, "NI DAQ") {}

  Log read() {
    read_header();
    read_rows();
    check_intervals();
    add_groups(log_, std::move(groups_), "s");
    note("the time has no unit in the file; it is taken as s");
    finish();
    return std::move(log_);
  }

 private:
  std::vector<std::string_view> header_line(std::string_view key) {
    if (!lines_.next()) fail(lines_.number(), "is cut off in its header (export it again)");
    const auto line = trimmed(lines_.text());
    if (separator_ == 0) separator_ = line.size() > key.size() ? line[key.size()] : ',';
    auto cells = split_exactly(line, separator_);
    std::vector<std::string_view> values;
    for (std::size_t i = 0; i + 1 < cells.size(); i += 2) {
      if (!begins_with(cells[i], key)) {
        fail(lines_.number(), "got " + in_quotes(as_utf8(cells[i])) + ", expected " + in_quotes(key));
      }
      values.push_back(cells[i + 1]);
    }
    if (values.empty() || values.size() > kMaxColumns / 2 ||
        (!groups_.empty() && values.size() != groups_.size())) {
      fail(lines_.number(), "got " + std::to_string(values.size()) + " channels, expected " +
                                std::to_string(std::max<std::size_t>(groups_.size(), 1)));
    }
    return values;
  }

  void read_header() {
    const auto starts = header_line("Timestamp");
    groups_.resize(starts.size());
    const auto intervals = header_line("Interval");
    const auto names = header_line("Channel name");
    const auto units = header_line("Unit");
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      Column c;
      c.name = as_utf8(unquoted(names[i]));
      if (!is_utf8(names[i])) note("column " + in_quotes(c.name) + " is not UTF-8, read as Windows-1252");
      if (c.name.empty()) c.name = "column " + std::to_string(i + 1);
      c.header = c.name;
      c.unit_text = plain_unit(units[i], c.name, log_.notes);
      add_metadata(c.name + " Timestamp", starts[i]);
      add_metadata(c.name + " Interval", intervals[i]);
      if (starts[i] != starts[0]) {
        note("column " + in_quotes(c.name) + " was started at another time than the first: " +
             as_utf8(starts[i]) + " instead of " + as_utf8(starts[0]));
      }
      intervals_.push_back(
          cell_number(intervals[i], intervals[i].find(',') == std::string_view::npos ? '.' : ','));
      groups_[i].channels.push_back(std::move(c));
    }
  }

  void read_rows() {
    const std::size_t n = 2 * groups_.size();
    std::vector<double> row(n);
    std::size_t rows = 0;
    while (lines_.next()) {
      const auto line = lines_.text();
      if (trimmed(line).empty()) continue;
      ++rows;
      if (cut(rows)) break;
      auto cells = split_exactly(line, separator_);
      while (cells.size() > n && cells.back().empty()) cells.pop_back();
      if (cells.size() != n) {
        if (cells.size() < n && lines_.last()) {
          note("the last row (row " + std::to_string(rows) + ", line " + std::to_string(lines_.number()) +
               ") was left out: it has " + std::to_string(cells.size()) + " of " + std::to_string(n) +
               " cells");
          break;
        }
        fail(lines_.number(), "row " + std::to_string(rows) + ": got " + std::to_string(cells.size()) +
                                  " cells, expected " + std::to_string(n) + " as in the header");
      }
      for (std::size_t i = 0; i < n; ++i) {
        row[i] = number_or_absent(cells[i], rows, i, groups_[i / 2].channels[0].name);
      }
      for (std::size_t g = 0; g < groups_.size(); ++g) {
        const double t = row[2 * g];
        const double value = row[2 * g + 1];
        if (std::isnan(t) && std::isnan(value)) continue;  // the end of a shorter channel
        if (std::isnan(t)) {
          fail(lines_.number(), "row " + std::to_string(rows) + ", column " +
                                    in_quotes(groups_[g].channels[0].name) + ": got a value without a time");
        }
        groups_[g].t.push_back(t);
        groups_[g].channels[0].values.push_back(value);
      }
    }
  }

  void check_intervals() {
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const auto& t = groups_[g].t;
      if (!intervals_[g] || t.size() < 2) continue;
      if (std::abs(t[1] - t[0] - *intervals_[g]) <= 1e-3 * std::abs(*intervals_[g])) continue;
      note("column " + in_quotes(groups_[g].channels[0].name) + ": the rows are " + number_text(t[1] - t[0]) +
           " apart, the header says " + number_text(*intervals_[g]));
    }
  }

  char separator_ = 0;
  std::vector<std::optional<double>> intervals_;
  std::vector<Group> groups_;
};

/// Whether line i (from 0) of the text begins with its key, for all keys.
bool lines_begin(std::string_view text, std::initializer_list<std::string_view> keys) {
  Lines lines(text.substr(0, 1 << 16));
  for (const auto key : keys) {
    if (!lines.next() || !begins_with(trimmed(lines.text()), key)) return false;
  }
  return true;
}

}  // namespace

bool is_epos(std::string_view text) {
  if (!begins_with(text, "Date:;")) return false;
  Lines lines(text.substr(0, 1 << 16));
  for (int i = 0; i < 5 && lines.next(); ++i) {
    if (begins_with(trimmed(lines.text()), "EPOS Studio Version:;")) return true;
  }
  return false;
}
Log read_epos(std::string_view text, const std::string& source) { return EposReader(text, source).read(); }

bool is_mr_configurator(std::string_view text) {
  return lines_begin(text, {"Axis", "Number of sampling data,"});
}
Log read_mr_configurator(std::string_view text, const std::string& source) {
  return MrReader(text, source).read();
}

bool is_ni_daq(std::string_view text) { return lines_begin(text, {"Timestamp", "Interval", "Channel name"}); }
Log read_ni_daq(std::string_view text, const std::string& source) { return NiReader(text, source).read(); }

}  // namespace stribeck::io::detail
