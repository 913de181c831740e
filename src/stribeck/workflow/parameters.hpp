#pragma once
/// Where the compensators' parameters come from: identified here, printed by the thesis, or axis files.

#include <map>
#include <stribeck/workflow/commission.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct ParameterOptions {
  std::string source = "identified";    ///< identified or thesis
  std::vector<std::string> axis_files;  ///< AXIS=FILE, overrides the source for that axis and kind of model
};

struct Parameters {
  std::vector<sim::AxisKnowledge> knowledge;  ///< per axis of the machine
  std::vector<CommissionedAxis> axes;         ///< per axis of the machine; empty unless identified
  std::string words;                          ///< where they come from
};
/// For the controllers' needs and the axes that they drive; other axes are left without knowledge.
Parameters get_parameters(const sim::Machine& machine, const std::string& path,
                          const ParameterOptions& options, const sim::CompareSpec& spec);

}  // namespace stribeck::workflow
