#pragma once
/// Disturbance observer: estimates the force that the model of the axis does not explain.
///
///   v̂' = (f − f_ff − d̂)/m − k_ev·(v̂ − v)        d̂' = k_ed·(v̂ − v)        k_ev = 2p,  k_ed = p²·m
///
///   f force on the axis [N], f_ff feed-forward of friction in it [N], v measured velocity [m/s], d̂ estimate
///   [N], p both poles [1/s], m mass [kg]. d̂ > 0 brakes a motion in +x; a controller adds it to its force.
///
/// Advanced exactly over one period with f and v held. f_ff is subtracted; otherwise friction would be compensated
/// twice. The error obeys s² + k_ev·s + k_ed/m.
/// Source: thesis (2.22), with the corrections in docs/corrections-to-the-thesis.md.
/// Not modelled: the half sample by which a differentiated encoder is late.
/// Real time: safe; configure() configure only.

#include <stribeck/core/fields.hpp>
#include <stribeck/core/vec.hpp>

namespace stribeck::control {

class DisturbanceObserver {
 public:
  struct State {
    double velocity = 0.0;     ///< v̂ [m/s]
    double disturbance = 0.0;  ///< d̂ [N]
  };

  DisturbanceObserver() = default;
  /// pole p [1/s], > 0; mass [kg]; period [s].
  DisturbanceObserver(double pole, double mass, double period) noexcept
      : decay_(exp(-pole * period)), pt_(pole * period), p_(pole), m_(mass) {}

  /// One period: force f − f_ff [N] held since the last call, velocity [m/s] measured now. Returns d̂ [N].
  double step(State& s, double force, double velocity) const noexcept {
    // Deviation from the equilibrium of held inputs, v̂ = v and d̂ = f, where both derivatives vanish.
    const double a = s.velocity - velocity;
    const double b = (s.disturbance - force) / m_;
    // exp(A·T) with A = [−2p −1; p² 0]: a double pole, so exp(−pT)·(I + (A + pI)·T).
    const double t = pt_ / p_;
    const double a1 = decay_ * (a - pt_ * a - t * b);
    const double b1 = decay_ * (b + pt_ * b + pt_ * p_ * a);
    s.velocity = velocity + a1;
    s.disturbance = force + m_ * b1;
    return s.disturbance;
  }

  /// The same without a measurement: the disturbance stays.
  void predict(State& s, double force) const noexcept {
    s.velocity += pt_ / p_ * (force - s.disturbance) / m_;
  }

 private:
  double decay_ = 1.0;
  double pt_ = 0.0;
  double p_ = 1.0;
  double m_ = 1.0;
};

}  // namespace stribeck::control
