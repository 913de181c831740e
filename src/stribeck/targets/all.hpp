#pragma once
/// --to all: every target that the given options suffice for, each into its own file of a folder, with their errors side by side.
/// Real time: no.
/// Errors: InputError naming the option or the file.

#include <stribeck/targets/target.hpp>

namespace stribeck::targets {

Exported write_all(const ExportRequest& request);

}  // namespace stribeck::targets
