#pragma once
/// A whole configuration of LinuxCNC for a machine: INI, HAL, and what makes it run at once.
/// Real time: no.
/// Errors: InputError naming the machine file and its axes.

#include <stribeck/friction/axis_model.hpp>
#include <stribeck/sim/machine.hpp>
#include <stribeck/targets/linuxcnc/limits.hpp>
#include <stribeck/targets/linuxcnc/written_folder.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::targets::linuxcnc {

/// One axis of a configuration.
struct HalAxis {
  std::string letter;  ///< of LinuxCNC
  const sim::MachineAxis* machine = nullptr;
  DrivableLimits can;
  friction::AxisModel model;  ///< what its controllers know
};

struct Configuration {
  std::string name;          ///< of the machine
  std::string comment;       ///< how these files were made
  double sample_time = 0.0;  ///< [s]
  double omega = 0.0;        ///< [rad/s]
  std::string feedforward;   ///< empty: by the model
  std::vector<HalAxis> axes;
};

/// Letters of LinuxCNC for the axes of a machine; refuses names that it does not know and any that occur twice.
std::vector<std::string> linuxcnc_letters(const sim::Machine& machine, const std::string& file);

/// hal/play.py
extern const std::string_view kPlay;

/// Files of the configuration by name, and their texts.
NamedTexts configuration_files(const Configuration& c);

}  // namespace stribeck::targets::linuxcnc
