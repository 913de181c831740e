// Triangles of speed.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/excitation/excitation_parts.hpp>

namespace stribeck::ident::excitation {
namespace {

constexpr double kShortestFlank = 0.25;  ///< of the wanted one
constexpr double kOfLimit = 0.5;         ///< of the acceleration that the axis may have
constexpr double kRestBehind = 0.2;      ///< behind each triangle [s]

}  // namespace

AccelerationDesign acceleration_design(const Limits& limits, double start, double mass, double friction) {
  constexpr double kShows = 0.3;  // inertia over friction
  AccelerationDesign design;
  design.start = start;
  const double room = limits.travel_max - start;
  const double acceleration = std::min(kReserve * limits.speed, 0.95 * room / design.flank) / design.flank;
  if (mass * acceleration < kShows * friction) {
    design.flank *= kShortestFlank;
    design.repeats = static_cast<int>(std::lround(design.repeats / kShortestFlank));
  }
  return design;
}

Excitation design_constant_acceleration(const Limits& limits, double sample_time,
                                        const AccelerationDesign& design) {
  check(limits, sample_time, design.start);
  if (!(design.flank > 0.0) || design.repeats < 1) {
    throw Refused(
        fmt::format("constant acceleration: got a flank of {:g} s and {} repeats, expected both above 0",
                    design.flank, design.repeats));
  }
  const double room =
      design.direction > 0 ? limits.travel_max - design.start : design.start - limits.travel_min;
  double v = kReserve * limits.speed;
  double flank = design.flank;
  if (limits.acceleration > 0.0) {
    const double most = kOfLimit * limits.acceleration;
    // Where the travel is too short for the highest speed, a shorter flank makes more of both.
    if (v * flank > 0.95 * room) {
      v = std::min(v, std::sqrt(0.95 * room * most));  // higher speeds are not reached
      flank = std::min(flank, std::max(kShortestFlank * design.flank, std::sqrt(0.95 * room / most)));
    }
    flank = std::max(flank, v / most);
  }
  v = std::min(v, 0.95 * room / flank);  // both flanks together travel v·flank
  check_rows("repeats", 2.0 * design.repeats * (2.0 * flank + kRestBehind) / sample_time, sample_time,
             fmt::format("constant acceleration: {} triangles in each direction", design.repeats),
             "fewer repeats");
  const auto rows = static_cast<std::size_t>(std::ceil(flank / sample_time));
  if (rows < 20) {
    throw Refused(fmt::format(
        "constant acceleration: a flank of {:.3g} s has only {} samples, expected at least 20", flank, rows));
  }
  Excitation e;
  e.method = ExcitationMethod::kConstantAcceleration;
  e.sample_time = sample_time;
  double r = design.start;
  e.r.push_back(r);
  for (int i = 0; i < design.repeats; ++i) {
    for (const double direction : {design.direction, -design.direction}) {
      for (std::size_t k = 0; k < 2 * rows; ++k) {
        const double up = (static_cast<double>(k) + 0.5) / static_cast<double>(rows);
        r += direction * v * std::min(up, 2.0 - up) * sample_time;
        e.r.push_back(r);
      }
      for (double t = 0.0; t < kRestBehind; t += sample_time) e.r.push_back(r);
    }
    r = design.start;
  }
  stamp(e, e.r.size());
  check_positions(e, limits);
  const Shown u = shown(limits);
  e.says = fmt::format(
      "constant acceleration: {:.1f} s, {} triangles of speed in each direction, {} {}/s2 up to {} {}/s. "
      "Determines the mass, from accelerating against braking at the same speed, whatever the friction; "
      "friction only roughly.",
      e.t.back(), design.repeats, digits(v / flank * u.per_metre), u.travel, digits(v * u.per_metre),
      u.travel);
  return e;
}

}  // namespace stribeck::ident::excitation
