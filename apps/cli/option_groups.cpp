#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include <apps/cli/expected.hpp>
#include <apps/cli/option_groups.hpp>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/core/fields.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/path/path_options.hpp>

namespace stribeck::cli {

using namespace workflow;

namespace {

template <NamedEnum E>
CLI::Validator names_of() {
  return one_of(words_of<E>());
}

}  // namespace

void add_log_options(CLI::App& verb, LogArguments& arguments) {
  LogOptions& o = arguments.options;
  verb.add_option("--axis", o.axis,
                  "Name of the axis; a log of several axes has columns like x_NAME or NAME_ActualPosition")
      ->type_name("NAME");
  verb.add_option(
          "--map", o.maps,
          "Which column is what, repeatable: quantity=\"column unit\", e.g. x=\"Istposition mm\"; none=\"column\": not used")
      ->type_name("MAP");
  verb.add_option(
          "--gain", o.gain,
          "Force per volt, ampere, newton metre or percent, e.g. \"1048 N/V\"; left out: the log's own unit")
      ->type_name("GAIN");
  verb.add_option(
          "--lead", o.lead,
          "Travel per turn of the motor, e.g. \"5 mm\", of a rotary axis \"360 deg\": angles become positions, torque force")
      ->type_name("LEAD");
  verb.add_option("--where", o.where, "Only rows with this value, repeatable")->type_name("COLUMN=VALUE");
  verb.add_option("--runs", o.runs, "A change in this column begins a new run, repeatable")
      ->type_name("COLUMN");
  verb.add_option("--sample-time", o.sample_time,
                  "Time between rows of a log without a time column, e.g. \"1 ms\" or \"125 us\"")
      ->type_name("TIME");
  verb.add_option("--keep", o.keep,
                  "Do not repair findings of this kind, repeatable (--inspect shows the kinds)")
      ->type_name("KIND");
  verb.add_option("--map-file", arguments.map_file,
                  "TOML file with map, axis, gain, lead, where, runs, sample_time, keep")
      ->type_name("MAP.toml");
}

void add_parameter_options(CLI::App& verb, ParameterOptions& options) {
  verb.add_option(
          "--parameters", options.source,
          "Parameters of the compensators: identified (from simulated logs of this machine) or thesis (as printed there)")
      ->check(one_of({"identified", "thesis"}))
      ->capture_default_str();
  verb.add_option(
          "--axis-file", options.axis_files,
          "Axis file written by identify, for one axis; repeat for more axes or for a second kind of model")
      ->type_name("AXIS=FILE");
  verb.add_option(
          "--lost-motion", options.lost_motion,
          "Compensation of backlash and wind-up that an axis file, or the logs of two encoders, tell: on or off")
      ->check(one_of({"on", "off"}))
      ->capture_default_str();
}

void add_path_options(CLI::App& verb, PathOptions& o) {
  const std::size_t before = verb.get_options().size();
  const auto path_or_program = [](std::string& text) {
    if (text.find('.') != std::string::npos || text.find('/') != std::string::npos) return std::string();
    const std::string refused = names_of<path::Shape>()(text);
    return refused.empty() ? refused : refused + ", nor a file like part.ngc or points.csv";
  };
  verb.add_option(
          "--path", o.path,
          "circle, eight, trifolium, a G-code file (read by LinuxCNC's interpreter), or a CSV file of points, one column for each axis")
      ->check(CLI::Validator(path_or_program, "SHAPE|PART.ngc|POINTS.csv"))
      ->capture_default_str();
  verb.add_option(
          "--axes", o.axes,
          "Axes of the shape, in its order, e.g. --axes x,z for a circle in that plane; left out: the first ones, for the "
          "circle of a machine of your own those that do not turn")
      ->delimiter(',')
      ->type_name("NAME");
  verb.add_option(
          "--size", o.size,
          "Radius of the circle, half width of the eight, length of a leaf of the trifolium; left out: 10 mm, on a machine of your own by its "
          "travel")
      ->type_name("LENGTH");
  verb.add_option("--laps", o.laps, "Number of laps at constant speed; these laps are evaluated")
      ->check(number_from(0.25, 1000.0))
      ->capture_default_str();
  verb.add_option(
          "--omega-t", o.omega_t,
          "Double pole of the loop along the path; left out: 40 rad/s, on a machine of your own its omega")
      ->type_name("RATE");
  verb.add_option(
          "--omega-n", o.omega_n,
          "Double pole of the loop across the path; left out: 40 rad/s, on a machine of your own its omega")
      ->type_name("RATE");
  verb.add_option("--observer-pole", o.observer_pole, "Both poles of the disturbance observer")
      ->type_name("RATE")
      ->capture_default_str();
  verb.add_option("--observer", o.observer, "Observer of the controllers (d) to (f): disturbance or kalman")
      ->check(one_of({"disturbance", "kalman"}))
      ->capture_default_str();
  verb.add_option(
          "--error-rate", o.error_rate,
          "Rate of the tracking error: difference-of-error, observed (by the Kalman observer), or late (half a sample delayed, for comparison)")
      ->check(names_of<control::ErrorRate>())
      ->capture_default_str();
  verb.add_option(
          "--acceleration", o.acceleration,
          "Part program or points: largest acceleration of each axis, at most the limit of the machine; left out: that limit")
      ->type_name("ACCELERATION");
  verb.add_option(
          "--jerk", o.jerk,
          "Part program or points: largest jerk of each axis; left out: the limit of the machine, or the jerk that reaches its acceleration in 0.1 s")
      ->type_name("JERK");
  verb.add_option(
          "--corner-tolerance", o.corner_tolerance,
          "Part program or points: largest deviation at rounded corners where the program gives no G64 P, or of a spline from its points")
      ->type_name("LENGTH")
      ->capture_default_str();
  verb.add_option_function<std::string>(
          "--join", [&o](const std::string& word) { o.join = *enum_value<PointJoin>(word); },
          "Points: corners (straight lines with rounded corners) or spline (one smooth curve); left out: corners")
      ->check(names_of<PointJoin>());
  const auto all = verb.get_options();
  for (std::size_t i = before; i < all.size(); ++i)
    all[i]->each([&o](const std::string&) { o.given = true; });
  // Of the simulation, not of the path.
  verb.add_option("--accuracy", o.accuracy,
                  "Accuracy of the simulated contour error; it determines the number of sub-steps")
      ->type_name("LENGTH")
      ->capture_default_str();
}

}  // namespace stribeck::cli
