#pragma once
/// Runs gnuplot as a separate process.
/// Real time: no. Errors: io::InputError when gnuplot is missing (with what to install) or fails.

#include <string>

namespace stribeck::report {

/// Returns the output of gnuplot for a script. Settings of the user are not read, and no file is left behind.
std::string run_gnuplot(const std::string& script);

}  // namespace stribeck::report
