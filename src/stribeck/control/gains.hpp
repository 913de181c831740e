#pragma once
/// Gains of a second-order error law.
/// Real time: safe.

namespace stribeck::control {

/// Proportional and derivative gain.
struct Gains {
  double kp = 0.0;  ///< [1/s²]
  double kv = 0.0;  ///< [1/s]

  /// A double pole at ω [rad/s]: k_p = ω², k_v = 2ω.
  static constexpr Gains critical(double omega) noexcept { return {omega * omega, 2.0 * omega}; }
};

}  // namespace stribeck::control
