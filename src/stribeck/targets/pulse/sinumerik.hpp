#pragma once
/// Quadrant error compensation of SINUMERIK (840D sl, 828D): a pulse on the set-point of speed at each reversal.
///
///   p(t) = Δn(a)·exp(−t/τ)                      τ MD32540
///   Δn(a) = Δn_max·a/a1                         a < a1 (MD32550)
///           Δn_max                              a1 ≤ a ≤ a2 (MD32560); MD32520
///           Δn_max + (Δn_min − Δn_max)·(a − a2)/(a3 − a2)       a2 < a < a3 (MD32570)
///           Δn_min                              a ≥ a3; MD32530
///
///   a = v²/r acceleration of the axis at the quadrant [m/s²], Δn [m/s]; in the control mm/min and m/s².
///
/// Source: SINUMERIK 840D sl/828D Function Manual, Extended Functions, 6FC5397-1BP40-3BA1, K3; formulas of the ranges: 808D Function
/// Manual 01/2017, p. 122. That p decays exponentially is taken from the name of its setting; no manual at hand gives its form.
/// Not modelled: blocks within one interpolation cycle (MD32580), which are set by trial.
/// Real time: no.

#include <stribeck/targets/pulse/pulse_target.hpp>
#include <string>
#include <vector>

namespace stribeck::targets {

struct Qec {
  double largest = 0.0;        ///< Δn_max [m/s]
  double smallest = 0.0;       ///< Δn_min [m/s]
  double time_constant = 0.0;  ///< [s]
  double a1 = 0.0;             ///< [m/s²], a1 < a2 < a3
  double a2 = 0.0;
  double a3 = 0.0;

  [[nodiscard]] double amplitude(double acceleration) const noexcept;
};

/// The characteristic that is nearest to the points: least squares of its two amplitudes, breaks from a list. At least two
/// accelerations that differ.
Qec nearest_qec(const std::vector<PulsePoint>& points, double time_constant);

/// Lines of an archive for one machine axis ("AX1"), rounded as the text shows.
std::string archive_text(const Qec& qec, const std::string& axis);

/// Reads them back. Throws InputError for a line that is missing.
Qec read_archive(const std::string& text, const std::string& axis);

}  // namespace stribeck::targets
