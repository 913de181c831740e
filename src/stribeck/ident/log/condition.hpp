#pragma once
/// From signals as a machine logged them to records that can be identified, and a note on everything that was found.
///
///   time       missing, backwards, double, rounded or jittering stamps, gaps; signals with own time bases
///   rows       values held over several rows, frozen logger, jumps and single wild samples
///   channels   stuck, saturated, velocity in another unit or direction than dx/dt
///   force      magnitude only (unsigned), sign against the position, drive switched off at an end
///
/// Signs come from a rough fit f = m·a + c·v + F·sgn v + k·x + f0 with a delay of whole samples. Friction decides,
/// because it takes power out of every axis, while k·x of pre-sliding can look like a negative mass (inertia alone
/// decides only where no friction shows and R² > 0.9). A force logged as a magnitude gets its sign from the same fit, repeated
/// until no row changes. Rows at rest or nearer to zero than the noise are then marked; a fit below R² = 0.7 is
/// refused. On a slower grid the force is the mean over each interval, as a zero-order hold requires.
///
/// Every repair is a Finding; a repair that is wrong for a machine can be switched off by its kind. Nothing is
/// filtered, no column is shifted. A clean log gives no finding.
/// Source: reference results of the recordings in tests/recordings.
/// Not modelled: the delay between force and motion (only in whole samples, to find the signs).
/// Real time: no.
/// Errors: Refused names source, place and the way out.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <stribeck/ident/log/record.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::log {

/// A column with its own times. Without t it shares the times of the position (of the velocity where there
/// is no position).
struct Signal {
  std::vector<double> t;  ///< [s]
  std::vector<double> y;  ///< SI, or in the log's own unit of force

  [[nodiscard]] bool empty() const noexcept { return y.empty(); }
};

/// One axis as logged. It must have x or v, and f.
struct RawLog {
  std::string source;
  Signal x, r, v, v_ref, f;
  std::string force_unit = "N";
  std::string position_unit = "m";
  bool rotary = false;    ///< positions are arcs at a radius of 1 m
  bool measured = false;  ///< the force is said to be the one that the drive makes, not its command
  Loop loop = Loop::kAutomatic;
  double sample_time = 0.0;      ///< [s], where there is no time column
  std::vector<std::size_t> row;  ///< row of the log, from 1, of every row here; empty: 1, 2, …
};

struct Finding {
  std::string kind;            ///< "gap", "frozen", "unsigned", …: the word that switches a repair off
  std::string text;            ///< a sentence, place included
  std::size_t row = 0;         ///< of the log, from 1; 0: all of it
  double time = 0.0;           ///< [s]
  bool repaired = false;       ///< false: the records still contain it
  std::vector<double> values;  ///< the numbers in the text, for programs
};

/// How the log was written. A resolution of 0: none can be seen. Holds: number of rows between new values.
struct Sampling {
  std::size_t rows = 0;          ///< as logged
  double duration = 0.0;         ///< as logged [s]
  double logged_time = 0.0;      ///< median step of the log [s]
  double sample_time = 0.0;      ///< of the records [s]
  double jitter = 0.0;           ///< largest |step/T − 1| outside gaps
  std::size_t gaps = 0;          ///< steps beyond 1.5 T
  double x_quantum = 0.0;        ///< finest step of the position [m]
  double x_quantum_large = 0.0;  ///< the same where numbers are large (three printed digits) [m]
  double v_quantum = 0.0;        ///< [m/s]
  double f_quantum = 0.0;        ///< [N]
  double x_hold = 1.0;
  double v_hold = 1.0;
  double f_hold = 1.0;
  double x_noise = 0.0;  ///< RMS of the white part [m]
  double v_noise = 0.0;  ///< [m/s]
  double f_noise = 0.0;  ///< [N]
};

/// The motion that the log covers.
struct Coverage {
  double x_min = 0.0;               ///< [m]
  double x_max = 0.0;               ///< [m]
  double v_min = 0.0;               ///< fastest towards −x [m/s]
  double v_max = 0.0;               ///< fastest towards +x [m/s]
  double slowest = 0.0;             ///< lower 2 % of the speeds of sliding rows [m/s]
  double a_max = 0.0;               ///< [m/s²], 99.5 % quantile
  double f_min = 0.0;               ///< [N]
  double f_max = 0.0;               ///< [N]
  double moving = 0.0;              ///< share of the rows
  double forward = 0.0;             ///< share of the rows that move towards +x
  std::size_t reversals = 0;        ///< changes of direction while moving
  std::size_t strokes = 0;          ///< stretches between them
  std::size_t rows_presliding = 0;  ///< rows per reversal within the first 50 µm (1 mrad) after it, median
};

/// f = m·a + c·v + F·sgn v + k·x + f0; only good enough to find signs, and to tell what explains the force.
struct RoughFit {
  double mass = 0.0;
  double viscous = 0.0;
  double coulomb = 0.0;
  double stiffness = 0.0;
  double offset = 0.0;
  int delay = 0;     ///< samples by which the force stands later than the motion
  double rms = 0.0;  ///< RMS of the residual [N]
  double r_squared = 0.0;
  bool good = false;        ///< enough moving rows
  bool mass_shows = false;  ///< the acceleration explains at least a tenth of the residual without it
  bool mass_shows_without_spring =
      false;  ///< the same in a fit without k·x: a motion of one frequency cannot tell a spring from a mass
  bool friction_shows = false;  ///< the same for c·v + F·sgn v, with motion in both directions
};

/// Marks of a row, as bits.
enum RowMark : std::uint8_t {
  kGoodRow = 0,
  kSignUnsure = 1,  ///< sign of the force recovered, nearer to zero than the noise; left out of fits
  kAtRest = 2,      ///< standstill at the beginning or the end of the record
  kAtLimit = 4,     ///< force at the end of its range; left out of fits
  kRepairedRow =
      8,  ///< a wild sample was replaced, or a row that was lost or not renewed was put in; left out of fits
};

struct Conditioned {
  std::vector<Record> records;  ///< in the order of the log
  std::vector<std::vector<std::uint8_t>>
      marks;  ///< RowMark bits for each row of the records; `skip` of a record follows from them
  std::vector<std::vector<std::size_t>> rows;  ///< rows of the log, for each record
  std::vector<std::size_t> run;                ///< index of the raw log, for each record
  std::vector<Finding> findings;               ///< in the order of the log
  Sampling sampling;
  Coverage coverage;
  RoughFit rough;
  std::vector<std::string> determinable;  ///< what such a log can tell
  std::vector<std::string> cannot_tell;   ///< what it cannot tell, with the reason
};

struct ConditionOptions {
  std::vector<std::string> keep;  ///< kinds of findings that are left alone, e.g. "inverted"
};

/// Several runs of one axis with the same wiring: the signs are decided for all of them together.
Conditioned condition(std::vector<RawLog> runs, const ConditionOptions& options = {});
Conditioned condition(RawLog log, const ConditionOptions& options = {});

/// All kinds that ConditionOptions::keep accepts.
const std::vector<std::string>& finding_kinds();

/// The step of which all values are multiples; 0 where there is none.
double quantum(const std::vector<double>& values);

}  // namespace stribeck::ident::log
