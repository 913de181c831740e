#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/option_groups.hpp>
#include <apps/cli/shared.hpp>
#include <apps/cli/trace_page.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/json.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/path/part_program.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <stribeck/workflow/path/single_run.hpp>
#include <stribeck/workflow/reference_file.hpp>
#include <stribeck/workflow/traces.hpp>

namespace stribeck::cli {
namespace {

constexpr int kAnswerIsNo = 1;

struct SimulateCommand {
  Common common;
  std::string machine;
  std::string output;
  std::uint64_t seed = 1;
  // for a run along a path
  SingleRunOptions run;
  std::uint32_t trial = 0;
  ParameterOptions parameters;
  // for one axis along a reference
  std::string reference;
  std::string axis;
};

std::vector<std::string> inputs_of(const SimulateCommand& o) {
  std::vector<std::string> inputs{o.machine, o.reference};
  if (o.reference.empty() && is_file(o.run.path)) inputs.push_back(o.run.path.path);
  for (const std::string& text : o.parameters.axis_files) inputs.push_back(axis_and_file(text).second);
  if (!o.run.controller.empty()) inputs.push_back(o.run.controller);
  return inputs;
}

/// Runs an axis along a file that excite wrote.
int play_reference(const SimulateCommand& o, const sim::Machine& machine) {
  if (o.axis.empty()) refuse_option("--axis", "missing, expected the axis that --reference is for");
  const std::size_t axis = axis_index(machine, o.machine, o.axis);
  const ReferenceFile reference = read_reference(o.reference, machine, axis);
  sim::Recording recording = play(machine, axis, reference.r, reference.force, o.seed);
  const std::optional<EndStop> end_stop = cut_at_end_stop(recording, machine.axes[axis].second.limits);
  io::Log log = as_log(recording);
  log.metadata = {{"machine", machine.name}, {"axis", o.axis}, {"seed", std::to_string(o.seed)}};
  io::write_csv(o.output, log);
  report_log(o.common, made_from(inputs_of(o)), log, fmt::format("Axis {} of {}", o.axis, machine.name),
             fmt::format("{:.6g} s, as a control would log it", recording.t.back()));
  nlohmann::ordered_json json{{"schema", "stribeck.simulate/1"},
                              {"machine", machine.name},
                              {"axis", o.axis},
                              {"seed", o.seed},
                              {"rows", log.rows},
                              {"duration_s", recording.t.back()},
                              {"end_stop", nullptr}};
  if (const auto& stop = end_stop) {
    json["end_stop"] = {
        {"time_s", stop->time}, {"position_mm", stop->position * 1e3}, {"speed_mm_per_s", stop->speed * 1e3}};
    fmt::print(
        stderr,
        "stribeck: axis {} ran into its end stop at {:.6g} mm with {:.3g} mm/s after {:.6g} s: the run "
        "ends there (check load, friction and start of the excitation)\n",
        o.axis, stop->position * 1e3, stop->speed * 1e3, stop->time);
  }
  write_json(o.common.json, json, made_from(inputs_of(o)));
  say(o.common,
      fmt::format("{:.6g} s of axis {} in {} ({} rows).\n", recording.t.back(), o.axis, o.output, log.rows));
  return end_stop ? kAnswerIsNo : 0;
}

int run_path(const SimulateCommand& o, const sim::Machine& machine) {
  sim::CompareSpec spec = single_run(o.run, o.parameters, machine, o.machine);
  spec.trials = o.trial + 1;
  spec.seed = o.seed;
  check_travel(machine, o.machine, spec);
  const sim::ControllerSpec& controller = spec.controllers.front();
  const sim::Travel& travel = spec.travels.front();
  const Parameters parameters = get_parameters(machine, o.machine, o.parameters, spec);
  sim::CompareResult one = sim::run_once(machine, parameters.knowledge, spec, o.trial);
  const sim::CompareRow& row = one.rows.front();
  const sim::Metrics& m = row.mean;
  io::Log log = as_log(one.axes, row.trace);
  const std::string pace = travel.pace_in_words();
  log.metadata = {{"machine", machine.name},
                  {"controller", controller.id + ", " + controller.label},
                  {"path", travel.name + ", " + pace},
                  {"seed", std::to_string(o.seed)}};
  io::write_csv(o.output, log);
  const std::string figures =
      fmt::format("{} error max {:.2f} µm, RMS {:.3f} µm", one.axes.size() == 1 ? "tracking" : "contour",
                  m.max_contour_error * 1e6, m.rms * 1e6);
  report_log(o.common, made_from(inputs_of(o)), errors_first(log, one.axes),
             fmt::format("Controller ({}) on {}", controller.id, travel.name),
             fmt::format("{}, {}: {}", controller.label, pace, figures));
  auto json = report::to_json(one, o.run.experiment);
  json["schema"] = "stribeck.simulate/1";
  write_json(o.common.json, json, made_from(inputs_of(o)));
  say(o.common, part_words(spec));
  say(o.common, fmt::format("Controller {} ({}) on {}, {}: {}. Trace in {} ({} rows).\n", controller.id,
                            controller.label, travel.name, pace, figures, o.output, log.rows));
  for (const std::string& warning : report::status_warnings(one))
    say(o.common, "Warning: " + warning + ".\n");
  for (const std::string& words : report::drift_words(one))
    say(o.common, "Change since identification: " + words + ".\n");
  return 0;
}

int simulate(const SimulateCommand& o) {
  check_distinct(inputs_of(o), {o.output, page_of(o.common), o.common.json});
  if (!o.reference.empty() && !o.run.experiment.empty())
    refuse_option("--experiment", "does not go with --reference, which has its own motion (leave one out)");
  const OutputFolder page_folder = check_outputs(o.common);
  io::check_writable(o.output);
  const sim::Machine machine = load_machine(o.machine);
  return o.reference.empty() ? run_path(o, machine) : play_reference(o, machine);
}

}  // namespace

void add_simulate(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "simulate", "Simulate one run of a virtual machine, along a path or with a reference of excite");
  auto o = std::make_shared<SimulateCommand>();
  verb->add_option("machine", o->machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option("-o,--output", o->output, "CSV of the run")->required()->type_name("TRACE.csv");
  add_seed(*verb, o->seed);
  verb->add_option(
          "--controller", o->run.controller,
          fmt::format(
              "A controller of the experiment, by its letter, {}, or a controller file; left out: (h), or the last controller of the thesis where there is no (h)",
              report::listed(built_in_controllers())))
      ->type_name("ID|NAME|FILE.toml");
  std::vector<std::string> ids;
  for (const sim::Experiment& e : sim::experiments()) ids.push_back(e.id);
  verb->add_option("--experiment", o->run.experiment,
                   "Path, gains and controllers of an experiment of compare")
      ->check(one_of(ids));
  verb->add_option("--speed", o->run.speed, "Speed along the path; left out: 9.5 mm/s")->type_name("SPEED");
  add_path_options(*verb, o->run.path);
  verb->add_option("--trial", o->trial, "Number of the trial; together with the seed it determines the noise")
      ->check(whole_from(0, std::numeric_limits<std::uint32_t>::max() - 1))
      ->capture_default_str();
  add_parameter_options(*verb, o->parameters);
  verb->add_option(
          "--reference", o->reference,
          "CSV written by excite, run on one axis in place of a path: column r in closed loop, u or f in open loop")
      ->type_name("REF.csv");
  verb->add_option("--axis", o->axis, "Axis on which the reference runs")->type_name("NAME");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Examples:\n  stribeck simulate machines/biaxial-table.toml --reference x-sine.csv --axis x -o "
      "x-sine-log.csv\n"
      "  stribeck simulate machines/biaxial-table.toml --controller f --path eight --parameters thesis -o "
      "trace.csv\n"
      "  stribeck simulate machines/triaxial-tool.toml --path examples/part.ngc -o trace.csv");
  verb->callback([o, &action] { action = [o] { return simulate(*o); }; });
}

}  // namespace stribeck::cli
