#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/decimal_sign.hpp>
#include <stribeck/io/log/head/table_rows.hpp>
#include <stribeck/io/log/log_csv_head.hpp>
#include <stribeck/io/log/log_formats.hpp>
#include <stribeck/io/log/log_spreadsheet.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <utility>

namespace stribeck::io::detail {
namespace {

/// Parses one text.
class CsvReader {
 public:
  CsvReader(std::string_view bytes, std::string source, const CsvDialect& options, AbsentCells* absent)
      : all_(bytes), options_(options), absent_(absent) {
    log_.source = std::move(source);
  }

  Log read() {
    check_text(all_, log_.source);
    std::string_view body = all_;
    CsvHead head = read_csv_head(body, log_.source, options_);
    log_ = std::move(head.log);
    separator_ = head.separator;
    decimal_ = head.decimal;
    header_ = head.header;
    const std::string_view unended = options_.drop_unended_row ? take_unended_row(body) : std::string_view();
    if (options_.text_columns != TextColumns::kRefuse) find_text_columns(body);
    if (separator_ == ' ') {
      read_rows<true>(body);
    } else {
      read_rows<false>(body);
    }
    drop_absent_end();
    refuse_thousands(body);
    if (options_.text_columns == TextColumns::kKeep) {
      keep_text_columns();
    } else {
      drop_text_columns();
    }
    for (const auto& [what, count] : left_out_) note(what + " were left out: " + std::to_string(count));
    for (const auto& [first, again] : head.twice) {
      if (drop_same_times(log_, first, again)) continue;
      if (options_.text_columns != TextColumns::kKeep || !pair_times(log_))
        fail(0, "columns " + in_quotes(first) + " and " + in_quotes(again) +
                    " hold different times (rename one)");
    }
    if (!unended.empty()) {
      note("the last row (row " + std::to_string(log_.rows + 1) + ", line " +
           std::to_string(line_number(unended.data())) +
           ") was left out: it has no line end and may be cut off");
    }
    set_decimal_sign(log_, decimal_);
    if (log_.rows < 2) {
      fail(0, log_.rows == 0 ? "has a header but no data rows, expected at least two"
                             : "has one data row, expected at least two");
    }
    return std::move(log_);
  }

 private:
  [[noreturn]] void fail(std::size_t line, std::string message) const {
    throw InputError(Problem{log_.source, line, "", std::move(message)});
  }
  void note(std::string text) { log_.notes.push_back(std::move(text)); }

  [[nodiscard]] std::size_t line_number(const char* at) const {
    return 1 + static_cast<std::size_t>(std::count(all_.data(), at, '\n'));
  }

  void find_text_columns(std::string_view body) {
    const std::string_view row = row_of_table(body, separator_, log_.columns.size());
    hash_first_ = is_comment(row) && !is_row_with_hash(row, separator_, log_.columns.size(), false);
    auto cells = split(row, separator_);
    if (cells.size() + 1 == log_.columns.size() && separator_ != ' ' && row.ends_with(separator_))
      cells.emplace_back();
    if (cells.size() != log_.columns.size()) return;
    is_text_ = blank_columns(body, separator_, cells.size());
    if (absent_ != nullptr && std::any_of(cells.begin(), cells.end(), is_absent))
      cells = first_present_cells(body, separator_, cells.size());
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const std::string_view cell = cells[c];
      if (!unquoted(cell).empty() && !number_in(cell)) is_text_[c] = 1;
    }
    if (std::count(is_text_.begin(), is_text_.end(), 1) == 0) is_text_.clear();
    row_texts_.resize(is_text_.size());
  }

  /// A cell as a number, also with thousands separators before the decimal mark.
  [[nodiscard]] std::optional<double> number_in(std::string_view cell) const {
    const auto value = cell_number(cell, decimal_);
    return value ? value : grouped_number(cell, decimal_);
  }

  void drop_text_columns() {
    for (std::size_t c = is_text_.size(); c-- > 0;) {
      if (is_text_[c] == 0) continue;
      note("column " + in_quotes(log_.columns[c].header) + " was left out: it holds text");
      log_.columns.erase(log_.columns.begin() + static_cast<std::ptrdiff_t>(c));
    }
    if (log_.columns.empty()) fail(0, "has no column of numbers");
  }

  /// Rows of figures below those of a column of times ("Min", "Max") are no rows of the log.
  void drop_figures_below(std::size_t clock) {
    constexpr std::size_t kMost = 8;
    const std::vector<std::string>& times = log_.columns[clock].texts;
    std::size_t rows = times.size();
    while (rows > 0 && times.size() - rows <= kMost && !time_of_day(times[rows - 1])) --rows;
    const std::size_t below = times.size() - rows;
    if (below == 0 || below > kMost || rows < 2 || trimmed(times[rows]).empty()) return;
    const auto end = times.begin() + static_cast<std::ptrdiff_t>(rows);
    if (!std::all_of(times.begin(), end, [](const std::string& t) { return time_of_day(t).has_value(); }))
      return;
    const std::string first = times[rows];
    log_.rows = rows;
    for (Column& column : log_.columns) {
      if (column.values.size() == rows + below) column.values.resize(rows);
      if (column.texts.size() == rows + below) column.texts.resize(rows);
    }
    note(std::to_string(below) + " rows from " + in_quotes(as_utf8(first)) +
         " on below the times were left out");
  }

  /// Times of day become seconds where no other column tells the time.
  void read_clock() {
    for (std::size_t c = 0; c < is_text_.size() && time_column(log_) < 0; ++c) {
      if (is_text_[c] == 0) continue;
      drop_figures_below(c);
      if (!read_times_of_day(log_.columns[c])) continue;
      is_text_[c] = 0;
      note("column " + in_quotes(log_.columns[c].header) +
           " holds times of day; taken as seconds since its first row");
    }
  }

  /// A column is text by its first cell; one damaged cell must not turn numbers into text.
  void keep_text_columns() {
    read_clock();
    bool utf8 = true;
    std::size_t kept = 0;
    for (std::size_t c = 0; c < is_text_.size(); ++c) {
      if (is_text_[c] == 0) continue;
      ++kept;
      auto& column = log_.columns[c];
      if (column.texts.empty()) continue;
      const auto numbers =
          std::count_if(column.texts.begin(), column.texts.end(),
                        [&](const std::string& text) { return cell_number(text, decimal_).has_value(); });
      if (2 * static_cast<std::size_t>(numbers) >= column.texts.size()) {
        const auto wrong = std::find_if(column.texts.begin(), column.texts.end(), [&](const auto& text) {
          return !unquoted(text).empty() && !cell_number(text, decimal_).has_value();
        });
        const auto first = wrong == column.texts.end() ? column.texts.begin() : wrong;
        fail(0, "row " + std::to_string(first - column.texts.begin() + 1) + ", column " +
                    in_quotes(column.header) + ": got " + in_quotes(as_utf8(*first)) +
                    ", expected a number as in " + std::to_string(numbers) + " other rows");
      }
      for (auto& text : column.texts) {
        if (std::any_of(text.begin(), text.end(), [](unsigned char ch) { return ch < 0x20; })) {
          fail(0, "column " + in_quotes(column.header) + ": the text " + in_quotes(text) +
                      " holds a control character: damaged, or not a text file");
        }
        if (is_utf8(text)) continue;
        text = as_utf8(text);
        utf8 = false;
      }
    }
    if (!utf8) note("text cells are not UTF-8 and are read as Latin-1");
    if (kept == log_.columns.size()) fail(0, why_no_numbers(row_texts_, separator_));
    drop_blank_columns(log_);
  }

  /// A thousands separator that was taken for the decimal mark makes numbers a thousand times too small, beside others that are right.
  void refuse_thousands(std::string_view body) const {
    for (std::size_t c = 0; c < log_.columns.size(); ++c) {
      const Column& column = log_.columns[c];
      const auto cell = maybe_thousands(column.values, body, separator_, c, decimal_);
      if (!cell) continue;
      if (proves_mark(body, separator_, decimal_)) return;
      std::string without = *cell;
      std::erase(without, decimal_);
      fail(
          0,
          "column " + in_quotes(column.header) + ": got " + in_quotes(*cell) + ", which may be " + without +
              " or have three decimals: all numbers without " + (decimal_ == ',' ? "a comma" : "a point") +
              " are below 1000 (export the log without thousands separators, or with three decimals in each row)");
    }
  }

  /// Reserves memory, estimated from the length of the first lines.
  void reserve(std::string_view body) {
    const auto sample = body.substr(0, 1 << 16);
    const auto lines = std::max<std::ptrdiff_t>(1, std::count(sample.begin(), sample.end(), '\n'));
    const double rows =
        static_cast<double>(body.size()) / static_cast<double>(sample.size()) * static_cast<double>(lines);
    for (std::size_t c = 0; c < log_.columns.size(); ++c) {
      if (is_text_.empty() || is_text_[c] == 0)
        log_.columns[c].values.reserve(static_cast<std::size_t>(rows * 1.05) + 16);
    }
  }

  /// Skips a comment or a blank line; returns the beginning of the next line, or null when this one is a row.
  const char* after_line_without_row(const char* p, const char* end) {
    const char* const next = end_of_line(p, end);
    std::string_view line(p, static_cast<std::size_t>(next - p));
    if (line.ends_with('\r')) line.remove_suffix(1);
    // A row without its time of day is left out.
    const bool text_first = !is_text_.empty() && is_text_[0] != 0;
    if ((hash_first_ || !text_first) && is_row_with_hash(line, separator_, log_.columns.size(), hash_first_))
      return nullptr;
    if (*p == '#' || *p == '%') take_comment(line, log_.metadata);
    if (!trimmed(line).empty() && *p == '\r') return nullptr;
    return next == end ? end : next + 1;
  }

  template <bool kBlankSeparated>
  void read_rows(std::string_view body) {
    if (body.empty()) return;
    reserve(body);
    const std::size_t n = log_.columns.size();
    // Rows are collected in a block that stays in the cache, then copied column by column.
    const std::size_t block_rows = std::max<std::size_t>(16, 16384 / n);
    std::vector<double> block(n * block_rows);
    std::size_t filled = 0;
    const auto flush = [&] {
      for (std::size_t c = 0; c < n; ++c) {
        if (!is_text_.empty() && is_text_[c] != 0) continue;
        const double* from = block.data() + c * block_rows;
        log_.columns[c].values.insert(log_.columns[c].values.end(), from, from + filled);
      }
      filled = 0;
    };

    const fast_float::parse_options number_format{fast_float::chars_format::general, decimal_};
    const char separator = separator_;
    const char* const is_text = is_text_.empty() ? nullptr : is_text_.data();
    const char* p = body.data();
    const char* const end = p + body.size();
    while (p != end) {
      const char* const line = p;
      if (*p == '\n' || *p == '\r' || *p == '#' || *p == '%' || (*p == '/' && p + 1 != end && p[1] == '/')) {
        if (const char* const next = after_line_without_row(p, end); next != nullptr) {
          p = next;
          continue;
        }
      }
      double* out = block.data() + filled;
      std::size_t column = 0;
      while (true) {
        while (p != end && (*p == ' ' || (kBlankSeparated && *p == '\t'))) ++p;
        const char* after = p;
        if (is_text != nullptr && is_text[column] != 0) {
          after = end_of_text<kBlankSeparated>(p, end);
          if (after == nullptr) break;
          row_texts_[column] = {p, static_cast<std::size_t>(after - p)};
        } else {
          const auto parsed = fast_float::from_chars_advanced(p, end, *out, number_format);
          if (parsed.ec != std::errc() || !std::isfinite(*out)) break;
          after = parsed.ptr;
        }
        const char* q = after;
        while (q != end && (*q == ' ' || (kBlankSeparated && *q == '\t'))) ++q;
        if (++column < n) {
          if (kBlankSeparated) {
            if (q == after) break;
          } else {
            if (q == end || *q != separator) break;
            ++q;
          }
          p = q;
          out += block_rows;
          continue;
        }
        if (!kBlankSeparated && q != end && *q == separator) {  // separator at the end of the line
          for (++q; q != end && *q == ' ';) ++q;
        }
        if (q != end && *q == '\r') ++q;
        if (q != end && *q != '\n') break;
        p = q;
        column = n + 1;
        break;
      }
      if (column != n + 1) {
        const auto rest = slow_row(line, end, block.data() + filled, block_rows, log_.rows + 1);
        p = rest.next;
        if (!rest.is_row) continue;
      }
      if (is_text != nullptr && options_.text_columns == TextColumns::kKeep) keep_row_texts();
      ++log_.rows;
      if (p != end) ++p;
      if (++filled == block_rows) flush();
    }
    flush();
  }

  void keep_row_texts() {
    for (std::size_t c = 0; c < is_text_.size(); ++c) {
      if (is_text_[c] != 0) log_.columns[c].texts.push_back(unquoted(trimmed(row_texts_[c])));
    }
  }

  /// End of an unquoted text cell; null where the slow path has to parse.
  template <bool kBlankSeparated>
  const char* end_of_text(const char* p, const char* end) const {
    for (; p != end && *p != separator_ && *p != '\n' && *p != '\r'; ++p) {
      if (*p == '"') return nullptr;
      if (kBlankSeparated && *p == '\t') break;
    }
    return p;
  }

  static const char* end_of_line(const char* p, const char* end) {
    const void* hit = std::memchr(p, '\n', static_cast<std::size_t>(end - p));
    return hit == nullptr ? end : static_cast<const char*>(hit);
  }

  struct SlowRow {
    const char* next;  ///< end of the line for a row, behind it for a line that was left out
    bool is_row;
  };

  /// What to say of a cell without a number where it cannot be left out.
  [[nodiscard]] Problem absent_cell(std::size_t line, const std::string& place, std::string_view cell) const {
    const std::string got = unquoted(cell).empty() ? "the cell is blank" : "got " + in_quotes(trimmed(cell));
    return Problem{log_.source, line, "", place + got + ", expected a number (remove the row or the column)"};
  }

  /// Whether a row of separators alone takes its time: no column tells the time, and rows follow each other at equal times.
  [[nodiscard]] bool is_absent_row(std::string_view line) {
    if (!options_.keep_blank_rows || absent_ == nullptr || log_.rows == 0 || separator_ == ' ' ||
        line.find(separator_) == std::string_view::npos)
      return false;
    if (no_times_) return *no_times_;
    const bool clock = std::any_of(log_.columns.begin(), log_.columns.end(), [](const Column& column) {
      if (column.texts.empty()) return false;
      return is_time_text(column.texts.front());
    });
    no_times_ = !clock && time_column(log_) < 0;
    return *no_times_;
  }

  void take_absent_row(const char* start, double* out, std::size_t stride, std::size_t row) {
    if (absent_rows_ == 0)
      first_absent_row_ = absent_cell(line_number(start), "row " + std::to_string(row) + ": ", "");
    ++absent_rows_;
    absent_together_ = row == last_absent_row_ + 1 ? absent_together_ + 1 : 1;
    last_absent_row_ = row;
    for (std::size_t c = 0; c < log_.columns.size(); ++c)
      out[c * stride] = std::numeric_limits<double>::quiet_NaN();
    std::fill(row_texts_.begin(), row_texts_.end(), std::string_view());
  }

  /// Rows of separators alone at the end of the file are none of the log.
  void drop_absent_end() {
    const std::size_t at_end = last_absent_row_ == log_.rows ? absent_together_ : 0;
    if (absent_rows_ > at_end && !absent_->first) absent_->first = first_absent_row_;
    if (at_end == 0) return;
    log_.rows -= at_end;
    left_out_["lines without any value"] += at_end;
    for (Column& column : log_.columns) {
      if (!column.values.empty()) column.values.resize(log_.rows);
      if (!column.texts.empty()) column.texts.resize(log_.rows);
    }
  }

  [[noreturn]] void wrong_width(std::size_t line, const std::string& where,
                                const std::vector<std::string_view>& cells) const {
    const std::size_t n = log_.columns.size();
    if (cells.front() == "Channels") {
      fail(
          line,
          where +
              ": a segment of LabVIEW begins here (write each segment into a file of its own, or with one heading for all)");
    }
    fail(line, where + ": got " + std::to_string(cells.size()) + (cells.size() == 1 ? " cell" : " cells") +
                   ", expected " + std::to_string(n) + " as in the header" +
                   (separator_ == ',' && n > 1 && cells.size() == 2 * n
                        ? " (a decimal comma? separate columns by ;)"
                        : ""));
  }

  /// A row that the fast loop could not read: quotes, plus signs, or an error.
  SlowRow slow_row(const char* start, const char* end, double* out, std::size_t stride, std::size_t row) {
    const char* const line_end = end_of_line(start, end);
    const SlowRow skip{line_end == end ? end : line_end + 1, false};
    const std::string_view line = trimmed({start, static_cast<std::size_t>(line_end - start)});
    const std::size_t n = log_.columns.size();
    if (std::all_of(line.begin(), line.end(),
                    [&](char c) { return c == separator_ || is_blank(c) || c == '"'; })) {
      if (is_absent_row({start, static_cast<std::size_t>(line_end - start)})) {
        take_absent_row(start, out, stride, row);
        return {line_end, true};
      }
      if (!line.empty()) ++left_out_["lines without any value"];
      return skip;
    }
    if (line == header_) {
      ++left_out_["lines that repeat the names of the columns"];
      return skip;
    }
    if ((is_text_.empty() || is_text_[0] == 0) &&
        below_the_table({start, static_cast<std::size_t>(end - start)}, separator_)) {
      ++left_out_["lines of text below the table"];
      return skip;
    }
    // A leading separator stands for an empty cell and stays; only blanks around the line are removed.
    std::string_view raw = line;
    if (separator_ == '\t') {
      raw = {start, static_cast<std::size_t>(line_end - start)};
      if (raw.ends_with('\r')) raw.remove_suffix(1);
    }
    auto cells = split(raw, separator_);
    const bool last = trimmed({line_end, static_cast<std::size_t>(end - line_end)}).empty();
    const bool cut = last && line_end == end;
    const std::string where = "row " + std::to_string(row);
    // Counted only for a message: quoted files come here with every row.
    const auto line_no = [&] { return line_number(start); };
    if (cells.size() + 1 == n && separator_ != ' ' && raw.ends_with(separator_) && !cut) cells.emplace_back();
    if (cells.size() < n && last) {
      note("the last row (" + where + ", line " + std::to_string(line_no()) + ") was left out: it has " +
           std::to_string(cells.size()) + " of " + std::to_string(n) + " cells");
      return skip;
    }
    const bool segment = cells.front() == "Channels" && (is_text_.empty() || is_text_[0] == 0);
    if (cells.size() != n || segment) wrong_width(line_no(), where, cells);
    for (std::size_t c = 0; c < n; ++c) {
      if (!is_text_.empty() && is_text_[c] != 0) {
        row_texts_[c] = cells[c];
        continue;
      }
      const auto value = number_in(cells[c]);
      if (value && std::isfinite(*value)) {
        out[c * stride] = *value;
        continue;
      }
      if (cut && c + 1 == n && !value) {
        note("the last row (" + where + ", line " + std::to_string(line_no()) +
             ") was left out: it is cut off");
        return skip;
      }
      const std::string place = where + ", column " + in_quotes(log_.columns[c].header) + ": ";
      if (absent_ != nullptr && is_absent(cells[c])) {
        out[c * stride] = std::numeric_limits<double>::quiet_NaN();
        if (!absent_->first) absent_->first = absent_cell(line_no(), place, cells[c]);
        continue;
      }
      if (value)
        fail(line_no(), place + "got " + in_quotes(trimmed(cells[c])) + ", expected a finite number");
      if (unquoted(cells[c]).empty()) {
        fail(line_no(), place + "the cell is blank, expected a number (remove the row or the column)");
      }
      fail(line_no(), place + "got " + in_quotes(as_utf8(trimmed(cells[c]))) + ", expected a number" +
                          why_no_number(cells[c], decimal_));
    }
    return {line_end, true};
  }

  std::string_view all_;
  const CsvDialect& options_;
  AbsentCells* absent_;  ///< null: absent cells are refused
  Log log_;
  char separator_ = ',';
  char decimal_ = '.';
  std::vector<char> is_text_;  ///< 1 for columns of text; empty when there are none
  bool hash_first_ = false;    ///< the first column is of text that begins with #
  std::vector<std::string_view> row_texts_;
  std::string_view header_;
  std::optional<bool> no_times_;     ///< no column tells the time; absent: not asked yet
  std::size_t absent_rows_ = 0;      ///< rows of separators alone that take their time
  std::size_t last_absent_row_ = 0;  ///< counted from 1
  std::size_t absent_together_ = 0;  ///< so many up to it, without another row between
  Problem first_absent_row_;
  std::map<std::string, std::size_t> left_out_;  ///< lines, by what they are
};

}  // namespace

Log read_csv_text(std::string_view text, const std::string& source, const CsvDialect& dialect,
                  AbsentCells* absent) {
  const std::string joined = with_names_in_one_line(text);
  return CsvReader(joined.empty() ? text : joined, source, dialect, absent).read();
}

}  // namespace stribeck::io::detail
