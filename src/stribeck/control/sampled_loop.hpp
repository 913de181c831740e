#pragma once
/// Stability of the loop that most laws here close on each axis: PID on a mass, sampled. It is exact for the zero-order hold and the
/// differenced error; a condition in continuous time is only its limit for short periods.
///
///   a_k = −k_p e_k − k_v (e_k − e_{k−1})/T − k_i I_k,   I_k = I_{k−1} + T e_k,   ë = a_k held over T
///   z(z−1)³ + (T²/2)(z+1)·{ k_p z(z−1) + (k_v/T)(z−1)² + k_i T z² } = 0       (without k_i one factor z−1 less)
///
///   k_p [1/s²], k_v [1/s], k_i [1/s³], T [s]. Stable: all roots inside the unit circle. For T → 0 that is Routh's
///   k_i < k_p k_v; with k_i = 0 it is k_p T < 2k_v(2 − k_v T)/(2 + k_v T) and k_v T < 2, for a double pole ω T < 0.70.
///
/// Source: Schur 1918 and Cohn 1922; Jury 1964, Theory and Application of the z-Transform Method.
/// Not modelled: delay, friction, wrong mass; each reduces the margin.
/// Real time: safe.

#include <array>
#include <cstddef>

namespace stribeck::control {

/// Whether c[0] + c[1] z + … + c[N−1] z^(N−1), c[N−1] > 0, has all its roots inside the unit circle (Schur–Cohn).
template <std::size_t N>
constexpr bool roots_inside_unit_circle(std::array<double, N> c) noexcept {
  for (std::size_t last = N - 1; last > 0; --last) {
    if (!(c[0] < c[last] && -c[0] < c[last])) return false;
    const double share = c[0] / c[last];
    std::array<double, N> next{};
    for (std::size_t i = 0; i < last; ++i) next[i] = c[i + 1] - share * c[last - 1 - i];
    c = next;
  }
  return true;
}

constexpr bool sampled_loop_stable(double kp, double kv, double ki, double period) noexcept {
  // The braces in powers of z, then times (T²/2)(z+1), then plus the free mass.
  const double p = kp;
  const double v = kv / period;
  const double h = 0.5 * period * period;
  if (!(ki != 0.0)) {
    // One factor z−1 less: { k_p z + (k_v/T)(z−1) }.
    const double b0 = -v;
    const double b1 = p + v;
    return roots_inside_unit_circle<4>({h * b0, 1.0 + h * (b0 + b1), -2.0 + h * b1, 1.0});
  }
  const double b0 = v;
  const double b1 = -p - 2.0 * v;
  const double b2 = p + v + ki * period;
  return roots_inside_unit_circle<5>({h * b0, -1.0 + h * (b0 + b1), 3.0 + h * (b1 + b2), -3.0 + h * b2, 1.0});
}

}  // namespace stribeck::control
