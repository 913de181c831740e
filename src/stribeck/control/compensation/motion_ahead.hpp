#pragma once
/// The reference of one axis over the coming hold: from the instant at which the new force begins to act, for one period.
///
///   r(τ) = r + ṙ·τ + r̈·τ²/2 + j·τ³/6,   0 ≤ τ ≤ T      τ [s] from the beginning of the hold
///
/// With a computation delay that instant is later than the sample; the Taylor series is continued to it. The jerk j is the
/// difference of the accelerations of the reference over one period, unless that was a step of acceleration (compensation.hpp).
/// Real time: safe.

namespace stribeck::control {

struct MotionAhead {
  double position = 0.0;      ///< [m]
  double velocity = 0.0;      ///< [m/s]
  double acceleration = 0.0;  ///< [m/s²]
  double jerk = 0.0;          ///< [m/s³]

  [[nodiscard]] constexpr double position_at(double t) const noexcept {
    return position + t * (velocity + t * (0.5 * acceleration + t * (jerk / 6.0)));
  }
  [[nodiscard]] constexpr double velocity_at(double t) const noexcept {
    return velocity + t * (acceleration + t * (0.5 * jerk));
  }
  /// The same motion, expanded a time t later.
  [[nodiscard]] constexpr MotionAhead later(double t) const noexcept {
    return {position_at(t), velocity_at(t), acceleration + t * jerk, jerk};
  }
};

}  // namespace stribeck::control
