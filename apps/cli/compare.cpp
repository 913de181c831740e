#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <apps/cli/commands.hpp>
#include <apps/cli/parameters.hpp>
#include <apps/cli/path_options.hpp>
#include <apps/cli/shared.hpp>
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
  PathOptions path;
};

sim::CompareSpec spec_of(const Options& o) {
  sim::CompareSpec s = make_spec(o.path);
  for (const std::string& speed : o.speeds) {
    s.speeds.push_back(option_si("--speed", speed, quantity("m/s", "mm/s").positive()));
  }
  if (s.speeds.empty()) s.speeds = {3e-3, 9.5e-3};
  s.controllers = sim::biaxial_controllers();
  s.trials = o.trials;
  s.seed = o.seed;
  s.threads = o.threads;
  return s;
}

constexpr std::string_view kPrintedMachine = "biaxial table";

/// The printed figures belong to one experiment: the circle of 10 mm at the gains of the table.
std::span<const report::PrintedTable> printed_for(const Options& o) {
  PathOptions standard;
  standard.laps = o.path.laps;
  standard.accuracy = o.path.accuracy;
  if (o.experiment != "bi-table" || !(o.path == standard)) return {};
  return report::kBiaxialTables;
}

/// Logs and axis files beside the page, so that the way from log to model can be walked again with identify.
void write_evidence(const std::string& directory, const sim::Machine& machine, const Parameters& parameters) {
  for (std::size_t i = 0; i < parameters.learned.size(); ++i) {
    const std::string& name = machine.axes[i].first;
    const Learned& l = parameters.learned[i];
    io::write_csv(directory + "/" + name + "-pulses.csv", as_log(l.pulses));
    io::write_csv(directory + "/" + name + "-sine.csv", as_log(l.sine));
    const std::string origin =
        "Identified by stribeck " STRIBECK_VERSION " on the machine \"" + machine.name + "\", axis " + name;
    io::write_atomically(
        directory + "/" + name + "-conventional.toml",
        io::write_toml(l.knowledge.conventional, origin + ", from " + name + "-pulses.csv."));
    io::write_atomically(directory + "/" + name + "-gaussian.toml",
                         io::write_toml(l.knowledge.gaussian, origin + ", from " + name + "-pulses.csv and " +
                                                                  name + "-sine.csv."));
  }
}

int compare(const Options& o) {
  check_distinct({o.machine}, {o.common.json});
  check_outputs(o.common);
  const sim::Machine machine = load_machine(o.machine);
  const sim::CompareSpec spec = spec_of(o);
  check_travel(machine, o.machine, spec);
  const Parameters parameters = get_parameters(machine, o.machine, o.parameters, o.seed);
  sim::CompareResult result;
  {
    Progress progress("compare", o.common.quiet);
    result = sim::compare(machine, parameters.knowledge, spec,
                          [&](std::size_t done, std::size_t all) { progress(done, all); });
  }
  // The printed figures are those of one machine.
  const auto printed = machine.name == kPrintedMachine && o.parameters.axis_files.empty()
                           ? printed_for(o)
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
  for (const std::string& warning : report::status_warnings(result))
    say(o.common, "Warning: " + warning + ".\n");
  say(o.common, fmt::format("Compensators: {}.\n", parameters.words));
  return 0;
}

}  // namespace

void add_compare(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand("compare", "The main job: controllers side by side on a virtual machine");
  auto o = std::make_shared<Options>();
  verb->add_option("machine", o->machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option("--experiment", o->experiment, "Experiment")
      ->check(CLI::IsMember({"bi-table"}))
      ->capture_default_str();
  add_parameter_options(*verb, o->parameters);
  verb->add_option("--trials", o->trials, "Trials, each with noise of its own")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  add_seed(*verb, o->seed);
  verb->add_option("--threads", o->threads, "Threads; 0: all cores. The result does not depend on it")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  verb->add_option("--speed", o->speeds, "Speed along the path, repeatable; left out: 3 and 9.5 mm/s")
      ->type_name("SPEED");
  add_path_options(*verb, o->path);
  add_common(*verb, o->common);
  verb->footer(
      "Example:\n  stribeck compare machines/biaxial-table.toml --experiment bi-table --json out.json "
      "--report report");
  verb->callback([o, &action] { action = [o] { return compare(*o); }; });
}

}  // namespace stribeck::cli
