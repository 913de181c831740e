#pragma once
/// A part program as the path of an experiment: read by LinuxCNC's interpreter, planned within the limits of the machine.

#include <stribeck/sim/compare.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <string>

namespace stribeck::workflow {

/// Sets travel and axes of a spec from the program that --path names. Refuses what the machine cannot travel: axes that it does
/// not have, places outside its travel.
void use_part(sim::CompareSpec& spec, const PathOptions& options, const sim::Machine& machine,
              const std::string& machine_file);

/// What was made of the program, in sentences that end in a line; empty where the path is none. What cannot be known of it is among
/// the warnings.
std::string part_words(const sim::CompareSpec& spec);

}  // namespace stribeck::workflow
