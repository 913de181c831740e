#pragma once
/// A circle that was travelled, judged from positions alone: any log, any control.
///
///   e = |p − c| − R          radial error, positive outside
///   max |e|;  RMS = √mean e²
///   quadrant glitch          max |e| within the first 0.15 mm that an axis travels after it turned round: R·(1 − cos Δ) = 0.15 mm
///   circular deviation G     largest minus smallest distance from the least-squares centre (ISO 230-4)
///
///   p positions [m], R radius that was meant [m], c least-squares centre (Kåsa) of the commanded circle, or where there is no
///   command of p itself, which then hides an error of position
///
/// Not modelled: the path between two samples; ISO 230-4's run-in and its filter.
/// Real time: no.
/// Errors: std::invalid_argument when there are fewer samples than kFewest, sizes differ, or the way is shorter than a revolution.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace stribeck::sim {

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

/// Positions, and where there is one the command; empty: none.
struct CircleSamples {
  std::span<const double> x;
  std::span<const double> y;
  std::span<const double> command_x;
  std::span<const double> command_y;
};

CircleTest circle_test(const CircleSamples& samples, double radius);

}  // namespace stribeck::sim
