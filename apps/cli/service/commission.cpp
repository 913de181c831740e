#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/option_groups.hpp>
#include <apps/cli/service/commission_linuxcnc.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/report/commission/commission_report.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/stages/stages.hpp>

namespace stribeck::cli {
namespace {

struct CommissionCommand {
  Common common;
  LogArguments log;
  StageOptions what;
  RunningArguments running;
};

int run_running(CommissionCommand& o) {
  const LogOptions given = o.log.resolved();
  if (!given.maps.empty() || !given.gain.empty() || !given.lead.empty() || !given.where.empty() ||
      !given.runs.empty() || !given.sample_time.empty() || !given.keep.empty() || !o.log.map_file.empty())
    refuse_option("--linuxcnc", "records its logs itself: options on the columns of logs belong to --logs");
  check_distinct({o.what.machine, o.running.what.ini}, {o.common.json});
  static_cast<void>(check_outputs(o.common));
  const OutputFolder output(o.what.output);
  o.running.what.machine = o.what.machine;
  o.running.what.output = o.what.output;
  o.running.what.axis = given.axis;
  o.running.what.limits = o.what.limits;
  o.running.what.version = STRIBECK_VERSION;
  return commission_running(o.common, o.running);
}

int run_commission(CommissionCommand& o) {
  if (!o.running.what.ini.empty()) {
    if (!o.what.folder.empty()) refuse_option("--linuxcnc", "and --logs exclude each other");
    return run_running(o);
  }
  if (o.what.folder.empty()) refuse_option("--logs", "or --linuxcnc is missing");
  if (!o.running.what.stage.empty()) refuse_option("--stage", "belongs to --linuxcnc");
  if (o.running.yes) refuse_option("--yes", "belongs to --linuxcnc");
  if (o.running.undo) refuse_option("--undo", "belongs to --linuxcnc");
  check_distinct({o.what.machine}, {o.common.json});
  static_cast<void>(check_outputs(o.common));
  const OutputFolder output(o.what.output);
  o.what.log = o.log.resolved();
  o.what.version = STRIBECK_VERSION;
  const report::CommissionReportInput found = commission_from_logs(o.what);
  std::vector<std::string> inputs{o.what.machine};
  for (const report::CommissionedAxisReport& axis : found.axes) {
    inputs.insert(inputs.end(), axis.logs.begin(), axis.logs.end());
    if (!axis.held_out.empty()) inputs.push_back(axis.held_out);
  }
  write_json(o.common.json, report::to_json(found), made_from(inputs));
  say(o.common, report::text_table(found));
  return found.ready() ? 0 : 1;
}

}  // namespace

void add_commission(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "commission",
      "From a folder of logs, or on a running LinuxCNC, to verified models: what is determined, what comes next (exit code 1: not ready, or stopped)");
  auto o = std::make_shared<CommissionCommand>();
  verb->add_option("machine", o->what.machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option("--logs", o->what.folder, "Folder of the logs, of any axes")->type_name("FOLDER");
  verb->add_option(
          "--linuxcnc", o->running.what.ini,
          "In place of --logs: INI file of a LinuxCNC that runs here. Checks it, moves its axes, records, "
          "identifies, drives a circle before and after, and writes its configuration")
      ->type_name("CONFIG.ini");
  verb->add_option(
          "--stage", o->running.what.stage,
          fmt::format(
              "With --linuxcnc: this stage alone, also when it is done ({}); left out: all that are not done",
              report::joined(commissioning::stage_names(), ", ")))
      ->check(one_of(commissioning::stage_names()))
      ->type_name("NAME");
  verb->add_flag("--yes", o->running.yes, "With --linuxcnc: motions begin without a question");
  verb->add_flag(
      "--undo", o->running.undo,
      "With --linuxcnc: gives back the configuration as it was, byte for byte, and the values of HAL");
  verb->add_option("-o,--output", o->what.output,
                   "Folder for AXIS.toml of each verified axis, and for the state of this command")
      ->required()
      ->type_name("FOLDER");
  verb->add_option("--good", o->what.limits.good, "Largest error of the force of a good model, in percent")
      ->check(number_from(0.0, 1000.0))
      ->capture_default_str();
  verb->add_option("--usable", o->what.limits.usable,
                   "Largest error of the force of a model that is promoted, in percent")
      ->check(number_from(0.0, 1000.0))
      ->capture_default_str();
  add_log_options(*verb, o->log);
  add_common(*verb, o->common, Page::kNone);
  refuse_empty_options(*verb);
  verb->footer(
      "Examples:\n  stribeck commission machine.toml --logs logs -o axes\n  stribeck commission machine.toml --linuxcnc "
      "mill.ini -o commissioned");
  verb->callback([o, &action] { action = [o] { return run_commission(*o); }; });
}

}  // namespace stribeck::cli
