#pragma once
/// The motion of a machine of one's own: a circle, an eight or a trifolium laid into the middle of the travel of its axes, as fast as
/// they can with something in hand. One axis moves in a sine.
///
/// Real time: no.
/// Errors: InputError naming the option.

#include <stribeck/sim/compare.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// The axes that --axes names; empty: it was not given.
std::vector<std::size_t> named_axes(const sim::Machine& machine, const std::string& machine_file,
                                    const PathOptions& options);

/// Axes and travels, without controllers. Speeds left out: a tenth of what the axes can do, and all of it.
sim::CompareSpec own_motion(const sim::Machine& machine, const std::string& machine_file,
                            const PathOptions& options, const std::vector<std::string>& speeds);

/// Speeds along a path of points: a tenth of what those of its axes that do not turn can do with something in hand, and all of it. Empty
/// where all turn.
std::vector<double> own_speeds(const sim::Machine& machine, const std::vector<std::size_t>& axes);

}  // namespace stribeck::workflow
