#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include <apps/cli/commands.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>

namespace stribeck::cli {
namespace {

struct MachineCommand {
  Common common;
  std::string machine;
};

std::string as_text(const ExplainedAxis& axis) {
  std::size_t what = 0;
  std::size_t value = 0;
  for (const Explained& line : axis.lines) {
    what = std::max(what, report::text_width(line.what));
    value = std::max(value, report::text_width(line.value));
  }
  std::string out = fmt::format("\nAxis {}:  {}\n", axis.name, axis.drawing);
  for (const Explained& line : axis.lines) {
    out += "  " + report::left_aligned(line.what, what) + "  ";
    out += line.note.empty() ? line.value : report::left_aligned(line.value, value) + "  " + line.note;
    out += '\n';
  }
  for (const std::string& lack : axis.lacks) out += "  missing for " + lack + '\n';
  return out;
}

int machine(const MachineCommand& o) {
  check_distinct({o.machine}, {o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);
  const MachineDescription m = read_description(o.machine);
  nlohmann::ordered_json axes = nlohmann::ordered_json::array();
  std::string text =
      fmt::format("{}: {} {}, control period {} ms\n", m.name, m.axes.size(),
                  m.axes.size() == 1 ? "axis" : "axes", report::short_number(m.sample_time * 1e3));
  for (std::size_t i = 0; i < m.axes.size(); ++i) {
    const ExplainedAxis axis = explain(m, i);
    text += as_text(axis);
    nlohmann::ordered_json one{{"axis", axis.name}};
    one.update(axis.numbers);
    one["lacks"] = axis.lacks;
    axes.push_back(std::move(one));
  }
  write_json(o.common.json,
             {{"schema", "stribeck.machine/1"},
              {"machine", m.name},
              {"sample_time_ms", m.sample_time * 1e3},
              {"axes", std::move(axes)}},
             made_from({o.machine}));
  say(o.common, text);
  return 0;
}

}  // namespace

void add_machine(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "machine", "Check a machine file, explain its values and say what is missing for which verb");
  auto o = std::make_shared<MachineCommand>();
  verb->add_option("machine", o->machine, "Machine file")->required()->type_name("MACHINE.toml");
  add_common(*verb, o->common, Page::kNone);
  refuse_empty_options(*verb);
  verb->footer("Example:\n  stribeck machine machines/biaxial-table.toml");
  verb->callback([o, &action] { action = [o] { return machine(*o); }; });
}

}  // namespace stribeck::cli
