#pragma once
/// `stribeck reproduce robustness`: controllers that know the biaxial table as it was identified, on machines that have drifted
/// from it (sim/robustness.hpp). Nothing of it was printed.
/// Real time: no. Errors: sim::Refused.

#include <cstdint>
#include <stribeck/report/pages/reproduction.hpp>
#include <stribeck/sim/study/robustness.hpp>
#include <string_view>

namespace stribeck::workflow {

inline constexpr std::string_view kRobustness = "robustness";
inline constexpr std::uint32_t kRobustMachines = 100;

/// Models to identify for these controllers: machine, axes, controllers.
sim::Experiment robustness_experiment(const sim::RobustnessSpec& spec);

/// Tables, percentiles against the first controller, and the share of machines below an error, drawn.
report::ReproducedSection robustness_section(const sim::RobustnessResult& result);

}  // namespace stribeck::workflow
