#pragma once
/// Experiments on what the thesis leaves to future work (§5.2): five axes, and a cutting force.
/// Real time: no.

#include <stribeck/sim/experiments.hpp>

namespace stribeck::sim {

Experiment five_axis();
Experiment milling();

}  // namespace stribeck::sim
