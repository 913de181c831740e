#pragma once
/// Logs: columns over time, from whatever a control or a drive tool exports, plain or gzip.
///
///   const Log log = read_log("trace.sco");   // format found by its content; see docs/log-formats.md
///   in_si(log.at("s ist/Y"), quantity("m", "mm"))
///
/// In a CSV header, units are written `x [mm]`, `x (mm)` or `x_mm`; other formats have their own places for them. A
/// column without unit has unit_text "" and in_si refuses it, because units are not guessed. Where a format has no units but
/// recordings have shown them, they are set and a note says so. Values stay in the unit of the file.
///
/// A side file LOG.toml may add missing data: columns = ["x mm", …], sample_time = "1 ms".
///
/// Refused, with FILE:LINE, row and column: text and infinite cells, rows of another length, damaged structure. Repaired, with a note:
/// a last row that may have been cut by the end of the file is dropped. Blank and NaN cells are absent samples: few take their rows
/// with them, a column with many has times of its own; parse_csv and read_csv refuse them.
/// Rows are counted from 1 below the header; LINE is the line of the file.
/// Real time: no. Errors: InputError.

#include <cstddef>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/io/keys.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::io {

struct Column {
  std::string name;       ///< header without its unit
  std::string unit_text;  ///< known to units.hpp, "1" for a pure number, "" where none is given
  std::vector<double> values;
  std::string header = {};              ///< as in the file
  std::vector<std::string> texts = {};  ///< of a column of text; its values are empty
  int time = -1;  ///< index of the column with its sampling times; −1: the log's only time column, if any
  bool unit_assumed = false;  ///< not in the file (a note says so), or one letter that may be an axis as well
};

/// What was found, repaired or left out when a log was read, in one sentence.
struct Note {
  enum class About {
    kOther,
    kGaps,        ///< gaps of the time: ident::log::condition() finds them again and repairs them
    kTimeBack,    ///< the time does not increase: usual where runs follow each other
    kGivenNames,  ///< names and units come from the user
  };

  std::string text;
  About about = About::kOther;

  Note(std::string sentence, About subject = About::kOther) : text(std::move(sentence)), about(subject) {}
  operator const std::string&() const noexcept { return text; }
  friend bool operator==(const Note&, const Note&) = default;
};
using Notes = std::vector<Note>;

struct Log {
  std::string source;  ///< file, for messages
  std::vector<Column> columns;
  std::size_t rows = 0;  ///< of the longest column; columns of different rates differ in length
  Notes notes;           ///< what was found, repaired or left out
  /// Keys as in the file; "sample time" and "axis N" where the format has its own place for them.
  std::vector<std::pair<std::string, std::string>> metadata;
  std::string format = "CSV";
  char decimal_sign = '.';  ///< of the numbers in the table

  /// By header as in the file, else by name; null where there is none.
  [[nodiscard]] const Column* find(std::string_view name) const;
  /// The same; throws with the names of all columns.
  [[nodiscard]] const Column& at(std::string_view name) const;
};

struct ReadOptions {
  std::size_t skip_lines = 0;  ///< lines before a CSV header
  /// "x mm" or "x [mm]", for logs without a header or in place of it.
  std::vector<std::string> names{};
  std::optional<double> sample_time{};     ///< [s], for logs without times
  std::optional<double> machine_period{};  ///< [s], of the machine file, for logs whose head tells none
  std::string time_column{};               ///< header or name; empty: found by name and unit
  bool times_needed = true;                ///< false: a table without times is taken as well
};

/// Any log. What the options leave open is taken from the side file LOG.toml, if it exists.
Log read_log(const std::string& path, const ReadOptions& options = {});
/// What a side file says, for readers of streams.
struct SideFileData {
  std::vector<std::string> columns{};
  std::optional<double> sample_time{};  ///< [s]
};
SideFileData read_side_file(const std::string& path);
/// Columns without values from texts such as "x mm".
std::vector<Column> named_columns(const std::vector<std::string>& names);
/// Keys of a side file, for the reference page.
std::vector<KeyInfo> side_file_keys();
/// The same from bytes (gzip too), without a side file; `source` is for messages.
Log parse_log(std::string_view bytes, const std::string& source, const ReadOptions& options = {});

/// Index of the time column, found by unit or name (the first of several); −1 when there is none.
int time_column(const Log& log);

struct CsvOptions {
  std::size_t skip_lines = 0;        ///< lines before the header
  std::vector<std::string> names{};  ///< headers to use when the file has none: the first row is data
  /// Columns that begin with text (names of runs, phases of a programme) are left out with a note instead of
  /// refused.
  bool leave_out_text_columns = false;
  bool unit_after_blank = false;  ///< a header "x mm" is read as "x [mm]"
};

/// A CSV table that need not be a log: it needs no time, and no side file is read.
Log read_csv(const std::string& path, const CsvOptions& options = {});
/// The same from bytes (gzip too); `source` is for messages.
Log parse_csv(std::string_view bytes, const std::string& source, const CsvOptions& options = {});

/// The values in the SI unit of the quantity. Throws when the column has no unit or a unit of another dimension.
std::vector<double> in_si(const Column& column, const Quantity& quantity);

/// Writes `name [unit]` headers and numbers that read back bit for bit; metadata as `# key: value`. Columns
/// of different length have no common table and are refused.
void write_csv(const std::string& path, const Log& log);
std::string csv_text(const Log& log);

/// Regularity of a time column. Steps longer than 1.5 samples are gaps; the others may differ from the
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
  Notes notes;  ///< what a user should know: gaps, jitter beyond the tolerance

  [[nodiscard]] bool regular() const noexcept { return gaps.empty() && jitter <= kJitterTolerance; }
};

/// Throws on a time that does not increase, with the row. `source`, `name` and `unit` are for messages.
TimeCheck check_time(const std::vector<double>& values, const std::string& source = {},
                     const std::string& name = "t", const std::string& unit = {});

}  // namespace stribeck::io
