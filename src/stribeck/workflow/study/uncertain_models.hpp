#pragma once
/// Axes whose identified model is the machine of a study, and what its logs leave open (friction/uncertainty.hpp).
///
/// Inside workflow/study only. Real time: no.

#include <stribeck/sim/machine.hpp>
#include <stribeck/workflow/study/factors.hpp>
#include <stribeck/workflow/study/study_file.hpp>
#include <vector>

namespace stribeck::workflow {

/// The machine with the models of these files as the plants of the axes whose uncertainty is a factor: of each axis the last file that says
/// what its logs leave open. Pre-sliding that a model does not have stays that of the machine.
sim::Machine with_models(const sim::Machine& machine, const StudyFile& study,
                         const std::vector<std::size_t>& moved, const std::vector<KnownAxis>& known);

/// One factor for each deviation of the models of these axes. Throws InputError for an axis without a file that says them.
std::vector<BoundFactor> deviations_as_factors(const sim::Machine& machine,
                                               const std::vector<std::size_t>& axes,
                                               const std::vector<KnownAxis>& known);

/// Whether one of the factors is a deviation.
bool has_uncertainty(const std::vector<BoundFactor>& factors);

/// Changes the models by these draws of the factors that are deviations.
void deviate_models(sim::Machine& machine, const std::vector<BoundFactor>& factors,
                    const std::vector<double>& values);

}  // namespace stribeck::workflow
