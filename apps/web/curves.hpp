#pragma once
/// What the page draws of a comparison, thinned so that every peak stays, and what can be changed of a machine.
/// Real time: no.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/workflow/run/comparison.hpp>

namespace stribeck::web {

/// Adds "axes", "curves" (a controller each: time, reference, errors, forces, friction and velocity), "friction" (steady friction over
/// velocity: the truth and the models of the controllers).
void add_curves(nlohmann::ordered_json& json, const workflow::Comparison& comparison);

/// {"name", "origin", "axes", "sample_time_ms", "parameters": [{"key", "doc", "unit", "kind", "label", "main", "values":
/// {axis: number}}]}; kind: scale (a factor), number or count; main: what people turn first
nlohmann::ordered_json machine_form(const sim::Machine& machine);

}  // namespace stribeck::web
