#pragma once
/// What a model misses of the force of a log, where one quantity explains most of it: a load, a mass, a spring, Coulomb or viscous friction.
///
/// The residual is fitted by each of these alone, and by the whole force, as a wrong scale makes it. One with at least half of its squares is named, with its size; of a sine, a mass
/// and a spring look the same.
/// Not modelled: two of them at once. Real time: no. Errors: none.

#include <stribeck/friction/axis_model.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/replay/model_force.hpp>
#include <string>

namespace stribeck::workflow {

/// A sentence; empty: the model misses little of the force, or nothing alone explains it.
std::string missed_in_words(const std::string& file, const friction::AxisModel& model,
                            const ident::replay::ForceError& error, const ident::log::Record& record);

}  // namespace stribeck::workflow
