#pragma once
/// From one speed to another with limited acceleration and jerk, starting and ending without acceleration: three phases.
///
///   t_j = a/j, t_a = |Δv|/a − t_j     where |Δv| ≥ a²/j
///   t_j = √(|Δv|/j), t_a = 0          else: the acceleration stays below a
///   duration T = 2·t_j + t_a,   distance = (v₀ + v₁)/2·T, since speed is symmetric about the middle
///
///   v speed [m/s], a acceleration [m/s²], j jerk [m/s³]; speeds not negative, limits positive.
/// Source: Biagiotti, Melchiorri, Trajectory Planning for Automatic Machines and Robots, 2008, section 3.4 (double S).
/// Real time: safe; the searches configure only.

#include <array>
#include <stribeck/core/scalar.hpp>

namespace stribeck::path {

/// A stretch of constant jerk.
struct FeedPhase {
  double time = 0.0;          ///< its beginning [s]
  double s = 0.0;             ///< distance at its beginning [m]
  double speed = 0.0;         ///< [m/s]
  double acceleration = 0.0;  ///< [m/s²]
  double jerk = 0.0;          ///< [m/s³]
};

struct SpeedRamp {
  double from = 0.0;
  double to = 0.0;
  double jerk_time = 0.0;  ///< t_j
  double hold_time = 0.0;  ///< t_a
  double jerk = 0.0;       ///< of the first phase, with its sign

  SpeedRamp() = default;
  SpeedRamp(double v0, double v1, double a, double j) noexcept : from(v0), to(v1) {
    const double change = abs(v1 - v0);
    if (change * j >= a * a) {
      jerk_time = a / j;
      hold_time = change / a - jerk_time;
    } else {
      jerk_time = sqrt(change / j);
    }
    jerk = v1 < v0 ? -j : j;
  }
  [[nodiscard]] double duration() const noexcept { return 2.0 * jerk_time + hold_time; }
  [[nodiscard]] double distance() const noexcept { return 0.5 * (from + to) * duration(); }

  /// Its phases, starting at a time and a place.
  [[nodiscard]] std::array<FeedPhase, 3> phases(double time, double s) const noexcept {
    const double a = jerk * jerk_time;
    const double t1 = jerk_time;
    const double v1 = from + 0.5 * a * t1;
    const double s1 = s + from * t1 + jerk * t1 * t1 * t1 / 6.0;
    const double t2 = hold_time;
    const double v2 = v1 + a * t2;
    const double s2 = s1 + v1 * t2 + 0.5 * a * t2 * t2;
    return {{{time, s, from, 0.0, jerk}, {time + t1, s1, v1, a, 0.0}, {time + t1 + t2, s2, v2, a, -jerk}}};
  }
};

/// Speed on a ramp at a distance from its beginning [m], 0 to distance(), by bisection of the time.
inline double speed_after(const SpeedRamp& ramp, double distance) noexcept {
  const auto p = ramp.phases(0.0, 0.0);
  double low = 0.0;
  double high = ramp.duration();
  const auto at = [&](double t) -> const FeedPhase& {
    return t < p[1].time ? p[0] : t < p[2].time ? p[1] : p[2];
  };
  for (int i = 0; i < 60; ++i) {
    const double t = 0.5 * (low + high);
    const FeedPhase& f = at(t);
    const double x = t - f.time;
    const double s = f.s + x * (f.speed + x * (0.5 * f.acceleration + x * f.jerk / 6.0));
    (s < distance ? low : high) = t;
  }
  const FeedPhase& f = at(high);
  const double x = high - f.time;
  return f.speed + x * (f.acceleration + 0.5 * x * f.jerk);
}

/// The highest speed, between v and most, that a ramp from v reaches within a distance [m].
inline double reachable(double v, double distance, double most, double a, double j) noexcept {
  if (!(most > v) || SpeedRamp(v, most, a, j).distance() <= distance) return max_of(v, most);
  double low = v;
  double high = most;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (SpeedRamp(v, middle, a, j).distance() <= distance ? low : high) = middle;
  }
  return low;
}

/// The highest speed up to `most` for which ramps from v0 and to v1 fit into a distance [m].
inline double reachable_between(double v0, double v1, double distance, double most, double a,
                                double j) noexcept {
  const auto fits = [&](double v) {
    return SpeedRamp(v0, v, a, j).distance() + SpeedRamp(v, v1, a, j).distance() <= distance;
  };
  double low = max_of(v0, v1);
  if (!(most > low) || fits(most)) return max_of(low, most);
  double high = most;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace stribeck::path
