#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/report/board/board_parts.hpp>
#include <stribeck/workflow/board/board.hpp>

namespace stribeck::cli {
namespace {

struct BenchCommand {
  Common common;
  BoardOptions what;
  std::vector<std::string> entries;
  std::vector<std::string> identifiers;
  std::vector<std::string> controllers;
  std::vector<std::string> answers;
  std::string write_logs;
  bool without_built_in = false;
};

/// Entry files, and what the options name.
std::vector<BoardEntry> entries_of(const BenchCommand& o) {
  std::vector<BoardEntry> all;
  for (const std::string& file : o.entries) all.push_back(read_entry(file));
  for (const std::string& text : o.identifiers) all.push_back(entry_of("--identifier", text));
  for (const std::string& text : o.controllers) all.push_back(entry_of("--controller", text));
  for (const std::string& text : o.answers) all.push_back(entry_of("--answers", text));
  return all;
}

/// Whether every entry of somebody's own gave a result in a case at least.
bool all_measured(const report::BoardResult& result) {
  const auto measured = [](const auto& row) {
    return !row.entrant.outside || row.failures.empty() || row.failed() < row.failures.size();
  };
  return std::all_of(result.identification.begin(), result.identification.end(), measured) &&
         std::all_of(result.control.begin(), result.control.end(), measured);
}

int bench(const BenchCommand& o) {
  if (!o.write_logs.empty()) {
    const auto names = write_board_logs(o.write_logs, o.what.seed, o.what.machines, o.what.threads);
    say(o.common, fmt::format("{} logs in {}: {} machines of two axes, seed {}.\n", names.size(),
                              o.write_logs, o.what.machines, o.what.seed));
    return 0;
  }
  check_distinct(o.entries, {page_of(o.common), o.common.json});
  BoardOptions what = o.what;
  what.entries = entries_of(o);
  what.built_in = !o.without_built_in;
  what.host = {"/proc/self/exe", "board-host"};
  const OutputFolder page_folder = check_outputs(o.common);
  const report::Made made = made_from(o.entries);
  report::BoardResult result;
  {
    Progress progress("bench", o.common.quiet);
    result = run_board(what, [&](std::size_t done, std::size_t all) { progress(done, all); });
  }
  write_json(o.common.json, report::to_json(result), made);
  report::write_board_report(folders_of(o.common), {result, typed_command(), STRIBECK_VERSION});
  say(o.common, report::text_table(result));
  for (const std::string& words : report::failures_in_words(result)) say(o.common, words + ".\n");
  for (const std::string& warning : result.warnings) say(o.common, "Warning: " + warning + ".\n");
  return all_measured(result) ? 0 : 1;
}

}  // namespace

void add_bench(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "bench", "The board: identification and controllers of anybody on machines drawn by a seed");
  auto o = std::make_shared<BenchCommand>();
  verb->add_option("entry", o->entries, "Entry files (docs/board.md), beside the entries that are built in")
      ->type_name("ENTRY.toml");
  verb->add_option(
          "--identifier", o->identifiers,
          "A program that identifies, repeatable: it is called with the path of its answer and the logs")
      ->type_name("COMMAND");
  verb->add_option(
          "--answers", o->answers,
          "A folder with an axis file MACHINE-AXIS.toml for each axis, repeatable; from the logs of --write-logs")
      ->type_name("DIR");
  verb->add_option(
          "--controller", o->controllers,
          "A controller, repeatable: a shared object (stribeck/board.h), a controller file, or a program that answers "
          "a line in each period")
      ->type_name("FILE.so|FILE.toml|COMMAND");
  verb->add_option("--only", o->what.only, "Run only these entries, by their names, e.g. --only auto,f,h")
      ->delimiter(',')
      ->type_name("NAME");
  verb->add_flag("--no-built-in", o->without_built_in, "Leave out the entries that are built in");
  verb->add_option("--machines", o->what.machines, "Number of machines")
      ->check(whole_from(1, 100000))
      ->capture_default_str();
  verb->add_option("--threads", o->what.threads,
                   "Number of threads; 0: all cores. The result does not depend on it")
      ->check(whole_from(0, 4096))
      ->capture_default_str();
  add_seed(*verb, o->what.seed);
  verb->add_option("--seconds", o->what.identifier_seconds,
                   "Most time that a program may take for one axis [s]")
      ->check(number_from(0.1, 86400))
      ->capture_default_str();
  verb->add_flag("--cost", o->what.cost,
                 "Measure the time of a step of every controller as well; only this differs from run to run");
  verb->add_option("--write-logs", o->write_logs, "Write the logs of all axes into a folder, and run nothing")
      ->type_name("DIR");
  verb->add_option("-o,--output", o->what.folder, "Keep logs, models and answers in this folder")
      ->type_name("DIR");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Examples:\n  stribeck bench --json board.json --report board\n"
      "  stribeck bench examples/board/least-squares.toml --only auto,least-squares,coulomb-viscous\n"
      "  stribeck bench --controller \"python3 mine.py\" --only f,h,mine");
  verb->callback([o, &action] { action = [o] { return bench(*o); }; });
}

}  // namespace stribeck::cli
