#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/option_groups.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/report/commission/commission_report.hpp>
#include <stribeck/workflow/stages/stages.hpp>

namespace stribeck::cli {
namespace {

struct CommissionCommand {
  Common common;
  LogArguments log;
  StageOptions what;
};

int run_commission(CommissionCommand& o) {
  check_distinct({o.what.machine}, {o.common.json});
  static_cast<void>(check_outputs(o.common));
  const OutputFolder output(o.what.output);
  o.what.log = o.log.resolved();
  o.what.version = STRIBECK_VERSION;
  const report::CommissionReportInput found = commission_from_logs(o.what);
  write_json(o.common.json, report::to_json(found));
  say(o.common, report::text_table(found));
  return found.ready() ? 0 : 1;
}

}  // namespace

void add_commission(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "commission",
      "From a folder of logs to verified axis files: what they determine, what to record next (exit code 1: an axis is not ready)");
  auto o = std::make_shared<CommissionCommand>();
  verb->add_option("machine", o->what.machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option("--logs", o->what.folder, "Folder of the logs, of any axes")
      ->required()
      ->type_name("FOLDER");
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
  verb->footer("Example:\n  stribeck commission machine.toml --logs logs -o axes");
  verb->callback([o, &action] { action = [o] { return run_commission(*o); }; });
}

}  // namespace stribeck::cli
