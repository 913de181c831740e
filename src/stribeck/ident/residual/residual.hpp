#pragma once
/// What an identified model leaves of the force: how much, at which frequencies, and which force it may be that the
/// model does not have.
///
///   e = f − (m·a + load + F(v, x))       on rows of settled sliding; once through the window of the motion, which
///                                        the fit uses, and once with the force as it was logged
///
///   quality     R², RMS beside that of friction, the low-pass, the strongest line over time (lines.cpp)
///   causes      each a few columns beside a, v, 1 and sgn v: a force that grows with position (spring, cable chain);
///               sin and cos of an angle (an arm, an unbalanced table); a mass that grows with the frequency;
///               friction along the travel; a tight spot (causes.cpp); a sudden change; logs that differ; speeds in order,
///               which hide a change (changes.cpp); a table on a spring (elastic.cpp); a force in one direction (one_sided.cpp)
///
/// A cause is told with the excitation that would separate it where this motion does not. Three causes are forces that
/// may be taken off before a second fit: `elastic`, `spring` and `unbalance`. Rows with a force in one direction are left out of it.
///
/// Works on records and a result alone, whichever method made it. Real time: no.
/// Errors: those of log::reconstruct.

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/ident/shown.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::residual {

/// A line of the spectrum over time.
struct Line {
  double frequency = 0.0;  ///< [Hz]
  double amplitude = 0.0;  ///< [N]
  double moves = 0.0;      ///< amplitude of m·a at this frequency, from the position [N]
  bool narrow = true;      ///< not wider than the resolution
};

struct Quality {
  double r_squared = kNaN;     ///< of the rows behind the low-pass
  double rms = kNaN;           ///< of e behind the low-pass [N]
  double raw_rms = kNaN;       ///< of e with the force as logged [N]
  double friction_rms = kNaN;  ///< of F [N]
  double cut_off = kNaN;       ///< of the low-pass, −3 dB [Hz]; NaN: none
  std::size_t rows = 0;
  std::optional<Line> strongest;
  std::vector<Line> spectrum;  ///< at most 300 lines, ascending frequency
};

/// A force that grows with position: f += stiffness·(x − middle).
struct Spring {
  double stiffness = 0.0;        ///< [N/m]
  double half_width = 0.0;       ///< 95 % [N/m]
  double middle = 0.0;           ///< of the travel [m]
  double from = 0.0;             ///< lowest position of the rows [m]
  double to = 0.0;               ///< highest position of the rows [m]
  double mass_half_width = 0.0;  ///< of the mass, by the error of this force, 95 % [kg]
  bool may_be_weight =
      false;  ///< on this angle it may as well be a weight that hangs; the mass allows for it
};

/// A force that follows the angle: f += sine·sin x + cosine·cos x.
struct Unbalance {
  double sine = 0.0;        ///< [N]
  double cosine = 0.0;      ///< [N]
  double half_width = 0.0;  ///< 95 %, of the amplitude [N]
  double mass = 0.0;        ///< half width of the mass beside it, 95 % [kg]
};

/// A table on a spring behind the motor that the encoder sees: f += force_of(…). The rigid model has the same whole mass.
struct Elastic {
  double frequency = 0.0;        ///< at which the table swings while the motor stands (anti-resonance) [Hz]
  double damping = 0.0;          ///< ratio
  double table_mass = 0.0;       ///< [kg]
  double friction = 0.0;         ///< on the table's side, of Coulomb [N]
  double mass = 0.0;             ///< of motor and table, that goes with it [kg]
  double mass_half_width = 0.0;  ///< of the whole mass, by the error of these numbers [kg]
  double late = 0.0;             ///< time by which its force is later than the shift of the model says [s]
  // Not of 95 %: all tables that leave less than 1.5 times the squared residual of this one.
  Interval frequency_interval;  ///< [Hz]
  Interval table_interval;      ///< [kg]
};

/// A force against the motion in one direction, on a part of the travel that the other direction passes without it.
struct OneSided {
  double direction = 1.0;         ///< of the motion that it opposes
  double force = 0.0;             ///< mean [N]
  double from = 0.0;              ///< [m]
  double to = 0.0;                ///< [m]
  bool from_the_low_end = false;  ///< of the travel
  bool to_the_high_end = false;
  bool enough_left = false;  ///< rows of this direction without it, to identify friction and mass from

  [[nodiscard]] bool holds(double x) const noexcept {
    return (from_the_low_end || x >= from) && (to_the_high_end || x <= to);
  }
};

/// Marks the rows on which that force acts, so that no fit uses them.
void leave_out(const OneSided& force, log::Record& record);

/// What it is and where it acts, without a full stop.
std::string in_words(const OneSided& force, const Shown& shown);

/// Value at a row and a share of a row, straight between rows; beyond the ends that of the end. `values` must not be empty.
double value_between(const std::vector<double>& values, double row);

/// What the spring carries more than a rigid drive would, at each row of a motion [N].
std::vector<double> force_of(const Elastic& elastic, const log::Motion& motion);

/// Takes that force off a record whose force is later than its motion by `shift` rows (log::MotionOptions).
void take_off(const Elastic& elastic, double shift, log::Record& record);

struct Diagnosis {
  Quality quality;
  std::optional<Elastic> elastic;      ///< well determined
  std::optional<Spring> spring;        ///< well determined
  std::optional<Unbalance> unbalance;  ///< well determined
  std::optional<OneSided> one_sided;   ///< well determined; then nothing else is looked for
  /// By how much the mass is too large because the drive gives way between motor and load [kg]; 0: no sign of it.
  double elastic_mass = 0.0;
  std::vector<std::string> warnings;
  std::vector<std::string> cannot_tell;
};

/// Rows by which the force is later than its motion (log::MotionOptions): as given, as found, else -0.5 for a held force.
double shift_in_rows(const Result& result, double period);

/// `one_sided`: whether a force in one direction is looked for, before all others.
Diagnosis diagnose(const std::vector<log::Record>& records, const Result& result, bool one_sided = true);

struct LogsAndModel {
  const std::vector<log::Record>& records;
  const Result& result;
};

/// RMS of what each of two models leaves of its logs [N], both behind the lower one of their low-passes: less of the noise of the force
/// passes there. NaN: no rows.
std::array<double, 2> both_leave(const LogsAndModel& a, const LogsAndModel& b);

/// One or two sentences about the quality.
std::string in_words(const Quality& quality, const std::string& force_unit);

}  // namespace stribeck::ident::residual
