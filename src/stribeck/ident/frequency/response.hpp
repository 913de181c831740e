#pragma once
/// Frequency response of an axis from logs: position per force, and position per reference, line by line.
///
///   G(ω) = S_xz/S_fz     T(ω) = S_xr/S_rr     S_ab = Σ A·B* over segments, A the transform of a under a Hann window
///
/// f, x and r are those of log::Record. z is the instrument: the reference r of a closed loop, the force of an open one. In a closed
/// loop noise of the axis comes back in f, and S_xf/S_ff tends to −1/C of the controller; S_xz/S_fz does not (joint input-output
/// method). G holds the zero-order hold of f and every delay between the columns: it is what a controller with this period sees.
///
/// Periodic: where the increments of z repeat, segments are two periods, lines the harmonics that z has, and the first period of each
/// stretch is left out; then nothing leaks between lines. Otherwise segments have one length and lines equal ratios (Welch).
/// Only rows in which the axis slides in one direction count: at a reversal friction is no linear response.
/// Half widths: residual X − G·F against z between stretches (fewer than four: between segments), pooled with the two lines on
/// either side, Student's t, 95 %. With different phases in each stretch they include what friction distorts.
///
/// Source: Pintelon, Schoukens 2012, System Identification: A Frequency Domain Approach, ch. 3, 4; Ljung 1999, System
/// Identification, 13.5; Welch 1967, doi:10.1109/TAU.1967.1161901.
/// Not modelled: change along the travel; Coulomb friction, of which the slope at this speed is all that remains in G.
/// Real time: no.
/// Errors: Refused: axis stands or reverses, nothing excites it, no reference in closed loop.

#include <complex>
#include <cstddef>
#include <optional>
#include <stribeck/ident/log/record.hpp>
#include <vector>

namespace stribeck::ident::frequency {

using Complex = std::complex<double>;

/// A relative half width from which a line tells nothing: its phase is unsure by 30°.
inline constexpr double kUnsure = 0.5;

struct Line {
  double omega = 0.0;  ///< [rad/s]
  Complex plant{};     ///< G [m/N]
  double half_width =
      0.0;  ///< 95 % of |ΔG|/|G| in any direction of the plane; at least 1 where z moves nothing beyond chance
  Complex plain{};                ///< S_xf/S_ff, biased in a closed loop [m/N]
  double force_coherence = 0.0;   ///< of f with z, 0 … 1
  double motion_coherence = 0.0;  ///< of x with z
  Complex closed{};               ///< T; zero without reference
  double closed_half_width = 0.0;

  [[nodiscard]] bool determined() const noexcept { return half_width < kUnsure; }
};

struct Response {
  double sample_time = 0.0;      ///< [s]
  std::optional<double> period;  ///< of the excitation [s]; absent: none
  bool closed_loop = false;      ///< z is the reference
  std::size_t stretches = 0;     ///< that count
  std::size_t segments = 0;
  std::size_t units = 0;  ///< independent parts, from which the half widths come
  std::size_t rows = 0;   ///< of all logs
  std::size_t rows_used = 0;
  std::size_t rows_reversal = 0;  ///< left out: the axis stands or reverses, or a stretch is too short
  std::size_t rows_settling = 0;  ///< left out: not yet periodic, or the first period
  double speed = 0.0;             ///< mean of |v| [m/s]
  double slowest = 0.0;           ///< lowest |v| of the used rows [m/s]
  std::vector<Line> lines;        ///< ascending

  /// Highest frequency of a line that is determined [rad/s]; 0: none is.
  [[nodiscard]] double highest() const noexcept;
};

struct ResponseOptions {
  std::optional<double> period;  ///< of the excitation [s]; absent: found in z
};

/// All records are of one axis and have one sample time.
Response estimate(const std::vector<log::Record>& records, const ResponseOptions& options = {});

}  // namespace stribeck::ident::frequency
