#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/gcode/canonical.hpp>

namespace stribeck::io {
namespace {

using Point = std::array<double, 3>;

/// Calls that do not affect the path of the axes.
constexpr std::array<std::string_view, 37> kHarmless{"COMMENT",
                                                     "MESSAGE",
                                                     "LOG",
                                                     "LOGOPEN",
                                                     "LOGAPPEND",
                                                     "LOGCLOSE",
                                                     "ON_RESET",
                                                     "PROGRAM_END",
                                                     "SET_FEED_REFERENCE",
                                                     "SET_TRAVERSE_RATE",
                                                     "SET_NAIVECAM_TOLERANCE",
                                                     "SET_SPINDLE_MODE",
                                                     "SET_SPINDLE_SPEED",
                                                     "SELECT_TOOL",
                                                     "CHANGE_TOOL_NUMBER",
                                                     "RELOAD_TOOLDATA",
                                                     "START_CHANGE",
                                                     "DISABLE_ADAPTIVE_FEED",
                                                     "DISABLE_FEED_HOLD",
                                                     "DISABLE_FEED_OVERRIDE",
                                                     "DISABLE_SPEED_OVERRIDE",
                                                     "ENABLE_ADAPTIVE_FEED",
                                                     "ENABLE_FEED_HOLD",
                                                     "ENABLE_FEED_OVERRIDE",
                                                     "ENABLE_SPEED_OVERRIDE",
                                                     "USE_NO_SPINDLE_FORCE",
                                                     "CLAMP_AXIS",
                                                     "UNCLAMP_AXIS",
                                                     "SET_MOTION_OUTPUT_BIT",
                                                     "CLEAR_MOTION_OUTPUT_BIT",
                                                     "SET_MOTION_OUTPUT_VALUE",
                                                     "SET_AUX_OUTPUT_BIT",
                                                     "CLEAR_AUX_OUTPUT_BIT",
                                                     "SET_AUX_OUTPUT_VALUE",
                                                     "STOP_SPEED_FEED_SYNCH",
                                                     "TURN_PROBE_OFF",
                                                     "SET_BLOCK_DELETE"};

/// Calls that LinuxCNC's task executes after the motion before them has ended.
constexpr std::array<std::string_view, 13> kWaits{"START_SPINDLE_CLOCKWISE",
                                                  "START_SPINDLE_COUNTERCLOCKWISE",
                                                  "STOP_SPINDLE_TURNING",
                                                  "ORIENT_SPINDLE",
                                                  "FLOOD_ON",
                                                  "FLOOD_OFF",
                                                  "MIST_ON",
                                                  "MIST_OFF",
                                                  "CHANGE_TOOL",
                                                  "PALLET_SHUTTLE",
                                                  "PROGRAM_STOP",
                                                  "OPTIONAL_PROGRAM_STOP",
                                                  "FINISH"};

template <std::size_t N>
bool one_of(std::string_view word, const std::array<std::string_view, N>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

void skip_blanks(std::string_view& text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Splits "   12 N..... CALL(arguments)" into its parts; false for a line of another form.
bool split(std::string_view text, std::string_view& call, std::string_view& arguments) {
  skip_blanks(text);
  if (text.empty() || !is_digit(text.front())) return false;
  while (!text.empty() && is_digit(text.front())) text.remove_prefix(1);
  skip_blanks(text);
  if (text.empty() || text.front() != 'N') return false;
  const std::size_t word = text.find(' ');
  if (word == std::string_view::npos) return false;
  text.remove_prefix(word);
  skip_blanks(text);
  const std::size_t open = text.find('(');
  if (open == std::string_view::npos || open == 0) return false;
  call = text.substr(0, open);
  const auto letter = [](char c) { return (c >= 'A' && c <= 'Z') || c == '_' || c == '.' || is_digit(c); };
  if (!std::all_of(call.begin(), call.end(), letter)) return false;
  const std::size_t close = text.rfind(')');
  if (close == std::string_view::npos || close < open) return false;
  arguments = text.substr(open + 1, close - open - 1);
  return true;
}

/// Largest distance of two notations of one place, in the unit in force: two roundings to four decimals, in two directions.
constexpr double kPrinted = 1.5e-4;

constexpr double kMillimetre = 1e-3;

}  // namespace

void CanonicalReader::refuse(std::string_view call, const std::string& why) const {
  throw InputError({program_, 0, fmt::format("move {} ({})", moves_.size() + 1, call), why});
}

std::vector<double> CanonicalReader::numbers(std::string_view call, std::string_view arguments,
                                             std::size_t count) const {
  std::vector<double> values;
  std::string_view rest = arguments;
  while (true) {
    while (!rest.empty() && (rest.front() == ' ' || rest.front() == ',')) rest.remove_prefix(1);
    if (rest.empty()) break;
    double value = 0.0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    // Beyond any machine; products and sums of larger ones would not stay finite.
    constexpr double kLargest = 1e9;
    if (error != std::errc() || !(std::abs(value) <= kLargest))
      refuse(call, fmt::format("got {}, expected {} finite numbers up to 1e9", in_quotes(arguments), count));
    values.push_back(value);
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  }
  if (values.size() != count)
    refuse(call, fmt::format("got {}, expected {} numbers", in_quotes(arguments), count));
  return values;
}

Point CanonicalReader::rotated(const Point& v) const {
  const double c = std::cos(rotation_);
  const double s = std::sin(rotation_);
  return {c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]};
}

Point CanonicalReader::machine(const Point& program) const {
  Point p = program;
  for (std::size_t i = 0; i < 3; ++i) p[i] += g92_[i];
  p = rotated(p);
  for (std::size_t i = 0; i < 3; ++i) p[i] += g5x_[i] + tool_[i];
  return p;
}

void CanonicalReader::motion(std::string_view call, CanonicalMove move, const Point& end) {
  if (moves_.size() >= kMostMoves) {
    refuse(call, fmt::format("expected at most {} moves (run the program in parts)", kMostMoves));
  }
  if (std::isfinite(move.feed)) {
    if (per_revolution_) refuse(call, "feed per revolution (G95) needs a spindle (use G94 or G93)");
    if (!(move.feed > 0.0))
      refuse(call, "the feed is 0.0000 as printed by the interpreter (give a higher F)");
    if (feed_unit_ != unit_ && !foreign_feed_) foreign_feed_ = ForeignFeed{feed_, feed_unit_ != kMillimetre};
  }
  here_ = end;
  frame_changed_ = false;
  move.to = machine(end);
  move.control = control_;
  move.tolerance = tolerance_;
  moves_.push_back(move);
}

void CanonicalReader::straight(std::string_view call, std::string_view arguments) {
  const std::vector<double> v = numbers(call, arguments, 6);
  for (std::size_t i = 0; i < 3; ++i) {
    if (v[3 + i] != rotary_[i]) refuse(call, "moves a rotary axis, expected moves of x, y and z only");
  }
  CanonicalMove move;
  if (call == "STRAIGHT_FEED") move.feed = feed_;
  motion(call, move, {unit_ * v[0], unit_ * v[1], unit_ * v[2]});
}

void CanonicalReader::arc(std::string_view call, std::string_view arguments) {
  const std::vector<double> v = numbers(call, arguments, 9);
  for (std::size_t i = 0; i < 3; ++i) {
    if (v[6 + i] != rotary_[i]) refuse(call, "moves a rotary axis, expected moves of x, y and z only");
  }
  constexpr double kMostTurns = 1e6;
  if (v[4] == 0.0 || v[4] != std::floor(v[4]) || std::abs(v[4]) > kMostTurns)
    refuse(call, fmt::format("got {:.6g} turns, expected a whole number other than 0", v[4]));
  const std::array<std::size_t, 3> axes = plane_ == Plane::kXy   ? std::array<std::size_t, 3>{0, 1, 2}
                                          : plane_ == Plane::kYz ? std::array<std::size_t, 3>{1, 2, 0}
                                                                 : std::array<std::size_t, 3>{2, 0, 1};
  Point end{};
  Point centre{};
  end[axes[0]] = unit_ * v[0];
  end[axes[1]] = unit_ * v[1];
  end[axes[2]] = unit_ * v[5];
  centre[axes[0]] = unit_ * v[2];
  centre[axes[1]] = unit_ * v[3];
  centre[axes[2]] = here_[axes[2]];
  Point normal{};
  normal[axes[2]] = 1.0;
  CanonicalMove move;
  move.arc = true;
  move.feed = feed_;
  move.centre = machine(centre);
  move.normal = rotated(normal);
  move.turns = static_cast<int>(v[4]);
  // A full circle if the end is printed equal to the start. Under another frame or unit than the start's, equal within rounding.
  const Point from = moves_.empty() ? Point{} : moves_.back().to;
  const Point to = machine(end);
  double along = 0.0;
  for (std::size_t k = 0; k < 3; ++k) along += (to[k] - from[k]) * move.normal[k];
  Point above{};  // the start, as far along the axis as the end
  for (std::size_t k = 0; k < 3; ++k) above[k] = from[k] + along * move.normal[k];
  const bool around =
      frame_changed_ ? std::hypot(to[0] - above[0], to[1] - above[1], to[2] - above[2]) <= kPrinted * unit_
                     : here_[axes[0]] == end[axes[0]] && here_[axes[1]] == end[axes[1]];
  motion(call, move, end);
  around_seen_ = around_seen_ || around;
  if (around) moves_.back().to = above;
}

void CanonicalReader::wait(double seconds) {
  // Before the first move there is no motion to wait for.
  if (moves_.empty()) return;
  moves_.back().waits = true;
  moves_.back().dwell += seconds;
}

/// Returns true for a call that sets something.
bool CanonicalReader::set(std::string_view call, std::string_view arguments) {
  const auto point = [&](const std::vector<double>& v, std::size_t first) {
    return Point{unit_ * v[first], unit_ * v[first + 1], unit_ * v[first + 2]};
  };
  const auto only_linear = [&](const std::vector<double>& v, std::size_t first) {
    for (std::size_t i = first; i < v.size(); ++i) {
      if (v[i] != 0.0)
        refuse(call, "offsets a rotary or secondary axis, expected offsets of x, y and z only");
    }
  };
  // An offset does not move the axes; it only changes the coordinates of their place.
  if (call == "USE_LENGTH_UNITS" || call == "SET_G5X_OFFSET" || call == "SET_G92_OFFSET" ||
      call == "USE_TOOL_LENGTH_OFFSET" || call == "SET_XY_ROTATION")
    frame_changed_ = true;
  if (call == "USE_LENGTH_UNITS") {
    if (arguments != "CANON_UNITS_MM" && arguments != "CANON_UNITS_INCHES")
      refuse(call, fmt::format("got {}, expected millimetres or inches", in_quotes(arguments)));
    const bool inches = arguments == "CANON_UNITS_INCHES";
    unit_ = inches ? 25.4e-3 : kMillimetre;
    inches_seen_ = inches_seen_ || inches;
  } else if (call == "SET_G5X_OFFSET") {
    const auto v = numbers(call, arguments, 7);
    only_linear(v, 4);
    g5x_ = point(v, 1);
  } else if (call == "SET_G92_OFFSET") {
    const auto v = numbers(call, arguments, 6);
    only_linear(v, 3);
    g92_ = point(v, 0);
  } else if (call == "USE_TOOL_LENGTH_OFFSET") {
    const auto v = numbers(call, arguments, 9);
    only_linear(v, 3);
    tool_ = point(v, 0);
  } else if (call == "SET_XY_ROTATION") {
    rotation_ = numbers(call, arguments, 1)[0] * kPi / 180.0;
  } else if (call == "SET_FEED_RATE") {
    feed_ = numbers(call, arguments, 1)[0] * unit_ / 60.0;
    feed_unit_ = unit_;
  } else if (call == "SET_FEED_MODE") {
    per_revolution_ = numbers(call, arguments, 2)[1] != 0.0;
  } else if (call == "SELECT_PLANE") {
    if (arguments == "CANON_PLANE_XY") {
      plane_ = Plane::kXy;
    } else if (arguments == "CANON_PLANE_YZ") {
      plane_ = Plane::kYz;
    } else if (arguments == "CANON_PLANE_XZ") {
      plane_ = Plane::kXz;
    } else {
      refuse(call,
             fmt::format("got {}, expected the plane XY, YZ or XZ (G17, G19 or G18)", in_quotes(arguments)));
    }
  } else if (call == "SET_MOTION_CONTROL_MODE") {
    tolerance_.reset();
    if (arguments == "CANON_EXACT_STOP") {
      control_ = PathControl::kExactStop;
    } else if (arguments == "CANON_EXACT_PATH") {
      control_ = PathControl::kExactPath;
    } else if (arguments.starts_with("CANON_CONTINUOUS,")) {
      control_ = PathControl::kContinuous;
      const double p = numbers(call, arguments.substr(arguments.find(',') + 1), 1)[0];
      if (p > 0.0) tolerance_ = unit_ * p;
    } else {
      refuse(call,
             fmt::format("got {}, expected exact stop, exact path or continuous", in_quotes(arguments)));
    }
  } else {
    return false;
  }
  return true;
}

void CanonicalReader::line(std::string_view text) {
  std::string_view call;
  std::string_view arguments;
  if (!split(text, call, arguments)) return;
  tools_seen_ = tools_seen_ || call == "SELECT_TOOL" || call == "CHANGE_TOOL";
  if (call == "STRAIGHT_FEED" || call == "STRAIGHT_TRAVERSE") {
    straight(call, arguments);
  } else if (call == "ARC_FEED") {
    arc(call, arguments);
  } else if (call == "DWELL") {
    const double seconds = numbers(call, arguments, 1)[0];
    if (!(seconds >= 0.0)) refuse(call, "got a negative time, expected 0 s or more");
    wait(seconds);
  } else if (one_of(call, kWaits) ||
             (call.starts_with("SPINDLE.") && call.ends_with(".WAIT_ORIENT_COMPLETE"))) {
    wait(0.0);
  } else if (!set(call, arguments) && !one_of(call, kHarmless)) {
    refuse(call, "is not supported here, expected lines and arcs of x, y and z (take it out of the program)");
  }
}

}  // namespace stribeck::io
