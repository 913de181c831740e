#pragma once
/// The forms of friction that controls and simulators know, each as near as it can be to the friction of an axis.
///
///   Lines     F(v) = ± level + viscous·v, per direction or for both
///   Curve     points over the speed, straight lines between them, per direction or for both
///
/// Nearest: lines in the sense of the RMS error, points in that of the largest error; every speed from the slowest to the fastest
/// counts alike. Forces [N], speeds [m/s].
///
/// Real time: no.

#include <stribeck/targets/steady/nearest_polyline.hpp>
#include <stribeck/targets/steady/steady_target.hpp>
#include <vector>

namespace stribeck::targets {

/// Speeds of one direction, ascending, so close that a straight line between two of them is the friction: closer towards the slowest,
/// and around every term of the map.
std::vector<double> telling_speeds(const Axis& axis);

/// Level and slope over the speed; force is positive in the direction of the motion.
struct Line {
  double level = 0.0;    ///< [N]
  double viscous = 0.0;  ///< [N s/m]

  [[nodiscard]] double at(double speed) const noexcept { return level + viscous * speed; }
};

/// Over both directions, or over one (+1, −1). A slope or a level below zero means nothing physical: it becomes zero, and the
/// other one is fitted again.
Line nearest_line(const Axis& axis);
Line nearest_line(const Axis& axis, double direction);

/// At most so many points, from the slowest to the fastest speed, over both directions or over one.
std::vector<Corner> nearest_points(const Axis& axis, std::size_t points);
std::vector<Corner> nearest_points(const Axis& axis, std::size_t points, double direction);

/// Straight lines between the points, the value of the end beyond them.
double interpolated(const std::vector<Corner>& points, double speed) noexcept;

/// The friction against a velocity of either sign.
double signed_force(double speed_force, double v) noexcept;

}  // namespace stribeck::targets
