#pragma once
/// Tables of a ball-bar: an angle, and the distance from the instrument's centre or its deviation from the radius.
///
///   angle [deg], radius [mm]                                 one series, in order of the motion
///   angle [deg], deviation [um], direction                   a column tells the direction: ccw, cw; +, -; 1, -1
///   angle [deg], deviation ccw [um], deviation cw [um]       one column for each direction; others are left out
///
/// Columns are named by --map, or found by the words of their names in English and German. A second radius called nominal (Soll…)
/// is the nominal one. `# radius: 100 mm` and `# feed: 1000 mm/min` above the names state both for the whole file.
///
/// The angle counts from +x towards +y. A direction that is told goes before the order of the rows: rows of a clockwise circle that
/// stand by increasing angle are taken in reversed order, with a note. Angles that go forth and back under one direction are refused.
///
/// Not known here: errors along the circle; times, unless there is a column of them. Real time: no.
/// Errors: InputError naming file and column.

#include <optional>
#include <stribeck/workflow/judge/circle_track.hpp>
#include <stribeck/workflow/log/columns.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct BallBarColumns {
  struct Series {
    std::optional<bool> counter_clockwise;  ///< told by the names of its columns
    NamedColumn angle;
    NamedColumn radial;
    bool deviation = false;  ///< from the nominal radius; false: the radius itself
  };
  std::vector<Series> series;             ///< one, or one for each direction
  const io::Column* direction = nullptr;  ///< null: none
  std::vector<std::string> notes;         ///< columns left out, units replaced
};

/// Absent where the log has positions, or is no table of a ball-bar.
std::optional<BallBarColumns> ball_bar_columns(const io::Log& log, const CircleMap& map);

/// That the file gives, above its names or in a column [m].
std::optional<double> stated_radius(const io::Log& log);

/// That the file gives above its names [m/s].
std::optional<double> stated_feed(const io::Log& log);

/// A ball-bar measures the distance from its own centre: that is the centre of the command.
/// `mirrored`: the angle is counted from +x towards -y.
CircleTrack ball_bar_track(const io::Log& log, const BallBarColumns& columns, double radius,
                           bool mirrored = false);

}  // namespace stribeck::workflow
