#pragma once
/// Speed and acceleration that LinuxCNC may ask of an axis: what the drive has left beside friction and load.
/// Real time: no.

#include <stribeck/sim/machine.hpp>
#include <string>

namespace stribeck::targets::linuxcnc {

/// What LinuxCNC may ask of an axis.
struct DrivableLimits {
  sim::AxisLimits
      limits;  ///< those of the machine file, with speed and acceleration that its drive can follow
  double friction = 0.0;  ///< most that friction and load take up to that speed [N]
  double force = 0.0;     ///< that the drive has at that speed [N]
};

/// Speed and acceleration at once: friction, terms periodic in position, load and mass times acceleration within nine tenths of the
/// drive's force, of which the acceleration gets a fifth at least. A speed of zero: friction and load leave less than that at rest.
DrivableLimits drivable_limits(const sim::MachineAxis& axis);

/// Where these limits come from, as a comment.
std::string limits_words(const DrivableLimits& d, const sim::MachineAxis& axis);

}  // namespace stribeck::targets::linuxcnc
