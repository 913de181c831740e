#pragma once
/// Truncated Taylor arithmetic: a value with its first N derivatives with respect to one variable, carried as
/// the coefficients c[k] = f⁽ᵏ⁾/k! through every operation. A path written once as q(φ) yields its
/// derivatives from it.
///
///   Taylor<4> phi = Taylor<4>::variable(0.3);
///   (sin(phi)).derivative(3)  →  −cos 0.3
///
/// Comparisons look at the value.
/// Source: Griewank, Walther, Evaluating Derivatives, 2nd ed., chapter 13.
/// Real time: safe.

#include <array>
#include <stribeck/core/scalar.hpp>

namespace stribeck {

template <int N>
struct Taylor {
  std::array<double, N + 1> c{};

  constexpr Taylor() = default;
  constexpr Taylor(double value) noexcept : c{value} {}  // NOLINT: a constant is a series

  /// The variable itself at a value: derivative 1, then 0.
  static constexpr Taylor variable(double value) noexcept {
    Taylor t(value);
    if constexpr (N > 0) t.c[1] = 1.0;
    return t;
  }

  /// k-th derivative, k ≤ N.
  [[nodiscard]] constexpr double derivative(int k) const noexcept {
    double f = c[k];
    for (int i = 2; i <= k; ++i) f *= i;
    return f;
  }

  friend constexpr Taylor operator+(const Taylor& a, const Taylor& b) noexcept {
    Taylor r;
    for (int k = 0; k <= N; ++k) r.c[k] = a.c[k] + b.c[k];
    return r;
  }
  friend constexpr Taylor operator-(const Taylor& a, const Taylor& b) noexcept {
    Taylor r;
    for (int k = 0; k <= N; ++k) r.c[k] = a.c[k] - b.c[k];
    return r;
  }
  friend constexpr Taylor operator-(const Taylor& a) noexcept { return Taylor(0.0) - a; }
  friend constexpr Taylor operator*(const Taylor& a, const Taylor& b) noexcept {
    Taylor r;
    for (int k = 0; k <= N; ++k) {
      for (int i = 0; i <= k; ++i) r.c[k] += a.c[i] * b.c[k - i];
    }
    return r;
  }
  friend constexpr Taylor operator/(const Taylor& a, const Taylor& b) noexcept {
    Taylor r;
    for (int k = 0; k <= N; ++k) {
      double s = a.c[k];
      for (int i = 0; i < k; ++i) s -= r.c[i] * b.c[k - i];
      r.c[k] = s / b.c[0];
    }
    return r;
  }
  friend constexpr bool operator<(const Taylor& a, const Taylor& b) noexcept { return a.c[0] < b.c[0]; }
  friend constexpr bool operator>(const Taylor& a, const Taylor& b) noexcept { return a.c[0] > b.c[0]; }

  friend Taylor exp(const Taylor& a) noexcept {
    Taylor r(std::exp(a.c[0]));
    for (int k = 1; k <= N; ++k) {
      double s = 0.0;
      for (int i = 1; i <= k; ++i) s += i * a.c[i] * r.c[k - i];
      r.c[k] = s / k;
    }
    return r;
  }
  friend Taylor sqrt(const Taylor& a) noexcept {
    Taylor r(std::sqrt(a.c[0]));
    for (int k = 1; k <= N; ++k) {
      double s = a.c[k];
      for (int i = 1; i < k; ++i) s -= r.c[i] * r.c[k - i];
      r.c[k] = s / (2.0 * r.c[0]);
    }
    return r;
  }
  friend Taylor sin(const Taylor& a) noexcept { return sin_cos(a)[0]; }
  friend Taylor cos(const Taylor& a) noexcept { return sin_cos(a)[1]; }
  friend constexpr Taylor abs(const Taylor& a) noexcept { return a.c[0] < 0.0 ? -a : a; }

 private:
  static std::array<Taylor, 2> sin_cos(const Taylor& a) noexcept {
    Taylor s(std::sin(a.c[0]));
    Taylor c(std::cos(a.c[0]));
    for (int k = 1; k <= N; ++k) {
      double ds = 0.0;
      double dc = 0.0;
      for (int i = 1; i <= k; ++i) {
        ds += i * a.c[i] * c.c[k - i];
        dc -= i * a.c[i] * s.c[k - i];
      }
      s.c[k] = ds / k;
      c.c[k] = dc / k;
    }
    return {s, c};
  }
};

template <int N>
constexpr double value_of(const Taylor<N>& t) noexcept {
  return t.c[0];
}

}  // namespace stribeck
