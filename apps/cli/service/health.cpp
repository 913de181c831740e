#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/option_groups.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/report/health/health_report.hpp>
#include <stribeck/workflow/health/health.hpp>

namespace stribeck::cli {
namespace {

struct HealthCommand {
  Common common;
  HealthOptions what;
  LogArguments log;
  std::string archive;
  double limit = 10.0;        ///< [%]
  double drift_limit = 25.0;  ///< [%]
  ArchiveFolder folder;       ///< locked until the files of this command are written
};

/// Nothing but text on the terminal is wanted: without an archive, the motion of the first test is the answer.
bool only_shows(const HealthCommand& o) {
  const Common& c = o.common;
  return c.json.empty() && c.report.empty() && c.plots.empty() && !c.quiet && o.what.since.empty();
}

int run_health(HealthCommand& o) {
  std::vector<std::string> inputs = o.what.logs;
  inputs.insert(inputs.end(), o.what.circles.begin(), o.what.circles.end());
  inputs.push_back(o.what.machine);
  check_distinct(inputs, {page_of(o.common), o.common.json});
  o.what.log = o.log.resolved();
  check_health_options(o.what);
  if (const std::string first = before_first_test(o.what, o.archive); !first.empty()) {
    say(o.common, first);
    if (only_shows(o)) return 0;
  }
  check_archive(o.what, o.archive);
  o.what.limits = {0.01 * o.limit, 0.01 * o.drift_limit};
  const OutputFolder page_folder = check_outputs(o.common);
  const OutputFolder archive_folder(o.archive);
  o.folder = ArchiveFolder(o.archive);
  report::HealthReportInput page = check_health(o.what, o.folder);
  const report::Made made = made_from(inputs);
  page.command = made.command;
  page.version = made.version;
  page.inputs = made.inputs;
  write_json(o.common.json, report::to_json(page), made);
  report::write_health_report(folders_of(o.common), page);
  say(o.common, report::text_table(page));
  return page.changed() ? 1 : 0;
}

}  // namespace

void add_health(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "health",
      "Repeat a short motion, keep its friction, mass and load in an archive, and tell changes from scatter and seasons (exit code 1: changed)");
  auto o = std::make_shared<HealthCommand>();
  verb->add_option("machine", o->what.machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option("logs", o->what.logs,
                   "Logs of today's test, of any axes; left out: only the trend of the archive")
      ->type_name("LOG");
  verb->add_option("--archive", o->archive, "Folder of the tests: one small file each, never changed")
      ->required()
      ->type_name("FOLDER");
  verb->add_option("--date", o->what.date, "Day of the test; left out: what the log says")
      ->type_name("YYYY-MM-DD");
  verb->add_option(
          "--temperature", o->what.temperature,
          "Temperature of the machine in degrees Celsius; its effect is taken off where every test has one")
      ->check(number_from(-50.0, 150.0));
  verb->add_option("--circle", o->what.circles, "Logs of a circle of two axes, for the circular test")
      ->type_name("LOG");
  verb->add_option("--size", o->what.size, "Commanded radius of the circle")->type_name("LENGTH");
  verb->add_option("--turn", o->what.turn,
                   "Travel per turn of the screw, for periodic forces; left out: lead of the machine file")
      ->type_name("TURN");
  verb->add_option("--since", o->what.since, "First day that counts, e.g. after a repair")
      ->type_name("YYYY-MM-DD");
  verb->add_option("--limit", o->limit, "Smallest step that matters, in percent")
      ->check(number_from(1.0, 1000.0))
      ->capture_default_str();
  verb->add_option("--drift-limit", o->drift_limit,
                   "Smallest slow change that matters, in percent; seasons are slow changes")
      ->check(number_from(1.0, 1000.0))
      ->capture_default_str();
  add_log_options(*verb, o->log);
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Example:\n  stribeck health machine.toml x-jog.csv x-mass.csv --archive health --date 2026-11-23\n"
      "  stribeck health machine.toml --archive health --report page");
  verb->callback([o, &action] { action = [o] { return run_health(*o); }; });
}

}  // namespace stribeck::cli
