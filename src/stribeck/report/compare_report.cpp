#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/io/file.hpp>
#include <stribeck/report/compare_report.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/laws.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kMicro = 1e6;
constexpr double kMilli = 1e3;
constexpr double kDegrees = 180.0 / kPi;

using Rows = std::vector<const sim::CompareRow*>;
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
std::string name_of(const sim::CompareRow& r) { return "(" + r.controller.id + ")"; }
std::string full_name(const sim::CompareRow& r) { return name_of(r) + " " + r.controller.label; }

// ---- in words
// -----------------------------------------------------------------------------------------------------

bool is_plain(const sim::CompareRow& r) {
  return r.controller.friction == sim::FrictionUse::kNone &&
         r.controller.observer == control::Observer::kNone;
}

const sim::CompareRow* least(const Rows& rows, double sim::Metrics::*figure) {
  const sim::CompareRow* best = nullptr;
  for (const sim::CompareRow* r : rows) {
    if (std::isfinite(r->mean.*figure) && (best == nullptr || r->mean.*figure < best->mean.*figure)) best = r;
  }
  return best;
}

/// Whether a difference of means is no more than chance: below two standard errors.
bool alike(const sim::CompareRow& a, const sim::CompareRow& b, double sim::Metrics::*figure, double trials) {
  const double sa = a.spread.*figure;
  const double sb = b.spread.*figure;
  if (!std::isfinite(sa) || !std::isfinite(sb)) return false;
  return std::abs(a.mean.*figure - b.mean.*figure) < 2.0 * std::sqrt((sa * sa + sb * sb) / trials);
}

std::string change(double value, double against) {
  const double percent = 100.0 * (value / against - 1.0);
  if (!std::isfinite(percent)) return "not comparable with";
  if (std::abs(percent) < 0.5) return "the same as";
  return fmt::format("{:.0f}\u00A0% {} than", std::abs(percent), percent < 0.0 ? "less" : "more");
}

std::string summary(const Block& block, double trials) {
  using sim::Metrics;
  const sim::CompareRow* best = least(block.rows, &Metrics::rms);
  if (best == nullptr) return "At " + block.text + " no controller gave a finite result.";
  std::string text = fmt::format("At {} {} leaves the smallest RMS contour error, {}\u00A0µm", block.text,
                                 full_name(*best), micrometres(best->mean.rms));
  std::vector<std::string> as_good;
  for (const sim::CompareRow* r : block.rows) {
    if (r != best && alike(*r, *best, &Metrics::rms, trials)) as_good.push_back(name_of(*r));
  }
  if (!as_good.empty()) text += " (" + listed(as_good) + " no further apart than chance)";

  const sim::CompareRow* plain = nullptr;
  const sim::CompareRow* conventional = nullptr;
  for (const sim::CompareRow* r : block.rows) {
    if (r == best) continue;
    if (is_plain(*r) && plain == nullptr) plain = r;
    if (r->controller.friction == sim::FrictionUse::kConventional) {
      if (conventional == nullptr || r->controller.observer == best->controller.observer) conventional = r;
    }
  }
  std::vector<const sim::CompareRow*> rivals;
  for (const sim::CompareRow* r : {plain, conventional}) {
    if (r != nullptr) rivals.push_back(r);
  }
  const auto compared = [&](double Metrics::*figure) {
    std::vector<std::string> parts;
    for (const sim::CompareRow* r : rivals) {
      parts.push_back(fmt::format("{} {} ({}\u00A0µm)", change(best->mean.*figure, r->mean.*figure),
                                  full_name(*r), micrometres(r->mean.*figure)));
    }
    return listed(parts);
  };
  if (!rivals.empty()) text += ": " + compared(&Metrics::rms);
  text += fmt::format(". Its largest error is {}\u00A0µm", micrometres(best->mean.max_contour_error));
  if (!rivals.empty()) text += ", " + compared(&Metrics::max_contour_error);
  text += ".";
  const sim::CompareRow* flattest = least(block.rows, &Metrics::max_contour_error);
  if (flattest != nullptr && flattest != best) {
    const bool chance = alike(*flattest, *best, &Metrics::max_contour_error, trials);
    text += fmt::format(" The smallest maximum has {}: {}\u00A0µm{}.", full_name(*flattest),
                        micrometres(flattest->mean.max_contour_error),
                        chance ? ", no more apart than chance" : "");
  }
  const double glitch = best->mean.quadrant_glitch;
  if (std::isfinite(glitch)) {
    const bool at_quadrant = glitch > 0.98 * best->mean.max_contour_error;
    text += fmt::format(
        " What remains at the quadrants is {}\u00A0µm within the first 0.15\u00A0mm after an axis "
        "reverses{}.",
        micrometres(glitch),
        at_quadrant ? ", and that is the largest error of all" : "; the largest error lies elsewhere");
  }
  return text;
}

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
  text += near.empty() ? "no controller is within 10 % of print" : listed(near) + " within 10 % of print";
  return text + fmt::format("; farthest off is {}, {} times print.", name_of(*farthest),
                            decimals(ratio(*farthest), 2));
}

// ---- table
// --------------------------------------------------------------------------------------------------------

struct Figure {
  std::string head;
  std::string unit;
  double scale;
  double (*of)(const sim::Metrics&);
  double PrintedRow::*printed;
  bool smaller_is_better = true;
};

std::vector<Figure> table_figures(const sim::CompareResult& result) {
  using sim::Metrics;
  std::vector<Figure> all{{"max", "µm", kMicro, [](const Metrics& m) { return m.max_contour_error; },
                           &PrintedRow::max_contour_error_um},
                          {"glitch", "µm", kMicro, [](const Metrics& m) { return m.quadrant_glitch; },
                           &PrintedRow::quadrant_glitch_um},
                          {"RMS", "µm", kMicro, [](const Metrics& m) { return m.rms; }, &PrintedRow::rms_um},
                          {"mean |ε|", "µm", kMicro, [](const Metrics& m) { return m.mean_abs; }, nullptr}};
  if (std::any_of(result.rows.begin(), result.rows.end(),
                  [](const sim::CompareRow& r) { return std::isfinite(r.mean.quadrant_ratio); })) {
    all.push_back({"quadrant ratio", "", 1.0, [](const Metrics& m) { return m.quadrant_ratio; }, nullptr});
  }
  const auto tool_axis = [](const sim::CompareRow& r) { return std::isfinite(r.mean.max_orientation_error); };
  if (std::any_of(result.rows.begin(), result.rows.end(), tool_axis)) {
    all.push_back(
        {"tool axis max", "µrad", kMicro, [](const Metrics& m) { return m.max_orientation_error; }, nullptr});
    all.push_back(
        {"mean", "µrad", kMicro, [](const Metrics& m) { return m.mean_orientation_error; }, nullptr});
  }
  all.push_back(
      {"mean |Δu|", "mV", kMilli, [](const Metrics& m) { return m.input_variation; }, nullptr, false});
  const bool current_known =
      std::any_of(result.rows.begin(), result.rows.end(),
                  [](const sim::CompareRow& r) { return std::isfinite(r.mean.mean_abs_ui); });
  if (current_known)
    all.push_back({"mean |u·i|", "W", 1.0, [](const Metrics& m) { return m.mean_abs_ui; }, nullptr, false});
  // What is looked at least stands last, where a narrow page cuts it off.
  all.push_back({"SD", "µm", kMicro, [](const Metrics& m) { return m.sd; }, &PrintedRow::sd_um});
  using Get = double (*)(const Metrics&);
  constexpr std::array<Get, control::kMostAxes> kTracking{
      [](const Metrics& m) { return m.mean_abs_tracking[0]; },
      [](const Metrics& m) { return m.mean_abs_tracking[1]; },
      [](const Metrics& m) { return m.mean_abs_tracking[2]; },
      [](const Metrics& m) { return m.mean_abs_tracking[3]; },
      [](const Metrics& m) { return m.mean_abs_tracking[4]; },
      [](const Metrics& m) { return m.mean_abs_tracking[5]; }};
  for (std::size_t i = 0; i < std::min(result.axes.size(), kTracking.size()); ++i)
    all.push_back({"mean |e| " + result.axes[i], "µm", kMicro, kTracking[i], nullptr});
  return all;
}

Table controllers_table(const Block& block, const sim::CompareResult& result) {
  const std::vector<Figure> figures = table_figures(result);
  Table t{"At " + block.text, {{"controller", "", false}}, {}};
  for (const Figure& f : figures) t.columns.push_back({f.head, f.unit});
  std::vector<double> best(figures.size(), std::numeric_limits<double>::infinity());
  for (const sim::CompareRow* r : block.rows) {
    for (std::size_t i = 0; i < figures.size(); ++i) best[i] = std::fmin(best[i], figures[i].of(r->mean));
  }
  for (std::size_t k = 0; k < block.rows.size(); ++k) {
    const sim::CompareRow& r = *block.rows[k];
    const PrintedRow* printed = block.printed != nullptr ? block.printed->find(r.controller.id) : nullptr;
    std::vector<Cell> row{{name_of(r), "", r.controller.label, false, controller_color(r.controller.id, k)}};
    for (std::size_t i = 0; i < figures.size(); ++i) {
      const Figure& f = figures[i];
      const double value = f.of(r.mean);
      const double spread = f.of(r.spread);
      Cell cell{decimals(value * f.scale, 2)};
      if (std::isfinite(spread)) cell.spread = "± " + decimals(spread * f.scale, 2);
      cell.best = f.smaller_is_better && value == best[i];
      if (printed != nullptr && f.printed != nullptr) {
        const double print = printed->*f.printed;
        cell.note = "print " + decimals(print, 2);
        // Printed standard deviations contradict the printed RMS; a ratio to them would say nothing.
        if (f.printed != &PrintedRow::sd_um) cell.note += " · ×" + decimals(value * f.scale / print, 2);
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

// ---- one lap
// ------------------------------------------------------------------------------------------------------

/// The last scored lap, by angle: the parameter of the path, from a twelfth before zero, so that no reversal
/// of a circle lies at the border.
struct Lap {
  std::vector<const sim::ContourSample*> samples;
  std::vector<double> angle;  ///< [°], ascending
};

/// Parameter of one lap [rad].
double lap_of(const sim::Travel& travel) {
  return std::visit([](const auto& path) { return path.period(); }, travel.path);
}
double first_angle(const sim::Travel& travel) {
  return travel.part() != nullptr ? 0.0 : -lap_of(travel) / 12.0;
}
/// From the parameter to what the axis of a plot shows: degrees, or millimetres along a part.
double shown_scale(const sim::Travel& travel) { return travel.part() != nullptr ? kMilli : kDegrees; }

/// The plane curve of a travel, or null.
const path::Curve* plane_curve(const sim::Travel& travel) { return std::get_if<path::Curve>(&travel.path); }

std::string angle_label(const sim::Travel& travel) {
  if (travel.part() != nullptr) return "place φ on the path [mm]";
  const path::Curve* curve = plane_curve(travel);
  return curve != nullptr && curve->shape == path::Shape::kCircle ? "angle φ of the reference [°]"
                                                                  : "parameter φ of the path [°]";
}

Lap last_lap(const Trace& trace, const sim::Travel& travel) {
  Lap lap;
  const auto last =
      std::find_if(trace.rbegin(), trace.rend(), [](const sim::ContourSample& s) { return s.scored; });
  if (last == trace.rend()) return lap;
  const double period = lap_of(travel);
  const double from = last->phi - period;
  std::vector<std::pair<double, const sim::ContourSample*>> all;
  for (const sim::ContourSample& s : trace) {
    if (!s.scored || s.phi <= from || s.phi > last->phi) continue;
    const double turns = (s.phi - first_angle(travel)) / period;
    const double whole = travel.part() != nullptr ? 0.0 : std::floor(turns);
    all.emplace_back((turns - whole) * period + first_angle(travel), &s);
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [angle, sample] : all) {
    lap.angle.push_back(angle * shown_scale(travel));
    lap.samples.push_back(sample);
  }
  return lap;
}

std::vector<Marker> reversals(const Lap& lap, const std::vector<std::string>& axes) {
  std::vector<Marker> markers;
  for (std::size_t k = 1; k < lap.samples.size(); ++k) {
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const double before = lap.samples[k - 1]->velocity[i];
      const double after = lap.samples[k]->velocity[i];
      if ((before < 0.0) == (after < 0.0)) continue;
      if (!markers.empty() && markers.back().x == lap.angle[k]) {
        // Two axes that turn together get one line.
        std::string& label = markers.back().label;
        label = label.substr(0, label.rfind(' ')) + ", " + axes[i] + " reverse";
      } else {
        markers.push_back({lap.angle[k], axes[i] + " reverses"});
      }
    }
  }
  // Many of them: the axis alone must do.
  if (markers.size() > 6) {
    for (Marker& m : markers) m.label = m.label.substr(0, m.label.rfind(' '));
  }
  return markers;
}

/// Largest |ε| drawn at this speed, so that its plots share one scale [µm].
double largest(const Rows& rows, bool whole_run) {
  double m = 0.0;
  for (const sim::CompareRow* r : rows) {
    for (const sim::ContourSample& s : r->trace) {
      if (whole_run || s.scored) m = std::fmax(m, std::abs(s.contour_error) * kMicro);
    }
  }
  return m > 0.0 ? m : 1.0;
}

/// Controllers in drawings of three: (a) to (c), (d) to (f).
std::vector<Rows> groups(const Rows& rows) {
  std::vector<Rows> all;
  for (std::size_t i = 0; i < rows.size(); i += 3) {
    all.emplace_back(rows.begin() + static_cast<std::ptrdiff_t>(i),
                     rows.begin() + static_cast<std::ptrdiff_t>(std::min(rows.size(), i + 3)));
  }
  return all;
}

std::size_t position(const Block& block, const sim::CompareRow* row) {
  return static_cast<std::size_t>(std::find(block.rows.begin(), block.rows.end(), row) - block.rows.begin());
}

Series line_of(const Block& block, const sim::CompareRow* r) {
  Series s;
  s.label = full_name(*r);
  s.color = controller_color(r->controller.id, position(block, r));
  s.width = 1.3;
  return s;
}

std::string range_name(const Rows& rows) {
  return rows.size() == 1 ? full_name(*rows.front())
                          : name_of(*rows.front()) + " to " + name_of(*rows.back());
}

std::vector<Plot> angle_plots(const Block& block, const sim::CompareResult& result) {
  const sim::Travel& travel = *block.travel;
  const double limit = 1.08 * largest(block.rows, false);
  std::vector<Plot> plots;
  for (const Rows& group : groups(block.rows)) {
    Plot p;
    p.title = fmt::format("Contour error at {}: {}", block.text, range_name(group));
    p.x_label = angle_label(travel);
    p.y_label = "contour error [µm]";
    const double from = first_angle(travel) * shown_scale(travel);
    p.x_range = Range{from, from + lap_of(travel) * shown_scale(travel)};
    if (travel.part() == nullptr) p.x_step = lap_of(travel) * kDegrees / 12.0;
    p.y_range = Range{result.axes.size() > 2 ? 0.0 : -limit, limit};
    p.height = 310;
    for (const sim::CompareRow* r : group) {
      const Lap lap = last_lap(r->trace, travel);
      if (p.markers.empty()) p.markers = reversals(lap, result.axes);
      Series s = line_of(block, r);
      s.x = lap.angle;
      for (const auto* sample : lap.samples) s.y.push_back(sample->contour_error * kMicro);
      p.series.push_back(std::move(s));
    }
    plots.push_back(std::move(p));
  }
  return plots;
}

std::vector<Plot> time_plots(const Block& block) {
  const double limit = 1.08 * largest(block.rows, true);
  std::vector<Plot> plots;
  for (const Rows& group : groups(block.rows)) {
    Plot p;
    p.title = fmt::format("Contour error at {} over time: {}", block.text, range_name(group));
    p.x_label = "time [s]";
    p.y_label = "contour error [µm]";
    p.y_range = Range{block.travel->axes() > 2 ? 0.0 : -limit, limit};
    p.height = 260;
    for (const sim::CompareRow* r : group) {
      Series s = line_of(block, r);
      s.width = 1.1;
      for (const sim::ContourSample& sample : r->trace) {
        s.x.push_back(sample.time);
        s.y.push_back(sample.contour_error * kMicro);
      }
      const auto scored = [](const sim::ContourSample& x) { return x.scored; };
      const auto first = std::find_if(r->trace.begin(), r->trace.end(), scored);
      const auto last = std::find_if(r->trace.rbegin(), r->trace.rend(), scored);
      if (p.markers.empty() && first != r->trace.end())
        p.markers = {{first->time, "scored from"}, {last->time, "to"}};
      p.series.push_back(std::move(s));
    }
    plots.push_back(std::move(p));
  }
  return plots;
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

Magnified contour_plots(const Block& block, const path::Curve& curve) {
  constexpr double kRoom = 0.6;  // of the path's size, for the largest error
  constexpr double kMostMagnification = 1e5;
  const double worst = largest(block.rows, false) / kMicro;
  const double magnification = round_down(std::min(kRoom * curve.size / worst, kMostMagnification));
  const double ring = round_down(0.4 * worst);

  Series line{.color = "#9aa0a6", .width = 1.0};
  std::array<Series, 2> rings{Series{.color = "#b6bbc0", .width = 0.8, .dashed = true},
                              Series{.color = "#b6bbc0", .width = 0.8, .dashed = true}};
  constexpr int kPoints = 240;
  double half = 0.0;
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
  half = 0.0;
  for (std::size_t k = 0; k < 2; ++k) half = std::max(half, 0.5 * (high[k] - low[k]));
  const Vec2 middle = 0.5 * (low + high);

  Magnified m;
  for (const sim::CompareRow* r : block.rows) {
    const Lap lap = last_lap(r->trace, *block.travel);
    std::vector<double> angle = lap.angle;
    std::vector<double> error;
    for (const auto* s : lap.samples) error.push_back(s->contour_error);
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
    p.y_range = Range{middle[1] - half, middle[1] + half};
    if (curve.shape == path::Shape::kCircle) {
      p.notes = {{0.0, 0.09 * half, "max " + micrometres(r->mean.max_contour_error) + " µm", s.color},
                 {0.0, -0.09 * half, "RMS " + micrometres(r->mean.rms) + " µm", s.color}};
    }
    p.series = {rings[0], rings[1], line, std::move(s)};
    m.plots.push_back(std::move(p));
  }
  m.caption = fmt::format(
      "The path (grey) and the table's way on the last scored lap, its error magnified {:.0f} times. Dashed: "
      "{} µm to both "
      "sides of the path.",
      magnification, short_number(ring * kMicro));
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

std::vector<Plot> reversal_plots(const Block& block, const sim::CompareResult& result) {
  constexpr double kBefore = 0.4e-3;
  constexpr double kAfter = 2e-3;
  std::vector<Plot> plots;
  for (std::size_t axis = 0; axis < result.axes.size(); ++axis) {
    Plot p;
    p.title = fmt::format("Where {} reverses, at {}", result.axes[axis], block.text);
    p.x_label = "way along the path after the reversal [mm]";
    p.y_label = "contour error [µm]";
    p.width = 560;
    p.height = 360;
    p.x_range = Range{-kBefore * kMilli, kAfter * kMilli};
    for (const sim::CompareRow* r : block.rows) {
      const Trace& t = r->trace;
      // The last reversal with all of its two millimetres inside the scored part.
      std::size_t at = 0;
      const auto reach =
          static_cast<std::size_t>(std::ceil(kAfter / speed_of(*block.travel) / result.period)) + 1;
      for (std::size_t k = 1; k + reach < t.size(); ++k) {
        const bool turns = (t[k - 1].velocity[axis] < 0.0) != (t[k].velocity[axis] < 0.0);
        if (turns && t[k].scored && t[k + reach].scored) at = k;
      }
      if (at == 0) continue;
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
      }
      if (p.markers.empty()) {
        p.markers.push_back({0.0, result.axes[axis] + " reverses"});
        if (std::isfinite(window)) p.markers.push_back({window * kMilli, "0.15 mm of " + result.axes[axis]});
      }
      p.series.push_back(std::move(s));
    }
    if (!p.series.empty()) plots.push_back(std::move(p));
  }
  return plots;
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

std::vector<Plot> force_plots(const Block& block, const CompareReportInput& input) {
  const sim::CompareResult& result = input.result;
  const sim::CompareRow* row = richest(block);
  const sim::Travel& travel = *block.travel;
  const Lap lap = last_lap(row->trace, travel);
  std::vector<Plot> plots;
  for (std::size_t axis = 0; axis < result.axes.size(); ++axis) {
    const AxisEvidence* evidence = axis < input.axes.size() ? &input.axes[axis] : nullptr;
    const double mass = evidence != nullptr && evidence->knowledge
                            ? evidence->knowledge->model(row->controller.friction, result.axes[axis]).mass
                            : 0.0;
    const bool truth = evidence != nullptr && evidence->truth.has_value();
    Plot p;
    p.title = fmt::format("Axis {}, {} at {}", result.axes[axis], full_name(*row), block.text);
    p.x_label = angle_label(travel);
    p.y_label = "force [N]";
    const double from = first_angle(travel) * shown_scale(travel);
    p.x_range = Range{from, from + lap_of(travel) * shown_scale(travel)};
    if (travel.part() == nullptr) p.x_step = lap_of(travel) * kDegrees / 12.0;
    p.height = 300;
    Series force = line_of(block, row);
    force.label = mass > 0.0 ? "force of the controller, less mass times acceleration of the reference"
                             : "force of the controller";
    force.x = lap.angle;
    for (const auto* s : lap.samples) force.y.push_back(s->force[axis] - mass * s->acceleration[axis]);
    p.series.push_back(std::move(force));
    if (truth) {
      Series friction{
          .label = "true friction", .x = lap.angle, .color = "#000000", .width = 1.2, .dashed = true};
      for (const auto* s : lap.samples) friction.y.push_back(s->friction[axis]);
      Series difference{.label = "difference", .x = lap.angle, .color = "#cc79a7", .width = 0.9};
      for (std::size_t k = 0; k < lap.samples.size(); ++k)
        difference.y.push_back(p.series[0].y[k] - friction.y[k]);
      p.series.push_back(std::move(friction));
      p.series.push_back(std::move(difference));
    }
    plots.push_back(std::move(p));
  }
  return plots;
}

// ---- bars
// ---------------------------------------------------------------------------------------------------------

Plot bar_plot(const Block& block, std::string_view head, double sim::Metrics::*figure,
              double PrintedRow::*printed) {
  Plot p;
  p.title = fmt::format("{} of the contour error at {}", head, block.text);
  p.y_label = "contour error [µm]";
  p.width = 560;
  p.height = 300;
  Series print{.label = "printed in the thesis", .style = Style::kPoints, .color = "#000000", .width = 3.2};
  double top = 0.0;
  for (std::size_t k = 0; k < block.rows.size(); ++k) {
    const sim::CompareRow& r = *block.rows[k];
    const double at = static_cast<double>(k) + 1.0;
    const double value = r.mean.*figure * kMicro;
    const double spread = std::isfinite(r.spread.*figure) ? r.spread.*figure * kMicro : 0.0;
    Series bar{.x = {at},
               .y = {value},
               .style = Style::kBars,
               .color = controller_color(r.controller.id, k),
               .width = 0.62};
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
      print.y.push_back(row->*printed);
      top = std::fmax(top, row->*printed);
    }
  }
  p.y_range = Range{0.0, 1.14 * std::max(top, 1e-9)};
  for (std::size_t k = 0; k < block.rows.size(); ++k) {
    const sim::CompareRow& r = *block.rows[k];
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
  for (std::size_t i = 0; i < input.axes.size(); ++i) {
    const std::string axis = i < input.result.axes.size() ? input.result.axes[i] : std::to_string(i + 1);
    for (const auto& [kind, r] : input.axes[i].models) {
      for (const std::string& w : r.warnings)
        all.push_back(fmt::format("axis {}, {} model: {}", axis, r.model, w));
    }
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

template <NamedEnum E>
std::string_view name_of_enum(E wanted) {
  for (const auto& [value, name] : EnumNames<E>::names) {
    if (value == wanted) return name;
  }
  return "";
}

/// The control laws with their parameters, and which controllers have them.
std::vector<std::pair<std::string, std::string>> laws_in_words(const sim::CompareSpec& spec) {
  std::vector<std::pair<std::string, std::string>> all;
  for (const sim::ControllerSpec& c : spec.controllers) {
    std::string words = law_in_words(c.law);
    if (c.observer == control::Observer::kDisturbance)
      words += fmt::format("; observer poles {} 1/s", short_number(c.observer_pole));
    if (c.observer == control::Observer::kAdaptive) {
      std::vector<std::string> gains;
      for (const double k : c.adaptive_gain) gains.push_back(short_number(k));
      words += fmt::format("; adaptive friction {} 1/s", joined(gains, ", "));
    }
    const auto same = std::find_if(all.begin(), all.end(), [&](const auto& a) { return a.first == words; });
    if (same == all.end()) {
      all.emplace_back(words, "(" + c.id + ")");
    } else {
      same->second += " (" + c.id + ")";
    }
  }
  return all;
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
    if (first.axes() > 2) add("frame", std::string(name_of_enum(first.frame)));
  }
  add("speeds", listed(paces));
  add("control period", short_number(input.result.period * kMilli) + " ms");
  for (const auto& [words, ids] : laws_in_words(spec)) add("law of " + ids, words);
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
  if (!input.command.empty()) {
    page.paragraph("This page is made again by:");
    page.code(input.command);
  }
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

  for (const Block& b : blocks) page.lead(summary(b, result.spec.trials));
  page.warnings(all_warnings(input));

  page.section("Figures");
  bool printed = false;
  for (const Block& b : blocks) {
    page.table(controllers_table(b, result));
    if (const std::string text = against_print(b); !text.empty()) page.paragraph(text);
    printed = printed || b.printed != nullptr;
  }
  page.remark(
      "Mean over the trials ± standard deviation between them; bold: the smallest. max: largest |ε|. glitch: "
      "largest |ε| within "
      "the first 0.15 mm that an axis travels after it reversed. ε: contour error; e: tracking error of an "
      "axis; mean |Δu|: "
      "variation of the control input from period to period, which shows chattering; quadrant ratio: mean of "
      "the quadrants' "
      "largest |ε| over that of windows as long elsewhere; at 1 there is no quadrant to be seen.");
  if (printed) {
    page.remark(
        "print: averages of 10 trials on the hardware of the thesis, with the ratio result to print. The "
        "printed SD is above the "
        "printed RMS in 11 of 12 rows, which one signal cannot have; it is shown, not compared.");
  }
  for (const Block& b : blocks) {
    page.figures({bar_plot(b, "Maximum", &sim::Metrics::max_contour_error, &PrintedRow::max_contour_error_um),
                  bar_plot(b, "RMS", &sim::Metrics::rms, &PrintedRow::rms_um)},
                 2, "");
  }

  bool plane = false;
  for (const Block& b : blocks) {
    if (plane_curve(*b.travel) == nullptr) continue;
    if (!plane) page.section("Contour, error magnified");
    plane = true;
    page.subsection(b.text);
    const Magnified m = contour_plots(b, *plane_curve(*b.travel));
    page.figures(m.plots, 3, m.caption);
  }

  if (const Table drift = drift_table(result); !drift.rows.empty()) {
    page.section("Change since identification");
    page.table(drift);
    page.remark(
        "What on-line adaptation believes at the end of the first trial, as shares of the identified model, "
        "± standard "
        "deviation. Delay: by how much more than assumed the force acts late.");
  }
  page.section("Contour error along the path");
  for (const Block& b : blocks) {
    page.figures(
        angle_plots(b, result), 1,
        "Last scored lap of the first trial" +
            std::string(result.axes.size() == 2   ? "; positive to the left of the direction of travel"
                        : result.axes.size() == 1 ? "; the tracking error, as there is one axis"
                                                  : "; a distance, without a sign") +
            ". All drawings have the same scale. Vertical lines: an axis reverses, a quadrant begins.");
  }
  page.section("Contour error over time");
  for (const Block& b : blocks)
    page.figures(time_plots(b), 1, "The whole run of the first trial, from rest to rest.");

  page.section("One quadrant, close up");
  for (const Block& b : blocks) {
    page.figures(reversal_plots(b, result), 2,
                 "The last reversal of each axis in the first trial. The second vertical line ends the "
                 "window of the quadrant glitch.");
  }

  double speed = 0.0;
  for (const sim::Travel& t : result.spec.travels) speed = std::max(speed, speed_of(t));
  bool mapped = false;
  for (std::size_t i = 0; i < std::min(input.axes.size(), result.axes.size()); ++i) {
    const FrictionMap map = map_of(input.axes[i], result.axes[i], speed);
    if (map.fit == nullptr && !map.model && !map.conventional && !map.truth) continue;
    if (!mapped) page.section("Friction");
    mapped = true;
    page.figures(friction_plots(map), 2,
                 map.truth ? "What the compensators know of the axis, beside the true friction of the "
                             "virtual machine, which no "
                             "controller may see."
                           : "What the compensators know of the axis.");
  }

  if (!blocks.empty()) {
    page.section("Forces");
    const bool truth = std::any_of(input.axes.begin(), input.axes.end(),
                                   [](const AxisEvidence& e) { return e.truth.has_value(); });
    for (const Block& b : blocks) {
      page.figures(force_plots(b, input), 1,
                   truth ? "Last scored lap of the first trial. Where controller and true friction part, the "
                           "contour shows it."
                         : "Last scored lap of the first trial.");
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
