#pragma once
/// Distance along a path over time, in stretches of constant jerk: ṡ and s̈ are continuous.
///
///   s = s_i + v_i·τ + a_i·τ²/2 + j_i·τ³/6,   τ = t − t_i,  t_i ≤ t < t_{i+1}
///
/// sim::plan_part makes it; the caller owns the memory of the phases. Outside its duration the path is at rest.
/// Real time: safe.

#include <span>
#include <stribeck/path/speed_law.hpp>
#include <stribeck/path/speed_ramp.hpp>

namespace stribeck::path {

class FeedProfile {
 public:
  FeedProfile() = default;
  /// Phases in the order of their times, at least one; duration [s] and length [m] are those at the end of the last one.
  FeedProfile(std::span<const FeedPhase> phases, double duration, double length) noexcept
      : phases_(phases), duration_(duration), length_(length) {}

  [[nodiscard]] double duration() const noexcept { return duration_; }
  [[nodiscard]] double length() const noexcept { return length_; }

  [[nodiscard]] SpeedLaw::Point at(double t) const noexcept {
    if (!(t > 0.0)) return {phases_.front().s, 0.0, 0.0};
    if (t >= duration_) return {length_, 0.0, 0.0};
    std::size_t low = 0;
    std::size_t high = phases_.size();
    while (high - low > 1) {
      const std::size_t middle = low + (high - low) / 2;
      (t < phases_[middle].time ? high : low) = middle;
    }
    const FeedPhase& p = phases_[low];
    const double x = t - p.time;
    // Rounding could give a speed of −1e-17 m/s at a stop.
    return {p.s + x * (p.speed + x * (0.5 * p.acceleration + x * p.jerk / 6.0)),
            max_of(p.speed + x * (p.acceleration + 0.5 * x * p.jerk), 0.0), p.acceleration + x * p.jerk};
  }
  [[nodiscard]] std::span<const FeedPhase> phases() const noexcept { return phases_; }

 private:
  std::span<const FeedPhase> phases_;
  double duration_ = 0.0;
  double length_ = 0.0;
};

}  // namespace stribeck::path
