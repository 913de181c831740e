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
#include <stribeck/report/pages/verify_report.hpp>
#include <stribeck/workflow/judge/verify.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::cli {
namespace {

struct VerifyCommand {
  Common common;
  std::vector<std::string> files;  ///< axis files, then the logs
  LogArguments log;
  VerifyOptions verify;
};

/// A machine file may stand first. The next one is an axis file and the last one a log; between them the ending tells.
void sort_files(const std::vector<std::string>& files, VerifyOptions& out) {
  auto first = files.begin();
  if (files.size() > 2 && describes_machine(files.front())) out.machine = *first++;
  if (files.end() - first < 2)
    refuse_option("AXIS.toml", "missing, expected one or more axis files and then the log");
  auto first_log = first + 1;
  while (first_log + 1 != files.end() && first_log->ends_with(".toml")) ++first_log;
  out.axis_files.assign(first, first_log);
  out.logs.assign(first_log, files.end());
}

int run_verify(const VerifyCommand& o) {
  VerifyOptions options = o.verify;
  sort_files(o.files, options);
  std::vector<std::string> inputs = o.files;
  inputs.push_back(options.controller);
  check_distinct(inputs, {o.common.json});
  if (!(options.limits.good <= options.limits.usable))
    refuse_option("--good", fmt::format("got {:g} %, expected at most --usable, {:g} %", options.limits.good,
                                        options.limits.usable));
  const OutputFolder page_folder = check_outputs(o.common);
  options.log = o.log.resolved();
  report::VerifyReportInput page = computing("verify", o.common, [&] { return verify(options); });
  const report::Made made = made_from(inputs);
  page.command = made.command;
  page.version = made.version;
  page.inputs = made.inputs;
  write_json(o.common.json, report::to_json(page), made);
  report::write_verify_report(folders_of(o.common), page);
  say(o.common, report::text_table(page));
  return report::usable(page) ? 0 : 1;
}

}  // namespace

void add_verify(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "verify",
      "Test identified models on logs that were not used to identify them: error of the force, motion in open and closed loop, verdict (exit code 1: no model is shown to be usable)");
  auto o = std::make_shared<VerifyCommand>();
  verb->add_option(
          "files", o->files,
          "Machine file where the logs need the drive of the axis (V, A, %, turns), axis files written by "
          "identify, then the logs")
      ->required()
      ->type_name("[MACHINE.toml] AXIS.toml... LOG...");
  add_log_options(*verb, o->log);
  verb->add_option(
          "--controller", o->verify.controller,
          "TOML file of the position controller that made the log (kind cascade or pd, forces in N): "
          "replays the closed loop as well")
      ->type_name("FILE.toml");
  verb->add_option(
          "--force-shift", o->verify.force_shift,
          "Time by which the force is later in the log than its motion, without a filter of the drive; left out: found in the log, and said where it is not that of a commanded force")
      ->type_name("TIME");
  verb->add_option("--good", o->verify.limits.good,
                   "Largest error of the force of a good model, in percent; of its friction twice as much")
      ->check(number_from(0.0, 1000.0))
      ->capture_default_str();
  verb->add_option(
          "--usable", o->verify.limits.usable,
          "Largest error of the force of a usable model, in percent; exit code 1 where no model is usable")
      ->check(number_from(0.0, 1000.0))
      ->capture_default_str();
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Example:\n  stribeck verify a.toml b.toml c.toml x-unseen-log.csv --axis x --report report\n"
      "  stribeck verify machine.toml x.toml x-log-in-percent.csv\n"
      "  stribeck verify x.toml log.csv --gain \"35.15 N/V\" --controller controller.toml");
  verb->callback([o, &action] { action = [o] { return run_verify(*o); }; });
}

}  // namespace stribeck::cli
