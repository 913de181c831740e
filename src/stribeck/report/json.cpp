#include <algorithm>
#include <nlohmann/json.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/json.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/table.hpp>

namespace stribeck::report {
namespace {

using io::Json;
using io::number_or_null;

constexpr double kMicro = 1e6;
constexpr double kMilli = 1e3;

/// Writes the metrics into an object, in the order that users know.
void write_metrics(Json& out, const sim::Metrics& m, std::size_t axes) {
  out["max_contour_error_um"] = number_or_null(m.max_contour_error * kMicro);
  out["quadrant_glitch_um"] = number_or_null(m.quadrant_glitch * kMicro);
  out["rms_um"] = number_or_null(m.rms * kMicro);
  out["sd_um"] = number_or_null(m.sd * kMicro);
  out["mean_abs_um"] = number_or_null(m.mean_abs * kMicro);
  out["power_W"] = number_or_null(m.power);
  out["mean_abs_ui_W"] = number_or_null(m.mean_abs_ui);
  out["input_variation_V"] = number_or_null(m.input_variation);
  Json tracking = Json::array();
  for (std::size_t i = 0; i < std::min(axes, m.mean_abs_tracking.size()); ++i) {
    tracking.push_back(number_or_null(m.mean_abs_tracking[i] * kMicro));
  }
  out["mean_abs_tracking_um"] = std::move(tracking);
}

Json interval(double low, double high) { return Json::array({number_or_null(low), number_or_null(high)}); }

}  // namespace

nlohmann::ordered_json to_json(const sim::CompareResult& result, std::string_view experiment) {
  Json out;
  out["schema"] = "stribeck.compare/1";
  out["machine"] = result.machine;
  out["experiment"] = experiment.empty() ? Json(nullptr) : Json(std::string(experiment));
  out["seed"] = result.spec.seed;
  out["trials"] = result.spec.trials;
  Json rows = Json::array();
  for (const sim::CompareRow& r : result.rows) {
    Json row;
    row["controller"] = r.controller.id;
    row["label"] = r.controller.label;
    row["speed_mm_per_s"] = r.speed > 0.0 ? number_or_null(r.speed * kMilli) : Json(nullptr);
    write_metrics(row, r.mean, result.axes.size());
    Json spread = Json::object();
    write_metrics(spread, r.spread, result.axes.size());
    row["spread"] = std::move(spread);
    row["solver"] = {{"substeps", r.substeps > 0 ? Json(r.substeps) : Json(nullptr)},
                     {"accuracy_nm", number_or_null(result.spec.accuracy * 1e9)}};
    rows.push_back(std::move(row));
  }
  out["rows"] = std::move(rows);
  out["warnings"] = status_warnings(result);
  return out;
}

nlohmann::ordered_json to_json(const ident::Result& result, std::string_view axis) {
  Json out;
  out["schema"] = "stribeck.identify/1";
  out["axis"] = axis.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(std::string(axis));
  out["model"] = result.model;
  out["mass_kg"] = number_or_null(result.mass);
  out["mass_ci95_kg"] = interval(result.mass_interval.low, result.mass_interval.high);
  out["velocity_range_mm_per_s"] =
      interval(result.velocity_range[0] * kMilli, result.velocity_range[1] * kMilli);
  Json parameters = Json::array();
  for (const ident::Parameter& p : result.parameters) {
    const ShownParameter s = shown(p);
    Json one;
    one["name"] = p.name;
    one["value"] = number_or_null(s.value);
    one["unit"] = s.unit;
    one["ci95"] = interval(s.low, s.high);
    one["identifiable"] = p.identifiable;
    parameters.push_back(std::move(one));
  }
  out["parameters"] = std::move(parameters);
  Json curve = Json::array();
  for (const ident::CurvePoint& c : result.curve) {
    Json one;
    one["velocity_mm_per_s"] = number_or_null(c.velocity * kMilli);
    one["friction_N"] = number_or_null(c.friction);
    one["ci95_N"] = interval(c.ci_low, c.ci_high);
    curve.push_back(std::move(one));
  }
  out["curve"] = std::move(curve);
  out["held_out_rms_N"] = number_or_null(result.held_out_rms);
  Json models = Json::array();
  for (const ident::Candidate& c : result.models) {
    Json one;
    one["name"] = c.name;
    one["terms"] = c.terms;
    one["parameters"] = c.parameters;
    one["held_out_rms_N"] = number_or_null(c.held_out_rms);
    one["standard_error_N"] = number_or_null(c.standard_error);
    one["chosen"] = c.chosen;
    models.push_back(std::move(one));
  }
  out["models"] = std::move(models);
  out["warnings"] = result.warnings;
  return out;
}

}  // namespace stribeck::report
