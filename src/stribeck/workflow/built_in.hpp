#pragma once
/// The files of machines/ and controllers/, compiled into the program, for verbs that bring their own.

#include <stribeck/sim/compare.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::workflow {

/// By the file's name without .toml; throws std::out_of_range when there is none, which is a fault of the program.
sim::Machine built_in_machine(std::string_view name);

/// Whether a machine file is the one that is built in, to the letter.
bool is_built_in(const std::string& file, std::string_view name);

/// Names of the controllers that are built in.
std::vector<std::string> built_in_controllers();

/// One of those, or a file.
sim::ControllerSpec read_controller(const std::string& file_or_name);

}  // namespace stribeck::workflow
