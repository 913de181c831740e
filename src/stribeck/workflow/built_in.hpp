#pragma once
/// The files of machines/ and controllers/, which are compiled into the program.
/// Real time: no.

#include <stribeck/sim/compare.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::workflow {

/// The machine with this file name (without .toml). Throws std::out_of_range for an unknown name, which is an error of the caller.
sim::Machine built_in_machine(std::string_view name);

/// Names of the machines that are built in.
std::vector<std::string> built_in_machines();

/// Whether a machine file has exactly the text of the built-in one.
bool is_built_in(const std::string& file, std::string_view name);

/// Names of the controllers that are built in.
std::vector<std::string> built_in_controllers();

/// A built-in controller, or one from a file.
sim::ControllerSpec read_controller(const std::string& file_or_name);

}  // namespace stribeck::workflow
