#pragma once
/// A path from a file: a CSV table of points, one column per axis, named as the axes of the machine (in small or capital
/// letters) and with a unit: `x [mm]`, `x mm` or `x_mm`.
///
///   x [mm],y [mm],z [mm]
///   0,0,0
///   …
///
/// A path whose last point is its first is closed. Points equal to the one before them are merged, with a note. Refused:
/// axes that are missing, other columns, columns without a unit of length, points farther than 1000 km from zero, paths
/// shorter than 1 um, more than a million points, and what path::SplineStatus names.
/// Errors: InputError naming the file, and the row counted from 1 below the header.
/// Real time: no.

#include <cstddef>
#include <span>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/path/spline_fit.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::workflow {

/// Content of the file as columns.
struct PathColumns {
  std::string source;
  std::vector<std::vector<double>> axes;  ///< [m], in the order of the axes asked for
  std::vector<std::size_t> rows;          ///< of each point, for messages
  bool closed = false;                    ///< the last point equals the first and is left out
  std::vector<std::string> notes;         ///< what was found or merged, one sentence each
};
/// `turns` says for each axis whether it turns: it may then be in degrees, which are arcs at a radius of 1 m; empty: none does.
PathColumns path_columns(const io::Log& table, const std::vector<std::string>& axes,
                         const std::vector<bool>& turns = {});

/// The table in a file; no side file is read.
io::Log read_path_table(const std::string& file);
/// The column of an axis; null where there is none. Refuses a second one.
const io::Column* find_axis(const io::Log& table, std::string_view axis);

/// Refuses the point at `index`; an index beyond the points refuses the path as a whole.
[[noreturn]] void refuse_path(const PathColumns& columns, std::size_t index, std::string_view why);

/// Points of a path with N axes.
template <std::size_t N>
struct PathPoints {
  PathColumns columns;
  std::vector<Vec<double, N>> points;
};

/// `read_path_points<3>("part.csv", {"x", "y", "z"})`
template <std::size_t N>
PathPoints<N> path_points(const io::Log& table, const std::vector<std::string>& axes,
                          const std::vector<bool>& turns = {}) {
  PathPoints<N> p{path_columns(table, axes, turns), {}};
  p.points.resize(p.columns.rows.size());
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t k = 0; k < p.points.size(); ++k) p.points[k][i] = p.columns.axes.at(i)[k];
  }
  return p;
}
template <std::size_t N>
PathPoints<N> read_path_points(const std::string& file, const std::vector<std::string>& axes) {
  return path_points<N>(read_path_table(file), axes);
}

/// A curve that owns the memory it refers to. It can be moved but not copied.
template <class Curve, class Piece>
struct OwnedPath {
  OwnedPath() = default;
  OwnedPath(OwnedPath&&) noexcept = default;
  OwnedPath& operator=(OwnedPath&&) noexcept = default;

  std::vector<Piece> pieces;
  Curve curve;
  double deviation = 0.0;  ///< largest distance of a point from the curve [m]
};
template <std::size_t N>
using SplinePath = OwnedPath<path::QuinticSpline<N>, typename path::QuinticSpline<N>::Segment>;
/// With a tolerance [m] of 0 the curve passes through all points, even noisy ones.
template <std::size_t N>
SplinePath<N> make_spline(const PathPoints<N>& from, double tolerance) {
  SplinePath<N> made;
  made.pieces.resize(from.points.size());
  std::vector<path::SplineRow<N>> rows(path::spline_rows(from.points.size()));
  path::SplineOptions<N> options;
  options.closed = from.columns.closed;
  options.tolerance = tolerance;
  const auto fit = path::fit_spline<N>(from.points, options, made.pieces, rows, made.curve);
  if (fit.status != path::SplineStatus::kOk) refuse_path(from.columns, fit.index, path::describe(fit.status));
  made.deviation = fit.deviation;
  return made;
}

}  // namespace stribeck::workflow
