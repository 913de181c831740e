#pragma once
/// Figures of merit of one run, by their textbook definitions (the thesis prints SD > RMS, which one signal cannot have).
///
///   max |ε|;  RMS = √mean ε²;  SD = √(RMS² − mean²);  mean |ε|
///   quadrant glitch   max |ε| within the first 0.15 mm that an axis travels after its reference velocity changed sign
///   quadrant ratio    mean of the quadrants' max |ε| over the mean max |ε| of windows of the same length elsewhere; 1: no quadrant to be seen
///   input variation   mean |Δu| over the axes and samples; chattering shows here
///   power             mean electrical power R·i² + K_e·θ̇·i, sum over the axes; known where the motor is
///   mechanical power  mean of the work that force does on the axes, F·Δx over the period, sum over the axes
///   mean |u·i|        mean of the axes' sum of |u·i|; known where the current is
///   orientation       max and mean angle between the tool axis and the one wanted at the nearest point of the path
///
/// ε contour error [m], of the tool tip where the path gives a tool axis; u voltage [V], i current [A], F force put out [N].
/// Real time: no.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/sim/axis_values.hpp>

namespace stribeck::sim {

inline constexpr double kGlitchTravel = 0.15e-3;  ///< [m]

struct Metrics {
  double max_contour_error = 0.0;  ///< [m]
  double quadrant_glitch = 0.0;    ///< [m]; NaN when no axis reversed
  double rms = 0.0;                ///< [m]
  double sd = 0.0;                 ///< [m]
  double mean_abs = 0.0;           ///< [m]
  AxisValues mean_abs_tracking;    ///< [m]
  double power = 0.0;        ///< electrical, R·i² + K_e·θ̇·i, sum over the axes [W]; NaN when not known
  double mean_abs_ui = 0.0;  ///< [W]; NaN when the current is not known
  double input_variation = 0.0;  ///< [V]
  double max_orientation_error =
      std::numeric_limits<double>::quiet_NaN();  ///< [rad]; NaN without a tool axis
  double mean_orientation_error =
      std::numeric_limits<double>::quiet_NaN();  ///< [rad]; NaN without a tool axis
  double quadrant_ratio =
      std::numeric_limits<double>::quiet_NaN();  ///< NaN without a quadrant or a stretch between two
  double mechanical_power = std::numeric_limits<double>::quiet_NaN();  ///< sum over the axes [W]

  /// Every figure NaN: not known.
  static Metrics unknown() noexcept {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNone, kNone, kNone, kNone, kNone, control::spread<control::kMostAxes>({}, kNone), kNone, kNone,
            kNone, kNone, kNone, kNone, kNone};
  }
};

/// Marks the samples that lie within the first travel after a reversal of an axis.
template <std::size_t N>
class GlitchWindow {
 public:
  bool step(const path::PathPoint<N>& r) noexcept {
    bool inside = false;
    for (std::size_t i = 0; i < N; ++i) {
      const double direction = sign(r.velocity[i]);
      if (direction != 0.0) {
        if (direction_[i] != 0.0 && direction != direction_[i]) {
          // The turning point lies between two samples; this one is its best estimate, off by nanometres.
          start_[i] = r.position[i];
          open_[i] = true;
        }
        direction_[i] = direction;
      }
      if (open_[i] && std::abs(r.position[i] - start_[i]) > kGlitchTravel) open_[i] = false;
      inside = inside || open_[i];
    }
    return inside;
  }

 private:
  std::array<double, N> direction_{};
  std::array<double, N> start_{};
  std::array<bool, N> open_{};
};

/// Collects Metrics sample by sample.
template <std::size_t N>
class MetricsCollector {
 public:
  struct Sample {
    double contour_error = 0.0;
    Vec<double, N> tracking_error;
    Vec<double, N> voltage;
    Vec<double, N> current;
    Vec<double, N> power;
    bool in_glitch = false;
    double orientation_error = std::numeric_limits<double>::quiet_NaN();
    double mechanical_power = 0.0;
  };

  void add(const Sample& s) noexcept {
    const double e = std::abs(s.contour_error);
    if (!(e <= max_)) max_ = e;  // NaN stays
    if (s.in_glitch) glitch_ = std::isnan(glitch_) ? e : std::max(glitch_, e);
    window(e, s.in_glitch);
    sum_ += s.contour_error;
    sum_abs_ += e;
    sum_square_ += e * e;
    if (!(s.orientation_error <= max_orientation_)) max_orientation_ = s.orientation_error;
    sum_orientation_ += s.orientation_error;
    mechanical_ += s.mechanical_power;
    for (std::size_t i = 0; i < N; ++i) {
      tracking_[i] += std::abs(s.tracking_error[i]);
      ui_ += std::abs(s.voltage[i] * s.current[i]);
      power_ += s.power[i];
      if (count_ > 0) variation_ += std::abs(s.voltage[i] - last_[i]);
    }
    last_ = s.voltage;
    ++count_;
  }

  [[nodiscard]] Metrics result() const noexcept {
    const double n = count_;
    const double mean = sum_ / n;
    Metrics m;
    m.max_contour_error = max_;
    m.quadrant_glitch = glitch_;
    m.rms = std::sqrt(sum_square_ / n);
    m.sd = std::sqrt(std::max(0.0, sum_square_ / n - mean * mean));
    m.mean_abs = sum_abs_ / n;
    for (std::size_t i = 0; i < N; ++i) m.mean_abs_tracking[i] = tracking_[i] / n;
    m.power = power_ / n;
    m.mean_abs_ui = ui_ / n;
    m.mechanical_power = mechanical_ / n;
    m.input_variation = variation_ / (static_cast<double>(N) * (n - 1.0));
    m.max_orientation_error = max_orientation_;
    m.mean_orientation_error = sum_orientation_ / n;
    // The last quadrant may be cut short by the end of the run and is not counted.
    m.quadrant_ratio = (quadrants_.sum / quadrants_.count) / (elsewhere_.sum / elsewhere_.count);
    return m;
  }

 private:
  struct Windows {
    double sum = 0.0;
    double count = 0.0;
  };

  /// A quadrant's window lasts as long as the axis needs for its first travel; what follows is cut into windows as long.
  void window(double error, bool in_quadrant) noexcept {
    if (in_quadrant != in_quadrant_) {
      if (in_quadrant_ && whole_) {
        quadrants_.sum += window_max_;
        quadrants_.count += 1.0;
        length_ = ticks_;
      }
      // The first window of a run has begun before it, unless it begins outside.
      whole_ = in_quadrant && count_ > 0;
      in_quadrant_ = in_quadrant;
      ticks_ = 0;
      window_max_ = 0.0;
    }
    window_max_ = std::max(window_max_, error);
    ++ticks_;
    if (in_quadrant || length_ == 0 || ticks_ < length_) return;
    elsewhere_.sum += window_max_;
    elsewhere_.count += 1.0;
    ticks_ = 0;
    window_max_ = 0.0;
  }

  Windows quadrants_;
  Windows elsewhere_;
  bool in_quadrant_ = false;
  bool whole_ = false;
  int ticks_ = 0;
  int length_ = 0;
  double window_max_ = 0.0;
  double max_ = 0.0;
  double glitch_ = std::numeric_limits<double>::quiet_NaN();
  double sum_ = 0.0;
  double sum_abs_ = 0.0;
  double sum_square_ = 0.0;
  double max_orientation_ = 0.0;
  double sum_orientation_ = 0.0;
  std::array<double, N> tracking_{};
  double ui_ = 0.0;
  double power_ = 0.0;
  double mechanical_ = 0.0;
  double variation_ = 0.0;
  Vec<double, N> last_;
  int count_ = 0;
};

}  // namespace stribeck::sim
