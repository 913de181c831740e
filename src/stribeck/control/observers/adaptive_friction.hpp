#pragma once
/// Adaptive friction: a first-order filter of the force that the nominal model of an axis lacks.
///
///   β_e' = K_c·(f_u − f_nom − β_e + K_c·m·q̇),   β̂ = β_e − K_c·m·q̇  (4.23)      so that   dβ̂/dt = K_c·(β − β̂)
///   β = f_u − f_nom − m·q̈;   f_nom + β̂ is added to the feedback  (4.22)
///
///   f_u force on the axis [N], f_nom nominal friction and load at the reference [N], q̇ measured velocity [m/s], m mass [kg],
///   K_c gain [1/s]. β̂ > 0 brakes a motion in +x; the controller adds it. Stable for every K_c > 0: one pole at −K_c.
///
/// Advanced exactly over one period with f_u − f_nom held, which is the printed law with q̈ the difference quotient of the
/// measured velocity; β_e itself need not be carried.
/// Source: thesis (4.22), (4.23), with the units corrected (docs/corrections-to-the-thesis.md).
/// Not modelled: the half sample by which a differentiated encoder is late.
/// Real time: safe; the constructor configure only.

#include <stribeck/core/vec.hpp>

namespace stribeck::control {

class AdaptiveFriction {
 public:
  struct State {
    double beta = 0.0;      ///< β̂ [N]
    double velocity = 0.0;  ///< of the last step [m/s]
  };

  AdaptiveFriction() = default;
  /// gain K_c [1/s], > 0; mass [kg]; period [s].
  AdaptiveFriction(double gain, double mass, double period) noexcept
      : keep_(exp(-gain * period)), mass_per_period_(mass / period) {}

  /// One period: force f_u − f_nom [N] held since the last call, velocity [m/s] measured now. Returns β̂ [N].
  double step(State& s, double force, double velocity) const noexcept {
    const double missed = force - mass_per_period_ * (velocity - s.velocity);
    s.beta = keep_ * s.beta + (1.0 - keep_) * missed;
    s.velocity = velocity;
    return s.beta;
  }

  /// The same without a measurement: β̂ stays, and the velocity follows the model.
  void predict(State& s, double force) const noexcept { s.velocity += (force - s.beta) / mass_per_period_; }

 private:
  double keep_ = 1.0;
  double mass_per_period_ = 0.0;
};

}  // namespace stribeck::control
