#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <span>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/option_groups.hpp>
#include <apps/cli/shared.hpp>
#include <apps/web/offline/offline_page.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/pages/compare_report.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/machine/drive_mode.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/path/part_program.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <stribeck/workflow/run/comparison.hpp>
#include <stribeck/workflow/run/tuning.hpp>
#include <stribeck/workflow/traces.hpp>

namespace stribeck::cli {
namespace {

struct CompareCommand {
  Common common;
  ComparisonOptions what;
  std::string traces;    ///< directory of every trial's trace; empty: none
  bool what_if = false;  ///< with a page in which the machine can be changed
};

/// The printed figures belong to one experiment: the circle of 10 mm with the gains of the table.
std::span<const report::PrintedTable> printed_for(const ComparisonOptions& o, const std::string& experiment) {
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
    for (const CommissionedLog& log : l.logs)
      io::write_csv(directory + "/" + log.file, as_log(log.recording));
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
    // The fastest travel bounds the tables of friction, on which the last nanometres depend.
    one.travels = {result.spec.travels[row.travel]};
    one.travels.insert(one.travels.end(), result.spec.travels.begin(), result.spec.travels.end());
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

constexpr const char* kWhatIf = "what-if.html";

/// The machine as it was simulated, in a page that computes without the program.
void write_what_if(const std::string& folder, const sim::Machine& machine) {
  const std::string text =
      machine_text(machine, "Simulated by stribeck compare " STRIBECK_VERSION ", " + machine.name + ".");
  io::write_atomically(folder + "/" + kWhatIf, web::offline_page({{"machine.toml", text}}));
}

int compare(const CompareCommand& o) {
  if (o.what_if && o.common.report.empty())
    refuse_option("--what-if", "expected --report DIR as well, the folder that it is written into");
  if (o.what_if) static_cast<void>(web::offline_page({}));  // before the work: this program may have none
  const std::vector<std::string> inputs = inputs_of(o.what);
  check_distinct(inputs, {page_of(o.common), o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);
  const OutputFolder trace_folder = o.traces.empty() ? OutputFolder() : OutputFolder(o.traces);
  const report::Made made = made_from(inputs);
  Comparison comparison;
  {
    Progress progress("compare", o.common.quiet);
    const auto run = o.what.tuned ? run_tuned_comparison : run_comparison;
    comparison = run(o.what, [&](std::size_t done, std::size_t all) { progress(done, all); });
  }
  const auto& [experiment, machine, parameters, result, warnings] = comparison;
  if (!o.traces.empty()) write_traces(o.traces, machine, parameters, result, o.common.quiet);
  // The printed figures are those of one machine.
  const auto printed = is_built_in(o.what.machine, "biaxial-table") && !o.what.tuned &&
                               o.what.parameters.axis_files.empty() && o.what.drive.empty()
                           ? printed_for(o.what, experiment)
                           : std::span<const report::PrintedTable>();
  write_json(o.common.json, to_json(comparison), made);
  if (folders_of(o.common).any()) {
    report::CompareReportInput input;
    input.result = result;
    for (const std::size_t i : sim::chosen_axes(machine, result.spec)) {
      report::AxisEvidence evidence;
      evidence.knowledge = parameters.knowledge[i];
      if (!parameters.axes.empty()) {
        for (const CommissionedModel& m : parameters.axes[i].models)
          evidence.models.push_back({m.kind, m.result});
      }
      evidence.truth = machine.axes[i].second.plant.friction;
      evidence.rotary = machine.axes[i].second.rotary;
      input.axes.push_back(std::move(evidence));
    }
    input.experiment = experiment;
    input.origin = machine.origin;
    input.parameters = parameters.words;
    input.command = made.command;
    input.version = made.version;
    input.inputs = made.inputs;
    input.warnings = warnings;
    input.printed = printed;
    if (o.what_if) input.what_if = kWhatIf;
    report::write_compare_report(folders_of(o.common), input);
    if (!o.common.report.empty()) write_evidence(o.common.report, machine, parameters);
    if (o.what_if) write_what_if(o.common.report, machine);
  }
  // Elsewhere the experiment or the options say it.
  if (experiment == kOwn) say(o.common, fmt::format("Path: {}.\n", result.spec.travels.front().name));
  say(o.common, part_words(result.spec) + report::text_table(result, printed));
  for (const std::string& warning : report::status_warnings(result))
    say(o.common, "Warning: " + warning + ".\n");
  for (const std::string& warning : warnings) say(o.common, "Warning: " + warning + ".\n");
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
  verb->add_option("machine", o->what.machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option(
          "--experiment", o->what.experiment,
          "Experiment; left out: uni-sim, bi-table, tri-circle or five-axis, by the number of axes of the machine; own, a "
          "circle (or the shape of --path) by its limits, for a machine without published parameters")
      ->check(one_of(experiment_ids()));
  add_parameter_options(*verb, o->what.parameters);
  add_trials(*verb, o->what.trials, o->what.threads);
  add_seed(*verb, o->what.seed);
  verb->add_option(
          "--speed", o->what.speeds,
          "Speed along the path, repeatable; left out: 3 and 9.5 mm/s, on a machine of your own by its limits")
      ->type_name("SPEED");
  verb->add_option(
          "--drive", o->what.drive,
          "Drives of the axes: force, velocity, position, velocity-offset or position-offset, each with the loops of "
          "a usual servo drive (docs/theory/drive-modes.md); left out: as the machine file has them")
      ->check(one_of(drive_modes()));
  verb->add_option("--controller", o->what.controllers,
                   fmt::format("An additional controller, repeatable: {}, or a controller file",
                               report::listed(built_in_controllers())))
      ->type_name("NAME|FILE.toml");
  verb->add_option("--only", o->what.only,
                   "Of the controllers of the experiment run only these, by their ids, e.g. --only f,g,i")
      ->delimiter(',')
      ->type_name("ID");
  verb->add_flag("--tuned", o->what.tuned,
                 "Each controller at its best gains, as tune finds them within its usual limits");
  add_path_options(*verb, o->what.path);
  verb->add_option(
          "--traces", o->traces,
          "Write the trace of every trial as a CSV, SPEED-ID-trial-NUMBER.csv with speeds counted from 1")
      ->type_name("DIR");
  add_common(*verb, o->common);
  verb->add_flag(
      "--what-if", o->what_if,
      "Write DIR/what-if.html beside the page of --report: this machine with knobs to turn, computed in the browser without the program");
  refuse_empty_options(*verb);
  verb->footer(
      "Examples:\n  stribeck compare machines/biaxial-table.toml --experiment bi-table --json out.json "
      "--report report\n"
      "  stribeck compare machines/triaxial-tool.toml --path examples/part.ngc");
  verb->callback([o, &action] { action = [o] { return compare(*o); }; });
}

}  // namespace stribeck::cli
