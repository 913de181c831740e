#pragma once
/// The quantities of the circular test, after ISO 230-4, of the runs of one circle.
///
///   G     circular deviation of one direction: width of its minimum zone
///   G(b)  bi-directional circular deviation: width of the minimum zone of both directions together
///   F     radial deviation: largest and smallest distance from the centre less the intended radius. The centre is that of the
///         command; where there is none, that of the least-squares circle of both directions, which hides an offset
///   D     mean bi-directional radial deviation: radius of the least-squares circle of both directions less the intended radius
///   H     circular hysteresis: largest radial difference between the directions at one angle, about that circle's centre
///
/// H compares paths that are means over laps and over steps of a quarter of a degree (wider where the samples are farther apart).
/// Defined in docs/theory/circular-test.md.
/// Source: after ISO 230-4. Not modelled: the filter that the standard allows. Real time: no. Errors: none.

#include <optional>
#include <stribeck/ident/circle/laps.hpp>
#include <vector>

namespace stribeck::ident::circle {

struct LapTest {
  double max_error = 0.0;  ///< largest |e| [m]
  double rms = 0.0;
  double circular_deviation = 0.0;
};

struct DirectionTest {
  bool counter_clockwise = true;
  double circular_deviation = 0.0;  ///< G [m]
  double radial_max = 0.0;          ///< F [m]
  double radial_min = 0.0;
  std::vector<LapTest> laps;  ///< whole ones
};

struct CircularTest {
  std::vector<DirectionTest> directions;  ///< in order of time: one or two
  double mean_radial_deviation = 0.0;     ///< D; of one direction where there is no other [m]
  std::optional<double> bidirectional;    ///< G(b); absent: one direction [m]
  std::optional<double> hysteresis;       ///< H
  double hysteresis_angle = 0.0;          ///< where [rad]
};

/// `samples` are those of which `motion` was made; it has at least one run.
CircularTest circular_test(const CircleSamples& samples, const CircleMotion& motion);

}  // namespace stribeck::ident::circle
