#pragma once
/// Where a table of forces may take an axis of which friction and mass are known roughly: every combination of the lightest
/// and the heaviest axis with the least and the most friction, also with more friction in one direction than in the other.
///
///   m·v̇ = f − load(x) − F·sgn v   F the level of friction in the direction of motion; at rest while |f − load(x)| ≤ F
///   load(x) = load + M·sin(x − x0)   M the unbalance of a rotary axis; x0 unknown: four angles, a quarter turn apart
///
/// Viscous friction is left out: without it every axis goes farther and faster.
///
/// Not modelled: elasticity; friction that rises towards rest (it only keeps the axis slower).
/// Real time: no.

#include <optional>
#include <stribeck/ident/excitation/excitation.hpp>
#include <string>

namespace stribeck::ident::excitation {

/// Bounds of mass, friction and load of an axis before it has moved.
struct Doubt {
  double mass_low = 0.0;             ///< [kg]
  double mass_high = 0.0;            ///< [kg]
  double friction_low = 0.0;         ///< [N]
  double friction_high = 0.0;        ///< [N]
  double load = 0.0;                 ///< constant force against +x [N]
  double uneven = 1.5;               ///< friction of one direction over that of the other, at the most
  double unbalance = 0.0;            ///< largest torque of an unbalance [N m at a radius of 1 m]
  std::optional<double> hangs_at{};  ///< where it hangs down [rad]; absent: anywhere
  double load_spread = 0.0;          ///< the load may be smaller or larger by that much [N]

  /// Largest weight on these positions [N].
  [[nodiscard]] double weight(double lowest, double highest) const noexcept;
  /// Without force the axis may not stay where it is.
  [[nodiscard]] bool may_fall(const Limits& limits) const noexcept;
};

/// The farthest of all cases.
struct Reach {
  double lowest = 0.0;   ///< [m]
  double highest = 0.0;  ///< [m]
  double speed = 0.0;    ///< [m/s]
  std::string farthest;  ///< the case that comes nearest to a limit, in words
};

/// Of forces [N], one per sample time, from rest at `start` [m].
Reach reach_of(const std::vector<double>& force, double sample_time, double start, const Doubt& doubt,
               const Limits& limits);

/// Why the axis must not do that; empty: it may.
std::string beyond(const Reach& reach, const Limits& limits);

/// Largest force that the positions may need of the drive [N].
double force_needed(const std::vector<double>& position, double sample_time, const Doubt& doubt);

/// A design and the range of motion that it can cause.
struct SafeExcitation {
  Excitation excitation;
  Reach reach;
};

/// Pulses that stay inside travel, speed and force in every case. As design_pulses() where that does; else shorter, so that
/// they are slow on the expected axis. Refused where none does, or where the axis may fall.
SafeExcitation design_safe_pulses(const Limits& limits, const RoughDrive& drive, const Doubt& doubt,
                                  double sample_time, const PulseDesign& design);

/// The same for ramps: refused where they may leave the limits, as a ramp ends at the force that was expected.
SafeExcitation design_safe_ramp(const Limits& limits, const RoughDrive& drive, const Doubt& doubt,
                                double sample_time, const RampDesign& design);

}  // namespace stribeck::ident::excitation
