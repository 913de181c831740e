#pragma once
/// Damping of pre-sliding that fades with speed, so that it does not act like viscous friction while sliding.
///
///   σ(v) = σ·exp(−(v/v_d)²)      v_d [m/s]; without v_d it does not fade
///
/// Beyond |v| = 6.3 v_d, a factor below 1e-17, it counts as zero.
/// Source: Olsson, Control Systems with Friction, 1996.
/// Real time: safe.

#include <optional>
#include <stribeck/core/scalar.hpp>

namespace stribeck::friction {

template <Real T>
T fading_damping(const T& sigma, const std::optional<T>& fade, const T& v) noexcept {
  if (!fade) return sigma;
  // Compared as products: far from a reversal, which is nearly always, neither division nor exponential is needed.
  const T limit = *fade * *fade;
  const auto alive = v * v < T(40.0) * limit;
  if (!any(alive)) return T(0.0);
  return select(alive, sigma * exp(-(v * v / limit)), T(0.0));
}

}  // namespace stribeck::friction
