#pragma once
/// Reads the canonical calls of LinuxCNC's stand-alone interpreter, one per line, as moves of the machine.
///
///      8 N..... STRAIGHT_FEED(10.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)
///
///   machine = R_z(rotation)·(program + G92 offset) + G5x offset + tool offset       rotation about z, counter-clockwise
///   arcs      ARC_FEED(end, end, centre, centre, turns, end along the axis, a, b, c): both ends in the plane, XY: (x, y),
///             YZ: (y, z), XZ: (z, x); turns > 0 counter-clockwise seen from the positive end of the third axis
///
///   An arc whose end is printed as its start is goes once around, and ends exactly there.
///   Numbers come with four decimals of the unit in force: 0.1 µm in millimetres, 2.54 µm in inches.
///
/// Motion waits (a stop) at dwells, unless before the first move, and where spindle, coolant, tool or program stop are called. Feed per revolution, motion
/// synchronised with the spindle, probing, rotary and secondary axes, NURBS and calls that are not known are refused; lines without the form of a
/// call are what the program prints. G64 P is in the unit in force; without P the tolerance is left to the caller.
/// A feed is in the unit in force when it was set: F of a line is before its G20 or G21.
/// Source: src/emc/sai/saicanon.cc, src/emc/task/emccanon.cc (order of the offsets) of LinuxCNC 2.9.
/// Real time: no.
/// Errors: InputError naming the program and the move.

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::io {

/// How exactly the path is followed at the end of a move.
enum class PathControl { kContinuous, kExactPath, kExactStop };

/// One motion in machine coordinates; SI.
struct CanonicalMove {
  std::array<double, 3> to{};
  bool arc = false;
  std::array<double, 3> centre{};
  std::array<double, 3> normal{};
  int turns = 0;
  double feed = std::numeric_limits<double>::infinity();  ///< along the path [m/s]; infinite: rapid
  PathControl control = PathControl::kContinuous;
  std::optional<double> tolerance{};  ///< of G64 P [m]; absent: not given
  bool waits = false;                 ///< the motion must end before the next call
  double dwell = 0.0;                 ///< dwell after that [s]
};

/// A feed that was set in one unit of length and is used under another.
struct ForeignFeed {
  double feed = 0.0;       ///< [m/s]
  bool in_inches = false;  ///< the unit that it was set in
};

/// Largest number of moves: planned, they take 1 GB (100 000 take 0.2 GB).
inline constexpr std::size_t kMostMoves = 500000;

class CanonicalReader {
 public:
  /// `program` is its name in error messages.
  explicit CanonicalReader(std::string program) : program_(std::move(program)) {}

  /// Reads one line, without its line end.
  void line(std::string_view text);

  [[nodiscard]] const std::vector<CanonicalMove>& moves() const noexcept { return moves_; }
  /// Whether a part of the program was in inches.
  [[nodiscard]] bool inches() const noexcept { return inches_seen_; }
  /// Whether an arc goes once around: its end is printed as its start.
  [[nodiscard]] bool once_around() const noexcept { return around_seen_; }
  /// Whether a tool was called.
  [[nodiscard]] bool tools() const noexcept { return tools_seen_; }
  /// The first such feed; absent: every feed is used in the unit in which it was set.
  [[nodiscard]] const std::optional<ForeignFeed>& foreign_feed() const noexcept { return foreign_feed_; }

 private:
  enum class Plane { kXy, kYz, kXz };

  [[noreturn]] void refuse(std::string_view call, const std::string& why) const;
  std::vector<double> numbers(std::string_view call, std::string_view arguments, std::size_t count) const;
  std::array<double, 3> machine(const std::array<double, 3>& program) const;
  std::array<double, 3> rotated(const std::array<double, 3>& v) const;
  void motion(std::string_view call, CanonicalMove move, const std::array<double, 3>& end);
  void straight(std::string_view call, std::string_view arguments);
  void arc(std::string_view call, std::string_view arguments);
  void wait(double seconds);
  bool set(std::string_view call, std::string_view arguments);

  std::string program_;
  std::vector<CanonicalMove> moves_;
  std::array<double, 3> here_{};  ///< program coordinates, in the unit in force times unit_ [m]
  std::array<double, 3> g5x_{};
  std::array<double, 3> g92_{};
  std::array<double, 3> tool_{};
  std::array<double, 3> rotary_{};
  double rotation_ = 0.0;    ///< [rad]
  double unit_ = 1e-3;       ///< [m]
  double feed_ = 0.0;        ///< [m/s]
  double feed_unit_ = 1e-3;  ///< unit in which feed_ was set [m]
  std::optional<ForeignFeed> foreign_feed_;
  bool per_revolution_ = false;
  Plane plane_ = Plane::kXy;
  PathControl control_ = PathControl::kContinuous;
  std::optional<double> tolerance_;
  bool frame_changed_ = false;  ///< since the last move
  bool inches_seen_ = false;
  bool around_seen_ = false;
  bool tools_seen_ = false;
};

}  // namespace stribeck::io
