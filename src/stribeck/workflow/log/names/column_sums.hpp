#pragma once
/// Quantities of --map that several columns give together. Internal to workflow/log.
/// Real time: no. Errors: InputError for columns that the log does not have or that cannot be added.

#include <stribeck/workflow/log/columns.hpp>
#include <string>

namespace stribeck::workflow {

/// "COLUMN + COLUMN", also with a unit behind it: a force that several motors make. The others are in `beside`.
NamedColumn named_sum(const io::Log& log, const std::string& text);

/// "COLUMN UNIT - COLUMN UNIT" or with +: a position from a command and its following error, in one column that is made. Units may differ.
NamedColumn named_difference(const io::Log& log, const std::string& text);

}  // namespace stribeck::workflow
