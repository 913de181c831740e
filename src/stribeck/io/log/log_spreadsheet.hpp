#pragma once
/// What spreadsheets and drive tools put into CSV beside numbers: the separator in a line of its own, units in the
/// row below the names, a head above them, times of day, thousands separators.
/// Internal to io. Real time: no.

#include <optional>
#include <stribeck/io/log/log.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::io::detail {

/// The separator that a first line `sep=;` tells, as Excel writes it; the text moves behind it.
std::optional<char> take_separator_line(std::string_view& text);

/// First line of the text that is neither blank nor comment.
std::string_view first_row(std::string_view text);

/// The separator under which header and first row have the same number of cells; else one that both contain.
char best_separator(std::string_view header, std::string_view row);

/// Whether all cells are numbers, whatever separates them.
bool is_data(std::string_view line);

/// Takes the lines of a head above the names of the columns ("Model,X1", "Sampling interval;1000;us"), which become metadata, and
/// returns their number: 0 where the first line has the names, or where no table of equal rows is found.
std::size_t take_head(std::string_view& text, std::vector<std::pair<std::string, std::string>>& metadata);

/// 1 for each column whose cells are blank in the first hundred rows.
std::vector<char> blank_columns(std::string_view body, char separator, std::size_t columns);

/// The row behind the last line end; it leaves the text. It may be cut inside a number: 12.5 would be read as 12.
std::string_view take_unended_row(std::string_view& body);

/// A comma is the decimal mark where cells of the first hundred lines hold commas, words and times of day aside, and the separator is
/// another; also further below where no number has a point.
char decimal_mark(std::string_view body, char separator);

/// "1.234,5", "1,234.5", "1'234.5" or "1 234.5": points, commas, apostrophes or blanks, also narrow ones that do not break a line,
/// between groups of three digits in front of the decimal mark. Without the decimal mark "1.234" may be 1.234, and is none; "1 234" is.
std::optional<double> grouped_number(std::string_view cell, char decimal);

/// Whether a comment holds the names of the columns of the row below it: as many cells, half of them numbers. ROS writes "%time,…".
bool names_in_comment(std::string_view comment, std::string_view row);

/// Ends each part of the head of a measurement file of LabVIEW.
constexpr std::string_view kEndOfLabViewHead = "***End_of_Header***";

/// Names of a table of TwinCAT with names only, "Name;ActPos;Name;ActTorque": a time in ms, or in ticks since 1601, stands beside each
/// signal. Nothing for other tables.
std::optional<std::vector<std::string>> twincat_pairs(const std::vector<std::string_view>& names,
                                                      const std::vector<std::string_view>& row, Notes& notes);

/// The names of the columns in a line. Where that is a title with blank cells behind it, the names are in the row below, which leaves
/// the text. Merged cells, "Axis Z;;;Axis X", are the first words of the names below them; they are in this line, or in the line `above`
/// it where a name stands twice.
std::vector<std::string> names_of_columns(std::string_view header, std::string_view above, char separator,
                                          std::string_view& body, Notes& notes);

/// The text with each name of a column that spreadsheets break into lines, in quotes, in one line; the lines below keep their numbers. ""
/// where no name is broken.
std::string with_names_in_one_line(std::string_view text);

/// Whether a column may stand twice: tables that a tool joined have a time each.
bool is_time_name(const std::string& header);
/// Leaves out a column of times that are those of another one; false where they differ.
bool drop_same_times(Log& log, const std::string& first, const std::string& again);

/// "# key: value" becomes metadata.
void take_comment(std::string_view line, std::vector<std::pair<std::string, std::string>>& metadata);

/// Columns whose cells are blank in every row go.
void drop_blank_columns(Log& log);

/// Whether a line and all that follow it are no rows: at most twenty, each with words in its first cell ("Min,…").
bool below_the_table(std::string_view rest, char separator);

/// Units in the row below the names, one for each column, "" where it has none; nothing where the row is another one.
std::vector<std::string> units_in_row(std::string_view row, char separator, std::size_t columns,
                                      Notes& notes);

/// Whether all cells of a row that are not blank are types of data: "LREAL", "S32", "float".
bool is_row_of_types(std::string_view row, char separator);

/// What to add where a cell is no number: decimal sign, or a date that a spreadsheet made of it; "" for others.
const char* why_no_number(std::string_view cell, char decimal);

/// What to say of a table whose cells are all text; `row` is one of its rows.
const char* why_no_numbers(const std::vector<std::string_view>& row, char separator);

/// Seconds since midnight of `07:15:23.123`, also with a date before and a zone behind, which are not looked at.
std::optional<double> time_of_day(std::string_view text);

/// Seconds of `01:02.5`, minutes and seconds as a spreadsheet shows short times; without the decimals it may be a time of day.
std::optional<double> minutes_and_seconds(std::string_view text);

/// Seconds of `0.002 sec`, as MATLAB writes a duration, of `0 days 00:00:00.002000`, as pandas does, and of `T#1s5ms` (IEC 61131-3).
std::optional<double> duration(std::string_view text);

/// Seconds of `25:07:15.123`, hours that go on after 24.
std::optional<double> hours_minutes_and_seconds(std::string_view text);

/// Seconds of `T#1s5ms`, `LTIME#1m_30s`: a duration of IEC 61131-3.
std::optional<double> iec_duration(std::string_view text);

/// Whether a text is one of these times.
bool is_time_text(std::string_view text);

/// A date and time of IEC 61131-3 without its type and date: `07:15:23.123` of `DT#2026-11-29-07:15:23.123` and of `TOD#07:15:23.123`;
/// another text as it is.
std::string_view without_iec_date(std::string_view text);

/// Milliseconds without leading zeros behind `;` or a third colon, `07:15:23;5`, get three digits where other cells have three.
void fill_milliseconds(std::vector<std::string>& texts);

/// Makes a column of times of day, durations, or of minutes and seconds, one of seconds since its first row; false where a cell is none, or
/// where the last is the first.
/// Past midnight, or a full hour, it goes on.
bool read_times_of_day(Column& column);

}  // namespace stribeck::io::detail
