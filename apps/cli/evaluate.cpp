#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/report/circle/circle_change.hpp>
#include <stribeck/report/circle/circle_report.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/circle_logs.hpp>

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
  const std::vector<report::CircleVerdict> verdicts = report::circle_verdicts(input);
  const bool passed = std::all_of(verdicts.begin(), verdicts.end(),
                                  [](const report::CircleVerdict& v) { return v.passed(); });
  return passed ? 0 : 1;
}

}  // namespace

void add_evaluate(CLI::App& app, Action& action) {
  auto* verb =
      app.add_subcommand("evaluate", "Measured circles from any log: circular test and causes of the error");
  auto o = std::make_shared<EvaluateCommand>();
  verb->add_option("logs", o->what.logs, "Logs of the same program, one log for each control")
      ->required()
      ->type_name("LOG...");
  verb->add_option("--path", o->path, "Shape of the path")->check(one_of({"circle"}))->capture_default_str();
  verb->add_option("--size", o->what.size, "Commanded radius")->type_name("LENGTH")->capture_default_str();
  verb->add_option(
          "--map", o->what.maps,
          "Which column is what: x, y (positions; left out: found by name), rx, ry (commanded positions; the circle then has their centre, else the least-squares centre); of a ball-bar angle and radius")
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
              "was not measured",
              report::listed(report::limited_figures())))
      ->type_name("FIGURE=LENGTH");
  verb->add_flag("--together", o->what.together,
                 "The logs are of one machine, e.g. at several feeds: one diagnosis over all of them");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Examples:\n  stribeck evaluate before.log after.log --limit G=10um --report page\n  stribeck evaluate pid.log axis.log --map x=\"x-pos mm\" --map y=\"y-pos mm\" --where "
      "line=7 --report page");
  verb->callback([o, &action] { action = [o] { return evaluate(*o); }; });
}

}  // namespace stribeck::cli
