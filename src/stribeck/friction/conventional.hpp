#pragma once
/// Coulomb, viscous and Stribeck friction.
///
///   F(v) = [α0 + (α1 − α0)·exp(−|v/v0|^δ)]·sgn v + α2·v
///
///   α0 Coulomb [N], α1 static [N], α2 viscous [N·s/m], v0 Stribeck velocity [m/s], δ shape [-]
///
/// Without a Stribeck part (absent, as in the thesis's Tables 2.1 and 2.2) the bracket is α0: printed zeros
/// for v0 and δ mean "not there", not an exponent. |v| because the printed form is undefined for v < 0 and
/// odd δ.
///
/// Source: thesis (2.9); Armstrong-Hélouvry, Dupont, Canudas de Wit 1994, doi:10.1016/0005-1098(94)90209-7.
/// Not modelled: pre-sliding (see lugre.hpp, gms.hpp), a difference between the directions (see
/// gaussian.hpp).
/// Real time: safe; one exp and one pow.

#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/friction/steady.hpp>

namespace stribeck::friction {

template <Real T>
struct Stribeck {
  T alpha1{0.0};
  T v0{1e-3};
  T delta{2.0};

  static constexpr auto fields() {
    return std::tuple{
        field("alpha1", &Stribeck::alpha1, quantity("N", "N").positive(), "static friction α1 at v → 0"),
        field("v0", &Stribeck::v0, quantity("m/s", "mm/s").positive(), "Stribeck velocity"),
        field("delta", &Stribeck::delta, pure_number().positive(), "shape δ of the Stribeck part")
            .or_default()};
  }
};

template <Real T>
struct Conventional {
  static constexpr std::string_view kKind = "conventional";

  T alpha0{0.0};
  T alpha2{0.0};
  std::optional<Stribeck<T>> stribeck;

  static constexpr auto fields() {
    return std::tuple{
        field("alpha0", &Conventional::alpha0, quantity("N", "N").positive(), "Coulomb friction α0"),
        field("alpha2", &Conventional::alpha2, quantity("N s/m", "N s/mm").not_negative(),
              "viscous coefficient α2"),
        field("stribeck", &Conventional::stribeck,
              "Stribeck part; left out: the level is α0 at every velocity")
            .or_default()};
  }

  [[nodiscard]] Conventional scaled(const T& factor) const noexcept {
    Conventional map{alpha0 * factor, alpha2 * factor, stribeck};
    if (map.stribeck) map.stribeck->alpha1 = map.stribeck->alpha1 * factor;
    return map;
  }
  [[nodiscard]] Conventional viscous_alone() const noexcept { return {T(0.0), alpha2, {}}; }
  [[nodiscard]] T viscous_coefficient(double) const noexcept { return alpha2; }
  [[nodiscard]] constexpr std::optional<std::array<double, 2>> identified_range() const noexcept {
    return {};
  }

  [[nodiscard]] SteadyParts<T> parts(const T& v, const T&) const noexcept {
    T level = alpha0;
    if (stribeck) {
      // |v/v0|^δ = exp(δ·log|v/v0|); the offset keeps log finite at v = 0, where the power is 0 to 300
      // digits.
      const T ratio = abs(v / stribeck->v0) + T(1e-300);
      level = level + (stribeck->alpha1 - alpha0) * exp(-exp(stribeck->delta * log(ratio)));
    }
    return {level, alpha2 * v, T(0.0)};
  }
};

}  // namespace stribeck::friction
