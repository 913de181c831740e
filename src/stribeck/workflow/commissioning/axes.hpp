#pragma once
/// The axes of a machine file in a running LinuxCNC: which joint, which stribeck controller, which signals, which columns of a sampler.
///
///   joint      the place of the axis's letter in coordinates= of trivkins
///   controller the stribeck_axis or the axis of a stribeck_contour whose pos-cmd has the signal of joint.N.motor-pos-cmd
///   sampler    one that has command, encoder and force of every axis; where no sampler is loaded, one is loaded
///
/// Real time: no.
/// Errors: Stopped where the configuration cannot be commissioned, with what to change.

#include <stdexcept>
#include <string>
#include <vector>

#include <stribeck/workflow/commissioning/running_machine.hpp>
#include <stribeck/workflow/machine/description.hpp>

namespace stribeck::workflow::commissioning {

/// Why commissioning does not go on, and what to do.
struct Stopped : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Somebody pressed the emergency stop or switched the machine off: nothing is tried again.
struct StoppedByHand : Stopped {
  using Stopped::Stopped;
};

struct RunningAxis {
  std::string name;  ///< in the machine file, one of x y z u v w
  char letter = 'X';
  int joint = 0;
  std::string controller;   ///< prefix of its pins: "ax.x", "ct.0"
  std::string component;    ///< prefix of the pins that it shares: "ax.x", "ct"
  bool takes_force = true;  ///< false: a drive with a velocity or position loop
  sim::AxisLimits limits;   ///< of machine file and INI file, the narrower of both [m], [m/s]
  RoughAxis rough;
  double force_limit = 0.0;  ///< [N]
  double force_unit = 1.0;   ///< [N] of the force signal
  double resolution = 0.0;   ///< of the encoder [m]; 0: not known
  std::string command_signal;
  std::string encoder_signal;
  std::string force_signal;
};

struct RunningAxes {
  double unit = 1e-3;    ///< machine unit [m]
  double period = 1e-3;  ///< of the servo thread [s]
  int sampler = 0;
  std::vector<std::string> columns;  ///< signals of the sampler's pins
  std::vector<RunningAxis> axes;
  std::vector<std::string> warnings;

  [[nodiscard]] const RunningAxis& axis(const std::string& name) const;
  /// Column of a signal.
  [[nodiscard]] std::size_t column(const std::string& signal) const;
};

/// `only`: name of one axis; empty: all.
RunningAxes find_axes(RunningMachine& machine, const MachineDescription& description,
                      const std::string& only);

}  // namespace stribeck::workflow::commissioning
