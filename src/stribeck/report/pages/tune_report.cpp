#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/columns.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/pages/tune_report.hpp>
#include <stribeck/report/run/loop_figures.hpp>
#include <stribeck/report/run/smooth_speeds.hpp>
#include <stribeck/report/run/tune_choice.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <vector>

namespace stribeck::report {
namespace {

using io::Json;
using io::number_or_null;

double decibels(double factor) { return 20.0 * std::log10(factor); }

std::string arrow(const std::string& a, const std::string& b) { return a + " → " + b; }

/// A figure of a travel before and after; "–" where there was no run.
std::string figure(const sim::TunedController& c, std::size_t travel, sim::Figure::OfRun which) {
  const double scale = sim::figure_of(which).scale;
  const auto one = [&](const std::vector<sim::TravelScore>& scores) {
    return travel < scores.size() ? decimals(scores[travel].mean.*which * scale, 2) : std::string("–");
  };
  return arrow(one(c.before), one(c.after));
}

/// Figures in the tables of a travel.
constexpr std::array kShown{&sim::Metrics::max_contour_error, &sim::Metrics::rms,
                            &sim::Metrics::input_variation};
/// Figures of a travel in the JSON.
constexpr std::array kInJson{&sim::Metrics::max_contour_error, &sim::Metrics::quadrant_glitch,
                             &sim::Metrics::rms, &sim::Metrics::input_variation, &sim::Metrics::power};

std::string degrees(double si) { return decimals(si * kDegrees, 1) + " deg"; }

/// Value and limit of the margin that the nearest gains violate most.
std::string in_words(const sim::Miss& m, const sim::TuneSpec& spec) {
  const auto pair = [](const char* what, const std::string& nearest, const std::string& asked) {
    return fmt::format("{} {}, where {} are required", what, nearest, asked);
  };
  switch (m.limit) {
    case sim::Limit::kPhaseMargin:
      return pair("a phase margin of", degrees(m.nearest), degrees(m.asked));
    case sim::Limit::kGainMargin:
      return pair("a gain margin of", decimals(decibels(m.nearest), 2) + " dB",
                  decimals(decibels(m.asked), 2) + " dB");
    case sim::Limit::kDelayMargin:
      return pair("a delay margin of", decimals(m.nearest, 2), short_number(m.asked) + " control periods");
    case sim::Limit::kInputVariation:
      return fmt::format(
          "a mean |Δu| of {} mV at {}, where at most {} mV less {} % for other noise are allowed",
          significant(m.nearest * 1e3, 4), spec.compare.travels[m.travel].pace_in_words(),
          significant(m.asked * 1e3, 4), short_number(100.0 * sim::kKeptBack));
    case sim::Limit::kPath:
      return "all limits kept, but the path is lost";
    case sim::Limit::kStability:
      break;
  }
  return "an unstable loop";
}

/// An arrow and the result; "–" where there is none.
std::string margin(const sim::TunedController& c, double start, double tuned, int digits) {
  return arrow(decimals(start, digits), c.found() ? decimals(tuned, digits) : "–");
}

std::string limits_in_words(const sim::TuneResult& r, const sim::TuneSpec& spec) {
  std::vector<std::string> variation;
  for (const double v : r.variation_limit) variation.push_back(significant(v * 1e3, 4) + " mV");
  return fmt::format(
      "phase margin {} deg, gain margin {} dB, {} more control period{} of delay, mean |Δu| {}{}",
      short_number(spec.limits.phase_margin * kDegrees), short_number(decibels(spec.limits.gain_margin)),
      short_number(spec.limits.delay_margin), spec.limits.delay_margin == 1.0 ? "" : "s", listed(variation),
      r.reference.empty() ? std::string() : " as of (" + clean_text(r.reference) + ") at its own gains");
}

std::string shown(double si, const Quantity& q) {
  return significant(si * io::unit_factor(q.unit, q.shown), 4);
}

std::string method_in_words(const sim::TuneSpec& spec) {
  constexpr std::array kGoals{"accuracy (largest error and RMS)", "surface (quadrant glitch and SD)",
                              "speed (lag of the axes and RMS)"};
  return fmt::format(
      "for {}, {} evaluations for each controller, {} trial{} each{}; reported: {} trial{} with other noise",
      kGoals[static_cast<std::size_t>(spec.goal)], spec.evaluations, spec.search_trials,
      spec.search_trials == 1 ? "" : "s",
      spec.nearby ? " on the given machine and one on each of those that it may be" : "", spec.compare.trials,
      spec.compare.trials == 1 ? "" : "s");
}

/// The limits that a controller's own gains break, in words; empty: none.
std::string broken_at_start(const sim::TunedController& c, const sim::TuneResult& result,
                            const sim::TuneSpec& spec) {
  std::vector<std::string> broken;
  const sim::LoopMargins& m = c.start_margins;
  if (m.phase < spec.limits.phase_margin) broken.push_back("the phase margin, " + degrees(m.phase));
  if (m.gain < spec.limits.gain_margin)
    broken.push_back("the gain margin, " + decimals(decibels(m.gain), 1) + " dB");
  if (m.delay < spec.limits.delay_margin * result.period)
    broken.push_back("the delay margin, " + decimals(m.delay / result.period, 2) + " control periods");
  for (std::size_t t = 0; t < c.before.size() && t < result.variation_limit.size(); ++t) {
    const double variation = c.before[t].mean.input_variation;
    if (variation > result.variation_limit[t]) {
      broken.push_back(fmt::format("mean |Δu|, {} mV at {}", significant(variation * 1e3, 4),
                                   spec.compare.travels[t].pace_in_words()));
    }
  }
  return listed(broken);
}

/// Whether the mean over nearby machines is smaller; false where there was none.
bool better_on_all(const sim::TunedController& c) {
  double before = 0.0, after = 0.0;
  for (const sim::MachineScore& m : c.machines) {
    if (std::isnan(m.after) || std::isinf(m.after)) return false;
    before += std::isnan(m.before) ? std::numeric_limits<double>::infinity() : m.before;
    after += m.after;
  }
  return after < before;
}

/// What a user must know before taking gains that leave a larger error than those there were; empty: they do not.
std::string worse_in_words(const sim::TunedController& c, const sim::TuneResult& result,
                           const sim::TuneSpec& spec) {
  // Gains for another goal may leave a larger error; those for several machines are judged on all of them.
  if (spec.goal != sim::TuneGoal::kAccuracy || better_on_all(c)) return {};
  for (std::size_t t = 0; t < c.before.size() && t < c.after.size(); ++t) {
    const double before = c.before[t].mean.max_contour_error;
    const double after = c.after[t].mean.max_contour_error;
    if (!(after > before)) continue;
    const std::string broken = broken_at_start(c, result, spec);
    return fmt::format(
        "controller ({}): the tuned gains leave a larger error than its own, {} in place of {} µm at "
        "{}{}",
        clean_text(c.start.id), micrometres(after), micrometres(before),
        spec.compare.travels[t].pace_in_words(),
        broken.empty() ? "; its own gains keep all limits: keep them"
                       : "; its own gains break a limit: " + broken);
  }
  return {};
}

}  // namespace

std::string why_none(const sim::TunedController& c, const sim::TuneSpec& spec) {
  if (!c.refused.empty()) return clean_text(c.refused);
  if (!c.miss) return {};
  return fmt::format("none found in {} tries, {} of them simulated{}; the nearest gains have {}", c.tries,
                     c.evaluations, c.miss->other_noise ? ", other noise breaks a limit" : "",
                     in_words(*c.miss, spec));
}

std::string text_table(const sim::TuneResult& result, const sim::TuneSpec& spec,
                       const sim::TradeOff& trade_off) {
  std::string out =
      "Limits: " + limits_in_words(result, spec) + ".\nSearch: " + method_in_words(spec) + ".\n";
  {
    TextColumn id{"", "", {}, false};
    id.least = kLongestId;
    TextColumn label{"controller", "", {}, false};
    TextColumn phase{"phase", "deg", {}};
    TextColumn gain{"gain", "dB", {}};
    TextColumn delay{"delay", "periods", {}};
    for (const sim::TunedController& c : result.controllers) {
      const auto& a = c.start_margins;
      const auto& b = c.tuned_margins;
      id.entries.push_back(clean_text(c.start.id));
      label.entries.push_back(clean_text(c.start.label));
      phase.entries.push_back(margin(c, a.phase * kDegrees, b.phase * kDegrees, 1));
      gain.entries.push_back(margin(c, decibels(a.gain), decibels(b.gain), 1));
      delay.entries.push_back(margin(c, a.delay / result.period, b.delay / result.period, 2));
    }
    out += "\nMargins of the loop\n" + lay_out({id, label, phase, gain, delay});
  }
  for (std::size_t t = 0; t < spec.compare.travels.size(); ++t) {
    TextColumn id{"", "", {}, false};
    id.least = kLongestId;
    TextColumn label{"controller", "", {}, false};
    for (const sim::TunedController& c : result.controllers) {
      id.entries.push_back(clean_text(c.start.id));
      label.entries.push_back(clean_text(c.start.label));
    }
    std::vector<TextColumn> columns{id, label};
    for (const auto which : kShown) {
      const sim::Figure& f = sim::figure_of(which);
      TextColumn& column = columns.emplace_back(TextColumn{std::string(f.name), std::string(f.unit), {}});
      for (const sim::TunedController& c : result.controllers) column.entries.push_back(figure(c, t, which));
    }
    out += fmt::format("\n{}, at its own gains → tuned\n", spec.compare.travels[t].pace_in_words()) +
           lay_out(columns);
  }
  out += nearby_text(result) + trade_off_text(trade_off, spec) + smooth_speed_text(result);
  TextColumn id{"", "", {}, false};
  id.least = kLongestId;
  TextColumn name{"gain", "", {}, false};
  TextColumn start{"own", "", {}};
  TextColumn tuned{"tuned", "", {}};
  TextColumn unit{"unit", "", {}, false};
  for (const sim::TunedController& c : result.controllers) {
    for (const sim::TunedGain& g : c.gains) {
      id.entries.push_back(clean_text(c.start.id));
      name.entries.push_back(g.name);
      start.entries.push_back(shown(g.start, g.quantity));
      tuned.entries.push_back(shown(g.tuned, g.quantity));
      unit.entries.emplace_back(g.quantity.shown);
    }
  }
  if (!id.entries.empty()) out += '\n' + lay_out({id, name, start, tuned, unit});
  for (const std::string& warning : travel_warnings(spec.compare)) out += "Warning: " + warning + ".\n";
  for (const sim::TunedController& c : result.controllers) {
    if (!c.before_refused.empty())
      out += fmt::format("({}) at its own gains: {}\n", clean_text(c.start.id), clean_text(c.before_refused));
    if (!c.found()) out += fmt::format("({}): {}\n", clean_text(c.start.id), why_none(c, spec));
    if (const std::string worse = worse_in_words(c, result, spec); !worse.empty())
      out += "Warning: " + worse + ".\n";
  }
  return out;
}

nlohmann::ordered_json to_json(const sim::TuneResult& result, const sim::TuneSpec& spec,
                               const sim::TradeOff& trade_off, const std::vector<std::string>& warnings) {
  const auto margins = [&](const sim::LoopMargins& m, const sim::LoopResponse& loop) {
    return Json{{"stable", m.stable},
                {"phase_deg", number_or_null(m.phase * kDegrees)},
                {"gain_dB", number_or_null(decibels(m.gain))},
                {"delay_periods", number_or_null(m.delay / result.period)},
                {"modulus", number_or_null(m.modulus)},
                {"crossover_rad_per_s", number_or_null(m.crossover)},
                {"response", loop.omega.empty() ? Json(nullptr) : loop_json(loop, result.axes[loop.axis])}};
  };
  const auto figures = [](const std::vector<sim::TravelScore>& scores, std::size_t t) {
    if (t >= scores.size()) return Json(nullptr);
    const sim::Metrics& m = scores[t].mean;
    Json one;
    for (const auto which : kInJson) {
      const sim::Figure& f = sim::figure_of(which);
      one[f.key] = number_or_null(m.*which * f.key_scale);
    }
    return one;
  };
  Json out;
  out["schema"] = "stribeck.tune/1";
  out["machine"] = result.machine;
  out["seed"] = spec.compare.seed;
  out["trials"] = spec.compare.trials;
  out["evaluations"] = spec.evaluations;
  out["goal"] = enum_name(spec.goal);
  out["limits"] = {{"phase_margin_deg", number_or_null(spec.limits.phase_margin * kDegrees)},
                   {"gain_margin_dB", number_or_null(decibels(spec.limits.gain_margin))},
                   {"delay_margin_periods", number_or_null(spec.limits.delay_margin)},
                   {"input_variation_V", io::numbers(result.variation_limit)},
                   {"reference", result.reference.empty() ? Json(nullptr) : Json(result.reference)}};
  out["controllers"] = Json::array();
  for (const sim::TunedController& c : result.controllers) {
    Json one;
    one["controller"] = c.start.id;
    one["label"] = c.start.label;
    const std::string worse = worse_in_words(c, result, spec);
    one["worse"] = worse.empty() ? Json(nullptr) : Json(worse);
    one["missed"] = c.found() ? Json(nullptr) : Json(why_none(c, spec));
    one["tries"] = c.tries;
    one["gains"] = Json::array();
    for (const sim::TunedGain& g : c.gains) {
      const double factor = io::unit_factor(g.quantity.unit, g.quantity.shown);
      one["gains"].push_back({{"name", g.name},
                              {"unit", std::string(g.quantity.shown)},
                              {"start", number_or_null(g.start * factor)},
                              {"tuned", number_or_null(g.tuned * factor)}});
    }
    one["margins"] = {{"start", margins(c.start_margins, c.start_loop)},
                      {"tuned", c.found() ? margins(c.tuned_margins, c.tuned_loop) : Json(nullptr)}};
    if (spec.stick_slip) {
      one["slowest_smooth_speed"] = {{"start", smooth_speed_json(c.start_smooth, result.axes)},
                                     {"tuned", smooth_speed_json(c.tuned_smooth, result.axes)}};
    }
    one["machines"] = nearby_json(c);
    one["rows"] = Json::array();
    for (std::size_t t = 0; t < spec.compare.travels.size(); ++t) {
      one["rows"].push_back({{"travel", spec.compare.travels[t].pace_in_words()},
                             {"start", figures(c.before, t)},
                             {"tuned", figures(c.after, t)}});
    }
    out["controllers"].push_back(std::move(one));
  }
  out["trade_off"] = trade_off_json(trade_off, spec);
  std::vector<std::string> all = warnings;
  for (std::string& warning : travel_warnings(spec.compare)) all.push_back(std::move(warning));
  out["warnings"] = std::move(all);
  return out;
}

namespace {

/// The tuned controller with the smallest largest error at the last speed.
std::string best_in_words(const TuneReportInput& input) {
  const std::size_t last = input.spec.compare.travels.size() - 1;
  const sim::TunedController* best = nullptr;
  const auto error = [&](const auto& scores) { return scores.at(last).mean.max_contour_error; };
  for (const sim::TunedController& c : input.result.controllers) {
    if (c.found() && c.after.size() > last && (best == nullptr || error(c.after) < error(best->after)))
      best = &c;
  }
  if (best == nullptr) return "No gains keep all limits: see the warnings.";
  std::string text =
      fmt::format("Use ({}) {}, tuned: its largest error at {} is {} µm", best->start.id, best->start.label,
                  input.spec.compare.travels[last].pace_in_words(), micrometres(error(best->after)));
  if (best->before.size() > last) {
    const std::string broken = broken_at_start(*best, input.result, input.spec);
    text += fmt::format(", {} µm with the gains that it had{}", micrometres(error(best->before)),
                        broken.empty() ? "" : ", which break a limit: " + broken);
  }
  text += ".";
  for (const sim::TunedController& c : input.result.controllers) {
    const std::string worse = worse_in_words(c, input.result, input.spec);
    if (!worse.empty())
      text += fmt::format(" ({}) has a larger error with its tuned gains than before.", c.start.id);
  }
  return text;
}

/// Bars of each speed: own gains grey, tuned ones blue.
std::vector<Plot> before_and_after(const TuneReportInput& input) {
  std::vector<Plot> plots;
  for (std::size_t t = 0; t < input.spec.compare.travels.size(); ++t) {
    Plot p{.title = "Largest error at " + input.spec.compare.travels[t].pace_in_words(),
           .y_label = "largest error [µm]",
           .width = 560,
           .height = 300};
    Series own{.label = "own gains", .style = Style::kBars, .color = "#7a7a7a", .width = 0.36};
    Series tuned{.label = "tuned", .style = Style::kBars, .color = "#0072b2", .width = 0.36};
    double place = 0.0;
    for (const sim::TunedController& c : input.result.controllers) {
      place += 1.0;
      p.x_tics.push_back({place, "(" + c.start.id + ")"});
      const auto bar = [&](Series& s, const auto& scores, double x) {
        if (t >= scores.size() || !std::isfinite(scores[t].mean.max_contour_error)) return;
        const double high = scores[t].mean.max_contour_error * 1e6;
        const double spread = scores[t].spread.max_contour_error * 1e6;
        const double half = std::isfinite(spread) ? spread : 0.0;
        s.x.push_back(x);
        s.y.push_back(high);
        s.y_low.push_back(high - half);
        s.y_high.push_back(high + half);
      };
      bar(own, c.before, place - 0.2);
      if (c.found()) bar(tuned, c.after, place + 0.2);
    }
    p.x_range = Range{0.4, place + 0.6};
    p.series = {std::move(own), std::move(tuned)};
    plots.push_back(std::move(p));
  }
  return plots;
}

/// The loops with the gains that each controller had and with the tuned ones.
std::vector<LoopCurve> loops_of(const sim::TuneResult& result) {
  std::vector<LoopCurve> curves;
  for (std::size_t i = 0; i < result.controllers.size(); ++i) {
    const sim::TunedController& c = result.controllers[i];
    const std::string color = controller_color(c.start.id, i);
    if (!c.start_loop.omega.empty())
      curves.push_back({"(" + c.start.id + ") own", &c.start_loop, color, true});
    if (!c.tuned_loop.omega.empty())
      curves.push_back({"(" + c.start.id + ") tuned", &c.tuned_loop, color, false});
  }
  return curves;
}

void add_loops(Page& page, const sim::TuneResult& r) {
  const std::vector<LoopCurve> loops = loops_of(r);
  if (loops.empty()) return;
  page.figures(
      loop_plots(loops), 2,
      "The loop L of the axis that comes nearest to instability, with the own and the tuned gains as the legend names them. Gain: the higher at low frequencies, the "
      "smaller the error; it crosses 0 dB at the bandwidth. Phase: its distance from −180° there is the phase margin. Nyquist plane: a "
      "good loop stays outside the circle about −1. Sensitivity: below 0 dB the loop reduces what disturbs the axis, above it "
      "amplifies it; a peak of more than 6 dB is a loop that rings. Friction of the axis is not in these curves.");
}

Page tune_report_page(const TuneReportInput& input) {
  const sim::TuneResult& r = input.result;
  Page page("Tuned controllers: " + r.machine, "stribeck " + input.version);
  page.lead(best_in_words(input));
  page.figures(
      before_and_after(input), 2,
      "Largest error with the gains that each controller had and with the tuned ones, mean over the trials; whiskers: standard "
      "deviation between them. Small is good.");
  page.paragraph(
      "Each controller at its best gains within the same limits: " + limits_in_words(r, input.spec) + ".");
  page.paragraph("One search for all: " + method_in_words(input.spec) +
                 ". Compensators: " + input.parameters + ".");
  for (std::size_t t = 0; t < input.spec.compare.travels.size(); ++t) {
    page.section(input.spec.compare.travels[t].pace_in_words());
    Table table;
    table.columns = {{"", "", false}, {"controller", "", false}};
    for (const auto which : kShown) {
      const sim::Figure& f = sim::figure_of(which);
      table.columns.push_back({std::string(f.name), std::string(f.unit) + ", own → tuned", true});
    }
    for (const sim::TunedController& c : r.controllers) {
      table.rows.push_back({{c.start.id}, {c.start.label}});
      for (const auto which : kShown) table.rows.back().push_back({figure(c, t, which)});
    }
    page.table(table);
  }
  add_nearby(page, r);
  add_trade_off(page, input.trade_off);
  page.section("Margins of the loop");
  Table margins;
  margins.columns = {{"", "", false},
                     {"controller", "", false},
                     {"phase", "deg, own → tuned", true},
                     {"gain", "dB, own → tuned", true},
                     {"delay", "periods, own → tuned", true}};
  for (const sim::TunedController& c : r.controllers) {
    const auto& a = c.start_margins;
    const auto& b = c.tuned_margins;
    margins.rows.push_back({{c.start.id},
                            {c.start.label},
                            {margin(c, a.phase * kDegrees, b.phase * kDegrees, 1)},
                            {margin(c, decibels(a.gain), decibels(b.gain), 1)},
                            {margin(c, a.delay / r.period, b.delay / r.period, 2)}});
  }
  page.table(margins);
  page.remark("Below zero: unstable; the number is the distance to stability.");
  add_loops(page, r);
  add_smooth_speeds(page, r);
  page.section("Gains");
  Table gains;
  gains.columns = {
      {"", "", false}, {"gain", "", false}, {"own", "", true}, {"tuned", "", true}, {"unit", "", false}};
  std::vector<std::string> warnings = input.warnings;
  for (std::string& warning : travel_warnings(input.spec.compare)) warnings.push_back(std::move(warning));
  for (const sim::TunedController& c : r.controllers) {
    for (const sim::TunedGain& g : c.gains) {
      gains.rows.push_back({{c.start.id},
                            {g.name},
                            {shown(g.start, g.quantity)},
                            {shown(g.tuned, g.quantity)},
                            {std::string(g.quantity.shown)}});
    }
    if (!c.before_refused.empty())
      warnings.push_back("(" + c.start.id + ") at its own gains: " + c.before_refused);
    if (!c.found()) warnings.push_back("(" + c.start.id + "): " + why_none(c, input.spec));
  }
  page.table(gains);
  page.warnings(warnings);
  page.made({input.command, input.version, input.inputs});
  return page;
}

}  // namespace

std::string tune_report(const TuneReportInput& input) { return tune_report_page(input).html(); }

void write_tune_report(const PageFolders& folders, const TuneReportInput& input) {
  write_page(tune_report_page(input), folders);
}

}  // namespace stribeck::report
