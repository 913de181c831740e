#pragma once
/// How far the force of a log agrees with friction that changes its direction with the motion, at a shift of the force.
///
/// Inside ident only. Real time: no.

#include <array>
#include <cstddef>
#include <stribeck/ident/drive/linear_fit.hpp>
#include <vector>

namespace stribeck::ident::drive {

inline constexpr double kLongestShift = 0.03;   ///< [s]
inline constexpr double kMostShiftRows = 40.0;  ///< [rows]

/// Longest shift [rows].
double longest_rows(double sample_time);
/// The same, at most kMostShiftRows.
double most_shift(double sample_time);

/// Rows around reversals, which the fit has not seen: friction goes there from the value of one direction to that of the other,
///
///   F = F_settled(v) − jump·Σ w·exp(−z/d)      z: distance since the reversal; w ≥ 0, Σ w = 1
///
/// through the window that the force has passed. The shares w of a row of distances d are free: friction may come in any number of stages.
class AroundReversals {
 public:
  explicit AroundReversals(const AlignedLog& log);

  /// Mean square of the force that is left [N²], with one distance and with shares of many. NaN: there are no reversals.
  struct Left {
    double simple = 0.0, mixed = 0.0;
    double friction = 0.0;  ///< where the axis hardly moves, mean of the directions [N]
  };
  [[nodiscard]] Left left(const AlignedLog& log, const LinearFit& fit, double shift) const;

  static constexpr std::size_t kDistances = 14;  ///< each half of the one before, the last 0

 private:
  struct Stretch {
    std::size_t record = 0, first = 0, last = 0;  ///< rows
    std::vector<double> columns;  ///< of each row: direction·exp(−z/d) for each distance, and the direction
  };
  static Stretch stretch_around(const log::Motion& m, std::size_t record, std::size_t row);
  /// Of the stretches from `first` on, all of one record.
  void add_columns(const log::Motion& m, std::size_t first);

  std::vector<Stretch> stretches_;
};

}  // namespace stribeck::ident::drive
