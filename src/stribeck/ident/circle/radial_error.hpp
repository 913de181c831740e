#pragma once
/// Judges a circle that was travelled from positions alone, for logs of any control.
///
///   e = |p − c| − R          radial error, positive outside
///   max |e|;  RMS = √mean e²
///   quadrant glitch          max |e| within the first `glitch_travel` that an axis travels after it reversed
///   circular deviation G     width of the minimum zone (minimum_zone.hpp)
///
///   p positions [m], R intended radius [m], c centre of the least-squares circle of the command, or of p itself where there is no
///   command; an error of position is then hidden. Of whole laps: a part of a lap that is travelled twice would pull it to its side.
///
/// Source: after ISO 230-4 for G; ISO 12181-1, formerly ISO 6318, for the least-squares circle.
/// Not modelled: the path between two samples; run-in and run-out, which laps.hpp takes off.
/// Real time: no.
/// Errors: std::invalid_argument when there are fewer samples than kFewest, sizes differ, the travel is shorter than kLeastArc or
/// has a sector of 10 degrees without samples, or the circle's radius differs from R by more than a fifth.

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace stribeck::ident::circle {

/// An arc in one direction that can stand for a circle, such as the 220 degrees of a ball-bar in a plane with z [rad]. A shorter one
/// does not tell its centre.
inline constexpr double kLeastArc = 3.05;

/// Names of the axes along θ = 0 and 90 degrees.
using AxisNames = std::array<std::string, 2>;

struct CircleTest {
  static constexpr std::size_t kFewest = 90;

  double radius = 0.0;  ///< [m]
  double centre_x = 0.0;
  double centre_y = 0.0;
  bool counter_clockwise = true;
  double revolutions = 0.0;
  double max_error = 0.0;           ///< [m]
  double rms = 0.0;                 ///< [m]
  double quadrant_glitch = 0.0;     ///< [m]
  double circular_deviation = 0.0;  ///< [m]
  std::vector<double> angle;        ///< of every sample, 0 to 2π [rad]
  std::vector<double> error;        ///< [m]
};

/// Positions, and the command where there is one; empty: no command.
struct CircleSamples {
  std::span<const double> x;
  std::span<const double> y;
  std::span<const double> command_x;
  std::span<const double> command_y;
  std::span<const std::size_t> row{};  ///< of the log, for words; empty: these are all of them
  std::span<const int> part{};         ///< rows of different parts are no one motion; empty: not known

  /// Counted from 1.
  [[nodiscard]] std::size_t row_of(std::size_t i) const noexcept { return (row.empty() ? i : row[i]) + 1; }
};

/// The circle whose distances from the points have the least sum of squares, Σ (|p − c| − r)²: geometric, not the algebraic fit (Kåsa),
/// which is its start and is too small for an arc with noise. Gauss–Newton on the centre, r eliminated.
/// Source: Gander, Golub, Strebel 1994, doi:10.1007/BF01934268, section 3.
/// Errors: std::invalid_argument where the points are on a line, or all at one place.
struct LeastSquaresCircle {
  double x = 0.0;
  double y = 0.0;
  double radius = 0.0;
};
LeastSquaresCircle least_squares_circle(std::span<const double> x, std::span<const double> y);

/// `glitch_travel` [m] as in the figures of merit of a simulation (sim/metrics.hpp).
CircleTest circle_test(const CircleSamples& samples, double radius, double glitch_travel);

}  // namespace stribeck::ident::circle
