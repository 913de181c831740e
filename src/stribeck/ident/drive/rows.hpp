#pragma once
/// Rows of settled sliding motion: which rows of a log the fit uses, sorted into bins of speed and into blocks.
///
/// A row is used when its window lies in one stretch between reversals, behind the distance in which friction
/// settles, at a speed above the slowest, and not marked `skip`. Blocks are left out in turn to judge on motion
/// that was not fitted: whole stretches where there are enough, else pieces of them.
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
  /// Change of the force from row to row that the reference asks for [N], the instrument of the shift; empty while
  /// the shift is not fitted.
  std::vector<double> asked_change;
  bool sampled = false;  ///< these are not all rows: the force is aligned at them and their neighbours only
};

/// What is seen of the axis before any fit.
struct Extent {
  std::array<double, map::kSides> top_speed{};  ///< [m/s]
  double near = 0.0;  ///< way after a reversal in which friction may not have settled, as a first guess [m]
};
Extent extent_of(const AlignedLog& log);

/// Which rows are used.
struct Window {
  double exclude = 0.0;        ///< way after a reversal that is left out [m]
  double slowest_share = 0.0;  ///< of the top speed
  double relaxation = 0.0;     ///< way in which friction settles [m]; 0: not known
};

Rows gather(const AlignedLog& log, const Extent& extent, const Window& window, int bins);

/// Indices of rows in sequence, spread over everything: enough for what is only looked at.
std::vector<std::size_t> sample(const Rows& rows);
/// Those rows alone; all of them where there are few.
Rows sampled(const Rows& rows);

/// Numbers the blocks of the rows anew.
void number_blocks(Rows& rows);

/// Aligns the force, as far as `rows` needs it.
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
