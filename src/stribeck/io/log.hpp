#pragma once
/// Logs: columns of numbers from CSV text, plain or gzip.
///
/// Found by itself: the separator (, ; tab blank), the decimal mark (comma when the separator leaves it
/// free), quotes, UTF-8 mark, line ends, comment lines (# or %; `# key: value` is metadata), a header in a
/// comment as some numeric programs write it. Units stand in the header as `x [mm]`, `x (mm)` or `x_mm`; a
/// column without one has unit_text "" and in_si refuses it: units are not guessed. Values stay in the unit
/// of the file.
///
/// Refused, with FILE:LINE, row and column: text, blank, NaN or infinite cells, rows with fewer or more cells
/// than the header, duplicate names, files that are no text. Repaired, with a note: a cut last row is
/// dropped. Rows are counted from 1 below the header; LINE is the line of the file.
/// Real time: no. Errors:
/// InputError.

#include <cstddef>
#include <stribeck/core/fields.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::io {

struct Column {
  std::string name;       ///< header without its unit
  std::string unit_text;  ///< as in the file, "1" for a pure number, "" where none is given
  std::vector<double> values;
  std::string header = {};  ///< as in the file
};

struct Log {
  std::string source;  ///< file, for messages
  std::vector<Column> columns;
  std::size_t rows = 0;
  std::vector<std::string> notes;  ///< what was repaired or left out, one sentence each
  std::vector<std::pair<std::string, std::string>> metadata;

  /// By header as in the file, else by name; null when there is none.
  [[nodiscard]] const Column* find(std::string_view name) const;
  /// The same; throws with the columns that are there.
  [[nodiscard]] const Column& at(std::string_view name) const;
};

struct CsvOptions {
  std::size_t skip_lines = 0;        ///< lines before the header
  std::vector<std::string> names{};  ///< headers to use when the file has none: the first row is data
  /// Columns that begin with text (names of runs, phases of a programme) are left out with a note instead of
  /// refused.
  bool leave_out_text_columns = false;
};

Log read_csv(const std::string& path, const CsvOptions& options = {});
/// The same from bytes (gzip too); `source` is for messages.
Log parse_csv(std::string_view bytes, const std::string& source, const CsvOptions& options = {});

/// The values in the SI unit of the quantity. Throws when the column has no unit or one of another dimension.
std::vector<double> in_si(const Column& column, const Quantity& quantity);

/// Writes `name [unit]` headers and numbers that read back bit for bit; metadata as `# key: value`.
void write_csv(const std::string& path, const Log& log);
std::string csv_text(const Log& log);

/// How regular a time column is. Steps longer than 1.5 samples are gaps; the others may differ from the
/// sample time by kJitterTolerance of it.
struct TimeCheck {
  static constexpr double kJitterTolerance = 0.01;
  struct Gap {
    std::size_t row;  ///< row after the gap, counted from 1
    double duration;  ///< from the row before [unit of the values]
  };

  double sample_time = 0.0;    ///< median step [unit of the values]
  double jitter = 0.0;         ///< largest |step/sample_time − 1| outside gaps
  std::size_t jitter_row = 0;  ///< where, counted from 1; 0: nowhere
  std::vector<Gap> gaps;
  std::vector<std::string> notes;  ///< what a user should know: gaps, jitter beyond the tolerance

  [[nodiscard]] bool regular() const noexcept { return gaps.empty() && jitter <= kJitterTolerance; }
};

/// Throws on a time that does not increase, with the row. `source` and `name` are for messages.
TimeCheck check_time(const std::vector<double>& values, const std::string& source = {},
                     const std::string& name = "t");

}  // namespace stribeck::io
