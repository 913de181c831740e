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
/// A new figure is a member of Metrics, its line in kFigures and its sum in MetricsCollector, all in this file: means over
/// trials, JSON, tables and claims loop over kFigures.
/// Real time: no.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/sim/axis_values.hpp>
#include <string_view>
#include <variant>

namespace stribeck::sim {

inline constexpr double kGlitchTravel = 0.15e-3;  ///< [m]

struct Metrics {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  double max_contour_error =
      0.0;                       ///< [m]; infinite where an axis moves less than half as far as its reference
  double quadrant_glitch = 0.0;  ///< [m]; NaN when no axis reversed
  double rms = 0.0;              ///< [m]
  double sd = 0.0;               ///< [m]
  double mean_abs = 0.0;         ///< [m]
  AxisValues mean_abs_tracking;  ///< [m]
  double power = 0.0;        ///< electrical, R·i² + K_e·θ̇·i, sum over the axes [W]; NaN when not known
  double mean_abs_ui = 0.0;  ///< [W]; NaN when the current is not known
  double input_variation = 0.0;              ///< [V]
  double max_orientation_error = kUnknown;   ///< [rad]; NaN without a tool axis
  double mean_orientation_error = kUnknown;  ///< [rad]; NaN without a tool axis
  double quadrant_ratio = kUnknown;          ///< NaN without a quadrant or a stretch between two
  double mechanical_power = kUnknown;        ///< sum over the axes [W]

  /// A value with every figure NaN: unknown.
  static Metrics unknown() noexcept;
};

/// A figure of merit as files and tables show it.
struct Figure {
  using OfRun = double Metrics::*;
  using OfAxis = AxisValues Metrics::*;
  static constexpr int kFurther = -1;

  std::variant<OfRun, OfAxis> member;
  std::string_view key;   ///< in JSON, with its unit
  double key_scale;       ///< factor from SI to that unit
  std::string_view name;  ///< heads a column
  std::string_view unit;  ///< shown; empty: a pure number
  double scale;           ///< factor from SI to that unit
  int column = 0;         ///< rank in the main table of a report, kFurther in its second table; 0: in neither
  bool marks_best = true;    ///< the smallest of a table is marked
  bool where_known = false;  ///< has a column only where some run knows it
  std::string_view tracking_name =
      {};  ///< for a single axis, where the error is the tracking error; empty: name

  [[nodiscard]] constexpr std::string_view head(bool single_axis) const noexcept {
    return single_axis && !tracking_name.empty() ? tracking_name : name;
  }
};

/// In the order of the JSON.
inline constexpr std::array kFigures{
    Figure{&Metrics::max_contour_error, "max_contour_error_um", 1e6, "max", "µm", 1e6, 1},
    Figure{&Metrics::quadrant_glitch, "quadrant_glitch_um", 1e6, "glitch", "µm", 1e6, 2},
    Figure{&Metrics::rms, "rms_um", 1e6, "RMS", "µm", 1e6, 3},
    Figure{&Metrics::sd, "sd_um", 1e6, "SD", "µm", 1e6, Figure::kFurther},
    Figure{&Metrics::mean_abs, "mean_abs_um", 1e6, "mean |ε|", "µm", 1e6, 4, true, false, "mean |e|"},
    Figure{&Metrics::power, "power_W", 1.0, "power", "W", 1.0},
    Figure{&Metrics::mean_abs_ui, "mean_abs_ui_W", 1.0, "mean |u·i|", "W", 1.0, 9, false, true},
    Figure{&Metrics::mechanical_power, "mechanical_power_W", 1.0, "mechanical power", "W", 1.0},
    Figure{&Metrics::input_variation, "input_variation_V", 1.0, "mean |Δu|", "mV", 1e3, 8, false},
    Figure{&Metrics::mean_abs_tracking, "mean_abs_tracking_um", 1e6, "mean |e|", "µm", 1e6, Figure::kFurther},
    Figure{&Metrics::max_orientation_error, "max_orientation_error_urad", 1e6, "tool axis max", "µrad", 1e6,
           6, true, true},
    Figure{&Metrics::mean_orientation_error, "mean_orientation_error_urad", 1e6, "tool axis mean", "µrad",
           1e6, 7, true, true},
    Figure{&Metrics::quadrant_ratio, "quadrant_ratio", 1.0, "quadrant ratio", "", 1.0, 5, false, true}};

/// The entry of a member; every member has its own.
constexpr const Figure& figure_of(std::variant<Figure::OfRun, Figure::OfAxis> member) noexcept {
  for (const Figure& f : kFigures) {
    if (f.member == member) return f;
  }
  return kFigures.front();
}

/// Calls act(get) for every number of the figures, each axis separately; get(m) is the number in a Metrics m.
template <class Act>
void for_each_number(Act&& act) {
  for (const Figure& f : kFigures) {
    if (const auto* run = std::get_if<Figure::OfRun>(&f.member)) {
      act([member = *run](auto& m) -> auto& { return m.*member; });
    } else {
      const Figure::OfAxis member = std::get<Figure::OfAxis>(f.member);
      for (std::size_t i = 0; i < control::kMostAxes; ++i)
        act([ member, i ](auto& m) -> auto& { return (m.*member)[i]; });
    }
  }
}

/// A member without an entry in kFigures would be missing in means and files.
static_assert([] {
  std::size_t numbers = 0;
  for (const Figure& f : kFigures) {
    numbers += f.member.index() == 0 ? 1 : control::kMostAxes;
    if (&figure_of(f.member) != &f) return false;  // listed twice
  }
  return numbers * sizeof(double) == sizeof(Metrics);
}());

inline Metrics Metrics::unknown() noexcept {
  Metrics m;
  for_each_number([&](auto get) { get(m) = kUnknown; });
  return m;
}

/// Marks the samples within the first travel after a reversal of an axis.
template <std::size_t N>
class GlitchWindow {
 public:
  bool step(const path::PathPoint<N>& r) noexcept {
    bool inside = false;
    for (std::size_t i = 0; i < N; ++i) {
      const double direction = sign(r.velocity[i]);
      if (direction != 0.0) {
        if (direction_[i] != 0.0 && direction != direction_[i]) {
          // The turning point lies between two samples; this sample is its best estimate, off by nanometres.
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
    double orientation_error = Metrics::kUnknown;
    double mechanical_power = 0.0;
    Vec<double, N> position;  ///< true [m]
  };

  void add(const Sample& s) noexcept {
    const double e = std::abs(s.contour_error);
    if (!std::isnan(max_) && !(e <= max_)) max_ = e;  // NaN stays
    if (s.in_glitch) glitch_ = std::isnan(glitch_) ? e : std::max(glitch_, e);
    window(e, s.in_glitch);
    sum_ += s.contour_error;
    sum_abs_ += e;
    sum_square_ += e * e;
    if (!std::isnan(max_orientation_) && !(s.orientation_error <= max_orientation_))
      max_orientation_ = s.orientation_error;
    sum_orientation_ += s.orientation_error;
    mechanical_ += s.mechanical_power;
    for (std::size_t i = 0; i < N; ++i) {
      is_[i].add(s.position[i]);
      should_[i].add(s.position[i] - s.tracking_error[i]);
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
    m.max_contour_error = stays_behind() ? std::numeric_limits<double>::infinity() : max_;
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
    // The end of the run may cut the last quadrant short, so it is not counted.
    m.quadrant_ratio = (quadrants_.sum / quadrants_.count) / (elsewhere_.sum / elsewhere_.count);
    return m;
  }

 private:
  struct Windows {
    double sum = 0.0;
    double count = 0.0;
  };
  struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    void add(double x) noexcept {
      low = std::min(low, x);
      high = std::max(high, x);
    }
    [[nodiscard]] double size() const noexcept { return high - low; }
  };

  /// Whether an axis that has a part in the path moved less than half as far as it should.
  [[nodiscard]] bool stays_behind() const noexcept {
    constexpr double kHasPart = 0.1;  // of the axis that moves farthest, or
    constexpr double kFar =
        2e-3;  // [m] or [rad]: an axis that turns may go farther in numbers than one that moves
    constexpr double kMoved = 0.5;
    double farthest = 0.0;
    for (const Range& r : should_) farthest = std::max(farthest, r.size());
    for (std::size_t i = 0; i < N; ++i) {
      if (should_[i].size() > std::min(kFar, kHasPart * farthest) &&
          is_[i].size() < kMoved * should_[i].size())
        return true;
    }
    return false;
  }

  /// A quadrant's window lasts as long as the axis needs for its first travel; the time after it is cut into windows of that length.
  void window(double error, bool in_quadrant) noexcept {
    if (in_quadrant != in_quadrant_) {
      if (in_quadrant_ && whole_) {
        quadrants_.sum += window_max_;
        quadrants_.count += 1.0;
        length_ = ticks_;
      }
      // The first window of a run began before the run, unless the run begins outside a quadrant.
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
  double glitch_ = Metrics::kUnknown;
  double sum_ = 0.0;
  double sum_abs_ = 0.0;
  double sum_square_ = 0.0;
  double max_orientation_ = 0.0;
  double sum_orientation_ = 0.0;
  std::array<double, N> tracking_{};
  std::array<Range, N> is_;      ///< of the positions
  std::array<Range, N> should_;  ///< of the reference
  double ui_ = 0.0;
  double power_ = 0.0;
  double mechanical_ = 0.0;
  double variation_ = 0.0;
  Vec<double, N> last_;
  int count_ = 0;
};

}  // namespace stribeck::sim
