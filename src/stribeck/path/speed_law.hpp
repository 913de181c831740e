#pragma once
/// Speed along a path: from rest to a constant speed and back to rest, without a step of speed or
/// acceleration.
///
///   ṡ(t) = V·w(t/t_r)  while running in,   V,   V·w((t_end − t)/t_r)  while running out
///   w(τ) = τ³·(10 − 15τ + 6τ²)
///
///   V speed [m/s], t_r run-in [s], cruise distance [m] travelled at V. The references of the thesis begin
///   with a velocity step instead; experiments are scored after the run-in.
/// Real time: safe.

#include <stribeck/core/scalar.hpp>

namespace stribeck::path {

struct SpeedLaw {
  double speed = 0.0;
  double run_in = 1.0;
  double cruise_distance = 0.0;

  struct Point {
    double s = 0.0;             ///< distance travelled [m]
    double speed = 0.0;         ///< [m/s]
    double acceleration = 0.0;  ///< [m/s²]
  };

  [[nodiscard]] double cruise_time() const noexcept { return cruise_distance / speed; }
  [[nodiscard]] double duration() const noexcept { return 2.0 * run_in + cruise_time(); }
  [[nodiscard]] double length() const noexcept { return speed * run_in + cruise_distance; }

  [[nodiscard]] Point at(double t) const noexcept {
    if (t <= 0.0) return {};
    if (t < run_in) return ramp(t);
    if (t <= run_in + cruise_time()) return {speed * (t - 0.5 * run_in), speed, 0.0};
    if (t >= duration()) return {length(), 0.0, 0.0};
    const Point back = ramp(duration() - t);
    return {length() - back.s, back.speed, -back.acceleration};
  }

 private:
  [[nodiscard]] Point ramp(double t) const noexcept {
    const double x = t / run_in;
    return {speed * run_in * x * x * x * x * (2.5 - x * (3.0 - x)),
            speed * x * x * x * (10.0 - x * (15.0 - 6.0 * x)),
            speed / run_in * 30.0 * x * x * (1.0 - x) * (1.0 - x)};
  }
};

}  // namespace stribeck::path
