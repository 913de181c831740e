#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/numbers.hpp>
#include <stribeck/report/laws.hpp>
#include <stribeck/report/pages/compare_tables.hpp>
#include <utility>

namespace stribeck::report {
namespace {}  // namespace

/// Compares the block with printed figures, in one sentence; empty where nothing was printed.
std::string against_print(const TravelBlock& block) {
  if (block.printed == nullptr) return {};
  std::vector<std::string> near;
  const sim::CompareRow* farthest = nullptr;
  double worst = 0.0;
  const auto ratio = [&](const sim::CompareRow& r) {
    const PrintedRow* p = block.printed->find(r.controller.id);
    return p == nullptr ? kNaN : r.mean.max_contour_error * kMicro / p->max_contour_error_um;
  };
  for (const sim::CompareRow* r : block.rows) {
    const double off = std::abs(std::log(ratio(*r)));
    if (off < std::log(1.1)) near.push_back(name_of(*r));
    if (off > worst) {
      worst = off;
      farthest = r;
    }
  }
  if (farthest == nullptr) return {};
  std::string text = "Largest error against " + std::string(block.printed->source) + ": ";
  text += near.empty() ? "no controller is within 10 % of the printed value"
                       : listed(near) + " within 10 % of the printed value";
  return text + fmt::format("; the largest difference has {}, {} times the printed value.",
                            name_of(*farthest), decimals(ratio(*farthest), 2));
}

/// The main figures, by rank.
std::vector<FigureColumn> main_figures(const sim::CompareResult& result) {
  std::vector<FigureColumn> all;
  for (const sim::Figure& f : sim::kFigures) {
    const FigureColumn column{&f, std::string(f.head(result.axes.size() == 1))};
    const bool known = std::any_of(result.rows.begin(), result.rows.end(), [&](const sim::CompareRow& r) {
      return std::isfinite(column.of(r.mean));
    });
    if (f.column > 0 && (known || !f.where_known)) all.push_back(column);
  }
  std::sort(all.begin(), all.end(),
            [](const FigureColumn& a, const FigureColumn& b) { return a.figure->column < b.figure->column; });
  return all;
}

/// The other figures, in a second table: one table with all of them would be wider than a page.
std::vector<FigureColumn> further_figures(const sim::CompareResult& result) {
  std::vector<FigureColumn> all;
  for (const sim::Figure& f : sim::kFigures) {
    if (f.column != sim::Figure::kFurther) continue;
    if (std::holds_alternative<sim::Figure::OfRun>(f.member)) {
      all.push_back({&f, std::string(f.name)});
      continue;
    }
    // The tracking error of a single axis is already in the main table.
    const std::size_t axes = result.axes.size() < 2 ? 0 : std::min(result.axes.size(), control::kMostAxes);
    for (std::size_t i = 0; i < axes; ++i) all.push_back({&f, std::string(f.name) + " " + result.axes[i], i});
  }
  return all;
}

Table controllers_table(const TravelBlock& block, const std::vector<FigureColumn>& figures) {
  Table t{"At " + block.text, {{"controller", "", false}}, {}};
  for (const FigureColumn& f : figures) t.columns.push_back({f.head, std::string(f.figure->unit)});
  std::vector<double> best(figures.size(), std::numeric_limits<double>::infinity());
  for (const sim::CompareRow* r : block.rows) {
    for (std::size_t i = 0; i < figures.size(); ++i) best[i] = std::fmin(best[i], figures[i].of(r->mean));
  }
  for (const sim::CompareRow* one : block.rows) {
    const sim::CompareRow& r = *one;
    const PrintedRow* printed = block.printed != nullptr ? block.printed->find(r.controller.id) : nullptr;
    std::vector<Cell> row{{name_of(r), "", r.controller.label, false, color_of(r, block.rows)}};
    for (std::size_t i = 0; i < figures.size(); ++i) {
      const FigureColumn& f = figures[i];
      const double scale = f.figure->scale;
      const double value = f.of(r.mean);
      const double spread = f.of(r.spread);
      Cell cell{decimals(value * scale, 2)};
      if (std::isfinite(spread)) cell.spread = "± " + decimals(spread * scale, 2);
      cell.best = f.figure->marks_best && value == best[i] && block.rows.size() > 1;
      if (const auto print = printed != nullptr ? f.printed(*printed) : std::nullopt) {
        cell.note = "thesis " + decimals(*print, 2);
        // Printed standard deviations contradict the printed RMS, so a ratio to them would mean nothing.
        if (f.figure != &sim::figure_of(&sim::Metrics::sd))
          cell.note += " · ×" + decimals(value * scale / *print, 2);
      }
      row.push_back(std::move(cell));
    }
    t.rows.push_back(std::move(row));
  }
  return t;
}

/// Changes that adaptation found, one row for each controller, travel and axis; no rows without adaptation.
Table drift_table(const sim::CompareResult& result) {
  Table t{"",
          {{"controller", "", false},
           {"axis", "", false},
           {"friction", "%"},
           {"forwards", "%"},
           {"backwards", "%"},
           {"viscous", "%"},
           {"break-away distance", "%"},
           {"mass", "%"},
           {"delay", "ms"},
           {"in words", "", false}},
          {}};
  for (const sim::CompareRow& r : result.rows) {
    for (std::size_t i = 0; i < r.drift.size(); ++i) {
      const control::Drift& d = r.drift[i];
      const auto percent = [](double share, double deviation) {
        if (std::isfinite(deviation) && !change_is_known(deviation)) return Cell{"not determined"};
        Cell cell{with_sign(100.0 * share, 0)};
        if (std::isfinite(deviation)) cell.spread = "± " + decimals(100.0 * deviation, 0);
        return cell;
      };
      constexpr double kUnsaid = std::numeric_limits<double>::quiet_NaN();
      Cell delay{with_sign(1e3 * d.delay, 1)};
      delay.spread = "± " + decimals(1e3 * d.delay_deviation, 1);
      t.rows.push_back({{name_of(r), "", result.spec.travels[r.travel].pace_in_words()},
                        {result.axes[i]},
                        percent(d.level, d.level_deviation),
                        percent(d.positive, kUnsaid),
                        percent(d.negative, kUnsaid),
                        percent(d.viscous, d.viscous_deviation),
                        percent(d.break_away, d.break_away_deviation),
                        percent(d.mass, d.mass_deviation),
                        delay,
                        {std::string(describe(d.verdict))}});
    }
  }
  return t;
}

}  // namespace stribeck::report
