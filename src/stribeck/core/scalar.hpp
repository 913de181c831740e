#pragma once
/// The scalar of the scalar-generic tier: double in the servo loop, a truncated Taylor series along a path,
/// a jet (automatic derivatives) in identification.
///
/// Laws are written once, as templates over a Real T, under these rules:
///   - no `if` or `?:` on a value that depends on data: select(condition, a, b), both sides evaluated;
///   - functions are called without a namespace (exp, not std::exp), so that each scalar brings its own;
///   - value_of(x) is the only conversion to double.
/// Derivatives at a kink (sgn, abs) are one-sided from the current side, never infinite.
/// Real time: safe.

#include <cmath>
#include <concepts>

namespace stribeck {

using std::abs;
using std::atan2;
using std::cos;
using std::exp;
using std::isfinite;
using std::log;
using std::pow;
using std::sin;
using std::sqrt;
using std::tanh;

/// a where the condition holds, else b. For scalars whose comparison is a bool; a scalar whose comparison is
/// a mask brings its own overload.
template <class T>
constexpr T select(bool condition, const T& a, const T& b) noexcept {
  return condition ? a : b;
}

/// True if any lane holds; lets a law skip work whose result select() would discard.
constexpr bool any(bool condition) noexcept { return condition; }

constexpr double value_of(double x) noexcept { return x; }

/// Arithmetic, ordering and the functions that the laws use.
template <class T>
concept Real = std::copyable<T> && requires(T a, T b, double d) {
  T(d);
  { a + b } -> std::convertible_to<T>;
  { a - b } -> std::convertible_to<T>;
  { a* b } -> std::convertible_to<T>;
  { a / b } -> std::convertible_to<T>;
  { -a } -> std::convertible_to<T>;
  select(a < b, a, b);
  exp(a);
  sin(a);
  cos(a);
};

/// Sign, with sgn(0) = 0.
template <Real T>
constexpr T sign(const T& x) noexcept {
  return select(x > T(0.0), T(1.0), select(x < T(0.0), T(-1.0), T(0.0)));
}

template <Real T>
constexpr T min_of(const T& a, const T& b) noexcept {
  return select(b < a, b, a);
}

template <Real T>
constexpr T max_of(const T& a, const T& b) noexcept {
  return select(a < b, b, a);
}

/// x limited to [lo, hi].
template <Real T>
constexpr T clamp_to(const T& x, const T& lo, const T& hi) noexcept {
  return min_of(max_of(x, lo), hi);
}

inline constexpr double kPi = 3.14159265358979323846;

}  // namespace stribeck
