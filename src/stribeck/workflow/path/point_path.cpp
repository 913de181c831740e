#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <utility>

#include <stribeck/report/text.hpp>
#include <stribeck/sim/part/part_path.hpp>
#include <stribeck/workflow/path/path_file.hpp>
#include <stribeck/workflow/path/planned_path.hpp>
#include <stribeck/workflow/path/point_path.hpp>

namespace stribeck::workflow {
namespace {

/// Axes of the machine that the file has columns for, in the order of the machine.
std::vector<std::size_t> axes_in(const io::Log& table, const sim::Machine& machine) {
  std::vector<std::size_t> axes;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    names.push_back(machine.axes[i].first);
    if (find_axis(table, names.back()) != nullptr) axes.push_back(i);
  }
  if (axes.size() == 2 || axes.size() == 3) return axes;
  throw io::InputError(
      {table.source, 0, "columns",
       fmt::format("got {} of the axes of the machine, expected two or three: a path has one "
                   "column for each of its axes, of {}",
                   axes.size(), report::listed(names))});
}

/// Straight lines from point to point, with rounded corners.
template <std::size_t N>
std::shared_ptr<const sim::Part<N>> plan_corners(const PathPoints<N>& from, double tolerance, double speed,
                                                 const sim::PartLimits<N>& limits) {
  const auto place = [&](std::size_t k) {
    Vec<double, 3> p;
    for (std::size_t i = 0; i < N; ++i) p[i] = from.points[k][i];
    return p;
  };
  std::vector<sim::PartMove> moves;
  const auto go_to = [&](std::size_t k) {
    sim::PartMove m;
    m.to = place(k);
    m.feed = speed;
    m.tolerance = tolerance;
    moves.push_back(m);
  };
  for (std::size_t k = 1; k < from.points.size(); ++k) go_to(k);
  if (from.columns.closed) go_to(0);
  return sim::plan_part<N>(place(0), moves, limits);
}

/// A spline, converted to segments whose polynomials use their own range.
template <std::size_t N>
std::shared_ptr<const sim::Part<N>> plan_spline(const PathPoints<N>& from, double tolerance, double speed,
                                                const sim::PartLimits<N>& limits) {
  const SplinePath<N> spline = make_spline(from, tolerance);
  const auto pieces = spline.curve.segments();
  std::vector<path::Segment<N>> segments;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    path::Segment<N> s;
    s.kind = path::SegmentKind::kCorner;
    s.length = (k + 1 < pieces.size() ? pieces[k + 1].begin : spline.curve.period()) - pieces[k].begin;
    double power = 1.0;
    for (std::size_t c = 0; c < pieces[k].c.size(); ++c, power *= s.length) s.c[c] = power * pieces[k].c[c];
    segments.push_back(std::move(s));
  }
  return sim::plan_smooth<N>(std::move(segments), speed, limits);
}

template <std::size_t N>
void plan(sim::CompareSpec& spec, const PathOptions& o, const std::vector<double>& speeds, double tolerance,
          const io::Log& table, const sim::Machine& machine) {
  std::vector<std::string> names;
  std::vector<bool> turns;
  for (const std::size_t axis : spec.axes) {
    names.push_back(machine.axes[axis].first);
    turns.push_back(machine.axes[axis].second.rotary);
  }
  const PathPoints<N> from = path_points<N>(table, names, turns);
  const sim::PartLimits<N> limits = part_limits<N>(o, machine, spec.axes);
  std::string note;
  for (const std::string& found : from.columns.notes) note += found + '\n';
  spec.travels.clear();
  for (const double speed : speeds) {
    const auto part = o.join == PointJoin::kSpline ? plan_spline<N>(from, tolerance, speed, limits)
                                                   : plan_corners<N>(from, tolerance, speed, limits);
    if (part == nullptr) refuse_path(from.columns, from.points.size(), "has no motion, expected two points");
    check_places<N>(*part, machine, spec.axes, o.path, "shift the points, or scale them down");
    spec.travels.push_back(planned_travel<N>(
        part,
        fmt::format("{} at {:.6g} mm/s", std::filesystem::path(o.path).filename().string(), speed * 1e3)));
    spec.travels.back().feed = speed;
    spec.travels.back().note = note;
    if (o.join == PointJoin::kSpline)
      spec.travels.back().note += "the contour error is the distance from the spline, not from the points\n";
  }
}

}  // namespace

void use_points(sim::CompareSpec& spec, const PathOptions& o, const std::vector<double>& speeds,
                const sim::Machine& machine) {
  const PathOptions standard;
  if (o.size != standard.size || o.laps != standard.laps)
    refuse_option("--path",
                  "points have their own size and are travelled once (leave out --size and --laps)");
  const double tolerance =
      option_si("--corner-tolerance", o.corner_tolerance, quantity("m", "um").at_least(1e-9));
  const io::Log table = read_path_table(o.path);
  spec.axes = axes_in(table, machine);
  if (spec.axes.size() == 2) {
    plan<2>(spec, o, speeds, tolerance, table, machine);
  } else {
    plan<3>(spec, o, speeds, tolerance, table, machine);
  }
}

}  // namespace stribeck::workflow
