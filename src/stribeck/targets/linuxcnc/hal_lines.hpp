#pragma once
/// HAL lines that set the parameters of this project's components, for one instance each.
/// Real time: no.

#include <array>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/sim/machine.hpp>
#include <string>
#include <string_view>

namespace stribeck::targets::linuxcnc {

/// setp lines for one instance of each component.
std::string controller_lines(const std::string& name, const friction::AxisModel& model, double omega,
                             const std::string& feedforward);
/// Supervision of everything (docs/guides/faults.md), within the limits that the machine file has for this axis.
std::string supervision_lines(const std::string& name, const sim::MachineAxis& axis);
/// What a parameter of a controller is before it is set, by its name in HAL ("friction.conventional.alpha0"); NaN: absent, or no such
/// parameter. A controller refuses a parameter of a kind that is not chosen unless it has this value.
double initial_value(std::string_view parameter);
std::string plant_lines(const std::string& name, const sim::MachineAxis& axis);
std::string setp(const std::string& component, std::string_view parameter, double value,
                 std::string_view word = {});

}  // namespace stribeck::targets::linuxcnc
