#include <algorithm>
#include <array>

#include <stribeck/sim/parallel.hpp>
#include <stribeck/targets/pulse/build_up.hpp>

namespace stribeck::targets {

namespace {

constexpr std::array kDistances{0.0,   1e-6,  2e-6,  3e-6,  5e-6,   7e-6,  10e-6,
                                15e-6, 20e-6, 30e-6, 50e-6, 100e-6, 200e-6};
constexpr std::array kCycles{0.0, 1.0, 2.0, 3.0, 4.0};  // the ISG kernel takes no more

}  // namespace

TableForce best_build_up(const PulseTask& t, std::size_t axis, const std::function<double(double)>& force) {
  const std::array known{t.axes[axis], t.axes[axis]};
  const CircleAxes axes{machine_of(known, t.period), known, t.loop};
  std::array<double, kDistances.size() * kCycles.size()> cost{};
  const auto at = [&](std::size_t i) {
    return TableForce{force, kDistances[i / kCycles.size()], t.period * kCycles[i % kCycles.size()]};
  };
  sim::parallel_for(
      kDistances.size(), 0, [] { return 0; },
      [&](int, std::size_t d) {
        // The part of a circle with a reversal of each axis.
        constexpr double kLaps = 0.6;
        Circle circle(axes, t.radius, t.feed, kLaps);
        for (std::size_t k = 0; k < kCycles.size(); ++k) {
          const std::size_t i = d * kCycles.size() + k;
          const CircleError e = circle.with(std::array{at(i), at(i)});
          cost[i] = e.quadrant + e.largest;
        }
      });
  return at(static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin()));
}

}  // namespace stribeck::targets
