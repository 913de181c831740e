#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/io/file.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/laws.hpp>
#include <stribeck/report/pages/compare_report.hpp>
#include <stribeck/report/pages/verdict.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/plot/contour_plots.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kMicro = 1e6;
constexpr double kMilli = 1e3;
constexpr double kDegrees = 180.0 / kPi;
/// Of text inside a drawing: the colours of some controllers are too light to read.
constexpr const char* kInk = "#202124";

using Trace = std::vector<sim::ContourSample>;

/// What happened on one travel.
struct Block {
  std::size_t index = 0;  ///< of the travel
  const sim::Travel* travel = nullptr;
  std::string text;  ///< "9.5 mm/s"
  Rows rows;
  const PrintedTable* printed = nullptr;
};

std::vector<Block> blocks_of(const CompareReportInput& input) {
  std::vector<Block> blocks;
  for (const sim::CompareRow& r : input.result.rows) {
    auto at = std::find_if(blocks.begin(), blocks.end(), [&](const Block& b) { return b.index == r.travel; });
    if (at == blocks.end()) {
      const sim::Travel& travel = input.result.spec.travels.at(r.travel);
      blocks.push_back({r.travel, &travel, travel.pace_in_words(), {}, find_printed(input.printed, r.speed)});
      at = blocks.end() - 1;
    }
    at->rows.push_back(&r);
  }
  return blocks;
}

std::string micrometres(double metres) { return decimals(metres * kMicro, 2); }

// ---- in words
// -----------------------------------------------------------------------------------------------------

/// How the block stands against print, in one sentence; empty without print.
std::string against_print(const Block& block) {
  if (block.printed == nullptr) return {};
  std::vector<std::string> near;
  const sim::CompareRow* farthest = nullptr;
  double worst = 0.0;
  const auto ratio = [&](const sim::CompareRow& r) {
    const PrintedRow* p = block.printed->find(r.controller.id);
    return p == nullptr ? kNaN : r.mean.max_contour_error * kMicro / p->max_contour_error_um;
  };
  for (const sim::CompareRow* r : block.rows) {
    const double off = std::abs(std::log(ratio(*r)));
    if (off < std::log(1.1)) near.push_back(name_of(*r));
    if (off > worst) {
      worst = off;
      farthest = r;
    }
  }
  if (farthest == nullptr) return {};
  std::string text = "Largest error against " + std::string(block.printed->source) + ": ";
  text += near.empty() ? "no controller is within 10 % of the printed value"
                       : listed(near) + " within 10 % of the printed value";
  return text + fmt::format("; the largest difference has {}, {} times the printed value.",
                            name_of(*farthest), decimals(ratio(*farthest), 2));
}

// ---- table
// --------------------------------------------------------------------------------------------------------

/// A column of figures: of the runs, or of one axis.
struct FigureColumn {
  const sim::Figure* figure;
  std::string head;
  std::size_t axis = 0;

  [[nodiscard]] double of(const sim::Metrics& m) const {
    if (const auto* run = std::get_if<sim::Figure::OfRun>(&figure->member)) return m.**run;
    return (m.*std::get<sim::Figure::OfAxis>(figure->member))[axis];
  }
  [[nodiscard]] std::optional<double> printed(const PrintedRow& row) const {
    const auto* run = std::get_if<sim::Figure::OfRun>(&figure->member);
    return run != nullptr ? row.of(*run) : std::nullopt;
  }
};

/// The figures that decide, by rank.
std::vector<FigureColumn> main_figures(const sim::CompareResult& result) {
  std::vector<FigureColumn> all;
  for (const sim::Figure& f : sim::kFigures) {
    const FigureColumn column{&f, std::string(f.head(result.axes.size() == 1))};
    const bool known = std::any_of(result.rows.begin(), result.rows.end(), [&](const sim::CompareRow& r) {
      return std::isfinite(column.of(r.mean));
    });
    if (f.column > 0 && (known || !f.where_known)) all.push_back(column);
  }
  std::sort(all.begin(), all.end(),
            [](const FigureColumn& a, const FigureColumn& b) { return a.figure->column < b.figure->column; });
  return all;
}

/// The others, in a table of their own: one with all would be wider than a page.
std::vector<FigureColumn> further_figures(const sim::CompareResult& result) {
  std::vector<FigureColumn> all;
  for (const sim::Figure& f : sim::kFigures) {
    if (f.column != sim::Figure::kFurther) continue;
    if (std::holds_alternative<sim::Figure::OfRun>(f.member)) {
      all.push_back({&f, std::string(f.name)});
      continue;
    }
    // The tracking error of one axis alone is in the main table.
    const std::size_t axes = result.axes.size() < 2 ? 0 : std::min(result.axes.size(), control::kMostAxes);
    for (std::size_t i = 0; i < axes; ++i) all.push_back({&f, std::string(f.name) + " " + result.axes[i], i});
  }
  return all;
}

Table controllers_table(const Block& block, const std::vector<FigureColumn>& figures) {
  Table t{"At " + block.text, {{"controller", "", false}}, {}};
  for (const FigureColumn& f : figures) t.columns.push_back({f.head, std::string(f.figure->unit)});
  std::vector<double> best(figures.size(), std::numeric_limits<double>::infinity());
  for (const sim::CompareRow* r : block.rows) {
    for (std::size_t i = 0; i < figures.size(); ++i) best[i] = std::fmin(best[i], figures[i].of(r->mean));
  }
  for (const sim::CompareRow* one : block.rows) {
    const sim::CompareRow& r = *one;
    const PrintedRow* printed = block.printed != nullptr ? block.printed->find(r.controller.id) : nullptr;
    std::vector<Cell> row{{name_of(r), "", r.controller.label, false, color_of(r, block.rows)}};
    for (std::size_t i = 0; i < figures.size(); ++i) {
      const FigureColumn& f = figures[i];
      const double scale = f.figure->scale;
      const double value = f.of(r.mean);
      const double spread = f.of(r.spread);
      Cell cell{decimals(value * scale, 2)};
      if (std::isfinite(spread)) cell.spread = "± " + decimals(spread * scale, 2);
      cell.best = f.figure->marks_best && value == best[i] && block.rows.size() > 1;
      if (const auto print = printed != nullptr ? f.printed(*printed) : std::nullopt) {
        cell.note = "thesis " + decimals(*print, 2);
        // Printed standard deviations contradict the printed RMS; a ratio to them would say nothing.
        if (f.figure != &sim::figure_of(&sim::Metrics::sd))
          cell.note += " · ×" + decimals(value * scale / *print, 2);
      }
      row.push_back(std::move(cell));
    }
    t.rows.push_back(std::move(row));
  }
  return t;
}

/// What adaptation found changed, one row for each controller, travel and axis; no rows without adaptation.
Table drift_table(const sim::CompareResult& result) {
  Table t{"",
          {{"controller", "", false},
           {"axis", "", false},
           {"friction", "%"},
           {"forwards", "%"},
           {"backwards", "%"},
           {"viscous", "%"},
           {"break-away distance", "%"},
           {"mass", "%"},
           {"delay", "ms"},
           {"in words", "", false}},
          {}};
  for (const sim::CompareRow& r : result.rows) {
    for (std::size_t i = 0; i < r.drift.size(); ++i) {
      const control::Drift& d = r.drift[i];
      const auto percent = [](double share, double deviation) {
        Cell cell{fmt::format("{:+.0f}", 100.0 * share)};
        if (std::isfinite(deviation)) cell.spread = fmt::format("± {:.0f}", 100.0 * deviation);
        return cell;
      };
      constexpr double kUnsaid = std::numeric_limits<double>::quiet_NaN();
      Cell delay{fmt::format("{:+.1f}", 1e3 * d.delay)};
      delay.spread = fmt::format("± {:.1f}", 1e3 * d.delay_deviation);
      t.rows.push_back({{name_of(r), "", result.spec.travels[r.travel].pace_in_words()},
                        {result.axes[i]},
                        percent(d.level, d.level_deviation),
                        percent(d.positive, kUnsaid),
                        percent(d.negative, kUnsaid),
                        percent(d.viscous, d.viscous_deviation),
                        percent(d.break_away, d.break_away_deviation),
                        percent(d.mass, d.mass_deviation),
                        delay,
                        {std::string(describe(d.verdict))}});
    }
  }
  return t;
}

/// The plane curve of a travel, or null.
const path::Curve* plane_curve(const sim::Travel& travel) { return std::get_if<path::Curve>(&travel.path); }

Series line_of(const Block& block, const sim::CompareRow* r) {
  Series s;
  s.label = full_name(*r);
  s.color = color_of(*r, block.rows);
  s.width = 1.3;
  return s;
}

// ---- contour with its error magnified
// -----------------------------------------------------------------------------

/// The greatest of 1, 2, 3, 5 times a power of ten that is not above x.
double round_down(double x) {
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double digit : {5.0, 3.0, 2.0}) {
    if (digit * power <= x * (1.0 + 1e-12)) return digit * power;
  }
  return power;
}

struct Magnified {
  std::vector<Plot> plots;
  std::string caption;
};

/// Controllers of one scale, on the path with their errors magnified.
Magnified contour_plots(const Block& block, const ScaleGroup& group, const path::Curve& curve) {
  constexpr double kRoom = 0.6;  // of the path's size, for the largest error
  constexpr double kMostMagnification = 1e5;
  const double worst = group.largest > 0.0 ? group.largest : 1e-6;
  const double magnification = round_down(std::min(kRoom * curve.size / worst, kMostMagnification));
  const double ring = round_down(0.4 * worst);

  Series line{.color = "#9aa0a6", .width = 1.0};
  std::array<Series, 2> rings{Series{.color = "#b6bbc0", .width = 0.8, .dashed = true},
                              Series{.color = "#b6bbc0", .width = 0.8, .dashed = true}};
  constexpr int kPoints = 240;
  Vec2 low{{1e9, 1e9}};
  Vec2 high{{-1e9, -1e9}};
  for (int i = 0; i <= kPoints; ++i) {
    const auto q = path::derivatives<1>(curve, curve.period() * i / kPoints);
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
  double half = 0.0;
  for (std::size_t k = 0; k < 2; ++k) half = std::max(half, 0.5 * (high[k] - low[k]));
  const Vec2 middle = 0.5 * (low + high);

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
    for (std::size_t i = 0; i < angle.size(); ++i) {
      const auto q = path::derivatives<1>(curve, angle[i] / kDegrees);
      const double stretch = norm(q[1]);
      const double scale = magnification * error[i] / stretch;
      s.x.push_back((q[0][0] - scale * q[1][1]) * kMilli);
      s.y.push_back((q[0][1] + scale * q[1][0]) * kMilli);
    }
    if (!s.x.empty()) {
      s.x.push_back(s.x.front());
      s.y.push_back(s.y.front());
    }
    Plot p;
    p.title = full_name(*r);
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
    if (curve.shape == path::Shape::kCircle) {
      p.notes.push_back({0.0, 0.09 * half, "max " + micrometres(r->mean.max_contour_error) + " µm", kInk});
      p.notes.push_back({0.0, -0.09 * half, "RMS " + micrometres(r->mean.rms) + " µm", kInk});
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

// ---- magnifier on a reversal
// --------------------------------------------------------------------------------------

/// Mean speed along the path [m/s].
double speed_of(const sim::Travel& travel) {
  if (travel.pace == path::Pace::kSpeed) return travel.speed;
  return std::visit([&](const auto& path) { return path::lap_length(path) / path.period() * travel.speed; },
                    travel.path);
}

/// The last reversal of an axis with all of its two millimetres inside the scored part; 0: none.
std::size_t reversal_of(const Trace& t, std::size_t axis, std::size_t reach) {
  std::size_t at = 0;
  for (std::size_t k = 1; k + reach < t.size(); ++k) {
    const bool turns = (t[k - 1].velocity[axis] < 0.0) != (t[k].velocity[axis] < 0.0);
    if (turns && t[k].scored && t[k + reach].scored) at = k;
  }
  return at;
}

/// The controllers of each scale where an axis, or several together, reverse.
ScaledPlots reversal_plots(const Block& block, const sim::CompareResult& result) {
  constexpr double kBefore = 0.4e-3;
  constexpr double kAfter = 2e-3;
  const auto reach =
      static_cast<std::size_t>(std::ceil(kAfter / speed_of(*block.travel) / result.period)) + 1;
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
      p.x_range = Range{-kBefore * kMilli, kAfter * kMilli};
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
        while (from > 1 && way[from] > -kBefore) {
          way[from - 1] = way[from] - step(from);
          --from;
        }
        double window = kNaN;
        std::size_t k = at;
        for (; k + 1 < t.size() && way[k] < kAfter; ++k) {
          const double travel = std::abs(t[k].reference[axis] - t[at].reference[axis]);
          if (std::isnan(window) && travel > sim::kGlitchTravel) window = way[k];
          way[k + 1] = way[k] + step(k + 1);
        }
        for (std::size_t i = from; i <= k; ++i) {
          s.x.push_back(way[i] * kMilli);
          s.y.push_back(t[i].contour_error * kMicro);
          if (way[i] <= kAfter) limit = std::fmax(limit, std::abs(s.y.back()));
        }
        if (p.markers.empty()) {
          p.markers.push_back({0.0, who});
          if (std::isfinite(window))
            p.markers.push_back({window * kMilli, "0.15 mm of " + result.axes[axis]});
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

// ---- forces
// -------------------------------------------------------------------------------------------------------

/// The richest controller: Gaussian model and observer if it is there, else the last one.
const sim::CompareRow* richest(const Block& block) {
  for (const sim::CompareRow* r : block.rows) {
    if (r->controller.friction == sim::FrictionUse::kGaussian &&
        r->controller.observer != control::Observer::kNone)
      return r;
  }
  return block.rows.back();
}

/// Whose forces are shown: the two that the summary compares, or the richest.
Rows force_rows(const Block& block) {
  if (const auto rivals = rivals_of(block.rows)) return {rivals->against, rivals->ours};
  return {richest(block)};
}

std::vector<Plot> force_plots(const Block& block, const CompareReportInput& input) {
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
      p.y_label = "force [N]";
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
    // What stands side by side has one scale.
    if (rows.size() < 2 || !(largest > 0.0)) continue;
    for (std::size_t k = plots.size() - rows.size(); k < plots.size(); ++k)
      plots[k].y_range = Range{-1.06 * largest, 1.06 * largest};
  }
  return plots;
}

// ---- bars
// ---------------------------------------------------------------------------------------------------------

/// Bars of these rows of a block, which are all or those of the finer scales.
Plot bar_plot(const Block& block, const Rows& rows, const std::string& error, std::string_view head,
              sim::Figure::OfRun figure) {
  Plot p;
  p.title = fmt::format("{} of the {} at {}", head, error, block.text);
  if (rows.size() < block.rows.size()) p.title += ": " + names_of(rows, block.rows) + " alone";
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
  // A few bars need not be as wide as the drawing.
  p.x_range = Range{0.5, 0.5 + std::max(4.0, static_cast<double>(rows.size()))};
  p.y_range = Range{0.0, 1.14 * std::max(top, 1e-9)};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const sim::CompareRow& r = *rows[k];
    const double spread = std::isfinite(r.spread.*figure) ? r.spread.*figure * kMicro : 0.0;
    p.notes.push_back({static_cast<double>(k) + 1.0, r.mean.*figure * kMicro + spread + 0.05 * top,
                       micrometres(r.mean.*figure)});
  }
  if (!print.x.empty()) p.series.push_back(std::move(print));
  return p;
}

// ---- page
// ---------------------------------------------------------------------------------------------------------

std::vector<std::string> all_warnings(const CompareReportInput& input) {
  std::vector<std::string> all = input.warnings;
  // What several axes share is said once.
  std::vector<std::pair<std::string, std::vector<std::string>>> said;
  for (std::size_t i = 0; i < input.axes.size(); ++i) {
    const std::string axis = i < input.result.axes.size() ? input.result.axes[i] : std::to_string(i + 1);
    for (const auto& [kind, r] : input.axes[i].models) {
      for (const std::string& w : r.warnings) {
        const auto at = std::find_if(said.begin(), said.end(), [&](const auto& s) { return s.first == w; });
        const std::string of = fmt::format("axis {}, {} model", axis, r.model);
        if (at == said.end()) {
          said.push_back({w, {of}});
        } else {
          at->second.push_back(of);
        }
      }
    }
  }
  for (const auto& [w, of] : said) {
    all.push_back(of.size() == 1 ? of.front() + ": " + w : fmt::format("{} ({})", w, joined(of, "; ")));
  }
  for (std::string& w : status_warnings(input.result)) all.push_back(std::move(w));
  return all;
}

FrictionMap map_of(const AxisEvidence& e, const std::string& axis, double speed) {
  FrictionMap map;
  map.axis = axis;
  map.speed = speed;
  map.fit = e.find("gaussian");
  if (map.fit == nullptr) map.fit = e.find("eccentric");
  if (map.fit == nullptr) map.fit = e.find("whole");
  if (e.knowledge) {
    if (const auto& best = e.knowledge->gaussian ? e.knowledge->gaussian : e.knowledge->eccentric) {
      map.model = best->friction.steady;
      map.model_label = e.knowledge->gaussian ? "Gaussian-augmented, as given"
                                              : "eccentric model without its periodic terms";
    }
    if (e.knowledge->conventional) map.conventional = e.knowledge->conventional->friction.steady;
  }
  if (const ident::Result* r = e.find("conventional")) map.conventional = r->friction.steady;
  if (e.truth) {
    map.truth = e.truth->steady;
    if (!e.truth->eccentric.empty()) map.truth_label = "true friction without periodic terms";
  }
  return map;
}

void settings(Page& page, const CompareReportInput& input) {
  const sim::CompareSpec& spec = input.result.spec;
  Table t{"", {{"", "", false}, {"", "", false}}, {}};
  const auto add = [&](std::string key, std::string value) {
    if (!value.empty()) t.rows.push_back({{std::move(key)}, {std::move(value)}});
  };
  add("machine", input.result.machine);
  add("origin of its numbers", input.origin);
  add("experiment", input.experiment);
  std::vector<std::string> paces;
  for (const sim::Travel& travel : spec.travels) paces.push_back(travel.pace_in_words());
  if (!spec.travels.empty()) {
    const sim::Travel& first = spec.travels.front();
    if (const sim::PartSummary* part = first.part()) {
      add("path", fmt::format("{}: {}", first.name, in_words(*part)));
    } else {
      add("path", fmt::format("{}, {} laps after a run-in of {} s", first.name, short_number(first.laps),
                              short_number(first.run_in)));
    }
    if (first.axes() > 2) add("frame", std::string(enum_name(first.frame)));
  }
  add("speeds", listed(paces));
  add("control period", short_number(input.result.period * kMilli) + " ms");
  add("compensators' parameters", input.parameters);
  add("trials, seed", fmt::format("{}, {}", spec.trials, spec.seed));
  int least_steps = std::numeric_limits<int>::max();
  int most_steps = 0;
  for (const sim::CompareRow& r : input.result.rows) {
    least_steps = std::min(least_steps, r.substeps);
    most_steps = std::max(most_steps, r.substeps);
  }
  if (most_steps > 0) {
    const std::string steps = least_steps == most_steps ? std::to_string(most_steps)
                                                        : fmt::format("{} to {}", least_steps, most_steps);
    add("solver", fmt::format("{} sub-steps in a control period, chosen for {} nm of contour error", steps,
                              short_number(spec.accuracy * 1e9)));
  }
  add("program", input.version.empty() ? "" : "stribeck " + input.version);
  page.table(t);
  page.table(controllers_in_words(spec.controllers));
  Table laws{"Their laws", {{"", "", false}, {"", "", false}}, {}};
  for (const auto& [words, ids] : laws_in_words(spec.controllers)) laws.rows.push_back({{ids}, {words}});
  if (!laws.rows.empty()) page.table(laws);
  page.remark(
      "Names as in a controller file (compare --controller). Several numbers in brackets belong to the directions along and across the path, or to the axes in order. Settings without effect and settings that were left out are not listed.");
  if (!input.command.empty()) {
    page.subsection("How to reproduce this page");
    page.code(input.command);
  }
}

std::string with_scales(const std::string& caption, const ScaledPlots& drawn) {
  return drawn.scales.empty() ? caption : caption + " " + drawn.scales;
}

void identification(Page& page, const CompareReportInput& input) {
  for (std::size_t i = 0; i < std::min(input.axes.size(), input.result.axes.size()); ++i) {
    for (const auto& model : input.axes[i].models) {
      const ident::Result& result = model.second;
      std::string about = fmt::format("Axis {}: {} model by {}, {} rows", input.result.axes[i], result.model,
                                      result.method, result.rows);
      if (std::isfinite(result.held_out_rms)) {
        about += fmt::format(", {} N RMS on motion that was not fitted", significant(result.held_out_rms, 3));
      }
      page.details(about, [&] {
        page.table(parameter_table(result));
        if (!result.models.empty()) page.table(candidate_table(result));
        page.warnings(result.warnings);
      });
    }
  }
}

}  // namespace

std::string compare_report(const CompareReportInput& input) {
  const sim::CompareResult& result = input.result;
  const std::vector<Block> blocks = blocks_of(input);
  std::vector<std::string> about;
  if (!input.experiment.empty()) about.push_back("experiment " + input.experiment);
  about.push_back(fmt::format("{} trial{}", result.spec.trials, result.spec.trials == 1 ? "" : "s"));
  about.push_back(fmt::format("seed {}", result.spec.seed));
  if (!input.version.empty()) about.push_back("stribeck " + input.version);
  Page page("Controllers compared: " + result.machine, joined(about, " · "));

  for (const Block& b : blocks) page.lead(verdict(b.rows, b.text, result));
  page.warnings(all_warnings(input));

  const bool one_axis = result.axes.size() == 1;
  const std::string error = error_name(result);
  const std::string letter = one_axis ? "e" : "ε";
  page.section("Figures");
  const std::vector<FigureColumn> figures = main_figures(result);
  bool printed = false;
  for (const Block& b : blocks) {
    page.table(controllers_table(b, figures));
    if (const std::string text = against_print(b); !text.empty()) page.paragraph(text);
    printed = printed || b.printed != nullptr;
  }
  page.remark(fmt::format(
      "Mean over the trials ± standard deviation between them; bold: the smallest. max: largest |{0}|. "
      "glitch: largest |{0}| within the first 0.15 mm that an axis travels after it reversed. {0}: {1}. "
      "mean |⁠Δu|: variation of the control input from period to period, which shows chattering. quadrant "
      "ratio: mean of the largest |{0}| of the quadrants divided by that of equally long windows elsewhere; at 1 no quadrant is visible.",
      letter, error));
  if (printed) {
    page.remark(
        "printed: averages of 10 trials on the hardware of the thesis, with the ratio of result to printed value. The "
        "printed SD is above the printed RMS in 11 of 12 rows, which one signal cannot have; it is shown, "
        "not compared.");
  }
  if (!blocks.empty()) {
    const std::vector<FigureColumn> further = further_figures(result);
    page.details(one_axis ? "Standard deviations" : "Standard deviations and tracking errors of the axes",
                 [&] {
                   for (const Block& b : blocks) page.table(controllers_table(b, further));
                   page.remark(one_axis ? "SD: standard deviation of e."
                                        : "SD: standard deviation of ε. e: tracking error of an axis.");
                 });
  }
  for (const Block& b : blocks) {
    const auto bars = [&](const Rows& rows) {
      return std::vector<Plot>{bar_plot(b, rows, error, "Maximum", &sim::Metrics::max_contour_error),
                               bar_plot(b, rows, error, "RMS", &sim::Metrics::rms)};
    };
    page.figures(bars(b.rows), 2, "");
    for (const Rows& fine : finer_rows(b.rows))
      page.figures(bars(fine), 2, "The same figures on a separate scale.");
  }

  bool plane = false;
  for (const Block& b : blocks) {
    const path::Curve* curve = plane_curve(*b.travel);
    if (curve == nullptr) continue;
    if (!plane) page.section("Contour, error magnified");
    plane = true;
    page.subsection(b.text);
    for (const ScaleGroup& group : scale_groups(b.rows)) {
      const Magnified m = contour_plots(b, group, *curve);
      page.figures(m.plots, 3, m.caption);
    }
  }

  if (const Table drift = drift_table(result); !drift.rows.empty()) {
    page.section("Change since identification");
    page.table(drift);
    page.remark(
        "Estimates of the on-line adaptation at the end of the first trial, as shares of the identified model, ± standard deviation. Delay: additional delay of the force beyond the assumed one.");
  }
  const std::string capital_error = one_axis ? "Tracking error" : "Contour error";
  page.section(capital_error + " along the path");
  for (const Block& b : blocks) {
    const ScaledPlots drawn = path_plots(result, b.index, {});
    page.figures(
        drawn.plots, 1,
        with_scales(
            "Last scored lap of the first trial" +
                std::string(result.axes.size() == 2 ? "; positive to the left of the direction of travel"
                            : one_axis              ? ""
                                                    : "; a distance, without a sign") +
                ". Vertical lines: an axis reverses" + (one_axis ? "." : ", a quadrant begins."),
            drawn));
  }
  page.section(capital_error + " over time");
  for (const Block& b : blocks) {
    const ScaledPlots drawn = time_plots(result, b.index, {.height = 260, .scored_only = false});
    page.figures(drawn.plots, 1, with_scales("The whole run of the first trial, from rest to rest.", drawn));
  }

  page.section(one_axis ? "One reversal, close up" : "One quadrant, close up");
  for (const Block& b : blocks) {
    const ScaledPlots drawn = reversal_plots(b, result);
    page.figures(
        drawn.plots, 2,
        with_scales("The last reversal of each axis in the first trial. The second vertical line ends the "
                    "window of the quadrant glitch.",
                    drawn));
  }

  double speed = 0.0;
  for (const sim::Travel& t : result.spec.travels) speed = std::max(speed, speed_of(t));
  bool mapped = false;
  for (std::size_t i = 0; i < std::min(input.axes.size(), result.axes.size()); ++i) {
    const FrictionMap map = map_of(input.axes[i], result.axes[i], speed);
    if (map.fit == nullptr && !map.model && !map.conventional && !map.truth) continue;
    if (!mapped) page.section("Friction");
    mapped = true;
    page.figures(
        friction_plots(map), 2,
        map.truth
            ? "The models of the compensators, and the true friction of the virtual machine, which no controller may use."
            : "The models of the compensators.");
  }

  if (!blocks.empty()) {
    page.section("Forces");
    const bool truth = std::any_of(input.axes.begin(), input.axes.end(),
                                   [](const AxisEvidence& e) { return e.truth.has_value(); });
    for (const Block& b : blocks) {
      page.figures(
          force_plots(b, input), static_cast<int>(force_rows(b).size()),
          std::string("Last scored lap of the first trial. m·r̈: mass times acceleration of the reference.") +
              (truth ? " Where controller and true friction differ, a contour error follows." : ""));
    }
  }

  const bool identified = std::any_of(input.axes.begin(), input.axes.end(),
                                      [](const AxisEvidence& e) { return !e.models.empty(); });
  if (identified || !input.parameters.empty()) {
    page.section("How the compensators were identified");
    if (!input.parameters.empty()) page.paragraph("Parameters: " + input.parameters + ".");
    identification(page, input);
  }

  page.section("Settings");
  settings(page, input);
  return page.html();
}

void write_compare_report(const std::string& directory, const CompareReportInput& input) {
  const std::string page = compare_report(input);
  io::make_directory(directory);
  io::write_atomically(directory + "/index.html", page);
}

}  // namespace stribeck::report
