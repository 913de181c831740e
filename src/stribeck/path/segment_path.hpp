#pragma once
/// A programmed path of lines, arcs and helices with rounded corners, as part programs have it.
///
///   line    q = p + x·t
///   arc     q = c + (r + g·x/l)·(u·cos(Θ·x/l) + v·sin(Θ·x/l)) + h·x/l      helix: h, spiral: g
///   corner  q = Σ c_k·(x/l)^k,  k = 0 … 9: value and four derivatives as those of its neighbours at both ends
///
///   x = φ − φ_i place in the segment [m], l its range of φ; t, u, v unit vectors, r radius, g its growth, Θ angle turned
///   through, h travel along the axis of the helix. φ is distance along lines and circles; in a corner |q'| falls to cos(θ/2).
///
/// Where two segments meet in a corner that is not rounded, motion has to stop: the path has no tangent there.
/// The caller owns the memory of the segments.
/// Real time: safe; make_corner configure only.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stribeck/path/derivatives.hpp>
#include <stribeck/path/pieces.hpp>

namespace stribeck::path {

enum class SegmentKind : std::uint8_t { kLine, kArc, kCorner };

template <std::size_t N>
struct Segment {
  double begin = 0.0;      ///< φ of its first point [m]
  double length = 0.0;     ///< range of φ [m]
  double travelled = 0.0;  ///< distance travelled up to it [m]
  double extent = 0.0;     ///< distance along it [m]
  double radius = 0.0;     ///< r [m]
  double growth = 0.0;     ///< g [m]
  double angle = 0.0;      ///< Θ [rad], positive from u to v
  SegmentKind kind = SegmentKind::kLine;
  /// line: p, t; arc: c, u, v, h; corner: coefficients from the constant upwards.
  std::array<Vec<double, N>, 10> c{};

  /// [m], at the place x of the segment [m].
  template <Real T>
  [[nodiscard]] Vec<T, N> point(const T& x) const noexcept {
    switch (kind) {
      case SegmentKind::kLine:
        return detail::polynomial(std::array{c[0], c[1]}, x);
      case SegmentKind::kCorner:
        return detail::polynomial(c, (1.0 / length) * x);
      case SegmentKind::kArc:
        break;
    }
    const T share = (1.0 / length) * x;
    const T turned = angle * share;
    const T r = T(radius) + growth * share;
    const T along = r * cos(turned);
    const T across = r * sin(turned);
    Vec<T, N> q;
    unrolled<N>([&](auto i) { q[i] = T(c[0][i]) + c[1][i] * along + c[2][i] * across + c[3][i] * share; });
    return q;
  }

  /// Derivatives with respect to x up to order K.
  template <int K>
  [[nodiscard]] std::array<Vec<double, N>, K + 1> derivatives(double x) const noexcept {
    const auto q = point(Taylor<K>::variable(x));
    std::array<Vec<double, N>, K + 1> d;
    for (int k = 0; k <= K; ++k) {
      for (std::size_t i = 0; i < N; ++i) d[k][i] = q[i].derivative(k);
    }
    return d;
  }

  /// Whether |q'| is 1 everywhere.
  [[nodiscard]] bool by_distance() const noexcept {
    return kind == SegmentKind::kLine || (kind == SegmentKind::kArc && growth == 0.0);
  }

  /// Distance along the segment up to x [m]: Gauss and Legendre, five points in each of four parts.
  [[nodiscard]] double distance(double x) const noexcept {
    if (by_distance()) return x;
    constexpr std::array<double, 5> kNode{-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                                          0.9061798459386640};
    constexpr std::array<double, 5> kWeight{0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                            0.4786286704993665, 0.2369268850561891};
    constexpr int kParts = 4;
    const double half = 0.5 * x / kParts;
    double sum = 0.0;
    for (int part = 0; part < kParts; ++part) {
      for (std::size_t k = 0; k < kNode.size(); ++k)
        sum += kWeight[k] * norm(derivatives<1>((2 * part + 1 + kNode[k]) * half)[1]);
    }
    return sum * half;
  }

  /// The place x at a distance along the segment [m], by Newton's iteration: |q'| is positive.
  [[nodiscard]] double place(double distance_along) const noexcept {
    if (by_distance()) return clamp_to(distance_along, 0.0, length);
    double x = length * clamp_to(distance_along / extent, 0.0, 1.0);
    for (int i = 0; i < 20; ++i) {
      const double before = x;
      x = clamp_to(x + (distance_along - distance(x)) / norm(derivatives<1>(x)[1]), 0.0, length);
      if (abs(x - before) < 1e-13 * length) break;
    }
    return x;
  }

  /// The place nearest to p, searched from x. A corner may have two: one on its way in and one on its way out.
  [[nodiscard]] double nearest(const Vec<double, N>& p, double x) const noexcept {
    if (kind == SegmentKind::kLine) return clamp_to(dot(p - c[0], c[1]), 0.0, length);
    const double from_here = nearby(p, clamp_to(x, 0.0, length));
    if (kind != SegmentKind::kCorner) return from_here;
    constexpr int kLooks = 8;
    double other = from_here, least = norm(p - point(from_here));
    for (int k = 0; k <= kLooks; ++k) {
      const double place = length * k / kLooks, distance = norm(p - point(place));
      if (distance < least) least = distance, other = place;
    }
    return other == from_here ? from_here : nearby(p, other);
  }

 private:
  /// Newton's iteration from x, to the least distance on its slope.
  [[nodiscard]] double nearby(const Vec<double, N>& p, double x) const noexcept {
    for (int i = 0; i < 12; ++i) {
      const auto q = derivatives<2>(x);
      const auto d = p - q[0];
      const double square = dot(q[1], q[1]);
      // Beyond the centre of curvature the distance has no minimum here: step downhill instead.
      const double curvature = max_of(square - dot(d, q[2]), 0.1 * square);
      const double before = x;
      x = clamp_to(x + clamp_to(dot(d, q[1]) / curvature, -0.25 * length, 0.25 * length), 0.0, length);
      if (abs(x - before) < 1e-12 * length) break;
    }
    return x;
  }
};

/// A point of a path near a position.
struct PathPlace {
  double phi = 0.0;       ///< [m]
  double distance = 0.0;  ///< of the position [m]
};

template <std::size_t N>
class SegmentPath {
 public:
  static constexpr std::size_t kAxes = N;

  SegmentPath() = default;
  /// At least one segment; their begins ascend without gaps.
  explicit SegmentPath(std::span<const Segment<N>> segments) noexcept : segments_(segments) {}

  [[nodiscard]] double period() const noexcept { return segments_.back().begin + segments_.back().length; }
  [[nodiscard]] static constexpr bool closed() noexcept { return false; }
  [[nodiscard]] std::span<const Segment<N>> segments() const noexcept { return segments_; }

  /// [m]
  template <Real T>
  [[nodiscard]] Vec<T, N> point(const T& phi) const noexcept {
    const Segment<N>& s = segments_[detail::item_at(segments_, value_of(phi), period())];
    return s.point(phi - T(s.begin));
  }

  /// The place nearest to p in the neighbourhood of phi: within four times the distance of p from there, and at most 256
  /// segments to both sides, so that a path that comes close to itself is judged against the branch that is being travelled.
  [[nodiscard]] PathPlace nearest(const Vec<double, N>& p, double phi) const noexcept {
    constexpr std::size_t kMost = 256;
    const std::size_t here = detail::item_at(segments_, phi, period());
    const auto in = [&](std::size_t i) {
      const Segment<N>& s = segments_[i];
      const double x = s.nearest(p, phi - s.begin);
      return PathPlace{s.begin + x, norm(p - s.point(x))};
    };
    const double reach = 4.0 * norm(p - point(phi));
    PathPlace best = in(here);
    for (std::size_t i = here + 1; i < segments_.size() && i <= here + kMost; ++i) {
      if (segments_[i].begin > phi + reach) break;
      const PathPlace at = in(i);
      if (at.distance < best.distance) best = at;
    }
    for (std::size_t i = here; i > 0 && i + kMost > here; --i) {
      if (segments_[i].begin < phi - reach) break;
      const PathPlace at = in(i - 1);
      if (at.distance < best.distance) best = at;
    }
    return best;
  }

  /// Exact contour error [m] of p, positive to the left of the direction of travel in a plane.
  [[nodiscard]] double contour_error(const Vec<double, N>& p, double phi) const noexcept {
    const PathPlace at = nearest(p, phi);
    if constexpr (N == 2) {
      const auto q = derivatives<1>(*this, at.phi);
      const auto d = p - q[0];
      return q[1][0] * d[1] - q[1][1] * d[0] < 0.0 ? -at.distance : at.distance;
    }
    return at.distance;
  }

 private:
  std::span<const Segment<N>> segments_;
};

/// The corner from the place x0 of one segment to x1 of the next; its `length` is the range of φ that it removes from both.
template <std::size_t N>
Segment<N> make_corner(const Segment<N>& before, double x0, const Segment<N>& after, double x1) noexcept {
  constexpr std::size_t kHalf = 5;
  Segment<N> corner;
  corner.kind = SegmentKind::kCorner;
  corner.length = (before.length - x0) + x1;
  const auto first = before.template derivatives<4>(x0);
  const auto last = after.template derivatives<4>(x1);
  double factorial = 1.0;
  double scale = 1.0;
  // Row k: the k-th derivative at the end in terms of the unknown c_5 … c_9, divided by k!.
  std::array<std::array<double, kHalf>, kHalf> m{};
  std::array<Vec<double, N>, kHalf> rest;
  for (std::size_t k = 0; k < kHalf; ++k) {
    corner.c[k] = (scale / factorial) * first[k];
    rest[k] = (scale / factorial) * last[k];
    scale *= corner.length;
    factorial *= static_cast<double>(k + 1);
  }
  const auto choose = [](std::size_t n, std::size_t k) {
    double c = 1.0;
    for (std::size_t i = 0; i < k; ++i) c = c * static_cast<double>(n - i) / static_cast<double>(i + 1);
    return c;
  };
  for (std::size_t k = 0; k < kHalf; ++k) {
    for (std::size_t j = k; j < kHalf; ++j) rest[k] = rest[k] - choose(j, k) * corner.c[j];
    for (std::size_t j = 0; j < kHalf; ++j) m[k][j] = choose(kHalf + j, k);
  }
  // All pivots of this matrix (of binomials, determinant 1) are positive.
  for (std::size_t p = 0; p < kHalf; ++p) {
    for (std::size_t r = p + 1; r < kHalf; ++r) {
      const double f = m[r][p] / m[p][p];
      for (std::size_t j = p; j < kHalf; ++j) m[r][j] -= f * m[p][j];
      rest[r] = rest[r] - f * rest[p];
    }
  }
  for (std::size_t p = kHalf; p-- > 0;) {
    for (std::size_t j = p + 1; j < kHalf; ++j) rest[p] = rest[p] - m[p][j] * rest[j];
    rest[p] = (1.0 / m[p][p]) * rest[p];
    corner.c[kHalf + p] = rest[p];
  }
  return corner;
}

}  // namespace stribeck::path
