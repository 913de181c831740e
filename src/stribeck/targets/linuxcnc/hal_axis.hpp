#pragma once
/// An axis of a configuration, in the units and words of LinuxCNC.
/// Real time: no.

#include <functional>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/path/five_axis.hpp>
#include <stribeck/sim/machine.hpp>
#include <stribeck/targets/linuxcnc/limits.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::targets::linuxcnc {

/// One axis of a configuration.
struct HalAxis {
  std::string letter;  ///< of LinuxCNC
  const sim::MachineAxis* machine = nullptr;
  DrivableLimits can;
  friction::AxisModel model;  ///< the model that its controllers know
  double radius =
      path::TiltingTable{}.radius;  ///< of a, b and c: where the machine file carries a rotary axis [m]
};

using Axes = std::vector<HalAxis>;

/// Whether LinuxCNC counts an axis of this name in degrees: a, b and c, small or capital.
bool counts_degrees(std::string_view axis);
/// Length [m] of one machine unit of an axis that is in no configuration: a millimetre, or a degree. An axis that a file calls rotary is
/// carried at 1 m; one of the letters a, b or c without that word at the radius of HalAxis.
double unit_of(std::string_view axis, bool rotary);
bool angular(const HalAxis& a);
/// Length [m] of one machine unit: a millimetre, or a degree at the radius of the axis.
double unit_of(const HalAxis& a);
/// Name of the machine unit, for people.
std::string_view unit_name(const HalAxis& a);
double in_units(const HalAxis& a, double metres);
std::string number(double x);
/// Home position of the axis, where the drive stands at the start [m]: zero, or the middle of a travel that does not contain zero.
double home_of(const HalAxis& a);
/// Letter as in G-code and INI.
std::string capital(const HalAxis& a);
/// Joins a text for every axis.
std::string each(const Axes& axes, const std::function<std::string(const HalAxis&, std::size_t)>& text);
/// "ax.x,ax.y"
std::string names(const Axes& axes, std::string_view prefix);

}  // namespace stribeck::targets::linuxcnc
