#pragma once
/// Contour error: the distance of a position from the path, signed positive to the left of the direction of
/// travel.
///
///   exact       ε = n(φ*)·(p − q(φ*)),  φ* the nearest point of the path near the reference: (p − q)·q' = 0
///   linearised  ε = n(φ)·(p − r),       n = (−sin θ, cos θ) at the reference point; what a controller can
///   know
///
///   The two differ by O(|e|²·curvature). ε [m].
/// The nearest point is searched from the reference point (Newton), so that a path that crosses itself is
/// judged against the branch that is being travelled. Real time: safe.

#include <stribeck/path/reference.hpp>

namespace stribeck::path {

/// Exact contour error [m] of position p [m]; phi is the reference's parameter.
inline double contour_error(const Curve& curve, const Vec2& p, double phi) noexcept {
  if (curve.shape == Shape::kCircle) return curve.size - norm(p);
  double at = phi;
  for (int i = 0; i < 8; ++i) {
    const auto q = curve.derivatives<2>(at);
    const Vec2 d = p - q[0];
    const double step = dot(d, q[1]) / (dot(q[1], q[1]) - dot(d, q[2]));
    at += step;
    if (abs(step) < 1e-13) break;
  }
  const auto q = curve.derivatives<1>(at);
  const Vec2 d = p - q[0];
  return (q[1][0] * d[1] - q[1][1] * d[0]) / norm(q[1]);
}

/// Contour error [m] to first order, from the tracking error e = p − r [m] and the unit tangent (cos θ, sin
/// θ).
inline double linearised_contour_error(const Vec2& e, const Vec2& tangent) noexcept {
  return tangent[0] * e[1] - tangent[1] * e[0];
}

}  // namespace stribeck::path
