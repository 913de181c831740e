#pragma once
/// Experiments on future work of the thesis (§5.2): five axes, a cutting force, and the quadrant glitch that its best
/// controllers leave.
/// Real time: no.

#include <stribeck/sim/experiments.hpp>

namespace stribeck::sim {

Experiment five_axis();
Experiment milling();

/// The thesis's experiment, with its own controllers and with (g)…, on identified parameters: id "beyond-…".
Experiment beyond(const Experiment& thesis);

/// Controllers that learn from pass to pass, on the circle of the biaxial table.
Experiment passes(const Experiment& thesis);

}  // namespace stribeck::sim
