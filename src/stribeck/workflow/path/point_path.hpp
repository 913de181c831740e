#pragma once
/// A path through points of a CSV file (path_file.hpp) as the path of an experiment, planned within the limits of the machine.
///
///   corners   straight lines, their corners rounded within the tolerance
///   spline    one smooth curve that passes the points within the tolerance
///
/// From rest at the first point to rest at the last one, at the speed asked for where the axes can follow it.
///
/// Real time: no.
/// Errors: InputError naming the file, the row or the option.

#include <stribeck/sim/compare.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// Sets travels, one for each speed [m/s], and axes of a spec from the file that --path names. Refuses what the machine cannot
/// travel.
void use_points(sim::CompareSpec& spec, const PathOptions& options, const std::vector<double>& speeds,
                const sim::Machine& machine);

}  // namespace stribeck::workflow
