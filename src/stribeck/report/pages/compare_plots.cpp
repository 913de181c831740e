#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/core/numbers.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/pages/compare_plots.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

/// Colour of text inside a drawing: the colours of some controllers are too light to read.
constexpr const char* kInk = "#202124";

using Trace = std::vector<sim::ContourSample>;

Series line_of(const TravelBlock& block, const sim::CompareRow* r) {
  Series s;
  s.label = full_name(*r);
  s.color = color_of(*r, block.rows);
  s.width = 1.3;
  return s;
}

/// The greatest of 1, 2, 3, 5 times a power of ten that is not above x.
double round_down(double x) {
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double digit : {5.0, 3.0, 2.0}) {
    if (digit * power <= x * (1.0 + 1e-12)) return digit * power;
  }
  return power;
}

/// The last reversal of an axis whose surrounding two millimetres lie inside the scored part; 0: none.
std::size_t reversal_of(const Trace& t, std::size_t axis, std::size_t reach) {
  std::size_t at = 0;
  for (std::size_t k = 1; k + reach < t.size(); ++k) {
    const bool turns = (t[k - 1].velocity[axis] < 0.0) != (t[k].velocity[axis] < 0.0);
    if (turns && t[k].scored && t[k + reach].scored) at = k;
  }
  return at;
}

/// The longest way along the path in which an axis has travelled the window of the quadrant glitch after its last reversal [m]; 0: none.
double longest_window(const Trace& t, std::size_t axes) {
  double longest = 0.0;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    std::size_t k = reversal_of(t, axis, 0);
    if (k == 0) continue;
    const double from = t[k].reference[axis];
    double way = 0.0;
    while (k + 1 < t.size() && std::abs(t[k].reference[axis] - from) <= sim::kGlitchTravel) {
      way += norm(t[k + 1].reference - t[k].reference);
      ++k;
    }
    longest = std::max(longest, way);
  }
  return longest;
}

/// How far a close-up reaches behind a reversal [m], so that the window of the quadrant glitch ends inside it: on a circle of 20 mm
/// 2.45 mm behind the reversal.
double close_up_behind(const TravelBlock& block, std::size_t axes) {
  constexpr double kLeast = 2e-3;
  constexpr double kRoom = 1.15;
  double window = 0.0;
  for (const sim::CompareRow* r : block.rows) window = std::max(window, longest_window(r->trace, axes));
  return std::max(kLeast, kRoom * window);
}

/// The controller with the largest model: Gaussian model and observer if present, else the last one.
const sim::CompareRow* richest(const TravelBlock& block) {
  for (const sim::CompareRow* r : block.rows) {
    if (r->controller.friction == sim::FrictionUse::kGaussian &&
        r->controller.observer != control::Observer::kNone)
      return r;
  }
  return block.rows.back();
}

std::string glitch_travel_of(const std::string& axis) {
  return fmt::format("{:g} mm of {}", 1e3 * sim::kGlitchTravel, axis);
}

}  // namespace

std::optional<PlanePath> plane_path(const sim::Travel& travel) {
  PlanePath out;
  const auto take = [&](const auto& path) {
    out.at = [path](double phi) { return path::derivatives<1>(path, phi); };
    out.period = path.period();
  };
  if (const auto* curve = std::get_if<path::Curve>(&travel.path)) {
    take(*curve);
    out.size = curve->size;
    out.circle = curve->shape == path::Shape::kCircle;
    return out;
  }
  const auto* sum = std::get_if<path::Fourier<2>>(&travel.path);
  if (sum == nullptr) return {};
  take(*sum);
  out.middle = Vec2{{sum->axis[0].offset, sum->axis[1].offset}};
  out.circle = is_circle(*sum);
  constexpr int kPlaces = 240;
  Vec2 low = out.at(0.0)[0];
  Vec2 high = low;
  for (int i = 1; i < kPlaces; ++i) {
    const Vec2 q = out.at(out.period * i / kPlaces)[0];
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], q[k]);
      high[k] = std::max(high[k], q[k]);
    }
  }
  out.size = 0.5 * std::max(high[0] - low[0], high[1] - low[1]);
  return out;
}

/// A curve about the path with its errors [m] magnified, by φ in degrees [mm].
void add_magnified(Series& s, const PlanePath& path, const std::vector<double>& angle,
                   const std::vector<double>& error, double magnification) {
  for (std::size_t i = 0; i < angle.size(); ++i) {
    const auto q = path.at(angle[i] / kDegrees);
    const double scale = magnification * error[i] / norm(q[1]);
    s.x.push_back((q[0][0] - scale * q[1][1]) * kMilli);
    s.y.push_back((q[0][1] + scale * q[1][0]) * kMilli);
  }
  if (s.x.empty()) return;
  s.x.push_back(s.x.front());
  s.y.push_back(s.y.front());
}

/// The path with magnified errors, for the controllers that share a scale.
Magnified contour_plots(const TravelBlock& block, const ScaleGroup& group, const PlanePath& path) {
  constexpr double kRoom = 0.6;  // share of the path's size that the largest error may take
  constexpr double kMostMagnification = 1e5;
  const double worst = group.largest > 0.0 ? group.largest : 1e-6;
  const double magnification = round_down(std::min(kRoom * path.size / worst, kMostMagnification));
  const double ring = round_down(0.4 * worst);

  Series line{.color = "#9aa0a6", .width = 1.0, .scale = ScaleLine::kRing};
  const Series dashed{.color = "#b6bbc0", .width = 0.8, .dashed = true, .scale = ScaleLine::kRing};
  std::array<Series, 2> rings{dashed, dashed};
  constexpr int kPoints = 240;
  Vec2 low{{1e9, 1e9}};
  Vec2 high{{-1e9, -1e9}};
  for (int i = 0; i <= kPoints; ++i) {
    const auto q = path.at(path.period * i / kPoints);
    const double stretch = norm(q[1]);
    const Vec2 normal{{-q[1][1] / stretch, q[1][0] / stretch}};
    line.x.push_back(q[0][0] * kMilli);
    line.y.push_back(q[0][1] * kMilli);
    for (std::size_t side = 0; side < 2; ++side) {
      const Vec2 at = q[0] + (side == 0 ? ring : -ring) * magnification * normal;
      rings[side].x.push_back(at[0] * kMilli);
      rings[side].y.push_back(at[1] * kMilli);
    }
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], (q[0][k] - magnification * worst) * kMilli);
      high[k] = std::max(high[k], (q[0][k] + magnification * worst) * kMilli);
    }
  }
  const double half = 0.5 * std::max(high[0] - low[0], high[1] - low[1]);
  const Vec2 middle = 0.5 * (low + high);
  const Vec2 at = kMilli * path.middle;

  Magnified m;
  for (const sim::CompareRow* r : group.rows) {
    const Lap lap = last_lap(r->trace, *block.travel);
    std::vector<double> angle = lap.angle;
    std::vector<double> error;
    for (const auto* s : lap.samples) error.push_back(s == nullptr ? kNaN : s->contour_error);
    thin(angle, error, 500);
    Series s = line_of(block, r);
    s.label.clear();
    s.width = 1.5;
    add_magnified(s, path, angle, error, magnification);
    Plot p;
    p.title = full_name(*r);
    if (path.circle) p.ring = Ring{middle[0], middle[1], path.size * kMilli, kMilli / magnification};
    p.description = fmt::format("Contour of {} at {}, error magnified {} times", full_name(*r), block.text,
                                magnification);
    p.axes = false;
    p.equal_aspect = true;
    p.legend = Legend::kNone;
    p.width = 350;
    p.height = 365;
    p.x_range = Range{middle[0] - half, middle[0] + half};
    p.y_range = Range{middle[1] - 1.12 * half, middle[1] + half};
    p.notes = {{middle[0], middle[1] - 1.06 * half, fmt::format("error × {:.0f}", magnification), kInk}};
    if (path.circle) {
      p.ring = Ring{middle[0], middle[1], path.size * kMilli, kMilli / magnification};
      p.notes.push_back(
          {at[0], at[1] + 0.09 * half, "max " + micrometres(r->mean.max_contour_error) + " µm", kInk});
      p.notes.push_back({at[0], at[1] - 0.09 * half, "RMS " + micrometres(r->mean.rms) + " µm", kInk});
    }
    p.series = {rings[0], rings[1], line, std::move(s)};
    m.plots.push_back(std::move(p));
  }
  m.caption = fmt::format(
      "{}: the path (grey) and the motion of the table on the last scored lap, with its error magnified {:.0f} times. "
      "Dashed: {} µm to both sides of the path.",
      names_of(group.rows, block.rows), magnification, short_number(ring * kMicro));
  return m;
}

/// Mean speed along the path [m/s].
double speed_of(const sim::Travel& travel) {
  if (travel.pace == path::Pace::kSpeed) return travel.speed;
  return std::visit([&](const auto& path) { return path::lap_length(path) / path.period() * travel.speed; },
                    travel.path);
}

/// Errors where an axis, or several together, reverse; for the controllers of each scale.
ScaledPlots reversal_plots(const TravelBlock& block, const sim::CompareResult& result) {
  const double after = close_up_behind(block, result.axes.size());
  const double before = 0.2 * after;
  const auto reach = static_cast<std::size_t>(std::ceil(after / speed_of(*block.travel) / result.period)) + 1;
  const std::vector<ScaleGroup> groups = scale_groups(block.rows);
  ScaledPlots all;
  std::vector<double> limits;
  for (const ScaleGroup& group : groups) {
    std::vector<Plot> plots;
    double limit = 0.0;
    std::vector<std::size_t> seen;  // reversals that have a drawing
    for (std::size_t axis = 0; axis < result.axes.size(); ++axis) {
      Plot p;
      p.x_label = "distance along the path after the reversal [mm]";
      p.y_label = error_name(result) + " [µm]";
      p.width = 560;
      p.height = 360;
      p.x_range = Range{-before * kMilli, after * kMilli};
      std::string who = result.axes[axis];
      bool drawn = false;
      for (const sim::CompareRow* r : group.rows) {
        const Trace& t = r->trace;
        const std::size_t at = reversal_of(t, axis, reach);
        if (at == 0) continue;
        if (p.series.empty()) {
          drawn = std::find(seen.begin(), seen.end(), at) != seen.end();
          if (drawn) break;
          seen.push_back(at);
          std::vector<std::string> together{who};
          for (std::size_t i = axis + 1; i < result.axes.size(); ++i) {
            if (reversal_of(t, i, reach) == at) together.push_back(result.axes[i]);
          }
          who = listed(together) + (together.size() > 1 ? " reverse" : " reverses");
        }
        Series s = line_of(block, r);
        s.label = name_of(*r);
        s.width = 1.6;
        const auto step = [&](std::size_t k) { return norm(t[k].reference - t[k - 1].reference); };
        std::vector<double> way(t.size(), kNaN);
        way[at] = 0.0;
        std::size_t from = at;
        while (from > 1 && way[from] > -before) {
          way[from - 1] = way[from] - step(from);
          --from;
        }
        double ends = kNaN;
        std::size_t k = at;
        for (; k + 1 < t.size() && way[k] < after; ++k) {
          const double travel = std::abs(t[k].reference[axis] - t[at].reference[axis]);
          if (std::isnan(ends) && travel > sim::kGlitchTravel) ends = way[k];
          way[k + 1] = way[k] + step(k + 1);
        }
        for (std::size_t i = from; i <= k; ++i) {
          s.x.push_back(way[i] * kMilli);
          s.y.push_back(t[i].contour_error * kMicro);
          if (way[i] <= after) limit = std::fmax(limit, std::abs(s.y.back()));
        }
        if (p.markers.empty()) {
          p.markers.push_back({0.0, who});
          if (std::isfinite(ends)) p.markers.push_back({ends * kMilli, glitch_travel_of(result.axes[axis])});
        }
        p.series.push_back(std::move(s));
      }
      if (drawn || p.series.empty()) continue;
      p.title = fmt::format("Where {}, at {}", who, block.text);
      plots.push_back(std::move(p));
    }
    limits.push_back(1.08 * (limit > 0.0 ? limit : 1.0));
    for (Plot& p : plots) {
      p.y_range = Range{result.axes.size() > 2 ? 0.0 : -limits.back(), limits.back()};
      if (groups.size() > 1)
        p.title += ": " + names_of(group.rows, block.rows) + finer(limits, limits.size() - 1);
      all.plots.push_back(std::move(p));
    }
  }
  all.scales = scales_in_words(groups, block.rows, limits, result.axes.size() <= 2, all.plots.size());
  return all;
}

/// The controllers whose forces are shown: the two that the summary compares, or the one with the largest model.
Rows force_rows(const TravelBlock& block) {
  if (const auto rivals = rivals_of(block.rows)) return {rivals->against, rivals->ours};
  return {richest(block)};
}

std::vector<Plot> force_plots(const TravelBlock& block, const CompareReportInput& input) {
  const sim::CompareResult& result = input.result;
  const sim::Travel& travel = *block.travel;
  const Rows rows = force_rows(block);
  std::vector<Plot> plots;
  for (std::size_t axis = 0; axis < result.axes.size(); ++axis) {
    const AxisEvidence* evidence = axis < input.axes.size() ? &input.axes[axis] : nullptr;
    const bool truth = evidence != nullptr && evidence->truth.has_value();
    double largest = 0.0;
    for (const sim::CompareRow* row : rows) {
      const Lap lap = last_lap(row->trace, travel);
      double mass = 0.0;
      double load = 0.0;
      if (evidence != nullptr && evidence->knowledge) {
        const auto model = evidence->knowledge->model(row->controller.friction, result.axes[axis]);
        mass = model.mass;
        load = model.load;
      }
      Plot p;
      p.title = fmt::format("Axis {}, {} at {}", result.axes[axis],
                            rows.size() > 1 ? name_of(*row) : full_name(*row), block.text);
      p.x_label = angle_label(travel);
      p.y_label = evidence != nullptr && evidence->rotary ? "torque [N m]" : "force [N]";
      const double from = first_angle(travel) * shown_scale(travel);
      p.x_range = Range{from, from + lap_of(travel) * shown_scale(travel)};
      if (travel.part() == nullptr) p.x_step = lap_of(travel) * kDegrees / (rows.size() > 1 ? 6.0 : 12.0);
      p.width = rows.size() > 1 ? 560 : 920;
      p.height = 300;
      Series force = line_of(block, row);
      force.color = "#0072b2";  // a controller's own may be the black of the true friction
      force.label = mass > 0.0 ? "force of the controller, less m·r̈ and load" : "force of the controller";
      force.x = lap.angle;
      for (const auto* s : lap.samples)
        force.y.push_back(s == nullptr ? kNaN : s->force[axis] - mass * s->acceleration[axis] - load);
      p.series.push_back(std::move(force));
      if (truth) {
        Series friction{
            .label = "true friction", .x = lap.angle, .color = "#000000", .width = 1.2, .dashed = true};
        for (const auto* s : lap.samples) friction.y.push_back(s == nullptr ? kNaN : s->friction[axis]);
        Series difference{.label = "difference", .x = lap.angle, .color = "#cc79a7", .width = 0.9};
        for (std::size_t k = 0; k < lap.samples.size(); ++k)
          difference.y.push_back(p.series[0].y[k] - friction.y[k]);
        p.series.push_back(std::move(friction));
        p.series.push_back(std::move(difference));
      }
      for (const Series& s : p.series) {
        for (const double y : s.y) largest = std::fmax(largest, std::abs(y));
      }
      plots.push_back(std::move(p));
    }
    // Drawings side by side have the same scale.
    if (rows.size() < 2 || !(largest > 0.0)) continue;
    for (std::size_t k = plots.size() - rows.size(); k < plots.size(); ++k)
      plots[k].y_range = Range{-1.06 * largest, 1.06 * largest};
  }
  return plots;
}

/// In micrometres; small values with two digits, so that a label does not read higher than its bar.
std::string label_of_bar(double metres) {
  return metres > 0.0 && metres < 1e-7 ? significant(metres * kMicro, 2) : micrometres(metres);
}

/// Bars of these rows of a block: of all rows or of those with the finer scales.
Plot bar_plot(const TravelBlock& block, const Rows& rows, const std::string& error, std::string_view head,
              sim::Figure::OfRun figure) {
  Plot p;
  // The bars have the names of their controllers; a title that lists them has no room on a small screen.
  p.title = rows.size() < block.rows.size() ? fmt::format("{} at {}, finer scale", head, block.text)
                                            : fmt::format("{} of the {} at {}", head, error, block.text);
  p.y_label = error + " [µm]";
  p.width = 560;
  p.height = 300;
  Series print{.label = "printed in the thesis", .style = Style::kPoints, .color = "#000000", .width = 3.2};
  double top = 0.0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const sim::CompareRow& r = *rows[k];
    const double at = static_cast<double>(k) + 1.0;
    const double value = r.mean.*figure * kMicro;
    const double spread = std::isfinite(r.spread.*figure) ? r.spread.*figure * kMicro : 0.0;
    Series bar{
        .x = {at}, .y = {value}, .style = Style::kBars, .color = color_of(r, block.rows), .width = 0.62};
    if (spread > 0.0) {
      bar.y_low = {value - spread};
      bar.y_high = {value + spread};
    }
    p.series.push_back(std::move(bar));
    p.x_tics.push_back({at, name_of(r)});
    top = std::fmax(top, value + spread);
    if (const PrintedRow* row = block.printed != nullptr ? block.printed->find(r.controller.id) : nullptr;
        row != nullptr) {
      print.x.push_back(at + 0.4);
      const double printed = row->of(figure).value_or(kNaN);
      print.y.push_back(printed);
      top = std::fmax(top, printed);
    }
  }
  // A few bars need not fill the width of the drawing.
  p.x_range = Range{0.5, 0.5 + std::max(4.0, static_cast<double>(rows.size()))};
  p.y_range = Range{0.0, 1.14 * std::max(top, 1e-9)};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const sim::CompareRow& r = *rows[k];
    const double spread = std::isfinite(r.spread.*figure) ? r.spread.*figure * kMicro : 0.0;
    p.notes.push_back({static_cast<double>(k) + 1.0, r.mean.*figure * kMicro + spread + 0.05 * top,
                       label_of_bar(r.mean.*figure)});
  }
  if (!print.x.empty()) p.series.push_back(std::move(print));
  return p;
}

}  // namespace stribeck::report
