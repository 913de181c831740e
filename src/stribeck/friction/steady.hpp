#pragma once
/// Steady-state friction of a drive in three parts, so that any map composes with any dynamics:
///
///   F(v, x) = level · sgn v + viscous + additive
///
///   level     [N]  ≥ 0, follows the direction of motion; the curve g(v) of LuGre and GMS
///   viscous   [N]  follows the velocity; stays outside the bristle
///   additive  [N]  keeps its sign when the motion reverses (position, gravity); outside the bristle
///
/// F opposes motion: positive for v > 0. sgn 0 = 0, so that a drive at rest is not asked for Coulomb force.
/// A steady map is a parameter struct with `SteadyParts<T> parts(T v, T x) const noexcept`. A map for a model (model.hpp)
/// also offers:
///
///   scaled(factor)                level and viscous part × factor
///   viscous_alone()               the map without level
///   viscous_coefficient(side)     viscous part divided by v for side = ±1 [N·s/m]; so that part must be proportional to v
///   identified_range()            lowest and highest velocity of its data [m/s]; absent where there are none
///
/// Real time: safe.

#include <array>
#include <concepts>
#include <optional>
#include <stribeck/core/scalar.hpp>
#include <variant>

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

template <class M>
concept SteadyLaw = SteadyMap<M, double> && std::copyable<M> && requires(const M& map, double x) {
  { map.scaled(x) } -> std::same_as<M>;
  { map.viscous_alone() } -> std::same_as<M>;
  { map.viscous_coefficient(x) } -> std::convertible_to<double>;
  { map.identified_range() } -> std::same_as<std::optional<std::array<double, 2>>>;
};
template <class Maps>
inline constexpr bool kAllSteadyLaws = false;
template <class... M>
inline constexpr bool kAllSteadyLaws<std::variant<M...>> = (SteadyLaw<M> && ...);

/// Steady friction force [N] at velocity v [m/s] and position x [m].
template <Real T, SteadyMap<T> M>
T steady_force(const M& map, const T& v, const T& x = T(0.0)) noexcept {
  const SteadyParts<T> p = map.parts(v, x);
  return p.level * sign(v) + p.viscous + p.additive;
}

}  // namespace stribeck::friction
