#pragma once
/// Steps of the diagnosis of a circle (causes.hpp): rows, columns of the fit, cyclic error, quadrant peaks, vibration.
///
/// Inside ident only: includes Eigen. Real time: no. Errors: none.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/causes.hpp>
#include <utility>
#include <vector>

namespace stribeck::ident::circle {

/// Mean radial error over one step of the angle in one lap.
struct CauseRow {
  int run = 0;
  int log = 0;
  int lap = 0;
  std::size_t at = 0;      ///< step within the run
  double angle = 0.0;      ///< goes on [rad]
  double error = 0.0;      ///< [m]
  double direction = 1.0;  ///< of travel, ±1
  double feed = 0.0;       ///< [m/s]; NaN: unknown
  int samples = 0;         ///< in the mean
  double progress = 0.0;   ///< time within its log, from −½ to ½
};

struct CauseRows {
  AxisNames axes{"x", "y"};
  std::vector<CauseRow> rows;
  double radius = 0.0;
  double step = 0.0;  ///< [rad]
  int logs = 0;
  bool both_directions = false;
  bool arcs = false;  ///< a part of the circle is missing
  bool feeds_known = false;
  bool feeds_differ = false;  ///< by more than a fifth
  bool drifts = false;        ///< the centre moves evenly with time: centre_drifts()
  bool own_encoder =
      false;             ///< positions of a control beside its commands: each encoder sees its own axis alone
  double fastest = 0.0;  ///< [m/s]
};

/// Where the circle is, from the centre of the motion [m].
struct Offset {
  double x = 0.0;
  double y = 0.0;
};
/// Angles and errors of the runs about the centre that the circle has. An offset d bends the circle by d²/(2R), which would be taken for
/// a radius, a scale mismatch and a squareness.
///
///   positions p            |p − c − d| − R
///   ball-bar of length r   √(r² − (d × u)²) − d·u − R      u direction in which the machine was commanded to be
Offset take_off_centre(CircleMotion& motion);

CauseRows cause_rows(const std::vector<CircleMotion>& motions);
/// Whether an even drift of the centre over each log takes off much of what the other causes leave, beyond chance.
bool centre_drifts(const CauseRows& rows);

/// Angle from the last reversal of either axis, in the direction of travel: 0 to 90 degrees [rad].
double after_reversal(const CauseRow& row);
/// The quadrant border that was passed last: 0 … 3 for 0, 90, 180, 270 degrees.
int last_border(const CauseRow& row);

/// One cyclic error of one axis.
struct Pitch {
  int axis = 0;
  double length = 0.0;  ///< [m]
};

/// Where the columns of a cause are.
struct CauseColumns {
  CauseKind kind;
  std::optional<int> axis;
  int first = 0;
  int count = 1;
  double pitch = 0.0;  ///< of a cyclic error [m]
  int log = 0;         ///< of a centre
};

struct Columns {
  std::vector<CauseColumns> causes;
  int count = 0;
};
Columns columns_of(const CauseRows& rows, const std::vector<Pitch>& pitches);
/// Radial error per coefficient at one angle [m/m]: one row of the fit, columns.count numbers.
Eigen::VectorXd column_values(const CauseRows& rows, const Columns& columns, const CauseRow& at);
/// The same of all rows.
struct Design {
  Columns columns;
  Eigen::MatrixXd X;
};
Design design_of(const CauseRows& rows, const std::vector<Pitch>& pitches);

/// A window as long as this is not that of a spike alone [rad].
inline constexpr double kBroad = 44.0 * kPi / 180.0;
/// Angles behind the reversals of x and of y that a fit leaves out [rad].
using Windows = std::array<double, 2>;

/// The fit of all rows more than a window behind a reversal.
struct CauseFit {
  std::vector<std::size_t> used;  ///< rows
  Eigen::MatrixXd X;
  Eigen::MatrixXd inverse;  ///< (XᵀX)⁻¹
  Eigen::VectorXd coefficients;
  Eigen::VectorXd rest;  ///< of the used rows [m]
  double variance = 0.0;
  Windows windows{};
  [[nodiscard]] double window() const { return std::max(windows[0], windows[1]); }
};
/// `before`: angle before a reversal that is left out too [rad].
CauseFit fit_causes(const CauseRows& rows, const Design& design, const Windows& windows,
                    double before = kPi / 180.0);
/// The same with the shortest window that leaves no more than any longer one. Where both directions were measured and that window is
/// long, longer ones are tried for each axis (45 and 60 degrees, which must take off a fifth of the variance), and then shorter ones for
/// the axis that needs none.
CauseFit fit_with_window(const CauseRows& rows, const Design& design);

/// Pitches that lower the rest clearly, at most two.
std::vector<Pitch> find_pitches(const CauseRows& rows);

/// Measured less fitted of every row [m].
std::vector<double> rest_of_rows(const CauseRows& rows, const Design& design, const CauseFit& fit);

/// Radial error of a sample that the fit explains.
class Explained {
 public:
  Explained(const CauseRows& rows, const Design& design, const CauseFit& fit)
      : rows_(rows), design_(design), fit_(fit) {}
  [[nodiscard]] double at(const CircleRun& run, int log, std::size_t i, double progress = 0.0) const;

 private:
  const CauseRows& rows_;
  const Design& design_;
  const CauseFit& fit_;
};

/// Run, and quarter of a turn within it.
using Passing = std::pair<int, long>;

/// The samples behind single reversals: a spike may be narrower than the step of the rows.
class PassingSamples {
 public:
  struct Sample {
    double behind = 0.0;   ///< angle behind the reversal [rad]
    double rest = 0.0;     ///< [m]
    bool goes_on = false;  ///< the sample before it is of the same passing
  };
  PassingSamples(const std::vector<CircleMotion>& motions, const CauseRows& rows, const Explained& explained);
  /// Of several passings, `from` ≤ angle behind the reversal < `to` [rad].
  [[nodiscard]] std::vector<Sample> of(const std::vector<Passing>& passings, double from, double to) const;

 private:
  struct Run {
    const CircleRun* run;
    int log;
  };
  [[nodiscard]] double progress_at(int run, double angle) const;

  const CauseRows& rows_;
  const Explained& explained_;
  std::vector<Run> runs_;
  using Ends = std::pair<std::size_t, std::size_t>;  ///< the first and the last one
  std::map<Passing, Ends> ends_;                     ///< samples
  std::map<int, Ends> rows_of_run_;
};

/// What an axis does behind a reversal: it crosses its play and stands still, or its compensation takes its time for a step that is too
/// large.
struct Crossing {
  double angle = 0.0;               ///< that it needs for it, behind the reversal [rad]; 0: it has no play
  double play = 0.0;                ///< size of the play, or of the step [m]
  bool stands = false;              ///< it crosses its play; false: it is compensated too much
  std::array<double, 2> at_ends{};  ///< play at the positive and at the negative end [m]
};
/// A peak is found on the rows, and its height, width and delay are measured on the samples where they resolve it. Where an axis crosses
/// its play, what stands still explains is taken off first, and no peak is looked for, except one that is larger than half of the play.
std::vector<QuadrantPeak> quadrant_peaks(const CauseRows& rows, const std::vector<double>& rest,
                                         const PassingSamples& samples, const Windows& windows,
                                         const std::array<Crossing, 2>& crossing);

struct Vibration {
  std::optional<int>
      axis;  ///< that vibrates alone, as far as the change of the amplitude around the circle tells
  double amplitude = 0.0;  ///< of that axis; else of the radius, mean over the circle [m]
  double half_width = 0.0;
  double in_radius = 0.0;  ///< amplitude in the radius, mean over the circle [m]
  double frequency = 0.0;  ///< [Hz]
  double frequency_half_width = 0.0;
};
/// Whether there are times, and enough rows between the reversals to look for a vibration.
bool tells_vibration(const std::vector<CircleMotion>& motions, double window);
/// Lines of the rest over time between the reversals, of the run with the strongest one, which is first; at most three. None: none stands
/// out, or no times.
std::vector<Vibration> find_vibrations(const std::vector<CircleMotion>& motions, const CauseRows& rows,
                                       const Design& design, const CauseFit& fit);

/// What these measurements cannot tell apart, and what the fit cannot hold.
std::vector<std::string> remarks_on(const CauseRows& rows, const CauseFit& fit,
                                    const std::vector<Cause>& causes, const std::vector<QuadrantPeak>& peaks,
                                    const std::vector<CircleMotion>& motions, bool commanded);

}  // namespace stribeck::ident::circle
