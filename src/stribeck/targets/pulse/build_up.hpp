#pragma once
/// How a control should let the force of a table come and go around a reversal: the best of a list on the user's circle, on which both
/// axes are the identified one.
/// Real time: no.

#include <stribeck/targets/pulse/pulse_target.hpp>

namespace stribeck::targets {

TableForce best_build_up(const PulseTask& task, std::size_t axis, const std::function<double(double)>& force);

}  // namespace stribeck::targets
