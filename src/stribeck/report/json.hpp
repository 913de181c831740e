#pragma once
/// Results for programs. Keys carry their unit, keep their order and do not change; a change raises the number in
/// "schema". A value that does not apply or is not known is null, never 0. Lists have one entry per axis. Numbers are not
/// rounded.
///
/// docs/reference/json.md lists every key of every verb.
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
