#pragma once
/// Common parts of the readers of log formats: lines, cells, numbers, units, rows, channels of different rates.
/// Internal to io. Real time: no. Errors: InputError.

#include <cstddef>
#include <optional>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::io::detail {

/// More columns than any log has: a hostile header must not fill the memory.
inline constexpr std::size_t kMaxColumns = 10000;

constexpr bool is_blank(char c) { return c == ' ' || c == '\t'; }
constexpr bool is_comment(std::string_view line) {
  return !line.empty() && (line[0] == '#' || line[0] == '%');
}
std::string_view trimmed(std::string_view s);
/// Position behind s if text begins with it, ignoring case; otherwise 0.
bool begins_with(std::string_view text, std::string_view s);

/// Returns the line at the start of text, without its line end, and removes it from text.
std::string_view take_line(std::string_view& text);

/// Cells of a line. Quotes protect separators. With blanks as separator, units in brackets belong to the name
/// before, and several blanks count as one.
std::vector<std::string_view> split(std::string_view line, char separator);
/// The last line of a text that is not blank and no comment; "" where there is none.
std::string_view last_line(std::string_view text);
/// Every separator outside quotes ends a cell, also at the end of the line.
std::vector<std::string_view> split_exactly(std::string_view line, char separator);
std::string unquoted(std::string_view cell);

/// Text that is not UTF-8 is read as Windows-1252, in which older Windows programs write µ, °, ‰ and a dash for a minus.
bool is_utf8(std::string_view in);
std::string as_utf8(std::string_view in);

/// A cell as a number; the slow and complete form, which accepts quotes and a leading +.
std::optional<double> cell_number(std::string_view cell, char decimal);
bool looks_like_number(std::string_view cell);

/// Splits a CSV header into name and unit.
Column column_of(std::string header, Notes& notes);
/// "x mm" → "x [mm]"; a text with brackets is unchanged.
std::string header_of(const std::string& name);

/// "s_ist/mm" → "s_ist [mm]", as ISO 80000-1 writes quantities in the heads of tables; absent where no unit stands behind a slash.
std::optional<std::string> name_with_unit_after_slash(std::string_view header);
bool all_have_unit_after_slash(const std::vector<std::string>& headers);

/// "x mm" and "x/mm" with the unit in brackets, where the names are written so.
std::string with_unit_in_brackets(const std::string& header, bool slashes, bool after_blank);

/// "Nm" and "N m" are the same.
bool same_unit(const std::string& a, const std::string& b);

/// A unit as controls spell it ("Ampere", "U/min", "Incr", "dV (Voltage)"), in a spelling that units.hpp knows;
/// "" and a note when there is none.
std::string plain_unit(std::string_view text, std::string_view column, Notes& notes);

/// Whether the text starts with a byte order mark of UTF-16.
bool is_utf16(std::string_view bytes);
/// Converts UTF-16 (with byte order mark) to UTF-8 without a mark. Refuses text that ends inside a character.
std::string from_utf16(std::string_view bytes, const std::string& source);

/// Text in the code page of Windows in Japan or in China.
struct EastAsianText {
  std::string encoding;  ///< for a note
  std::string utf8;
};
/// Found by the first 16 kB; nothing for UTF-8, for what may be Latin-1, and for what cannot be converted. In Shift-JIS the second
/// byte of a letter may be that of a bracket or a bar, so it is converted before it is cut into cells.
std::optional<EastAsianText> from_east_asian(std::string_view bytes);

/// Refuses content that is no text: empty, archives, NUL bytes.
void check_text(std::string_view bytes, const std::string& source);

/// The same for control characters; too slow for a large table, where control characters fail as numbers anyway.
void check_no_control_characters(std::string_view text, const std::string& source);

/// Inflates gzip data, also of several members; limited in size.
std::string inflated(std::string_view bytes, const std::string& source);

/// Numbers the columns of equal name, with a note.
void make_names_unique(Log& log);

/// Reads a text line by line.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  bool next() {
    if (rest_.empty()) return false;
    const std::size_t before = rest_.size();
    text_ = take_line(rest_);
    // Only a line with a line end is shorter than the text it took.
    ended_ = before - rest_.size() > text_.size();
    ++number_;
    return true;
  }
  [[nodiscard]] std::string_view text() const { return text_; }
  [[nodiscard]] std::size_t number() const { return number_; }  ///< counted from 1
  [[nodiscard]] bool ended() const { return ended_; }  ///< has a line end: was not cut by the end of the file
  [[nodiscard]] bool last() const { return trimmed(rest_).empty(); }

 private:
  std::string_view text_;
  std::string_view rest_;
  std::size_t number_ = 0;
  bool ended_ = true;
};

/// Common base of all readers: the place in the file, and messages.
class Reader {
 protected:
  Reader(std::string_view text, const std::string& source, std::string format) : lines_(text) {
    check_no_control_characters(text, source);
    log_.source = source;
    log_.format = std::move(format);
  }

  [[noreturn]] void fail(std::size_t line, std::string message) const;
  void note(std::string text, Note::About about = Note::About::kOther) {
    log_.notes.emplace_back(std::move(text), about);
  }
  void add_metadata(std::string_view key, std::string_view value);
  /// Non-negative integer behind a key; empty where there is none.
  static std::optional<std::size_t> count(std::string_view text);

  /// Cell of row `row` (from 1) as a finite number. The first decimal mark of a column is its mark; a column
  /// that mixes point and comma is refused, because one of them would be read wrongly.
  double number(std::string_view cell, std::size_t row, std::size_t column, std::string_view name);
  /// The same, but blank and "nan" are NaN: absent.
  double number_or_absent(std::string_view cell, std::size_t row, std::size_t column, std::string_view name);

  /// Whether the end of the file may have cut the last row; adds a note.
  bool cut(std::size_t row);

  /// Reads rows of as many cells as the log has columns, to the end of the text.
  void read_table(char separator);

  /// Refuses a log of fewer than two rows.
  void finish();

  Lines lines_;
  Log log_;

 private:
  std::vector<char> marks_;
};

/// Channels that share their sampling times. NaN marks an absent sample.
struct Group {
  std::vector<double> t;
  std::vector<Column> channels;
};

/// Columns of groups: the time of each (shared where equal), then its channels. Absent samples are left out; such a channel then
/// has its own times.
void add_groups(Log& log, std::vector<Group> groups, const std::string& time_unit);

/// Notes on gaps and jitter of the time columns; throws on a time that does not increase.
void note_times(Log& log);

/// A column of whole numbers that increase and is called index, sample, …; null: there is none.
/// With `of_control` also one of control periods ("IPO_Cycle"), which a time between rows would not count.
const Column* row_counter(const Log& log, bool of_control);
/// Times from a counter. It may count several for each row, as the cycles of a drive that writes every fourth.
struct CountedTimes {
  std::vector<double> t;  ///< [s]
  double per_row = 1.0;   ///< the middle one of all steps
  bool even = true;       ///< the rows stand where they would without the counter
  std::string text;       ///< how the time follows from it
};
/// `period` [s]: of one count or, with `of_rows`, of one row.
CountedTimes times_of_counter(const Column& counter, double period, bool of_rows);
/// A column whose name says that it is the time, in a unit that is not known ("Time [100ns]"); null: there is none.
const Column* time_of_unknown_unit(const Log& log);

/// "Time 1, x, Time 2, f": a table in which each signal has a time of its own before it, at rates that differ. The columns get their times;
/// false for other tables, and where all times are the same.
bool pair_times(Log& log);

/// Blank, or one of the words that tools write where there is no number: nan, n/a, null, none.
bool is_absent(std::string_view cell);
/// The samples of a channel that are not absent (NaN), with their times.
struct Samples {
  std::vector<double> t;
  std::vector<double> values;
};
Samples present(const std::vector<double>& t, const std::vector<double>& values);
/// Leaves out absent samples (NaN) of a table whose times are in column `time`, with notes. A column in which few are absent loses
/// nothing else than these rows, of the whole table: the time has gaps there. A column in which more are absent has times of its own:
/// tools that join channels of different rates write blank cells between. Throws `first` where there is no time (−1).
void leave_out_absent(Log& log, int time, const Problem& first);

/// Seconds (of a number, or of a clock) and their fraction in two columns become one time, with a note; false where a table has no such
/// pair. A sample time that was given (`given`) is not used then.
bool join_seconds(Log& log, bool given);
/// Beside "position[0]", "position[1]" has an index and not the unit 1.
void tell_indices(Log& log);

/// Signals of an ODrive without units get those of its documentation (turns, A, N m), with a note.
void tell_odrive_units(Log& log);

/// A time column without a unit whose numbers can only be times since 1970 in one unit gets it, with a note.
void tell_epoch(Log& log);
/// A time column without a unit whose rows follow each other as those of a drive's log do in one unit alone (15 us to 1 s; with the
/// control period [s] as many of these as up to twenty) gets it, with a note. Numbers of rows get none.
void tell_unit_of_time(Log& log, std::optional<double> control_period);

/// What the head of a file says of the sampling: "Sampling interval: 1000;us".
struct ToldSampling {
  std::string text;  ///< for a message; "" where the head says nothing
  std::optional<double>
      period;  ///< the time between rows [s]; absent where no line, or two that differ, tell one
};
/// A line tells a period by a time or a rate with its unit: "Sample rate: 8 kHz", "Sampling time[us]: 125".
ToldSampling told_sampling(const Log& log);

/// Leaves out a time column whose stamps stand still in more than a twentieth of the rows; for logs whose sample time is given.
bool leave_out_coarse_time(Log& log);

/// Adds a column t in front, computed from the index of the row; `note` explains it.
void add_time(Log& log, std::vector<double> values, const std::string& unit);

}  // namespace stribeck::io::detail
