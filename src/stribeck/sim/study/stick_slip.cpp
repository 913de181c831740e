#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/sim/study/stick_slip.hpp>
#include <variant>
#include <vector>

namespace stribeck::sim {

std::complex<double> friction_resistance(const friction::Model& model, double v0, double amplitude,
                                         double omega) {
  constexpr int kSteps = 96;
  constexpr int kRunIn = 2;  // periods
  const double dt = 2.0 * kPi / (omega * kSteps);
  return std::visit(
      [&](const auto& law) {
        typename std::decay_t<decltype(law)>::State state{};
        law.slide(state, std::copysign(model.parts(v0, 0.0).level, v0));
        std::complex<double> sum;
        for (int k = 0; k < kSteps * (kRunIn + 1); ++k) {
          const double during = v0 + amplitude * std::sin(omega * dt * (k + 0.5));
          law.advance(state, during, model.parts(during, 0.0).level, dt);
          if (k < kSteps * kRunIn) continue;
          const double angle = omega * dt * (k + 1.0);
          const double v = v0 + amplitude * std::sin(angle);
          const auto parts = model.parts(v, 0.0);
          const double force = law.bristle(state, v, parts.level, 1.0) + parts.viscous + parts.additive;
          sum += force * std::complex<double>(std::sin(angle), std::cos(angle));
        }
        return sum * (2.0 / (kSteps * amplitude));
      },
      model.dynamics);
}

bool oscillates(const LoopResponse& loop, double mass, const friction::Model& model, double v0) {
  // Small ones, and such as reverse the axis.
  constexpr std::array kAmplitudes{0.02, 0.2, 0.5, 0.8, 1.1, 1.5, 2.0, 3.0};
  for (const double share : kAmplitudes) {
    double turned = 0.0;
    std::complex<double> last;
    for (std::size_t k = 0; k < loop.omega.size(); ++k) {
      const double omega = loop.omega[k];
      const std::complex<double> impedance = std::complex<double>(0.0, omega * mass) * (1.0 + loop.loop[k]);
      const std::complex<double> now = 1.0 + friction_resistance(model, v0, share * v0, omega) / impedance;
      if (k > 0) turned += std::arg(now / last);
      last = now;
    }
    if (std::abs(turned) > kPi) return true;
  }
  return false;
}

template <std::size_t N>
bool sticks(Drives& drives, const AnyController<N>& controller, const Route<N>& line, std::size_t axis,
            double v0) {
  constexpr double kRadius = 10e-3;    // of the circle whose parameter the law gets [m]
  constexpr double kTravel = 0.2e-3;   // [m]
  constexpr double kShortest = 5.0;    // [s]
  constexpr double kLongest = 20.0;    // [s]
  constexpr std::size_t kOver = 5;     // periods
  constexpr std::size_t kAhead = 64;   // points for laws that look ahead
  constexpr double kStill = 0.1;       // of v0
  constexpr double kMostStill = 0.05;  // of the time
  const double period = drives.period();
  // Of the least power of two that is stable, twice as many: the answer is yes or no.
  int substeps = 8;
  while (substeps < kMostSubsteps && substeps < 2.0 * least_substeps(drives.rate_bound(), period))
    substeps *= 2;
  const auto ticks = static_cast<std::size_t>(std::clamp(kTravel / v0, kShortest, kLongest) / period);
  Route<N> route;
  route.path = line.path;
  path::PathPoint<N> point;
  for (std::size_t i = 0; i < N; ++i) {
    point.frame[i] = {};
    point.frame[i][(axis + i) % N] = 1.0;
  }
  point.velocity[axis] = v0;
  for (std::size_t k = 0; k < ticks + kAhead; ++k) {
    point.position[axis] = v0 * period * static_cast<double>(k);
    point.phi = point.position[axis] / kRadius;
    route.points.push_back(point);
  }
  std::vector<ContourSample> seen;
  drives.run<N>(controller, route, {substeps, true, false}, 1, 0, &seen);
  std::size_t still = 0;
  std::size_t all = 0;
  for (std::size_t k = ticks / 2; k + kOver < ticks; ++k) {
    const double moved = seen[k + kOver].position[axis] - seen[k].position[axis];
    still += moved < kStill * v0 * period * kOver ? 1 : 0;
    ++all;
  }
  return static_cast<double>(still) > kMostStill * static_cast<double>(all);
}

#define STRIBECK_INSTANTIATE(N) \
  template bool sticks<N>(Drives&, const AnyController<N>&, const Route<N>&, std::size_t, double);
STRIBECK_INSTANTIATE(1)
STRIBECK_INSTANTIATE(2)
STRIBECK_INSTANTIATE(3)
STRIBECK_INSTANTIATE(5)
#undef STRIBECK_INSTANTIATE

}  // namespace stribeck::sim
