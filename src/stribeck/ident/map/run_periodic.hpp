#pragma once
/// A term periodic in position over stretches of constant speed (steady_runs.hpp), fitted together with their means.
///
/// Inside ident only. Real time: no.

#include <optional>
#include <stribeck/friction/eccentric.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/map/steady_runs.hpp>
#include <vector>

namespace stribeck::ident::map {

/// Absent where the term explains too little. `period`: as in SteadyOptions.
std::optional<friction::Eccentric<double>> find_run_periodic(const std::vector<log::Record>& records,
                                                             const std::vector<SteadyRun>& runs,
                                                             const std::optional<double>& period);

}  // namespace stribeck::ident::map
