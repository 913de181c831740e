#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/report/circle/circle_change.hpp>
#include <stribeck/report/circle/circle_report.hpp>
#include <stribeck/report/lost_motion/lost_motion_report.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/circle_logs.hpp>
#include <stribeck/workflow/judge/indicator_series.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::cli {
namespace {

struct EvaluateCommand {
  Common common;
  std::string path = "circle";
  CircleOptions what;
};

int evaluate(const EvaluateCommand& o) {
  check_distinct(o.what.logs, {page_of(o.common), o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);
  report::CircleReportInput input = judge_circles(o.what);
  const report::Made made = made_from(o.what.logs);
  input.command = made.command;
  input.version = made.version;
  input.inputs = made.inputs;
  write_json(o.common.json, report::to_json(input), made);
  report::write_circle_report(folders_of(o.common), input);
  say(o.common, report::text_table(input));
  return report::within_limits(input) ? 0 : 1;
}

/// Readings of a dial indicator: lost motion of one axis.
int evaluate_indicator(const EvaluateCommand& o) {
  const auto refuse = [](const char* option) {
    refuse_option(option, "applies to circles only; leave it out with --path indicator");
  };
  if (!o.what.size.empty()) refuse("--size");
  if (!o.what.feeds.empty()) refuse("--feed");
  if (!o.what.maps.empty()) refuse("--map");
  if (!o.what.where.empty()) refuse("--where");
  if (!o.what.labels.empty()) refuse("--label");
  if (!o.what.beside.empty()) refuse("--beside");
  if (!o.what.limits.empty()) refuse("--limit");
  if (o.what.together) refuse("--together");
  if (!o.common.report.empty())
    refuse_option("--report", "readings of an indicator have no page; use --json");
  if (o.what.logs.size() != 1)
    refuse_option("--path", fmt::format("got {} files, expected one series of readings", o.what.logs.size()));
  check_distinct(o.what.logs, {o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);
  const auto series = read_indicator_series(o.what.logs.front());
  const ident::lost_motion::LostMotion found = ident::lost_motion::identify(series);
  nlohmann::ordered_json json;
  json["schema"] = "stribeck.indicator/1";
  json["readings"] = series.size();
  json["lost_motion"] = report::lost_motion_json(found);
  write_json(o.common.json, std::move(json), made_from(o.what.logs));
  say(o.common, fmt::format("{} readings{}", series.size(), report::lost_motion_text(found)));
  return found.total ? 0 : 1;
}

}  // namespace

void add_evaluate(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "evaluate",
      "Measured circles from any log: circular test and causes of the error; lost motion from readings of an indicator");
  auto o = std::make_shared<EvaluateCommand>();
  verb->add_option("logs", o->what.logs, "Logs of the same program, one log for each control")
      ->required()
      ->type_name("LOG...");
  verb->add_option(
          "--path", o->path,
          "What was measured: circle, or indicator: readings of a dial indicator, in a table with the columns direction, reading, position and load")
      ->check(one_of({"circle", "indicator"}))
      ->capture_default_str();
  verb->add_option(
          "--size", o->what.size,
          "Commanded radius; left out: what the file of a ball-bar states, else that of the commanded circle, else the measured one, rounded")
      ->type_name("LENGTH");
  verb->add_option(
          "--feed", o->what.feeds,
          "Feed where a log has no times, as of a ball-bar: one for all logs, or one for each; left out: what "
          "the file states")
      ->type_name("SPEED");
  verb->add_option(
          "--map", o->what.maps,
          "Which column is what: x, y (positions; left out: found by name), rx, ry (commanded positions; the circle then has their centre, else the least-squares centre); of a ball-bar angle and radius or deviation, and direction (ccw, cw) where a column tells it; left out: found by their names")
      ->type_name("QUANTITY=COLUMN");
  verb->add_option("--where", o->what.where,
                   "Rows of one circle, e.g. line=7; repeat for more circles; left out: all rows")
      ->type_name("COLUMN=VALUE");
  verb->add_option("--label", o->what.labels, "Name of each log in the table; left out: the name of the file")
      ->type_name("NAME");
  verb->add_option("--beside", o->what.beside, "A further column of the table, with one value for each log")
      ->type_name("HEAD=VALUE,VALUE");
  verb->add_option(
          "--limit", o->what.limits,
          fmt::format(
              "Largest allowed value of a figure, repeatable: {}; exit code 1 where a log is above it or the figure "
              "was not measured; of several logs the first, with which the others are compared, does not decide (with --together it does)",
              report::listed(report::limited_figures())))
      ->type_name("FIGURE=LENGTH");
  verb->add_flag("--together", o->what.together,
                 "The logs are of one machine, e.g. at several feeds: one diagnosis over all of them");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Examples:\n  stribeck evaluate before.log after.log --limit G=10um --report page\n  stribeck evaluate pid.log axis.log --map x=\"x-pos mm\" --map y=\"y-pos mm\" --where "
      "line=7 --report page\n  stribeck evaluate bar.csv --size \"100 mm\" --feed \"1000 mm/min\" --report page");
  verb->callback(
      [o, &action] { action = [o] { return o->path == "circle" ? evaluate(*o) : evaluate_indicator(*o); }; });
}

}  // namespace stribeck::cli
