#pragma once
/// A part program as the path of an experiment: read by LinuxCNC's interpreter, planned within the limits of the machine.
/// Real time: no. Errors: InputError.

#include <stribeck/sim/compare.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <string>

namespace stribeck::workflow {

/// Sets travel and axes of a spec from the program that --path names. Refuses what the machine cannot travel: unknown axes, places
/// outside its travel.
void use_part(sim::CompareSpec& spec, const PathOptions& options, const sim::Machine& machine,
              const std::string& machine_file);

/// Summary of the planned path in sentences that end in a line break; empty where the path is no part. What is not known of the
/// program is a warning.
std::string part_words(const sim::CompareSpec& spec);

}  // namespace stribeck::workflow
