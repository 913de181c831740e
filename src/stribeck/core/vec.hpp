#pragma once
/// Small vectors and matrices over any Real scalar, by value.
/// Real time: safe.
/// Not Eigen: these also hold Taylor series and jets, for which Eigen needs traits of each scalar.

#include <array>
#include <cstddef>
#include <stribeck/core/scalar.hpp>
#include <stribeck/core/unrolled.hpp>

namespace stribeck {

template <class T, std::size_t N>
struct Vec {
  std::array<T, N> c{};

  constexpr T& operator[](std::size_t i) noexcept { return c[i]; }
  constexpr const T& operator[](std::size_t i) const noexcept { return c[i]; }

  friend constexpr Vec operator+(const Vec& a, const Vec& b) noexcept {
    return zip(a, b, [](const T& x, const T& y) { return x + y; });
  }
  friend constexpr Vec operator-(const Vec& a, const Vec& b) noexcept {
    return zip(a, b, [](const T& x, const T& y) { return x - y; });
  }
  friend constexpr Vec operator*(const T& s, const Vec& a) noexcept {
    return zip(a, a, [&](const T& x, const T&) { return s * x; });
  }
  friend constexpr bool operator==(const Vec&, const Vec&) = default;

  /// Element by element.
  template <class F>
  static constexpr Vec zip(const Vec& a, const Vec& b, F f) noexcept {
    Vec r;
    unrolled<N>([&](auto i) { r.c[i] = f(a.c[i], b.c[i]); });
    return r;
  }
};

template <class T, std::size_t N>
constexpr T dot(const Vec<T, N>& a, const Vec<T, N>& b) noexcept {
  T s = a[0] * b[0];
  unrolled<N - 1>([&](auto i) { s = s + a[i + 1] * b[i + 1]; });
  return s;
}

template <class T, std::size_t N>
T norm(const Vec<T, N>& a) noexcept {
  return sqrt(dot(a, a));
}

/// Row-major N × N matrix.
template <class T, std::size_t N>
struct Mat {
  std::array<Vec<T, N>, N> row{};

  constexpr Vec<T, N>& operator[](std::size_t i) noexcept { return row[i]; }
  constexpr const Vec<T, N>& operator[](std::size_t i) const noexcept { return row[i]; }
};

template <class T, std::size_t N>
constexpr Vec<T, N> operator*(const Mat<T, N>& m, const Vec<T, N>& v) noexcept {
  Vec<T, N> r;
  unrolled<N>([&](auto i) { r[i] = dot(m[i], v); });
  return r;
}

template <class T, std::size_t N>
constexpr Mat<T, N> operator*(const Mat<T, N>& a, const Mat<T, N>& b) noexcept {
  Mat<T, N> r;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) {
      T sum = a[i][0] * b[0][j];
      for (std::size_t k = 1; k < N; ++k) sum = sum + a[i][k] * b[k][j];
      r[i][j] = sum;
    }
  }
  return r;
}

template <class T, std::size_t N>
constexpr Mat<T, N> transpose(const Mat<T, N>& m) noexcept {
  Mat<T, N> r;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) r[i][j] = m[j][i];
  }
  return r;
}

using Vec2 = Vec<double, 2>;
using Mat2 = Mat<double, 2>;

}  // namespace stribeck
