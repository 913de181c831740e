#pragma once
/// A complete configuration of LinuxCNC for a machine: INI, HAL, and programs so that it runs at once.
/// Real time: no.
/// Errors: InputError naming the machine file and its axes.

#include <stribeck/sim/machine.hpp>
#include <stribeck/targets/linuxcnc/hal_axis.hpp>
#include <stribeck/targets/linuxcnc/written_folder.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::targets::linuxcnc {

struct Configuration {
  std::string name;          ///< of the machine, safe on any line
  std::string made;          ///< how these files were made, on one line
  std::string comment;       ///< the same as lines of a comment
  double sample_time = 0.0;  ///< [s]
  double omega = 0.0;        ///< [rad/s]
  std::string feedforward;   ///< empty: by the model
  std::vector<HalAxis> axes;
};

/// LinuxCNC's letters for the axes of a machine; refuses names that LinuxCNC does not have, and names that occur twice.
std::vector<std::string> linuxcnc_letters(const sim::Machine& machine, const std::string& file);

/// Whether one stribeck_contour can control all axes.
bool has_contour(const Configuration& c);

// Its files: machine.ini with the screen, headless.ini without (ini.cpp); HAL (hal_files.cpp); G-code (gcode_programs.cpp).
std::string ini(const Configuration& c, bool screen);
std::string motion(const Configuration& c);
std::string axis_control(const Configuration& c);
std::string contour_control(const Configuration& c);
std::string pid_control(const Configuration& c, bool with_lincurve);
std::string record(const Configuration& c);
/// Whether the set-points are among the signals that it records: there is no room for those of many axes.
bool records_command(const Configuration& c);
std::string record_names(const Configuration& c);
std::string drives(const Configuration& c);
std::string demo(const Configuration& c);
std::string identify(const Configuration& c);

/// hal/play.py
extern const std::string_view kPlay;

/// Names and texts of the files of the configuration.
NamedTexts configuration_files(const Configuration& c);

}  // namespace stribeck::targets::linuxcnc
