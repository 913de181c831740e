#pragma once
/// Steady-state friction of a drive in three parts, so that any map composes with any dynamics:
///
///   F(v, x) = level · sgn v + viscous + additive
///
///   level     [N]  ≥ 0, follows the direction of motion; the curve g(v) of LuGre and GMS
///   viscous   [N]  follows the velocity; stays outside the bristle
///   additive  [N]  keeps its sign when the motion reverses (position, gravity); outside the bristle
///
/// F opposes motion: positive for v > 0. sgn 0 = 0, so that a drive at rest is asked for no Coulomb force.
/// A steady map is a parameter struct with `SteadyParts<T> parts(T v, T x) const noexcept`.
/// Real time: safe.

#include <concepts>
#include <stribeck/core/scalar.hpp>

namespace stribeck::friction {

template <Real T>
struct SteadyParts {
  T level{0.0};
  T viscous{0.0};
  T additive{0.0};
};

template <class M, class T>
concept SteadyMap = Real<T> && requires(const M& map, const T& t) {
  { map.parts(t, t) } -> std::same_as<SteadyParts<T>>;
};

/// Steady friction force [N] at velocity v [m/s] and position x [m].
template <Real T, SteadyMap<T> M>
T steady_force(const M& map, const T& v, const T& x = T(0.0)) noexcept {
  const SteadyParts<T> p = map.parts(v, x);
  return p.level * sign(v) + p.viscous + p.additive;
}

}  // namespace stribeck::friction
