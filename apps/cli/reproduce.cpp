#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/report/pages/reproduction.hpp>
#include <stribeck/report/shell_words.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/reproduce/compare_documents.hpp>
#include <stribeck/workflow/reproduce/reproduction.hpp>

namespace stribeck::cli {
namespace {

struct ReproduceCommand {
  Common common;
  ReproduceOptions what;
  std::string markdown;
  std::string check;

  ReproduceCommand() { what.ids.clear(); }
};

/// The command that makes the same page again, without options that have no effect.
std::string command_of(const ReproduceOptions& o) {
  const ReproduceOptions standard;
  std::string command = "stribeck reproduce " + report::joined(o.ids, " ");
  if (o.trials != standard.trials) command += fmt::format(" --trials {}", o.trials);
  if (o.seed != standard.seed) command += fmt::format(" --seed {}", o.seed);
  if (o.machines != standard.machines) command += fmt::format(" --machines {}", o.machines);
  if (o.vary != standard.vary) command += " --vary " + o.vary;
  for (const std::string& name : o.controllers) command += " --controller " + report::shell_quoted(name);
  return command;
}

/// A bar for each stage of the work.
class StageBars {
 public:
  explicit StageBars(bool quiet) : quiet_(quiet) {}
  void operator()(const char* stage, std::size_t done, std::size_t all) {
    if (stage_ != stage) {
      bar_.reset();
      bar_.emplace(stage_ = stage, quiet_);
    }
    (*bar_)(done, all);
  }

 private:
  bool quiet_;
  std::string stage_;
  std::optional<Progress> bar_;
};

int run_reproduce(const ReproduceCommand& o) {
  const ReproductionPlan plan = plan_reproduction(o.what);
  std::vector<std::string> inputs = o.what.controllers;
  inputs.push_back(o.check);
  check_distinct(inputs, {page_of(o.common), o.common.json, o.markdown});
  const std::string expected = o.check.empty() ? std::string() : io::read_text(o.check);
  const OutputFolder page_folder = check_outputs(o.common);
  io::check_writable(o.markdown);
  report::ReproductionInput page;
  {
    StageBars bars(o.common.quiet);
    page = reproduce(plan,
                     [&](const char* stage, std::size_t done, std::size_t all) { bars(stage, done, all); });
  }
  page.version = STRIBECK_VERSION;
  page.command = command_of(o.what);
  // The command that makes the same result, without threads and names of outputs.
  report::Made made = made_from(o.what.controllers);
  made.command = page.command;
  page.inputs = made.inputs;
  write_json(o.common.json, report::reproduction_json(page), made);
  report::write_reproduction(folders_of(o.common), page);
  const std::string markdown = report::reproduction_markdown(page);
  if (!o.markdown.empty()) io::write_atomically(o.markdown, markdown);
  say(o.common, report::reproduction_text(page));
  if (o.check.empty()) return 0;
  const std::string difference = first_difference(expected, markdown);
  if (!difference.empty()) {
    fmt::print(
        stderr, "stribeck: {}\n",
        io::printable(fmt::format("{}:{} (write the table anew with --markdown)", o.check, difference)));
    return 1;
  }
  say(o.common, fmt::format("\n{} is what comes out now.\n", o.check));
  return 0;
}

}  // namespace

void add_reproduce(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "reproduce", "Repeat the experiments of the thesis and compare the results with its printed values");
  auto o = std::make_shared<ReproduceCommand>();
  verb->add_option("ids", o->what.ids, "Experiments; all: every experiment of the thesis, without robustness")
      ->required()
      ->check(one_of(reproducible_ids()))
      ->type_name("ID");
  add_trials(*verb, o->what.trials, o->what.threads);
  add_seed(*verb, o->what.seed);
  verb->add_option("--machines", o->what.machines,
                   "Number of machines in robustness, each with different deviations")
      ->check(whole_from(1, 100000))
      ->capture_default_str();
  std::vector<std::string> factors = sim::variation_factors();
  factors.insert(factors.begin(), "all");
  verb->add_option("--vary", o->what.vary, "Factor in which the machines of robustness differ")
      ->check(one_of(factors))
      ->type_name("FACTOR")
      ->capture_default_str();
  verb->add_option(
          "--controller", o->what.controllers,
          fmt::format(
              "Controllers of robustness in place of (g) and the following, repeatable: {}, or a controller file, e.g. of tune -o",
              report::listed(built_in_controllers())))
      ->type_name("NAME|FILE.toml");
  verb->add_option("--markdown", o->markdown, "Table for a document")->type_name("FILE.md");
  verb->add_option("--check", o->check,
                   "Compare with a file that --markdown wrote; exit code 1 if they differ")
      ->type_name("FILE.md");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Examples:\n  stribeck reproduce all --report build/reproduction\n  stribeck reproduce smc-circle "
      "smc-free\n  stribeck reproduce robustness --machines 1000\n"
      "  stribeck reproduce robustness --controller tuned/f.toml --controller tuned/h.toml");
  verb->callback([o, &action] { action = [o] { return run_reproduce(*o); }; });
}

}  // namespace stribeck::cli
