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
#include <stribeck/workflow/part_program.hpp>
#include <stribeck/workflow/path_options.hpp>

namespace stribeck::cli {
namespace {

struct Options {
  Common common;
  std::string machine;
  std::string experiment;
  ParameterOptions parameters;
  std::uint32_t trials = 10;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  std::vector<std::string> speeds;
  std::vector<std::string> controllers;
  PathOptions path;
  double phase_margin = 45.0;
  double gain_margin = 6.0;
  double delay_margin = 1.0;
  std::string input_variation;
  std::string axial_mode;
  int evaluations = 300;
  std::string out;
};

/// One of the experiment's by its id, one that is built in, or a file.
sim::ControllerSpec chosen(const std::vector<sim::ControllerSpec>& known, const std::string& name) {
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

sim::TuneSpec spec_of(const Options& o, const sim::Machine& machine) {
  sim::TuneSpec s;
  s.compare = experiment_spec(o.experiment, o.path, o.speeds, machine, o.machine);
  s.reference = s.compare.controllers.back();  // of the thesis's own
  add_beyond(s.compare.controllers, o.experiment, o.parameters);
  s.compare.trials = o.trials;
  s.compare.seed = o.seed;
  s.compare.threads = o.threads;
  if (!o.controllers.empty()) {
    const std::vector<sim::ControllerSpec> known = std::move(s.compare.controllers);
    s.compare.controllers.clear();
    for (const std::string& name : o.controllers)
      add_controller(s.compare.controllers, chosen(known, name), name);
  }
  s.limits.phase_margin = o.phase_margin * kPi / 180.0;
  s.limits.gain_margin = std::pow(10.0, o.gain_margin / 20.0);
  s.limits.delay_margin = o.delay_margin;
  if (!o.input_variation.empty())
    s.limits.input_variation =
        option_si("--input-variation", o.input_variation, quantity("V", "V").positive());
  if (!o.axial_mode.empty()) {
    // Light damping and a table of half the mass, where nothing was measured.
    const plant::AxialMode mode{
        option_si("--axial-mode", o.axial_mode, quantity("Hz", "Hz").positive().at_most(1e4)), 0.02, 0.5};
    s.limits.axial_mode.assign(control::kMostAxes, mode);
  }
  s.evaluations = o.evaluations;
  return s;
}

bool is_file(const std::string& out) { return out.size() > 5 && out.ends_with(".toml"); }

/// Where each tuned controller goes.
std::string file_of(const Options& o, const std::string& id) {
  return is_file(o.out) ? o.out : o.out + "/" + id + ".toml";
}

/// The tuned controller under a name of its own, so that it stands beside the one that it began as.
sim::ControllerSpec renamed(sim::ControllerSpec c) {
  constexpr std::string_view kId = "-tuned";
  constexpr std::string_view kLabel = ", tuned";
  if (!c.id.ends_with(kId)) c.id = c.id.substr(0, 16 - kId.size()).append(kId);
  if (!c.label.ends_with(kLabel) && c.label.size() + kLabel.size() <= 60) c.label += kLabel;
  return c;
}

/// The option that says what no gains met.
std::string way_out(const sim::TunedController& c) {
  if (!c.miss) return {};
  switch (c.miss->limit) {
    case sim::Limit::kPhaseMargin:
      return " (lower --phase-margin)";
    case sim::Limit::kGainMargin:
      return " (lower --gain-margin)";
    case sim::Limit::kDelayMargin:
      return " (lower --delay-margin)";
    case sim::Limit::kInputVariation:
      return " (raise --input-variation)";
    case sim::Limit::kStability:
    case sim::Limit::kPath:
      break;
  }
  return " (start from slower gains: a file for --controller)";
}

int tune(Options o) {
  const sim::Machine machine = load_machine(o.machine);
  if (o.experiment.empty()) o.experiment = default_experiment(machine, o.path);
  const sim::TuneSpec spec = spec_of(o, machine);
  std::vector<std::string> inputs = o.controllers;
  inputs.push_back(o.machine);
  if (is_file(o.path)) inputs.push_back(o.path.path);
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
  write_json(o.common.json, report::to_json(result, spec));
  if (!o.common.report.empty())
    report::write_tune_report(o.common.report,
                              {result, spec, parameters.words, typed_command(), STRIBECK_VERSION});
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
  auto o = std::make_shared<Options>();
  verb->add_option("machine", o->machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option("--experiment", o->experiment,
                   "Experiment whose path and controllers are used; left out: chosen as in compare")
      ->check(one_of(experiment_ids()));
  verb->add_option(
          "--controller", o->controllers,
          fmt::format(
              "Tune only this controller, repeatable: an id of the experiment, {}, or a controller file",
              report::listed(built_in_controllers())))
      ->type_name("ID|NAME|FILE.toml");
  verb->add_option("--phase-margin", o->phase_margin, "Smallest allowed phase margin of the loop, in degrees")
      ->check(number_from(1.0, 90.0))
      ->capture_default_str();
  verb->add_option("--gain-margin", o->gain_margin, "Smallest allowed gain margin, up and down, in dB")
      ->check(number_from(0.1, 40.0))
      ->capture_default_str();
  verb->add_option(
          "--delay-margin", o->delay_margin,
          "Smallest allowed delay margin, in control periods: additional delay with which the loop is still stable")
      ->check(number_from(0.0, 100.0))
      ->capture_default_str();
  verb->add_option(
          "--input-variation", o->input_variation,
          "Largest allowed mean |Δu| of every run; left out: that of the last thesis controller of the experiment at its own gains, (f) on the biaxial table")
      ->type_name("VOLTAGE");
  verb->add_option(
          "--axial-mode", o->axial_mode,
          "Frequency of a first axial mode of every axis, with which the loop must be stable; left out: rigid axes")
      ->type_name("FREQUENCY");
  verb->add_option("--evaluations", o->evaluations, "Number of sets of gains to try for each controller")
      ->check(whole_from(10, 100000))
      ->capture_default_str();
  verb->add_option(
          "-o,--output", o->out,
          "Controller files to write: a folder for one ID.toml each, or FILE.toml for a single controller; the id in the file is ID-tuned")
      ->type_name("DIR|FILE.toml");
  add_parameter_options(*verb, o->parameters);
  add_trials(*verb, o->trials, o->threads);
  add_seed(*verb, o->seed);
  verb->add_option("--speed", o->speeds, "Speed along the path, repeatable; left out: 3 and 9.5 mm/s")
      ->type_name("SPEED");
  add_path_options(*verb, o->path);
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Example:\n  stribeck tune machines/biaxial-table.toml --controller f --controller pid -o tuned");
  verb->callback([o, &action] { action = [o] { return tune(*o); }; });
}

}  // namespace stribeck::cli
