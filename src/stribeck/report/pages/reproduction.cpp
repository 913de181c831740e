#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/numbers.hpp>
#include <stribeck/report/columns.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/pages/reproduction.hpp>
#include <stribeck/report/plot/contour_plots.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/cutting_estimate.hpp>

namespace stribeck::report {
namespace {

constexpr double kDetail = 0.5;

using Figure = sim::Figure::OfRun;

const sim::CompareRow* find_row(const sim::CompareResult& result, std::string_view id, std::size_t travel) {
  for (const sim::CompareRow& r : result.rows) {
    if (r.controller.id == id && r.travel == travel) return &r;
  }
  return nullptr;
}

struct MeanAndSpread {
  double mean = kNaN;
  double spread = kNaN;
};
MeanAndSpread mean_and_spread(const std::vector<double>& values) {
  const double n = static_cast<double>(values.size());
  double sum = 0.0;
  for (const double v : values) sum += v;
  MeanAndSpread m{sum / n, kNaN};
  if (values.size() < 2) return m;
  double square = 0.0;
  for (const double v : values) square += (v - m.mean) * (v - m.mean);
  m.spread = std::sqrt(square / (n - 1.0));
  return m;
}

ReproducedFigure of_claim(const sim::Claim& claim, const sim::CompareResult& result) {
  ReproducedFigure f;
  f.what = claim.what;
  f.of = "(" + claim.controller + ")";
  f.source = claim.source;
  if (result.spec.travels.size() > 1) f.what += ", " + result.spec.travels[claim.travel].pace_in_words();
  const sim::CompareRow* row = find_row(result, claim.controller, claim.travel);
  const sim::CompareRow* against =
      claim.against.empty() ? nullptr : find_row(result, claim.against, claim.travel);
  if (row == nullptr || (!claim.against.empty() && against == nullptr)) {
    f.printed = f.ours = f.low = f.high = kNaN;
    return f;
  }
  const sim::Figure& shown = sim::figure_of(claim.figure);
  MeanAndSpread ours{row->mean.*claim.figure * shown.scale, row->spread.*claim.figure * shown.scale};
  f.unit = shown.unit;
  f.printed = claim.printed * shown.scale;
  if (against != nullptr) {
    std::vector<double> changes;
    for (std::size_t i = 0; i < row->trials.size(); ++i)
      changes.push_back(100.0 * (row->trials[i].*claim.figure / (against->trials[i].*claim.figure) - 1.0));
    ours.spread = mean_and_spread(changes).spread;
    // Change of the means over the trials, computed as in the thesis.
    ours.mean = 100.0 * (row->mean.*claim.figure / (against->mean.*claim.figure) - 1.0);
    f.against = "(" + claim.against + ")";
    f.unit = "%";
    f.printed = 100.0 * claim.printed;
    f.digits = 1;
  }
  f.ours = ours.mean;
  f.low = ours.mean - ours.spread;
  f.high = ours.mean + ours.spread;
  return f;
}

/// A column of the measured table; `head` only where it differs from that of the figure.
struct MeasuredColumn {
  Figure figure;
  int digits = 2;
  std::string_view head = {};
};

/// The quadrant ratio is not in the thesis.
std::vector<MeasuredColumn> measured_columns(const sim::CompareResult& result, bool with_quadrants) {
  using sim::Metrics;
  const bool one_axis = result.axes.size() == 1;
  std::vector<MeasuredColumn> all{{&Metrics::max_contour_error, 2, one_axis ? "max |e|" : ""}};
  if (!one_axis) all.push_back({&Metrics::quadrant_glitch});
  if (with_quadrants && !one_axis) all.push_back({&Metrics::quadrant_ratio});
  all.insert(all.end(), {{&Metrics::rms},
                         {&Metrics::mean_abs},
                         {&Metrics::input_variation, 1},
                         {&Metrics::mean_abs_ui},
                         {&Metrics::max_orientation_error, 1, "orientation max"},
                         {&Metrics::mean_orientation_error, 1, "orientation mean"}});
  std::erase_if(all, [&](const MeasuredColumn& c) {
    return sim::figure_of(c.figure).where_known &&
           std::none_of(result.rows.begin(), result.rows.end(),
                        [&](const sim::CompareRow& r) { return std::isfinite(r.mean.*c.figure); });
  });
  return all;
}

Table measured_table(const sim::CompareResult& result, bool with_quadrants) {
  const std::vector<MeasuredColumn> columns = measured_columns(result, with_quadrants);
  Table t{"", {{"controller", "", false}}, {}};
  if (result.spec.travels.size() > 1) t.columns.push_back({"motion", "", false});
  for (const MeasuredColumn& c : columns) {
    const sim::Figure& f = sim::figure_of(c.figure);
    t.columns.push_back(
        {std::string(c.head.empty() ? f.head(result.axes.size() == 1) : c.head), std::string(f.unit)});
  }
  for (std::size_t k = 0; k < result.rows.size(); ++k) {
    const sim::CompareRow& r = result.rows[k];
    std::vector<Cell> row{{"(" + r.controller.id + ") " + r.controller.label, "", "", false,
                           controller_color(r.controller.id, k)}};
    if (result.spec.travels.size() > 1) row.push_back({result.spec.travels[r.travel].pace_in_words()});
    for (const MeasuredColumn& c : columns) {
      const double scale = sim::figure_of(c.figure).scale;
      Cell cell{decimals(r.mean.*c.figure * scale, c.digits)};
      if (std::isfinite(r.spread.*c.figure))
        cell.spread = "± " + decimals(r.spread.*c.figure * scale, c.digits);
      row.push_back(std::move(cell));
    }
    t.rows.push_back(std::move(row));
  }
  return t;
}

/// Errors along and across the path over time, as in figures 3.17 and 3.18; the controllers of each scale together.
std::vector<Plot> local_errors(const sim::CompareResult& result, std::size_t travel) {
  const Rows rows = rows_of(result, travel);
  std::vector<Plot> plots;
  for (const ScaleGroup& group : scale_groups(rows)) {
    for (std::size_t direction = 0; direction < 2; ++direction) {
      Plot p;
      p.title = direction == 0 ? "Tangential error" : "Normal error";
      if (group.rows.size() < rows.size()) p.title += ": " + names_of(group.rows, rows);
      p.x_label = "time [s]";
      p.y_label = "error [µm]";
      p.width = 560;
      p.height = 300;
      p.detail = kDetail;
      for (const sim::CompareRow* r : group.rows) {
        Series s;
        s.label = name_of(*r);
        s.color = color_of(*r, rows);
        s.width = 1.0;
        for (const sim::ContourSample& x : r->trace) {
          if (!x.scored) continue;
          s.x.push_back(x.time);
          s.y.push_back(x.local[direction] * kMicro);
        }
        p.series.push_back(std::move(s));
      }
      plots.push_back(std::move(p));
    }
  }
  return plots;
}

/// One bar for each trial and controller; `some` are all rows of the travel or those with the finer scales.
Plot bars(const Rows& some, const Rows& all, Figure figure, const char* title, const std::string& label) {
  Plot p;
  p.title = title;
  if (some.size() < all.size()) p.title += ": " + names_of(some, all) + " alone";
  p.x_label = "trial";
  p.y_label = label;
  p.width = 560;
  p.height = 280;
  const double width = 0.8 / static_cast<double>(std::max<std::size_t>(some.size(), 1));
  double top = 0.0;
  for (std::size_t i = 0; i < some.size(); ++i) {
    Series s;
    s.label = name_of(*some[i]);
    s.color = color_of(*some[i], all);
    s.style = Style::kBars;
    s.width = width;
    for (std::size_t k = 0; k < some[i]->trials.size(); ++k) {
      s.x.push_back(static_cast<double>(k) + 1.0 +
                    width * (static_cast<double>(i) - 0.5 * static_cast<double>(some.size() - 1)));
      s.y.push_back(some[i]->trials[k].*figure * sim::figure_of(figure).scale);
      if (std::isfinite(s.y.back())) top = std::fmax(top, s.y.back());
    }
    p.series.push_back(std::move(s));
  }
  p.y_range = Range{0.0, 1.1 * std::max(top, 1e-9)};
  p.x_step = 1.0;
  return p;
}

std::string shown(double value, const ReproducedFigure& f) { return decimals(value, f.digits); }

std::string with_spread(const ReproducedFigure& f) {
  std::string text = shown(f.ours, f);
  if (std::isfinite(f.low) && std::isfinite(f.high))
    text += fmt::format(" [{}, {}]", shown(f.low, f), shown(f.high, f));
  return text;
}

std::string figure_name(const ReproducedFigure& f) {
  return f.against.empty() ? f.of : fmt::format("{} against {}", f.of, f.against);
}

std::string heading(const ReproducedSection& s) {
  return s.setting.empty() ? s.id + ": " + s.title : fmt::format("{}: {} ({})", s.id, s.title, s.setting);
}

Table figure_table(const ReproducedSection& s) {
  Table t{"Printed and computed values",
          {{"figure", "", false},
           {"of", "", false},
           {"thesis"},
           {"Stribeck"},
           {"ratio"},
           {"unit", "", false},
           {"source", "", false}},
          {}};
  for (const ReproducedFigure& f : s.figures) {
    Cell ours{shown(f.ours, f)};
    if (std::isfinite(f.low) && std::isfinite(f.high))
      ours.spread = fmt::format("[{}, {}]", shown(f.low, f), shown(f.high, f));
    t.rows.push_back({{f.what},
                      {figure_name(f)},
                      {shown(f.printed, f)},
                      ours,
                      {decimals(f.ratio(), 2)},
                      {printed_unit(f.unit)},
                      {f.source}});
  }
  return t;
}

/// Text inside a Markdown table.
std::string cell_text(std::string_view text) {
  std::string out;
  for (const char c : clean_text(text)) {
    if (c == '|') out += '\\';
    out += c;
  }
  return out;
}

constexpr const char* kIntroduction =
    "Values printed in the thesis beside the results on virtual machines that represent its hardware. The compensators use parameters identified from logs of the virtual machine, or the printed parameters where a setting says so. The pre-sliding stiffness of the biaxial table is not printed: it "
    "is fitted to rows (a) and (b) of Tables 3.1 and 3.2 only (docs/theory/plant.md), which say nothing "
    "about its damping and the noise; every other row is a prediction. Brackets: one standard deviation "
    "over the trials to both sides, or a 95 % interval for identified parameters. A figure that is not "
    "reached is shown as it is.";

}  // namespace

ReproducedSection reproduced(const sim::Experiment& experiment, const sim::Setting& setting,
                             const sim::CompareResult& result, std::string parameters) {
  ReproducedSection s;
  s.id = experiment.id;
  s.title = experiment.title;
  s.source = experiment.source;
  s.setting = setting.name;
  s.machine = result.machine;
  s.parameters = std::move(parameters);
  s.remarks = experiment.remarks;
  for (const sim::Claim& c : setting.claims) s.figures.push_back(of_claim(c, result));
  s.table = measured_table(result, experiment.id.starts_with("beyond-"));
  for (const sim::CompareRow& r : result.rows) {
    const auto& cutting = result.spec.travels[r.travel].cutting;
    if (!cutting || r.trace.empty()) continue;
    const sim::CuttingFigures c = sim::cutting_figures(r.trace, *cutting);
    s.remarks.push_back(
        fmt::format("Cutting force against the feed under ({}), true / estimated from what the control "
                    "knows: mean {} / {} N, once per turn {} / {} N, once per tooth {} / {} N; error of "
                    "the estimate {} N RMS of {} N.",
                    r.controller.id, decimals(c.truth.mean, 1), decimals(c.estimate.mean, 1),
                    decimals(c.truth.turn, 1), decimals(c.estimate.turn, 1), decimals(c.truth.tooth, 1),
                    decimals(c.estimate.tooth, 1), decimals(c.rms_error, 1), decimals(c.rms_truth, 1)));
  }
  const bool current = std::any_of(result.rows.begin(), result.rows.end(),
                                   [](const auto& r) { return std::isfinite(r.mean.mean_abs_ui); });
  for (std::size_t travel = 0; travel < result.spec.travels.size(); ++travel) {
    const std::string pace = result.spec.travels[travel].pace_in_words();
    const Rows rows = rows_of(result, travel);
    // All experiments are on one page: half the points of a line reduce it to two thirds of the size.
    const TraceLook look = rows.size() > 3 ? TraceLook{560, 300, kDetail, false, true}
                                           : TraceLook{920, 300, kDetail, true, true};
    const ScaledPlots over_time = time_plots(result, travel, look);
    s.plots.emplace_back(over_time.plots, over_time.caption("Scored part of the first trial."));
    if (result.axes.size() > 1) {
      const ScaledPlots over_path = path_plots(result, travel, look);
      s.plots.emplace_back(
          over_path.plots,
          over_path.caption(
              "Last scored lap of the first trial, over the path. Vertical lines: an axis reverses."));
    }
    if (result.axes.size() == 2 && result.spec.travels[travel].pace == path::Pace::kRate)
      s.plots.emplace_back(local_errors(result, travel),
                           "Tracking error along and across the path, first trial.");
    const std::string label = error_name(result) + " [µm]";
    std::vector<Plot> trials;
    const auto errors = [&](const Rows& some) {
      trials.push_back(bars(some, rows, &sim::Metrics::max_contour_error, "Maximum", label));
      trials.push_back(bars(some, rows, &sim::Metrics::mean_abs, "Mean", label));
    };
    errors(rows);
    for (const Rows& fine : finer_rows(rows)) errors(fine);
    if (current) trials.push_back(bars(rows, rows, &sim::Metrics::mean_abs_ui, "Power", "mean |u·i| [W]"));
    trials.push_back(bars(rows, rows, &sim::Metrics::input_variation, "Control input", "mean |Δu| [mV]"));
    s.plots.emplace_back(std::move(trials), "Trial by trial, " + pace + ".");
  }
  return s;
}

namespace {

/// Whether there is a value to compare with.
bool has_print(const ReproducedSection& s) {
  return std::any_of(s.figures.begin(), s.figures.end(),
                     [](const ReproducedFigure& f) { return std::isfinite(f.printed); });
}

/// A table as text; the spread follows the figures where the width permits.
std::string as_text(const Table& table, bool spread = true) {
  constexpr std::size_t kGap = 2;
  std::vector<TextColumn> columns;
  std::size_t width = 0;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const Column& c = table.columns[i];
    TextColumn column{c.head, c.unit, {}, c.number};
    std::size_t widest = std::max(text_width(c.head), text_width(c.unit));
    for (const auto& row : table.rows) {
      const Cell& cell = row[i];
      column.entries.push_back(
          clean_text(cell.spread.empty() || !spread ? cell.text : cell.text + ' ' + cell.spread));
      widest = std::max(widest, text_width(column.entries.back()));
    }
    width += widest + kGap;
    columns.push_back(std::move(column));
  }
  if (spread && width > kTableWidth + kGap) return as_text(table, false);
  return lay_out(std::move(columns));
}

/// Result over print. Of a change against another controller it is what is left that is compared: 88 % and 97 % for -12 % and -3 %.
double ratio_of(const ReproducedFigure& f) {
  constexpr double kAll = 100.0;
  return f.against.empty() ? f.ratio() : (kAll + f.ours) / (kAll + f.printed);
}

/// How many printed figures are reached, and which one is farthest away. A printed zero has no ratio and is left out.
std::string agreement(const ReproductionInput& input) {
  constexpr double kClose = 1.1;
  constexpr double kNear = 1.25;
  std::size_t count = 0;
  std::size_t close = 0;
  std::size_t near = 0;
  double farthest = 1.0;
  std::string which;
  for (const ReproducedSection& s : input.sections) {
    for (const ReproducedFigure& f : s.figures) {
      const double ratio = ratio_of(f);
      if (!std::isfinite(f.printed) || !std::isfinite(ratio)) continue;
      ++count;
      const double factor =
          ratio > 0.0 ? std::max(ratio, 1.0 / ratio) : std::numeric_limits<double>::infinity();
      if (factor <= kClose) ++close;
      if (factor <= kNear) ++near;
      if (factor <= farthest) continue;
      farthest = factor;
      which = fmt::format("{}, {}, {}: {} in place of {} {}", s.id, f.what, figure_name(f), shown(f.ours, f),
                          shown(f.printed, f), printed_unit(f.unit));
    }
  }
  if (count == 0) return {};
  std::string words =
      fmt::format("Of {} printed figures {} are reached within 10 % and {} within 25 %.", count, close, near);
  if (!which.empty()) words += fmt::format(" Farthest away: {}.", which);
  return words;
}

Page reproduction_page(const ReproductionInput& input) {
  const bool any = std::any_of(input.sections.begin(), input.sections.end(), has_print);
  Page page(any ? "The thesis reproduced" : "Beyond the thesis",
            fmt::format("{}seed {}{}", input.trials > 0 ? fmt::format("{} trials · ", input.trials) : "",
                        input.seed, input.version.empty() ? "" : " · stribeck " + input.version));
  if (const std::string words = agreement(input); !words.empty()) page.lead(words);
  if (any) page.paragraph(kIntroduction);
  Table all{"All printed figures",
            {{"experiment", "", false},
             {"figure", "", false},
             {"of", "", false},
             {"thesis"},
             {"Stribeck"},
             {"ratio"},
             {"unit", "", false}},
            {}};
  for (const ReproducedSection& s : input.sections) {
    if (!has_print(s)) continue;
    for (const ReproducedFigure& f : s.figures) {
      Cell ours{shown(f.ours, f)};
      if (std::isfinite(f.low) && std::isfinite(f.high))
        ours.spread = fmt::format("[{}, {}]", shown(f.low, f), shown(f.high, f));
      all.rows.push_back({{s.id, "", s.setting},
                          {f.what},
                          {figure_name(f)},
                          {shown(f.printed, f)},
                          ours,
                          {decimals(f.ratio(), 2)},
                          {printed_unit(f.unit)}});
    }
  }
  if (any) page.details("All printed figures in one table", [&] { page.table(all); });
  for (const ReproducedSection& s : input.sections) {
    page.section(heading(s));
    page.remark(fmt::format("Thesis {}. Machine: {}.{}", s.source, s.machine,
                            s.parameters.empty() ? "" : " Compensators: " + s.parameters + "."));
    if (has_print(s)) page.table(figure_table(s));
    if (!s.table.columns.empty()) page.table(s.table);
    page.list("", s.remarks);
    for (const auto& [plots, caption] : s.plots) page.figures(plots, plots.size() > 1 ? 2 : 1, caption);
  }
  page.made({input.command, input.version, input.inputs});
  return page;
}

}  // namespace

std::string reproduction_html(const ReproductionInput& input) { return reproduction_page(input).html(); }

void write_reproduction(const PageFolders& folders, const ReproductionInput& input) {
  write_page(reproduction_page(input), folders);
}

std::string reproduction_markdown(const ReproductionInput& input) {
  std::string out = "# The thesis reproduced\n\n";
  out += fmt::format("Made by `{}`; continuous integration makes it again and compares. {}\n",
                     input.command.empty() ? "stribeck reproduce all" : input.command, kIntroduction);
  for (const ReproducedSection& s : input.sections) {
    out += fmt::format("\n## {}\n\nThesis {}. Machine: {}.{}\n", heading(s), s.source, s.machine,
                       s.parameters.empty() ? "" : " Compensators: " + s.parameters + ".");
    if (has_print(s)) {
      out += "\n| figure | of | thesis | Stribeck | ratio | unit | source |\n|---|---|---|---|---|---|---|\n";
      for (const ReproducedFigure& f : s.figures) {
        out += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", cell_text(f.what),
                           cell_text(figure_name(f)), shown(f.printed, f), with_spread(f),
                           decimals(f.ratio(), 2), cell_text(f.unit), cell_text(f.source));
      }
    }
    if (!s.table.columns.empty()) {
      std::string head = "|";
      std::string rule = "|";
      for (const Column& c : s.table.columns) {
        head += " " + cell_text(c.head) + (c.unit.empty() ? "" : " [" + c.unit + "]") + " |";
        rule += "---|";
      }
      out += "\n" + head + "\n" + rule + "\n";
      for (const auto& row : s.table.rows) {
        out += "|";
        for (const Cell& c : row)
          out += " " + cell_text(c.text) + (c.spread.empty() ? "" : " " + c.spread) + " |";
        out += "\n";
      }
    }
    if (!s.remarks.empty()) out += "\n";
    for (const std::string& r : s.remarks) out += "- " + clean_text(r) + "\n";
  }
  return out;
}

std::string reproduction_text(const ReproductionInput& input) {
  std::string out;
  for (const ReproducedSection& s : input.sections) {
    if (!out.empty()) out += '\n';
    out += clean_text(heading(s)) + '\n';
    if (!has_print(s)) {
      out += s.table.columns.empty() ? "  nothing printed to compare with\n" : as_text(s.table);
      continue;
    }
    TextColumn what{"", "", {}, false};
    TextColumn of{"", "", {}, false};
    TextColumn print{"thesis", "", {}};
    TextColumn ours{"Stribeck", "", {}};
    TextColumn times{"ratio", "", {}};
    TextColumn unit{"", "", {}, false};
    for (const ReproducedFigure& f : s.figures) {
      what.entries.push_back(clean_text(f.what));
      of.entries.push_back(clean_text(figure_name(f)));
      print.entries.push_back(shown(f.printed, f));
      ours.entries.push_back(shown(f.ours, f));
      times.entries.push_back(decimals(f.ratio(), 2));
      unit.entries.push_back(clean_text(f.unit));
    }
    out += lay_out({what, of, print, ours, times, unit});
  }
  return out;
}

}  // namespace stribeck::report
