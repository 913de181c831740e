#pragma once
/// Rows of settled sliding motion: which rows of a log the fit uses, sorted into bins of speed and into blocks.
///
/// A row is used when its window lies in one stretch between reversals, farther from the reversal than friction needs to
/// settle, faster than the slowest speed (a share of the top speed of all records) or steady (steady_rows.hpp), and not marked
/// `skip`. Blocks are left out in turn to judge the fit on other motion:
/// whole stretches where there are enough of them, otherwise pieces of stretches.
///
/// Inside ident only. Real time: no.
/// Errors: Refused when a direction has too few rows.

#include <array>
#include <cmath>
#include <cstdint>
#include <stribeck/ident/drive/aligned_log.hpp>
#include <stribeck/ident/map/drive_rows.hpp>
#include <vector>

namespace stribeck::ident::drive {

struct Rows : map::Rows {
  std::array<map::Grid, map::kSides> grid;
  std::vector<std::uint8_t> block;
  std::size_t blocks = 5;
  /// Change from row to row of the force that the reference asks for [N]: the instrument of the shift. Empty while the shift is
  /// not fitted.
  std::vector<double> asked_change;
  bool sampled = false;  ///< only some of the rows: the force is aligned at these and their neighbours only
};

/// First estimates, before any fit.
struct Extent {
  std::array<double, map::kSides> top_speed{};  ///< [m/s]
  double near =
      0.0;  ///< first guess of the distance after a reversal in which friction may not have settled [m]
};
Extent extent_of(const AlignedLog& log);

/// Limits that select the rows.
struct Window {
  double exclude = 0.0;        ///< distance after a reversal that is left out [m]
  double slowest_share = 0.0;  ///< as a share of the top speed
  double relaxation = 0.0;     ///< distance in which friction settles [m]; 0: not known
};

Rows gather(const AlignedLog& log, const Extent& extent, const Window& window, int bins);

/// Indices of rows spread evenly over the log, for quick looks at the data.
std::vector<std::size_t> sample(const Rows& rows);
/// The rows with these indices, without their instrument of the shift.
Rows picked(const Rows& rows, const std::vector<std::size_t>& kept);
/// The rows of sample(); all rows where there are few.
Rows sampled(const Rows& rows);

/// Renumbers the blocks of the rows.
void number_blocks(Rows& rows);

/// Aligns the force at all rows that `rows` needs.
void align(AlignedLog& log, double shift, const Rows& rows);
/// Aligns the force at every row.
void align_all(AlignedLog& log, double shift);

inline const log::Motion& motion_of(const AlignedLog& log, const Rows& rows, std::size_t i) {
  return log.motions[static_cast<std::size_t>(rows.record[i])];
}
inline double velocity_of(const AlignedLog& log, const Rows& rows, std::size_t i) {
  return motion_of(log, rows, i).v[rows.at[i]];
}

}  // namespace stribeck::ident::drive
