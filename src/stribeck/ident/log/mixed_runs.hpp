#pragma once
/// Runs that look like different days of measurement.
///
/// Friction of one axis changes from day to day by more than the friction curve bends between two speeds. When the slow
/// runs come from one day and the fast ones from another, an identification makes a low-speed term of the difference.
///
/// Steady runs of each direction are ordered by speed. Two groups are told apart by the duration or the sampling time of
/// their runs; they are reported when the mean force at the same positions jumps between them by far more than between
/// neighbouring speeds within the groups.
///
/// Not modelled: days that differ in nothing but friction.
/// Real time: no.

#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/log/record.hpp>
#include <vector>

namespace stribeck::ident::log {

/// At most one finding, of kind "mixed-runs".
std::vector<Finding> warn_of_mixed_runs(const std::vector<Record>& records);

}  // namespace stribeck::ident::log
