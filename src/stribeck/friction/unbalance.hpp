#pragma once
/// The weight of an arm or of an unbalanced table on a rotary axis that does not stand upright.
///
///   F = M·sin(x − x0)   against +x, at standstill too
///
///   M  torque while the heavy side is level with the axis, m·g·d of a mass at a distance [N m]
///   x  angle [rad]; x0 the angle at which the heavy side hangs down, where the axis rests by itself [rad]
///
/// Positive behind x0: it pulls the axis back to x0. A rotary axis is carried as a linear one at a radius of 1 m, so that x and F
/// are those of every other axis. The same law as an additive eccentric term of one turn, see eccentric.hpp: an identified
/// unbalance stands in an axis file as such a term.
///
/// Not modelled: an axis of rotation that tilts while the machine moves (five axes); the inertia, which belongs to the mass.
/// Real time: safe; one sin.

#include <cmath>
#include <stribeck/core/fields.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/friction/eccentric.hpp>

namespace stribeck::friction {

struct Unbalance {
  double torque = 0.0;    ///< M [N m]
  double hangs_at = 0.0;  ///< x0 [rad]

  static constexpr auto fields() {
    return std::tuple{
        field("torque", &Unbalance::torque, quantity("N m", "N m").positive(),
              "largest torque of the weight: mass times 9.81 m/s2 times distance from the axis"),
        field("hangs_at", &Unbalance::hangs_at, quantity("rad", "deg"),
              "angle at which the heavy side hangs down; the axis rests there by itself")};
  }

  [[nodiscard]] double at(double x) const noexcept { return torque * std::sin(x - hangs_at); }
  [[nodiscard]] Eccentric<double> term() const noexcept {
    return {torque, 2.0 * kPi, hangs_at, EccentricForm::kAdditive};
  }
};

/// Whether a term of an axis file is an unbalance: additive, one turn long.
inline bool is_unbalance(const Eccentric<double>& term) noexcept {
  return term.form == EccentricForm::kAdditive && abs(term.period - 2.0 * kPi) < 1e-6;
}

}  // namespace stribeck::friction
