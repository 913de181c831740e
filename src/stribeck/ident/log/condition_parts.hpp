#pragma once
/// Parts of condition() that are no promise to anybody: one table of equally spaced rows, its pieces, notes.
/// Real time: no.

#include <cstddef>
#include <cstdint>
#include <stribeck/ident/log/condition.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::ident::log::parts {

/// One stretch of rows with one sample time; columns that the log does not have are empty.
struct Table {
  std::string source;
  std::size_t run = 0;
  double sample_time = 0.0;  ///< [s]
  std::vector<double> t, x, r, v, f;
  std::vector<std::size_t> row;    ///< of the log
  std::vector<std::uint8_t> mark;  ///< RowMark
  bool gap_before = false;

  [[nodiscard]] std::size_t rows() const noexcept { return t.size(); }
  /// The column that tells of motion.
  [[nodiscard]] const std::vector<double>& motion() const noexcept { return x.empty() ? v : x; }
};

/// Rows from first to last (not included).
Table slice(const Table& table, std::size_t first, std::size_t last);

/// Collects findings; a kind that is switched off is neither noted nor repaired.
class Notes {
 public:
  explicit Notes(const ConditionOptions& options);
  [[nodiscard]] bool wanted(std::string_view kind) const;
  /// Place from a table: row k, or rows k to last.
  void add(std::string kind, const Table& table, std::size_t k, bool repaired, const std::string& text,
           std::vector<double> values = {});
  void add_range(std::string kind, const Table& table, std::size_t k, std::size_t last, bool repaired,
                 const std::string& text, std::vector<double> values = {});
  void add_all(std::string kind, const std::string& source, bool repaired, const std::string& text,
               std::vector<double> values = {});
  /// A way [m or rad] as people read it.
  [[nodiscard]] std::string way(double value) const;
  void turns(bool yes) { turns_ = yes; }
  [[nodiscard]] bool has(std::string_view kind) const;
  std::vector<Finding> take() { return std::move(found_); }

 private:
  std::vector<std::string> keep_;
  std::vector<Finding> found_;
  bool turns_ = false;
};

std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// The value below which a share of them lies; of a part of the values when there are very many. NaN for none.
double quantile(std::vector<double> values, double share);
std::vector<double> magnitudes(const std::vector<double>& values);
/// At most `most` values in four blocks spread over the column, each of neighbouring rows.
std::vector<double> sample_of(const std::vector<double>& values, std::size_t most);

/// Mean over [from, to) of a signal that holds its value from one stamp to the next.
double hold_mean(const std::vector<double>& t, const std::vector<double>& y, double from, double to,
                 std::size_t& hint);
/// On the straight line between the neighbouring stamps.
double on_line(const std::vector<double>& t, const std::vector<double>& y, double at, std::size_t& hint);

// condition_time.cpp
/// All signals on one time base; takes them out of the log. Throws Refused.
Table one_table(RawLog& log, std::size_t run, Notes& notes);
/// Pieces without gaps, each with regular time.
std::vector<Table> regular_pieces(Table table, Sampling& sampling, Notes& notes);
/// Rows between new values; 1 when the column is new in every row.
double hold_of(const std::vector<Table>& tables, std::vector<double> Table::*column);
/// The same pieces on the grid of the slowest channel.
std::vector<Table> on_slow_grid(std::vector<Table> tables, Sampling& sampling, Notes& notes);
/// Cuts out what a frozen logger wrote.
std::vector<Table> without_frozen(std::vector<Table> tables, double longest_hold, Notes& notes);

// condition_force.cpp
RoughFit rough_fit(const std::vector<Table>& tables);
/// Rough fit and the recovered signs of a force that was logged as a magnitude.
void recover_signs(std::vector<Table>& tables, Notes& notes);
/// Flips the force where it acts against the position.
void mend_sign(std::vector<Table>& tables, Notes& notes);
/// Cuts standstill without drive off both ends.
void cut_drive_off(std::vector<Table>& tables, Notes& notes);
/// Whether the force has no noise of its own: it was programmed, not measured.
bool quiet(const std::vector<double>& force);
void find_saturation(std::vector<Table>& tables, Notes& notes);

}  // namespace stribeck::ident::log::parts
