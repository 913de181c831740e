#pragma once
/// Common parts of planned paths whose feed obeys the limits of the axes: part programs and points.
/// Real time: no.
/// Errors: InputError naming the option or the file.

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <stribeck/io/error.hpp>
#include <stribeck/sim/machine.hpp>
#include <stribeck/sim/part/travel.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::workflow {

/// Limits of the axes, or those of the options where they are lower.
template <std::size_t N>
sim::PartLimits<N> part_limits(const PathOptions& o, const sim::Machine& machine,
                               const std::vector<std::size_t>& axes) {
  sim::PartLimits<N> limits;
  const double acceleration = o.acceleration.empty() ? std::numeric_limits<double>::infinity()
                                                     : option_si("--acceleration", o.acceleration,
                                                                 quantity("m/s2", "mm/s2").positive());
  const double jerk =
      o.jerk.empty() ? 0.0 : option_si("--jerk", o.jerk, quantity("m/s3", "mm/s3").positive());
  for (std::size_t i = 0; i < N; ++i) {
    const sim::AxisLimits& axis = machine.axes[axes[i]].second.limits;
    limits.speed[i] = axis.speed;
    limits.acceleration[i] = std::min(axis.acceleration, acceleration);
    limits.jerk[i] = axis.jerk         ? std::min(*axis.jerk, o.jerk.empty() ? *axis.jerk : jerk)
                     : !o.jerk.empty() ? jerk
                                       : limits.acceleration[i] / sim::AxisLimits::kJerkTime;
  }
  return limits;
}

/// Refuses places outside the travel of an axis.
template <std::size_t N>
void check_places(const sim::Part<N>& part, const sim::Machine& machine, const std::vector<std::size_t>& axes,
                  const std::string& file, const char* way_out) {
  constexpr int kCurve = 8;       // places along a polynomial
  constexpr double kStep = 0.05;  // [rad] along arcs: within 0.03 % of the radius
  for (const path::Segment<N>& s : part.segments) {
    const int steps = s.kind == path::SegmentKind::kArc      ? 1 + static_cast<int>(std::abs(s.angle) / kStep)
                      : s.kind == path::SegmentKind::kCorner ? kCurve
                                                             : 1;
    for (int k = 0; k <= steps; ++k) {
      const Vec<double, N> p = s.point(s.length * k / steps);
      for (std::size_t i = 0; i < N; ++i) {
        const auto& [name, axis] = machine.axes[axes[i]];
        if (p[i] >= axis.limits.travel_min && p[i] <= axis.limits.travel_max) continue;
        throw io::InputError(
            {file,
             0,
             {},
             fmt::format("leaves the travel of axis {}, {:.6g} to {:.6g} mm: it goes to {:.6g} mm, {:.6g} "
                         "mm along the path ({})",
                         name, axis.limits.travel_min * 1e3, axis.limits.travel_max * 1e3, p[i] * 1e3,
                         (s.travelled + s.distance(s.length * k / steps)) * 1e3, way_out)});
      }
    }
  }
}

/// The whole part, travelled once.
template <std::size_t N>
sim::Travel planned_travel(std::shared_ptr<const sim::Part<N>> part, std::string name) {
  sim::Travel travel;
  travel.path = sim::PartPath<N>{part};
  travel.name = std::move(name);
  travel.speed = part->summary.length / part->summary.duration;
  travel.laps = 1.0;
  travel.run_in = 0.0;
  return travel;
}

}  // namespace stribeck::workflow
