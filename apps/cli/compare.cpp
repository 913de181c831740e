#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/option_groups.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/json.hpp>
#include <stribeck/report/pages/compare_report.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/machine/drive_mode.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/path/part_program.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <stribeck/workflow/traces.hpp>

namespace stribeck::cli {
namespace {

struct CompareCommand {
  Common common;
  std::string machine;
  std::string experiment;
  std::string drive;
  ParameterOptions parameters;
  std::uint32_t trials = 10;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  std::vector<std::string> speeds;
  std::vector<std::string> controllers;
  std::vector<std::string> only;
  PathOptions path;
  std::string traces;  ///< directory of every trial's trace; empty: none
};

/// Leaves only those controllers, in their order.
void keep_only(std::vector<sim::ControllerSpec>& controllers, const std::vector<std::string>& only) {
  if (only.empty()) return;
  std::vector<std::string> ids;
  for (const sim::ControllerSpec& c : controllers) ids.push_back(c.id);
  for (const std::string& id : only) {
    if (std::find(ids.begin(), ids.end(), id) == ids.end()) {
      refuse_option("--only",
                    fmt::format("got {}, expected one of {}", io::in_quotes(id), report::listed(ids)));
    }
  }
  std::erase_if(controllers, [&](const sim::ControllerSpec& c) {
    return std::find(only.begin(), only.end(), c.id) == only.end();
  });
}

sim::CompareSpec spec_of(const CompareCommand& o, const std::string& experiment,
                         const sim::Machine& machine) {
  sim::CompareSpec s = experiment_spec(experiment, o.path, o.speeds, machine, o.machine);
  add_beyond(s.controllers, experiment, o.parameters);
  for (const std::string& name : o.controllers) add_controller(s.controllers, read_controller(name), name);
  keep_only(s.controllers, o.only);
  s.trials = o.trials;
  s.seed = o.seed;
  s.threads = o.threads;
  return s;
}

/// The printed figures belong to one experiment: the circle of 10 mm with the gains of the table.
std::span<const report::PrintedTable> printed_for(const CompareCommand& o, const std::string& experiment) {
  PathOptions standard;
  standard.laps = o.path.laps;
  standard.accuracy = o.path.accuracy;
  if (experiment != kVaried || !(o.path == standard)) return {};
  return report::kBiaxialTables;
}

/// Logs and axis files beside the page, so that the identification can be repeated.
void write_evidence(const std::string& directory, const sim::Machine& machine, const Parameters& parameters) {
  for (std::size_t i = 0; i < parameters.axes.size(); ++i) {
    const std::string& name = machine.axes[i].first;
    const CommissionedAxis& l = parameters.axes[i];
    for (const auto& [file, log] : l.logs) io::write_csv(directory + "/" + file, as_log(log));
    for (const CommissionedModel& m : l.models) {
      const std::string origin = "Identified by stribeck " STRIBECK_VERSION " on the machine \"" +
                                 machine.name + "\", axis " + name + ", from " +
                                 report::joined(m.sources, " and ") + ".";
      io::write_atomically(directory + "/" + name + "-" + m.kind + ".toml",
                           io::write_toml(as_model(m.result), origin));
    }
  }
}

/// Every trial of every controller at every speed as a CSV, computed anew: the comparison itself keeps one trace each.
void write_traces(const std::string& folder, const sim::Machine& machine, const Parameters& parameters,
                  const sim::CompareResult& result, bool quiet) {
  Progress progress("traces", quiet);
  std::size_t done = 0;
  for (const sim::CompareRow& row : result.rows) {
    sim::CompareSpec one = result.spec;
    one.travels = {result.spec.travels[row.travel]};
    one.controllers = {row.controller};
    for (std::uint32_t trial = 0; row.refused.empty() && trial < result.spec.trials; ++trial) {
      const sim::CompareResult run = sim::run_once(machine, parameters.knowledge, one, trial);
      io::Log log = as_log(run.axes, run.rows.front().trace);
      log.metadata = {{"machine", machine.name},
                      {"controller", row.controller.id + ", " + row.controller.label},
                      {"path", one.travels.front().name + ", " + one.travels.front().pace_in_words()},
                      {"seed", std::to_string(one.seed)},
                      {"trial", std::to_string(trial)}};
      io::write_csv(fmt::format("{}/{}-{}-trial-{:03}.csv", folder, row.travel + 1, row.controller.id, trial),
                    log);
      progress(++done, result.rows.size() * result.spec.trials);
    }
  }
}

int compare(const CompareCommand& o) {
  std::vector<std::string> inputs = o.controllers;
  inputs.push_back(o.machine);
  if (is_file(o.path)) inputs.push_back(o.path.path);
  for (const std::string& text : o.parameters.axis_files) inputs.push_back(axis_and_file(text).second);
  check_distinct(inputs, {page_of(o.common), o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);
  const OutputFolder trace_folder = o.traces.empty() ? OutputFolder() : OutputFolder(o.traces);
  const report::Made made = made_from(inputs);
  sim::Machine machine = load_machine(o.machine);
  if (!o.drive.empty()) set_drive_mode(machine, o.drive);
  const std::string experiment = o.experiment.empty() ? default_experiment(machine, o.path) : o.experiment;
  const sim::CompareSpec spec = spec_of(o, experiment, machine);
  check_travel(machine, o.machine, spec);
  const Parameters parameters = get_parameters(machine, o.machine, o.parameters, spec);
  sim::CompareResult result;
  {
    Progress progress("compare", o.common.quiet);
    result = sim::compare(machine, parameters.knowledge, spec,
                          [&](std::size_t done, std::size_t all) { progress(done, all); });
  }
  if (!o.traces.empty()) write_traces(o.traces, machine, parameters, result, o.common.quiet);
  // The printed figures are those of one machine.
  const auto printed =
      is_built_in(o.machine, "biaxial-table") && o.parameters.axis_files.empty() && o.drive.empty()
          ? printed_for(o, experiment)
          : std::span<const report::PrintedTable>();
  const std::vector<std::string> uncovered =
      coverage_warnings(result, sim::chosen_axes(machine, spec), parameters);
  nlohmann::ordered_json json = report::to_json(result, experiment);
  for (const std::string& warning : uncovered) json["warnings"].push_back(warning);
  write_json(o.common.json, json, made);
  if (folders_of(o.common).any()) {
    report::CompareReportInput input;
    input.result = result;
    for (const std::size_t i : sim::chosen_axes(machine, spec)) {
      report::AxisEvidence evidence;
      evidence.knowledge = parameters.knowledge[i];
      if (!parameters.axes.empty()) {
        for (const CommissionedModel& m : parameters.axes[i].models)
          evidence.models.push_back({m.kind, m.result});
      }
      evidence.truth = machine.axes[i].second.plant.friction;
      input.axes.push_back(std::move(evidence));
    }
    input.experiment = experiment;
    input.origin = machine.origin;
    input.parameters = parameters.words;
    input.command = made.command;
    input.version = made.version;
    input.inputs = made.inputs;
    input.warnings = uncovered;
    input.printed = printed;
    report::write_compare_report(folders_of(o.common), input);
    if (!o.common.report.empty()) write_evidence(o.common.report, machine, parameters);
  }
  say(o.common, part_words(spec) + report::text_table(result, printed));
  for (const std::string& warning : report::status_warnings(result))
    say(o.common, "Warning: " + warning + ".\n");
  for (const std::string& warning : uncovered) say(o.common, "Warning: " + warning + ".\n");
  const auto drift = report::drift_words(result);
  if (!drift.empty())
    say(o.common, "Change since identification, estimated by adaptation at the end of the first trial:\n");
  for (const std::string& words : drift) say(o.common, "  " + words + "\n");
  say(o.common, fmt::format("Compensators: {}.\n", parameters.words));
  return 0;
}

}  // namespace

void add_compare(CLI::App& app, Action& action) {
  auto* verb =
      app.add_subcommand("compare", "Run several controllers on a virtual machine and compare their errors");
  auto o = std::make_shared<CompareCommand>();
  verb->add_option("machine", o->machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option(
          "--experiment", o->experiment,
          "Experiment; left out: uni-sim, bi-table, tri-circle or five-axis, by the number of axes of the machine; own, a "
          "circle by its limits, for a machine without published parameters")
      ->check(one_of(experiment_ids()));
  add_parameter_options(*verb, o->parameters);
  add_trials(*verb, o->trials, o->threads);
  add_seed(*verb, o->seed);
  verb->add_option(
          "--speed", o->speeds,
          "Speed along the path, repeatable; left out: 3 and 9.5 mm/s, on a machine of your own by its limits")
      ->type_name("SPEED");
  verb->add_option(
          "--drive", o->drive,
          "Drives of the axes: force, velocity, position, velocity-offset or position-offset, each with the loops of "
          "a usual servo drive (docs/theory/drive-modes.md); left out: as the machine file has them")
      ->check(one_of(drive_modes()));
  verb->add_option("--controller", o->controllers,
                   fmt::format("An additional controller, repeatable: {}, or a controller file",
                               report::listed(built_in_controllers())))
      ->type_name("NAME|FILE.toml");
  verb->add_option("--only", o->only, "Run only these controllers, by their ids, e.g. --only f,g,i")
      ->delimiter(',')
      ->type_name("ID");
  add_path_options(*verb, o->path);
  verb->add_option(
          "--traces", o->traces,
          "Write the trace of every trial as a CSV, SPEED-ID-trial-NUMBER.csv with speeds counted from 1")
      ->type_name("DIR");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Examples:\n  stribeck compare machines/biaxial-table.toml --experiment bi-table --json out.json "
      "--report report\n"
      "  stribeck compare machines/triaxial-tool.toml --path examples/part.ngc");
  verb->callback([o, &action] { action = [o] { return compare(*o); }; });
}

}  // namespace stribeck::cli
