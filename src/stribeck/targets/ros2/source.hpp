#pragma once
/// The ros2_control controller that --to ros2_control writes beside its parameters, as it stands in ros2/; made by CMakeLists.txt of the module.
/// Real time: no.

#include <string_view>

namespace stribeck::targets {

extern const std::string_view kFrictionFeedforward;

}  // namespace stribeck::targets
