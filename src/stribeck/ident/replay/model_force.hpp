#pragma once
/// The force that a model asks for under the measured motion, beside the logged one: the error of the model as the
/// EMPS benchmark defines it, and the shift and phases that belong to this record.
///
///   f̂ = m·a + load + F(v, x, bristles)        error = ‖f − f̂‖/‖f‖ over the decimated rows
///
/// Protocol: x through a Butterworth filter of order 4 at 100 Hz, forward and backward; v and a by two central
/// differences; the first 49 rows dropped; f and f̂ decimated to 100 rows a second (Chebyshev filter of order 8, flat
/// to 40 Hz). At 1 ms these are the published steps to the digit. A slower log is filtered at 0.8 of half its rate at
/// most, and decimated by a smaller whole number.
///
/// The protocol pairs force k with motion k. The other two errors take out what belongs to the record and not to the
/// axis: the shift s, by which f(k + s) belongs to motion k (a force under its hold: half of that hold and the model's delay
/// earlier, unless the record says otherwise), and the phase of each periodic term, which a new homing position moves. These come from
/// least squares on the same rows; amplitudes and everything else stay as they are. Beside the shift, columns of a, v,
/// sgn v, x, 1 and the friction of a model with bristles take what a wrong mass, friction, load or a spring leaves: a model that is wrong in these is
/// not late.
///
/// These errors are shares of the force less the middle between the mean forces of both directions: a weight that hangs
/// may be many times the force that moves the axis, and would hide what a model misses of that.
///
/// Not every error is the model's. A right model misses on this record what noise and resolution of the position, the time
/// between rows and a force that changed anywhere between two of them make: the force under a position with as much noise again,
/// under every other row, and with the force of a row moved by up to half a row. The sum of the squares is `of_log`.
///
/// Rows that the record marks `skip` do not count. Friction without pre-sliding is that of sgn v.
/// Source: see methods/idim_ls.hpp. Not modelled: a delay that changes. Real time: no.
/// Errors: Refused for a record with problems().

#include <cstddef>
#include <optional>
#include <span>
#include <stribeck/core/numbers.hpp>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/replay/friction_change.hpp>
#include <stribeck/ident/result.hpp>
#include <vector>

namespace stribeck::ident::replay {

/// Largest shift between force and motion [rows].
inline constexpr double kMostShift = 100.0;
/// Largest one that a user may give [rows]: the hold of the force adds half a row.
inline constexpr double kMostGivenShift = kMostShift - 1.0;

struct ForceOptions {
  double cut_off = 100.0;       ///< of the Butterworth filter [Hz]
  double row_time = 10e-3;      ///< between decimated rows, at least [s]
  std::size_t drop = 49;        ///< rows at the start
  std::optional<double> shift;  ///< known shift of the force [s]; absent: estimated
  double control_period = 0.0;  ///< over which a command is held, in a log of every n-th one [s]; 0: a row
  bool of_log = false;          ///< whether `of_log` is wanted; it costs as much as the rest
  double told_from =
      0.0;  ///< slowest speed whose friction the model tells [m/s]: friction of slower rows is not compared
};

/// Phase of one periodic term in this record.
struct RecordPhase {
  double period = 0.0;      ///< of the term [m]
  double stored = 0.0;      ///< in the model [rad]
  double found = 0.0;       ///< in the record [rad], within π of the stored one
  double half_width = 0.0;  ///< of 95 % [rad]
  bool determined = false;  ///< the record tells it; else `stored` is used
  bool differs = false;     ///< by more than the interval, and by a twentieth of a turn at least
};

struct ForceError {
  double relative = kNaN;  ///< by the protocol, force k beside motion k; NaN: the record is too short
  double rms = kNaN;       ///< the same [N]
  double filed_relative =
      kNaN;  ///< the model as it stands, the force aligned by the shift, as a share of it less the constant part
  double filed_rms = kNaN;     ///< [N]
  double own_relative = kNaN;  ///< with the phases of this record too
  double own_rms = kNaN;       ///< [N]
  double shift = kNaN;         ///< s [s]; > 0: the force stands later in the log than its motion
  double shift_half = kNaN;    ///< half width of 95 % [s]
  bool shifted = false;  ///< s is not that of a force under its hold that begins after the model's delay
  bool or_pre_sliding = false;  ///< s may as well be pre-sliding that the model does not have
  double at_rest = 0.0;         ///< share of the rows in which the axis stands
  double unsettled =
      0.0;  ///< and behind reversals, in which friction builds up and the model has no pre-sliding
  double untold = 0.0;            ///< share of the other rows, in which it is slower than the model tells
  std::size_t moving = 0;         ///< of the decimated rows, without them
  double moving_relative = kNaN;  ///< as own_relative, of these
  double moving_rms = kNaN;       ///< [N]
  double of_log = kNaN;           ///< largest share of the force that this record makes a right model miss
  double of_log_moving = kNaN;    ///< the same of the rows in which the axis moves
  FrictionChanges friction;       ///< of the record, beside that of the model
  std::vector<RecordPhase> phases;
  double cut_off = kNaN;             ///< that was used [Hz]
  double band = kNaN;                ///< up to which the decimated rows are flat [Hz]
  std::size_t factor = 1;            ///< of the decimation
  std::vector<std::size_t> row;      ///< of the record, of each decimated row
  std::vector<double> measured;      ///< force of it, aligned [N]
  std::vector<double> modelled;      ///< with the phases of this record [N]
  std::vector<double> velocity;      ///< of the same rows [m/s]
  std::vector<double> acceleration;  ///< [m/s²]

  /// Whether rests, and without pre-sliding in the model the distances behind reversals, make most of the error. The force of an axis that stands lies anywhere within its friction: a model without pre-sliding
  /// knows nothing of it, and bristles know it only as far as the encoder shows how they are strained.
  [[nodiscard]] bool of_rests() const noexcept {
    constexpr double kMuchRest = 0.1, kSomeRest = 0.02;  // of the rows
    constexpr double kMuchLess = 0.7, kHalf = 0.5;       // of the error
    constexpr std::size_t kFewest = 50;                  // rows of motion
    const bool much = at_rest >= kMuchRest, some = unsettled > 0.0 && at_rest + unsettled >= kSomeRest;
    return moving >= kFewest && (much || some) && moving_relative < (much ? kMuchLess : kHalf) * own_relative;
  }
};

/// Friction [N] at every row of a motion x [m], v [m/s] with rows of equal time [s]; bristles go along with it. They begin
/// as in a slide with v[0]; at rest, with the force `push` [N] on the axis.
std::vector<double> friction_along(const friction::Model& model, std::span<const double> x,
                                   std::span<const double> v, double period, double push);

/// Shift of a force under its hold that begins after the delay of the model [s].
double expected_shift(const friction::AxisModel& model, const log::Record& record, double control_period);

ForceError force_error(const friction::AxisModel& model, const log::Record& record,
                       const ForceOptions& options = {});

}  // namespace stribeck::ident::replay
