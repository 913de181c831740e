#pragma once
/// What a machine file says of an axis that its axis file takes over: the drive, its loop, the period of the control. Exports then need
/// not be told it again.
/// Real time: no.

#include <optional>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/workflow/machine/description.hpp>
#include <string_view>

namespace stribeck::workflow {

struct OfMachineFile {
  std::optional<friction::DriveNumbers> drive{};
  std::optional<friction::DriveLoop> drive_loop{};
  std::optional<double> control_period{};  ///< [s]
};

/// Of an axis that exists. The loop is that of drive_loop, or of plant.drive_loop, whose settings a user can read in the drive.
OfMachineFile of_machine_file(const MachineDescription& machine, std::string_view axis);

}  // namespace stribeck::workflow
