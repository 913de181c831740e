#pragma once
/// Truncated Taylor arithmetic: a value with its first N derivatives with respect to one variable, carried as
/// the coefficients c[k] = f⁽ᵏ⁾/k! through every operation. A path written once as q(φ) yields its
/// derivatives from it.
///
///   Taylor<4> phi = Taylor<4>::variable(0.3);
///   (sin(phi)).derivative(3)  →  −cos 0.3
///
/// Comparisons use the value.
/// Source: Griewank, Walther, Evaluating Derivatives, 2nd ed., chapter 13.
/// Real time: safe.

#include <array>
#include <stribeck/core/scalar.hpp>
#include <stribeck/core/unrolled.hpp>

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
    unrolled<N + 1>([&](auto k) { r.c[k] = a.c[k] + b.c[k]; });
    return r;
  }
  friend constexpr Taylor operator-(const Taylor& a, const Taylor& b) noexcept {
    Taylor r;
    unrolled<N + 1>([&](auto k) { r.c[k] = a.c[k] - b.c[k]; });
    return r;
  }
  friend constexpr Taylor operator-(const Taylor& a) noexcept { return Taylor(0.0) - a; }
  friend constexpr Taylor operator*(const Taylor& a, const Taylor& b) noexcept {
    Taylor r;
    unrolled<N + 1>([&](auto k) {
      double sum = a.c[0] * b.c[k];
      unrolled<k>([&](auto i) { sum += a.c[i + 1] * b.c[k - i - 1]; });
      r.c[k] = sum;
    });
    return r;
  }
  friend constexpr Taylor operator*(double a, const Taylor& b) noexcept {
    Taylor r;
    unrolled<N + 1>([&](auto k) { r.c[k] = a * b.c[k]; });
    return r;
  }
  friend constexpr Taylor operator/(const Taylor& a, const Taylor& b) noexcept {
    Taylor r;
    r.c[0] = a.c[0] / b.c[0];
    const double inverse = 1.0 / b.c[0];
    unrolled<N>([&](auto j) {
      constexpr std::size_t k = j + 1;
      double sum = a.c[k];
      unrolled<k>([&](auto i) { sum -= r.c[i] * b.c[k - i]; });
      r.c[k] = sum * inverse;
    });
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
    const double inverse = 0.5 / r.c[0];
    unrolled<N>([&](auto j) {
      constexpr std::size_t k = j + 1;
      double sum = a.c[k];
      unrolled<k - 1>([&](auto i) { sum -= r.c[i + 1] * r.c[k - i - 1]; });
      r.c[k] = sum * inverse;
    });
    return r;
  }
  /// Angle of (x, y), not both 0: θ' = (x·y' − y·x')/(x² + y²).
  friend Taylor atan2(const Taylor& y, const Taylor& x) noexcept {
    const Taylor square = x * x + y * y;
    Taylor r(std::atan2(y.c[0], x.c[0]));
    for (int k = 1; k <= N; ++k) {
      double sum = 0.0;
      for (int i = 1; i <= k; ++i) sum += i * (y.c[i] * x.c[k - i] - x.c[i] * y.c[k - i]);
      for (int i = 1; i < k; ++i) sum -= i * r.c[i] * square.c[k - i];
      r.c[k] = sum / (k * square.c[0]);
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
    bool linear = true;
    for (int k = 2; k <= N; ++k) linear = linear && a.c[k] == 0.0;
    if (linear) {  // most paths need only this branch, which takes a third of the time
      unrolled<N>([&](auto j) {
        constexpr double kShare = 1.0 / (j + 1);
        s.c[j + 1] = kShare * a.c[1] * c.c[j];
        c.c[j + 1] = -(kShare * a.c[1] * s.c[j]);
      });
      return {s, c};
    }
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
