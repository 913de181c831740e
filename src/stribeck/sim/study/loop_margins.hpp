#pragma once
/// Margins of the loop that a control law closes, measured on the law itself, for any law.
///
///   C(z)   answer of the law's force to a short small error of the measured position, less the answer without; reference straight
///          on at constant speed. Integrators are differenced out: C = Σ Δ^q h_n z⁻ⁿ / (1 − z⁻¹)^q
///   P(z)   mass, force held over a period and late by the declared delay, first axial mode where one is declared; exact
///   L_i    loop of axis i broken at its force, the other axes closed:  1/[(I + C·P)⁻¹]_ii − 1,  and C·P where axes do not couple
///
///   phase margin   least |arg(−L)| where |L| = 1                  gain margin    least factor, up or down, to L = −1
///   delay margin   least (π + arg L)/ω where |L| = 1, in [0, 2π)/ω modulus       least |1 + L|
///
/// The tangent lies along each axis in turn, so that the gains along and across the path meet every drive. Stable: a small
/// error of the closed linear loop dies out. Unstable loops have the same distances with the sign turned: phase < 0, gain < 1,
/// delay 0. Switching with sgn counts with its describing function 4k/(πa) at a = 0.1 mm/s of the surface: 1 µm at 100 rad/s.
/// Sign: L = +C·P, C > 0 for a force against the error. Source: Åström, Murray 2008, Feedback Systems, 9.3; Skogestad,
/// Postlethwaite 2005, 8.5 (one loop at a time); Gelb, Vander Velde 1968 (describing function).
/// Not modelled: friction in the plant (viscous friction helps, pre-sliding stiffens), limits, adaptation of the friction model
/// (slow), what a law learned laps ago, frames turned between the axes, errors of the mass.
/// Real time: no. Errors: Refused where a law has no linear part or does not settle.

#include <array>
#include <complex>
#include <limits>
#include <optional>
#include <stribeck/control/laws.hpp>
#include <stribeck/plant/params.hpp>
#include <vector>

namespace stribeck::sim {

struct LoopMargins {
  bool stable = false;
  double phase = std::numeric_limits<double>::infinity();      ///< [rad]
  double gain = std::numeric_limits<double>::infinity();       ///< [1]; 2 is 6 dB
  double gain_up = std::numeric_limits<double>::infinity();    ///< the same, for more gain only
  double gain_down = std::numeric_limits<double>::infinity();  ///< the same, for less gain, as a divisor
  double delay = std::numeric_limits<double>::infinity();      ///< more delay that the loop bears [s]
  double modulus = std::numeric_limits<double>::infinity();
  double crossover = 0.0;  ///< highest frequency where |L| = 1 [rad/s]
  std::size_t axis = 0;    ///< with the least phase margin

  friend bool operator==(const LoopMargins&, const LoopMargins&) = default;
};

/// Further data of the drives, beside masses and delays of the setup: a first axial mode.
template <std::size_t N>
using DeclaredModes = std::array<std::optional<plant::AxialMode>, N>;

/// For the masses, period and delays of the setup. Its limits of force, adaptation and friction are not used.
template <std::size_t N>
LoopMargins loop_margins(const control::LawParams& law, const control::Setup<N>& setup,
                         const DeclaredModes<N>& modes = {});

/// The loop of one axis over frequency. Closed: L/(1 + L); what remains of a disturbance of the position: 1/(1 + L).
struct LoopResponse {
  std::size_t axis = 0;
  std::vector<double> omega;               ///< [rad/s] in equal ratios, up to half the sampling frequency
  std::vector<std::complex<double>> loop;  ///< L
  double nearest = std::numeric_limits<double>::infinity();  ///< least |1 + L| of these
};

/// Of every axis the loop, of those with the tangents that loop_margins() looks at, that comes nearest to −1.
template <std::size_t N>
std::array<LoopResponse, N> loop_responses(const control::LawParams& law, const control::Setup<N>& setup,
                                           const DeclaredModes<N>& modes = {});

/// The law with a straight line in place of sgn in its switching part, at the amplitude above.
control::LawParams linear_part(const control::LawParams& law);

}  // namespace stribeck::sim
