#pragma once
/// Results for programs. Keys carry their unit, keep their order and do not change; a change raises the number in
/// "schema". A value that does not apply or is not known is null, never 0. Lists have one entry per axis. Numbers are not
/// rounded.
///
///   compare    {"schema": "stribeck.compare/1", "machine", "experiment", "seed", "trials", "rows":
///   [{"controller",
///              "label", "speed_mm_per_s", the metrics, "spread": {the metrics}, "cutting": {"truth", "estimate", …} under a cutting force, "solver": {"substeps",
///              "accuracy_nm"}}]}
///   metrics    max_contour_error_um, quadrant_glitch_um, rms_um, sd_um, mean_abs_um, power_W, mean_abs_ui_W,
///              mechanical_power_W, input_variation_V, mean_abs_tracking_um: [x, y], max_orientation_error_urad,
///              mean_orientation_error_urad (of the tool axis; null without one)
///   identify   {"schema": "stribeck.identify/1", "axis", "method", "model", "force_unit", "position_unit", "mass_kg",
///              "mass_ci95_kg", "load_N", "velocity_range_mm_per_s",
///              "curve_from_mm_per_s", "rows",
///              "parameters": [{"name", "value", "unit", "ci95", "identifiable"}],
///              "curve": [{"velocity_mm_per_s", "friction_N", "ci95_N"}], "held_out_rms_N",
///              "models": [{"name", "terms", "parameters", "held_out_rms_N", "standard_error_N", "chosen"}],
///              "friction": {"steady", "eccentric", "dynamics"} as in an axis file, each quantity {"value",
///              "unit"}, "break_away_um", "cannot_tell": [...], "warnings": [...]}
///
/// Parameters have the unit for people (N s/mm); the mass also has kg. A log without a scale is identified in its own unit,
/// "force_unit": "A" or "position_unit": "rad". A key whose unit would then be wrong is null, and the number has a key of the
/// same name without the unit, in force_unit, position_unit and s: "mass_kg": null, "mass": 0.5.
/// Real time: no.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/sim/compare.hpp>
#include <string_view>

namespace stribeck::report {

/// Pass an empty text for no experiment.
nlohmann::ordered_json to_json(const sim::CompareResult& result, std::string_view experiment = {});

nlohmann::ordered_json to_json(const ident::Result& result, std::string_view axis);

}  // namespace stribeck::report
