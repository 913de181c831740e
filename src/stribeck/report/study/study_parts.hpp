#pragma once
/// Words and numbers of a study, for its tables and its page.
///
/// Inside report/study only.
/// Real time: no.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/report/study/study_report.hpp>
#include <stribeck/report/text.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::report {

/// In the order of the rows.
inline std::vector<std::string> motions_of(const StudyResult& r) {
  std::vector<std::string> all;
  for (const StudiedRow& row : r.rows) {
    if (std::find(all.begin(), all.end(), row.motion) == all.end()) all.push_back(row.motion);
  }
  return all;
}

/// Whether any run has this figure.
inline bool is_known(const StudiedFigure& f) { return f.spread.count() > f.spread.infinite(); }

/// The points of a grid are no draws: their quantiles have no confidence.
inline sim::Confident quantile_of(const StudyResult& r, const StudiedFigure& f, double p) {
  sim::Confident q = f.spread.quantile(p);
  if (r.sampling == sim::Sampling::kGrid) q.low = q.high = kNaN;
  return q;
}

/// The middle 95 % of the machines.
inline std::pair<double, double> band_of(const StudyResult& r, const StudiedFigure& f) {
  return {quantile_of(r, f, 0.025).value, quantile_of(r, f, 0.975).value};
}

/// Heads a column or labels an axis: name and unit.
inline std::string with_unit(const StudiedColumn& column) {
  return column.name + (column.unit.empty() ? "" : " [" + column.unit + "]");
}

/// In the column's unit, with four digits; "lost" for infinity.
inline std::string shown(const StudiedColumn& column, double value) {
  return std::isinf(value) ? "lost" : significant(value * column.shown, 4);
}

/// "3.1 … 3.4"; "–" on a side without a limit.
inline std::string interval(const StudiedColumn& column, const sim::Confident& c) {
  const auto end = [&](double x) { return std::isnan(x) ? std::string("–") : shown(column, x); };
  return end(c.low) + " … " + end(c.high);
}

inline std::string per_cent(double share) { return decimals(100.0 * share, 1); }
inline std::string per_cent_interval(const sim::Confident& c) {
  return per_cent(c.low) + " … " + per_cent(c.high);
}

inline std::string_view sampling_in_words(sim::Sampling sampling) {
  switch (sampling) {
    case sim::Sampling::kGrid:
      return "grid";
    case sim::Sampling::kLatinHypercube:
      return "Latin hypercube";
    case sim::Sampling::kSobol:
      return "Sobol' sequence";
    case sim::Sampling::kRandom:
      break;
  }
  return "random draws";
}

/// "2000 machines (Latin hypercube of 2000 samples, seed 1)".
inline std::string study_in_words(const StudyResult& r) {
  const std::string_view how = sampling_in_words(r.sampling);
  const char* const plural = r.runs == 1 ? "" : "s";
  const std::string what =
      r.factors.empty() ? fmt::format("run{} of", plural) : fmt::format("machine{} that differ from", plural);
  std::string words = fmt::format("{} {} \"{}\": {}", r.runs, what, clean_text(r.machine), how);
  if (r.runs != r.samples)
    words += fmt::format(" of {} samples, {} runs each (means and quantiles over the first two, {} machines)",
                         r.samples, r.runs / r.samples, 2 * r.samples);
  return words + fmt::format(", seed {}", r.seed);
}

/// One sentence for each row with lost runs.
inline std::vector<std::string> lost_in_words(const StudyResult& r) {
  std::vector<std::string> all;
  for (const StudiedRow& row : r.rows) {
    if (row.lost == 0) continue;
    all.push_back(
        fmt::format("({}) at {}: the path is lost on {} of {} machines, {} %; they count as infinite",
                    clean_text(row.controller), row.motion, row.lost, r.runs,
                    significant(100.0 * static_cast<double>(row.lost) / static_cast<double>(r.runs), 3)));
  }
  return all;
}

}  // namespace stribeck::report
