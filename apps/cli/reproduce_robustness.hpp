#pragma once
/// `stribeck reproduce robustness`: controllers that know the biaxial table as it was identified, on machines that have drifted
/// from it (sim/robustness.hpp). Nothing of it was printed.
/// Real time: no. Errors: sim::Refused.

#include <cstdint>
#include <functional>
#include <stribeck/report/reproduction.hpp>
#include <stribeck/sim/robustness.hpp>
#include <string_view>
#include <vector>

namespace stribeck::cli {

inline constexpr std::string_view kRobustness = "robustness";
inline constexpr std::uint32_t kRobustMachines = 100;

/// What has to be identified for it: machine, axes, controllers.
sim::Experiment robustness_experiment();

/// The same for any number of threads (0: as many as there are).
report::ReproducedSection reproduce_robustness(const sim::Machine& machine,
                                               const std::vector<sim::AxisKnowledge>& knowledge,
                                               std::uint32_t machines, const sim::Variation& variation,
                                               std::uint64_t seed, unsigned threads,
                                               const std::function<void(std::size_t, std::size_t)>& progress);

/// Tables, percentiles against the first controller, and the share of machines below an error, drawn.
report::ReproducedSection robustness_section(const sim::RobustnessResult& result);

}  // namespace stribeck::cli
