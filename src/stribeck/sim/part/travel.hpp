#pragma once
/// A path with its law of motion, as an experiment travels it, and its samples, which all runs on it share.
///
/// A travel begins at rest on the path, reaches its law within the run-in, keeps it, and runs out. The part between is scored,
/// except the laps to settle. A part program is travelled with its own feed from rest to rest, and scored from end to end.
/// A cutting force may act during the travel.
/// Real time: no.

#include <limits>
#include <optional>
#include <stribeck/path/contour_error.hpp>
#include <stribeck/path/curve.hpp>
#include <stribeck/path/five_axis.hpp>
#include <stribeck/path/fourier.hpp>
#include <stribeck/path/reference.hpp>
#include <stribeck/sim/cutting_force.hpp>
#include <stribeck/sim/part/part_path.hpp>
#include <string>
#include <variant>
#include <vector>

namespace stribeck::sim {

using AnyPath = std::variant<path::Curve, path::Fourier<1>, path::Fourier<2>, path::Fourier<3>,
                             path::Fourier<5>, path::ConeFrustum, PartPath<2>, PartPath<3>>;

/// How the derivatives of the frame reach a controller.
enum class FrameDerivatives { kExact, kDifferenced };

struct Travel {
  AnyPath path;
  std::string name;  ///< in words, "circle of 10 mm"
  path::Pace pace = path::Pace::kSpeed;
  /// Along the path [m/s], or of its parameter [1/s] with Pace::kRate; the mean of a part.
  double speed = 0.0;
  /// Speed [m/s] asked for along a part whose axes may force it to be slower; NaN: the program has its own feed.
  double feed = std::numeric_limits<double>::quiet_NaN();
  double laps = 2.0;    ///< number of scored laps under the law
  double run_in = 1.0;  ///< [s]
  path::FrameKind frame = path::FrameKind::kTransported;
  FrameDerivatives frame_derivatives = FrameDerivatives::kExact;
  std::optional<CuttingForce> cutting;
  std::string note;          ///< further notes for the user, in lines; may be empty
  double settle_laps = 0.0;  ///< laps under the law before the scored ones, in which adaptation settles

  [[nodiscard]] std::size_t axes() const {
    return std::visit([](const auto& p) { return std::decay_t<decltype(p)>::kAxes; }, path);
  }
  /// Length of one lap, in the unit of the law of motion.
  [[nodiscard]] double lap() const {
    return std::visit(
        [&](const auto& p) { return pace == path::Pace::kRate ? p.period() : path::lap_length(p); }, path);
  }
  /// Not defined for a part.
  [[nodiscard]] path::SpeedLaw law() const { return {speed, run_in, (settle_laps + laps) * lap()}; }
  /// The plan of a part program; null for other paths.
  [[nodiscard]] const PartSummary* part() const;
  /// From rest to rest [s].
  [[nodiscard]] double duration() const;
  /// Along the path [m/s]; NaN where it is not constant.
  [[nodiscard]] double constant_speed() const;
  /// How fast, in words: "9.5 mm/s", "one lap in 7.39 s", "at most 9.5 mm/s" or "its programmed feed".
  [[nodiscard]] std::string pace_in_words() const;
};

/// Samples of a travel.
template <std::size_t N>
struct Route {
  std::vector<path::PathPoint<N>> points;
  std::vector<Vec<double, N>>
      cutting;  ///< against +x, mean over the period from each point on [N]; empty: none
  std::vector<path::PathPoint<N>> motors;  ///< set-points of the motors (guide_motors()); empty: the points
  std::vector<Vec<double, N>> added;       ///< forces beside those of the law [N]; empty: none
  AnyPath path;
  double scored_from = 0.0;  ///< [s]
  double scored_to = 0.0;    ///< [s]
  double first_lap =
      0.0;  ///< run-in and one lap, which contain every kind of reversal; for a part the first minute [s]
  double lap = 0.0;   ///< range of the path's parameter after which it repeats; NaN: it does not repeat
  double size = 0.0;  ///< greatest distance from the first point [m]
};

/// travel.axes() must be N.
template <std::size_t N>
Route<N> sample(const Travel& travel, double period);

}  // namespace stribeck::sim

template <>
struct stribeck::EnumNames<stribeck::sim::FrameDerivatives> {
  static constexpr std::array names{
      std::pair{stribeck::sim::FrameDerivatives::kExact, std::string_view{"exact"}},
      std::pair{stribeck::sim::FrameDerivatives::kDifferenced, std::string_view{"differenced"}}};
};
