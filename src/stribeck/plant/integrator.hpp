#pragma once
/// Explicit Runge–Kutta steps over a fixed-size state. The plant is hardly stiff over a control period, so
/// explicit steps with a hold of the input are enough; a solver that adapts its step would restart at every
/// tick.
///
///   rk3   Kutta's third order, three evaluations, stable on the real axis to |λh| = 2.51
///
/// Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.1.
/// Real time: safe.

#include <stribeck/core/vec.hpp>

namespace stribeck::plant {

template <class T, std::size_t N>
constexpr Vec<T, N> along(const Vec<T, N>& y, const T& h, const Vec<T, N>& k) noexcept {
  Vec<T, N> r;
  for (std::size_t i = 0; i < N; ++i) r[i] = y[i] + h * k[i];
  return r;
}

/// The caller computes k1 = rhs(y), so that it may inspect it before it chooses how to evaluate the other stages.
template <class T, std::size_t N, class Rhs>
Vec<T, N> rk3_step(const Vec<T, N>& y, const Vec<T, N>& k1, const T& h, const Rhs& rhs) noexcept {
  const Vec<T, N> k2 = rhs(along(y, T(0.5) * h, k1));
  Vec<T, N> m;
  for (std::size_t i = 0; i < N; ++i) m[i] = T(2.0) * k2[i] - k1[i];
  const Vec<T, N> k3 = rhs(along(y, h, m));
  Vec<T, N> r;
  const T sixth = h / T(6.0);
  for (std::size_t i = 0; i < N; ++i) r[i] = y[i] + sixth * (k1[i] + T(4.0) * k2[i] + k3[i]);
  return r;
}

}  // namespace stribeck::plant
