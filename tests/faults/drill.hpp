#pragma once
/// A machine of machines/ in closed loop under any controller, with supervision, and something that breaks on the way: the set-up of
/// the tests of this folder.
///
/// Controllers know the friction of the plant exactly. What breaks stands between encoder and controller, or between controller and
/// drive.

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <stribeck/control/supervision/supervisor.hpp>
#include <stribeck/sim/compare.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/sim/study/loop_margins.hpp>
#include <string>
#include <vector>

namespace stribeck::test {

struct Drill {
  std::string machine;                ///< of machines/, without .toml
  std::optional<sim::Machine> drawn;  ///< in place of it
  sim::ControllerSpec controller;
  sim::Travel travel;
  std::vector<std::size_t> axes;  ///< empty: the first ones
  double duration = 4.0;          ///< of the run, at most [s]
  bool supervised = true;
  double omega = 0.0;     ///< of the loop, for supervision [rad/s]; 0: not known to it
  double friction = 1.0;  ///< friction and mass of the plant against what controllers know
  double mass = 1.0;
  std::optional<plant::AxialMode> mode;        ///< of the plant; controllers know a rigid axis
  std::optional<sim::AxisValues> force_limit;  ///< in place of the machine's [N]
  double command_lost = std::numeric_limits<double>::infinity();  ///< from when on the reference is NaN [s]
  std::uint64_t seed = 1;
  /// What the controller reads in place of the encoder's position [m].
  std::function<double(double time, std::size_t axis, double reading)> encoder;
  /// What acts in place of the force that was asked for [N].
  std::function<double(double time, std::size_t axis, double force)> force;
};

/// What happened, tick by tick.
struct Tick {
  double time = 0.0;
  double error = 0.0;               ///< largest true tracking error over the axes [m]
  sim::AxisValues position, force;  ///< true [m], put out [N]
  bool limited = false;             ///< the force of an axis was cut
};
struct Drilled {
  std::vector<Tick> ticks;
  double period = 0.0;
  sim::AxisValues limit;  ///< of the force [N]
  control::Fault fault = control::Fault::kNone;
  double tripped = -1.0;  ///< when [s]; below 0: never
  std::uint32_t bridged = 0;

  /// Largest tracking error from `begin` to before `end` [m].
  [[nodiscard]] double worst(double begin, double end) const;
  /// How far an axis has moved since then, at most [m].
  [[nodiscard]] double moved(std::size_t axis, double since,
                             double until = std::numeric_limits<double>::infinity()) const;
  /// Of the fastest axis at that time [m/s].
  [[nodiscard]] double speed(double time) const;
  [[nodiscard]] std::size_t limited(double begin, double end) const;  ///< ticks
  /// Every force is a number within the limit.
  [[nodiscard]] bool forces_good() const;
  /// From this fault on [s] until the forces stay the same; infinite: they never do.
  [[nodiscard]] double safe_after(double since) const;
};

Drilled run(const Drill&);
/// Of its linear loop with the axial modes of the machine, and with the masses that controllers know.
sim::LoopMargins margins(const Drill&);
sim::Machine machine_of(const std::string& name);
/// Every controller of an experiment's first setting on its last travel, which is the fastest.
std::vector<Drill> drills_of(const std::string& experiment);
/// Every controller of these experiments: contouring with each compensation and observer, predictive, sliding mode; and the laws for
/// comparison, on two axes.
std::vector<Drill> all_drills();
std::string name_of(const Drill&);

}  // namespace stribeck::test
