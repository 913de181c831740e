#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/option_groups.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/workflow/frequency/frequency.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::cli {
namespace {

struct FrequencyCommand {
  Common common;
  std::vector<std::string> files;
  LogArguments log;
  FrequencyOptions what;
  std::string output;
};

int run_frequency(const FrequencyCommand& o) {
  check_distinct(o.files, {o.output, page_of(o.common), o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);
  io::check_writable(o.output);
  report::FrequencyReportInput found = frequency_of_logs(o.files, o.log.resolved(), o.what);
  if (!o.output.empty() && found.axes.size() > 1)
    refuse_option("--output",
                  fmt::format("one table is of one axis, the logs are of {} (choose one with --axis)",
                              found.axes.size()));
  const report::Made made = made_from(o.files);
  found.command = made.command;
  found.version = made.version;
  found.inputs = made.inputs;
  if (!o.output.empty()) io::write_csv(o.output, report::table_of(found.axes.front()));
  write_json(o.common.json, report::to_json(found), made);
  report::write_frequency_report(folders_of(o.common), found);
  say(o.common, report::text_table(found));
  return 0;
}

}  // namespace

void add_frequency(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "frequency",
      "Measure the frequency response of an axis from its logs: resonances, delay and mass with 95 % intervals, margins, bandwidth and notch");
  auto o = std::make_shared<FrequencyCommand>();
  verb->add_option(
          "log", o->files,
          "Logs of one axis with force, position and reference; several are taken together. With a machine file first: logs of any of its "
          "axes, and the margins of the gains in that file")
      ->required()
      ->type_name("[MACHINE.toml] LOG");
  verb->add_option(
          "--period", o->what.period,
          "Period of the excitation; left out: found in the reference, or in the force of an open loop")
      ->type_name("TIME");
  verb->add_option("--phase-margin", o->what.phase_margin,
                   "Smallest phase margin of the proposed loop, in degrees")
      ->check(number_from(1.0, 90.0))
      ->capture_default_str();
  verb->add_option("--gain-margin", o->what.gain_margin,
                   "Smallest gain margin of the proposed loop, up and down, in dB")
      ->check(number_from(0.1, 40.0))
      ->capture_default_str();
  verb->add_option("-o,--output", o->output,
                   "CSV with a row for each line: frequency, gain, phase, interval, coherence")
      ->type_name("LINES.csv");
  add_log_options(*verb, o->log);
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Example:\n  stribeck excite machine.toml --method multisine --axis x -o x-multisine.csv\n"
      "  stribeck frequency machine.toml x-multisine-log.csv --report page");
  verb->callback([o, &action] { action = [o] { return run_frequency(*o); }; });
}

}  // namespace stribeck::cli
