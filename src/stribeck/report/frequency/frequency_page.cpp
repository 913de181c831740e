#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <stribeck/core/scalar.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/frequency/frequency_parts.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

using ident::frequency::Line;

constexpr const char* kMeasured = "#0072b2";
constexpr const char* kFitted = "#d55e00";
constexpr const char* kBandColor = "#9ecae1";
constexpr const char* kOther = "#009e73";
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

double dB(double factor) { return 20.0 * std::log10(factor); }

/// An angle [deg] in one piece with the one before.
double continued(double angle, double before) {
  while (angle - before > 180.0) angle -= 360.0;
  while (angle - before < -180.0) angle += 360.0;
  return angle;
}

Plot over_frequency_plot(std::string title, std::string y_label) {
  return {.title = std::move(title),
          .x_label = "frequency [Hz]",
          .y_label = std::move(y_label),
          .log_x = true,
          .width = 560,
          .height = 320};
}

void mark_resonance(Plot& p, const FrequencyAxis& a) {
  if (a.fit.antiresonance) p.markers.push_back({a.fit.antiresonance->value / kPerTurn, ""});
  if (a.fit.resonance)
    p.markers.push_back({a.fit.resonance->value / kPerTurn,
                         fmt::format("{} Hz", significant(a.fit.resonance->value / kPerTurn, 3))});
}

/// Gain or phase of the plant: band, lines, fit; lines that are not determined in grey.
Plot plant_plot(const FrequencyAxis& a, bool phase) {
  Plot p = over_frequency_plot(
      phase ? "Plant: phase" : "Plant: gain",
      phase ? "phase [deg]" : fmt::format("gain [dB re 1 {}/{}]", a.units.fine, a.units.force));
  Series band{.label = "95 %", .style = Style::kBand, .color = kBandColor};
  Series points{.label = "measured", .style = Style::kPoints, .color = kMeasured, .width = 1.2};
  Series unsure{.label = "not determined", .style = Style::kPoints, .color = "#bbbbbb", .width = 1.2};
  Series fit{.label = "fit", .color = kFitted};
  double before = -180.0;
  for (const Line& l : a.response.lines) {
    const double hz = l.omega / kPerTurn;
    const double gain = dB(std::abs(l.plant) * a.units.per_fine);
    const double angle = continued(std::arg(l.plant) * kDegrees, before);
    if (!l.determined()) {
      unsure.x.push_back(hz);
      unsure.y.push_back(phase ? angle : gain);
      continue;
    }
    before = angle;
    points.x.push_back(hz);
    points.y.push_back(phase ? angle : gain);
    const double turn = std::asin(std::min(1.0, l.half_width)) * kDegrees;
    band.x.push_back(hz);
    band.y_low.push_back(phase ? angle - turn : gain + dB(1.0 - std::min(0.99, l.half_width)));
    band.y_high.push_back(phase ? angle + turn : gain + dB(1.0 + l.half_width));
  }
  before = -180.0;
  for (const double omega : a.plant.omega) {
    const auto g = ident::frequency::sampled_response(a.fit.plant, omega, a.response.sample_time);
    before = continued(std::arg(g) * kDegrees, before);
    fit.x.push_back(omega / kPerTurn);
    fit.y.push_back(phase ? before : dB(std::abs(g) * a.units.per_fine));
  }
  p.series = {band, fit, points};
  if (!unsure.x.empty()) p.series.push_back(unsure);
  mark_resonance(p, a);
  return p;
}

Plot coherence_plot(const FrequencyAxis& a) {
  Plot p = over_frequency_plot("Coherence with the excitation", "coherence");
  p.y_range = Range{0.0, 1.05};
  Series force{.label = "force", .color = kMeasured};
  Series motion{.label = "position", .color = kFitted, .dashed = true};
  for (const Line& l : a.response.lines) {
    for (Series* s : {&force, &motion}) s->x.push_back(l.omega / kPerTurn);
    force.y.push_back(l.force_coherence);
    motion.y.push_back(l.motion_coherence);
  }
  p.series = {force, motion};
  return p;
}

Plot closed_plot(const FrequencyAxis& a) {
  Plot p = over_frequency_plot("Closed loop: position per reference", "gain [dB]");
  p.legend = Legend::kNone;
  Series band{.style = Style::kBand, .color = kBandColor};
  Series gain{.color = kMeasured};
  for (const Line& l : a.response.lines) {
    if (!(l.closed_half_width < ident::frequency::kUnsure)) continue;
    const double y = dB(std::abs(l.closed));
    gain.x.push_back(l.omega / kPerTurn);
    gain.y.push_back(y);
    band.x.push_back(l.omega / kPerTurn);
    band.y_low.push_back(y + dB(1.0 - std::min(0.99, l.closed_half_width)));
    band.y_high.push_back(y + dB(1.0 + l.closed_half_width));
  }
  p.series = {band, gain};
  return p;
}

/// A loop with its name and colour.
struct Drawn {
  std::string label;
  std::vector<std::complex<double>> loop;
  const char* color;
  bool dashed;
};

std::vector<Drawn> drawn_loops(const FrequencyAxis& a) {
  std::vector<Drawn> out;
  if (a.present)
    out.push_back({fmt::format("{}, ω = {}", a.present_is_proposed ? "for recording" : "present",
                               significant(a.present->omega, 3)),
                   sim::measured_loop(a.plant, *a.present), "#7a7a7a", true});
  const double mass = a.fit.mass.value;
  if (a.proposed.omega > 0.0)
    out.push_back({fmt::format("ω = {}", significant(a.proposed.omega, 3)),
                   sim::measured_loop(a.plant, {mass, a.proposed.omega, {}}), kMeasured, false});
  if (a.with_notch)
    out.push_back({fmt::format("ω = {} with notch", significant(a.with_notch->omega, 3)),
                   sim::measured_loop(a.plant, {mass, a.with_notch->omega, a.with_notch->notch}), kOther,
                   false});
  return out;
}

Series ring(double radius) {
  Series s{.color = "#999999", .width = 1.0, .dashed = true};
  for (int k = 0; k <= 120; ++k) {
    s.x.push_back(-1.0 + radius * std::cos(kPerTurn * k / 120.0));
    s.y.push_back(radius * std::sin(kPerTurn * k / 120.0));
  }
  return s;
}

Plot nyquist_plot(const FrequencyAxis& a) {
  constexpr Range kReal{-3.0, 1.0};
  constexpr Range kImaginary{-2.0, 2.0};
  Plot p{.title = "Nyquist plane of the open loop",
         .x_label = "real part of L",
         .y_label = "imaginary part of L",
         .x_range = kReal,
         .y_range = kImaginary,
         .equal_aspect = true,
         .notes = {{-1.0, 0.0, "−1", "#444444"}},
         .width = 560,
         .height = 560};
  p.series.push_back(ring(0.5));
  for (const Drawn& d : drawn_loops(a)) {
    Series s{.label = d.label, .color = d.color, .dashed = d.dashed};
    for (const std::complex<double>& l : d.loop) {
      const bool inside = l.real() >= kReal.low && l.real() <= kReal.high && l.imag() >= kImaginary.low &&
                          l.imag() <= kImaginary.high;
      s.x.push_back(inside ? l.real() : kNothing);
      s.y.push_back(inside ? l.imag() : kNothing);
    }
    p.series.push_back(std::move(s));
  }
  return p;
}

/// Gain or phase of the open loops.
Plot open_plot(const FrequencyAxis& a, bool phase) {
  Plot p = over_frequency_plot(phase ? "Open loop: phase" : "Open loop: gain",
                               phase ? "phase of L [deg]" : "|L| [dB]");
  for (const Drawn& d : drawn_loops(a)) {
    Series s{.label = d.label, .color = d.color, .dashed = d.dashed};
    double before = -150.0;
    for (std::size_t k = 0; k < d.loop.size(); ++k) {
      before = continued(std::arg(d.loop[k]) * kDegrees, before);
      s.x.push_back(a.plant.omega[k] / kPerTurn);
      s.y.push_back(phase ? before : dB(std::abs(d.loop[k])));
    }
    p.series.push_back(std::move(s));
  }
  const double level = phase ? -180.0 : 0.0;
  p.series.push_back({.x = {a.plant.omega.front() / kPerTurn, a.plant.omega.back() / kPerTurn},
                      .y = {level, level},
                      .color = "#999999",
                      .width = 1.0,
                      .dashed = true});
  mark_resonance(p, a);
  return p;
}

void add_axis(Page& page, const FrequencyAxis& a) {
  const ident::frequency::Response& r = a.response;
  page.section(a.name.empty() ? "Plant" : "Axis " + a.name + ": plant");
  page.figures(
      {plant_plot(a, false), plant_plot(a, true)}, 2,
      "Position per force as a controller with this period sees it, with hold and delay; bars of the band: 95 % of each line. A "
      "mass alone falls by 40 dB per decade at −180°, and delay turns the phase further. The line of the fit between the points "
      "is the model of the table below.");
  page.table(plant_table(a));
  page.remark(fmt::format("Model: {}; {}. It misses the lines by {} %, {} times their noise.",
                          enum_name(a.fit.plant.structure), a.fit.reason,
                          significant(100.0 * a.fit.misfit, 2), significant(a.fit.excess, 2)));
  std::vector<Plot> quality{coherence_plot(a)};
  if (r.closed_loop) quality.push_back(closed_plot(a));
  page.figures(
      quality, 2,
      "Coherence: the share of a signal's power that comes from the excitation; below one there is noise, or friction that is "
      "not linear. Closed loop: with the gains and the feed-forward that the log was recorded with.");
  page.section(a.name.empty() ? "Loop" : "Axis " + a.name + ": loop");
  page.table(loop_table(a));
  if (drawn_loops(a).empty()) return;
  page.figures(
      {open_plot(a, false), open_plot(a, true), nyquist_plot(a)}, 2,
      "L is the measured plant times the controller, kv = 2ω and kp = ω² on the sampled error. Gain margin: distance of |L| "
      "from 0 dB where the phase is −180°; phase margin: distance of the phase from −180° where |L| is 0 dB. A good loop stays "
      "outside the circle about −1. Observers and integrators are not in it: they take phase (stribeck tune).");
}

Page frequency_page(const FrequencyReportInput& input) {
  const FrequencyAxis& first = input.axes.front();
  Page page(first.name.empty() || input.axes.size() > 1 ? "Frequency response"
                                                        : "Frequency response of axis " + first.name,
            "stribeck " + input.version);
  for (const FrequencyAxis& a : input.axes) {
    std::string words = input.axes.size() > 1 ? "Axis " + a.name + ": " : "";
    for (const std::string& sentence : answer_of(a)) words += sentence + ". ";
    page.lead(words);
    page.warnings(a.warnings);
  }
  for (const FrequencyAxis& a : input.axes) add_axis(page, a);
  page.section("How it was measured");
  for (const FrequencyAxis& a : input.axes) {
    const ident::frequency::Response& r = a.response;
    page.paragraph(fmt::format(
        "{}: {}, {} segments in {} stretches of one direction, {} of {} rows. Left out: {} rows in which the axis stands or reverses, "
        "because friction is no linear response there; {} rows of settling.",
        a.sources,
        r.period ? fmt::format("excitation with a period of {} s", significant(*r.period, 4))
                 : "no period found (Welch)",
        r.segments, r.stretches, r.rows_used, r.rows, r.rows_reversal, r.rows_settling));
  }
  page.made({input.command, input.version, input.inputs});
  return page;
}

}  // namespace

std::string frequency_report(const FrequencyReportInput& input) { return frequency_page(input).html(); }

void write_frequency_report(const PageFolders& folders, const FrequencyReportInput& input) {
  if (folders.any()) write_page(frequency_page(input), folders);
}

}  // namespace stribeck::report
