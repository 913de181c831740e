#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <apps/cli/path_options.hpp>
#include <apps/cli/shared.hpp>

namespace stribeck::cli {
namespace {

template <NamedEnum E>
E value_of_name(const std::string& wanted) {
  E found{};
  for (const auto& [value, name] : EnumNames<E>::names) {
    if (name == wanted) found = value;
  }
  return found;
}

template <NamedEnum E>
CLI::IsMember names_of() {
  std::vector<std::string> names;
  for (const auto& [value, name] : EnumNames<E>::names) names.emplace_back(name);
  return CLI::IsMember(names);
}

}  // namespace

void add_path_options(CLI::App& verb, PathOptions& o) {
  verb.add_option("--path", o.path, "circle, eight or trifolium")
      ->check(names_of<path::Shape>())
      ->capture_default_str();
  verb.add_option("--size", o.size, "Radius of the circle, half width of the others")
      ->type_name("LENGTH")
      ->capture_default_str();
  verb.add_option("--laps", o.laps, "Laps at constant speed, which are scored")
      ->check(CLI::Range(0.25, 1000.0))
      ->capture_default_str();
  verb.add_option("--omega-t", o.omega_t, "Double pole of the loop along the path")
      ->type_name("RATE")
      ->capture_default_str();
  verb.add_option("--omega-n", o.omega_n, "Double pole of the loop across the path")
      ->type_name("RATE")
      ->capture_default_str();
  verb.add_option("--observer-pole", o.observer_pole, "Both poles of the disturbance observer")
      ->type_name("RATE")
      ->capture_default_str();
  verb.add_option("--observer", o.observer, "Observer of the controllers (d) to (f): disturbance or kalman")
      ->check(CLI::IsMember({"disturbance", "kalman"}))
      ->capture_default_str();
  verb.add_option("--error-rate", o.error_rate,
                  "Rate of the tracking error: difference-of-error, or late for comparison")
      ->check(names_of<control::ErrorRate>())
      ->capture_default_str();
  verb.add_option("--accuracy", o.accuracy,
                  "Accuracy of the simulated contour error, which decides the sub-steps")
      ->type_name("LENGTH")
      ->capture_default_str();
}

sim::CompareSpec make_spec(const PathOptions& o) {
  sim::CompareSpec s;
  s.curve.shape = value_of_name<path::Shape>(o.path);
  s.curve.size = option_si("--size", o.size, quantity("m", "mm").positive());
  if (!std::isfinite(o.laps)) refuse_option("--laps", "expected a finite number");
  s.laps = o.laps;
  s.omega_t = option_si("--omega-t", o.omega_t, quantity("rad/s", "rad/s").positive());
  s.omega_n = option_si("--omega-n", o.omega_n, quantity("rad/s", "rad/s").positive());
  s.observer_pole = option_si("--observer-pole", o.observer_pole, quantity("1/s", "1/s").positive());
  s.observer = value_of_name<control::Observer>(o.observer);
  s.error_rate = value_of_name<control::ErrorRate>(o.error_rate);
  s.accuracy = option_si("--accuracy", o.accuracy, quantity("m", "nm").at_least(1e-12));
  return s;
}

void check_travel(const sim::Machine& machine, const std::string& machine_file,
                  const sim::CompareSpec& spec) {
  if (machine.axes.size() != 2) {
    throw io::InputError(
        {machine_file, 0, "axes",
         fmt::format("a plane path needs two axes, the machine has {}", machine.axes.size())});
  }
  constexpr int kPoints = 720;
  constexpr double kMostTicks = 2e6;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& [name, axis] = machine.axes[i];
    for (int k = 0; k < kPoints; ++k) {
      const double x = spec.curve.point(spec.curve.period() * k / kPoints)[i];
      if (x < axis.limits.travel_min || x > axis.limits.travel_max) {
        refuse_option(
            "--size",
            fmt::format("the path leaves the travel of axis {}, {:.6g} to {:.6g} mm (choose a smaller size)",
                        name, axis.limits.travel_min * 1e3, axis.limits.travel_max * 1e3));
      }
    }
    for (const double speed : spec.speeds) {
      double fastest = 0.0;
      for (int k = 0; k < kPoints; ++k) {
        const auto q = spec.curve.derivatives<2>(spec.curve.period() * k / kPoints);
        // Centripetal part of q'' for constant speed, on this axis.
        const double stretch = dot(q[1], q[1]);
        fastest = std::max(fastest,
                           speed * speed * std::abs(q[2][i] - q[1][i] * dot(q[1], q[2]) / stretch) / stretch);
      }
      fastest = std::max(fastest, 1.875 * speed / spec.run_in);
      if (fastest > axis.limits.acceleration) {
        refuse_option(
            "--speed",
            fmt::format(
                "{:.6g} mm/s on this path needs {:.4g} mm/s2 of axis {}, above its limit of {:.4g} mm/s2",
                speed * 1e3, fastest * 1e3, name, axis.limits.acceleration * 1e3));
      }
      const double ticks = spec.laps * spec.curve.lap_length() / speed / machine.sample_time;
      if (ticks > kMostTicks) {
        refuse_option(
            "--speed",
            fmt::format(
                "the run would take {:.3g} control periods, at most {:.3g} are simulated (choose a higher "
                "speed or fewer laps)",
                ticks, kMostTicks));
      }
      if (speed > axis.limits.speed) {
        refuse_option("--speed", fmt::format("{:.6g} mm/s is above the limit of axis {}, {:.6g} mm/s",
                                             speed * 1e3, name, axis.limits.speed * 1e3));
      }
    }
  }
}

}  // namespace stribeck::cli
