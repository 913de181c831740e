/// A friction model in a few lines: Table 2.3 of the thesis, x axis, v ≥ 0, and LuGre over it.

#include <cstdio>
#include <stribeck/friction/gaussian.hpp>
#include <stribeck/friction/lugre.hpp>

int main() {
  using namespace stribeck::friction;
  Gaussian<double> map;
  map.positive = {768.6, 102.48e3, {}};
  map.positive.gaussians.push_back({517.4, 1.763e-3, 3.091e-3});
  map.positive.gaussians.push_back({509.3, 5.806e-3, 1.825e-3});
  map.positive.gaussians.push_back({1995.9, 10.668e-3, 1.876e-3});
  map.negative = {-768.6, 102.48e3, {}};
  map.velocity_range = {-9.5e-3, 9.5e-3};

  for (const double v : {0.5e-3, 5e-3, 9.5e-3})
    std::printf("%4.1f mm/s   %.1f N\n", v * 1e3, steady_force(map, v));

  // The first micrometres after a start, at 1 mm/s and a millisecond per step: friction builds up with the distance.
  const LuGre<double> law{3e8, 600e3, 0.05e-3};
  LuGre<double>::State bristle;
  for (int k = 1; k <= 10; ++k) std::printf("%4d um   %.1f N\n", k, law.step(map, bristle, 1e-3, 0.0, 1e-3));
}
