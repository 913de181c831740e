#pragma once
/// The fastest progress along a path that the limits of acceleration and speed of every axis permit over the coming stretch, never
/// faster than programmed.
///
///   a = c·(z + T·w) + d·w         low ≤ a ≤ high          z⁺ = z + 2T·w,  0 ≤ z ≤ most          every axis, every stage
///
///   z = θ̇² [1], θ time as the path was programmed, θ̇ = 1 as programmed; w = θ̈ [1/s]; d mean of ṙ, c mean of r̈ over a stage of
///   the programmed length T. Backwards: the greatest z_j from which some w leads to a z that the next stage permits (reach());
///   Newton's method finds it. Forwards: at every stage the greatest w (advance()).
///
/// If no w satisfies all bounds, the w that violates them least is taken, and it brakes.
/// Source: Pham, Pham 2018, doi:10.1109/TRO.2018.2819195; Bobrow, Dubowsky, Gibson 1985, doi:10.1177/027836498500400301.
/// Not modelled: jerk; the path beyond the last stage.
/// Real time: safe.

#include <array>
#include <cstddef>
#include <stribeck/core/vec.hpp>

namespace stribeck::control {

template <std::size_t N, std::size_t Most>
class Progress {
 public:
  struct Stage {
    Vec<double, N> d;    ///< mean velocity as programmed [m/s]
    Vec<double, N> c;    ///< mean acceleration as programmed [m/s²]
    Vec<double, N> low;  ///< bounds of the acceleration [m/s²]
    Vec<double, N> high;
    double most = 1.0;  ///< greatest z at its start
  };
  /// Stages ahead; greatest[j]: largest z permitted at the beginning of stage j.
  struct Work {
    std::array<Stage, Most> stage{};
    std::array<double, Most + 1> greatest{};
  };
  /// Rate and place after a period.
  struct Moved {
    double rate = 1.0;   ///< θ̇
    double place = 0.0;  ///< θ since the beginning of the first stage, in periods
    double pull = 0.0;   ///< θ̈ [1/s]
  };

  Progress() = default;
  explicit Progress(double period) noexcept : t_(period) {}

  /// Fills greatest[] for n stages; last: largest z at their end.
  void reach(Work& w, std::size_t n, double last) const noexcept {
    w.greatest[n] = last;
    for (std::size_t j = n; j-- > 0;) {
      const Stage& s = w.stage[j];
      double z = standing(s, s.most);
      // The gap of the range is concave in z: Newton's steps from above stay above and end on its last piece.
      for (int k = 0; k < kSteps; ++k) {
        const Range r = range(s, z, w.greatest[j + 1], 1.0);
        if (r.possible()) break;
        const double slope = r.high_slope - r.low_slope;
        const double lower = z - (r.high - r.low) / slope;
        z = slope < 0.0 && lower > 0.0 ? lower : 0.0;
        if (!(z > 0.0)) break;
      }
      w.greatest[j] = z;
    }
  }

  /// Advances by one control period, as fast as permitted and not slower than `least`; n stages.
  [[nodiscard]] Moved advance(const Work& w, std::size_t n, Moved from, double least) const noexcept {
    auto j = static_cast<std::size_t>(from.place);
    if (j >= n) return {from.rate, from.place + from.rate, 0.0};
    double left = static_cast<double>(j + 1) - from.place;
    // A stage that is almost over leaves no time to act.
    if (left < 0.5 && j + 1 < n) {
      ++j;
      left += 1.0;
    }
    const Range r = range(w.stage[j], from.rate * from.rate, w.greatest[j + 1], left);
    double pull = r.high;
    if (!r.possible()) pull = min_of(0.5 * (r.low + r.high), 0.0);
    const double rate = max_of(from.rate + t_ * pull, max_of(least, 0.0));
    return {rate, from.place + 0.5 * (from.rate + rate), (rate - from.rate) / t_};
  }

 private:
  /// Limit of Newton's steps: there are no more pieces than pairs of bounds, and few are met.
  static constexpr int kSteps = 12;
  /// Slower than this counts as standing [m/s].
  static constexpr double kStands = 1e-9;

  struct Range {
    double low;
    double high;
    double low_slope;  ///< by z
    double high_slope;
    [[nodiscard]] bool possible() const noexcept { return low - high <= 1e-9 * (1.0 + abs(low)); }
  };

  /// The largest z, up to `most`, at which the axes that w does not move are within their bounds.
  [[nodiscard]] double standing(const Stage& s, double z) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      if (!(abs(s.d[i] + t_ * s.c[i]) < kStands)) continue;
      if (s.c[i] * z > s.high[i]) z = max_of(s.high[i] / s.c[i], 0.0);
      if (s.c[i] * z < s.low[i]) z = max_of(s.low[i] / s.c[i], 0.0);
    }
    return z;
  }

  /// The range of w permitted at z, so that z is at most `next` after this many stages.
  [[nodiscard]] Range range(const Stage& s, double z, double next, double stages) const noexcept {
    const double slope = -0.5 / (t_ * stages);
    Range r{slope * z, slope * (z - next), slope, slope};
    for (std::size_t i = 0; i < N; ++i) {
      const double b = s.d[i] + t_ * s.c[i];
      if (abs(b) < kStands) continue;
      const double c = -s.c[i] / b;
      const double p = s.low[i] / b + c * z;
      const double q = s.high[i] / b + c * z;
      const double least = min_of(p, q);
      const double most = max_of(p, q);
      if (least > r.low) {
        r.low = least;
        r.low_slope = c;
      }
      if (most < r.high) {
        r.high = most;
        r.high_slope = c;
      }
    }
    return r;
  }

  double t_ = 1e-3;
};

}  // namespace stribeck::control
