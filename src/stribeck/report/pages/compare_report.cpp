#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/report/html.hpp>
#include <stribeck/report/laws.hpp>
#include <stribeck/report/pages/compare_plots.hpp>
#include <stribeck/report/pages/compare_report.hpp>
#include <stribeck/report/pages/compare_tables.hpp>
#include <stribeck/report/pages/recommendation.hpp>
#include <stribeck/report/pages/verdict.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/plot/contour_plots.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <utility>

namespace stribeck::report {
namespace {

std::vector<std::string> all_warnings(const CompareReportInput& input) {
  std::vector<std::string> all = input.warnings;
  std::vector<ModelOfAxis> models;
  for (std::size_t i = 0; i < input.axes.size(); ++i) {
    const std::string axis = i < input.result.axes.size() ? input.result.axes[i] : std::to_string(i + 1);
    for (const auto& model : input.axes[i].models) models.push_back({axis, &model.second});
  }
  for (std::string& w : identification_warnings(models)) {
    // The caller may have them already.
    if (std::find(all.begin(), all.end(), w) == all.end()) all.push_back(std::move(w));
  }
  for (std::string& w : status_warnings(input.result)) all.push_back(std::move(w));
  return all;
}

FrictionMap map_of(const AxisEvidence& e, const std::string& axis, double speed) {
  FrictionMap map;
  map.axis = axis;
  map.speed = speed;
  map.rotary = e.rotary;
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
    if (r.substeps == 0) continue;
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
  page.made({input.command, input.version, input.inputs});
}

void identification(Page& page, const CompareReportInput& input) {
  for (std::size_t i = 0; i < std::min(input.axes.size(), input.result.axes.size()); ++i) {
    for (const auto& model : input.axes[i].models) {
      const ident::Result& result = model.second;
      std::string about = fmt::format("Axis {}: {} model by {}, {} rows", input.result.axes[i], result.model,
                                      ident::name_of(result.method), result.rows);
      if (std::isfinite(result.held_out_rms)) {
        about += fmt::format(", {} {} RMS on motion that was not fitted", significant(result.held_out_rms, 3),
                             units_of(result).force);
      }
      page.details(about, [&] {
        page.table(parameter_table(result));
        if (!result.models.empty()) page.table(candidate_table(result));
        page.warnings(result.warnings);
      });
    }
  }
}

void figures(Page& page, const CompareReportInput& input, const std::vector<TravelBlock>& blocks) {
  const sim::CompareResult& result = input.result;
  const bool one_axis = result.axes.size() == 1;
  const std::string error = error_name(result);
  const std::string letter = one_axis ? "e" : "ε";
  page.section("Figures");
  const std::vector<FigureColumn> figures = main_figures(result);
  bool printed = false;
  for (const TravelBlock& b : blocks) {
    page.table(controllers_table(b, figures));
    page.paragraph(verdict(b.rows, b.text, result));
    if (const std::string text = against_print(b); !text.empty()) page.paragraph(text);
    printed = printed || b.printed != nullptr;
  }
  page.remark(fmt::format(
      "Mean over the trials ± standard deviation between them; bold: the smallest. max: largest |{0}|. "
      "glitch: largest |{0}| within the first {2:g} mm that an axis travels after it reversed. {0}: {1}. "
      "mean |⁠Δu|: variation of the control input from period to period, which shows chattering. quadrant "
      "ratio: mean of the largest |{0}| of the quadrants divided by that of equally long windows elsewhere; at 1 no quadrant is visible.",
      letter, error, 1e3 * sim::kGlitchTravel));
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
                   for (const TravelBlock& b : blocks) page.table(controllers_table(b, further));
                   page.remark(one_axis ? "SD: standard deviation of e."
                                        : "SD: standard deviation of ε. e: tracking error of an axis.");
                 });
  }
}

/// The picture of the first screen.
void largest_errors(Page& page, const std::vector<TravelBlock>& blocks, const sim::CompareResult& result) {
  std::vector<Plot> plots;
  for (const TravelBlock& b : blocks)
    plots.push_back(bar_plot(b, b.rows, error_name(result), "Maximum", &sim::Metrics::max_contour_error));
  page.figures(
      plots, 2,
      "Largest error of each controller, mean over the trials; whiskers: standard deviation between them. Small is good.");
}

void bars_of_figures(Page& page, const CompareReportInput& input, const std::vector<TravelBlock>& blocks) {
  const std::string error = error_name(input.result);
  for (const TravelBlock& b : blocks) {
    const auto bars = [&](const Rows& rows) {
      return std::vector<Plot>{bar_plot(b, rows, error, "Maximum", &sim::Metrics::max_contour_error),
                               bar_plot(b, rows, error, "RMS", &sim::Metrics::rms)};
    };
    page.figures({bar_plot(b, b.rows, error, "RMS", &sim::Metrics::rms)}, 2, "");
    for (const Rows& fine : finer_rows(b.rows))
      page.figures(bars(fine), 2, "The same figures on a separate scale.");
  }
}

void magnified_contours(Page& page, const std::vector<TravelBlock>& blocks) {
  bool plane = false;
  for (const TravelBlock& b : blocks) {
    const std::optional<PlanePath> path = plane_path(*b.travel);
    if (!path) continue;
    if (!plane) page.section("Contour, error magnified");
    plane = true;
    page.subsection(b.text);
    for (const ScaleGroup& group : scale_groups(b.rows)) {
      const Magnified m = contour_plots(b, group, *path);
      page.figures(m.plots, 3, m.caption);
    }
  }
}

void change_since_identification(Page& page, const CompareReportInput& input) {
  if (const Table drift = drift_table(input.result); !drift.rows.empty()) {
    page.section("Change since identification");
    page.table(drift);
    page.remark(
        "Estimates of the on-line adaptation at the end of the first trial, as shares of the identified model, ± standard deviation. Delay: additional delay of the force beyond the assumed one.");
  }
}

void errors_along_path_and_time(Page& page, const CompareReportInput& input,
                                const std::vector<TravelBlock>& blocks) {
  const sim::CompareResult& result = input.result;
  const bool one_axis = result.axes.size() == 1;
  const std::string capital_error = one_axis ? "Tracking error" : "Contour error";
  page.section(capital_error + " along the path");
  for (const TravelBlock& b : blocks) {
    const ScaledPlots drawn = path_plots(result, b.index, {});
    page.figures(drawn.plots, 1,
                 drawn.caption(
                     "Last scored lap of the first trial" +
                     std::string(result.axes.size() == 2 ? "; positive to the left of the direction of travel"
                                 : one_axis              ? ""
                                                         : "; a distance, without a sign") +
                     ". Vertical lines: an axis reverses" + (one_axis ? "." : ", a quadrant begins.")));
  }
  page.details(capital_error + " over time", [&] {
    for (const TravelBlock& b : blocks) {
      const ScaledPlots drawn = time_plots(result, b.index, {.height = 260, .scored_only = false});
      page.figures(drawn.plots, 1, drawn.caption("The whole run of the first trial, from rest to rest."));
    }
  });
}

void reversals(Page& page, const CompareReportInput& input, const std::vector<TravelBlock>& blocks) {
  const sim::CompareResult& result = input.result;
  const bool one_axis = result.axes.size() == 1;
  page.section(one_axis ? "One reversal, close up" : "One quadrant, close up");
  for (const TravelBlock& b : blocks) {
    const ScaledPlots drawn = reversal_plots(b, result);
    page.figures(
        drawn.plots, 2,
        drawn.caption("The last reversal of each axis in the first trial. The second vertical line ends the "
                      "window of the quadrant glitch."));
  }
}

void friction_maps(Page& page, const CompareReportInput& input) {
  const sim::CompareResult& result = input.result;
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
}

void forces(Page& page, const CompareReportInput& input, const std::vector<TravelBlock>& blocks) {
  if (!blocks.empty()) {
    page.section("Forces");
    const bool truth = std::any_of(input.axes.begin(), input.axes.end(),
                                   [](const AxisEvidence& e) { return e.truth.has_value(); });
    for (const TravelBlock& b : blocks) {
      page.figures(
          force_plots(b, input), static_cast<int>(force_rows(b).size()),
          std::string("Last scored lap of the first trial. m·r̈: mass times acceleration of the reference.") +
              (truth
                   ? " The difference accelerates the axis beside its reference. It is small under every controller, because feedback "
                     "supplies what a model of friction lacks; the error that this needs is in the figures above."
                   : ""));
    }
  }
}

}  // namespace

std::vector<TravelBlock> blocks_of(const CompareReportInput& input) {
  std::vector<TravelBlock> blocks;
  for (const sim::CompareRow& r : input.result.rows) {
    auto at =
        std::find_if(blocks.begin(), blocks.end(), [&](const TravelBlock& b) { return b.index == r.travel; });
    if (at == blocks.end()) {
      const sim::Travel& travel = input.result.spec.travels.at(r.travel);
      blocks.push_back({r.travel, &travel, travel.pace_in_words(), {}, find_printed(input.printed, r.speed)});
      at = blocks.end() - 1;
    }
    at->rows.push_back(&r);
  }
  return blocks;
}

namespace {

/// The blocks without the rows that could not be simulated: those have nothing to draw.
std::vector<TravelBlock> simulated(std::vector<TravelBlock> blocks) {
  for (TravelBlock& b : blocks)
    std::erase_if(b.rows, [](const sim::CompareRow* r) { return !r->refused.empty(); });
  std::erase_if(blocks, [](const TravelBlock& b) { return b.rows.empty(); });
  return blocks;
}

}  // namespace

namespace {

Page compare_report_page(const CompareReportInput& input) {
  const sim::CompareResult& result = input.result;
  const std::vector<TravelBlock> blocks = blocks_of(input);
  std::vector<std::string> about;
  if (!input.experiment.empty()) about.push_back("experiment " + input.experiment);
  about.push_back(fmt::format("{} trial{}", result.spec.trials, result.spec.trials == 1 ? "" : "s"));
  about.push_back(fmt::format("seed {}", result.spec.seed));
  if (!input.version.empty()) about.push_back("stribeck " + input.version);
  Page page("Controllers compared: " + result.machine, joined(about, " · "));

  const std::vector<TravelBlock> drawn = simulated(blocks);
  const Recommendation advice = recommendation(blocks, result);
  page.lead(advice.words);
  page.numbers(advice.numbers);
  if (!input.what_if.empty())
    page.link(input.what_if,
              "Change friction, gains or speed of this machine and see what follows, in this browser");
  largest_errors(page, drawn, result);
  page.warnings(all_warnings(input));

  figures(page, input, blocks);
  bars_of_figures(page, input, drawn);
  magnified_contours(page, drawn);
  change_since_identification(page, input);
  errors_along_path_and_time(page, input, drawn);
  reversals(page, input, drawn);
  friction_maps(page, input);
  forces(page, input, drawn);

  const bool identified = std::any_of(input.axes.begin(), input.axes.end(),
                                      [](const AxisEvidence& e) { return !e.models.empty(); });
  if (identified || !input.parameters.empty()) {
    page.section("How the compensators were identified");
    if (!input.parameters.empty()) page.paragraph("Parameters: " + input.parameters + ".");
    identification(page, input);
  }

  page.section("Settings");
  settings(page, input);
  return page;
}

}  // namespace

std::string compare_report(const CompareReportInput& input) { return compare_report_page(input).html(); }

void write_compare_report(const PageFolders& folders, const CompareReportInput& input) {
  write_page(compare_report_page(input), folders);
}

}  // namespace stribeck::report
