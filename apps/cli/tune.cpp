#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/option_groups.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/report/pages/tune_report.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/experiments.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/run/tuning.hpp>

namespace stribeck::cli {
namespace {

struct TuneCommand {
  Common common;
  std::string machine;
  ParameterOptions parameters;
  TuneOptions what;
  std::string out;
};

int tune(const TuneCommand& o) {
  Tuning tuning = plan_tuning(o.what, o.parameters, o.machine);
  const std::vector<std::string> inputs = inputs_of(o.what, o.parameters, o.machine);
  std::vector<std::string> outputs = tuned_files(tuning, o.out, "-o");
  outputs.push_back(page_of(o.common));
  outputs.push_back(o.common.json);
  const bool is_file = is_controller_file(o.out);
  const OutputFolder tuned_folder = o.out.empty() || is_file ? OutputFolder() : OutputFolder(o.out);
  check_distinct(inputs, outputs);
  const OutputFolder page_folder = check_outputs(o.common);
  if (is_file) io::check_writable(o.out);
  {
    Progress progress("tune", o.common.quiet);
    run_tuning(tuning, [&](std::size_t done, std::size_t all) { progress(done, all); });
  }
  const report::Made made = made_from(inputs);
  write_json(o.common.json,
             report::to_json(tuning.result, tuning.spec, tuning.trade_off, tuning.parameters.assumed), made);
  report::write_tune_report(folders_of(o.common),
                            {tuning.result, tuning.spec, tuning.parameters.words, made.command, made.version,
                             made.inputs, tuning.trade_off, tuning.parameters.assumed});
  write_tuned(tuning, o.out, STRIBECK_VERSION);
  say(o.common, text_of(tuning));
  const std::string none = missed(tuning);
  if (!none.empty()) throw sim::Refused(none);
  return 0;
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
  verb->add_option(
          "--goal", o->what.goal,
          "What the gains are for: accuracy (largest error and RMS), surface (quadrant glitch and SD) or speed (lag of the "
          "axes, which grows with the feed, and RMS)")
      ->check(one_of({"accuracy", "surface", "speed"}))
      ->capture_default_str();
  verb->add_option(
          "--machines", o->what.machines,
          "Machines that the gains must suit: nominal, the given one, or nearby, also with mass and friction up and down, a "
          "period of delay and a mode; left out: nominal, but nearby where an axis is simulated as its identified model")
      ->check(one_of({"nominal", "nearby"}));
  verb->add_flag(
      "--trade-off", o->what.trade_off,
      "Search again with 50 to 200 % of the limit of mean |Δu|: what a rougher input buys. Takes six times as long");
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
  verb->add_flag(
      "--stick-slip", o->what.stick_slip,
      "Look for the slowest speed that every axis keeps without stick-slip, by describing function and by simulation");
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
