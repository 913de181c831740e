#pragma once
/// What can break on a machine, how it is brought about in a simulation, and the end that is declared for it.

#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <stribeck/control/setup.hpp>
#include <string>
#include <vector>

namespace stribeck::test {

/// What a fault needs to know of the machine and of its sound run.
struct Sound {
  double period = 0.0;  ///< [s]
  double when = 0.0;    ///< it breaks [s]
  double speed = 0.0;   ///< of the fastest axis then [m/s]
  std::size_t axes = 0;
  std::array<double, control::kMostAxes> resolution{};  ///< of the encoder [m]
  std::array<double, control::kMostAxes> limit{};       ///< of the force [N]
  std::array<double, control::kMostAxes> peak{};        ///< of the force in the sound run [N]
};

/// What stands between controller and plant, and how the plant differs from what is known.
struct Broken {
  std::function<double(double time, std::size_t axis, double reading)> encoder;
  std::function<double(double time, std::size_t axis, double force)> force;
  double friction = 1.0;
  double mass = 1.0;
  std::optional<std::array<double, control::kMostAxes>> force_limit{};
  bool mode = false;  ///< half of the mass on a spring, 40 Hz
  double command_lost = std::numeric_limits<double>::infinity();
};

enum class End {
  kGoesOn,      ///< the machine goes on; `most`: by how much the error grows, at most
  kGoesOnSoon,  ///< the same, and 0.2 s later the error is as before
  kStops,       ///< the machine is stopped; `most`: how far an axis still moves
  kEither       ///< by how bad it is; `most` holds for the growth of the error and for the way
};

enum class Since {
  kWhen,           ///< it breaks on the way
  kStart,          ///< the machine is another one than is known
  kStartEachAxis,  ///< the same, once for each axis
};

struct Break {
  std::string name;
  End end = End::kEither;
  double most = 0.0;        ///< [m]
  bool with_speed = false;  ///< `most` is at 10 mm/s, and grows in proportion above that
  Since since = Since::kWhen;
  std::function<void(Broken&, const Sound&, std::size_t axis)> bring_about;
};

/// All of them, in the order of the table.
std::vector<Break> all_breaks();

}  // namespace stribeck::test
