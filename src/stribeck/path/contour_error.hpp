#pragma once
/// Contour error: the distance of a position from the path.
///
///   exact       ε = |p − q(φ*)|,  φ* the nearest point of the path near the reference: (p − q)·q' = 0
///   linearised  ε = √(e_n² + e_b² + …),  e_l = Rᵀe: the part of the tracking error across the path, as a controller sees it
///
///   In a plane the path has sides, and ε is positive to the left of the direction of travel; elsewhere it has no sign. The
///   two differ by O(|e|²·curvature). ε [m].
/// The nearest point is searched from the reference point (damped Newton), so that a path that crosses itself is judged
/// against the branch that is being travelled. A path with one axis has no contour error: 0.
/// Real time: safe.

#include <limits>
#include <stribeck/path/curve.hpp>
#include <stribeck/path/derivatives.hpp>

namespace stribeck::path {

/// Parameter of the point of the path nearest to p, searched from `phi`; converged is false when there is none nearby.
struct NearestPoint {
  double phi = 0.0;
  bool converged = false;
};

template <PathCurve C>
NearestPoint nearest_from(const C& curve, const Vec<double, C::kAxes>& p, double phi) noexcept {
  constexpr int kIterations = 16;
  const double longest_step = curve.period() / 30.0;
  const double close_enough = 2e-13 * curve.period();
  for (int i = 0; i < kIterations; ++i) {
    const auto q = derivatives<2>(curve, phi);
    const auto d = p - q[0];
    const double square = dot(q[1], q[1]);
    // Beyond the centre of curvature the distance has no minimum here: step downhill instead.
    const double curvature = max_of(square - dot(d, q[2]), 0.1 * square);
    const double before = phi;
    phi += clamp_to(dot(d, q[1]) / curvature, -longest_step, longest_step);
    if (!curve.closed()) phi = clamp_to(phi, 0.0, curve.period());
    if (abs(phi - before) < close_enough) return {phi, true};
  }
  return {phi, false};
}

/// Exact contour error [m] of position p [m]; phi is the reference's parameter. If the search from the reference does not converge
/// (a position far from the path), the whole path is searched.
template <PathCurve C>
double contour_error(const C& curve, const Vec<double, C::kAxes>& p, double phi) noexcept {
  if constexpr (C::kAxes == 1) return 0.0;
  if constexpr (std::is_same_v<C, Curve>) {
    if (curve.shape == Shape::kCircle) return curve.size - norm(p);
  }
  NearestPoint at = nearest_from(curve, p, phi);
  if (!at.converged) {
    constexpr int kSamples = 256;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kSamples; ++i) {
      const double sample = curve.period() * i / kSamples;
      const auto d = p - curve.point(sample);
      const bool nearer = dot(d, d) < least;
      least = nearer ? dot(d, d) : least;
      at.phi = nearer ? sample : at.phi;
    }
    at = nearest_from(curve, p, at.phi);
  }
  const auto q = derivatives<1>(curve, at.phi);
  const auto d = p - q[0];
  if constexpr (C::kAxes == 2) {
    const double side = q[1][0] * d[1] - q[1][1] * d[0];
    return select(side < 0.0, -norm(d), norm(d));
  }
  return norm(d);
}

/// Contour error [m] to first order, from the tracking error in the frame of the path, e_l = Rᵀ(p − r) [m].
template <std::size_t N>
double linearised_contour_error(const Vec<double, N>& local) noexcept {
  if constexpr (N == 1) return 0.0;
  if constexpr (N == 2) return local[1];
  double sum = 0.0;
  for (std::size_t i = 1; i < N; ++i) sum += local[i] * local[i];
  return sqrt(sum);
}

}  // namespace stribeck::path
