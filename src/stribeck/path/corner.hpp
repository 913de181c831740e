#pragma once
/// A corner between two straight legs, rounded over a length d to both sides of it.
///
///   sin(θ/2) = |t₂ − t₁|/2, cos(θ/2) = |t₂ + t₁|/2      distance of corner and path: 35/128·d·sin(θ/2)
///
///   t₁, t₂ unit vectors before and after the corner, which turns by θ. The sums keep their digits where θ is small or nearly
///   180°. The blend is what make_corner (segment_path.hpp) gives for two lines.
/// Real time: safe.

#include <stribeck/core/vec.hpp>

namespace stribeck::path {

/// Half the angle of a corner.
struct HalfTurn {
  double sine = 0.0;
  double cosine = 1.0;
};
template <std::size_t N>
HalfTurn half_turn(const Vec<double, N>& before, const Vec<double, N>& after) noexcept {
  return {0.5 * norm(after - before), 0.5 * norm(after + before)};
}

/// Distance of the corner from a blend of length d [m].
constexpr double blend_deviation(double d, double sine) noexcept { return 35.0 / 128.0 * d * sine; }
/// Length d [m] of the blend with this deviation [m].
constexpr double blend_length(double deviation, double sine) noexcept {
  return deviation / (35.0 / 128.0 * sine);
}

}  // namespace stribeck::path
