#pragma once
/// The force of one axis after a fault: brakes against the last known motion, then holds the load.
///
///   brake   f = load − sgn(v₀)·B,   B = clamp(m|v₀|/t − F(v̂), 0, 0.8·limit),   v̂' = −(B + F(v̂))/m,   v̂(0) = |v₀|
///           without a limit B is at most m·100 m/s², more than feed drives can do
///           until v̂ < v₀/10, for at most t = the rest of the stop time
///   ramp    at rest, from the last force to the final one in 20 ms, for at most t
///   end     load: gravity is held until a brake has closed; 0 at once after a wrong sign
///
///   F(v̂) friction of the model. Nothing is measured any more: v̂ is the model's. With B above static friction an axis that stops
///   early is moved backwards, by (ΔF/m)·t²/2 at most.
/// Source: Stribeck's own; docs/theory/supervision.md has the distances.
/// Real time: safe.

#include <stribeck/control/supervision/fault.hpp>
#include <stribeck/control/supervision/limits.hpp>

namespace stribeck::control {

class SafeStop {
 public:
  struct State {
    double force = 0.0;     ///< last output [N]
    double end = 0.0;       ///< the safe force [N]
    double velocity = 0.0;  ///< v̂, with its sign [m/s]
    double least = 0.0;     ///< v̂ at which braking ends [m/s]
    double brake = 0.0;     ///< B [N]
    double ramp = 0.0;      ///< of the force per period [N]
    int left = 0;           ///< periods until the safe force
    bool brakes = false;
  };

  SafeStop() = default;
  SafeStop(const SupervisionLimits& l, const friction::Model& friction) noexcept
      : l_(l), friction_(friction) {}

  /// Starts from the force [N] and velocity [m/s] of the last period; `used` periods of the stop time are over.
  void begin(State& s, Reaction how, double force, double velocity, int used) const noexcept {
    s = {};
    s.end = how == Reaction::kCut ? 0.0 : clamp_to(l_.load, -l_.force, l_.force);
    s.left = how == Reaction::kCut ? 0 : l_.stop_periods - used - 1;
    if (s.left < 0) s.left = 0;
    s.force = force;
    s.velocity = velocity;
    if (s.left == 0) return;
    s.brakes = abs(velocity) > l_.rattle();
    if (s.brakes) {
      const double wanted = l_.mass * abs(velocity) / (l_.period * s.left) - friction(velocity);
      s.brake = clamp_to(wanted, 0.0, isfinite(l_.force) ? kShare * l_.force : kMostBraking * l_.mass);
      s.least = kLeast * abs(velocity);
    } else {
      const int ramp = static_cast<int>(kRamp / l_.period) + 1;
      if (ramp < s.left) s.left = ramp;
      s.ramp = (s.end - s.force) / s.left;
    }
  }

  double step(State& s) const noexcept {
    if (s.left <= 0) return s.force = s.end;
    --s.left;
    if (!s.brakes) return s.force += s.ramp;
    const double direction = sign(s.velocity);
    const double lost = l_.period * (s.brake + friction(s.velocity)) / l_.mass;
    s.force = clamp_to(l_.load - direction * s.brake, -l_.force, l_.force);
    s.velocity -= direction * lost;
    if (s.velocity * direction <= s.least) s.left = 0;
    return s.force;
  }

 private:
  static constexpr double kShare = 0.8;
  static constexpr double kLeast = 0.1;
  static constexpr double kMostBraking = 100.0;  ///< [m/s²]
  static constexpr double kRamp = 20e-3;         ///< [s]

  [[nodiscard]] double friction(double v) const noexcept {
    const auto p = friction_.parts(v, 0.0);
    return max_of(p.level + abs(p.viscous), 0.0);
  }

  SupervisionLimits l_;
  friction::Model friction_;
};

}  // namespace stribeck::control
