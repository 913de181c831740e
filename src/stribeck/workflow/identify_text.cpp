#include <fmt/format.h>
#include <algorithm>
#include <nlohmann/json.hpp>

#include <stribeck/ident/drive/smoothing/before_filter.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/replay/model_force.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/json.hpp>
#include <stribeck/report/lost_motion/lost_motion_report.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/workflow/identify_text.hpp>

namespace stribeck::workflow {
namespace {

/// Names and SI units, in the order of the law.
std::vector<std::pair<std::string, std::string>> published_names(bool by_direction) {
  if (by_direction) return {{"M", "kg"}, {"Fv+", "N s/m"}, {"Fc+", "N"}, {"Fv-", "N s/m"}, {"Fc-", "N"}};
  return {{"M", "kg"}, {"Fv", "N s/m"}, {"Fc", "N"}, {"offset", "N"}};
}

nlohmann::ordered_json published_json(const ident::methods::IdimResult::Published& p, bool by_direction) {
  nlohmann::ordered_json json;
  const auto names = published_names(by_direction);
  for (std::size_t i = 0; i < names.size(); ++i) {
    json["parameters"].push_back(
        {{"name", names[i].first}, {"value", p.value[i]}, {"sd", p.deviation[i]}, {"unit", names[i].second}});
  }
  json["error_norm_N"] = p.error_norm;
  json["relative_error_percent"] = 100.0 * p.relative_error;
  json["error_sd_N"] = p.error_deviation;
  json["condition"] = p.condition;
  return json;
}

/// The figures as papers print them; their deviations assume white residuals.
std::string published_text(const ident::methods::IdimResult::Published& p, bool by_direction) {
  std::string out = "\nAs the published protocol prints it (standard deviations for white residuals):\n";
  const auto names = published_names(by_direction);
  for (std::size_t i = 0; i < names.size(); ++i) {
    out += fmt::format("  {:<7}{:10.4f} ({:.4f}) {}\n", names[i].first, p.value[i], p.deviation[i],
                       names[i].second);
  }
  return out +
         fmt::format(
             "  error: norm {:.4f} N, relative {:.4f} %, standard deviation {:.4f} N; condition {:.4f}\n",
             p.error_norm, 100.0 * p.relative_error, p.error_deviation, p.condition);
}

std::string model_a_text(const ident::methods::LeastSquaresA& a) {
  std::string out = fmt::format(
      "\nMass by the printed forward Euler form: {:.4g} N s2/mm; by simple least squares, without Coulomb "
      "friction: {:.4g} N s2/mm.\n",
      a.mass_euler * 1e-3, a.simple_mass * 1e-3);
  const auto line = [&](const char* name, const std::optional<ident::methods::ViscousCorrection>& c) {
    if (!c) return;
    out += fmt::format(
        "Viscous coefficient corrected by jogging, {}: {:.5g} N s/mm (95 %: {:.5g} … {:.5g}), Coulomb "
        "{:.5g} and {:.5g} N",
        name, c->alpha2 * 1e-3, c->alpha2_interval.low * 1e-3, c->alpha2_interval.high * 1e-3,
        c->alpha0_positive, c->alpha0_negative);
    if (c->stribeck)
      out += fmt::format(", static {:.5g} N, v0 {:.3g} mm/s", c->stribeck->alpha1, c->stribeck->v0 * 1e3);
    out += ".\n";
  };
  line("disturbance observer", a.observer);
  line("Kalman", a.kalman);
  return out;
}

nlohmann::ordered_json quality_json(const ident::residual::Quality& q) {
  using io::number_or_null;
  nlohmann::ordered_json out = {{"r_squared", number_or_null(q.r_squared)},
                                {"residual_rms", number_or_null(q.rms)},
                                {"residual_rms_unfiltered", number_or_null(q.raw_rms)},
                                {"friction_rms", number_or_null(q.friction_rms)},
                                {"low_pass_Hz", number_or_null(q.cut_off)},
                                {"strongest_line", nullptr}};
  if (q.strongest)
    out["strongest_line"] = {{"frequency_Hz", number_or_null(q.strongest->frequency)},
                             {"amplitude", number_or_null(q.strongest->amplitude)}};
  return out;
}

/// Whether friction by direction was asked for in the published protocol: then there are five numbers, else four.
bool by_direction(const ident::methods::IdimResult::Published& published) {
  return published.value.size() > 4;
}

/// Measured and modelled force of the longest record; absent: the result is no model of the force.
std::optional<report::ForceOverTime> force_over_time(const Identification& found, const AxisRecords& axis) {
  if (!found.quality || found.holding_only || !(found.result.mass > 0.0) || axis.records.empty()) return {};
  const auto longest = std::max_element(
      axis.records.begin(), axis.records.end(),
      [](const ident::log::Record& a, const ident::log::Record& b) { return a.x.size() < b.x.size(); });
  try {
    ident::log::Record record = *longest;
    std::string source = record.source;
    if (found.result.filter) {
      ident::drive::take_off(*found.result.filter, record);
      source += ", before the filter of the drive,";
    }
    if (found.elastic) {
      take_off(*found.elastic, ident::residual::shift_in_rows(found.result, record.sample_time), record);
      source += ", less that of the spring between motor and table,";
    }
    const ident::replay::ForceError e = ident::replay::force_error(as_model(found.result), record);
    report::ForceOverTime force{source, {}, e.measured, e.modelled};
    for (const std::size_t row : e.row) force.t.push_back(longest->t[row]);
    if (force.t.empty()) return {};
    return force;
  } catch (const ident::Refused&) {
    return {};  // too short for the filters of the comparison
  }
}

}  // namespace

nlohmann::ordered_json to_json(const Identification& found, const std::string& axis) {
  const ident::Result& result = found.result;
  auto json = report::to_json(result, axis);
  if (found.quality) json["quality"] = quality_json(*found.quality);
  if (found.lost_motion) json["lost_motion"] = report::lost_motion_json(*found.lost_motion);
  if (found.published) json["published"] = published_json(*found.published, by_direction(*found.published));
  if (result.peaks) json["peaks"] = {{"positive", (*result.peaks)[0]}, {"negative", (*result.peaks)[1]}};
  if (found.model_a) {
    json["forward_euler_mass_kg"] = found.model_a->mass_euler;
    json["simple_least_squares_mass_kg"] = found.model_a->simple_mass;
  }
  for (const ident::Result& other : found.beside) json["beside"].push_back(report::to_json(other, axis));
  return json;
}

std::string text_of(const Identification& found, const std::string& axis) {
  const ident::Result& result = found.result;
  std::string out = report::text_table(result, axis);
  if (found.quality && found.quality->rows > 0)
    out += '\n' + ident::residual::in_words(*found.quality, result.rotary ? "N m" : result.force_unit) + '\n';
  if (found.lost_motion) out += report::lost_motion_text(*found.lost_motion);
  for (const ident::Result& other : found.beside) out += report::text_table(other, axis);
  if (result.peaks && found.result.method == Method::kVelocityMap) {
    out += fmt::format(
        "\nPeaks of the smoothed map, by which the thesis chooses the number of "
        "terms: {} for v > 0, {} for v < 0.\n",
        (*result.peaks)[0], (*result.peaks)[1]);
  }
  if (found.model_a) out += model_a_text(*found.model_a);
  if (found.published) out += published_text(*found.published, by_direction(*found.published));
  return out;
}

report::IdentifyReportInput page_of(const Identification& found, const AxisRecords& axis) {
  report::IdentifyReportInput page;
  page.axis = axis.axis;
  page.results = {found.result};
  page.results.insert(page.results.end(), found.beside.begin(), found.beside.end());
  page.source = axis.sources;
  page.quality = found.quality;
  page.lost_motion = found.lost_motion;
  page.force = force_over_time(found, axis);
  return page;
}

}  // namespace stribeck::workflow
