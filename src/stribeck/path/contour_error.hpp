#pragma once
/// Contour error: the distance of a position from the path, signed positive to the left of the direction of
/// travel.
///
///   exact       ε = n(φ*)·(p − q(φ*)),  φ* the nearest point of the path near the reference: (p − q)·q' = 0
///   linearised  ε = n(φ)·(p − r),       n = (−sin θ, cos θ) at the reference point; a controller's view
///
///   The two differ by O(|e|²·curvature). ε [m].
/// The nearest point is searched from the reference point (damped Newton), so that a path that crosses itself is
/// judged against the branch that is being travelled.
/// Real time: safe.

#include <limits>
#include <stribeck/path/reference.hpp>

namespace stribeck::path {

/// Parameter of the point of the curve nearest to p, searched from `phi`; converged is false when there is none close by.
struct NearestPoint {
  double phi = 0.0;
  bool converged = false;
};

inline NearestPoint nearest_from(const Curve& curve, const Vec2& p, double phi) noexcept {
  constexpr int kIterations = 16;
  constexpr double kLongestStep = 0.2;  // [rad]
  for (int i = 0; i < kIterations; ++i) {
    const auto q = curve.derivatives<2>(phi);
    const Vec2 d = p - q[0];
    const double square = dot(q[1], q[1]);
    // Beyond the centre of curvature the distance has no minimum here: walk downhill instead.
    const double curvature = max_of(square - dot(d, q[2]), 0.1 * square);
    const double step = dot(d, q[1]) / curvature;
    phi += clamp_to(step, -kLongestStep, kLongestStep);
    if (abs(step) < 1e-12) return {phi, true};
  }
  return {phi, false};
}

/// Exact contour error [m] of position p [m]; phi is the reference's parameter. Where the search from the reference does not
/// end (a position far from the path), the whole path is searched.
inline double contour_error(const Curve& curve, const Vec2& p, double phi) noexcept {
  if (curve.shape == Shape::kCircle) return curve.size - norm(p);
  NearestPoint at = nearest_from(curve, p, phi);
  if (!at.converged) {
    constexpr int kSamples = 256;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kSamples; ++i) {
      const double sample = curve.period() * i / kSamples;
      const Vec2 d = p - curve.point(sample);
      const bool nearer = dot(d, d) < least;
      least = nearer ? dot(d, d) : least;
      at.phi = nearer ? sample : at.phi;
    }
    at = nearest_from(curve, p, at.phi);
  }
  const auto q = curve.derivatives<1>(at.phi);
  const Vec2 d = p - q[0];
  const double side = q[1][0] * d[1] - q[1][1] * d[0];
  return select(side < 0.0, -norm(d), norm(d));
}

/// Contour error [m] to first order, from the tracking error e = p − r [m] and the unit tangent (cos θ, sin
/// θ).
inline double linearised_contour_error(const Vec2& e, const Vec2& tangent) noexcept {
  return tangent[0] * e[1] - tangent[1] * e[0];
}

}  // namespace stribeck::path
