#pragma once
/// What a builder should know about the loops of a configuration before they close: supervision stops a machine whose loop is unfit.
///
///   unstable   the linear loop is, with the axial mode that the machine file declares (sim/study/loop_margins.hpp)
///   soft       at a reversal of friction the loop leaves its command farther than the axis moves in 1/ω at its largest speed:  2F₀/(m·ω²) > v/ω
///
///   F₀ level of friction at rest [N], m mass [kg], ω pole [rad/s], v largest speed [m/s]
/// Not modelled: modes that the machine file does not have; a mass or a friction that is off.
/// Real time: no.

#include <stribeck/targets/linuxcnc/configuration.hpp>

namespace stribeck::targets::linuxcnc {

/// One line for each of these loops, without a line break.
std::vector<std::string> loop_warnings(const Configuration& c);

}  // namespace stribeck::targets::linuxcnc
