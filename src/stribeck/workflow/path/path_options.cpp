#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stribeck/core/numbers.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/path/own_motion.hpp>
#include <stribeck/workflow/path/part_program.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <stribeck/workflow/path/point_path.hpp>
#include <system_error>

namespace stribeck::workflow {

PathSource source_of(const PathOptions& options) {
  if (enum_value<path::Shape>(options.path)) return PathSource::kShape;
  const auto extension = std::filesystem::path(options.path).extension();
  return extension == ".csv" || extension == ".CSV" ? PathSource::kPoints : PathSource::kProgram;
}

sim::Travel make_travel(const PathOptions& o, double speed) {
  return sim::along(*enum_value<path::Shape>(o.path),
                    option_si("--size", o.size.empty() ? "10 mm" : o.size, quantity("m", "mm").positive()),
                    speed, o.laps);
}

namespace {

/// One that is laid into the travel if it fits.
bool is_circle(const sim::Travel& travel) {
  const auto* curve = std::get_if<path::Curve>(&travel.path);
  return curve != nullptr && curve->shape == path::Shape::kCircle;
}

/// A circle that would leave the travel about position 0 is laid about the middle of the travel of its two axes.
void keep_circle_in_travel(sim::Travel& travel, const sim::Machine& machine, const sim::CompareSpec& spec) {
  if (!is_circle(travel) || (spec.axes.empty() && machine.axes.size() < 2)) return;
  const auto* curve = std::get_if<path::Curve>(&travel.path);
  const std::vector<std::size_t> axes = sim::chosen_axes(machine, spec);
  if (axes.size() < 2) return;
  path::Fourier<2> moved;
  bool leaves = false;
  for (std::size_t i = 0; i < 2; ++i) {
    const sim::AxisLimits& l = machine.axes[axes[i]].second.limits;
    const double middle = 0.5 * (l.travel_min + l.travel_max);
    if (middle - curve->size < l.travel_min) return;  // a smaller one is needed, and is asked for
    leaves = leaves || -curve->size < l.travel_min || curve->size > l.travel_max;
    moved.axis[i].offset = middle;
    moved.axis[i].terms = {path::Harmonic{curve->size, 1.0, i == 0 ? 0.0 : -0.5 * kPi}};
  }
  if (!leaves) return;
  travel.name = fmt::format("circle of {:.6g} mm about {:.6g}, {:.6g} mm", 1e3 * curve->size,
                            1e3 * moved.axis[0].offset, 1e3 * moved.axis[1].offset);
  travel.path = moved;
}

}  // namespace

std::vector<sim::ControllerSpec> make_controllers(const PathOptions& o) {
  const auto omega = [](const char* option, const std::string& text) {
    return option_si(option, text.empty() ? "40 rad/s" : text, quantity("rad/s", "rad/s").positive());
  };
  control::ContouringParams law =
      control::ContouringParams::critical(omega("--omega-t", o.omega_t), omega("--omega-n", o.omega_n));
  law.error_rate = *enum_value<control::ErrorRate>(o.error_rate);
  return sim::biaxial_controllers(law, *enum_value<control::Observer>(o.observer),
                                  option_si("--observer-pole", o.observer_pole, control::kObserverPole));
}

void use_path(sim::CompareSpec& spec, const PathOptions& path, const std::vector<double>& speeds,
              const sim::Machine& machine, const std::string& machine_file) {
  const PathSource source = source_of(path);
  const PathOptions standard;
  if (source != PathSource::kPoints && path.join != standard.join)
    refuse_option("--join", "applies to a CSV file of points as --path only");
  if (source != PathSource::kShape && !path.axes.empty())
    refuse_option("--axes", "a file has its own axes (leave it out)");
  if (source == PathSource::kProgram) return use_part(spec, path, machine, machine_file);
  if (source == PathSource::kPoints) return use_points(spec, path, speeds, machine);
  if (!path.acceleration.empty() || !path.jerk.empty() || path.corner_tolerance != standard.corner_tolerance)
    refuse_option("--acceleration, --jerk, --corner-tolerance",
                  "go with a G-code or CSV file as --path only");
  spec.travels.clear();
  spec.axes = named_axes(machine, machine_file, path);
  for (const double speed : speeds) {
    spec.travels.push_back(make_travel(path, speed));
    const std::size_t needed = spec.travels.back().axes();
    if (!spec.axes.empty() && spec.axes.size() != needed)
      refuse_option("--axes", fmt::format("got {} axes, expected {} for this path, e.g. --axes {}",
                                          spec.axes.size(), needed,
                                          needed == 2   ? "x,z"
                                          : needed == 1 ? "x"
                                                        : "x,y,z"));
    keep_circle_in_travel(spec.travels.back(), machine, spec);
  }
}

std::string default_experiment(const sim::Machine& machine, const PathOptions& path,
                               const std::vector<std::string>& speeds) {
  if (is_file(path)) return kVaried;
  if (!is_of_thesis(machine)) {
    // The five-axis path has its own size, speeds and axes, for a virtual mill; it is no motion for a machine that exists.
    const bool exists = std::any_of(machine.axes.begin(), machine.axes.end(),
                                    [](const auto& axis) { return !axis.second.truth_from.empty(); });
    const bool asked = !(path == PathOptions{}) || !speeds.empty();
    return machine.axes.size() == 5 && !exists && !asked ? "five-axis" : kOwn;
  }
  switch (machine.axes.size()) {
    case 1:
      return "uni-sim";
    case 2:
      return kVaried;
    case 5:
      return "five-axis";
    default:
      return "tri-circle";
  }
}

std::vector<std::string> experiment_ids() {
  std::vector<std::string> ids;
  for (const sim::Experiment& e : sim::experiments()) ids.push_back(e.id);
  ids.emplace_back(kOwn);
  return ids;
}

sim::CompareSpec printed_spec(const std::string& experiment, const sim::Machine& machine,
                              const std::string& machine_file) {
  const auto all = sim::experiments();
  sim::CompareSpec spec = sim::find_experiment(all, experiment)->settings.front().spec;
  for (sim::Travel& t : spec.travels) {
    auto* cone = std::get_if<path::ConeFrustum>(&t.path);
    if (cone == nullptr || machine.axes.size() < 5) continue;
    const auto turns = [&](std::size_t i) { return machine.axes[i].second.rotary; };
    if (turns(3) != turns(4))
      throw io::InputError({machine_file, 0,
                            fmt::format("axes.{}.rotary", machine.axes[turns(3) ? 4 : 3].first),
                            fmt::format("missing beside that of axis {}: {} turns both (write rotary = true)",
                                        machine.axes[turns(3) ? 3 : 4].first, experiment)});
    // An axis that says so is carried at 1 m; one that does not is a travel at the radius of the experiment.
    if (turns(3)) cone->table.radius = 1.0;
  }
  return spec;
}

namespace {

/// One pole for all axes, which the stiffest demand of friction and encoder allows; poles that were given stay.
PathOptions with_own_poles(PathOptions path, const sim::Machine& machine,
                           const std::vector<std::size_t>& axes) {
  double omega = kInfinity;
  for (const std::size_t i : axes) omega = std::min(omega, machine.axes[i].second.commissioning.omega);
  for (std::string* text : {&path.omega_t, &path.omega_n}) {
    if (text->empty()) *text = fmt::format("{} rad/s", omega);
  }
  return path;
}

}  // namespace

sim::CompareSpec experiment_spec(const std::string& experiment, const PathOptions& path,
                                 const std::vector<std::string>& speeds, const sim::Machine& machine,
                                 const std::string& machine_file) {
  if (experiment == kOwn) {
    sim::CompareSpec own = own_motion(machine, machine_file, path, speeds);
    own.controllers = make_controllers(with_own_poles(path, machine, own.axes));
    own.accuracy = make_accuracy(path);
    return own;
  }
  if (experiment != kVaried) {
    PathOptions rest = path;
    rest.accuracy = PathOptions{}.accuracy;
    if (!(rest == PathOptions{}) || !speeds.empty()) {
      refuse_option(
          "--experiment",
          fmt::format(
              "{} has its own path, speeds and gains: --path, --size and the other options of a path, and --speed, belong "
              "to {} and {}",
              experiment, kVaried, kOwn));
    }
    sim::CompareSpec printed = printed_spec(experiment, machine, machine_file);
    if (path.accuracy != rest.accuracy) printed.accuracy = make_accuracy(path);
    return printed;
  }
  sim::CompareSpec s;
  std::vector<double> in_si;
  for (const std::string& speed : speeds)
    in_si.push_back(option_si("--speed", speed, quantity("m/s", "mm/s").positive()));
  if (source_of(path) == PathSource::kProgram && !speeds.empty())
    refuse_option("--speed", "a part program has its own feed (leave it out)");
  const bool own = is_file(path) && !is_of_thesis(machine);
  if (in_si.empty() && own && source_of(path) == PathSource::kPoints) {
    sim::CompareSpec look = s;  // for its axes
    use_path(look, path, {1e-3}, machine, machine_file);
    in_si = own_speeds(machine, sim::chosen_axes(machine, look));
  }
  use_path(s, path, in_si.empty() ? std::vector<double>{3e-3, 9.5e-3} : in_si, machine, machine_file);
  s.controllers = make_controllers(own ? with_own_poles(path, machine, sim::chosen_axes(machine, s)) : path);
  s.accuracy = make_accuracy(path);
  return s;
}

void add_controller(std::vector<sim::ControllerSpec>& controllers, sim::ControllerSpec more,
                    const std::string& name) {
  for (const sim::ControllerSpec& other : controllers) {
    if (other.id == more.id) {
      refuse_option("--controller",
                    fmt::format("{}: there is a controller with the id {} already (choose another id)",
                                io::in_quotes(name), io::in_quotes(more.id)));
    }
  }
  controllers.push_back(std::move(more));
}

void add_beyond(std::vector<sim::ControllerSpec>& controllers, const std::string& experiment,
                const ParameterOptions& parameters) {
  const auto all = sim::experiments();
  const bool has = experiment.empty() || experiment == kOwn ||
                   sim::find_experiment(all, "beyond-" + experiment) != nullptr;
  if (!has || parameters.source == "thesis") return;
  for (sim::ControllerSpec& more : sim::beyond_controllers(controllers.back()))
    controllers.push_back(std::move(more));
}

const sim::ControllerSpec& default_controller(const std::vector<sim::ControllerSpec>& controllers,
                                              std::size_t printed) {
  for (const sim::ControllerSpec& c : controllers) {
    if (c.adaptation.enabled) return c;
  }
  return controllers[printed - 1];
}

sim::ControllerSpec chosen_controller(const std::vector<sim::ControllerSpec>& known,
                                      const std::string& name) {
  for (const sim::ControllerSpec& c : known) {
    if (c.id == name) return c;
  }
  const std::vector<std::string> built_in = built_in_controllers();
  std::error_code ignored;
  if (std::find(built_in.begin(), built_in.end(), name) == built_in.end() &&
      !std::filesystem::exists(name, ignored)) {
    std::vector<std::string> ids;
    for (const sim::ControllerSpec& c : known) ids.push_back(c.id);
    refuse_option("--controller",
                  fmt::format("got {}, expected a file, one of the experiment's {}, or one of {}",
                              io::in_quotes(name), report::listed(ids), report::listed(built_in)));
  }
  return read_controller(name);
}

namespace {

/// Middle of the range of one axis [m].
template <class Path>
double centre_of(const Path& path, std::size_t axis) {
  constexpr int kPoints = 720;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (int k = 0; k < kPoints; ++k) {
    const double q = path::derivatives<2>(path, path.period() * k / kPoints)[0][axis];
    low = std::min(low, q), high = std::max(high, q);
  }
  // A circle about 0 has its middle at some 1e-19.
  const double centre = 0.5 * (low + high);
  return std::abs(centre) < 1e-9 * (high - low) ? 0.0 : centre;
}

/// A path leaves the travel of an axis at a position; `centre` is that of the path [m].
[[noreturn]] void refuse_size(const std::string& axis, const sim::AxisLimits& limits, double at,
                              double centre) {
  refuse_option(
      "--size",
      fmt::format(
          "the path leaves the travel of axis {}, {:.6g} to {:.6g} mm, at {:.6g} mm ({})", axis,
          limits.travel_min * 1e3, limits.travel_max * 1e3, 1e3 * at,
          centre > limits.travel_min && centre < limits.travel_max
              ? std::string("choose a smaller size")
              : fmt::format(
                    "this shape is centred at position {:.6g} mm, outside the travel: give it as --path POINTS.csv inside the travel",
                    1e3 * centre)));
}

}  // namespace

double make_accuracy(const PathOptions& o) {
  return option_si("--accuracy", o.accuracy, quantity("m", "nm").at_least(1e-12));
}

void check_travel(const sim::Machine& machine, const std::string& machine_file,
                  const sim::CompareSpec& spec) {
  const std::size_t needed = spec.travels.front().axes();
  if (spec.axes.empty() && machine.axes.size() < needed) {
    throw io::InputError({machine_file, 0, "axes",
                          fmt::format("the path needs {} axes, the machine has {} (choose another path, or "
                                      "an --experiment for this machine)",
                                      needed, machine.axes.size())});
  }
  const std::vector<std::size_t> axes = sim::chosen_axes(machine, spec);
  constexpr int kPoints = 720;
  constexpr double kMostTicks = 2e6;
  for (const sim::Travel& travel : spec.travels) {
    const std::string pace = travel.pace_in_words();
    const double ticks = travel.duration() / machine.sample_time;
    if (travel.part() != nullptr) {
      // Parts are planned within the limits of the machine.
      if (ticks <= kMostTicks) continue;
      refuse_option("--path", fmt::format("the program would take {:.3g} control periods, at most {:.3g} are "
                                          "simulated (run it in parts)",
                                          ticks, kMostTicks));
    }
    if (!(ticks <= kMostTicks)) {
      refuse_option(
          "--speed",
          fmt::format(
              "the run would take {:.3g} control periods, at most {:.3g} are simulated (choose a higher "
              "speed or fewer laps)",
              ticks, kMostTicks));
    }
    std::visit(
        [&](const auto& path) {
          for (std::size_t i = 0; i < axes.size(); ++i) {
            const auto& [name, axis] = machine.axes[axes[i]];
            const auto& limits = axis.limits;
            double fastest = 0.0;
            double hardest = 0.0;
            for (int k = 0; k < kPoints; ++k) {
              const auto q = path::derivatives<2>(path, path.period() * k / kPoints);
              if (q[0][i] < limits.travel_min || q[0][i] > limits.travel_max)
                refuse_size(name, limits, q[0][i], centre_of(path, i));
              const double square = dot(q[1], q[1]);
              if (travel.pace == path::Pace::kRate) {
                fastest = std::max(fastest, travel.speed * std::abs(q[1][i]));
                hardest = std::max(hardest, travel.speed * travel.speed * std::abs(q[2][i]));
              } else {
                // Centripetal part of q'' at constant speed, on this axis.
                fastest = std::max(fastest, travel.speed * std::abs(q[1][i]) / std::sqrt(square));
                hardest =
                    std::max(hardest, travel.speed * travel.speed *
                                          std::abs(q[2][i] - q[1][i] * dot(q[1], q[2]) / square) / square);
              }
            }
            hardest = std::max(hardest, 1.875 * fastest / travel.run_in);
            if (hardest > limits.acceleration) {
              refuse_option(
                  "--speed",
                  fmt::format(
                      "{} on this path needs {:.4g} mm/s2 of axis {}, above its limit of {:.4g} mm/s2", pace,
                      hardest * 1e3, name, limits.acceleration * 1e3));
            }
            if (fastest > limits.speed) {
              refuse_option(
                  "--speed",
                  fmt::format("{} on this path needs {:.6g} mm/s of axis {}, above its limit of {:.6g} mm/s",
                              pace, fastest * 1e3, name, limits.speed * 1e3));
            }
          }
        },
        travel.path);
  }
}

}  // namespace stribeck::workflow
