#pragma once
/// The friction of axes as the two texts of an FMU that hold its numbers: sources/axes.h and modelDescription.xml.
///
/// Numbers are written with 17 digits, so that the FMU has those of the axis file.
/// Real time: no.

#include <stribeck/targets/steady/steady_target.hpp>
#include <string>
#include <vector>

namespace stribeck::targets {

struct FmuTexts {
  std::string identifier;   ///< name of the model in C and of the binary
  std::string axes;         ///< sources/axes.h
  std::string description;  ///< modelDescription.xml
};

/// sources: the text of the other sources, which the token must tell apart as well.
FmuTexts fmu_texts(const std::vector<Axis>& axes, const std::string& command, const std::string& sources);

}  // namespace stribeck::targets
