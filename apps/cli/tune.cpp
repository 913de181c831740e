#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/option_groups.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/pages/tune_report.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/parameters.hpp>
#include <stribeck/workflow/path/part_program.hpp>
#include <stribeck/workflow/path/path_options.hpp>
#include <stribeck/workflow/tune_options.hpp>

namespace stribeck::cli {
namespace {

struct TuneCommand {
  Common common;
  std::string machine;
  ParameterOptions parameters;
  TuneOptions what;
  std::string out;
};

bool is_file(const std::string& out) { return out.size() > 5 && out.ends_with(".toml"); }

/// The output file of each tuned controller.
std::string file_of(const TuneCommand& o, const std::string& id) {
  return is_file(o.out) ? o.out : o.out + "/" + id + ".toml";
}

int tune(const TuneCommand& o) {
  const sim::Machine machine = load_machine(o.machine);
  const sim::TuneSpec spec = tune_spec(o.what, o.parameters, machine, o.machine);
  std::vector<std::string> inputs = o.what.controllers;
  inputs.push_back(o.machine);
  if (is_file(o.what.path)) inputs.push_back(o.what.path.path);
  for (const std::string& text : o.parameters.axis_files) inputs.push_back(axis_and_file(text).second);
  std::vector<std::string> outputs{page_of(o.common), o.common.json};
  if (!o.out.empty()) {
    if (is_file(o.out) && spec.compare.controllers.size() > 1) {
      refuse_option("-o",
                    fmt::format("got a file for {} controllers, expected a folder (or a single --controller)",
                                spec.compare.controllers.size()));
    }
    for (const sim::ControllerSpec& c : spec.compare.controllers) outputs.push_back(file_of(o, c.id));
  }
  const OutputFolder tuned_folder = o.out.empty() || is_file(o.out) ? OutputFolder() : OutputFolder(o.out);
  check_distinct(inputs, outputs);
  const OutputFolder page_folder = check_outputs(o.common);
  if (is_file(o.out)) io::check_writable(o.out);
  check_travel(machine, o.machine, spec.compare);
  sim::CompareSpec needed = spec.compare;
  if (!spec.limits.input_variation) needed.controllers.push_back(*spec.reference);
  const Parameters parameters = get_parameters(machine, o.machine, o.parameters, needed);
  sim::TuneResult result;
  {
    Progress progress("tune", o.common.quiet);
    result = sim::tune(machine, parameters.knowledge, spec,
                       [&](std::size_t done, std::size_t all) { progress(done, all); });
  }
  const report::Made made = made_from(inputs);
  write_json(o.common.json, report::to_json(result, spec), made);
  report::write_tune_report(folders_of(o.common),
                            {result, spec, parameters.words, made.command, made.version, made.inputs});
  bool all = true;
  for (const sim::TunedController& c : result.controllers) {
    all = all && c.found();
    if (o.out.empty() || !c.found()) continue;
    io::write_atomically(
        file_of(o, c.start.id),
        io::write_toml(renamed(c.tuned), "Tuned by stribeck " STRIBECK_VERSION " on the machine \"" +
                                             machine.name + "\": docs/theory/tuning.md."));
  }
  say(o.common, part_words(spec.compare) + report::text_table(result, spec));
  say(o.common, fmt::format("Compensators: {}.\n", parameters.words));
  if (all) return 0;
  std::vector<std::string> missed;
  for (const sim::TunedController& c : result.controllers) {
    if (!c.found())
      missed.push_back(
          fmt::format("controller ({}): {}{}", c.start.id, report::why_none(c, spec), way_out(c)));
  }
  throw sim::Refused(report::joined(missed, "; "));
}

}  // namespace

void add_tune(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "tune", "Find the best gains of each controller within limits of stability margin and input variation");
  auto o = std::make_shared<TuneCommand>();
  verb->add_option("machine", o->machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option("--experiment", o->what.experiment,
                   "Experiment whose path and controllers are used; left out: chosen as in compare")
      ->check(one_of(experiment_ids()));
  verb->add_option(
          "--controller", o->what.controllers,
          fmt::format(
              "Tune only this controller, repeatable: an id of the experiment, {}, or a controller file",
              report::listed(built_in_controllers())))
      ->type_name("ID|NAME|FILE.toml");
  verb->add_option("--phase-margin", o->what.phase_margin,
                   "Smallest allowed phase margin of the loop, in degrees")
      ->check(number_from(1.0, 90.0))
      ->capture_default_str();
  verb->add_option("--gain-margin", o->what.gain_margin, "Smallest allowed gain margin, up and down, in dB")
      ->check(number_from(0.1, 40.0))
      ->capture_default_str();
  verb->add_option(
          "--delay-margin", o->what.delay_margin,
          "Smallest allowed delay margin, in control periods: additional delay with which the loop is still stable")
      ->check(number_from(0.0, 100.0))
      ->capture_default_str();
  verb->add_option(
          "--input-variation", o->what.input_variation,
          "Largest allowed mean |Δu| of every run; left out: that of the last thesis controller of the experiment at its own gains, (f) on the biaxial table")
      ->type_name("VOLTAGE");
  verb->add_option(
          "--axial-mode", o->what.axial_mode,
          "Frequency of a first axial mode of every axis, with which the loop must be stable; left out: rigid axes")
      ->type_name("FREQUENCY");
  verb->add_option("--evaluations", o->what.evaluations, "Number of sets of gains to try for each controller")
      ->check(whole_from(10, 100000))
      ->capture_default_str();
  verb->add_option(
          "-o,--output", o->out,
          "Controller files to write: a folder for one ID.toml each, or FILE.toml for a single controller; the id in the file is ID-tuned")
      ->type_name("DIR|FILE.toml");
  add_parameter_options(*verb, o->parameters);
  add_trials(*verb, o->what.trials, o->what.threads);
  add_seed(*verb, o->what.seed);
  verb->add_option("--speed", o->what.speeds, "Speed along the path, repeatable; left out: 3 and 9.5 mm/s")
      ->type_name("SPEED");
  add_path_options(*verb, o->what.path);
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Example:\n  stribeck tune machines/biaxial-table.toml --controller f --controller pid -o tuned");
  verb->callback([o, &action] { action = [o] { return tune(*o); }; });
}

}  // namespace stribeck::cli
