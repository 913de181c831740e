#pragma once
/// Margins of a position loop on a measured response of the axis, the fastest loop that keeps them, and a notch where one helps.
///
///   L(ω) = C·N·G     C = m·(ω0² + 2·ω0·(1 − z⁻¹)/T), z = exp(jωT): control::Gains::critical(ω0) on the sampled error
///   N = (s² + 2·d·ζ·ωn·s + ωn²)/(s² + 2·ζ·ωn·s + ωn²), made discrete by Tustin with its middle kept; d depth, 2ζ·ωn width
///
///   phase margin   least |arg(−L)| where |L| = 1, negative of an unstable loop
///   gain margin    least factor to L = −1, up or down
///   stable         L passes left of −1 as often upwards as downwards (Nyquist), from the first line on, where L is below −1
///
/// G comes with the 95 % half width h of each frequency. "Sure" margins are those at the worse edge of the interval: the phase less
/// asin h, the gain less a factor 1 + h. A loop is proposed by its sure margins only, and only where L crosses 1 and −180° within the
/// measured frequencies, or falls below a half there.
///
/// Source: Åström, Murray 2008, Feedback Systems, 9.2, 9.3, 11.4. Not modelled: friction that changes its sign, limits, observers and
/// integrators, which take more phase (loop_margins.hpp).
/// Real time: no.

#include <complex>
#include <optional>
#include <string>
#include <vector>

namespace stribeck::sim {

/// Position per force over frequency, ascending.
struct MeasuredPlant {
  double period = 0.0;                         ///< of the controller [s]
  std::vector<double> omega;                   ///< [rad/s]
  std::vector<std::complex<double>> response;  ///< [m/N]
  std::vector<double> half_width;              ///< relative, 95 %
};

struct Notch {
  double frequency = 0.0;  ///< ωn [rad/s]
  double depth = 0.1;      ///< d: gain at ωn
  double damping = 0.5;    ///< ζ

  [[nodiscard]] std::complex<double> at(double omega, double period) const;
};

/// Gains of a loop.
struct MeasuredGains {
  double mass = 0.0;   ///< m of the controller [kg]
  double omega = 0.0;  ///< ω0 [rad/s]
  std::optional<Notch> notch{};
};

struct MeasuredMargins {
  bool stable = false;
  bool inside = false;      ///< both crossings lie within the measured frequencies
  double phase = 0.0;       ///< [rad]
  double sure_phase = 0.0;  ///< at the worse edge of the interval [rad]
  double gain_up = 0.0;     ///< factor; infinite: no crossing of −180° above
  double sure_gain = 0.0;   ///< the smaller of both factors, at the worse edge
  double gain_down = 0.0;   ///< factor, as a divisor
  double crossover = 0.0;   ///< highest frequency where |L| = 1 [rad/s]
  double critical = 0.0;    ///< frequency that limits the gain upwards [rad/s]; 0: none
};

struct MarginRule {
  double phase = 0.0;  ///< least [rad]
  double gain = 0.0;   ///< least, factor
};

std::vector<std::complex<double>> measured_loop(const MeasuredPlant& plant, const MeasuredGains& gains);
MeasuredMargins measured_margins(const MeasuredPlant& plant, const MeasuredGains& gains);

/// What a faster loop would violate first.
enum class LoopLimit { kPhase, kGain, kMeasured, kUnstable };

struct LoopProposal {
  /// The fastest ω0 of the first range that keeps the rule throughout and reaches down to a half of it, or to the slowest loop whose
  /// crossings were measured [rad/s]; 0: none. A loop in between that only the interval of a line makes unsure does not end the range, where
  /// no line of the faster one reaches −1 within its interval.
  double omega = 0.0;
  MeasuredMargins margins;
  LoopLimit limit = LoopLimit::kPhase;
  bool unsure = false;  ///< the margin itself keeps the rule there; its interval does not
  /// The frequency where the next faster loop violates the rule; without a proposal, where the slowest loop does [rad/s].
  double limit_at = 0.0;
  std::optional<Notch> notch{};
};

LoopProposal propose_loop(const MeasuredPlant& plant, double mass, const MarginRule& rule,
                          const std::optional<Notch>& notch = {});

/// The notch at a resonance that allows the fastest loop, also when the resonance is off by `drift` (relative). `without`: ω0 without a
/// notch. Absent: none makes the loop a sixth faster, or there is no loop without one.
std::optional<LoopProposal> propose_notch(const MeasuredPlant& plant, double mass, const MarginRule& rule,
                                          double resonance, double drift, double without);

}  // namespace stribeck::sim
