#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/core/numbers.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/pages/verify_parts.hpp>
#include <stribeck/report/plot/force_plot.hpp>
#include <stribeck/report/plot/time_axis.hpp>
#include <stribeck/report/shown_units.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

constexpr std::size_t kShownParts = 4;  ///< parts with drawings; a log may consist of hundreds
constexpr std::size_t kShownReversals = 4;

// ---- drawings -------------------------------------------------------------------------------------------

/// Rows from first to last of a column, with a gap before each row in `starts`.
Series over_time(std::string label, const VerifiedPart& part, const std::vector<double>& column, double scale,
                 std::string_view color, double width, std::size_t first, std::size_t last,
                 const std::vector<std::size_t>& starts = {}) {
  Series s;
  s.label = std::move(label);
  s.color = std::string(color);
  s.width = width;
  const double origin = time_axis(part.record.t).origin;
  for (std::size_t k = first; k < last; ++k) {
    if (k > first && std::binary_search(starts.begin(), starts.end(), k)) {
      s.x.push_back(part.record.t[k] - origin);
      s.y.push_back(kNaN);
    }
    s.x.push_back(part.record.t[k] - origin);
    s.y.push_back(column[k] * scale);
  }
  return s;
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> d(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) d[k] = a[k] - b[k];
  return d;
}

Plot time_plot(const VerifiedPart& part, std::string title, std::string y_label, int width, int height) {
  Plot p;
  p.title = std::move(title);
  p.x_label = time_axis(part.record.t).label;
  p.y_label = std::move(y_label);
  p.width = width;
  p.height = height;
  return p;
}

/// Measured and modelled force over time, after the low-pass of the score, one drawing per model.
std::vector<Plot> force_plots(const VerifiedPart& part) {
  const ShownUnits units = units_of(part);
  std::vector<Plot> plots;
  for (std::size_t i = 0; i < part.models.size(); ++i) {
    const ident::replay::ForceError& e = part.models[i].force;
    if (e.modelled.empty()) continue;
    ForceOverTime force{part.record.source, {}, e.measured, e.modelled};
    for (const std::size_t row : e.row) force.t.push_back(part.record.t[row]);
    plots.push_back(force_plot(force, part.models[i].name + ": force", units.force, model_color(0)));
  }
  return plots;
}

/// Measured and predicted velocity: one drawing per model, all on one scale.
std::vector<Plot> velocity_plots(const VerifiedPart& part) {
  const ShownUnits units = units_of(part);
  const std::size_t n = part.record.x.size();
  double most = 0.0;
  for (const VerifiedModel& m : part.models) {
    for (const auto* v : {&m.open.measured_velocity, &m.open.restarted.v}) {
      for (const double s : *v) most = std::fmax(most, std::abs(s));
    }
  }
  std::vector<Plot> plots;
  for (std::size_t i = 0; i < part.models.size(); ++i) {
    const VerifiedModel& m = part.models[i];
    Plot p = time_plot(part, m.name + ": velocity under the measured force",
                       "velocity [" + units.velocity + "]", 920, 270);
    if (most > 0.0) {
      const double border = 1.15 * most * units.per_velocity;
      p.y_range = Range{-border, border};
    }
    p.series.push_back(
        over_time("measured", part, m.open.measured_velocity, units.per_velocity, kMeasuredColor, 4.0, 0, n));
    p.series.push_back(over_time("predicted, started anew at each reversal", part, m.open.restarted.v,
                                 units.per_velocity, model_color(0), 1.4, 0, n, m.open.starts));
    Series free = over_time("predicted from the first row on", part, m.open.free.v, units.per_velocity,
                            "#e69f00", 1.1, 0, n);
    free.dashed = true;
    p.series.push_back(std::move(free));
    plots.push_back(std::move(p));
  }
  return plots;
}

/// A few reversals spread over the record, as rows around them.
struct Window {
  std::size_t first = 0;
  std::size_t at = 0;
  std::size_t last = 0;
};

std::vector<Window> reversal_windows(const VerifiedPart& part) {
  if (part.models.empty()) return {};
  const std::vector<std::size_t>& turns = part.models.front().open.reversals;
  const std::size_t n = part.record.x.size();
  if (turns.empty()) return {};
  std::vector<std::size_t> lengths{turns.front()};
  for (std::size_t i = 1; i < turns.size(); ++i) lengths.push_back(turns[i] - turns[i - 1]);
  std::nth_element(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2),
                   lengths.end());
  const std::size_t half = std::max<std::size_t>(10, lengths[lengths.size() / 2] / 14);
  const std::size_t shown = std::min(kShownReversals, turns.size());
  std::vector<Window> windows;
  for (std::size_t i = 0; i < shown; ++i) {
    // Taken from the middle of equal shares, so that they are not all at the beginning or at the end.
    const std::size_t at = turns[(2 * i + 1) * turns.size() / (2 * shown)];
    windows.push_back({at > half ? at - half : 0, at, std::min(n, at + half)});
  }
  return windows;
}

std::vector<Plot> reversal_plots(const VerifiedPart& part, bool force) {
  const ShownUnits units = units_of(part);
  std::vector<Plot> plots;
  for (const Window& w : reversal_windows(part)) {
    const double at = part.record.t[w.at] - time_axis(part.record.t).origin;
    Plot p = time_plot(part, fmt::format("Reversal at {} s", significant(at, 4)),
                       force ? "force [" + units.force + "]" : "velocity [" + units.velocity + "]", 560, 300);
    p.markers.push_back({at, ""});
    p.series.push_back(over_time("measured", part,
                                 force ? part.record.f : part.models.front().open.measured_velocity,
                                 force ? 1.0 : units.per_velocity, kMeasuredColor, 4.0, w.first, w.last));
    for (std::size_t i = 0; i < part.models.size(); ++i) {
      const VerifiedModel& m = part.models[i];
      if (force && !m.closed) continue;
      p.series.push_back(over_time(m.name, part, force ? m.closed->f : m.open.restarted.v,
                                   force ? 1.0 : units.per_velocity, model_color(i), 1.5, w.first, w.last,
                                   force ? std::vector<std::size_t>{} : m.open.starts));
    }
    plots.push_back(std::move(p));
  }
  return plots;
}

std::vector<Plot> open_error_plots(const VerifiedPart& part) {
  const ShownUnits units = units_of(part);
  const std::size_t n = part.record.x.size();
  Plot velocity = time_plot(part, "Error of the velocity, started anew at each reversal",
                            "predicted less measured [" + units.velocity + "]", 560, 300);
  Plot position = time_plot(part, "Drift from the first row on",
                            "predicted less measured [" + units.position + "]", 560, 300);
  for (std::size_t i = 0; i < part.models.size(); ++i) {
    const VerifiedModel& m = part.models[i];
    velocity.series.push_back(over_time(m.name, part,
                                        difference(m.open.restarted.v, m.open.measured_velocity),
                                        units.per_velocity, model_color(i), 1.2, 0, n, m.open.starts));
    position.series.push_back(over_time(m.name, part, difference(m.open.free.x, part.record.x),
                                        units.per_position, model_color(i), 1.4, 0, n));
  }
  return {std::move(velocity), std::move(position)};
}

std::vector<Plot> closed_error_plots(const VerifiedPart& part) {
  const ShownUnits units = units_of(part);
  const std::size_t n = part.record.x.size();
  Plot force =
      time_plot(part, "Error of the force", "predicted less measured [" + units.force + "]", 560, 300);
  Plot position =
      time_plot(part, "Error of the position", "predicted less measured [" + units.fine + "]", 560, 300);
  for (std::size_t i = 0; i < part.models.size(); ++i) {
    const VerifiedModel& m = part.models[i];
    if (!m.closed) continue;
    force.series.push_back(
        over_time(m.name, part, difference(m.closed->f, part.record.f), 1.0, model_color(i), 1.0, 0, n));
    position.series.push_back(over_time(m.name, part, difference(m.closed->x, part.record.x), units.per_fine,
                                        model_color(i), 1.0, 0, n));
  }
  return {std::move(force), std::move(position)};
}

}  // namespace

namespace {

Page verify_report_page(const VerifyReportInput& given) {
  const VerifyReportInput input = with_short_names(given);
  std::vector<std::string> about;
  if (!input.source.empty()) about.push_back("on " + input.source);
  if (!input.version.empty()) about.push_back("stribeck " + input.version);
  Page page(
      input.axis.empty() ? "Models verified on a log" : "Models of axis " + input.axis + " verified on a log",
      joined(about, " · "));
  for (const Verdict& v : verdicts(input)) page.lead(sentence(v, input));
  std::vector<KeyNumber> numbers;
  for (const Verdict& v : verdicts(input)) {
    if (numbers.size() < 3)
      numbers.push_back({fmt::format("error of the {} of {}", v.of_force ? "force" : "velocity", v.name),
                         decimals(100.0 * v.error, 2), "%"});
  }
  page.numbers(numbers);
  for (const VerifiedPart& part : input.parts) page.paragraph(summary(part));
  page.warnings(input.warnings);
  for (std::size_t i = 0; i < input.parts.size(); ++i) {
    const VerifiedPart& part = input.parts[i];
    if (part.models.empty()) continue;
    page.section(input.parts.size() > 1 ? "Errors, " + part_name(input, i) : "Errors");
    page.table(score_table(part));
    page.remark(
        "%: RMS of the error as a share of the RMS of the measured signal. Bold: the smallest. Force: under the measured "
        "motion; protocol: as the EMPS benchmark pairs the rows; as filed: the force aligned with its motion; phases: those "
        "of periodic terms taken from the log. Stroke: open loop, started anew at each reversal. Free run: the model runs "
        "from the first row without a restart, so errors of the force add up; ±: 95 % range of the drift that the error of the "
        "force explains. Loop: closed loop.");
    if (i >= kShownParts) continue;
    if (const std::vector<Plot> plots = force_plots(part); !plots.empty()) {
      page.section("Force under the measured motion");
      const ident::replay::ForceError& e = part.models.front().force;
      page.figures(plots, 1,
                   fmt::format("Through a low-pass of {} Hz and decimated to {} Hz.",
                               significant(e.cut_off, 3), significant(e.band, 3)));
    }
    page.section("Open loop: velocity under the measured force");
    page.figures(
        velocity_plots(part), 1,
        "These figures are meaningful only if the log was not used to identify the models. Every error of the modelled force is "
        "integrated: from the first row on without end, else since the last reversal.");
    page.figures(open_error_plots(part), 2, "");
    page.figures(reversal_plots(part, false), 2,
                 "Reversals close up, all models. The prediction starts anew at the vertical line.");
    if (!has_closed(part)) continue;
    page.section("Closed loop: the model behind the controller");
    page.figures(
        closed_error_plots(part), 2,
        "The controller follows the reference of the log; force and position of the model stand beside the "
        "measured ones row by row.");
    page.figures(reversal_plots(part, true), 2, "Force at the same reversals.");
  }
  if (input.parts.size() > kShownParts)
    page.remark(fmt::format("Drawings of the first {} of {} parts.", kShownParts, input.parts.size()));
  page.made({input.command, input.version, input.inputs});
  return page;
}

}  // namespace

std::string verify_report(const VerifyReportInput& input) { return verify_report_page(input).html(); }

void write_verify_report(const PageFolders& folders, const VerifyReportInput& input) {
  write_page(verify_report_page(input), folders);
}

}  // namespace stribeck::report
