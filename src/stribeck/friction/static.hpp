#pragma once
/// No dynamics: friction is always at its steady state.
///
///   F = g(v)·sgn v + viscous + additive
///
/// Not modelled: pre-sliding. Standstill needs an integrator that handles it (ident/replay).
/// Real time: safe.

#include <stribeck/core/fields.hpp>
#include <stribeck/core/scalar.hpp>
#include <string_view>

namespace stribeck::friction {

struct Static {
  static constexpr std::string_view kKind = "static";
  static constexpr auto fields() { return std::tuple{}; }

  struct State {};

  template <Real T>
  void advance(State&, const T&, const T&, double) const noexcept {}
  template <Real T>
  [[nodiscard]] T bristle(const State&, const T& v, const T& level, const T&) const noexcept {
    return level * sign(v);
  }
  template <Real T>
  void slide(State&, const T&) const noexcept {}
  template <Real T>
  void carry(State&, const T&) const noexcept {}
  /// There is no deflection, so nothing can be shifted.
  template <Real T>
  [[nodiscard]] T shift(State&, const T&, const T&) const noexcept {
    return T(0.0);
  }
  [[nodiscard]] Static stiffened(double) const noexcept { return *this; }
};

}  // namespace stribeck::friction
