#pragma once
/// Finds the circular motion in a record of positions: directions apart, run-in and run-out off.
///
///   e = |p − c| − R          radial error over the angle of travel
///
/// Motion of one direction is a run; it ends where the angle turns back by more than 10 degrees, or where the positions leave the
/// circle by more than a fifth of R. At both ends of a run, rows that do not leave the angle of the first or the last one are a stop or an
/// approach along the radius, and rows off the circle are an approach along a line or an arc: those more than six times the usual
/// deviation of the command, or of the positions where there is no command. Then sectors of 5 degrees that take clearly longer than
/// usual are run-in and run-out, and so is one sector beside them. They stay, with a note, where less than a revolution, or of arcs less than kLeastArc, would be
/// left. Of what is left beyond whole laps, up to 15 degrees at both ends are left out too, where there are times: the drives
/// settle there. A gap of the time ends a run, and so does a jump of the angle: by 30 degrees, in a table without times by 5. In such a
/// table another part of the samples ends it too. The ends are those of the command where there is one: it has no noise.
///
///   p positions [m], R intended radius [m], c centre of the least-squares circle of all runs' rows, of the command where there is one
///
/// Not modelled: a feed that changes within a run. Real time: no. Errors: none; a record without a circle has no runs.

#include <cstddef>
#include <span>
#include <stribeck/ident/circle/radial_error.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::circle {

struct CircleRun {
  bool counter_clockwise = true;
  std::size_t first = 0;  ///< row of the record
  std::size_t last = 0;   ///< row after the last one
  double revolutions = 0.0;
  double feed = 0.0;          ///< [m/s]; NaN: the record has no times; the caller may set it
  std::vector<double> angle;  ///< of the positions; goes on from lap to lap [rad]
  std::vector<double> error;  ///< [m]
  std::vector<double> time;   ///< [s]; empty: none
  std::vector<int> lap;       ///< 0, 1, …; the last may be a part
};

struct CircleMotion {
  AxisNames axes{"x", "y"};  ///< set by the caller
  double radius = 0.0;       ///< intended [m]
  double centre_x = 0.0;
  double centre_y = 0.0;
  bool commanded = false;    ///< the centre is that of the command
  bool scale = false;        ///< set by the caller: the positions are those of scales at the table
  bool arcs = false;         ///< no run is a whole revolution
  bool ball_bar = false;     ///< set by the caller: distances from the centre alone are measured
  double longest_arc = 0.0;  ///< in one direction [rad]
  std::vector<CircleRun>
      runs;  ///< of at least a revolution, or where there are none, of kLeastArc; in order of time
  std::vector<std::string> notes;
};

/// The whole laps of an arc, but for a fiftieth of a lap; of less than a lap all of it [rad]. A fit takes them alone: a part that is
/// travelled twice would weigh double.
double whole_laps(double arc);

/// `time` may be empty.
CircleMotion circle_motion(const CircleSamples& samples, std::span<const double> time, double radius);

}  // namespace stribeck::ident::circle
