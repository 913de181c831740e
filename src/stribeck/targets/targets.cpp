#include <algorithm>
#include <array>

#include <stribeck/targets/target.hpp>

namespace stribeck::targets {

// Each is defined in the folder of its name. To add a target, enter its name in this line and in the list.
extern const Target kLinuxCnc;

namespace {

constexpr std::array<const Target*, 1> kTargets{&kLinuxCnc};

}  // namespace

std::span<const Target* const> all_targets() { return kTargets; }

const Target* find_target(std::string_view name) {
  const auto found =
      std::find_if(kTargets.begin(), kTargets.end(), [&](const Target* t) { return t->name == name; });
  return found == kTargets.end() ? nullptr : *found;
}

}  // namespace stribeck::targets
