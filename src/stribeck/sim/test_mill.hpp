#pragma once
/// A small mill built in code, for the tests of this folder: five axes that differ, LuGre over conventional friction, 1 ms.

#include <stribeck/sim/compare.hpp>
#include <stribeck/sim/experiments_beyond.hpp>

namespace stribeck::sim::test {

inline Machine mill(bool quantised = true) {
  Machine m;
  m.name = "mill";
  m.sample_time = 1e-3;
  for (std::size_t i = 0; i < 5; ++i) {
    const double n = static_cast<double>(i);
    MachineAxis a;
    a.plant.mass = 1000.0 - 100.0 * n;
    a.plant.drive = plant::CurrentDrive{25.0, {}};
    a.plant.encoder.resolution = quantised ? 50e-9 : 1e-12;
    a.plant.converter.bits = quantised ? 16 : 32;
    a.plant.friction.steady =
        friction::Conventional<double>{20.0 + n, 4e3, friction::Stribeck<double>{35.0 + n, 0.6e-3, 2.0}};
    a.plant.friction.dynamics = friction::LuGre<double>{8e6, 90e3, 0.05e-3};
    if (quantised) a.plant.noise = plant::ForceNoise{0.5, 9.5e-3};
    a.limits = {-150e-3, 150e-3, 80e-3, 0.4};
    m.axes.emplace_back(std::string(1, "xyzac"[i]), a);
  }
  return m;
}

/// Everything is known exactly except the bristles.
inline std::vector<AxisKnowledge> known(const Machine& m) {
  std::vector<AxisKnowledge> all;
  for (const auto& [name, axis] : m.axes) {
    AxisKnowledge k;
    k.conventional = friction::AxisModel{axis.plant.mass, axis.plant.load, axis.plant.friction};
    k.conventional->friction.dynamics = friction::Static{};
    k.eccentric = k.conventional;
    all.push_back(k);
  }
  return all;
}

}  // namespace stribeck::sim::test
