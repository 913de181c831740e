#pragma once
/// The same virtual machine with drives that take another kind of command, to see what each interface costs.
/// Real time: no.

#include <stribeck/sim/machine.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::workflow {

/// force; velocity and position; the same with a force offset beside the command.
std::vector<std::string> drive_modes();

/// Gives every axis a drive of this mode; "force" takes its loops away. The loops are those of a usual servo drive: velocity loop of
/// 200 Hz bandwidth for the axis's mass, integral time 10 ms, cycles of 250 µs, one of them delay, K_v = 60 1/s with whole velocity
/// feed-forward, a motor encoder of 24 bit on 10 mm, the force reported.
void set_drive_mode(sim::Machine& machine, std::string_view mode);

}  // namespace stribeck::workflow
