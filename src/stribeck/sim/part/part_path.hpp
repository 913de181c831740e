#pragma once
/// The path of a part program with its feed: lines and arcs with rounded corners, travelled under limits of speed, acceleration
/// and jerk of every axis (docs/theory/feed-profile.md).
///
///   |q_i'·ṡ| ≤ v_i      |q_i''·ṡ² + q_i'·s̈| ≤ a_i      |q_i'''·ṡ³ + 3·q_i''·ṡ·s̈ + q_i'·s⃛| ≤ j_i       ' = d/ds
///
///   Every segment gets a highest speed c, and limits a_t, j_t of s̈ and s⃛ that hold at any speed up to c. Between two stops the
///   slowest segment is crossed at its c without acceleration. The parts before and behind it are then planned in the same
///   way; the rest is one ramp up and one down. Position, speed and acceleration are continuous.
///
/// Source: seven-segment ramps as in speed_ramp.hpp; corners as in segment_path.hpp.
/// Not modelled: feed override, the naive merging of short moves (G64 Q), a tool; least time under these limits.
/// Real time: no.

#include <cstdint>
#include <memory>
#include <stribeck/path/feed_profile.hpp>
#include <stribeck/path/reference.hpp>
#include <stribeck/path/segment_path.hpp>
#include <vector>

namespace stribeck::sim {

/// What happens at the end of a move.
enum class Junction : std::uint8_t {
  kRound,  ///< the corner is rounded within the tolerance
  kExact,  ///< rounded within kExactTolerance if it turns by less than a degree, else a stop
  kStop,
};

/// Resolution of the interpreter's output [m].
inline constexpr double kExactTolerance = 1e-7;

/// One programmed move, from the end of the last one; SI.
struct PartMove {
  Vec<double, 3> to;
  bool arc = false;
  Vec<double, 3> centre;   ///< arc
  Vec<double, 3> normal;   ///< of the plane of an arc, length 1
  int turns = 0;           ///< arc: positive counter-clockwise about the normal; 1: up to once around
  double feed = 0.0;       ///< infinite: as fast as the axes can
  double tolerance = 0.0;  ///< at its end, with kRound
  Junction junction = Junction::kRound;
  double dwell = 0.0;  ///< at its end, with kStop [s]
};

/// Limits of each axis.
template <std::size_t N>
struct PartLimits {
  Vec<double, N> speed;
  Vec<double, N> acceleration;
  Vec<double, N> jerk;
};

/// Facts about the planned path of a program.
struct PartSummary {
  std::size_t moves = 0;    ///< with travel
  std::size_t stops = 0;    ///< between the first move and the last
  std::size_t corners = 0;  ///< rounded
  std::size_t limited = 0;  ///< number of moves whose feed is above the limits of the axes
  double length = 0.0;      ///< travelled [m]
  double duration = 0.0;    ///< [s]
  double deviation = 0.0;   ///< largest between the programmed and the rounded path [m]
};

template <std::size_t N>
struct Part {
  std::vector<path::Segment<N>> segments;
  std::vector<path::FeedPhase> phases;
  path::SegmentPath<N> path;
  path::FeedProfile feed;
  PartSummary summary;
};

/// The path of a part, which owns its memory; for an experiment.
template <std::size_t N>
struct PartPath {
  static constexpr std::size_t kAxes = N;

  std::shared_ptr<const Part<N>> part;

  [[nodiscard]] double period() const noexcept { return part->path.period(); }
  [[nodiscard]] static constexpr bool closed() noexcept { return false; }
  template <Real T>
  [[nodiscard]] Vec<T, N> point(const T& phi) const noexcept {
    return part->path.point(phi);
  }
};

/// With two axes, z of the moves is ignored. Null where no move has travel. Limits are those of the axes and positive.
template <std::size_t N>
std::shared_ptr<const Part<N>> plan_part(const Vec<double, 3>& start, const std::vector<PartMove>& moves,
                                         const PartLimits<N>& limits);

/// Plans a curve that is given as segments with continuous derivatives (polynomials: SegmentKind::kCorner), from rest to rest at one
/// feed. Its narrow bends are cut into pieces (tame_pieces.hpp), and at a cusp the motion stops. Null where the curve has no
/// length.
template <std::size_t N>
std::shared_ptr<const Part<N>> plan_smooth(std::vector<path::Segment<N>> segments, double feed,
                                           const PartLimits<N>& limits);

/// The motion along a part at ascending times, with the transported frame. After a stop in a corner a new frame is started.
template <std::size_t N>
class PartMotion {
 public:
  explicit PartMotion(const Part<N>& part) noexcept : part_(part) {}
  [[nodiscard]] path::PathPoint<N> at(double time) noexcept;

 private:
  const Part<N>& part_;
  std::size_t segment_ = 0;
  Vec<double, N> position_;
  Mat<double, N> rt_;
  bool started_ = false;
};

/// The largest speed c of a segment, and its limits of s̈ and s⃛ up to that speed.
struct SegmentLimits {
  double speed = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
};
template <std::size_t N>
SegmentLimits limits_on(const path::Segment<N>& segment, double feed, const PartLimits<N>& limits);

}  // namespace stribeck::sim
