#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stribeck/report/columns.hpp>
#include <stribeck/report/pages/identify_report.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <vector>

namespace stribeck::report {
namespace {

using Figure = sim::Figure::OfRun;

/// A figure of a row in the unit for people, with its spread where requested and known. Volts have three significant digits, because
/// they range over decades.
std::string entry(const sim::CompareRow& r, Figure which, bool with_spread) {
  const double scale = sim::figure_of(which).scale;
  const double spread = r.spread.*which * scale;
  if (which == &sim::Metrics::input_variation) return significant(r.mean.*which * scale, 3);
  const int digits = decimals_of_micrometres(r.mean.max_contour_error);
  std::string text = decimals(r.mean.*which * scale, digits);
  if (with_spread && std::isfinite(spread)) text += " ±" + decimals(spread, digits);
  return text;
}

TextColumn figure_column(Figure which, std::string group = {}) {
  const sim::Figure& f = sim::figure_of(which);
  return {std::string(f.name), std::string(f.unit), {}, true, std::move(group)};
}

}  // namespace

std::vector<std::string> travel_warnings(const sim::CompareSpec& spec) {
  std::vector<std::string> all;
  if (spec.travels.empty()) return all;
  // Travels differ in speed only.
  std::istringstream lines(spec.travels.front().note);
  for (std::string line; std::getline(lines, line);) all.push_back(line);
  return all;
}

std::vector<std::string> status_warnings(const sim::CompareResult& result) {
  std::vector<std::string> all = travel_warnings(result.spec);
  for (const sim::CompareRow& r : result.rows) {
    if (!r.refused.empty()) {
      all.push_back(fmt::format("({}) at {}: not simulated: {}", r.controller.id,
                                result.spec.travels[r.travel].pace_in_words(), r.refused));
    }
    if (!r.repeatable && r.refused.empty()) {
      all.push_back(fmt::format(
          "({}) at {}: stick-slip or an oscillation multiplies every difference: single errors are chance, means "
          "over many trials are not",
          r.controller.id, result.spec.travels[r.travel].pace_in_words()));
    }
    for (const Status s :
         {Status::kNotFinite, Status::kOutputLimited, Status::kOutsideVelocityRange, Status::kOscillation}) {
      if (r.status.count(s) == 0) continue;
      all.push_back(fmt::format("({}) at {}: {} ({} in {} trial{})", r.controller.id,
                                result.spec.travels[r.travel].pace_in_words(), describe(s),
                                r.status.count(s) == 1 ? "once" : fmt::format("{} times", r.status.count(s)),
                                result.spec.trials, result.spec.trials == 1 ? "" : "s"));
    }
  }
  return all;
}

std::vector<std::string> identification_warnings(const std::vector<ModelOfAxis>& models) {
  std::vector<std::pair<std::string, std::vector<std::string>>> said;
  for (const ModelOfAxis& m : models) {
    for (const std::string& w : m.result->warnings) {
      const auto at = std::find_if(said.begin(), said.end(), [&](const auto& s) { return s.first == w; });
      const std::string of = fmt::format("axis {}, {} model", m.axis, m.result->model);
      if (at == said.end()) {
        said.push_back({w, {of}});
      } else {
        at->second.push_back(of);
      }
    }
  }
  std::vector<std::string> all;
  for (const auto& [w, of] : said)
    all.push_back(of.size() == 1 ? of.front() + ": " + w : fmt::format("{} ({})", w, joined(of, "; ")));
  return all;
}

namespace {

/// "+3 ± 2 %".
std::string percent_words(double share, double deviation) {
  if (!change_is_known(deviation)) return "not determined";
  return fmt::format("{} ± {} %", with_sign(100.0 * share, 0), decimals(100.0 * deviation, 0));
}

}  // namespace

std::vector<std::string> drift_words(const sim::CompareResult& result) {
  std::vector<std::string> all;
  for (const sim::CompareRow& r : result.rows) {
    for (std::size_t i = 0; i < r.drift.size(); ++i) {
      const control::Drift& d = r.drift[i];
      all.push_back(fmt::format(
          "({}) at {}, axis {}: friction {}, viscous {}, break-away distance {}, mass {}, delay {} ± {} ms: {}",
          r.controller.id, result.spec.travels[r.travel].pace_in_words(), result.axes[i],
          percent_words(d.level, d.level_deviation), percent_words(d.viscous, d.viscous_deviation),
          percent_words(d.break_away, d.break_away_deviation), percent_words(d.mass, d.mass_deviation),
          with_sign(1e3 * d.delay, 1), decimals(1e3 * d.delay_deviation, 1), describe(d.verdict)));
    }
  }
  return all;
}

std::string in_words(const sim::PartSummary& part) {
  const auto counted = [](std::size_t n, std::string_view what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
  };
  std::string words =
      fmt::format("{}, {} mm in {} s, {} on the way", counted(part.moves, "move"),
                  decimals(part.length * 1e3, 3), decimals(part.duration, 3), counted(part.stops, "stop"));
  if (part.corners > 0)
    words += fmt::format(", {} rounded by at most {} um", counted(part.corners, "corner"),
                         decimals(part.deviation * 1e6, 3));
  if (part.limited > 0)
    words += fmt::format(", {} slower than programmed: limits of the axes", counted(part.limited, "move"));
  return words;
}

std::string text_table(const sim::CompareResult& result, std::span<const PrintedTable> printed) {
  std::string out;
  for (std::size_t travel = 0; travel < result.spec.travels.size(); ++travel) {
    const PrintedTable* print = find_printed(printed, result.spec.travels[travel].speed);
    TextColumn id{"", "", {}, false};
    id.least = kLongestId;
    TextColumn label{"controller", "", {}, false};
    using sim::Metrics;
    std::vector<Figure> shown{&Metrics::max_contour_error, &Metrics::quadrant_glitch, &Metrics::rms,
                              &Metrics::mean_abs};
    if (print == nullptr) shown.insert(shown.end(), {&Metrics::sd, &Metrics::input_variation});
    const std::vector<Figure> printed_too{&Metrics::max_contour_error, &Metrics::quadrant_glitch,
                                          &Metrics::rms};
    std::vector<TextColumn> figures;
    for (const Figure f : shown) figures.push_back(figure_column(f));
    std::vector<TextColumn> prints;
    for (const Figure f : printed_too) prints.push_back(figure_column(f, "thesis"));
    for (const sim::CompareRow& r : result.rows) {
      if (r.travel != travel) continue;
      id.entries.push_back(clean_text(r.controller.id));
      label.entries.push_back(clean_text(r.controller.label));
      for (std::size_t i = 0; i < shown.size(); ++i) {
        const bool with_spread = shown[i] == &Metrics::max_contour_error || shown[i] == &Metrics::rms;
        figures[i].entries.push_back(entry(r, shown[i], with_spread));
      }
      const PrintedRow* p = print != nullptr ? print->find(r.controller.id) : nullptr;
      for (std::size_t i = 0; i < printed_too.size(); ++i) {
        const auto value = p != nullptr ? p->of(printed_too[i]) : std::nullopt;
        prints[i].entries.push_back(value ? decimals(*value, 2) : "");
      }
    }
    if (!out.empty()) out += '\n';
    out += fmt::format("{}, {} error, mean of {} trial{}", result.spec.travels[travel].pace_in_words(),
                       result.axes.size() == 1 ? "tracking" : "contour", result.spec.trials,
                       result.spec.trials == 1 ? "" : "s ± standard deviation between them");
    if (print != nullptr) out += fmt::format("; printed: {}", print->source);
    out += "\n";
    std::vector<TextColumn> columns{id, label};
    columns.insert(columns.end(), figures.begin(), figures.end());
    if (print != nullptr) columns.insert(columns.end(), prints.begin(), prints.end());
    out += lay_out(std::move(columns));
  }
  return out;
}

std::string text_table(const ident::Result& result, std::string_view axis) {
  const ShownUnits units = units_of(result);
  std::string out = fmt::format("{}{}, {}", axis.empty() ? std::string() : "axis " + clean_text(axis) + ": ",
                                clean_text(headline(result)), counted(result));
  if (std::isfinite(result.held_out_rms)) {
    out += fmt::format(", {} {} RMS on held-out motion", significant(result.held_out_rms, 3), units.force);
  }
  out += '\n';
  TextColumn name{"parameter", "", {}, false};
  TextColumn value{"value", "", {}};
  TextColumn low{"95 % from", "", {}};
  TextColumn high{"to", "", {}};
  TextColumn unit{"unit", "", {}, false};
  TextColumn remark{"", "", {}, false};
  for (const ident::Parameter& p : result.parameters) {
    const ShownParameter s = shown(p, units);
    name.entries.push_back(clean_text(p.name));
    value.entries.push_back(shown_number(s.value, s.low, s.high));
    low.entries.push_back(shown_number(s.low, s.low, s.high));
    high.entries.push_back(shown_number(s.high, s.low, s.high));
    unit.entries.push_back(clean_text(s.unit));
    remark.entries.push_back(p.identifiable ? "" : "not determined by the data");
  }
  out += lay_out({name, value, low, high, unit, remark});
  if (!result.models.empty()) {
    TextColumn model{"model", "", {}, false};
    TextColumn held{"held-out RMS", units.force, {}};
    TextColumn error{"± from best", units.force, {}};
    TextColumn chosen{"", "", {}, false};
    const int digits = candidate_digits(result);
    for (const ident::Candidate& c : result.models) {
      model.entries.push_back(clean_text(c.name));
      held.entries.push_back(decimals(c.held_out_rms, digits));
      error.entries.push_back(decimals(c.standard_error, digits));
      chosen.entries.push_back(c.chosen ? "chosen" : "");
    }
    out += '\n' + lay_out({model, held, error, chosen});
  }
  if (!units.physical()) {
    out += fmt::format("\nForces are in {}, positions in {}: the log gives no scale.\n", units.force,
                       units.linear() ? "mm" : units.position);
  }
  if (!result.cannot_tell.empty()) out += "\nThis log does not determine:\n";
  for (const std::string& c : result.cannot_tell) out += "  - " + clean_text(c) + '\n';
  for (const std::string& w : result.warnings) out += "warning: " + clean_text(w) + '\n';
  return out;
}

}  // namespace stribeck::report
