#pragma once
/// Symmetric positive definite systems of half bandwidth three, open or cyclic, for several right-hand sides at once.
///
///   A = L·D·Lᵀ;  A(i, j) = 0 for 3 < |i − j| (cyclic: < n − 3)
///
/// A cyclic system keeps its last three unknowns apart as a border: eliminating the others fills only their columns. The matrix is
/// positive definite, so no pivoting is needed. O(n); the caller provides the memory.
/// Source: Golub, Van Loan, Matrix Computations, 4th ed., 4.3.6 (band), 4.1.2 (LDLᵀ).
/// Real time: configure only.

#include <array>
#include <cstddef>
#include <stribeck/core/vec.hpp>

namespace stribeck::path::detail {

inline constexpr std::size_t kBand = 3;

/// Row i of the system, lower triangle; after solving, `value` is the unknown.
template <std::size_t N>
struct Equation {
  std::array<double, kBand + 1> band{};  ///< A(i, i − k)
  std::array<double, kBand> border{};    ///< A(n − 3 + k, i), cyclic systems only
  Vec<double, N> value{};                ///< right-hand side
};

/// `at(i)` returns equation i of n.
template <std::size_t N, class At>
class BandSystem {
 public:
  BandSystem(At at, std::size_t n, bool cyclic) noexcept : at_(at), n_(n), core_(cyclic ? n - kBand : n) {}

  void clear() noexcept {
    for (std::size_t i = 0; i < n_; ++i) at_(i) = {};
  }

  /// Adds to A(i, j) and A(j, i) (once if i = j).
  void add(std::size_t i, std::size_t j, double a) noexcept {
    if (i < j) return add(j, i, a);
    if (i >= core_ && j < core_) {
      at_(j).border[i - core_] += a;
    } else {
      at_(i).band[i - j] += a;
    }
  }

  void solve() noexcept {
    factor();
    for (std::size_t i = 0; i < n_; ++i) {
      if (i < core_) {
        for (std::size_t k = 1; k <= reach(i); ++k) subtract(i, at_(i).band[k], i - k);
      } else {
        for (std::size_t p = 0; p < core_; ++p) subtract(i, at_(p).border[i - core_], p);
        for (std::size_t k = 1; k <= i - core_; ++k) subtract(i, at_(i).band[k], i - k);
      }
    }
    for (std::size_t i = 0; i < n_; ++i) at_(i).value = (1.0 / at_(i).band[0]) * at_(i).value;
    for (std::size_t i = n_; i-- > 0;) {
      const std::size_t end = i < core_ ? core_ : n_;
      for (std::size_t k = 1; k <= kBand && i + k < end; ++k) subtract(i, at_(i + k).band[k], i + k);
      for (std::size_t b = core_; i < core_ && b < n_; ++b) subtract(i, at_(i).border[b - core_], b);
    }
  }

 private:
  [[nodiscard]] static std::size_t reach(std::size_t i) noexcept { return i < kBand ? i : kBand; }

  void subtract(std::size_t i, double l, std::size_t from) noexcept {
    at_(i).value = at_(i).value - l * at_(from).value;
  }

  /// band and border become L, band[0] becomes D.
  void factor() noexcept {
    for (std::size_t i = 0; i < core_; ++i) {
      auto& row = at_(i);
      const std::size_t m = reach(i);
      for (std::size_t k = m; k >= 1; --k) {  // column i − k
        double a = row.band[k];
        for (std::size_t p = m; p > k; --p) a -= row.band[p] * at_(i - p).band[0] * at_(i - k).band[p - k];
        row.band[k] = a / at_(i - k).band[0];
      }
      for (std::size_t p = 1; p <= m; ++p) row.band[0] -= row.band[p] * row.band[p] * at_(i - p).band[0];
      for (std::size_t b = 0; b < n_ - core_; ++b) {
        double a = row.border[b];
        for (std::size_t p = 1; p <= m; ++p) a -= at_(i - p).border[b] * at_(i - p).band[0] * row.band[p];
        row.border[b] = a / row.band[0];
      }
    }
    for (std::size_t b = 0; b < n_ - core_; ++b) {
      auto& row = at_(core_ + b);
      for (std::size_t k = b + 1; k-- > 0;) {  // column b − k of the border
        double a = row.band[k];
        for (std::size_t p = 0; p < core_; ++p) a -= at_(p).border[b] * at_(p).band[0] * at_(p).border[b - k];
        for (std::size_t p = b; p > k; --p) {
          a -= row.band[p] * at_(core_ + b - p).band[0] * at_(core_ + b - k).band[p - k];
        }
        row.band[k] = k == 0 ? a : a / at_(core_ + b - k).band[0];
      }
    }
  }

  At at_;
  std::size_t n_;
  std::size_t core_;  ///< unknowns before the border
};

}  // namespace stribeck::path::detail
