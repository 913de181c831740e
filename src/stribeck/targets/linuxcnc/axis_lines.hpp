#pragma once
/// A file of HAL lines: controllers or tables of axis files, or the virtual drives of a machine.
/// Real time: no. Errors: InputError naming the option or the file.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/sim/machine.hpp>
#include <stribeck/targets/target.hpp>
#include <string>

namespace stribeck::targets::linuxcnc {

/// Default double pole of the position loops.
inline constexpr const char* kOmega = "40 rad/s";

/// The value of --omega, else kOmega [rad/s].
double omega_of(const ExportRequest& request);

/// One stribeck_axis for each axis file.
std::string controllers(const ExportRequest& request);

/// One lincurve for each axis file; points and errors are added to `json` and, in words, to `words`.
std::string tables(const ExportRequest& request, nlohmann::ordered_json& json, std::string& words);

/// One stribeck_plant for each axis of a machine.
std::string plants(const ExportRequest& request, const sim::Machine& machine);

}  // namespace stribeck::targets::linuxcnc
