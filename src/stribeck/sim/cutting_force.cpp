#include <stribeck/sim/cutting_force.hpp>

namespace stribeck::sim {

std::array<double, 2> CuttingForce::mean_over(double t, double period) const noexcept {
  const double middle = t + 0.5 * period;
  const double engaged = clamp_to(min_of((middle - entry) / ramp, (exit - middle) / ramp), 0.0, 1.0);
  if (engaged == 0.0) return {};
  // The mean of cos ωt over a period is its value in the middle, times sin(ωT/2)/(ωT/2).
  const auto fades = [&](double omega) {
    const double half = 0.5 * omega * period;
    return half > 0.0 ? std::sin(half) / half : 1.0;
  };
  const double turn = turn_frequency();
  const double tooth = turn * teeth;
  const double slow = 1.0 + run_out * fades(turn) * std::cos(turn * middle);
  const double p = tooth_passing * fades(tooth);
  const double h = second * fades(2.0 * tooth);
  return {engaged * along * (slow + p * std::cos(tooth * middle) + h * std::cos(2.0 * tooth * middle)),
          engaged * across * (slow + p * std::sin(tooth * middle) + h * std::sin(2.0 * tooth * middle))};
}

}  // namespace stribeck::sim
