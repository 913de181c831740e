#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/option_groups.hpp>
#include <apps/cli/shared.hpp>
#include <apps/cli/trace_page.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/run/run_figures.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/path/part_program.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <stribeck/workflow/run/axis_run.hpp>
#include <stribeck/workflow/run/path_run.hpp>
#include <stribeck/workflow/traces.hpp>

namespace stribeck::cli {
namespace {

constexpr int kAnswerIsNo = 1;

struct SimulateCommand {
  Common common;
  std::string machine;
  std::string output;
  PathRunOptions path;  ///< for a run along a path; parameters and seed for both
  // for one axis along a reference
  std::string reference;
  std::string axis;
};

std::vector<std::string> inputs_of(const SimulateCommand& o) {
  std::vector<std::string> inputs{o.machine, o.reference};
  if (o.reference.empty() && is_file(o.path.run.path)) inputs.push_back(o.path.run.path.path);
  for (const std::string& text : o.path.parameters.axis_files) inputs.push_back(axis_and_file(text).second);
  if (!o.path.run.controller.empty()) inputs.push_back(o.path.run.controller);
  return inputs;
}

/// Runs an axis along a file that excite wrote.
int play_reference(const SimulateCommand& o, const sim::Machine& machine) {
  if (o.axis.empty()) refuse_option("--axis", "missing, expected the axis that --reference is for");
  const AxisRun run = run_axis(machine, o.machine, o.axis, io::read_csv(o.reference), o.path.seed);
  io::write_csv(o.output, run.log);
  const double duration = run.recording.t.back();
  const report::Made made = made_from(inputs_of(o));
  std::vector<std::string> warnings;
  if (const auto& stop = run.end_stop) {
    warnings.push_back(
        fmt::format("axis {} ran into its end stop at {:.6g} mm with {:.3g} mm/s after {:.6g} s: the run "
                    "ends there (check load, friction and start of the excitation)",
                    o.axis, stop->position * 1e3, stop->speed * 1e3, stop->time));
    fmt::print(stderr, "stribeck: {}\n", warnings.back());
  }
  report_log(o.common, made, run.log, fmt::format("Axis {} of {}", o.axis, machine.name),
             fmt::format("{:.6g} s, as a control would log it", duration), {}, warnings);
  write_json(o.common.json, to_json(run), made);
  say(o.common,
      fmt::format("{:.6g} s of axis {} in {} ({} rows).\n", duration, o.axis, o.output, run.log.rows));
  return run.end_stop ? kAnswerIsNo : 0;
}

/// " It is largest after 12.3 s, at x = 10.2 mm, y = -3.1 mm." Empty without a scored sample.
std::string place_of_largest(const sim::Machine& machine, const sim::CompareResult& one) {
  const sim::ContourSample* largest = nullptr;
  for (const sim::ContourSample& sample : one.rows.front().trace) {
    if (!sample.scored || !std::isfinite(sample.contour_error)) continue;
    if (largest == nullptr || std::abs(sample.contour_error) > std::abs(largest->contour_error))
      largest = &sample;
  }
  if (largest == nullptr) return {};
  std::vector<std::string> places;
  for (std::size_t i = 0; i < one.axes.size(); ++i) {
    const bool rotary = std::any_of(machine.axes.begin(), machine.axes.end(), [&](const auto& axis) {
      return axis.first == one.axes[i] && axis.second.rotary;
    });
    places.push_back(fmt::format("{} = {:.2f} {}", one.axes[i],
                                 largest->reference[i] * (rotary ? report::kDegrees : 1e3),
                                 rotary ? "deg" : "mm"));
  }
  return fmt::format(" It is largest after {:.2f} s, at {}.", largest->time, report::joined(places, ", "));
}

int follow_path(const SimulateCommand& o, const sim::Machine& machine) {
  const PathRun run = run_path(o.path, machine, o.machine);
  const sim::CompareResult& one = run.result;
  const sim::ControllerSpec& controller = run.spec.controllers.front();
  const sim::Travel& travel = run.spec.travels.front();
  const sim::Metrics& m = one.rows.front().mean;
  io::write_csv(o.output, run.log);
  const std::string pace = travel.pace_in_words();
  const bool stands = std::isinf(m.max_contour_error);
  const std::string figures = stands ? std::string("the path is not followed")
                                     : fmt::format("{} error max {:.2f} µm, RMS {:.3f} µm",
                                                   one.axes.size() == 1 ? "tracking" : "contour",
                                                   m.max_contour_error * 1e6, m.rms * 1e6);
  std::vector<std::string> warnings = report::status_warnings(one);
  if (stands)
    warnings.emplace_back(
        "an axis moves less than half as far as it should: friction holds it (gains too low, a wrong unit of a gain, or a drive "
        "without force), so that errors of the path mean nothing");
  warnings.insert(warnings.end(), run.warnings.begin(), run.warnings.end());
  report_log(o.common, made_from(inputs_of(o)), errors_first(run.log, one.axes),
             fmt::format("Controller ({}) on {}", controller.id, travel.name),
             fmt::format("{}, {}: {}.{}", controller.label, pace, figures, place_of_largest(machine, one)),
             report::run_figures(one), warnings);
  write_json(o.common.json, to_json(run), made_from(inputs_of(o)));
  say(o.common, part_words(run.spec));
  say(o.common, fmt::format("Controller {} ({}) on {}, {}: {}. Trace in {} ({} rows).\n", controller.id,
                            controller.label, travel.name, pace, figures, o.output, run.log.rows));
  for (const std::string& warning : warnings) say(o.common, "Warning: " + warning + ".\n");
  for (const std::string& words : report::drift_words(one))
    say(o.common, "Change since identification: " + words + ".\n");
  return 0;
}

int simulate(const SimulateCommand& o) {
  check_distinct(inputs_of(o), {o.output, page_of(o.common), o.common.json});
  if (!o.reference.empty() && !o.path.run.experiment.empty())
    refuse_option("--experiment", "does not go with --reference, which has its own motion (leave one out)");
  if (o.reference.empty() && !o.axis.empty())
    refuse_option("--axis", "goes with --reference; --axes chooses the axes of a path");
  const OutputFolder page_folder = check_outputs(o.common);
  io::check_writable(o.output);
  const sim::Machine machine =
      read_virtual_machine(o.machine, o.path.parameters.axis_files, AxisWithoutTruth::kLeftOut);
  return o.reference.empty() ? follow_path(o, machine) : play_reference(o, machine);
}

}  // namespace

void add_simulate(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "simulate", "Simulate one run of a virtual machine, along a path or with a reference of excite");
  auto o = std::make_shared<SimulateCommand>();
  verb->add_option("machine", o->machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option("-o,--output", o->output, "CSV of the run")->required()->type_name("TRACE.csv");
  add_seed(*verb, o->path.seed);
  verb->add_option(
          "--controller", o->path.run.controller,
          fmt::format(
              "A controller of the experiment, by its letter, {}, or a controller file; left out: (h), or the last controller of the thesis where there is no (h)",
              report::listed(built_in_controllers())))
      ->type_name("ID|NAME|FILE.toml");
  std::vector<std::string> ids;
  for (const sim::Experiment& e : sim::experiments()) ids.push_back(e.id);
  verb->add_option("--experiment", o->path.run.experiment,
                   "Path, gains and controllers of an experiment of compare")
      ->check(one_of(ids));
  verb->add_option("--speed", o->path.run.speed,
                   "Speed along the path; left out: 9.5 mm/s, on a machine of your own by its limits")
      ->type_name("SPEED");
  add_path_options(*verb, o->path.run.path);
  verb->add_option("--trial", o->path.trial,
                   "Number of the trial; together with the seed it determines the noise")
      ->check(whole_from(0, std::numeric_limits<std::uint32_t>::max() - 1))
      ->capture_default_str();
  add_parameter_options(*verb, o->path.parameters);
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
