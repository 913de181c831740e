#pragma once
/// The motion of an axis between its samples, cut into the pieces near reversals that show pre-sliding.
///
///   m·D²x[k] + load + J_k = (f[k−1] + f[k])/2      J_k = ∫ F(t)·w((t − t_k)/T) dt/T,  w(s) = 1 − |s|
///
/// D²x is the second difference over T². The relation is exact under a zero-order hold: friction enters by its
/// mean over two samples under a triangle, not by its value at the tick. The position between ticks is a
/// cubic spline through the measured one, after a window of fourth order (2K − K²) where the encoder is coarse.
/// Where the mass swings on its bristles within a few samples, a spline is not its motion: there the motion between two ticks is that
/// of the fitted law under the held force (Model::follow), and the measured positions hold at the ticks only.
/// A sub-step is short compared with the break-away distance. `early` and `late` are its shares of the triangles of
/// the tick before it and of the tick after it.
///
/// A piece begins where the axis has been sliding for long, so that the state of the bristle is known. A piece that begins
/// with the record adds an unknown start. Residuals pass a window (three boxes of 2j+1 rows): the shortest one that brings the
/// noise of D²x below a hundredth of the swing of friction at a reversal. They may then be whitened, e_k + Σ c_l·e_{k−l}: this
/// removes noise that lasts longer than a reversal and would hide it.
///
/// Inside ident only.
/// Real time: no.

#include <array>
#include <cstddef>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <vector>

namespace stribeck::ident::bristle {

/// One sub-step. Friction is evaluated in its middle.
struct PathStep {
  double dt = 0.0;         ///< [s]
  double v = 0.0;          ///< mean [m/s]
  double x = 0.0;          ///< position in the middle [m]
  double level = 0.0;      ///< of the steady map [N]
  double direction = 1.0;  ///< +1 or −1; where v = 0 that of the last motion
  double early = 0.0;      ///< share of J of the tick before it
  double late = 0.0;       ///< share of J of the tick after it
};

/// One sample: the sub-steps that follow a tick.
struct PathSample {
  std::size_t first = 0;  ///< index of the first step
  std::size_t count = 0;
  bool settled = false;  ///< the axis has been sliding for so long that friction is steady
};

struct PathPiece {
  int record = 0;
  std::size_t begin = 0;       ///< first tick, row of the record
  bool unknown_start = false;  ///< the state of the bristle at the first tick is not known
  std::vector<PathSample> samples;
  std::vector<double> acceleration;  ///< D²x at ticks begin … begin + samples [m/s²]
  std::vector<double> force;         ///< mean of the two held forces [N]
  std::vector<double> given;         ///< J of viscous and additive parts [N]
  std::vector<double> speed;         ///< J of v [m/s]
  std::vector<double> at;            ///< position of each tick [m]
  std::vector<double> held;          ///< force from each tick to the next, late by the shift [N]
  double late = 0.0;                 ///< share of a sample for which the force before `held` goes on
  std::vector<std::size_t> rows;     ///< ticks, counted from begin, whose residual counts in the fit
};

/// A row that counts in the fit.
struct PathRow {
  int record = 0;
  std::size_t at = 0;    ///< row of the record
  int stretch = 0;       ///< stretch between two reversals, counted over all records
  bool turning = false;  ///< shortly after a reversal: dynamic models are compared on these rows
};

struct BristlePath {
  int window = 0;                 ///< j of the boxes
  std::vector<double> whitening;  ///< c_1 … c_p, empty: none
  std::vector<PathStep> steps;    ///< of all pieces
  std::vector<PathPiece> pieces;
  std::vector<PathRow> rows;  ///< of all pieces, in their order
  int stretches = 0;
  int starts = 0;  ///< pieces with an unknown start
};

/// What the pieces are cut from, for each record.
struct BristleData {
  std::vector<log::Motion> motion;
  double noise = 0.0;             ///< of the position [m], the largest of the records
  std::array<double, 2> level{};  ///< of friction at rest, forward and backward [N]
  std::size_t reversals = 0;
};

inline constexpr std::size_t kMostWhitening = 4;

/// Applies the window, and the whitening where `white`, to every column[k] whose neighbours lie inside; the others are undefined.
void filter_like(const BristlePath& path, bool white, std::size_t n, const double* column, double* out,
                 std::vector<double>& work);

/// Coefficients of an autoregressive model of residuals e of all rows.
std::vector<double> whitening_of(const BristlePath& path, const double* e);

struct CutOptions {
  double break_away = 0.0;  ///< [m]
  double shift = -0.5;      ///< of the force, as in MotionOptions [rows]
  bool whole = false;       ///< every row, not only those near reversals
  double swing = 0.0;       ///< phase by which the mass swings on its bristles in one sample [rad]
};
BristlePath cut_path(const std::vector<log::Record>& records, const BristleData& data,
                     const friction::AxisModel& known, const CutOptions& options);

/// Level, direction and place of a step with the velocity `v` that begins at x, by the steady map; its shares are given.
/// Adds what is not the bristle's to the J of sample i.
void lay_step(const friction::AxisModel& known, double x, double v, std::size_t i, PathPiece& piece,
              PathStep& step);

/// First estimate of the break-away distance g/σ0 [m]: the place where friction crosses zero after a reversal; without
/// reversals, from the stiffness of a motion that never slides. NaN when nothing moves.
double guess_break_away(const std::vector<log::Record>& records, const BristleData& data,
                        const friction::AxisModel& known);

}  // namespace stribeck::ident::bristle
