#pragma once
/// Speed and acceleration that LinuxCNC may use on an axis: the drive's reserve beside friction and load.
/// Real time: no.

#include <stribeck/sim/machine.hpp>
#include <string>

namespace stribeck::targets::linuxcnc {

/// Limits for LinuxCNC on an axis.
struct DrivableLimits {
  sim::AxisLimits
      limits;  ///< those of the machine file, with speed and acceleration that its drive can follow
  double friction = 0.0;  ///< largest force of friction and load up to that speed [N]
  double force = 0.0;     ///< force of the drive at that speed [N]
};

/// Speed and acceleration together: friction, terms periodic in position, load, and mass times acceleration stay within nine tenths of
/// the drive's force; acceleration gets at least a fifth of that. The speed is zero where friction and load leave less at rest.
DrivableLimits drivable_limits(const sim::MachineAxis& axis);

/// Origin of these limits, as a comment.
std::string limits_words(const DrivableLimits& d, const sim::MachineAxis& axis);

}  // namespace stribeck::targets::linuxcnc
