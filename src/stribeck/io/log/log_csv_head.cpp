// The head of a CSV table: names, units, separator and decimal mark.
#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/io/log/log_csv_head.hpp>
#include <stribeck/io/log/log_formats.hpp>
#include <stribeck/io/log/log_spreadsheet.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <utility>

namespace stribeck::io::detail {
namespace {

/// The number behind a name, with its dot or underscore: ".1" of "Time (s).1"; empty: there is none.
std::string copy_number(const std::string& header) {
  const std::size_t end = header.find_last_not_of("0123456789");
  if (end == std::string::npos || end == 0 || end + 1 == header.size()) return {};
  return header[end] == '.' || header[end] == '_' ? header.substr(end) : std::string();
}

class HeadReader {
 public:
  HeadReader(std::string_view all, const std::string& source, const CsvDialect& options)
      : all_(all), options_(options) {
    head_.log.source = source;
  }

  CsvHead read(std::string_view& body) {
    read_names(body);
    return std::move(head_);
  }

 private:
  [[noreturn]] void fail(std::size_t line, std::string message) const {
    throw InputError(Problem{head_.log.source, line, "", std::move(message)});
  }
  void note(std::string text) { head_.log.notes.push_back(std::move(text)); }

  [[nodiscard]] std::size_t line_number(const char* at) const {
    return 1 + static_cast<std::size_t>(std::count(all_.data(), at, '\n'));
  }

  void read_names(std::string_view& body) {
    if (body.substr(0, 3) == "\xEF\xBB\xBF") body.remove_prefix(3);
    for (std::size_t i = 0; i < options_.skip_lines; ++i) take_line(body);
    told_separator_ = take_separator_line(body);
    const std::size_t first = line_number(body.data());
    if (const std::size_t lines = take_head(body, head_.log.metadata); lines > 0) {
      note("the names of the columns are in line " + std::to_string(first + lines) +
           "; what stands above them was left out");
    }
    std::string_view header;
    std::string_view last_comment;
    std::string_view rest = body;
    while (!rest.empty() && header.empty()) {
      body = rest;
      const auto line = take_line(rest);
      if (trimmed(line).empty()) continue;
      if (is_comment(line)) {
        last_comment = line;
        take_comment(line, head_.log.metadata);
      } else {
        header = line;
      }
    }
    if (header.empty()) fail(0, "has no header line, expected names of columns");
    const std::size_t line = line_number(header.data());
    if (!options_.names.empty()) {
      head_.separator = separator_of(header, header);
      const auto cells = split(header, head_.separator).size();
      if (cells != options_.names.size()) {
        fail(line, "got " + std::to_string(cells) + " columns, expected " +
                       std::to_string(options_.names.size()) + " as named");
      }
      if (!is_data(header)) {
        body = rest;
        head_.separator = separator_of(header, first_row(rest));
        note("the given names of the columns replace those in line " + std::to_string(line));
      }
      std::vector<std::string> names;
      for (const auto& name : options_.names) names.push_back(header_of(name));
      set_columns(names, line);
    } else if (is_data(header) || names_in_comment(last_comment, header)) {
      // "# t,x" directly above the numbers.
      head_.separator = separator_of(header, header);
      const auto cells = split(header, head_.separator).size();
      std::vector<std::string_view> names;
      if (!last_comment.empty()) {
        const auto text = trimmed(
            last_comment.substr(std::min(last_comment.find_first_not_of("#% \t"), last_comment.size())));
        names = split(text, head_.separator);
        if (names.size() != cells) names = split(text, separator_of(text, header));
      }
      if (names.size() != cells || cells < 2) {
        fail(line,
             "has no header: the first row holds numbers (put a line with the names of the columns above "
             "it" +
                 (options_.has_side_file
                      ? ", or name them in " + head_.log.source + ".toml: columns = [\"x mm\", …])"
                      : ")"));
      }
      set_columns({names.begin(), names.end()}, line);
      note("the names of the columns are taken from the comment above the numbers");
    } else {
      for (const char c : header) {
        if (static_cast<unsigned char>(c) < 0x20 && c != '\t') {
          fail(line, c == '\r' ? "ends its lines with CR alone, expected LF or CR LF (save it again as text)"
                               : "holds control characters: not a text file (export it as CSV)");
        }
      }
      body = rest;
      head_.separator = separator_of(header, first_row(rest));
      head_.header = trimmed(header);
      const auto above = last_line(all_.substr(0, static_cast<std::size_t>(header.data() - all_.data())));
      set_columns(with_legend(names_of_columns(header, above, head_.separator, body, head_.log.notes)), line);
    }
    take_units(body);
    head_.decimal = decimal_mark(body, head_.separator);
  }

  [[nodiscard]] char separator_of(std::string_view header, std::string_view row) const {
    return told_separator_ ? *told_separator_ : best_separator(header, row);
  }

  /// Leaves out rows of data types (IEC 61131-3, C) below the names.
  void leave_out_types(std::string_view& body) {
    constexpr std::size_t kMost = 2;
    for (std::size_t k = 0; k < kMost; ++k) {
      const std::string_view row = first_row(body);
      if (!is_row_of_types(row, head_.separator)) return;
      note("line " + std::to_string(line_number(row.data())) +
           " names the types of the columns and was left out");
      body.remove_prefix(static_cast<std::size_t>(row.data() + row.size() - body.data()));
    }
  }

  /// LabVIEW writes the units of the signals behind Y_Unit_Label, without that of the time.
  void take_labview_units() {
    const auto label = std::find_if(head_.log.metadata.begin(), head_.log.metadata.end(),
                                    [](const auto& m) { return m.first == "Y_Unit_Label"; });
    if (label == head_.log.metadata.end()) return;
    const auto units = split_exactly(label->second, '\t');
    for (std::size_t c = 1; c < head_.log.columns.size() && c <= units.size(); ++c) {
      Column& column = head_.log.columns[c];
      if (!column.unit_text.empty()) continue;
      column.unit_text = plain_unit(std::string(trimmed(units[c - 1])), column.header, head_.log.notes);
    }
  }

  static bool is_blank_or_digit(char c) { return c == ' ' || (c >= '0' && c <= '9'); }

  /// "CH1", "Channel 2": a name that says nothing.
  static bool is_channel(const std::string& name) {
    constexpr std::array<std::string_view, 6> kWords{"ch", "chan", "channel", "signal", "trace", "kanal"};
    const auto word = std::find_if(name.begin(), name.end(), is_blank_or_digit);
    const std::string first = lower_case({name.begin(), word});
    return word != name.end() && std::find(kWords.begin(), kWords.end(), first) != kWords.end() &&
           std::all_of(word, name.end(), is_blank_or_digit);
  }

  /// "CH1: Feedback position [PUU]" above the table says what column CH1 is.
  [[nodiscard]] std::vector<std::string> with_legend(std::vector<std::string> headers) {
    std::size_t told = 0;
    for (std::string& header : headers) {
      const std::string name = unquoted(trimmed(header));
      const auto found = std::find_if(head_.log.metadata.begin(), head_.log.metadata.end(),
                                      [&](const auto& m) { return m.first == name; });
      if (found == head_.log.metadata.end() || !is_channel(name) || found->second.empty() ||
          looks_like_number(found->second))
        continue;
      header = found->second;
      ++told;
    }
    if (told > 0)
      note("the names of " + std::to_string(told) + " columns are those that the head gives them");
    return headers;
  }

  /// Units in the row below the names.
  void take_units(std::string_view& body) {
    leave_out_types(body);
    take_labview_units();
    const std::string_view row = first_row(body);
    const std::vector<std::string> units =
        units_in_row(row, head_.separator, head_.log.columns.size(), head_.log.notes);
    if (units.empty()) return;
    const std::size_t line = line_number(row.data());
    for (std::size_t c = 0; c < units.size(); ++c) {
      Column& column = head_.log.columns[c];
      if (units[c].empty()) continue;
      if (!column.unit_text.empty() && !column.unit_assumed && !same_unit(column.unit_text, units[c])) {
        fail(line, "column " + in_quotes(column.header) + ": the row of units says " + in_quotes(units[c]) +
                       ", the name " + in_quotes(column.unit_text) + " (correct the one that is wrong)");
      }
      if (column.unit_assumed && column.unit_text != units[c]) column.name = column.header;
      column.unit_text = units[c];
      column.unit_assumed = false;
    }
    body.remove_prefix(static_cast<std::size_t>(row.data() + row.size() - body.data()));
    note("the units are taken from the row below the names (line " + std::to_string(line) + ")");
  }

  void set_columns(const std::vector<std::string>& headers, std::size_t line) {
    if (headers.size() > kMaxColumns) {
      fail(line, "got " + std::to_string(headers.size()) + " columns, expected at most " +
                     std::to_string(kMaxColumns));
    }
    for (const auto& header : headers) {
      if (is_utf8(header)) continue;
      note("the names of the columns are not UTF-8 and are read as Windows-1252");
      break;
    }
    const bool slashes = all_have_unit_after_slash(headers);
    std::map<std::string, std::size_t> seen;
    for (std::size_t i = 0; i < headers.size(); ++i) {
      std::string header = as_utf8(unquoted(trimmed(headers[i])));
      if (header.empty()) {
        header = "column " + std::to_string(i + 1);
        note("column " + std::to_string(i + 1) + " has no name");
      }
      // "Time (s).1" is a second "Time (s)", as pandas numbers it.
      std::string copy = copy_number(header);
      const std::string original = header.substr(0, header.size() - copy.size());
      const bool bracket = original.ends_with(')') || original.ends_with(']');
      const bool second_time = copy.starts_with('.') && is_time_name(original);
      if (copy.empty() || !seen.contains(original) || !(bracket || second_time)) copy.clear();
      if (!copy.empty() && is_time_name(original)) header = original, copy.clear();
      const auto [hit, fresh] = seen.emplace(header, i);
      std::string again;  // behind a name that stands twice
      if (!fresh && is_time_name(header)) {
        again = " in column " + std::to_string(i + 1);
        head_.twice.emplace_back(header, header + again);
      } else if (!fresh) {
        fail(line, "column name " + in_quotes(header) + " stands twice, for columns " +
                       std::to_string(hit->second + 1) + " and " + std::to_string(i + 1) + " (rename one)");
      }
      const std::string split =
          with_unit_in_brackets(copy.empty() ? header : original, slashes, options_.unit_after_blank);
      head_.log.columns.push_back(column_of(split, head_.log.notes));
      head_.log.columns.back().header = header + again;
      head_.log.columns.back().name += copy + again;
    }
    // x_mm and x_um: what is left without the unit is no name.
    std::map<std::string, int> names;
    for (const auto& c : head_.log.columns) ++names[c.name];
    for (auto& c : head_.log.columns) {
      if (names[c.name] > 1) c.name = c.header;
    }
  }

  std::string_view all_;
  const CsvDialect& options_;
  CsvHead head_;
  std::optional<char> told_separator_;  ///< in the first line
};

}  // namespace

CsvHead read_csv_head(std::string_view& body, const std::string& source, const CsvDialect& dialect) {
  return HeadReader(body, source, dialect).read(body);
}

}  // namespace stribeck::io::detail
