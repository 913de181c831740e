#pragma once
/// A LinuxCNC that runs on this computer, through its Python module, halcmd and halsampler (docs/decisions/0019-linuxcnc-bridge.md).
///
/// A program in Python stands between (linuxcnc_bridge.py): it answers lines of JSON, and stops the machine when this program ends, for
/// whatever reason, while something moves.
/// Real time: no.
/// Errors: MachineError, InputError for an INI file that cannot be read.

#include <memory>
#include <string>

#include <stribeck/workflow/commissioning/running_machine.hpp>

namespace stribeck::workflow::commissioning {

/// Connects to the LinuxCNC that was started with this INI file; refused where another one runs.
std::unique_ptr<RunningMachine> running_linuxcnc(const std::string& ini);

}  // namespace stribeck::workflow::commissioning
