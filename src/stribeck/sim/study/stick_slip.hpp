#pragma once
/// The slowest speed that an axis keeps without stick-slip under a control law, in two ways.
///
/// By describing function. Friction under v = v0 + a·sin ωt answers with a part of the same frequency: a resistance
///
///   N(a, ω; v0) = F₁/a   [N s/m], complex; from the friction law itself, run over some periods
///
/// The loop without friction answers a force with the impedance Q = jωm·(1 + L). An oscillation of amplitude a grows where 1 + N/Q turns
/// about zero from the lowest to the highest frequency, as N is stable and the loop is. The axis sticks and slips at v0 if that is so
/// for any a: a falling curve makes N negative; bristles and everything that lags turn it.
///
/// By simulation. The axis follows a straight line at v0 under the law, the machine's true friction, delay and encoder, without noise.
/// It sticks where it moves at less than a tenth of v0, over five periods, in more than a twentieth of the second half of the run.
/// A run takes 5 to 20 s, as long as 0.2 mm take where that lies between. An encoder with coarse steps makes a slow axis stick too.
///
/// Both look at speeds in equal ratios, from the fastest down, and name the slowest above which every one is smooth.
/// Source: Armstrong-Hélouvry, Dupont, Canudas de Wit 1994, doi:10.1016/0005-1098(94)90209-7; Gelb, Vander Velde 1968.
/// Not modelled: friction that depends on the position; the other axes, which stand still in the simulation and are closed in L; frequencies
/// below π/T·10^−3.5, where an axis creeps; compensation that follows the measured velocity.
/// Real time: no. Errors: Refused of the law (loop_margins.hpp).

#include <cmath>
#include <complex>
#include <optional>
#include <stribeck/friction/model.hpp>
#include <stribeck/sim/contour_run.hpp>
#include <stribeck/sim/study/loop_margins.hpp>

namespace stribeck::sim {

/// N(a, ω; v0) of a friction model at position 0.
std::complex<double> friction_resistance(const friction::Model& model, double v0, double amplitude,
                                         double omega);

/// Whether friction makes a loop oscillate at v0; the loop must be stable without it.
bool oscillates(const LoopResponse& loop, double mass, const friction::Model& model, double v0);

/// Whether an axis sticks at v0 in the simulation. `line` has a path of these axes; its points are not used.
template <std::size_t N>
bool sticks(Drives& drives, const AnyController<N>& controller, const Route<N>& line, std::size_t axis,
            double v0);

/// Speeds that are looked at [m/s].
inline constexpr double kSlowestLooked = 20e-6;
inline constexpr double kFastestLooked = 20e-3;
inline constexpr int kLookedPerDecade = 8;

/// The slowest speed above which every one, up to the fastest, is smooth; absent: none is. smooth(v0) says whether v0 [m/s] is.
template <class Smooth>
std::optional<double> slowest_smooth(double fastest, Smooth smooth) {
  std::optional<double> slowest;
  const double decades = std::log10(std::fmin(fastest, kFastestLooked) / kSlowestLooked);
  for (int k = static_cast<int>(std::floor(decades * kLookedPerDecade + 1e-9)); k >= 0; --k) {
    const double v = kSlowestLooked * std::pow(10.0, static_cast<double>(k) / kLookedPerDecade);
    if (!smooth(v)) break;
    slowest = v;
  }
  return slowest;
}

/// Of one axis; absent: no speed that was looked at is smooth.
struct SmoothSpeed {
  std::optional<double> predicted{};  ///< by describing function [m/s]
  std::optional<double> simulated{};  ///< [m/s]
};

}  // namespace stribeck::sim
