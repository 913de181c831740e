#pragma once
/// The interface of a path: any type with
///
///   static constexpr std::size_t kAxes               number of axes N
///   Vec<T, N> point(const T& φ) const noexcept       T = double or a Taylor series, written once
///   double period() const noexcept                   range of φ: one lap, or from end to end
///   bool closed() const noexcept                     φ and φ + period() are the same place
///
/// Derivatives come from Taylor arithmetic and are exact; paths need no code for them.
/// Real time: safe.

#include <array>
#include <concepts>
#include <stribeck/core/taylor.hpp>
#include <stribeck/core/vec.hpp>

namespace stribeck::path {

template <class C>
concept PathCurve = requires(const C& c, double phi) {
  { C::kAxes } -> std::convertible_to<std::size_t>;
  { c.point(phi) } -> std::same_as<Vec<double, C::kAxes>>;
  { c.period() } -> std::convertible_to<double>;
  { c.closed() } -> std::convertible_to<bool>;
};

/// The path around φ as a series of order K.
template <int K, PathCurve C>
Vec<Taylor<K>, C::kAxes> series(const C& curve, double phi) noexcept {
  return curve.point(Taylor<K>::variable(phi));
}

/// Value and derivatives with respect to φ up to order K: element k is the k-th derivative.
template <int K, PathCurve C>
std::array<Vec<double, C::kAxes>, K + 1> derivatives(const C& curve, double phi) noexcept {
  const auto q = series<K>(curve, phi);
  std::array<Vec<double, C::kAxes>, K + 1> d;
  for (int k = 0; k <= K; ++k) {
    for (std::size_t i = 0; i < C::kAxes; ++i) d[k][i] = q[i].derivative(k);
  }
  return d;
}

/// Arc length per φ, |q'(φ)|.
template <PathCurve C>
double stretch(const C& curve, double phi) noexcept {
  return norm(derivatives<1>(curve, phi)[1]);
}

/// Length of one lap [m] by the trapezoidal rule, which converges exponentially for a closed analytic path; the error for an open or
/// piecewise path is of order (period/4096)².
template <PathCurve C>
double lap_length(const C& curve) noexcept {
  constexpr int kPoints = 4096;
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) sum += stretch(curve, curve.period() * i / kPoints);
  if (!curve.closed()) sum += 0.5 * (stretch(curve, curve.period()) - stretch(curve, 0.0));
  return sum * curve.period() / kPoints;
}

}  // namespace stribeck::path
