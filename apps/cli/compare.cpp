#include <apps/cli/commands.hpp>
#include <apps/cli/parameters.hpp>
#include <apps/cli/shared.hpp>
#include <nlohmann/json.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/compare_report.hpp>
#include <stribeck/report/json.hpp>
#include <stribeck/report/table.hpp>

namespace stribeck::cli {
namespace {

struct Options {
  Common common;
  std::string machine;
  std::string experiment = "bi-table";
  ParameterOptions parameters;
  std::uint32_t trials = 10;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  std::vector<std::string> speeds;
  std::string path = "circle";
  std::string size = "10 mm";
  double laps = 2.0;
  std::string omega_t = "40 rad/s";
  std::string omega_n = "40 rad/s";
  std::string observer_pole = "20 1/s";
  std::string accuracy = "1 nm";
  std::string error_rate = "difference-of-error";
};

sim::CompareSpec make_spec(const Options& o) {
  sim::CompareSpec s;
  for (const auto& [shape, name] : EnumNames<path::Shape>::names) {
    if (name == o.path) s.curve.shape = shape;
  }
  for (const auto& [form, name] : EnumNames<control::ErrorRate>::names) {
    if (name == o.error_rate) s.error_rate = form;
  }
  s.curve.size = option_si("--size", o.size, quantity("m", "mm").positive());
  for (const std::string& speed : o.speeds) {
    s.speeds.push_back(option_si("--speed", speed, quantity("m/s", "mm/s").positive()));
  }
  if (s.speeds.empty()) s.speeds = {3e-3, 9.5e-3};
  s.laps = o.laps;
  s.omega_t = option_si("--omega-t", o.omega_t, quantity("rad/s", "rad/s").positive());
  s.omega_n = option_si("--omega-n", o.omega_n, quantity("rad/s", "rad/s").positive());
  s.observer_pole = option_si("--observer-pole", o.observer_pole, quantity("1/s", "1/s").positive());
  s.accuracy = option_si("--accuracy", o.accuracy, quantity("m", "nm").positive());
  s.controllers = sim::biaxial_controllers();
  s.trials = o.trials;
  s.seed = o.seed;
  s.threads = o.threads;
  return s;
}

/// The printed figures belong to one experiment: the circle of 10 mm at the gains of the table.
bool is_printed_experiment(const Options& o) {
  const Options standard;
  return o.experiment == "bi-table" && o.path == standard.path && o.size == standard.size && o.omega_t == standard.omega_t &&
         o.omega_n == standard.omega_n && o.observer_pole == standard.observer_pole && o.error_rate == standard.error_rate;
}

void check_travel(const sim::Machine& machine, const std::string& path, const sim::CompareSpec& spec) {
  if (machine.axes.size() != 2) {
    throw io::InputError({path, 0, "axes", fmt::format("the machine has {} axes, this experiment needs two", machine.axes.size())});
  }
  constexpr int kPoints = 720;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& [name, axis] = machine.axes[i];
    for (int k = 0; k < kPoints; ++k) {
      const double x = spec.curve.point(spec.curve.period() * k / kPoints)[i];
      if (x < axis.limits.travel_min || x > axis.limits.travel_max) {
        refuse_option("--size", fmt::format("the path leaves the travel of axis {}, {:.6g} to {:.6g} mm (choose a smaller size)", name,
                                            axis.limits.travel_min * 1e3, axis.limits.travel_max * 1e3));
      }
    }
    for (const double speed : spec.speeds) {
      if (speed > axis.limits.speed) {
        refuse_option("--speed", fmt::format("{:.6g} mm/s is above the limit of axis {}, {:.6g} mm/s", speed * 1e3, name,
                                             axis.limits.speed * 1e3));
      }
    }
  }
}

/// Logs and axis files beside the page, so that the way from log to model can be walked again with identify.
void write_evidence(const std::string& directory, const sim::Machine& machine, const Parameters& parameters) {
  for (std::size_t i = 0; i < parameters.learned.size(); ++i) {
    const std::string& name = machine.axes[i].first;
    const Learned& l = parameters.learned[i];
    io::write_csv(directory + "/" + name + "-pulses.csv", as_log(l.pulses));
    io::write_csv(directory + "/" + name + "-sine.csv", as_log(l.sine));
    const std::string origin = "Identified by stribeck " STRIBECK_VERSION " on the machine \"" + machine.name + "\", axis " + name;
    io::write_atomically(directory + "/" + name + "-conventional.toml",
                         io::write_toml(l.knowledge.conventional, origin + ", from " + name + "-pulses.csv."));
    io::write_atomically(directory + "/" + name + "-gaussian.toml",
                         io::write_toml(l.knowledge.gaussian,
                                        origin + ", from " + name + "-pulses.csv and " + name + "-sine.csv."));
  }
}

int compare(const Options& o) {
  check_outputs(o.common);
  const sim::Machine machine = load_machine(o.machine);
  const sim::CompareSpec spec = make_spec(o);
  check_travel(machine, o.machine, spec);
  const Parameters parameters = get_parameters(machine, o.machine, o.parameters, o.seed);
  sim::CompareResult result;
  {
    Progress progress("compare", o.common.quiet);
    result = sim::compare(machine, parameters.knowledge, spec, [&](std::size_t done, std::size_t all) { progress(done, all); });
  }
  const auto printed = is_printed_experiment(o) ? std::span<const report::PrintedTable>(report::kBiaxialTables)
                                                : std::span<const report::PrintedTable>();
  write_json(o.common.json, report::to_json(result, o.experiment));
  if (!o.common.report.empty()) {
    report::CompareReportInput input;
    input.result = result;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      report::AxisEvidence evidence;
      evidence.knowledge = parameters.knowledge[i];
      if (!parameters.learned.empty()) {
        evidence.conventional = parameters.learned[i].conventional;
        evidence.gaussian = parameters.learned[i].gaussian;
      }
      evidence.truth = machine.axes[i].second.plant.friction;
      input.axes.push_back(std::move(evidence));
    }
    input.experiment = o.experiment;
    input.origin = machine.origin;
    input.parameters = parameters.words;
    input.command = typed_command();
    input.version = STRIBECK_VERSION;
    input.printed = printed;
    report::write_compare_report(o.common.report, input);
    write_evidence(o.common.report, machine, parameters);
  }
  say(o.common, report::text_table(result, printed));
  say(o.common, fmt::format("Compensators: {}.\n", parameters.words));
  return 0;
}

}  // namespace

void add_compare(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand("compare", "The main job: controllers side by side on a virtual machine");
  auto o = std::make_shared<Options>();
  verb->add_option("machine", o->machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option("--experiment", o->experiment, "Experiment")->check(CLI::IsMember({"bi-table"}))->capture_default_str();
  add_parameter_options(*verb, o->parameters);
  verb->add_option("--trials", o->trials, "Trials, each with noise of its own")->check(CLI::Range(1, 100000))->capture_default_str();
  verb->add_option("--seed", o->seed, "Seed of the noise")->capture_default_str();
  verb->add_option("--threads", o->threads, "Threads; 0: all cores. The result does not depend on it")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  verb->add_option("--speed", o->speeds, "Speed along the path, repeatable; left out: 3 and 9.5 mm/s")->type_name("SPEED");
  verb->add_option("--path", o->path, "circle, eight or trifolium")
      ->check(CLI::IsMember({"circle", "eight", "trifolium"}))
      ->capture_default_str();
  verb->add_option("--size", o->size, "Radius of the circle, half width of the others")->type_name("LENGTH")->capture_default_str();
  verb->add_option("--laps", o->laps, "Laps that are scored")->check(CLI::Range(0.25, 1000.0))->capture_default_str();
  verb->add_option("--omega-t", o->omega_t, "Double pole of the loop along the path")->type_name("RATE")->capture_default_str();
  verb->add_option("--omega-n", o->omega_n, "Double pole of the loop across the path")->type_name("RATE")->capture_default_str();
  verb->add_option("--observer-pole", o->observer_pole, "Both poles of the disturbance observer")
      ->type_name("RATE")
      ->capture_default_str();
  verb->add_option("--error-rate", o->error_rate, "Rate of the tracking error: difference-of-error, or late for comparison")
      ->check(CLI::IsMember({"difference-of-error", "late"}))
      ->capture_default_str();
  verb->add_option("--accuracy", o->accuracy, "Accuracy of the simulated contour error, which decides the sub-steps")
      ->type_name("LENGTH")
      ->capture_default_str();
  add_common(*verb, o->common);
  verb->footer("Example:\n  stribeck compare machines/biaxial-table.toml --experiment bi-table --json out.json --report report");
  verb->callback([o, &action] { action = [o] { return compare(*o); }; });
}

}  // namespace stribeck::cli
