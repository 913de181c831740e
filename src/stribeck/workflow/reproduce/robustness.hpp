#pragma once
/// `stribeck reproduce robustness`: controllers that know the identified biaxial table, on machines that have drifted from it
/// (sim/robustness.hpp). The thesis prints nothing on this.
/// Real time: no. Errors: sim::Refused.

#include <cstdint>
#include <stribeck/report/pages/reproduction.hpp>
#include <stribeck/sim/study/robustness.hpp>
#include <string_view>

namespace stribeck::workflow {

inline constexpr std::string_view kRobustness = "robustness";
inline constexpr std::uint32_t kRobustMachines = 100;

/// Machine, axes and controllers whose models must be identified.
sim::Experiment robustness_experiment(const sim::RobustnessSpec& spec);

/// Tables, percentiles relative to the first controller, and drawings of the share of machines below an error.
report::ReproducedSection robustness_section(const sim::RobustnessResult& result);

}  // namespace stribeck::workflow
