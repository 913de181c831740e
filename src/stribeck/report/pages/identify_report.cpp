#include <fmt/format.h>
#include <algorithm>

#include <cmath>
#include <optional>
#include <stribeck/ident/bristle/told_break_away.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/lost_motion/lost_motion_report.hpp>
#include <stribeck/report/pages/identify_report.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

/// The answer: what the axis is.
std::string answer(const ident::Result& r, std::string_view axis) {
  const ShownUnits units = units_of(r);
  const auto known = [&](std::string_view name) -> const ident::Parameter* {
    const auto found = std::find_if(r.parameters.begin(), r.parameters.end(),
                                    [&](const ident::Parameter& p) { return p.name == name; });
    return found == r.parameters.end() || !std::isfinite(found->value) ? nullptr : &*found;
  };
  std::string text;
  // In the units of the table below.
  if (const ident::Parameter* mass = known("mass")) {
    const ShownParameter s = shown(*mass, units);
    text += fmt::format("{} {} {}", r.rotary || r.position_unit == "rad" ? "Inertia" : "Mass",
                        shown_number(s.value, s.low, s.high), printed_unit(s.unit));
    if (std::isfinite(s.low) && std::isfinite(s.high))
      text += fmt::format(" (95 %: {} … {})", shown_number(s.low, s.low, s.high),
                          shown_number(s.high, s.low, s.high));
    text += ".";
  }
  const ident::Parameter* forward = known("coulomb_positive");
  const ident::Parameter* backward = known("coulomb_negative");
  if (forward != nullptr && backward != nullptr) {
    const ShownParameter f = shown(*forward, units);
    const ShownParameter b = shown(*backward, units);
    text += fmt::format(" Coulomb friction {} and {} {}.", shown_number(f.value, f.low, f.high),
                        shown_number(b.value, b.low, b.high), printed_unit(f.unit));
  }
  for (const auto& term : r.friction.eccentric) {
    const bool turns = term.form == friction::EccentricForm::kProportional;
    text += fmt::format(" A force of {} {} repeats every {} {}{}.", significant(term.amplitude, 3),
                        units.force, significant(term.period * units.per_position, 4), units.position,
                        turns ? " and reverses with the direction" : "");
  }
  if (const double way = ident::told_break_away(r); std::isfinite(way)) {
    text += fmt::format(
        " Friction breaks away after about {0} {1} (its level over the first stiffness), and after a reversal it settles over several times that.",
        significant(way * units.per_fine, 2), units.fine);
  }
  if (text.empty())
    return fmt::format("{}: {}, from {}.", axis.empty() ? "The axis" : fmt::format("Axis {}", axis),
                       headline(r), counted(r));
  return (axis.empty() ? "" : fmt::format("Axis {}. ", axis)) + text.substr(text.find_first_not_of(' '));
}

/// What the answer rests on, and how far it holds.
std::string basis(const ident::Result& r) {
  const ShownUnits units = units_of(r);
  std::string text = fmt::format("The model, {}, is from {}", headline(r), counted(r));
  if (r.velocity_range[0] < 0.0 && r.velocity_range[1] > 0.0) {
    text +=
        fmt::format("; it holds from {} to {} {}", significant(r.velocity_range[0] * units.per_velocity, 3),
                    significant(r.velocity_range[1] * units.per_velocity, 3), units.velocity);
    const auto [back, forward] = curve_begin(r);
    if (std::isfinite(back) && std::isfinite(forward)) {
      text += fmt::format(" and is measured beyond {} and {} {}", significant(back * units.per_velocity, 2),
                          significant(forward * units.per_velocity, 2), units.velocity);
    }
  }
  text += ".";
  if (std::isfinite(r.held_out_rms)) {
    text += fmt::format(" On held-out motion the error of the model is {} {} RMS.",
                        significant(r.held_out_rms, 3), units.force);
  }
  std::size_t loose = 0;
  for (const ident::Parameter& p : r.parameters) loose += p.identifiable ? 0 : 1;
  if (loose > 0) {
    text += fmt::format(
        " {} of {} parameters are not determined by the data: use the curve, not these parameters alone.",
        loose, r.parameters.size());
  }
  if (!units.physical()) {
    text += fmt::format(" The log gives no scale: forces are in {}, positions in {}.", units.force,
                        units.linear() ? "mm" : units.position);
  }
  return text;
}

void force_over_time(Page& page, const ForceOverTime& force, const ShownUnits& units) {
  page.section("Force over time");
  page.figure(
      force_plot(force, "", units.force, "#0072b2"),
      "Measured force of " + force.source +
          " beside that of the model under the measured motion, both behind the same low-pass. Good: the lines lie "
          "on each other, and what is left looks like noise. Where it does not, look at the velocity there in the figures below.");
}

/// The residual: against velocity, position and time, and its spectrum.
void residuals(Page& page, const ident::Result& r, bool heading) {
  std::vector<Plot> plots = residual_plots(r);
  const bool points = !plots.empty();
  std::optional<Plot> spectrum = spectrum_plot(r);
  if (spectrum) plots.push_back(std::move(*spectrum));
  if (plots.empty()) return;
  if (heading) page.section("What the model leaves");
  std::string caption;
  if (points) {
    caption =
        "Measured less modelled force of every row that was fitted, thinned. Where the band of means differs from zero, the model lacks a part of the friction.";
  }
  if (spectrum) {
    caption += std::string(caption.empty() ? "" : " ") +
               "Spectrum: a peak is a force that repeats with the position, e.g. once per turn of the "
               "screw. It is that of the residual before periodic terms; those that the model took are "
               "marked.";
  }
  page.figures(plots, 2, caption);
}

/// Quality in words, and the spectrum of the residual over time.
void quality(Page& page, const ident::residual::Quality& q, const ShownUnits& units) {
  if (q.rows == 0) return;
  page.paragraph(ident::residual::in_words(q, units.force));
  if (q.spectrum.empty()) return;
  Plot p;
  p.title = "Residual over frequency";
  p.x_label = "frequency [Hz]";
  p.y_label = "amplitude [" + units.force + "]";
  p.width = 920;
  p.height = 260;
  Series s;
  for (const ident::residual::Line& line : q.spectrum) {
    s.x.push_back(line.frequency);
    s.y.push_back(line.amplitude);
  }
  p.series.push_back(std::move(s));
  if (q.strongest) p.markers.push_back({q.strongest->frequency, ""});
  page.figures(
      {std::move(p)}, 1,
      "Of the force as it was logged, without a low-pass, on rows of settled sliding. A line is a vibration, hum of "
      "the mains or a mode of the drive.");
}

/// What a reader asks first: mass, error on motion that was not fitted, speeds.
std::vector<KeyNumber> key_numbers(const ident::Result& r) {
  const ShownUnits units = units_of(r);
  std::vector<KeyNumber> numbers;
  for (const ident::Parameter& p : r.parameters) {
    if (p.name != "mass" || !numbers.empty()) continue;
    const ShownParameter s = shown(p, units);
    numbers.push_back({"mass", shown_number(s.value, s.low, s.high), s.unit});
  }
  if (std::isfinite(r.held_out_rms))
    numbers.push_back(
        {"error on motion that was not fitted, RMS", significant(r.held_out_rms, 3), units.force});
  if (r.velocity_range[0] < 0.0 && r.velocity_range[1] > 0.0) {
    numbers.push_back({"speeds that the log holds",
                       fmt::format("{} to {}", significant(r.velocity_range[0] * units.per_velocity, 3),
                                   significant(r.velocity_range[1] * units.per_velocity, 3)),
                       units.velocity});
  }
  return numbers;
}

/// The parameters; those that only together make a curve are unfolded on demand.
void parameters(Page& page, const ident::Result& r) {
  const Table all = parameter_table(r);
  Table single{all.caption, all.columns, {}};
  Table curve{"", all.columns, {}};
  for (const auto& row : all.rows) {
    const std::string& name = row.front().text;
    const bool of_curve = name.starts_with("gaussian_") || name.starts_with("exponential_") ||
                          name.starts_with("eta") || name.starts_with("friction_at_");
    (of_curve ? curve : single).rows.push_back(row);
  }
  constexpr std::size_t kFew = 6;
  if (curve.rows.size() < kFew || single.rows.empty()) {
    page.table(all);
    return;
  }
  page.table(single);
  page.details(fmt::format("{} points and parameters of the curve", curve.rows.size()),
               [&] { page.table(curve); });
}

}  // namespace

std::string headline(const ident::Result& r) {
  if (r.method == ident::Method::kBreakAway) return "force and distance of break-away, from slow ramps";
  if (r.method == ident::Method::kGravity) return "load and friction, from equal speeds both ways";
  if (r.method == ident::Method::kConstantAcceleration)
    return "mass, from accelerating against braking at equal speed";
  if (r.steady == ident::SteadyModel::kCogging)
    return "forces periodic in position (cogging), from holding at standstill";
  return fmt::format("{} model by {}", r.model, ident::name_of(r.method));
}

std::string counted(const ident::Result& r) {
  const char* one = r.method == ident::Method::kBreakAway ? "slip" : "row";
  return fmt::format("{} {}{}", r.rows, one, r.rows == 1 ? "" : "s");
}

namespace {

Page identify_report_page(const IdentifyReportInput& input) {
  std::vector<std::string> about;
  if (!input.source.empty()) about.push_back("from " + input.source);
  if (!input.version.empty()) about.push_back("stribeck " + input.version);
  Page page(input.axis.empty() ? "Friction of an axis" : "Friction of axis " + input.axis,
            joined(about, " · "));
  bool first = true;
  for (const ident::Result& r : input.results) {
    if (!first) page.section("Beside it: " + headline(r));
    page.lead(answer(r, input.axis));
    if (first) page.numbers(key_numbers(r));
    page.paragraph(basis(r));
    page.list("What this log does not determine", r.cannot_tell);
    page.warnings(r.warnings);
    if (first) page.section("Friction map");
    FrictionMap map;
    map.axis = input.axis;
    map.fit = &r;
    map.speed = std::max(std::abs(r.velocity_range[0]), std::abs(r.velocity_range[1]));
    if (r.curve.size() < 2) map.model = r.friction.steady;
    map.model_label = "fit";
    for (const ident::Result& other : input.results) {
      // Only the whole model is compared: a model with periodic terms or bristles is no curve.
      const bool steady_only = other.friction.eccentric.empty() &&
                               std::holds_alternative<friction::Static>(other.friction.dynamics);
      if (&other != &r && other.steady == ident::SteadyModel::kConventional && steady_only)
        map.conventional = other.friction.steady;
    }
    page.figures(
        friction_plots(map), 2,
        std::string("Left: friction against velocity. Right: the same as difference from the fit, where "
                    "its 95 % band can be seen. Measured points are thinned.") +
            (r.friction.eccentric.empty() ? "" : " Periodic terms are subtracted."));
    if (first) page.section("Parameters");
    parameters(page, r);
    if (first && input.force) force_over_time(page, *input.force, units_of(r));
    residuals(page, r, first);
    if (first && input.quality) quality(page, *input.quality, units_of(r));
    if (first && input.lost_motion) {
      page.section("Lost motion");
      page.paragraph(kLostMotionMeaning);
      page.table(lost_motion_table(*input.lost_motion));
      page.list("What this log does not tell of it", input.lost_motion->words);
    }
    if (first && !r.models.empty()) page.section("Choice of the model");
    if (!r.models.empty()) {
      page.table(candidate_table(r));
      page.remark(
          "Judged on motion that was not fitted: of the models within one standard error of the best, or within 1 % of its "
          "RMS, the simplest is chosen.");
    }
    first = false;
  }
  page.made({input.command, input.version, input.inputs});
  return page;
}

}  // namespace

std::string identify_report(const IdentifyReportInput& input) { return identify_report_page(input).html(); }

void write_identify_report(const PageFolders& folders, const IdentifyReportInput& input) {
  write_page(identify_report_page(input), folders);
}

}  // namespace stribeck::report
