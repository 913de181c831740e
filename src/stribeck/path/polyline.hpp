#pragma once
/// A planned path of straight legs (G1 moves) whose corners are rounded: four times continuously differentiable.
///
///   q(φ) = p + (φ − φ_p)·t                                   on a leg
///   q(φ) = p + s·(t₁ + t₂)/2 + d·E(s²/d²)·(t₂ − t₁)          in a corner, s = φ − φ_p, |s| < d
///   E(y) = (35 + 140y − 70y² + 28y³ − 5y⁴)/256:  q' goes from t₁ to t₂ by a smooth step with three derivatives at rest
///
///   φ       distance along the plan [m]; corners stand at its φ_p. |q'| = 1 on legs, at least cos(θ/2) in a corner
///   t₁, t₂  directions before and after the corner p, which turns by θ
///   d       half the length of the blend: 35/128·d·sin(θ/2) = tolerance, at most half of the shorter leg
///
/// A blend stays inside its corner; it is nearest to it at its middle, within the tolerance [m], which therefore also
/// bounds the distance from the plan. Peak curvature 35/16·sin(θ/2)/(d·cos²(θ/2)).
/// Not modelled: arcs (G2, G3); a stop in a corner: a path that turns back on itself is refused and has to be run in parts.
/// Real time: safe; round_corners: configure only. Errors: PolylineStatus with the index of the point.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stribeck/path/corner.hpp>
#include <stribeck/path/derivatives.hpp>
#include <stribeck/path/pieces.hpp>
#include <string_view>

namespace stribeck::path {

enum class PolylineStatus : std::uint8_t {
  kOk,
  kTooFewPoints,     ///< open two, closed three
  kNotFinite,        ///< point
  kEqualNeighbours,  ///< the point equals the one before it; 0: the last one of a closed path equals the first
  kTurnsBack,        ///< at the point by more than 179.8°
  kToleranceNotPositive,  ///< or not finite
  kMemoryTooSmall         ///< see polyline_legs
};

constexpr std::string_view describe(PolylineStatus s) noexcept {
  switch (s) {
    case PolylineStatus::kOk:
      return "ok";
    case PolylineStatus::kTooFewPoints:
      return "too few points: a path needs two, a closed one three";
    case PolylineStatus::kNotFinite:
      return "a point is not finite";
    case PolylineStatus::kEqualNeighbours:
      return "two neighbouring points are equal";
    case PolylineStatus::kTurnsBack:
      return "the path turns back on itself";
    case PolylineStatus::kToleranceNotPositive:
      return "the tolerance is not a positive number";
    case PolylineStatus::kMemoryTooSmall:
      return "the memory given is too small";
  }
  return "unknown status";
}

template <std::size_t N>
class BlendedPolyline {
 public:
  static constexpr std::size_t kAxes = N;

  struct Leg {
    double begin = 0.0;        ///< φ of its first point [m]
    double length = 0.0;       ///< [m]
    double blend = 0.0;        ///< d of the corner at its first point [m]; 0: none
    Vec<double, N> from;       ///< its first point [m]
    Vec<double, N> direction;  ///< t, of length 1
  };

  BlendedPolyline() = default;
  /// Made by round_corners. At least one leg.
  BlendedPolyline(std::span<const Leg> legs, bool closed) noexcept : legs_(legs), closed_(closed) {}

  /// Length of the plan [m]; of one lap if closed.
  [[nodiscard]] double period() const noexcept { return legs_.back().begin + legs_.back().length; }
  [[nodiscard]] bool closed() const noexcept { return closed_; }
  [[nodiscard]] std::span<const Leg> legs() const noexcept { return legs_; }

  /// [m]
  template <Real T>
  [[nodiscard]] Vec<T, N> point(const T& phi) const noexcept {
    const T lap = detail::in_lap(phi, period(), closed_);
    const std::size_t i = detail::item_at(legs_, value_of(lap), period());
    const Leg& leg = legs_[i];
    const double s = value_of(lap) - leg.begin;
    if (s < leg.blend) return blend(legs_[i > 0 ? i - 1 : legs_.size() - 1], leg, lap - T(leg.begin));
    if (i + 1 < legs_.size() || closed_) {
      const Leg& next = legs_[i + 1 < legs_.size() ? i + 1 : 0];
      if (leg.length - s < next.blend) return blend(leg, next, lap - T(leg.begin + leg.length));
    }
    return detail::polynomial(std::array{leg.from, leg.direction}, lap - T(leg.begin));
  }

 private:
  /// Around the first point of `after`, at the distance s from it.
  template <Real T>
  static Vec<T, N> blend(const Leg& before, const Leg& after, const T& s) noexcept {
    constexpr std::array<Vec<double, 1>, 5> kBlend{
        {{{35.0 / 256}}, {{140.0 / 256}}, {{-70.0 / 256}}, {{28.0 / 256}}, {{-5.0 / 256}}}};
    const double d = after.blend;
    const T bend = detail::polynomial(kBlend, 1.0 / (d * d) * (s * s))[0];
    Vec<T, N> q;
    unrolled<N>([&](auto i) {
      const double mean = 0.5 * (before.direction[i] + after.direction[i]);
      const double turn = d * (after.direction[i] - before.direction[i]);
      q[i] = mean * s + turn * bend + T(after.from[i]);
    });
    return q;
  }

  std::span<const Leg> legs_;
  bool closed_ = false;
};

struct PolylineResult {
  PolylineStatus status = PolylineStatus::kOk;
  std::size_t index = 0;   ///< of the point that is wrong
  double deviation = 0.0;  ///< largest distance of a corner from the rounded path [m]
};

constexpr std::size_t polyline_legs(std::size_t points, bool closed) noexcept {
  return closed ? points : points - 1;
}

/// Rounds the corners of a plan. `path` refers to `legs`, at least polyline_legs of them; it is left as it was on errors.
///
///   std::vector<BlendedPolyline<3>::Leg> legs(polyline_legs(points.size(), false));
///   BlendedPolyline<3> path;
///   const PolylineResult r = round_corners<3>(points, 10e-6, false, legs, path);
template <std::size_t N>
PolylineResult round_corners(std::span<const Vec<double, N>> points, double tolerance, bool closed,
                             std::span<typename BlendedPolyline<N>::Leg> legs,
                             BlendedPolyline<N>& path) noexcept {
  using Leg = typename BlendedPolyline<N>::Leg;
  constexpr double kLeastStretch = 2e-3;  // cos(θ/2) at 179.77°
  const std::size_t n = points.size();
  if (n < (closed ? 3U : 2U)) return {PolylineStatus::kTooFewPoints, n, 0.0};
  if (!(tolerance > 0.0) || !isfinite(tolerance)) return {PolylineStatus::kToleranceNotPositive, 0, 0.0};
  const std::size_t count = polyline_legs(n, closed);
  if (legs.size() < count) return {PolylineStatus::kMemoryTooSmall, 0, 0.0};
  double begin = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t to = i + 1 < n ? i + 1 : 0;
    const Vec<double, N> chord = points[to] - points[i];
    const double length = norm(chord);
    if (!isfinite(length)) {
      const bool at_end = isfinite(norm(points[i]));
      return {PolylineStatus::kNotFinite, at_end ? to : i, 0.0};
    }
    if (!(length > 1e-100)) return {PolylineStatus::kEqualNeighbours, to, 0.0};
    legs[i] = Leg{begin, length, 0.0, points[i], (1.0 / length) * chord};
    begin += length;
  }
  double deviation = 0.0;
  for (std::size_t i = closed ? 0 : 1; i < count; ++i) {
    const Leg& before = legs[i > 0 ? i - 1 : count - 1];
    Leg& after = legs[i];
    const HalfTurn turn = half_turn(before.direction, after.direction);
    if (turn.cosine < kLeastStretch) return {PolylineStatus::kTurnsBack, i, 0.0};
    if (!(turn.sine > 0.0)) continue;
    const double room = 0.5 * (before.length < after.length ? before.length : after.length);
    const double wanted = blend_length(tolerance, turn.sine);
    after.blend = wanted < room ? wanted : room;
    const double off = blend_deviation(after.blend, turn.sine);
    deviation = off > deviation ? off : deviation;
  }
  path = BlendedPolyline<N>(legs.first(count), closed);
  return {PolylineStatus::kOk, 0, deviation};
}

/// A point of the plan.
struct PlanPoint {
  double phi = 0.0;       ///< distance along the plan [m]
  double distance = 0.0;  ///< of the position asked for [m]
};

/// The point of the plan, corners and all, nearest to p: exact contour error against what was planned.
///
/// Only the part of the plan is looked at that is connected with the reference point r at phi and not farther from p than
/// 2·|p − r| + d, d of the corners of its leg: a path that comes near itself is judged against the branch that is being
/// travelled, a corner against both of its legs. Time grows with the number of legs in that part.
/// Real time: safe.
template <std::size_t N>
PlanPoint nearest_on_plan(const BlendedPolyline<N>& path, const Vec<double, N>& p, double phi) noexcept {
  const auto legs = path.legs();
  const double lap = clamp_to(detail::in_lap(phi, path.period(), path.closed()), 0.0, path.period());
  const std::size_t start = detail::item_at(legs, lap, path.period());
  const auto at_leg = [&](std::size_t i) {
    const auto& leg = legs[i];
    const double s = clamp_to(dot(p - leg.from, leg.direction), 0.0, leg.length);
    return PlanPoint{leg.begin + s, norm(p - leg.from - s * leg.direction)};
  };
  const auto& here = legs[start];
  const std::size_t after = start + 1 < legs.size() ? start + 1 : 0;
  const double blend = max_of(here.blend, after > 0 || path.closed() ? legs[after].blend : 0.0);
  const double reach = 2.0 * norm(p - here.from - (lap - here.begin) * here.direction) + blend;
  PlanPoint best = at_leg(start);
  const auto consider = [&](const PlanPoint& at) { best = at.distance < best.distance ? at : best; };
  // Along a leg the distance has one minimum: a leg is left inside the reach only through its end.
  const std::size_t most = legs.size() - 1;
  std::size_t walked = 0;
  for (std::size_t i = start; walked < most; ++walked) {
    if (i + 1 == legs.size() && !path.closed()) break;
    i = i + 1 < legs.size() ? i + 1 : 0;
    if (norm(p - legs[i].from) > reach) break;
    consider(at_leg(i));
  }
  for (std::size_t i = start; walked < most; ++walked) {
    if (norm(p - legs[i].from) > reach || (i == 0 && !path.closed())) break;
    i = i > 0 ? i - 1 : legs.size() - 1;
    consider(at_leg(i));
  }
  return best;
}

}  // namespace stribeck::path
