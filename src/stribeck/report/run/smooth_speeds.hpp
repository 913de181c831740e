#pragma once
/// The slowest speeds without stick-slip that `tune --stick-slip` finds: table, part of the page, JSON.
/// Real time: no.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/sim/study/tuning.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

/// Empty where none were looked for.
std::string smooth_speed_text(const sim::TuneResult& result);

/// A section of the page; nothing where none were looked for.
void add_smooth_speeds(Page& page, const sim::TuneResult& result);

/// [{"axis", "predicted_mm_per_s", "simulated_mm_per_s"}]; empty where the loop is not stable or there is none.
nlohmann::ordered_json smooth_speed_json(const std::vector<sim::SmoothSpeed>& speeds,
                                         const std::vector<std::string>& axes);

}  // namespace stribeck::report
