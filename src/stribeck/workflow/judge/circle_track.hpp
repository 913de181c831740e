#pragma once
/// The columns of a log of a circle: positions and commands, or angle and radius of a ball-bar.
/// Real time: no.
/// Errors: InputError naming the log, the column or the option.

#include <cmath>
#include <cstddef>
#include <map>
#include <stribeck/ident/circle/radial_error.hpp>
#include <stribeck/io/log/log.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct CircleTrack {
  ident::circle::AxisNames axes{"x", "y"};  ///< those that `x` and `y` hold
  std::vector<double> x;                    ///< [m]
  std::vector<double> y;
  std::vector<double> rx;  ///< empty: no command
  std::vector<double> ry;
  std::vector<double> t;         ///< empty: no times
  std::vector<std::size_t> row;  ///< of the log
  std::vector<int> part;         ///< of a ball-bar whose rows tell their direction; empty: not known
  bool scale = false;            ///< positions of scales at the table, beside those of the motors
  bool ball_bar = false;
  bool turned =
      false;  ///< rows of a ball-bar stand against their told direction, and were put into reversed order
  double feed = std::nan("");  ///< stated, where the log has no times [m/s]
  std::vector<std::string> notes;

  [[nodiscard]] ident::circle::CircleSamples samples() const { return {x, y, rx, ry, row, part}; }
  /// One row of `from`, behind those that are there.
  void append(const CircleTrack& from, std::size_t at);
  /// No samples, all else as here.
  [[nodiscard]] CircleTrack empty_copy() const;
};

/// What --map gives: quantity, column.
using CircleMap = std::map<std::string, std::string>;
CircleMap circle_map(const std::vector<std::string>& texts);
/// Whether --map has this word for a circle.
bool is_word_of_circle(const std::string& word);

/// One radius for all logs.
struct CircleRadius {
  double value = 0.0;  ///< [m]
  std::string note{};  ///< of one that was rounded, or is another than a file states
};

/// `size` is the text of --size; empty: what a ball-bar's file states, else that of the commanded circle in the first log, else that of
/// the measured one, rounded to a number that people command.
CircleRadius circle_radius(const std::vector<io::Log>& logs, const CircleMap& map, const std::string& size);

/// All rows; the axes of the circle are those that move in the rows of --where, all rows where that is empty.
CircleTrack circle_track(const io::Log& log, const CircleMap& map, double radius,
                         const std::string& where = {});

/// Times of the rows [s]; empty where the log has none of one unit for all.
std::vector<double> circle_times(const io::Log& log, std::size_t rows);

}  // namespace stribeck::workflow
