#pragma once
/// V2 built in code, for the tests of this folder: Table 2.3 under LuGre, and what the thesis printed of it.

#include <stribeck/friction/test_maps.hpp>
#include <stribeck/sim/compare.hpp>

namespace stribeck::sim::test {

inline Machine biaxial_table() {
  Machine m;
  m.name = "biaxial table";
  m.sample_time = 5e-3;
  for (const bool y : {false, true}) {
    MachineAxis a;
    a.plant.mass = y ? 58930.0 : 57650.0;
    a.plant.drive = plant::CurrentDrive{1048.0, {}};
    a.plant.encoder.resolution = 25e-9;
    a.plant.friction.steady = y ? friction::test::table_2_3_y() : friction::test::table_2_3_x();
    a.plant.friction.dynamics = friction::LuGre<double>{3e8, 600e3, 0.05e-3};
    a.plant.noise = plant::ForceNoise{20.0, 47e-3};
    a.limits = {-75e-3, 75e-3, 20e-3, 0.2};
    a.commissioning = {55000.0, 1300.0, 40.0, 20.0, -20e-3, 20e-3, 0.475};
    m.axes.emplace_back(y ? "y" : "x", a);
  }
  return m;
}

/// The printed parameters: Tables 2.1 and 2.3.
inline std::vector<AxisKnowledge> printed() {
  std::vector<AxisKnowledge> k(2);
  for (auto& axis : k) {
    axis.conventional.emplace();
    axis.gaussian.emplace();
  }
  k[0].conventional->mass = k[0].gaussian->mass = 57650.0;
  k[1].conventional->mass = k[1].gaussian->mass = 58930.0;
  k[0].conventional->friction.steady = friction::Conventional<double>{1255.38, 105.54e3, {}};
  k[1].conventional->friction.steady = friction::Conventional<double>{1066.05, 138.86e3, {}};
  k[0].gaussian->friction.steady = friction::test::table_2_3_x();
  k[1].gaussian->friction.steady = friction::test::table_2_3_y();
  return k;
}

/// Laps of a circle of 10 mm.
inline Travel circle(double speed, double laps = 2.0, path::Shape shape = path::Shape::kCircle) {
  Travel t;
  t.path = path::Curve{shape, 10e-3};
  t.speed = speed;
  t.laps = laps;
  return t;
}

inline CompareSpec bi_table() {
  CompareSpec s;
  for (const double speed : {3e-3, 9.5e-3}) s.travels.push_back(circle(speed));
  s.controllers = biaxial_controllers();
  return s;
}

}  // namespace stribeck::sim::test
