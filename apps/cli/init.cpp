#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include <apps/cli/commands.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/report/shell_words.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/sim/machine.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::cli {
namespace {

struct InitCommand {
  Common common;
  MachineDraft draft;
  std::vector<std::string> set;
  std::string output;
};

/// The values of --set, each with its key.
void take_values(InitCommand& o) {
  for (const std::string& text : o.set) {
    auto [key, value] = halves("--set", text, "AXIS.GROUP.KEY=VALUE");
    check_value(o.draft, "--set", key, value);
    o.draft.values.emplace_back(std::move(key), std::move(value));
  }
}

/// Asks for what was not given, until it can be read. An empty answer leaves it out.
void ask(MachineDraft& draft) {
  fmt::print(
      "Values with their unit; nothing leaves a line to fill in later. An axis that turns takes deg, N m and kg m2.\n");
  for (const std::string& axis : draft.axes) {
    for (const Asked& a : asked_keys()) {
      const std::string key = fmt::format("{}.{}.{}", axis, a.group, a.key);
      if (!worth_asking(draft, axis, a)) continue;
      while (draft.find(key) == nullptr) {
        const bool rotary = !a.rotary_example.empty() && draft.rotary(axis);
        const std::string_view doc = info_of(a).doc;
        fmt::print("{}: {}", key, doc);
        if (doc.find("e.g. \"") == std::string_view::npos)
          fmt::print(", e.g. {}", rotary ? a.rotary_example : a.example);
        fmt::print(": ");
        std::fflush(stdout);
        std::string answer;
        if (!std::getline(std::cin, answer) || answer.find_first_not_of(" \t") == std::string::npos) break;
        try {
          answer = as_answered(a, answer);
          check_value(draft, key, key, answer);
          draft.values.emplace_back(key, answer);
        } catch (const io::InputError& e) {
          fmt::print("{}\n", e.problems().front().text());
        }
      }
    }
  }
}

int init(InitCommand o) {
  io::check_writable(o.output);
  check_distinct({}, {o.output, o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);
  (void)option_si("--sample-time", o.draft.sample_time, quantity("s", "ms").positive().at_most(0.1));
  if (o.draft.name.find_first_of("\"\\\n") != std::string::npos)
    refuse_option("--name", "expected a name without quotes and backslashes");
  for (auto axis = o.draft.axes.begin(); axis != o.draft.axes.end(); ++axis) {
    if (!sim::is_axis_name(*axis))
      refuse_option("--axes",
                    fmt::format("got {}, expected names of 1 to 16 letters and digits, e.g. --axes x y c2",
                                io::in_quotes(*axis)));
    if (std::find(o.draft.axes.begin(), axis, *axis) != axis)
      refuse_option("--axes",
                    fmt::format("got {} twice, expected another name for each axis", io::in_quotes(*axis)));
  }
  take_values(o);
  const bool asks = !o.common.quiet && isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1;
  std::error_code absent;
  if (std::filesystem::is_regular_file(o.output, absent) &&
      (asks || io::read_text(o.output) != draft_text(o.draft)))
    throw io::InputError(
        {o.output,
         0,
         {},
         "exists, and what was filled in there would be lost (give another name after -o, or move it "
         "away)"});
  if (asks) ask(o.draft);
  io::write_atomically(o.output, draft_text(o.draft));
  const std::vector<std::string> open = open_keys(o.draft);
  write_json(o.common.json, {{"schema", "stribeck.init/1"}, {"machine", o.draft.name}, {"fill_in", open}},
             made_from({}));
  say(o.common, fmt::format("Machine file in {}.\n", o.output));
  if (!open.empty())
    say(o.common, fmt::format("To fill in, marked FILL IN: {}.\n", report::joined(open, ", ")));
  say(o.common, fmt::format("Then: stribeck machine {}\n", report::shell_quoted(o.output)));
  return 0;
}

}  // namespace

void add_init(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "init", "Write a commented machine file from options, and from answers on a terminal");
  auto o = std::make_shared<InitCommand>();
  verb->add_option("--name", o->draft.name, "Name of the machine")->required()->type_name("NAME");
  verb->add_option("--axes", o->draft.axes, "Names of its axes, e.g. --axes x y z")
      ->required()
      ->type_name("NAME")
      ->delimiter(',');
  verb->add_option("--sample-time", o->draft.sample_time, "Control period, e.g. \"1 ms\"")
      ->required()
      ->type_name("TIME");
  verb->add_option("--set", o->set, "A value of the file, repeatable, e.g. \"x.limits.speed=30 m/min\"")
      ->type_name("AXIS.GROUP.KEY=VALUE");
  verb->add_option("-o,--output", o->output, "Machine file to write")->required()->type_name("MACHINE.toml");
  add_common(*verb, o->common, Page::kNone);
  refuse_empty_options(*verb);
  verb->footer(
      "Example:\n  stribeck init --name gantry --axes x y z --sample-time \"1 ms\" --set \"x.drive.rated_torque=2.4 "
      "N m\" -o gantry.toml");
  verb->callback([o, &action] { action = [o] { return init(*o); }; });
}

}  // namespace stribeck::cli
