#pragma once
/// What makes a circle deviate: causes with their size, from the radial error over angle, direction of travel and feed.
///
///   e(θ) = Σ effect of each cause + rest,   one least-squares fit over all runs (columns: docs/theory/circular-test.md)
///
/// θ angle from +x, d = ±1 direction of travel (+ counter-clockwise), V feed, R radius; x along θ = 0, y along 90 degrees.
/// The first degrees after a reversal are left out of the fit; what they hold beyond it are the quadrant peaks. A cyclic error is
/// added where a pitch lowers the rest clearly, and so is an even drift of the centre over a log. A cause counts as found where its size is beyond 1.5 half widths of its 95 % interval, and
/// its effect at least 50 nm and a hundredth of the largest one; of a cyclic error also a twentieth of the largest spike.
///
/// Source: the causes are those that ball-bar users know; columns from the geometry of the circle. Intervals:
/// ident/stats/uncertainty.hpp, and how far a size moves beyond it when more is left out around the reversals: the tail of a spike has the
/// form of other causes.
/// Not modelled: causes that depend on temperature or place; stick-slip; two axes' slides that are no straight angle lines.
/// Real time: no. Errors: none; without enough rows there is no result.

#include <array>
#include <limits>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/ident/circle/laps.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::ident::circle {

enum class CauseKind {
  kReversalSpike,
  kBacklash,
  kLateralPlay,
  kCyclic,
  kServoMismatch,
  kScaleMismatch,
  kSquareness,
  kStraightness,
  kRadius,
  kLag,
  kVibration,
  kCentre,
  kDrift
};

/// No fault of the machine, but of how the instrument stood, or of a measurement that did not stand still.
constexpr bool is_set_up(CauseKind kind) { return kind == CauseKind::kCentre || kind == CauseKind::kDrift; }

/// The reversals of one axis in one direction of travel, at one end.
struct QuadrantPeak {
  int axis = 0;  ///< 0: x, 1: y
  bool counter_clockwise = true;
  double feed = 0.0;           ///< [m/s]; NaN: unknown
  double angle = 0.0;          ///< of the reversal [rad]
  double height = 0.0;         ///< beyond the fit; negative: inwards [m]
  double half_width_95 = 0.0;  ///< of the height
  double width = 0.0;          ///< at half height, as an angle [rad]
  double delay = 0.0;          ///< from the reversal to the top [rad]
  double before =
      std::numeric_limits<double>::quiet_NaN();  ///< a lower top of the other sign before it [m]; NaN: none
  double repeatability = 0.0;  ///< standard deviation of the height over laps [m]; NaN: one lap
  int laps = 0;
  bool in_play = false;  ///< its top lies where the axis crosses its play: it may be higher
};

struct Cause {
  CauseKind kind = CauseKind::kCentre;
  std::optional<int> axis;  ///< absent: of both
  double size = 0.0;        ///< [m], with its sign where that has a meaning
  double half_width = 0.0;  ///< of the 95 % interval [m]
  double effect = 0.0;      ///< span of its radial error over the circle [m]
  double share = 0.0;       ///< of all found effects but the set-up's
  bool found = false;
  /// Of a reversal spike: a lower top of the other sign that comes first [m]; NaN: none. It tells the cause; the larger one is what the
  /// loop makes of it.
  double before = std::numeric_limits<double>::quiet_NaN();
  /// Of a reversal spike: what an axis does behind its reversals reaches so far that it may stick and slip all along, and no advice holds.
  bool broad = false;
  /// A second number that the trade knows it by: name, value, unit of files. Empty name: none.
  struct Figure {
    std::string name;
    double value = 0.0;
    double half_width = 0.0;  ///< NaN: none
    std::string unit;
  };
  std::vector<Figure> figures;
};

struct Diagnosis {
  AxisNames axes{"x", "y"};
  bool own_encoder = false;   ///< positions of a control beside its commands, of no scale that is known
  std::vector<Cause> causes;  ///< found ones first, largest effect first
  std::vector<QuadrantPeak> peaks;
  std::vector<std::string> remarks;  ///< what these measurements cannot tell apart
  double rest_rms = 0.0;             ///< of the means over a step of the angle [m]
  double window = 0.0;               ///< angle after a reversal that was left out of the fit [rad]
  bool both_directions = true;       ///< were measured; one alone leaves several causes open
  double span = 0.0;                 ///< largest less smallest radial error, of means over a step [m]
};

/// Motions of one machine: both directions, and several feeds where there are several. Absent where no run is long enough.
std::optional<Diagnosis> diagnose(const std::vector<CircleMotion>& motions);

/// One sentence each: what it is, the next step; and whether a parameter of the control can cure it.
struct CauseWords {
  std::string_view meaning;
  std::string_view next_step;
  bool parameter = false;
};
CauseWords words_of(CauseKind kind);
/// The same for what was measured: play is not seen by the motor's own encoder, friction of a soft loop is.
CauseWords words_of(const Diagnosis& diagnosis, CauseKind kind);
/// The same for its sign: a compensation that pushes too much is to be reduced, not switched on.
CauseWords words_of(const Diagnosis& diagnosis, const Cause& cause);

}  // namespace stribeck::ident::circle

template <>
struct stribeck::EnumNames<stribeck::ident::circle::CauseKind> {
  using K = stribeck::ident::circle::CauseKind;
  static constexpr std::array<std::pair<K, std::string_view>, 13> names{
      {{K::kReversalSpike, "reversal spike"},
       {K::kBacklash, "backlash"},
       {K::kLateralPlay, "lateral play"},
       {K::kCyclic, "cyclic error"},
       {K::kServoMismatch, "servo mismatch"},
       {K::kScaleMismatch, "scale mismatch"},
       {K::kSquareness, "squareness"},
       {K::kStraightness, "straightness"},
       {K::kRadius, "radius"},
       {K::kLag, "lag"},
       {K::kVibration, "vibration"},
       {K::kCentre, "centre offset"},
       {K::kDrift, "centre drift"}}};
};
