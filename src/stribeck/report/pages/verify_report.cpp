#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/columns.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/pages/verify_report.hpp>
#include <stribeck/report/shown_units.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

using io::Json;
using io::number_or_null;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::string_view kMeasuredColor = "#9aa0a6";
constexpr std::size_t kShownParts = 4;  ///< parts with drawings; a log may consist of hundreds
constexpr std::size_t kShownReversals = 4;

std::string model_color(std::size_t i) {
  constexpr std::array<std::string_view, 6> kColors{"#0072b2", "#d55e00", "#009e73",
                                                    "#cc79a7", "#e69f00", "#56b4e9"};
  return std::string(kColors[i % kColors.size()]);
}

ShownUnits units_of(const VerifiedPart& part) { return {part.record.force_unit, part.record.position_unit}; }

bool has_closed(const VerifiedPart& part) {
  return std::any_of(part.models.begin(), part.models.end(),
                     [](const VerifiedModel& m) { return m.closed.has_value(); });
}

/// Names of the models without their common folder: they differ at the end.
VerifyReportInput with_short_names(VerifyReportInput input) {
  for (VerifiedPart& part : input.parts) {
    if (part.models.empty()) continue;
    std::string common = part.models.front().name;
    for (const VerifiedModel& m : part.models) {
      const auto differ = std::mismatch(common.begin(), common.end(), m.name.begin(), m.name.end()).first;
      common.erase(differ, common.end());
    }
    const auto folder = common.rfind('/');
    if (folder == std::string::npos) continue;
    for (VerifiedModel& m : part.models) m.name.erase(0, folder + 1);
  }
  return input;
}

std::string percent(double share) { return std::isfinite(share) ? decimals(100.0 * share, 2) : "–"; }

std::string part_name(const VerifyReportInput& input, std::size_t i) {
  const std::vector<double>& t = input.parts[i].record.t;
  if (t.empty()) return fmt::format("part {}", i + 1);
  return fmt::format("part {} of {}, {} s to {} s", i + 1, input.parts.size(), significant(t.front(), 4),
                     significant(t.back(), 4));
}

// ---- drawings -------------------------------------------------------------------------------------------

/// Rows from first to last of a column, with a gap before each row in `starts`.
Series over_time(std::string label, const VerifiedPart& part, const std::vector<double>& column, double scale,
                 std::string_view color, double width, std::size_t first, std::size_t last,
                 const std::vector<std::size_t>& starts = {}) {
  Series s;
  s.label = std::move(label);
  s.color = std::string(color);
  s.width = width;
  for (std::size_t k = first; k < last; ++k) {
    if (k > first && std::binary_search(starts.begin(), starts.end(), k)) {
      s.x.push_back(part.record.t[k]);
      s.y.push_back(kNaN);
    }
    s.x.push_back(part.record.t[k]);
    s.y.push_back(column[k] * scale);
  }
  return s;
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> d(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) d[k] = a[k] - b[k];
  return d;
}

Plot time_plot(std::string title, std::string y_label, int width, int height) {
  Plot p;
  p.title = std::move(title);
  p.x_label = "time [s]";
  p.y_label = std::move(y_label);
  p.width = width;
  p.height = height;
  return p;
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
    Plot p = time_plot(m.name + ": velocity under the measured force", "velocity [" + units.velocity + "]",
                       920, 270);
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
  const std::vector<std::size_t>& starts = part.models.front().open.starts;
  const std::size_t n = part.record.x.size();
  if (starts.size() < 2) return {};
  std::vector<std::size_t> lengths;
  for (std::size_t i = 1; i < starts.size(); ++i) lengths.push_back(starts[i] - starts[i - 1]);
  std::nth_element(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2),
                   lengths.end());
  const std::size_t half = std::max<std::size_t>(10, lengths[lengths.size() / 2] / 14);
  const std::size_t shown = std::min(kShownReversals, starts.size() - 1);
  std::vector<Window> windows;
  for (std::size_t i = 0; i < shown; ++i) {
    // Taken from the middle of equal shares, so that they are not all at the beginning or at the end.
    const std::size_t at = starts[1 + (2 * i + 1) * (starts.size() - 1) / (2 * shown)];
    windows.push_back({at > half ? at - half : 0, at, std::min(n, at + half)});
  }
  return windows;
}

std::vector<Plot> reversal_plots(const VerifiedPart& part, bool force) {
  const ShownUnits units = units_of(part);
  std::vector<Plot> plots;
  for (const Window& w : reversal_windows(part)) {
    Plot p = time_plot(fmt::format("Reversal at {} s", significant(part.record.t[w.at], 4)),
                       force ? "force [" + units.force + "]" : "velocity [" + units.velocity + "]", 560, 300);
    p.markers.push_back({part.record.t[w.at], ""});
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
  Plot velocity = time_plot("Error of the velocity, started anew at each reversal",
                            "predicted less measured [" + units.velocity + "]", 560, 300);
  Plot position =
      time_plot("Drift from the first row on", "predicted less measured [" + units.position + "]", 560, 300);
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
  Plot force = time_plot("Error of the force", "predicted less measured [" + units.force + "]", 560, 300);
  Plot position =
      time_plot("Error of the position", "predicted less measured [" + units.fine + "]", 560, 300);
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

// ---- words and numbers ----------------------------------------------------------------------------------

Table score_table(const VerifiedPart& part) {
  const ShownUnits u = units_of(part);
  Table t{"",
          {{"model", "", false},
           {"velocity, anew at each reversal", u.velocity + " RMS"},
           {"", "%"},
           {"position", u.fine + " RMS"},
           {"velocity, from the first row on", u.velocity + " RMS"},
           {"", "%"},
           {"largest drift", u.position}},
          {}};
  const bool closed = has_closed(part);
  if (closed) {
    t.columns.push_back({"closed loop: force", u.force + " RMS"});
    t.columns.push_back({"", "%"});
    t.columns.push_back({"position", u.fine + " RMS"});
  }
  const auto best = [&](auto&& figure) {
    double least = std::numeric_limits<double>::infinity();
    for (const VerifiedModel& m : part.models) least = std::fmin(least, figure(m));
    return part.models.size() > 1 ? least : kNaN;
  };
  const auto restarted = [](const VerifiedModel& m) { return m.open.restarted.velocity_relative; };
  const auto free = [](const VerifiedModel& m) { return m.open.free.velocity_relative; };
  const auto force = [](const VerifiedModel& m) { return m.closed ? m.closed->force_relative : kNaN; };
  for (std::size_t i = 0; i < part.models.size(); ++i) {
    const VerifiedModel& m = part.models[i];
    const ident::replay::Replay& a = m.open.restarted;
    const ident::replay::Replay& b = m.open.free;
    std::vector<Cell> row{{m.name, "", "", false, model_color(i)},
                          {significant(a.velocity_rms * u.per_velocity, 3)},
                          {percent(a.velocity_relative), "", "", restarted(m) == best(restarted)},
                          {significant(a.position_rms * u.per_fine, 3)},
                          {significant(b.velocity_rms * u.per_velocity, 3)},
                          {percent(b.velocity_relative), "", "", free(m) == best(free)},
                          {significant(b.position_most * u.per_position, 3)}};
    if (closed) {
      const ident::replay::Replay none;
      const ident::replay::Replay& c = m.closed ? *m.closed : none;
      row.push_back({significant(c.force_rms, 3)});
      row.push_back({percent(c.force_relative), "", "", force(m) == best(force)});
      row.push_back({significant(c.position_rms * u.per_fine, 3)});
    }
    t.rows.push_back(std::move(row));
  }
  return t;
}

std::string summary(const VerifiedPart& part) {
  const VerifiedModel* open = nullptr;
  const VerifiedModel* closed = nullptr;
  for (const VerifiedModel& m : part.models) {
    if (open == nullptr || m.open.restarted.velocity_relative < open->open.restarted.velocity_relative)
      open = &m;
    if (m.closed && (closed == nullptr || m.closed->force_relative < closed->closed->force_relative))
      closed = &m;
  }
  if (open == nullptr) return "No model was given.";
  const ShownUnits u = units_of(part);
  std::string text = fmt::format(
      "Driven by the measured force and started anew at each of {} reversals, {} predicts the velocity to "
      "{} % ({} {} RMS)",
      open->open.starts.size() - 1, open->name, percent(open->open.restarted.velocity_relative),
      significant(open->open.restarted.velocity_rms * u.per_velocity, 3), u.velocity);
  if (part.models.size() > 1) text += ", the best of " + std::to_string(part.models.size()) + " models";
  text += ".";
  if (closed != nullptr) {
    text += fmt::format(" In its closed loop {} predicts the force to {} % and the position to {} {} RMS.",
                        closed->name, percent(closed->closed->force_relative),
                        significant(closed->closed->position_rms * u.per_fine, 3), u.fine);
  }
  return text;
}

Json replay_json(const ident::replay::Replay& r, const ShownUnits& u, bool force) {
  Json out;
  const auto put = [&](const std::string& name, const std::string& unit, bool holds, double value,
                       double scale) {
    out[name + "_" + unit] = holds ? number_or_null(value * scale) : Json(nullptr);
    if (!holds) out[name] = number_or_null(value);
  };
  if (force) {
    put("force_rms", "N", u.force == "N", r.force_rms, 1.0);
    out["force_relative_percent"] = number_or_null(100.0 * r.force_relative);
  }
  put("velocity_rms", "mm_per_s", u.linear(), r.velocity_rms, 1e3);
  out["velocity_relative_percent"] = number_or_null(100.0 * r.velocity_relative);
  put("position_rms", "um", u.linear(), r.position_rms, 1e6);
  put("position_max", "um", u.linear(), r.position_most, 1e6);
  out["rows_outside_range"] = r.outside;
  return out;
}

}  // namespace

std::string text_table(const VerifyReportInput& given) {
  const VerifyReportInput input = with_short_names(given);
  std::string out;
  for (std::size_t i = 0; i < input.parts.size(); ++i) {
    const VerifiedPart& part = input.parts[i];
    const ShownUnits u = units_of(part);
    if (!out.empty()) out += '\n';
    out += fmt::format("{}{}{} rows", input.axis.empty() ? "" : "axis " + clean_text(input.axis) + ": ",
                       input.parts.size() > 1 ? part_name(input, i) + ", " : "", part.record.x.size());
    if (!part.models.empty())
      out += fmt::format(", {} reversals", part.models.front().open.starts.size() - 1);
    out += '\n';
    TextColumn name{"model", "", {}, false};
    TextColumn velocity{"velocity", u.velocity, {}, true, "open loop"};
    TextColumn share{"error", "%", {}, true, "anew at"};
    TextColumn position{"position", u.fine, {}, true, "reversals"};
    TextColumn free{"velocity", "%", {}, true, "from the"};
    TextColumn drift{"drift", u.position, {}, true, "first row"};
    TextColumn force{"force", u.force, {}, true, "closed"};
    TextColumn relative{"error", "%", {}, true, "loop"};
    TextColumn way{"position", u.fine, {}, true, ""};
    for (const VerifiedModel& m : part.models) {
      name.entries.push_back(clean_text(m.name));
      velocity.entries.push_back(significant(m.open.restarted.velocity_rms * u.per_velocity, 3));
      share.entries.push_back(percent(m.open.restarted.velocity_relative));
      position.entries.push_back(significant(m.open.restarted.position_rms * u.per_fine, 3));
      free.entries.push_back(percent(m.open.free.velocity_relative));
      drift.entries.push_back(significant(m.open.free.position_most * u.per_position, 3));
      const ident::replay::Replay none;
      const ident::replay::Replay& c = m.closed ? *m.closed : none;
      force.entries.push_back(significant(c.force_rms, 3));
      relative.entries.push_back(percent(c.force_relative));
      way.entries.push_back(significant(c.position_rms * u.per_fine, 3));
    }
    out += has_closed(part) ? lay_out({name, velocity, share, position, free, drift, force, relative, way})
                            : lay_out({name, velocity, share, position, free, drift});
  }
  if (!out.empty()) out += "RMS values; drift: largest value; error: share of the measured RMS.\n";
  for (const std::string& w : input.warnings) out += "warning: " + clean_text(w) + '\n';
  return out;
}

nlohmann::ordered_json to_json(const VerifyReportInput& input) {
  Json out;
  out["schema"] = "stribeck.verify/1";
  out["axis"] = input.axis.empty() ? Json(nullptr) : Json(input.axis);
  const VerifiedPart none;
  const VerifiedPart& first = input.parts.empty() ? none : input.parts.front();
  out["force_unit"] = first.record.force_unit;
  out["position_unit"] = first.record.position_unit;
  Json parts = Json::array();
  for (const VerifiedPart& part : input.parts) {
    const ShownUnits u = units_of(part);
    Json one;
    one["log"] = part.record.source;
    one["rows"] = part.record.x.size();
    one["duration_s"] = number_or_null(static_cast<double>(part.record.x.size()) * part.record.sample_time);
    one["restarts"] = part.models.empty() ? Json(nullptr) : Json(part.models.front().open.starts.size() - 1);
    Json models = Json::array();
    for (const VerifiedModel& m : part.models) {
      Json model;
      model["file"] = m.name;
      model["open_loop"] = replay_json(m.open.restarted, u, false);
      model["open_loop_free"] = replay_json(m.open.free, u, false);
      model["closed_loop"] = m.closed ? replay_json(*m.closed, u, true) : Json(nullptr);
      models.push_back(std::move(model));
    }
    one["models"] = std::move(models);
    parts.push_back(std::move(one));
  }
  out["parts"] = std::move(parts);
  out["warnings"] = input.warnings;
  return out;
}

std::string verify_report(const VerifyReportInput& given) {
  const VerifyReportInput input = with_short_names(given);
  std::vector<std::string> about;
  if (!input.source.empty()) about.push_back("on " + input.source);
  if (!input.version.empty()) about.push_back("stribeck " + input.version);
  Page page(
      input.axis.empty() ? "Models verified on a log" : "Models of axis " + input.axis + " verified on a log",
      joined(about, " · "));
  for (const VerifiedPart& part : input.parts) page.lead(summary(part));
  page.warnings(input.warnings);
  for (std::size_t i = 0; i < input.parts.size(); ++i) {
    const VerifiedPart& part = input.parts[i];
    if (part.models.empty()) continue;
    page.section(input.parts.size() > 1 ? "Errors, " + part_name(input, i) : "Errors");
    page.table(score_table(part));
    page.remark("%: RMS of the error as a share of the RMS of the measured signal. Bold: the smallest.");
    if (i >= kShownParts) continue;
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
  if (!input.command.empty()) {
    page.section("How to reproduce this page");
    page.code(input.command);
  }
  return page.html();
}

void write_verify_report(const std::string& directory, const VerifyReportInput& input) {
  const std::string page = verify_report(input);
  io::make_directory(directory);
  io::write_atomically(directory + "/index.html", page);
}

}  // namespace stribeck::report
