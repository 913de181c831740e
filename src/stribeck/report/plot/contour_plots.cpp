#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/numbers.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/plot/contour_plots.hpp>
#include <stribeck/report/text.hpp>
#include <utility>
#include <variant>

namespace stribeck::report {
namespace {

constexpr double kRoom = 1.08;        ///< height of a scale relative to the largest error
constexpr double kSameScale = 0.25;   ///< as a share of the largest error of a group
constexpr std::size_t kTogether = 3;  ///< controllers in a drawing

/// Largest |ε| [m]; zero without a trace.
double largest(const Rows& rows, bool scored_only) {
  double m = 0.0;
  for (const sim::CompareRow* r : rows) {
    for (const sim::ContourSample& s : r->trace) {
      if (!scored_only || s.scored) m = std::fmax(m, std::abs(s.contour_error));
    }
  }
  return m;
}

/// Half the height of each group's drawings [µm].
std::vector<double> limits_of(const std::vector<ScaleGroup>& groups, bool scored_only) {
  std::vector<double> limits;
  for (const ScaleGroup& g : groups) {
    const double m = largest(g.rows, scored_only);
    limits.push_back(kRoom * (m > 0.0 ? m * kMicro : 1.0));
  }
  return limits;
}

bool has_sign(const sim::CompareResult& result) { return result.axes.size() <= 2; }

/// Splits controllers into drawings of three.
std::vector<Rows> in_threes(const Rows& rows) {
  std::vector<Rows> all;
  for (std::size_t i = 0; i < rows.size(); i += kTogether) {
    all.emplace_back(rows.begin() + static_cast<std::ptrdiff_t>(i),
                     rows.begin() + static_cast<std::ptrdiff_t>(std::min(rows.size(), i + kTogether)));
  }
  return all;
}

std::vector<Marker> reversals(const Lap& lap, const std::vector<std::string>& axes) {
  std::vector<Marker> markers;
  for (std::size_t k = 1; k < lap.samples.size(); ++k) {
    if (lap.samples[k - 1] == nullptr || lap.samples[k] == nullptr) continue;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const double before = lap.samples[k - 1]->velocity[i];
      const double after = lap.samples[k]->velocity[i];
      if ((before < 0.0) == (after < 0.0)) continue;
      if (!markers.empty() && markers.back().x == lap.angle[k]) {
        // Axes that reverse together get one line.
        std::string& label = markers.back().label;
        label = label.substr(0, label.rfind(' ')) + ", " + axes[i] + " reverse";
      } else {
        markers.push_back({lap.angle[k], axes[i] + " reverses"});
      }
    }
  }
  // Where there are many of them, only the axis is named.
  if (markers.size() > 6) {
    for (Marker& m : markers) m.label = m.label.substr(0, m.label.rfind(' '));
  }
  return markers;
}

/// The text with a capital first letter.
std::string capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

/// The drawings of all groups; fill(plot, row, series) adds the points of one controller.
template <class Fill>
ScaledPlots traces(const sim::CompareResult& result, std::size_t travel, const TraceLook& look,
                   bool scored_only, std::string_view what, const Plot& frame, Fill&& fill) {
  const Rows rows = rows_of(result, travel);
  const std::vector<ScaleGroup> groups = scale_groups(rows);
  const std::vector<double> limits = limits_of(groups, scored_only);
  const std::string pace = result.spec.travels.at(travel).pace_in_words();
  ScaledPlots all;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    for (const Rows& together : in_threes(groups[k].rows)) {
      Plot p = frame;
      p.title = fmt::format("{} at {}{}: {}{}", capital(error_name(result)), pace, what,
                            names_of(together, rows), finer(limits, k));
      p.y_label = error_name(result) + " [µm]";
      p.y_range = Range{has_sign(result) ? -limits[k] : 0.0, limits[k]};
      p.width = look.width;
      p.height = look.height;
      p.detail = look.detail;
      for (const sim::CompareRow* r : together) {
        Series s;
        s.label = look.full_names ? full_name(*r) : name_of(*r);
        s.color = color_of(*r, rows);
        s.width = 1.2;
        fill(p, *r, s);
        p.series.push_back(std::move(s));
      }
      all.plots.push_back(std::move(p));
    }
  }
  all.scales = scales_in_words(groups, rows, limits, has_sign(result), all.plots.size());
  return all;
}

}  // namespace

std::string name_of(const sim::CompareRow& row) { return "(" + row.controller.id + ")"; }
std::string full_name(const sim::CompareRow& row) { return name_of(row) + " " + row.controller.label; }

std::string names_of(const Rows& some, const Rows& all) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < some.size();) {
    // As many as stand behind one another in all rows.
    auto at = std::find(all.begin(), all.end(), some[k]);
    std::size_t last = k;
    while (last + 1 < some.size() && at != all.end() && at + 1 != all.end() && some[last + 1] == *(at + 1))
      ++last, ++at;
    if (last > k + 1) {
      names.push_back(name_of(*some[k]) + " to " + name_of(*some[last]));
      k = last + 1;
    } else {
      names.push_back(name_of(*some[k++]));
    }
  }
  return listed(names);
}

Rows rows_of(const sim::CompareResult& result, std::size_t travel) {
  Rows rows;
  for (const sim::CompareRow& r : result.rows) {
    if (r.travel == travel) rows.push_back(&r);
  }
  return rows;
}

std::string error_name(const sim::CompareResult& result) {
  return result.axes.size() == 1 ? "tracking error" : "contour error";
}

std::string color_of(const sim::CompareRow& row, const Rows& all) {
  return controller_color(row.controller.id,
                          static_cast<std::size_t>(std::find(all.begin(), all.end(), &row) - all.begin()));
}

std::vector<ScaleGroup> scale_groups(const Rows& rows) {
  std::vector<std::pair<double, const sim::CompareRow*>> by_size;
  for (const sim::CompareRow* r : rows) {
    if (r->refused.empty()) by_size.emplace_back(largest({r}, true), r);
  }
  std::stable_sort(by_size.begin(), by_size.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<ScaleGroup> groups;
  for (const auto& [size, row] : by_size) {
    // A controller without a trace is listed with the last group: it has no error on any scale.
    if (groups.empty() || (size > 0.0 && size < kSameScale * groups.back().largest))
      groups.push_back({{}, size});
    groups.back().rows.push_back(row);
  }
  for (ScaleGroup& g : groups) {
    std::sort(g.rows.begin(), g.rows.end(), [&](const auto* a, const auto* b) {
      return std::find(rows.begin(), rows.end(), a) < std::find(rows.begin(), rows.end(), b);
    });
  }
  return groups;
}

std::vector<Rows> finer_rows(const Rows& rows) {
  std::vector<Rows> all;
  Rows left = rows;
  const std::vector<ScaleGroup> groups = scale_groups(rows);
  for (std::size_t k = 0; k + 1 < groups.size(); ++k) {
    std::erase_if(left, [&](const sim::CompareRow* r) {
      return std::find(groups[k].rows.begin(), groups[k].rows.end(), r) != groups[k].rows.end();
    });
    all.push_back(left);
  }
  return all;
}

std::string finer(const std::vector<double>& limits, std::size_t group) {
  return group == 0 ? std::string()
                    : fmt::format(", scale {} times finer", significant(limits[0] / limits[group], 2));
}

std::string scales_in_words(const std::vector<ScaleGroup>& groups, const Rows& all,
                            const std::vector<double>& limits, bool signed_error, std::size_t drawings) {
  if (drawings < 2) return {};
  if (groups.size() == 1) return "All drawings have the same scale.";
  std::vector<std::string> parts;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    parts.push_back(fmt::format(
        "{}{}\u00A0µm for {}{}", signed_error ? "±" : "0 to ", significant(limits[k], 2),
        names_of(groups[k].rows, all),
        k == 0 ? std::string() : fmt::format(" ({} times finer)", significant(limits[0] / limits[k], 2))));
  }
  return "Scales differ: " + joined(parts, "; ") + ".";
}

double lap_of(const sim::Travel& travel) {
  return std::visit([](const auto& path) { return path.period(); }, travel.path);
}

double first_angle(const sim::Travel& travel) {
  return travel.part() != nullptr ? 0.0 : -lap_of(travel) / 12.0;
}

double shown_scale(const sim::Travel& travel) { return travel.part() != nullptr ? kMilli : kDegrees; }

bool is_circle(const path::Fourier<2>& path) {
  const auto& [x, y] = path.axis;
  if (x.terms.size() != 1 || y.terms.size() != 1) return false;
  const path::Harmonic& a = x.terms[0];
  const path::Harmonic& b = y.terms[0];
  // cos φ and cos(φ − 90°): φ is the angle.
  return a.amplitude == b.amplitude && a.order == 1.0 && b.order == 1.0 && a.phase == 0.0 &&
         std::abs(b.phase + 0.5 * kPi) < 1e-12;
}

std::string angle_label(const sim::Travel& travel) {
  if (travel.part() != nullptr) return "place φ on the path [mm]";
  const auto* curve = std::get_if<path::Curve>(&travel.path);
  const auto* sum = std::get_if<path::Fourier<2>>(&travel.path);
  const bool circle =
      curve != nullptr ? curve->shape == path::Shape::kCircle : sum != nullptr && is_circle(*sum);
  return circle ? "angle φ of the reference [°]" : "parameter φ of the path [°]";
}

Lap last_lap(const std::vector<sim::ContourSample>& trace, const sim::Travel& travel) {
  Lap lap;
  const auto last =
      std::find_if(trace.rbegin(), trace.rend(), [](const sim::ContourSample& s) { return s.scored; });
  if (last == trace.rend()) return lap;
  const double period = lap_of(travel);
  const double from = last->phi - period;
  std::vector<std::pair<double, const sim::ContourSample*>> all;
  double longest = 0.0;  // largest step of φ between samples
  for (const sim::ContourSample& s : trace) {
    if (!s.scored || s.phi <= from || s.phi > last->phi) continue;
    if (&s != &trace.front()) longest = std::fmax(longest, s.phi - (&s - 1)->phi);
    const double turns = (s.phi - first_angle(travel)) / period;
    const double whole = travel.part() != nullptr ? 0.0 : std::floor(turns);
    all.emplace_back((turns - whole) * period + first_angle(travel), &s);
  }
  const double duration = all.empty() ? 0.0 : all.back().second->time - all.front().second->time;
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t k = 0; k < all.size(); ++k) {
    // Less than a lap was scored: the rest is a gap, not a line. Neither is there one from the end of the lap to its beginning.
    const bool seam = k > 0 && all[k].second->time - all[k - 1].second->time < -0.5 * duration;
    if (k > 0 && (seam || all[k].first - all[k - 1].first > 3.0 * longest)) {
      lap.angle.push_back(kNaN);
      lap.samples.push_back(nullptr);
    }
    lap.angle.push_back(all[k].first * shown_scale(travel));
    lap.samples.push_back(all[k].second);
  }
  return lap;
}

ScaledPlots path_plots(const sim::CompareResult& result, std::size_t travel, const TraceLook& look) {
  const sim::Travel& t = result.spec.travels.at(travel);
  Plot frame;
  frame.x_label = angle_label(t);
  const double from = first_angle(t) * shown_scale(t);
  frame.x_range = Range{from, from + lap_of(t) * shown_scale(t)};
  if (t.part() == nullptr) frame.x_step = lap_of(t) * kDegrees / 12.0;
  return traces(result, travel, look, true, "", frame, [&](Plot& p, const sim::CompareRow& r, Series& s) {
    const Lap lap = last_lap(r.trace, t);
    if (p.markers.empty()) p.markers = reversals(lap, result.axes);
    s.x = lap.angle;
    for (const auto* sample : lap.samples)
      s.y.push_back(sample == nullptr ? kNaN : sample->contour_error * kMicro);
  });
}

ScaledPlots time_plots(const sim::CompareResult& result, std::size_t travel, const TraceLook& look) {
  Plot frame;
  frame.x_label = "time [s]";
  return traces(result, travel, look, look.scored_only, " over time", frame,
                [&](Plot& p, const sim::CompareRow& r, Series& s) {
                  for (const sim::ContourSample& sample : r.trace) {
                    if (look.scored_only && !sample.scored) continue;
                    s.x.push_back(sample.time);
                    s.y.push_back(sample.contour_error * kMicro);
                  }
                  if (look.scored_only || !p.markers.empty()) return;
                  const auto scored = [](const sim::ContourSample& x) { return x.scored; };
                  const auto first = std::find_if(r.trace.begin(), r.trace.end(), scored);
                  const auto last = std::find_if(r.trace.rbegin(), r.trace.rend(), scored);
                  if (first != r.trace.end()) p.markers = {{first->time, "scored from"}, {last->time, "to"}};
                });
}

}  // namespace stribeck::report
