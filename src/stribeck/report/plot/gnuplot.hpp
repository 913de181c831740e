#pragma once
/// Runs gnuplot as a process of its own.
/// Real time: no. Errors: io::InputError when gnuplot is missing or refuses, with what to install.

#include <string>

namespace stribeck::report {

/// What gnuplot writes for a script. No settings of the user are read, and no file is left behind.
std::string run_gnuplot(const std::string& script);

}  // namespace stribeck::report
