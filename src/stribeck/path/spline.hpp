#pragma once
/// A path of points as a quintic spline: four times continuously differentiable, as frames and sliding-mode laws need.
///
///   q(φ) = Σ c_k·(φ − φ_i)^k,  k = 0 … 5,   φ_i ≤ φ < φ_{i+1}
///
///   φ     arc length [m] to the accuracy of the fit (spline_fit.hpp): |q'| is near 1
///   c_k   coefficients of one segment [m^(1−k)], in memory of the caller, who keeps it alive and unchanged
///
/// A closed spline repeats with its period. An open one continues beyond its ends with its end polynomials, so that derivatives
/// are continuous there; use it no farther out than rounding errors need.
/// Real time: safe.

#include <array>
#include <cstddef>
#include <span>
#include <stribeck/path/derivatives.hpp>
#include <stribeck/path/pieces.hpp>

namespace stribeck::path {

template <std::size_t N>
class QuinticSpline {
 public:
  static constexpr std::size_t kAxes = N;

  struct Segment {
    double begin = 0.0;                    ///< φ_i [m]
    std::array<Vec<double, N>, 6> c = {};  ///< from the constant upwards
  };

  QuinticSpline() = default;
  /// Made by fit_spline. At least one segment.
  QuinticSpline(std::span<const Segment> segments, double period, bool closed) noexcept
      : segments_(segments), period_(period), closed_(closed) {}

  /// Length of the parameter range [m]; of one lap if closed.
  [[nodiscard]] double period() const noexcept { return period_; }
  [[nodiscard]] bool closed() const noexcept { return closed_; }
  [[nodiscard]] std::span<const Segment> segments() const noexcept { return segments_; }

  /// [m]
  template <Real T>
  [[nodiscard]] Vec<T, N> point(const T& phi) const noexcept {
    const T lap = detail::in_lap(phi, period_, closed_);
    const Segment& s = segments_[detail::item_at(segments_, value_of(lap), period_)];
    return detail::polynomial(s.c, lap - T(s.begin));
  }

 private:
  std::span<const Segment> segments_;
  double period_ = 0.0;
  bool closed_ = false;
};

}  // namespace stribeck::path
