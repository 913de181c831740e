#pragma once
/// From points to a QuinticSpline, in O(n).
///
///   exact     ∫|q'''|² dφ → min,  q(φ_i) = p_i:  q''' and q'''' are continuous at the knots, unknown are q', q'' there
///   smoothed  Σ|z_i − p_i|² + λ·∫|q'''|² dφ → min,  λ the largest with max|z_i − p_i| ≤ tolerance; then exact through z
///             (R + λQᵀQ)·γ = Qᵀp,  z = p − λQγ,  q''' = Σγ_j M_j on quadratic B-splines, Q third divided differences
///   ends      q', q'' of the polynomial through the six points there (no order is lost), three where their steps are uneven; or q''' = q'''' = 0; or given
///   φ         chord lengths, then twice the arc length of the previous spline: with chords alone the order is four where the spacing
///             changes, with this it is six; or given knots
///
/// Noise e on points at distance h gives derivatives of order e/h^k: q''' of an exact spline through measured or rounded
/// points is mostly noise. A tolerance of four to five times its standard deviation lets the curve pass between.
/// Fewer than eight points are never smoothed. A closed path does not repeat its first point.
/// Source: Reinsch 1967, doi:10.1007/BF02162161, with m = 3; Floater, Surazhsky, Parameterization for curve interpolation, 2006.
/// Not modelled: corners (segment_path.hpp); outliers, because the tolerance limits the largest deviation.
/// Real time: configure only. Errors: SplineStatus with the index of the point; the spline then stays as it was.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stribeck/core/taylor.hpp>
#include <stribeck/core/vec.hpp>
#include <stribeck/path/band_solver.hpp>
#include <stribeck/path/spline.hpp>
#include <string_view>

namespace stribeck::path {

enum class SplineStatus : std::uint8_t {
  kOk,
  kTooFewPoints,     ///< open two, closed three
  kNotFinite,        ///< point, knot, given end
  kEqualNeighbours,  ///< the point equals the one before it; 0: the last one of a closed path equals the first
  kKnotsDoNotAscend,   ///< or their number is wrong: one per point, closed one more
  kToleranceNegative,  ///< or not a number
  kTooUneven,          ///< the steps before and after the point differ more than 10⁶-fold
  kLeavesPoints,   ///< the spline is far longer than the distance to the next point, or leaves a long step
  kMemoryTooSmall  ///< see spline_segments and spline_rows
};

constexpr std::string_view describe(SplineStatus s) noexcept {
  switch (s) {
    case SplineStatus::kOk:
      return "ok";
    case SplineStatus::kTooFewPoints:
      return "too few points: a path needs two, a closed one three";
    case SplineStatus::kNotFinite:
      return "a point, knot or end is not a finite number";
    case SplineStatus::kEqualNeighbours:
      return "two neighbouring points are equal";
    case SplineStatus::kKnotsDoNotAscend:
      return "the knots do not ascend, or are not one per point and one more if closed";
    case SplineStatus::kToleranceNegative:
      return "the tolerance is negative or not a number";
    case SplineStatus::kTooUneven:
      return "the steps before and after a point differ more than a million-fold";
    case SplineStatus::kLeavesPoints:
      return "a spline leaves the line from this point to the next by far: the points are too far apart for the curve between them, as "
             "those of a straight line beside those of an arc; add points along the long steps, or join the points with corners";
    case SplineStatus::kMemoryTooSmall:
      return "the memory given is too small";
  }
  return "unknown status";
}

enum class SplineEnds : std::uint8_t { kFromPoints, kNatural, kGiven };

template <std::size_t N>
struct SplineOptions {
  bool closed = false;
  SplineEnds ends = SplineEnds::kFromPoints;  ///< of an open path
  std::array<std::array<Vec<double, N>, 2>, 2> given =
      {};                  ///< q', q'' at the first and at the last point, for kGiven
  double tolerance = 0.0;  ///< largest distance between a point and the spline at its knot [m]; 0: none
  std::span<const double> knots =
      {};  ///< φ of the points, and of the end of the lap if closed; empty: arc length
};

struct SplineFit {
  SplineStatus status = SplineStatus::kOk;
  std::size_t index = 0;   ///< of the point that is wrong
  double deviation = 0.0;  ///< largest distance between a point and the spline at its knot [m]
};

/// Working memory of the fit, per point.
template <std::size_t N>
struct SplineRow {
  double knot = 0.0;
  Vec<double, N> value;                              ///< z_i
  std::array<detail::Equation<N>, 2> equation = {};  ///< of q', q''; of γ while smoothing
};

constexpr std::size_t spline_segments(std::size_t points, bool closed) noexcept {
  return closed ? points : points - 1;
}
constexpr std::size_t spline_rows(std::size_t points) noexcept { return points + 1; }

namespace detail {

template <std::size_t N>
class SplineFitter {
 public:
  using Point = Vec<double, N>;
  using Segment = typename QuinticSpline<N>::Segment;

  SplineFitter(std::span<const Point> points, const SplineOptions<N>& options, std::span<Segment> segments,
               std::span<SplineRow<N>> rows) noexcept
      : points_(points), options_(options), segments_(segments), rows_(rows), n_(points.size()) {}

  SplineFit run(QuinticSpline<N>& spline) noexcept {
    SplineFit fit = check();
    if (fit.status != SplineStatus::kOk) return fit;
    segments_ = segments_.first(spline_segments(n_, options_.closed));
    for (std::size_t i = 0; i < n_; ++i) rows_[i].value = points_[i];
    if (options_.knots.empty()) {
      knots_from_chords();
    } else {
      for (std::size_t i = 0; i < options_.knots.size(); ++i) rows_[i].knot = options_.knots[i];
    }
    for (std::size_t i = options_.closed ? 0 : 1; i < segments_.size(); ++i) {
      const double ratio = step(i) / step(i > 0 ? i - 1 : segments_.size() - 1);
      if (!(ratio < kMostUneven && ratio > 1.0 / kMostUneven)) return {SplineStatus::kTooUneven, i, 0.0};
    }
    if (options_.tolerance > 0.0 && n_ >= kFewestSmoothed) fit.deviation = smooth();
    interpolate();
    for (int pass = 0; options_.knots.empty() && pass < kArcPasses; ++pass) {
      knots_from_arcs();
      interpolate();
    }
    const bool by_arcs = options_.knots.empty() && options_.ends != SplineEnds::kGiven;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      for (const Point& c : segments_[i].c) {
        if (!finite(c)) return {SplineStatus::kTooUneven, i, 0.0};
      }
      if (by_arcs && (length_of(i) > kLongest * chord_of(i) || leaves_long_step(i)))
        return {SplineStatus::kLeavesPoints, i, 0.0};
    }
    spline = QuinticSpline<N>(segments_, rows_[segments_.size()].knot, options_.closed);
    return fit;
  }

 private:
  static constexpr std::size_t kFewestSmoothed = 8;
  static constexpr int kArcPasses = 2;
  static constexpr double kUneven = 5.0;  // ratio of steps
  static constexpr double kOfChord = 0.005;
  static constexpr double kLongest = 1.5;     // a quarter of a circle is 1.11 of its chord, half of one 1.57
  static constexpr double kMostUneven = 1e6;  // from 1e7 on rounding shows, at 1e8 the result is wrong

  static bool finite(const Point& p) noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      if (!isfinite(p[i])) return false;
    }
    return true;
  }

  [[nodiscard]] SplineFit check() const noexcept {
    const bool closed = options_.closed;
    if (n_ < (closed ? 3U : 2U)) return {SplineStatus::kTooFewPoints, n_, 0.0};
    if (segments_.size() < spline_segments(n_, closed) || rows_.size() < spline_rows(n_)) {
      return {SplineStatus::kMemoryTooSmall, 0, 0.0};
    }
    if (!(options_.tolerance >= 0.0)) return {SplineStatus::kToleranceNegative, 0, 0.0};
    for (std::size_t i = 0; i < n_; ++i) {
      if (!finite(points_[i])) return {SplineStatus::kNotFinite, i, 0.0};
    }
    for (std::size_t i = closed ? 0 : 1; i < n_; ++i) {
      // Besides equal points: a distance that underflows or overflows has no direction either.
      const double chord = norm(points_[i] - points_[i == 0 ? n_ - 1 : i - 1]);
      if (!isfinite(chord)) return {SplineStatus::kNotFinite, i, 0.0};
      if (!(chord > 1e-100)) return {SplineStatus::kEqualNeighbours, i, 0.0};
    }
    if (!closed && options_.ends == SplineEnds::kGiven) {
      for (std::size_t e = 0; e < 2; ++e) {
        for (const Point& d : options_.given[e]) {
          if (!finite(d)) return {SplineStatus::kNotFinite, e == 0 ? 0 : n_ - 1, 0.0};
        }
      }
    }
    const auto& knots = options_.knots;
    if (knots.empty()) return {};
    if (knots.size() != n_ + (closed ? 1 : 0)) return {SplineStatus::kKnotsDoNotAscend, 0, 0.0};
    for (std::size_t i = 0; i < knots.size(); ++i) {
      if (!isfinite(knots[i])) return {SplineStatus::kNotFinite, i, 0.0};
      if (i == 0 ? knots[0] != 0.0 : !(knots[i] > knots[i - 1]))
        return {SplineStatus::kKnotsDoNotAscend, i, 0.0};
    }
    return {};
  }

  [[nodiscard]] std::size_t wrapped(std::size_t i) const noexcept { return i < n_ ? i : i - n_; }
  [[nodiscard]] double step(std::size_t i) const noexcept { return rows_[i + 1].knot - rows_[i].knot; }

  void knots_from_chords() noexcept {
    rows_[0].knot = 0.0;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      rows_[i + 1].knot = rows_[i].knot + norm(rows_[wrapped(i + 1)].value - rows_[i].value);
    }
  }

  /// |q'| integrated over a segment; five Gauss points are exact to the tenth power of its length.
  [[nodiscard]] double length_of(std::size_t i) const noexcept {
    constexpr std::array kAt{0.0, 0.5384693101056831, 0.9061798459386640};
    constexpr std::array kWeight{128.0 / 225.0, 0.4786286704993665, 0.2369268850561891};
    const double half = 0.5 * step(i);
    double length = 0.0;
    for (int k = -2; k <= 2; ++k) {
      const std::size_t at = static_cast<std::size_t>(k < 0 ? -k : k);
      const double u = half * (1.0 + (k < 0 ? -kAt[at] : kAt[at]));
      Point d;
      for (std::size_t c = 5; c >= 1; --c) d = u * d + static_cast<double>(c) * segments_[i].c[c];
      length += half * kWeight[at] * norm(d);
    }
    return length;
  }

  /// Angle between the steps that meet at a point; at an end of an open path none.
  [[nodiscard]] double turn_at(std::size_t i) const noexcept {
    if (!options_.closed && (i == 0 || i + 1 == n_)) return 0.0;
    const Point to = rows_[i].value - rows_[i == 0 ? n_ - 1 : i - 1].value;
    const Point from = rows_[wrapped(i + 1)].value - rows_[i].value;
    const double cosine = dot(to, from) / (norm(to) * norm(from));
    return acos(cosine < -1.0 ? -1.0 : cosine > 1.0 ? 1.0 : cosine);
  }

  /// Whether the spline leaves a step that is far longer than one beside it by more than three arcs through its turns would.
  [[nodiscard]] bool leaves_long_step(std::size_t i) const noexcept {
    const double chord = chord_of(i);
    const std::size_t count = segments_.size();
    const bool has_last = options_.closed || i > 0, has_next = options_.closed || i + 1 < count;
    const bool is_long = (has_last && chord > kUneven * chord_of(i > 0 ? i - 1 : count - 1)) ||
                         (has_next && chord > kUneven * chord_of(i + 1 < count ? i + 1 : 0));
    if (!is_long) return false;
    // An arc that turns by θ at either end leaves its chord by θ/8.
    const double allowed = chord * (3.0 / 16.0 * (turn_at(i) + turn_at(wrapped(i + 1))) + kOfChord);
    for (const double share : {0.25, 0.5, 0.75}) {
      const double u = share * step(i);
      Point q;
      for (std::size_t c = 6; c-- > 0;) q = u * q + segments_[i].c[c];
      const Point along = (1.0 / chord) * (rows_[wrapped(i + 1)].value - rows_[i].value);
      const Point off = q - rows_[i].value;
      if (norm(off - dot(off, along) * along) > allowed) return true;
    }
    return false;
  }

  void knots_from_arcs() noexcept {
    double end = 0.0;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      const double length = length_of(i);
      rows_[i].knot = end;
      end += length;
    }
    rows_[segments_.size()].knot = end;
  }
  [[nodiscard]] double chord_of(std::size_t i) const noexcept {
    return norm(rows_[wrapped(i + 1)].value - rows_[i].value);
  }

  /// q' and q'' at an end from the polynomial through the points next to it: six, or three where the steps between the six are uneven,
  /// because a polynomial of high order leaves them far beside the long steps.
  [[nodiscard]] std::array<Point, 2> end_of_polynomial(bool last) const noexcept {
    constexpr std::size_t kMost = 6, kFew = 3;
    const auto index = [&](std::size_t k) { return last ? n_ - 1 - k : k; };
    std::size_t m = n_ < kMost ? n_ : kMost;
    double shortest = step(last ? n_ - 2 : 0), longest = shortest;
    for (std::size_t k = 0; k + 1 < m; ++k) {
      const double h = step(last ? n_ - 2 - k : k);
      shortest = h < shortest ? h : shortest;
      longest = h > longest ? h : longest;
    }
    if (options_.knots.empty() && m > kFew && longest > kUneven * shortest) m = kFew;
    std::array<Point, kMost> difference;
    for (std::size_t k = 0; k < m; ++k) difference[k] = rows_[index(k)].value;
    for (std::size_t order = 1; order < m; ++order) {
      for (std::size_t k = m - 1; k >= order; --k) {
        const double span = rows_[index(k)].knot - rows_[index(k - order)].knot;
        difference[k] = (1.0 / span) * (difference[k] - difference[k - 1]);
      }
    }
    std::array<Point, 2> d;
    const Taylor<2> at = Taylor<2>::variable(rows_[index(0)].knot);
    for (std::size_t i = 0; i < N; ++i) {
      Taylor<2> q(difference[m - 1][i]);
      for (std::size_t k = m - 1; k-- > 0;) q = q * (at - rows_[index(k)].knot) + difference[k][i];
      d[0][i] = q.derivative(1);
      d[1][i] = q.derivative(2);
    }
    return d;
  }

  /// The spline through the values at the knots.
  void interpolate() noexcept {
    const auto at = [this](std::size_t i) -> Equation<N>& { return rows_[i / 2].equation[i % 2]; };
    const bool fixed = !options_.closed && options_.ends != SplineEnds::kNatural;
    std::array<std::array<Point, 2>, 2> ends = options_.given;
    if (fixed && options_.ends == SplineEnds::kFromPoints)
      ends = {end_of_polynomial(false), end_of_polynomial(true)};

    BandSystem<N, decltype(at)> system(at, 2 * n_, options_.closed);
    system.clear();
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      const double h = step(i);
      const std::size_t next = wrapped(i + 1);
      // ½·∂∫|q'''|²/∂(q'_i, q''_i, q'_{i+1}, q''_{i+1}) of the Hermite quintic, which is (q'''', −q''') at its
      // left and (−q'''', q''') at its right end.
      const double a = 1.0 / h;
      const double a2 = a * a;
      const double a3 = a2 * a;
      const std::array<std::array<double, 4>, 4> energy{{{192.0 * a3, 36.0 * a2, 168.0 * a3, -24.0 * a2},
                                                         {36.0 * a2, 9.0 * a, 24.0 * a2, -3.0 * a},
                                                         {168.0 * a3, 24.0 * a2, 192.0 * a3, -36.0 * a2},
                                                         {-24.0 * a2, -3.0 * a, -36.0 * a2, 9.0 * a}}};
      const Point slope = a * (rows_[next].value - rows_[i].value);
      const std::array<double, 4> force{360.0 * a3, 60.0 * a2, 360.0 * a3, -60.0 * a2};
      const std::array<std::size_t, 4> unknown{2 * i, 2 * i + 1, 2 * next, 2 * next + 1};
      const auto known = [&](std::size_t k) { return fixed && (unknown[k] < 2 || unknown[k] >= 2 * n_ - 2); };
      for (std::size_t r = 0; r < 4; ++r) {
        if (known(r)) continue;
        at(unknown[r]).value = at(unknown[r]).value + force[r] * slope;
        for (std::size_t c = 0; c < 4; ++c) {
          if (known(c)) {
            const Point& end = ends[unknown[c] < 2 ? 0 : 1][unknown[c] % 2];
            at(unknown[r]).value = at(unknown[r]).value - energy[r][c] * end;
          } else if (c <= r) {
            system.add(unknown[r], unknown[c], energy[r][c]);
          }
        }
      }
    }
    if (fixed) {
      for (const std::size_t i : {std::size_t{0}, std::size_t{1}, 2 * n_ - 2, 2 * n_ - 1}) {
        at(i).band[0] = 1.0;
        at(i).value = ends[i < 2 ? 0 : 1][i % 2];
      }
    }
    system.solve();

    for (std::size_t i = 0; i < segments_.size(); ++i) {
      const std::size_t next = wrapped(i + 1);
      const double h = step(i);
      const Point d0 = h * at(2 * i).value;
      const Point s0 = (h * h) * at(2 * i + 1).value;
      const Point d1 = h * at(2 * next).value;
      const Point s1 = (h * h) * at(2 * next + 1).value;
      const Point rise = rows_[next].value - rows_[i].value;
      Segment& s = segments_[i];
      s.begin = rows_[i].knot;
      s.c[0] = rows_[i].value;
      s.c[1] = at(2 * i).value;
      s.c[2] = 0.5 * at(2 * i + 1).value;
      const double h3 = h * h * h;
      s.c[3] = (1.0 / h3) * (10.0 * rise - 6.0 * d0 - 4.0 * d1 - 1.5 * s0 + 0.5 * s1);
      s.c[4] = (1.0 / (h3 * h)) * (-15.0 * rise + 8.0 * d0 + 7.0 * d1 + 1.5 * s0 - s1);
      s.c[5] = (1.0 / (h3 * h * h)) * (6.0 * rise - 3.0 * d0 - 3.0 * d1 - 0.5 * s0 + 0.5 * s1);
    }
  }

  // Smoothing. Unknown j is γ_j of the B-spline M_j on the knots j … j + 3, for a closed path modulo n.

  [[nodiscard]] double knot(std::size_t i) const noexcept {
    return i < n_ || !options_.closed ? rows_[i].knot : rows_[i - n_].knot + rows_[n_].knot;
  }

  /// Weights of six times the third divided difference of the points j … j + 3, knots counted in mean steps.
  [[nodiscard]] std::array<double, 4> third_difference(std::size_t j, double unit) const noexcept {
    std::array<double, 4> w{};
    for (std::size_t l = 0; l < 4; ++l) {
      w[l] = 6.0;
      for (std::size_t m = 0; m < 4; ++m) {
        if (m != l) w[l] /= unit * (knot(j + l) - knot(j + m));
      }
    }
    return w;
  }

  /// M_j at the parameter x of its part p = 0, 1, 2: the quadratic B-spline of unit area.
  [[nodiscard]] double bell(std::size_t j, std::size_t p, double x, double unit) const noexcept {
    const std::array t{unit * knot(j), unit * knot(j + 1), unit * knot(j + 2), unit * knot(j + 3)};
    const double scale = 3.0 / (t[3] - t[0]);
    if (p == 0) return scale * (x - t[0]) * (x - t[0]) / ((t[2] - t[0]) * (t[1] - t[0]));
    if (p == 2) return scale * (t[3] - x) * (t[3] - x) / ((t[3] - t[1]) * (t[3] - t[2]));
    return scale * ((x - t[0]) * (t[2] - x) / ((t[2] - t[0]) * (t[2] - t[1])) +
                    (t[3] - x) * (x - t[1]) / ((t[3] - t[1]) * (t[2] - t[1])));
  }

  /// ∫ M_j·M_{j+d}, exact with three Gauss points per part.
  [[nodiscard]] double overlap(std::size_t j, std::size_t d, double unit) const noexcept {
    constexpr std::array kAt{-0.7745966692414834, 0.0, 0.7745966692414834};
    constexpr std::array kWeight{5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
    double sum = 0.0;
    for (std::size_t p = d; p < 3; ++p) {
      const double begin = unit * knot(j + p);
      const double half = 0.5 * (unit * knot(j + p + 1) - begin);
      for (std::size_t g = 0; g < 3; ++g) {
        const double x = begin + half * (1.0 + kAt[g]);
        sum += half * kWeight[g] * bell(j, p, x, unit) * bell(j + d, p - d, x, unit);
      }
    }
    return sum;
  }

  /// z for one λ; returns the largest |z_i − p_i|.
  double smooth(double lambda, double unit) noexcept {
    const auto at = [this](std::size_t i) -> Equation<N>& { return rows_[i].equation[0]; };
    const bool closed = options_.closed;
    const std::size_t count = closed ? n_ : n_ - 3;
    BandSystem<N, decltype(at)> system(at, count, closed);
    system.clear();
    for (std::size_t j = 0; j < count; ++j) {
      const auto w = third_difference(j, unit);
      // Relative to the first of the four: the weights add up to zero only to rounding.
      for (std::size_t l = 1; l < 4; ++l) {
        at(j).value = at(j).value + w[l] * (points_[wrapped(j + l)] - points_[j]);
      }
      for (std::size_t d = 0; d < 4 && (closed || j + d < count); ++d) {
        const auto other = third_difference(wrapped(j + d), unit);
        double a = d < 3 ? overlap(j, d, unit) : 0.0;
        for (std::size_t l = d; l < 4; ++l) a += lambda * w[l] * other[l - d];
        system.add(wrapped(j + d), j, a);
      }
    }
    system.solve();
    for (std::size_t i = 0; i < n_; ++i) rows_[i].value = points_[i];
    for (std::size_t j = 0; j < count; ++j) {
      const auto w = third_difference(j, unit);
      for (std::size_t l = 0; l < 4; ++l) {
        Point& z = rows_[wrapped(j + l)].value;
        z = z - (lambda * w[l]) * at(j).value;
      }
    }
    double largest = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      const double deviation = norm(rows_[i].value - points_[i]);
      largest = deviation > largest || !isfinite(deviation) ? deviation : largest;
    }
    return largest;
  }

  /// The largest λ within the tolerance, by bisection of its logarithm.
  double smooth() noexcept {
    const double unit = static_cast<double>(segments_.size()) / rows_[segments_.size()].knot;
    // λ in mean steps to the fifth power: the curve follows wavelengths above λ^(1/6) steps, a tenth to a hundred. Beyond a hundred,
    // rounding dominates: with λ = 1e15, points with noise of 1 µm were moved by 119 µm.
    constexpr double kLeast = 1e-6;
    constexpr double kMost = 1e12;
    constexpr int kBisections = 16;  // λ to 0.1 %
    double within = 0.0;
    double lo = std::log(kLeast);
    double hi = std::log(kMost);
    if (smooth(kMost, unit) <= options_.tolerance) {
      within = kMost;
    } else {
      for (int i = 0; i < kBisections; ++i) {
        const double middle = 0.5 * (lo + hi);
        const bool is_within = smooth(exp(middle), unit) <= options_.tolerance;
        within = is_within ? exp(middle) : within;
        (is_within ? lo : hi) = middle;
      }
    }
    return smooth(within, unit);
  }

  std::span<const Point> points_;
  const SplineOptions<N>& options_;
  std::span<Segment> segments_;
  std::span<SplineRow<N>> rows_;
  std::size_t n_;
};

}  // namespace detail

/// Fits a spline to points. It refers to `segments` (at least spline_segments of them); `rows` (at least spline_rows)
/// are free again after the call.
///
///   std::vector<QuinticSpline<3>::Segment> segments(spline_segments(points.size(), false));
///   std::vector<SplineRow<3>> rows(spline_rows(points.size()));
///   QuinticSpline<3> path;
///   const SplineFit fit = fit_spline<3>(points, {.tolerance = 5e-6}, segments, rows, path);
template <std::size_t N>
SplineFit fit_spline(std::span<const Vec<double, N>> points, const SplineOptions<N>& options,
                     std::span<typename QuinticSpline<N>::Segment> segments, std::span<SplineRow<N>> rows,
                     QuinticSpline<N>& spline) noexcept {
  return detail::SplineFitter<N>(points, options, segments, rows).run(spline);
}

}  // namespace stribeck::path
