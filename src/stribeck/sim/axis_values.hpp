#pragma once
/// One value for each axis of a machine whose number of axes is known at run time; those beyond it are 0.
/// Real time: safe.

#include <stribeck/control/setup.hpp>

namespace stribeck::sim {

using AxisValues = Vec<double, control::kMostAxes>;

template <std::size_t N>
constexpr AxisValues widened(const Vec<double, N>& v) noexcept {
  AxisValues w;
  for (std::size_t i = 0; i < N; ++i) w[i] = v[i];
  return w;
}

/// Calls f with the number of axes as a constant: f(std::integral_constant<std::size_t, N>).
/// Returns false when no controller is built for that many.
template <class F>
constexpr bool with_axes(std::size_t n, F&& f) {
  switch (n) {
    case 1:
      f(std::integral_constant<std::size_t, 1>());
      return true;
    case 2:
      f(std::integral_constant<std::size_t, 2>());
      return true;
    case 3:
      f(std::integral_constant<std::size_t, 3>());
      return true;
    case 5:
      f(std::integral_constant<std::size_t, 5>());
      return true;
    default:
      return false;
  }
}

}  // namespace stribeck::sim
