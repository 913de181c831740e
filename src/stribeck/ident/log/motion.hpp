#pragma once
/// Velocity, acceleration and force of a record, row by row, so that m·a + F(v) = f holds without a shift.
///
///   a[k] = (x[k+1] − 2x[k] + x[k−1])/T²     pairs exactly with (f[k−1] + f[k])/2 under a zero-order hold
///   v[k] = (x[k+1] − x[k−1])/(2T)
///
/// A log may hold the force s + ½ rows later (options.shift = s: the force of row k + s belongs to the motion of row k; −½ is a
/// commanded force under its hold). The weights are then shares of the triangle over [k−1, k+1]. A second difference has the
/// same triangle, so the hold stays exact for any fraction of a row.
///
/// Both sides then pass one symmetric window (a box of 2j+1 rows, three times; or, with options.cut_off, a Butterworth
/// filter of order 4 forward and backward). So the linear relation is kept and nothing is shifted. The window is the shortest
/// one that brings the noise of a, computed from the white part of the noise of x, below 1 % of the spread of a. A row whose
/// window reaches over an end is not valid.
///
/// A reversal is an extreme of x from which x has come back by more than the hysteresis (ten times the noise of
/// x); elastic spring-back after a stop counts. `distance` is the travel since then, because bristles depend on travel, not on
/// time.
///
/// `instrument` multiplies in least squares for the mass instead of the measured a, whose noise would bias the mass (by −4.7 %
/// with a 25 nm encoder at 5 ms without a window). In closed loop it is the acceleration of the reference, in open loop the
/// force; where neither is known to be free of noise, the acceleration through a three times longer window.
///
/// Source: thesis §2.4.3; Söderström, Errors-in-Variables Methods in System Identification, 2018.
/// Not modelled: elasticity between encoder and force.
/// Real time: no.

#include <cstdint>
#include <stribeck/ident/log/record.hpp>
#include <vector>

namespace stribeck::ident::log {

/// For how long a command stands before the next one comes [s]: a row, or the period of the control (0: not known) in a log of
/// every n-th command.
inline double hold_of(double control_period, double sample_time) noexcept {
  return control_period > 0.0 && control_period < sample_time ? control_period : sample_time;
}

struct Motion {
  double sample_time = 0.0;      ///< [s]
  Loop loop = Loop::kAutomatic;  ///< as found: never kAutomatic
  double position_noise = 0.0;   ///< RMS of the white part of x [m]
  double stroke = 0.0;           ///< [m]
  int window = 0;                ///< j of the boxes, 0: none
  double cut_off = 0.0;          ///< of the Butterworth filter instead [Hz], 0: none
  int reach = 0;                 ///< rows on each side that the values of a row use

  std::vector<double> x;               ///< [m]
  std::vector<double> v;               ///< [m/s]
  std::vector<double> a;               ///< [m/s²]
  std::vector<double> f;               ///< [N]
  std::vector<double> instrument;      ///< [m/s²], open loop [N]
  std::vector<double> distance;        ///< since the last reversal [m]
  std::vector<std::int8_t> direction;  ///< of the stretch between reversals: +1, −1
  std::vector<int> stretch;            ///< number of the stretch, from 0
  std::vector<std::size_t> reversals;  ///< rows
  std::vector<std::uint8_t> skip;      ///< of the record: 1: the row is not fitted; may be empty

  [[nodiscard]] std::size_t rows() const noexcept { return v.size(); }
  /// Whether the window of row k lies inside the record.
  [[nodiscard]] bool valid(std::size_t k) const noexcept {
    const auto n = static_cast<std::size_t>(reach);
    return k >= n && k + n < rows();
  }
  /// Whether row k counts, and its window lies in one stretch, at least `exclude` [m] after its reversal.
  [[nodiscard]] bool sliding(std::size_t k, double exclude) const noexcept {
    const auto n = static_cast<std::size_t>(reach);
    return valid(k) && (skip.empty() || skip[k] == 0) && stretch[k - n] == stretch[k + n] &&
           distance[k - n] >= exclude;
  }
};

struct MotionOptions {
  int window = -1;       ///< j of the boxes; negative: chosen from the data
  double cut_off = 0.0;  ///< of the Butterworth filter that replaces the boxes [Hz]; 0: boxes
  double shift = -0.5;   ///< the force of row k + shift belongs to the motion of row k [rows]
  std::vector<double>* smoothed_force = nullptr;  ///< receives the windowed force before alignment
};

/// Force that acts together with the acceleration of each row.
std::vector<double> align_force(const std::vector<double>& f, double shift);
/// The same for rows `from` to `to` (not included) of `out`, which has as many rows as f.
void align_force(const std::vector<double>& f, double shift, std::size_t from, std::size_t to,
                 std::vector<double>& out);

/// Passes another column of the same record through the same window.
std::vector<double> smooth_like(const Motion& motion, const std::vector<double>& column);

/// Frequency at which the window leaves 1/√2 of an amplitude, for the Butterworth filter, which runs both ways, one half [Hz]; NaN: no window.
double cut_off_of(const Motion& motion);

/// Share of an amplitude that a low-pass leaves, `ratio` the frequency divided by cut_off_of().
using Passed = double (*)(double ratio);
/// That of the motion's window; null: no window.
Passed passed_by(const Motion& motion);

/// Velocity behind a second window, of boxes twice as long [m/s]: it has little of the noise of the motion. Near the ends of the record,
/// where that window does not fit, v.
std::vector<double> calm_velocity(const Motion& motion);

/// Rows at either end of a record where calm_velocity() is v.
std::size_t calm_reach(const Motion& motion);

/// Variance of the noise in the acceleration of calm_velocity(), at most [m²/s⁴].
double calm_noise(const Motion& motion);

/// The record must be free of problems().
Motion reconstruct(const Record& record, const MotionOptions& options = {});

/// RMS of the white part of the position noise [m], from fourth differences where the axis moves.
double position_noise(const std::vector<double>& x);

}  // namespace stribeck::ident::log
