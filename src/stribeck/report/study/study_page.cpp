#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/study/study_parts.hpp>
#include <stribeck/report/study/study_report.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

/// Points of a curve: one for each pixel of its width would be more than a reader sees.
constexpr std::size_t kPoints = 250;

std::string color_of_row(const StudyResult& r, const StudiedRow& row) {
  std::size_t position = 0;
  for (const StudiedRow& other : r.rows) {
    if (other.motion != row.motion) continue;
    if (other.controller == row.controller) break;
    ++position;
  }
  return controller_color(row.controller, position);
}

/// Share of the machines whose figure is below a value, over that value.
Plot shares_below(const StudyResult& r, const std::string& motion, std::size_t c) {
  const StudiedColumn& column = r.columns[c];
  Plot p;
  p.title = motion;
  p.description = fmt::format("share of the machines whose {} is below a value, {}", column.name, motion);
  p.x_label = with_unit(column);
  p.y_label = "machines below [%]";
  p.y_range = Range{0.0, 100.0};
  for (const StudiedRow& row : r.rows) {
    if (row.motion != motion) continue;
    const StudiedFigure& f = row.figures[c];
    Series s;
    s.label = "(" + clean_text(row.controller) + ")";
    s.color = color_of_row(r, row);
    s.style = Style::kSteps;
    if (is_known(f)) {
      s.x.push_back(f.spread.smallest() * column.shown);
      s.y.push_back(0.0);
    }
    for (const sim::SharePoint& point : f.spread.shares(kPoints)) {
      s.x.push_back(point.x * column.shown);
      s.y.push_back(100.0 * point.share);
    }
    if (s.x.empty()) continue;
    p.series.push_back(std::move(s));
  }
  return p;
}

/// A key that fits below its bars: the whole, else its last word, with the axis in front where two factors have the same.
std::string short_key(const StudyResult& r, std::size_t which) {
  constexpr double kRoom = 470.0;  // of all keys [px]
  constexpr double kLetter = 7.0;  // width of a letter [px]
  const std::string& key = r.factors[which].key;
  const auto last = [](const std::string& k) { return k.substr(k.rfind('.') + 1); };
  const auto room = static_cast<std::size_t>(kRoom / kLetter / static_cast<double>(r.factors.size()));
  if (key.size() <= room) return key;
  const auto same = std::count_if(r.factors.begin(), r.factors.end(),
                                  [&](const auto& other) { return last(other.key) == last(key); });
  std::string out = same > 1 ? key.substr(0, key.find('.')) + " " + last(key) : last(key);
  constexpr std::size_t kFewest = 4;
  if (out.size() > std::max(room, kFewest)) out = out.substr(0, std::max(room, kFewest) - 1) + "…";
  return out;
}

/// Indices of one controller on one motion.
Plot bars(const StudyResult& r, const StudiedRow& row) {
  const StudiedFigure& f = row.figures.front();
  Plot p;
  p.title = fmt::format("({}) at {}", clean_text(row.controller), row.motion);
  p.description = "share of the variance that comes from each factor, " + p.title;
  p.y_label = "share of the variance [%]";
  p.width = 560;
  p.height = 300;
  p.x_range = Range{0.4, static_cast<double>(f.indices.size()) + 0.6};
  Series first{.label = "alone", .style = Style::kBars, .color = "#0072b2", .width = 0.32};
  Series total{
      .label = "with what it acts together with", .style = Style::kBars, .color = "#e69f00", .width = 0.32};
  for (std::size_t i = 0; i < f.indices.size(); ++i) {
    const auto add = [&](Series& s, const sim::Confident& c, double x) {
      s.x.push_back(x);
      s.y.push_back(100.0 * c.value);
      s.y_low.push_back(100.0 * (std::isnan(c.low) ? c.value : c.low));
      s.y_high.push_back(100.0 * (std::isnan(c.high) ? c.value : c.high));
    };
    const auto at = static_cast<double>(i + 1);
    add(first, f.indices[i].first, at - 0.18);
    add(total, f.indices[i].total, at + 0.18);
    p.x_tics.push_back({at, short_key(r, i)});
  }
  p.series = {std::move(first), std::move(total)};
  return p;
}

Table figures_table(const StudyResult& r, const std::string& motion) {
  Table t;
  t.columns = {
      {"controller", "", false}, {"figure", "", false}, {"nominal"}, {"5 %"}, {"median"}, {"95 %"}, {"99 %"}};
  if (r.has_band) t.columns.push_back({"band of 95 %"});
  t.columns.push_back({"worst"});
  t.columns.push_back({"lost", "machines"});
  for (const StudiedRow& row : r.rows) {
    if (row.motion != motion) continue;
    bool begin = true;
    for (std::size_t c = 0; c < r.columns.size(); ++c) {
      const StudiedFigure& f = row.figures[c];
      if (!is_known(f)) continue;
      const StudiedColumn& column = r.columns[c];
      std::vector<Cell> cells;
      cells.push_back(begin ? Cell{"(" + clean_text(row.controller) + ") " + clean_text(row.label), "", "",
                                   false, color_of_row(r, row)}
                            : Cell{});
      cells.push_back({with_unit(column)});
      cells.push_back({row.nominal_lost ? "lost" : shown(column, f.nominal)});
      for (const double p : kStudyQuantiles) {
        const sim::Confident q = quantile_of(r, f, p);
        cells.push_back({shown(column, q.value), "", interval(column, q)});
      }
      if (r.has_band) {
        const auto [from, to] = band_of(r, f);
        cells.push_back({shown(column, from) + " … " + shown(column, to)});
      }
      cells.push_back({shown(column, f.spread.largest())});
      cells.push_back({begin ? std::to_string(row.lost) : std::string()});
      t.rows.push_back(std::move(cells));
      begin = false;
    }
  }
  return t;
}

void add_indices(Page& page, const StudyResult& r) {
  std::vector<Plot> plots;
  Table t;
  t.columns = {{"controller", "", false},
               {"motion", "", false},
               {"factor", "", false},
               {"alone", "%"},
               {"in all", "%"}};
  for (const StudiedRow& row : r.rows) {
    const StudiedFigure& f = row.figures.front();
    bool known = false;
    for (std::size_t i = 0; i < f.indices.size(); ++i) {
      const sim::SobolIndex& s = f.indices[i];
      known = known || std::isfinite(s.total.value);
      t.rows.push_back({{"(" + clean_text(row.controller) + ")"},
                        {row.motion},
                        {clean_text(r.factors[i].key)},
                        {per_cent(s.first.value), "", per_cent_interval(s.first)},
                        {per_cent(s.total.value), "", per_cent_interval(s.total)}});
    }
    if (known) plots.push_back(bars(r, row));
  }
  if (t.rows.empty()) return;
  page.section("Which factor matters");
  page.paragraph(fmt::format(
      "Share of the variance of \"{}\" over the machines. Alone: by how much it would fall if this factor were "
      "known. In all: what would be left of it if all other factors were known. What the shares alone leave to "
      "100 % comes from factors together, and from the noise.",
      r.columns.front().name));
  if (!plots.empty()) page.figures(plots, 2, "Bars: estimates; whiskers: 95 % confidence by bootstrap.");
  page.table(t);
}

/// Rows of a motion whose main figure is known, the smallest 95 % quantile first; lost ones are last.
std::vector<const StudiedRow*> by_figure(const StudyResult& r, const std::string& motion) {
  std::vector<const StudiedRow*> rows;
  for (const StudiedRow& row : r.rows) {
    if (row.motion == motion && is_known(row.figures.front())) rows.push_back(&row);
  }
  std::stable_sort(rows.begin(), rows.end(), [&](const StudiedRow* a, const StudiedRow* b) {
    return quantile_of(r, a->figures.front(), 0.95).value < quantile_of(r, b->figures.front(), 0.95).value;
  });
  return rows;
}

/// Who has the smallest error that 95 % of the machines stay below, how sure that is, and whether the next one is distinct from it.
std::string best_in_words(const StudyResult& r, const std::string& motion) {
  const StudiedColumn& column = r.columns.front();
  const std::string unit = column.unit.empty() ? "" : " " + column.unit;
  const std::string what = column.key == "max_contour_error_um" ? "largest error" : column.name;
  const auto rows = by_figure(r, motion);
  if (rows.empty()) return fmt::format("{}: no run of any controller could be scored.", motion);
  const StudiedRow& best = *rows.front();
  const sim::Confident most = quantile_of(r, best.figures.front(), 0.95);
  const std::string id = clean_text(best.controller);
  if (!std::isfinite(most.value)) {
    return fmt::format(
        "{}: every controller loses the path on more than 5 % of the machines; ({}) does so on {} of {}.",
        motion, id, best.lost, r.runs);
  }
  const bool sure = std::isfinite(most.low) && std::isfinite(most.high);
  std::string words = fmt::format("{}: under ({}) the {} stays below {}{} on 95 % of the machines", motion,
                                  id, what, shown(column, most.value), unit);
  if (sure) {
    words += fmt::format(" ({}, 95 % sure)", interval(column, most));
  } else if (r.sampling != sim::Sampling::kGrid) {
    words +=
        fmt::format("; {} machines are too few to say how sure that is", best.figures.front().spread.count());
  }
  if (rows.size() > 1) {
    const sim::Confident other = quantile_of(r, rows[1]->figures.front(), 0.95);
    const std::string next = std::isfinite(other.value) ? "it is " + shown(column, other.value) + unit
                                                        : "the path is lost on more than 5 %";
    words +=
        fmt::format("; under ({}), the next of {}, {}", clean_text(rows[1]->controller), rows.size(), next);
    if (sure && other.low <= most.high) words += ", which these machines do not tell apart";
  }
  return words +
         (best.lost > 0 ? fmt::format(". It loses the path on {} of {} machines.", best.lost, r.runs) : ".");
}

/// The factor with the largest share of the variance of the best controller; empty without indices.
std::string largest_factor(const StudyResult& r, const std::string& motion) {
  const auto rows = by_figure(r, motion);
  if (rows.empty()) return {};
  const auto& indices = rows.front()->figures.front().indices;
  const sim::SobolIndex* largest = nullptr;
  std::size_t which = 0;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (!std::isfinite(indices[i].total.value)) continue;
    if (largest != nullptr && !(indices[i].total.value > largest->total.value)) continue;
    largest = &indices[i];
    which = i;
  }
  if (largest == nullptr) return {};
  constexpr double kUnsure = 0.5;
  const sim::Confident& total = largest->total;
  if (!(total.high - total.low < kUnsure))
    return fmt::format(" Under ({}) these machines are too few to say which factor counts most.",
                       clean_text(rows.front()->controller));
  return fmt::format(" Of the variance under ({}) {} % ({} … {}, 95 % sure) goes with {}.",
                     clean_text(rows.front()->controller), per_cent(total.value), per_cent(total.low),
                     per_cent(total.high), clean_text(r.factors[which].key));
}

Page study_report_page(const StudyReportInput& input) {
  const StudyResult& r = input.result;
  Page page("Study: " + clean_text(r.machine), "stribeck " + input.version);
  for (const std::string& motion : motions_of(r))
    page.lead(best_in_words(r, motion) + largest_factor(r, motion));
  page.paragraph(study_in_words(r) + ".");
  page.paragraph(
      std::string(
          r.has_band
              ? "The machines are drawn from what the logs of the axes leave open; 95 % of them lie in the band. "
                "Controllers know the model of the axis file where it is of the kind that they take, else one from simulated logs of "
                "it. Compensators: "
              : "Controllers know the machine as its file says it, not how it differs. Compensators: ") +
      clean_text(r.parameters) + ".");
  Table factors;
  factors.columns = {{"factor", "", false}, {"distribution", "", false}};
  for (const StudiedFactor& f : r.factors)
    factors.rows.push_back({{clean_text(f.key)}, {clean_text(f.distribution)}});
  if (!factors.rows.empty()) page.table(factors);
  for (const std::string& motion : motions_of(r)) {
    page.section(motion);
    page.figure(shares_below(r, motion, 0),
                "Share of the machines that stay below a value; lost ones never do.");
    page.table(figures_table(r, motion));
    page.remark(
        "Small below a quantile: its interval of 95 % confidence, from order statistics; a dash where there are too few "
        "machines for a limit.");
  }
  add_indices(page, r);
  std::vector<std::string> warnings = lost_in_words(r);
  warnings.insert(warnings.end(), r.warnings.begin(), r.warnings.end());
  page.warnings(warnings);
  page.made({input.command, input.version, input.inputs});
  return page;
}

}  // namespace

std::string study_report(const StudyReportInput& input) { return study_report_page(input).html(); }

void write_study_report(const PageFolders& folders, const StudyReportInput& input) {
  write_page(study_report_page(input), folders);
}

}  // namespace stribeck::report
