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
/// what its logs leave open. Pre-sliding that a model does not have, drive, encoder, noise,
/// delay, lost motion and ripple stay those of the machine.
sim::Machine with_models(const sim::Machine& machine, const StudyFile& study,
                         const std::vector<std::size_t>& moved, const std::vector<KnownAxis>& known);

/// One factor for each deviation of the models of these axes. Throws InputError for an axis without a file that says them.
std::vector<BoundFactor> deviations_as_factors(const sim::Machine& machine,
                                               const std::vector<std::size_t>& axes,
                                               const std::vector<KnownAxis>& known);

/// Whether all factors are deviations, so that the machines are what the logs leave open and nothing else.
bool only_uncertainty(const std::vector<BoundFactor>& factors);

/// All deviations as text: rows depend on them.
std::string deviations_text(const std::vector<BoundFactor>& factors);

/// A sentence for each axis whose logs do not tell the friction down to rest.
std::vector<std::string> untold_at_rest(const sim::Machine& machine, const std::vector<BoundFactor>& factors);

/// Changes the models by these draws of the factors that are deviations.
void deviate_models(sim::Machine& machine, const std::vector<BoundFactor>& factors,
                    const std::vector<double>& values);

}  // namespace stribeck::workflow
