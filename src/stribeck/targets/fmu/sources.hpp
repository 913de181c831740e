#pragma once
/// The C sources of every FMU, as they stand in fmu/sources/; made by CMakeLists.txt of the module.
/// Real time: no.

#include <string_view>

namespace stribeck::targets {

extern const std::string_view kFrictionHeader, kFrictionSource, kFmiHeader, kFmiFunctions, kFmiUnused;

}  // namespace stribeck::targets
