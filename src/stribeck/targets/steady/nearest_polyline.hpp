#pragma once
/// The continuous polyline with few corners that is nearest to a curve, by the largest error. It is the best that a control with a
/// table of a few points can do.
///
///   polyline_within    the fewest pieces with |p(x_i) − y_i| ≤ tolerance
///   nearest_polyline   the smallest largest error with this number of pieces, by bisection over the tolerance, to a millionth of the height
///
/// Corners are free in x and y. The band y ± tolerance is a tunnel; each piece goes as far through it as a straight line can. The
/// line that goes farthest separates what one more piece can reach from what it cannot. The next piece therefore begins on it, from
/// the place where it last touches the wall through which it leaves. No polyline has fewer pieces. The curve is given by samples;
/// between two of them a corner may be farther off.
///
/// Source: Suri 1986, Computer Vision, Graphics, and Image Processing 35 (paths with fewest links in a polygon).
/// Not modelled: jumps (a curve on each side), noise.
/// Real time: no.
/// Errors: std::invalid_argument when x does not ascend, sizes differ, or there are fewer than two samples.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace stribeck::targets {

struct Corner {
  double x = 0.0;
  double y = 0.0;
};

struct Polyline {
  std::vector<Corner> corners;  ///< both ends included
  double largest_error = 0.0;   ///< at the samples

  /// Value at x; beyond the ends, the value at the end.
  [[nodiscard]] double at(double x) const noexcept;
};

/// Empty where more than `pieces` would be needed.
std::optional<Polyline> polyline_within(std::span<const double> x, std::span<const double> y,
                                        double tolerance, std::size_t pieces);

Polyline nearest_polyline(std::span<const double> x, std::span<const double> y, std::size_t pieces);

/// The value that a reader gets from a text with this many significant digits.
double with_digits(double value, int digits);

}  // namespace stribeck::targets
