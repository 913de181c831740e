#pragma once
/// The shared library of an FMU, made by the C compiler of this machine where there is one.
/// Real time: no.

#include <stribeck/targets/fmu/zip.hpp>
#include <string>

namespace stribeck::targets {

struct FmuBinary {
  std::string platform;  ///< folder of the binary after FMI 3.0: x86_64-linux
  std::string bytes;     ///< empty: there is none
  std::string why_not;
};

/// sources: names and texts of one folder. The compiler is that of the environment variable CC, or cc.
FmuBinary fmu_binary(const std::string& identifier, const std::vector<ZipFile>& sources);

}  // namespace stribeck::targets
