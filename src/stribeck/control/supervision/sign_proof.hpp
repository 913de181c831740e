#pragma once
/// Limits the force of one axis until the encoder has once shown that the axis moves in the direction of the force.
///
///   unproven    f within load ± start, and within the force limit
///   push run    periods for which f − load has kept its sign with |f − load| ≥ level/2, counted once the delay is over
///   proven      in a push run, moved with it by 5 µm and 10 encoder steps, and no slower than at its start; from then on no limit
///
///   start, level see limits.hpp. Not slower: with a wrong sign, an axis that the force brakes seems to move with it as well.
/// A wrong sign needs some periods until it is seen (motion_check.hpp). A stiff law would ask for full force in the first of them.
/// Source: Stribeck's own; docs/theory/supervision.md.
/// Not modelled: an external force that moves the axis with the push.
/// Real time: safe.

#include <stribeck/control/supervision/limits.hpp>

namespace stribeck::control {

class SignProof {
 public:
  struct State {
    bool proven = false;
    double direction = 0.0;  ///< of the push run
    int pushed = 0;          ///< its length [periods]
    double begin_position = 0.0;
    double begin_speed = 0.0;
  };

  /// The force after this limit [N].
  [[nodiscard]] static double limited(const State& s, const SupervisionLimits& l, double force) noexcept {
    if (s.proven) return force;
    return clamp_to(clamp_to(force, l.load - l.start, l.load + l.start), -l.force, l.force);
  }

  /// One good sample: position [m] and smoothed velocity [m/s] now, force for the coming period [N].
  static void step(State& s, const SupervisionLimits& l, double position, double velocity,
                   double force) noexcept {
    if (s.proven) return;
    if (s.pushed == l.late_periods + kSettled) {
      s.begin_position = position;
      s.begin_speed = abs(velocity);
    } else if (s.pushed > l.late_periods + kSettled) {
      s.proven = (position - s.begin_position) * s.direction >= max_of(kLeastTravel, kSteps * l.step) &&
                 velocity * s.direction >= s.begin_speed;
    }
    const double net = force - l.load;
    const double direction = abs(net) >= 0.5 * l.level ? sign(net) : 0.0;
    if (direction == 0.0 || direction != s.direction) s.pushed = 0;
    s.direction = direction;
    if (direction != 0.0 && s.pushed < 1000000) ++s.pushed;
  }

 private:
  static constexpr int kSettled = 2;            ///< periods until a force shows in a difference of positions
  static constexpr double kLeastTravel = 5e-6;  ///< [m]
  static constexpr double kSteps = 10.0;
};

}  // namespace stribeck::control
