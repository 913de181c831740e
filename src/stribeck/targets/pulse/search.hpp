#pragma once
/// Which pulse takes most of the quadrant error away, over a grid of circles of the identified axis.
///
/// On each circle both axes are the identified one. The amplitude is that with the smallest sum of the peak at the quadrant and the
/// largest contour error of the lap, by golden section; all else of the pulse is the best one of a list on the user's circle, then
/// the same on all.
/// Real time: no.

#include <stribeck/targets/pulse/circle.hpp>
#include <string>
#include <vector>

namespace stribeck::targets {

struct PulseRow {
  double radius = 0.0;        ///< [m]
  double feed = 0.0;          ///< [m/s]
  double acceleration = 0.0;  ///< at the quadrant, feed²/radius [m/s²]
  double amplitude = 0.0;     ///< best of this circle [m/s]
  CircleError without;        ///< without the pulse
  CircleError best;           ///< with that amplitude
  double cost = 0.0;          ///< what the search makes small [m]
  int substeps = 0;           ///< of its simulation
};

/// A pulse of which the amplitude [m/s] is free.
using PulseShape = std::function<Pulse(double amplitude)>;

struct PulseSearch {
  std::size_t shape = 0;       ///< which of the list
  std::vector<PulseRow> rows;  ///< those that are left, by radius, then by feed, the user's circle first
  std::size_t left_out = 0;    ///< circles of the grid that the loop does not follow, or that take too long
  std::string why;             ///< of the first of them
};

/// Multiples of the integral time that are tried for a time of a pulse.
inline constexpr std::array kPulseTimes{0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 10.0};

/// Force by which steady friction changes at a reversal [N], of slow motion: a thousandth of the feed.
double jump_of_friction(const friction::AxisModel& axis, double feed) noexcept;

/// Circles done, and in all.
using SearchProgress = std::function<void(std::size_t done, std::size_t all)>;

/// radius, feed: the user's circle, the largest and fastest of the grid. Throws sim::Refused where the loop does not follow that circle,
/// or its simulation would take too long.
PulseSearch search_pulses(const friction::AxisModel& axis, const sim::ControllerSpec& loop, double period,
                          double radius, double feed, const std::vector<PulseShape>& shapes,
                          const SearchProgress& progress = {});

/// The errors with one pulse on the circles of rows.
std::vector<CircleError> try_pulse(const friction::AxisModel& axis, const sim::ControllerSpec& loop,
                                   double period, const std::vector<PulseRow>& rows, const Pulse& pulse);

}  // namespace stribeck::targets
