#pragma once
/// Contour error of a stream, from commanded and actual positions alone, row by row.
///
///   ε   distance of the actual position from the line through the commanded positions of the last rows; in a plane positive on the
///       left of the motion, in space without a sign; with one axis actual minus commanded
///
///   The nearest piece of the line is searched from the one of the row before, so that a loop that lags is measured against the place
///   where it is, and not against the one where it should be.
///
/// A row costs a few operations; memory is that of kKept rows. Where the lag is longer than that, ε is the distance to the oldest
/// piece.
/// Not modelled: the curvature between two commanded positions, v²T²/8r: 1.3 nm at 10 mm/s on 10 mm with 1 ms.
/// Real time: no.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace stribeck::workflow {

class ContourTracker {
 public:
  static constexpr std::size_t kMostAxes = 3;
  static constexpr std::size_t kKept = 4096;

  /// 1 to 3 axes.
  explicit ContourTracker(std::size_t axes) : axes_(axes) {}

  /// Positions in one unit; returns ε in the same unit.
  double step(std::span<const double> commanded, std::span<const double> actual);
  /// Forgets the line, after a gap.
  void restart();

 private:
  using Point = std::array<double, kMostAxes>;
  /// Square of the distance to the piece from points_[i] to the next one, which may go on beyond its end at the newest point.
  [[nodiscard]] double square_to(std::size_t i, const Point& p) const;
  [[nodiscard]] double signed_distance(std::size_t i, const Point& p, double square) const;

  std::size_t axes_;
  std::vector<Point> points_;  ///< commanded, without repeated ones
  std::size_t near_ = 0;
};

/// The largest error of each reversal of an axis, as sim/metrics.hpp has it for a run: within the first kGlitchTravel that the
/// commanded position of the axis travels after it turned.
struct QuadrantGlitch {
  double t = 0.0;  ///< of the reversal [s]
  std::size_t axis = 0;
  bool to_positive = false;  ///< the axis moves in positive direction after it
  double error_um = 0.0;     ///< with its sign
};

class QuadrantGlitches {
 public:
  explicit QuadrantGlitches(std::size_t axes) : axes_(axes) {}

  /// Commanded positions [m] and error [um]; appends the glitches whose travel has been completed.
  void step(double t, std::span<const double> commanded_m, double error_um,
            std::vector<QuadrantGlitch>& found);
  void restart();

 private:
  struct Axis {
    bool known = false;
    double last = 0.0;
    int direction = 0;
    bool open = false;
    double from = 0.0;
    QuadrantGlitch glitch;
  };
  std::vector<Axis> axes_;
};

}  // namespace stribeck::workflow
