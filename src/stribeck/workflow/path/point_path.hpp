#pragma once
/// A path through points of a CSV file (path_file.hpp) as the path of an experiment, planned within the limits of the machine.
///
///   corners   straight lines, their corners rounded within the tolerance
///   spline    one smooth curve that passes the points within the tolerance
///
/// The motion begins at rest at the first point and ends at rest at the last one. Its speed is the one asked for, or less where an
/// axis cannot follow.
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
