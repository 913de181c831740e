#pragma once
/// Options of a run along a path, the same for every verb that has them.
/// Real time: no.

#include <array>
#include <stribeck/core/fields.hpp>
#include <stribeck/sim/compare.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::workflow {

/// Kind of path that --path names.
enum class PathSource { kShape, kProgram, kPoints };

/// How the points of a CSV file become a path (point_path.hpp).
enum class PointJoin { kCorners, kSpline };

struct PathOptions {
  std::string path = "circle";
  std::vector<std::string>
      axes;  ///< of a shape, in its order; empty: the first ones, for the circle of a machine of one's own those that do not turn
  std::string size;  ///< empty: 10 mm; of a machine of one's own by its travel
  double laps = 2.0;
  std::string omega_t;  ///< empty: 40 rad/s; of a machine of one's own its commissioning.omega
  std::string omega_n;  ///< the same
  std::string observer_pole = "20 1/s";
  std::string accuracy = "1 nm";
  std::string observer = "disturbance";
  std::string error_rate = "difference-of-error";
  PointJoin join = PointJoin::kCorners;
  // of a part program and of points
  std::string acceleration;  ///< empty: of the machine file
  std::string jerk;          ///< empty: of the machine file
  std::string corner_tolerance = "10 um";

  bool given = false;  ///< true where any option was given, even with its default value

  friend bool operator==(const PathOptions&, const PathOptions&) = default;
};

/// A CSV file of points, a G-code file or one of the shapes.
PathSource source_of(const PathOptions& options);

/// Whether --path names a file.
inline bool is_file(const PathOptions& options) { return source_of(options) != PathSource::kShape; }

/// The path, travelled at a speed [m/s].
sim::Travel make_travel(const PathOptions& options, double speed);

/// Controllers (a) to (f) with the options' gains and observer.
std::vector<sim::ControllerSpec> make_controllers(const PathOptions& options);

/// The experiment whose circle the options of a path vary.
inline constexpr const char* kVaried = "bi-table";
/// The motion for a machine without published parameters: a circle through its axes, in the middle of their travel, with radius and
/// speeds as its limits allow.
inline constexpr const char* kOwn = "own";

/// The default experiment for a machine, for the options of a path and the speeds that were given.
std::string default_experiment(const sim::Machine& machine, const PathOptions& path,
                               const std::vector<std::string>& speeds = {});

/// Names of all experiments.
std::vector<std::string> experiment_ids();

/// Path, speeds and controllers of an experiment of sim/experiments.hpp, on the axes that this machine has.
sim::CompareSpec printed_spec(const std::string& experiment, const sim::Machine& machine,
                              const std::string& machine_file);

/// Path, speeds and the thesis's own controllers of an experiment; options of a path and speeds are allowed with kVaried and kOwn only.
sim::CompareSpec experiment_spec(const std::string& experiment, const PathOptions& path,
                                 const std::vector<std::string>& speeds, const sim::Machine& machine,
                                 const std::string& machine_file);

/// Sets the travels of a spec from the options of a path, at speeds [m/s].
void use_path(sim::CompareSpec& spec, const PathOptions& path, const std::vector<double>& speeds,
              const sim::Machine& machine, const std::string& machine_file);

/// Adds a controller that was given as `name`; refuses an id that exists already.
void add_controller(std::vector<sim::ControllerSpec>& controllers, sim::ControllerSpec more,
                    const std::string& name);

/// Adds controllers beyond the thesis to those of an experiment; an empty name means the circle of the biaxial table.
/// Not with printed parameters, which have no bristles.
void add_beyond(std::vector<sim::ControllerSpec>& controllers, const std::string& experiment,
                const ParameterOptions& parameters);

/// The controller that is used by default: the adapting one where there is one, else the last of the first `printed`.
const sim::ControllerSpec& default_controller(const std::vector<sim::ControllerSpec>& controllers,
                                              std::size_t printed);

/// A controller of the experiment by its id, a built-in one by its name, or that of a file; refuses anything else.
sim::ControllerSpec chosen_controller(const std::vector<sim::ControllerSpec>& known, const std::string& name);

double make_accuracy(const PathOptions& options);

/// Refuses a path that the machine cannot travel: number of axes, travel, speed, acceleration, length.
void check_travel(const sim::Machine& machine, const std::string& machine_file, const sim::CompareSpec& spec);

}  // namespace stribeck::workflow

template <>
struct stribeck::EnumNames<stribeck::workflow::PointJoin> {
  static constexpr std::array names{
      std::pair{stribeck::workflow::PointJoin::kCorners, std::string_view{"corners"}},
      std::pair{stribeck::workflow::PointJoin::kSpline, std::string_view{"spline"}}};
};
