#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stribeck/core/numbers.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/columns.hpp>
#include <stribeck/report/study/study_parts.hpp>
#include <stribeck/report/study/study_report.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

using io::Json;
using io::number_or_null;

std::string id_of(const StudiedRow& row) { return clean_text(row.controller); }

/// One table for each motion: every figure of every controller.
std::string tables(const StudyResult& r) {
  std::string out;
  for (const std::string& motion : motions_of(r)) {
    TextColumn id{"", "", {}, false};
    id.least = kLongestId;
    TextColumn figure{"figure", "", {}, false};
    TextColumn nominal{"nominal", "", {}};
    TextColumn median{"median", "", {}};
    TextColumn of_median{"95 % sure", "", {}};
    TextColumn most{"95 %", "", {}};
    TextColumn of_most{"95 % sure", "", {}};
    TextColumn worst{"worst", "", {}};
    for (const StudiedRow& row : r.rows) {
      if (row.motion != motion) continue;
      for (std::size_t c = 0; c < r.columns.size(); ++c) {
        const StudiedFigure& f = row.figures[c];
        if (!is_known(f)) continue;
        const StudiedColumn& column = r.columns[c];
        const sim::Confident half = quantile_of(r, f, 0.5);
        const sim::Confident high = quantile_of(r, f, 0.95);
        id.entries.push_back(id_of(row));
        figure.entries.push_back(column.name + (column.unit.empty() ? "" : " [" + column.unit + "]"));
        nominal.entries.push_back(row.nominal_lost ? "lost" : shown(column, f.nominal));
        median.entries.push_back(shown(column, half.value));
        of_median.entries.push_back(interval(column, half));
        most.entries.push_back(shown(column, high.value));
        of_most.entries.push_back(interval(column, high));
        worst.entries.push_back(shown(column, f.spread.largest()));
      }
    }
    out += fmt::format("\n{}\n", motion) +
           lay_out({id, figure, nominal, median, of_median, most, of_most, worst});
  }
  return out;
}

/// Indices of the first figure.
std::string index_table(const StudyResult& r) {
  TextColumn id{"", "", {}, false};
  id.least = kLongestId;
  TextColumn motion{"motion", "", {}, false};
  TextColumn factor{"factor", "", {}, false};
  factor.least = 20;
  TextColumn first{"alone", "%", {}};
  TextColumn of_first{"95 % sure", "%", {}};
  TextColumn total{"in all", "%", {}};
  TextColumn of_total{"95 % sure", "%", {}};
  for (const StudiedRow& row : r.rows) {
    const StudiedFigure& f = row.figures.front();
    for (std::size_t i = 0; i < f.indices.size(); ++i) {
      id.entries.push_back(id_of(row));
      motion.entries.push_back(row.motion);
      factor.entries.push_back(clean_text(r.factors[i].key));
      first.entries.push_back(per_cent(f.indices[i].first.value));
      of_first.entries.push_back(per_cent_interval(f.indices[i].first));
      total.entries.push_back(per_cent(f.indices[i].total.value));
      of_total.entries.push_back(per_cent_interval(f.indices[i].total));
    }
  }
  if (id.entries.empty()) return {};
  return fmt::format("\nShare of the variance of \"{}\" that comes from each factor\n",
                     r.columns.front().name) +
         lay_out({id, motion, factor, first, of_first, total, of_total});
}

/// What the logs leave open of every figure; empty: the machines are others.
std::string band_table(const StudyResult& r) {
  if (!r.has_band) return {};
  TextColumn id{"", "", {}, false};
  id.least = kLongestId;
  TextColumn motion{"motion", "", {}, false};
  TextColumn figure{"figure", "", {}, false};
  TextColumn low{"from", "", {}};
  TextColumn high{"to", "", {}};
  for (const StudiedRow& row : r.rows) {
    for (std::size_t c = 0; c < r.columns.size(); ++c) {
      if (!is_known(row.figures[c])) continue;
      const StudiedColumn& column = r.columns[c];
      const auto [from, to] = band_of(r, row.figures[c]);
      id.entries.push_back(id_of(row));
      motion.entries.push_back(row.motion);
      figure.entries.push_back(with_unit(column));
      low.entries.push_back(shown(column, from));
      high.entries.push_back(shown(column, to));
    }
  }
  return "\nBand of 95 %: what the logs of the axes above leave open of each figure\n" +
         lay_out({id, motion, figure, low, high});
}

Json limits(const sim::Confident& c) { return {number_or_null(c.low), number_or_null(c.high)}; }

}  // namespace

std::string text_table(const StudyResult& r) {
  std::string out = study_in_words(r) + ".\n";
  for (const StudiedFactor& f : r.factors)
    out += fmt::format("  {}: {}\n", clean_text(f.key), clean_text(f.distribution));
  out += tables(r) + band_table(r) + index_table(r);
  const std::vector<std::string> lost = lost_in_words(r);
  if (!lost.empty()) out += '\n' + joined(lost, "\n") + '\n';
  for (const std::string& warning : r.warnings) out += "Warning: " + warning + ".\n";
  return out;
}

nlohmann::ordered_json to_json(const StudyResult& r) {
  Json out;
  out["schema"] = "stribeck.study/1";
  out["machine"] = r.machine;
  out["sampling"] = enum_name(r.sampling);
  out["samples"] = r.samples;
  out["runs"] = r.runs;
  out["seed"] = r.seed;
  out["parameters"] = r.parameters;
  out["factors"] = Json::array();
  for (const StudiedFactor& f : r.factors)
    out["factors"].push_back({{"key", f.key}, {"distribution", f.distribution}});
  out["rows"] = Json::array();
  for (const StudiedRow& row : r.rows) {
    Json one;
    one["controller"] = row.controller;
    one["label"] = row.label;
    one["motion"] = row.motion;
    one["lost"] = row.lost;
    one["refused"] = row.refused;
    one["figures"] = Json::array();
    for (std::size_t c = 0; c < r.columns.size(); ++c) {
      const StudiedFigure& f = row.figures[c];
      if (!is_known(f)) continue;
      Json figure;
      figure["figure"] = r.columns[c].key;
      figure["nominal"] = row.nominal_lost ? Json(nullptr) : number_or_null(f.nominal);
      figure["mean"] = number_or_null(f.spread.mean());
      figure["sd"] = number_or_null(f.spread.deviation());
      figure["smallest"] = number_or_null(f.spread.smallest());
      figure["largest"] = number_or_null(f.spread.largest());
      figure["quantiles"] = Json::array();
      for (const double p : kStudyQuantiles) {
        const sim::Confident q = quantile_of(r, f, p);
        figure["quantiles"].push_back(
            {{"probability", p}, {"value", number_or_null(q.value)}, {"ci95", limits(q)}});
      }
      if (r.has_band) {
        const auto [from, to] = band_of(r, f);
        figure["band95"] = {number_or_null(from), number_or_null(to)};
      }
      figure["index_samples"] = f.index_samples;
      figure["indices"] = Json::array();
      for (std::size_t i = 0; i < f.indices.size(); ++i) {
        const sim::SobolIndex& s = f.indices[i];
        figure["indices"].push_back({{"factor", r.factors[i].key},
                                     {"first", number_or_null(s.first.value)},
                                     {"first_ci95", limits(s.first)},
                                     {"total", number_or_null(s.total.value)},
                                     {"total_ci95", limits(s.total)}});
      }
      one["figures"].push_back(std::move(figure));
    }
    out["rows"].push_back(std::move(one));
  }
  out["warnings"] = r.warnings;
  return out;
}

}  // namespace stribeck::report
