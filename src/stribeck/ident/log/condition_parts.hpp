#pragma once
/// Inside of condition(): a table of equally spaced rows, the notes on what was found, and the steps, listed by file.
/// Nothing here is for users of the library; it may change at any time.
/// Real time: no.

#include <cstddef>
#include <cstdint>
#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/log/record_limits.hpp>
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
  double x_step = 0.0;   ///< resolution of the motion before the rows were resampled; 0: they were not
  bool counted = false;  ///< the sample time was found by counting rows between coarse stamps

  [[nodiscard]] std::size_t rows() const noexcept { return t.size(); }
  /// The column that shows motion.
  [[nodiscard]] const std::vector<double>& motion() const noexcept { return x.empty() ? v : x; }
};

/// Rows from first to last (not included).
Table slice(const Table& table, std::size_t first, std::size_t last);

/// Collects findings. A kind that is switched off is neither noted nor repaired.
class Notes {
 public:
  explicit Notes(const ConditionOptions& options);
  [[nodiscard]] bool wanted(std::string_view kind) const;
  /// The place of a finding is row k of a table, or rows k to last.
  void add(std::string kind, const Table& table, std::size_t k, bool repaired, const std::string& text,
           std::vector<double> values = {});
  void add_range(std::string kind, const Table& table, std::size_t k, std::size_t last, bool repaired,
                 const std::string& text, std::vector<double> values = {});
  void add_all(std::string kind, const std::string& source, bool repaired, const std::string& text,
               std::vector<double> values = {});
  /// A length [m or rad] as text for people.
  [[nodiscard]] std::string travel(double value) const;
  /// Angles are shown in rad, those of a rotary axis in deg.
  void turns(bool yes, bool rotary) {
    turns_ = yes;
    rotary_ = rotary;
  }
  [[nodiscard]] bool has(std::string_view kind) const;
  /// What was found; the same about the time stamps of several pieces of a log is one finding, of the worst piece.
  std::vector<Finding> take();

 private:
  std::vector<std::string> keep_;
  std::vector<Finding> found_;
  bool turns_ = false;
  bool rotary_ = false;
};

inline bool turning(const std::string& position_unit) { return position_unit == "rad"; }

// condition_table.cpp
bool same_row(const Table& table, std::size_t a, std::size_t b);
/// Whether a column has one value in all rows of all tables.
bool constant(const std::vector<Table>& tables, std::vector<double> Table::*column);
/// At most `most` values of a column: four blocks spread over it, each of neighbouring rows.
std::vector<double> sample_of(const std::vector<double>& values, std::size_t most);
/// Mean over [from, to) of a signal that keeps its value from one stamp to the next.
double hold_mean(const std::vector<double>& t, const std::vector<double>& y, double from, double to,
                 std::size_t& hint);
/// Value at a time, on the straight line between the neighbouring stamps.
double on_line(const std::vector<double>& t, const std::vector<double>& y, double at, std::size_t& hint);

// condition_bases.cpp
/// Brings all signals to one time base and takes them out of the log. Throws Refused.
Table one_table(RawLog& log, std::size_t run, Notes& notes);

// condition_time.cpp
double median_step(const std::vector<double>& t);
/// Cuts a table into pieces without gaps, each with regular time.
std::vector<Table> regular_pieces(Table table, Sampling& sampling, Notes& notes);

// condition_sampling.cpp
/// Number of rows between new values; 1 when every row has a new value.
double hold_of(const std::vector<Table>& tables, std::vector<double> Table::*column);
/// Measures resolution and noise of every channel.
void measure(const std::vector<Table>& tables, Sampling& sampling);

// condition_grid.cpp
/// Brings the pieces to the grid of the slowest channel.
std::vector<Table> on_slow_grid(std::vector<Table> tables, Sampling& sampling, Notes& notes);
/// Cuts out the rows that a frozen logger wrote.
std::vector<Table> without_frozen(std::vector<Table> tables, double longest_hold, Notes& notes);

// condition_columns.cpp
/// Integrates the velocity to a position that begins at 0, where the log has no position; or the reference from its velocity.
void integrate_velocity(std::vector<Table>& tables, bool reference);
/// Leaves out, turns or refuses a velocity that is not the rate of the position.
void check_velocity(std::vector<Table>& tables, const Sampling& sampling, Notes& notes);
/// Leaves out a reference that does not belong to the position.
void check_reference(std::vector<Table>& tables, Notes& notes);

// condition_samples.cpp
/// Replaces single samples that are far off neighbours which agree with each other.
void mend_spikes(std::vector<Table>& tables, double resolution, std::vector<double> Table::*column,
                 const char* name, Notes& notes);
/// Cuts out rows in which the force keeps its value to the last bit although the axis accelerates.
std::vector<Table> cut_stuck_force(std::vector<Table> tables, double hold, Notes& notes);

// condition_drive.cpp
/// Cuts off standstill with the drive switched off, at both ends.
void cut_drive_off(std::vector<Table>& tables, Notes& notes);
/// Cuts out rows without any force in which the axis sets out from rest: it is pushed by hand, or falls.
void cut_moved_without_drive(std::vector<Table>& tables, Notes& notes);
/// Whether the force has no noise of its own: it was programmed, not measured.
bool quiet(const std::vector<double>& force);
/// Marks rows in which the force is at the end of its range.
void find_saturation(std::vector<Table>& tables, Notes& notes);

// rough_fit.cpp
RoughFit rough_fit(const std::vector<Table>& tables);

// condition_sign.cpp
/// Recovers the signs of a force that was logged as a magnitude.
void recover_signs(std::vector<Table>& tables, Notes& notes);
/// Reverses the force where its sign disagrees with the position's.
void mend_sign(std::vector<Table>& tables, Notes& notes);

// condition_coverage.cpp
/// Marks standstill at both ends.
void mark_rest(Table& table, double resolution);
Coverage cover(const std::vector<Table>& tables, const Sampling& sampling, const std::string& position_unit);

// condition_verdict.cpp
/// Writes what such a log can determine and what not.
void judge(Conditioned& out, const std::string& position_unit, bool rotary);

}  // namespace stribeck::ident::log::parts
