#pragma once
/// What tune chose for: errors on the machines that the given one may be, and contour error against input variation.
///
///   json   controllers[].machines: [{"machine", "start_max_contour_error_um", "tuned_max_contour_error_um"}]
///          trade_off: [{"share", "input_variation_V": [per travel], "controllers": [{"controller", "missed": null or why,
///          "max_contour_error_um": [per travel] or null, "input_variation_V": [per travel] or null}]}]
///
/// Real time: no. Errors: none.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/sim/study/tuning.hpp>
#include <string>

namespace stribeck::report {

/// Tables of the errors on each machine; empty where tune looked at the given one alone.
std::string nearby_text(const sim::TuneResult& result);
nlohmann::ordered_json nearby_json(const sim::TunedController& controller);
void add_nearby(Page& page, const sim::TuneResult& result);

/// Empty where it was not looked for.
std::string trade_off_text(const sim::TradeOff& all, const sim::TuneSpec& spec);
nlohmann::ordered_json trade_off_json(const sim::TradeOff& all, const sim::TuneSpec& spec);
void add_trade_off(Page& page, const sim::TradeOff& all);

}  // namespace stribeck::report
