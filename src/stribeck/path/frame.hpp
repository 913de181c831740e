#pragma once
/// The frame that moves along a path: R = [t n b …], its first row in Rᵀ the unit tangent, the others across the path. All
/// derivatives are with respect to the path's parameter φ and exact.
///
///   transported   n_i' = −(t'·n_i)·t: the normals turn about the path as little as they can (rotation-minimising). Continuous
///                 through straight stretches and inflections, any number of axes; from point to point by double reflection.
///   Frenet        b = q'×q''/|q'×q''|, n = b×t. Undefined where q'' ∥ q', and n and b flip there. Three axes only.
///   printed       b = t×q''/|q''| not normalised, n = b×t, as (4.3) is printed: R is no rotation, and its gains vanish
///                 towards inflections. Where q'' = 0, e_x (or e_y) stands for it. For comparison.
///
/// On a plane path Frenet and transported frames differ by the sign of n and b only. Where Frenet's normal is undefined the
/// last one is held with derivative 0.
/// Source: thesis (4.3), (4.4); Bishop 1975, doi:10.2307/2319846; Wang, Jüttler, Zheng, Liu 2008 (double reflection),
/// doi:10.1145/1330511.1330513.
/// Real time: safe.

#include <array>
#include <stribeck/core/fields.hpp>
#include <stribeck/core/unrolled.hpp>
#include <stribeck/path/derivatives.hpp>
#include <string_view>
#include <utility>

namespace stribeck::path {

enum class FrameKind { kTransported, kFrenet, kPrinted };

/// Rᵀ and its derivatives: row 0 is that of the tangent.
template <std::size_t N>
struct Frame {
  Mat<double, N> rt;
  Mat<double, N> first;
  Mat<double, N> second;
};

template <std::size_t N>
constexpr Mat<double, N> identity() noexcept {
  Mat<double, N> m;
  for (std::size_t i = 0; i < N; ++i) m[i][i] = 1.0;
  return m;
}

template <class T>
constexpr Vec<T, 3> cross(const Vec<T, 3>& a, const Vec<T, 3>& b) noexcept {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

namespace detail {

/// n·(n − 1)·…, K factors.
constexpr double falling(std::size_t n, std::size_t k) noexcept {
  return k == 0 ? 1.0 : static_cast<double>(n) * falling(n - 1, k - 1);
}

}  // namespace detail

/// The first terms of a series.
template <int M, int L>
constexpr Taylor<M> shortened(const Taylor<L>& t) noexcept {
  static_assert(M <= L);
  Taylor<M> r;
  for (int k = 0; k <= M; ++k) r.c[k] = t.c[k];
  return r;
}

/// The K-th derivative of a series, as a series of order M.
template <int M, int K, int L, std::size_t N>
constexpr Vec<Taylor<M>, N> differentiated(const Vec<Taylor<L>, N>& q) noexcept {
  static_assert(M + K <= L);
  Vec<Taylor<M>, N> d;
  unrolled<M + 1>([&](auto k) {
    constexpr double kFactor = detail::falling(k + K, K);
    unrolled<N>([&](auto i) { d[i].c[k] = kFactor * q[i].c[k + K]; });
  });
  return d;
}

namespace detail {

template <int K, int L, std::size_t N>
constexpr Vec<double, N> derivative_of(const Vec<Taylor<L>, N>& s) noexcept {
  constexpr double kFactor = falling(K, K);
  Vec<double, N> d;
  unrolled<N>([&](auto i) { d[i] = kFactor * s[i].c[K]; });
  return d;
}

template <std::size_t N>
constexpr void set_row(Frame<N>& f, std::size_t i, const Vec<Taylor<2>, N>& s) noexcept {
  f.rt[i] = derivative_of<0>(s);
  f.first[i] = derivative_of<1>(s);
  f.second[i] = derivative_of<2>(s);
}

template <std::size_t N>
Vec<double, N> without(const Vec<double, N>& v, const Vec<double, N>& unit) noexcept {
  return v - dot(v, unit) * unit;
}

}  // namespace detail

/// First normals at a place with tangent t: the first one points to the inside of the curve where it is curved (to the left in a
/// plane); the others complete a right-handed frame from the coordinate axes.
template <std::size_t N>
Mat<double, N> first_frame(const Vec<double, N>& t, const Vec<double, N>& curvature) noexcept {
  Mat<double, N> m;
  m[0] = t;
  if constexpr (N == 2) {
    m[1] = {{-t[1], t[0]}};
    return m;
  }
  std::array<bool, N> used{};
  for (std::size_t row = 1; row < N; ++row) {
    Vec<double, N> best;
    double most = 0.0;
    std::size_t which = N;
    const auto consider = [&](Vec<double, N> v, std::size_t index) {
      for (std::size_t k = 0; k < row; ++k) v = detail::without(v, m[k]);
      const double length = norm(v);
      // A slight preference for earlier axes, so that rounding does not decide.
      if (length > most * (1.0 + 1e-9)) {
        most = length;
        best = (1.0 / length) * v;
        which = index;
      }
    };
    const double bend = norm(curvature);
    if (row == 1 && bend > 0.0) {
      const Vec<double, N> unit = (1.0 / bend) * curvature;
      if (norm(detail::without(unit, t)) > 1e-6) consider(unit, N);
    }
    if (most == 0.0) {
      for (std::size_t i = 0; i < N; ++i) {
        Vec<double, N> axis;
        axis[i] = 1.0;
        if (!used[i]) consider(axis, i);
      }
    }
    if (which < N) used[which] = true;
    m[row] = best;
  }
  if constexpr (N == 3) m[2] = cross(m[0], m[1]);
  return m;
}

/// Transported frame with the given normals (rows 1… of `rt`), from the series of the path and that of 1/|q'|.
template <int L, std::size_t N>
Frame<N> transported_frame(const Vec<Taylor<L>, N>& q, const Taylor<2>& inverse_stretch,
                           const Mat<double, N>& rt) noexcept {
  const Vec<Taylor<2>, N> t = inverse_stretch * differentiated<2, 1>(q);
  Frame<N> f;
  detail::set_row(f, 0, t);
  for (std::size_t i = 1; i < N; ++i) {
    // n' = −(t'·n) t, hence n'' = −(t''·n) t − (t'·n) t', since t'·n' = 0.
    f.rt[i] = rt[i];
    const double turn = dot(f.first[0], rt[i]);
    f.first[i] = -turn * f.rt[0];
    f.second[i] = -dot(f.second[0], rt[i]) * f.rt[0] - turn * f.first[0];
  }
  return f;
}

template <int L, std::size_t N>
Frame<N> transported_frame(const Vec<Taylor<L>, N>& q, const Mat<double, N>& rt) noexcept {
  return transported_frame(q, Taylor<2>(1.0) / norm(differentiated<2, 1>(q)), rt);
}

/// Carries the frame's normals from place x0 to place x1 with unit tangent t1, by double reflection: the error over a path is of
/// fourth order in the step. The rows of `rt` are orthonormal.
template <std::size_t N>
Mat<double, N> transport(const Mat<double, N>& rt, const Vec<double, N>& x0, const Vec<double, N>& x1,
                         const Vec<double, N>& t1) noexcept {
  const Vec<double, N> chord = x1 - x0;
  const double c1 = dot(chord, chord);
  const double ahead = dot(chord, rt[0]);
  Mat<double, N> m = rt;
  m[0] = t1;
  // A chord of rounding errors has a random direction, and reflections in such planes would turn the normals at random. In this case,
  // and when nothing moves, only the projection below is needed.
  if (ahead * ahead > 0.25 * c1 && c1 > 1e-200) {
    const double k1 = 2.0 / c1;
    const Vec<double, N> second = t1 - (rt[0] - (k1 * ahead) * chord);
    const double k2 = 2.0 / dot(second, second);
    for (std::size_t i = 1; i < N; ++i) {
      const Vec<double, N> a = rt[i] - (k1 * dot(chord, rt[i])) * chord;
      m[i] = a - (k2 * dot(second, a)) * second;
    }
  }
  // Rounding must not accumulate over millions of steps.
  for (std::size_t i = 1; i < N; ++i) {
    for (std::size_t k = 0; k < i; ++k) m[i] = detail::without(m[i], m[k]);
    const double square = dot(m[i], m[i]);
    // 1/√(1 + ε) to the last digit for the ε that reflections leave.
    m[i] = (abs(square - 1.0) < 1e-8 ? 1.5 - 0.5 * square : 1.0 / sqrt(square)) * m[i];
  }
  return m;
}

/// Frenet's frame or the printed one. `held` are the normals that are used where Frenet's are undefined.
inline Frame<3> frenet_frame(const Vec<Taylor<4>, 3>& q, bool as_printed,
                             const Mat<double, 3>& held) noexcept {
  constexpr double kParallel = 1e-9;
  const Vec<Taylor<2>, 3> v = differentiated<2, 1>(q);
  Vec<Taylor<2>, 3> a = differentiated<2, 2>(q);
  const Vec<Taylor<2>, 3> t = (Taylor<2>(1.0) / norm(v)) * v;
  Frame<3> f;
  detail::set_row(f, 0, t);
  const double bend = norm(detail::derivative_of<0>(a));
  // (4.3) on a straight stretch: e_x replaces q'', e_y where the path runs along x.
  if (as_printed && bend == 0.0) a[abs(t[0].c[0]) == 1.0 ? 1 : 0] = Taylor<2>(1.0);
  const Vec<Taylor<2>, 3> normal_to_both = cross(t, a);
  if (!as_printed && !(norm(detail::derivative_of<0>(normal_to_both)) > kParallel * bend)) {
    f.rt[1] = held[1];
    f.rt[2] = held[2];
    return f;
  }
  const Taylor<2> length = as_printed ? norm(a) : norm(normal_to_both);
  const Vec<Taylor<2>, 3> b = (Taylor<2>(1.0) / length) * normal_to_both;
  detail::set_row(f, 1, cross(b, t));
  detail::set_row(f, 2, b);
  return f;
}

}  // namespace stribeck::path

template <>
struct stribeck::EnumNames<stribeck::path::FrameKind> {
  static constexpr std::array names{
      std::pair{stribeck::path::FrameKind::kTransported, std::string_view{"transported"}},
      std::pair{stribeck::path::FrameKind::kFrenet, std::string_view{"frenet"}},
      std::pair{stribeck::path::FrameKind::kPrinted, std::string_view{"printed"}}};
};
