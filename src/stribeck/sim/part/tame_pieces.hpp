#pragma once
/// Cuts a polynomial segment where its direction changes fast, so that each piece can have a speed limit of its own.
///
///   tame    all Bézier vectors b_i of q' satisfy d·b_i ≥ max|b_i|/2, d the unit vector of q' in the middle of the piece
///
/// Then q' turns by less than 60° to either side of d and |q'| changes by less than a factor of two: places at even distance
/// resolve curvature and jerk. At a cusp no piece is tame, however short. There the cutting ends at kCuspLength, and the
/// motion has to stop.
///
/// Source: Farin, Curves and Surfaces for CAGD, 2002 (convex hull of the Bézier points).
/// Inside sim/part only. Real time: no.

#include <array>
#include <cmath>
#include <cstddef>
#include <stribeck/path/segment_path.hpp>
#include <vector>

namespace stribeck::sim {

/// A piece that is not tame is a cusp once it is shorter than this [m].
inline constexpr double kCuspLength = 1e-9;

/// The piece of a polynomial segment between two shares of its range.
template <std::size_t N>
path::Segment<N> piece_of(const path::Segment<N>& s, double from, double to) {
  constexpr std::size_t kTerms = std::tuple_size_v<decltype(s.c)>;
  path::Segment<N> r = s;
  r.length = (to - from) * s.length;
  // Taylor's shift by Horner's scheme, then the new range.
  for (std::size_t i = 0; i + 1 < kTerms; ++i) {
    for (std::size_t k = kTerms - 1; k-- > i;) r.c[k] = r.c[k] + from * r.c[k + 1];
  }
  double power = 1.0;
  for (std::size_t k = 0; k < kTerms; ++k, power *= to - from) r.c[k] = power * r.c[k];
  r.extent = r.distance(r.length);
  return r;
}

struct Hull {
  bool tame = false;
  double longest = 0.0;  ///< at least the length of the piece [m]
};

template <std::size_t N>
Hull hull_of(const path::Segment<N>& s) {
  constexpr std::size_t kDegree = std::tuple_size_v<decltype(s.c)> - 2;  // of q'
  std::array<Vec<double, N>, kDegree + 1> b;
  for (std::size_t i = 0; i <= kDegree; ++i) {
    // b_i = Σ C(i,k)/C(n,k)·a_k with a_k the coefficients of q'.
    double weight = 1.0;
    for (std::size_t k = 0; k <= i; ++k) {
      b[i] = b[i] + (weight * static_cast<double>(k + 1)) * s.c[k + 1];
      weight *= static_cast<double>(i - k) / static_cast<double>(kDegree - k);
    }
  }
  Hull hull;
  for (const auto& v : b) hull.longest = std::max(hull.longest, norm(v));
  const Vec<double, N> middle = s.template derivatives<1>(0.5 * s.length)[1];
  const double size = norm(middle);
  hull.tame = size > 0.0;
  for (const auto& v : b) hull.tame = hull.tame && dot(v, middle) >= 0.5 * size * hull.longest;
  return hull;
}

/// A piece, or a cusp: the straight line over it, which begins and ends at rest.
template <std::size_t N>
struct TamePiece {
  path::Segment<N> segment;
  bool cusp = false;
};

/// The pieces of a polynomial segment, in order. A cusp without any length is a piece of length 0.
template <std::size_t N>
std::vector<TamePiece<N>> tame_pieces(const path::Segment<N>& whole) {
  struct Range {
    double from;
    double to;
  };
  std::vector<TamePiece<N>> pieces;
  std::vector<Range> todo{{0.0, 1.0}};
  while (!todo.empty()) {
    const auto [from, to] = todo.back();
    todo.pop_back();
    const path::Segment<N> s = from == 0.0 && to == 1.0 ? whole : piece_of(whole, from, to);
    const Hull hull = hull_of(s);
    if (hull.tame) {
      pieces.push_back({s, false});
    } else if (hull.longest > kCuspLength) {
      const double middle = 0.5 * (from + to);
      todo.push_back({middle, to});
      todo.push_back({from, middle});
    } else {
      path::Segment<N> chord;
      // Neighbouring pieces without a tame one between them are one cusp.
      const bool goes_on = !pieces.empty() && pieces.back().cusp;
      chord.c[0] = goes_on ? pieces.back().segment.c[0] : s.point(0.0);
      if (goes_on) pieces.pop_back();
      const Vec<double, N> across = s.point(s.length) - chord.c[0];
      chord.length = chord.extent = norm(across);
      if (chord.length > 0.0) chord.c[1] = (1.0 / chord.length) * across;
      pieces.push_back({chord, true});
    }
  }
  return pieces;
}

}  // namespace stribeck::sim
