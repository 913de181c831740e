#pragma once
/// Finds runs that look as if they were measured on different days.
///
/// From day to day, friction of one axis changes by more than the friction curve changes between two speeds. When the slow
/// runs come from one day and the fast ones from another, an identification takes the difference for a low-speed term.
///
/// The steady runs of each direction are ordered by speed. Two groups are separated by the duration or the sampling time of
/// their runs. They are reported when, at equal positions, the mean force jumps between the groups by far more than between
/// neighbouring speeds within a group.
///
/// Not modelled: days that differ in friction alone.
/// Real time: no.

#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/log/record.hpp>
#include <vector>

namespace stribeck::ident::log {

/// At most one finding, of kind "mixed-runs".
std::vector<Finding> warn_of_mixed_runs(const std::vector<Record>& records);

}  // namespace stribeck::ident::log
