#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <stribeck/core/numbers.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/reproduce/robustness.hpp>

namespace stribeck::workflow {
namespace {

using report::Cell;
using report::decimals;

constexpr double kMicro = 1e6;

/// A share as a percentage: 30, 5, 0.5.
std::string per_cent(double share) { return report::short_number(100.0 * share) + " %"; }

/// The factors in which machines differ, in words.
std::string in_words(const sim::Variation& v) {
  std::vector<std::string> parts;
  if (v.friction > 0.0)
    parts.push_back(fmt::format("friction level and viscous part ± {}", per_cent(v.friction)));
  if (v.stiffness > 0.0) parts.push_back(fmt::format("pre-sliding stiffness ± {}", per_cent(v.stiffness)));
  if (v.mass > 0.0) parts.push_back(fmt::format("mass ± {}", per_cent(v.mass)));
  if (v.delay > 0) parts.push_back(fmt::format("0 to {} more control periods of delay", v.delay));
  if (v.encoder > 1.0)
    parts.push_back(fmt::format("encoder 1 to {} times coarser", report::short_number(v.encoder)));
  if (v.axial_mode && v.axial_mode->probability > 0.0) {
    const sim::AxialModeVariation& m = *v.axial_mode;
    parts.push_back(fmt::format(
        "on {} of the axes a mode of {} to {} Hz (damping {} to {}, table {} to {} of the mass)",
        per_cent(m.probability), report::short_number(m.frequency[0]), report::short_number(m.frequency[1]),
        report::short_number(m.damping_ratio[0]), report::short_number(m.damping_ratio[1]),
        per_cent(m.table_share[0]), per_cent(m.table_share[1])));
  }
  if (v.periodic > 0.0) {
    parts.push_back(fmt::format("a term periodic in position of 0 to {} of the level every {} to {} mm",
                                per_cent(v.periodic), report::short_number(v.periodic_period[0] * 1e3),
                                report::short_number(v.periodic_period[1] * 1e3)));
  }
  if (v.warming > 0.0) {
    parts.push_back(fmt::format("friction that falls by 0 to {} with a time constant of {} to {} s",
                                per_cent(v.warming), report::short_number(v.warming_time[0]),
                                report::short_number(v.warming_time[1])));
  }
  return parts.empty() ? "nothing" : report::listed(parts);
}

Cell micrometres(double value) {
  return {std::isinf(value) ? std::string("lost") : decimals(value * kMicro, 2)};
}
Cell shares(double value) { return {std::isinf(value) ? std::string("lost") : decimals(100.0 * value, 0)}; }

/// Share of the machines whose maximum error is below a value, over that value.
report::Plot below(const sim::RobustnessResult& result, std::size_t travel) {
  report::Plot p;
  p.title = result.spec.travels[travel].pace_in_words();
  p.description = "share of the machines whose maximum contour error is below a value, " + p.title;
  p.x_label = "maximum contour error [µm]";
  p.y_label = "machines below [%]";
  p.y_range = report::Range{0.0, 100.0};
  p.width = 560;
  p.height = 300;
  for (std::size_t r = 0; r < result.rows.size(); ++r) {
    const sim::RobustRow& row = result.rows[r];
    if (row.travel != travel) continue;
    std::vector<double> all = sim::figures(row, &sim::Metrics::max_contour_error);
    std::sort(all.begin(), all.end());
    report::Series s;
    s.label = "(" + row.controller.id + ")";
    s.color = report::controller_color(row.controller.id, r % result.spec.controllers.size());
    s.style = report::Style::kSteps;
    for (std::size_t i = 0; i < all.size() && std::isfinite(all[i]); ++i) {
      s.x.push_back(all[i] * kMicro);
      s.y.push_back(100.0 * static_cast<double>(i + 1) / static_cast<double>(all.size()));
    }
    if (!s.x.empty()) p.series.push_back(std::move(s));
  }
  return p;
}

report::ReproducedFigure figure(std::string what, const sim::RobustRow& row, double ours) {
  report::ReproducedFigure f;
  f.what = std::move(what);
  f.of = "(" + row.controller.id + ")";
  f.unit = "µm";
  f.printed = f.low = f.high = kNaN;
  f.ours = ours * kMicro;
  f.source = "not printed";
  return f;
}

}  // namespace

sim::Experiment robustness_experiment(const sim::RobustnessSpec& spec) {
  sim::Experiment e;
  e.id = kRobustness;
  e.title = "Machines that differ from the identified one";
  e.source = "§5.2, future work: nothing printed";
  sim::Setting s;
  s.machine = "biaxial-table";
  s.spec.travels = spec.travels;
  s.spec.controllers = spec.controllers;
  e.settings.push_back(std::move(s));
  return e;
}

report::ReproducedSection robustness_section(const sim::RobustnessResult& result) {
  const sim::Experiment experiment = robustness_experiment(result.spec);
  report::ReproducedSection s;
  s.id = experiment.id;
  s.title = experiment.title;
  s.source = experiment.source;
  s.setting = fmt::format("{} machines", result.spec.machines);
  s.machine = result.machine;
  s.parameters = "identified from logs of the nominal machine, the same for all";
  s.table = {"",
             {{"controller", "", false},
              {"motion", "", false},
              {"nominal", "µm"},
              {"median", "µm"},
              {"90 %", "µm"},
              {"99 %", "µm"},
              {"worst", "µm"},
              {"median", "% of ref."},
              {"99 %", "% of ref."},
              {"mean |Δu|", "mV"},
              {"lost"}},
             {}};
  const std::size_t count = result.spec.controllers.size();
  constexpr auto kMax = &sim::Metrics::max_contour_error;
  for (std::size_t r = 0; r < result.rows.size(); ++r) {
    const sim::RobustRow& row = result.rows[r];
    const sim::RobustRow& reference = result.rows[r - r % count];
    const std::string pace = result.spec.travels[row.travel].pace_in_words();
    const sim::Quantiles q = sim::quantiles(sim::figures(row, kMax));
    const sim::Quantiles of_reference = sim::quantiles(sim::figures(reference, kMax));
    const sim::Quantiles ratio = sim::quantiles(sim::ratios(row, reference, kMax));
    const double input = sim::interpolated_quantile(sim::figures(row, &sim::Metrics::input_variation), 0.5);
    s.table.rows.push_back({{"(" + row.controller.id + ") " + row.controller.label, "", "", false,
                             report::controller_color(row.controller.id, r % count)},
                            {pace},
                            row.nominal.lost ? Cell{"lost"} : micrometres(row.nominal.metrics.*kMax),
                            micrometres(q.median),
                            micrometres(q.p90),
                            micrometres(q.p99),
                            micrometres(q.worst),
                            shares(ratio.median),
                            shares(ratio.p99),
                            {std::isinf(input) ? std::string("lost") : decimals(input * 1e3, 1)},
                            {std::to_string(sim::lost(row))}});
    s.figures.push_back(figure("maximum, median of the machines, " + pace, row, q.median));
    s.figures.push_back(figure("maximum, 99th percentile, " + pace, row, q.p99));
    if (&row == &reference) continue;
    for (const auto& [what, ours] :
         {std::pair{"change of the median, ", q.median / of_reference.median},
          std::pair{"change of the 99th percentile, ", q.p99 / of_reference.p99}}) {
      report::ReproducedFigure f = figure(what + pace, row, 0.0);
      f.against = "(" + reference.controller.id + ")";
      f.unit = "%";
      f.ours = 100.0 * (ours - 1.0);
      f.digits = 1;
      s.figures.push_back(std::move(f));
    }
  }
  std::vector<report::Plot> plots;
  for (std::size_t t = 0; t < result.spec.travels.size(); ++t) plots.push_back(below(result, t));
  s.plots.emplace_back(std::move(plots),
                       "Share of the machines that stay below an error; lost ones never do.");
  s.remarks = {
      fmt::format("Every axis of every machine has random deviations of its own, all factors together: {}.",
                  in_words(result.spec.variation)),
      fmt::format(
          "Scored after {} laps, with the machine's own force noise, the same for all controllers. Seed {}.",
          report::short_number(result.spec.travels.front().settle_laps), result.spec.seed),
      fmt::format("Reference: ({}). Per cent of reference: quantiles of the ratio on the same machine. "
                  "Change: ratio of quantiles. A lost loop left the path or was held together by the limit "
                  "of the drives; it counts as infinite.",
                  result.spec.controllers.front().id)};
  return s;
}

}  // namespace stribeck::workflow
