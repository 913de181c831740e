#pragma once
/// Common parts of paths of several pieces: finding the piece, and its polynomial with derivatives.
/// Real time: safe.

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <stribeck/core/taylor.hpp>
#include <stribeck/core/unrolled.hpp>
#include <stribeck/core/vec.hpp>

namespace stribeck::path::detail {

/// Σ c_k·u^k of N axes, for any scalar.
template <Real T, std::size_t N, std::size_t Terms>
constexpr Vec<T, N> polynomial(const std::array<Vec<double, N>, Terms>& c, const T& u) noexcept {
  Vec<T, N> q;
  unrolled<N>([&](auto i) {
    q[i] = T(c[Terms - 1][i]);
    unrolled<Terms - 1>([&](auto k) { q[i] = q[i] * u + T(c[Terms - 2 - k][i]); });
  });
  return q;
}

/// The same for a series, several times faster than by products of series: the polynomial is shifted to the value of u, then
/// composed with the powers of the remaining part of u, whose leading coefficients are zero.
template <int K, std::size_t N, std::size_t Terms>
requires(K > 0) constexpr Vec<Taylor<K>, N> polynomial(const std::array<Vec<double, N>, Terms>& c,
                                                       const Taylor<K>& u) noexcept {
  constexpr std::size_t kLast = Terms - 1;
  constexpr std::size_t kPowers = std::size_t{K} < kLast ? std::size_t{K} : kLast;
  std::array<std::array<double, K + 1>, kPowers> power{};  // power[j]: the (j + 1)-th
  unrolled<K>([&](auto k) { power[0][k + 1] = u.c[k + 1]; });
  unrolled<kPowers - 1>([&](auto j) {
    unrolled<K - 1 - j>([&](auto k) {  // its term j + 2 + k
      double sum = 0.0;
      unrolled<k + 1>([&](auto i) { sum += power[j][j + 1 + i] * power[0][k + 1 - i]; });
      power[j + 1][j + 2 + k] = sum;
    });
  });
  Vec<Taylor<K>, N> q;
  unrolled<N>([&](auto i) {
    std::array<double, Terms> b;
    unrolled<Terms>([&](auto k) { b[k] = c[k][i]; });
    unrolled<kPowers + (kPowers < kLast ? 1 : 0)>(
        [&](auto k) { unrolled<kLast - k>([&](auto j) { b[kLast - 1 - j] += u.c[0] * b[kLast - j]; }); });
    q[i].c[0] = b[0];
    unrolled<K>([&](auto k) {
      double sum = 0.0;
      unrolled<(k + 1 < kPowers ? k + 1 : kPowers)>([&](auto j) { sum += b[j + 1] * power[j][k + 1]; });
      q[i].c[k + 1] = sum;
    });
  });
  return q;
}

/// Index of the item whose begin is the last one at or before phi; items ascend in begin. The search starts where even spacing
/// would put it, so that it ends at once along a path of equal segments.
template <class Item>
std::size_t item_at(std::span<const Item> items, double phi, double length) noexcept {
  const std::size_t last = items.size() - 1;
  const double share = phi / length * static_cast<double>(items.size());
  std::size_t lo =
      share > 0.0 ? (share < static_cast<double>(last) ? static_cast<std::size_t>(share) : last) : 0;
  std::size_t step = 1;
  std::size_t hi = lo + 1;
  while (lo > 0 && phi < items[lo].begin) {
    hi = lo;
    lo = lo > step ? lo - step : 0;
    step *= 2;
  }
  for (step = 1; hi <= last && !(phi < items[hi].begin); step *= 2) {
    lo = hi;
    hi += step;
  }
  hi = hi > last ? last + 1 : hi;
  while (hi - lo > 1) {
    const std::size_t middle = lo + (hi - lo) / 2;
    (phi < items[middle].begin ? hi : lo) = middle;
  }
  return lo;
}

/// φ wrapped into [0, period) if the path is closed.
template <Real T>
T in_lap(const T& phi, double period, bool closed) noexcept {
  const double laps = closed ? std::floor(value_of(phi) / period) : 0.0;
  return phi - T(laps * period);
}

}  // namespace stribeck::path::detail
