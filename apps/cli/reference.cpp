/// `stribeck reference -o FOLDER`: writes the pages of docs/reference from the declarations in the program. It is not in --help;
/// tools/make-reference runs it, adds the page of the JSON keys and compares. With --install: man pages and completion, which
/// the build makes beside the program.

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <cmath>

#include <apps/cli/commands.hpp>
#include <apps/cli/shell/shell_pages.hpp>
#include <capi/axis_settings.hpp>
#include <capi/parameters.hpp>
#include <stribeck/ident/replay/replay_controller.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/keys.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/sim/compare.hpp>
#include <stribeck/workflow/board/entry.hpp>
#include <stribeck/workflow/log/log_options.hpp>
#include <stribeck/workflow/machine/description.hpp>
#include <stribeck/workflow/study/study_file.hpp>

namespace stribeck::cli {
namespace {

constexpr std::string_view kMade =
    "<!-- Made by tools/make-reference from the program's own declarations; change those, not this page. -->\n\n";
constexpr std::string_view kHowToRead =
    "Quantities are text with a unit of the same kind (`\"5 mm\"`, `\"0.2 in\"`); the table shows the unit that the "
    "program writes. A key without a default is required. Where a table says when a key has an effect, the key is "
    "refused at other times unless it has its default. `<name>` is a name of your own; `[]` stands for each item of "
    "a list.\n";

std::string page(std::string_view title, std::string_view about) {
  return fmt::format("{}# {}\n\n{}", kMade, title, about);
}

std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

// ---- files

/// Keys of a machine file. Each table below `published` is an axis file, which has its own page.
std::vector<io::KeyInfo> machine_keys() {
  std::vector<io::KeyInfo> keys = io::keys_of<workflow::MachineDescription>();
  constexpr std::string_view kPublished = "axes.<name>.published.";
  std::erase_if(keys, [&](const io::KeyInfo& k) {
    return k.key.starts_with(kPublished) && k.key.find('.', kPublished.size()) != std::string::npos;
  });
  for (io::KeyInfo& k : keys) {
    if (k.key.starts_with(kPublished)) k.doc += ", with the keys of an [axis file](axis-file.md)";
  }
  return keys;
}

std::string machine_page() {
  return page("Machine files",
              fmt::format("What `machines/*.toml` and every argument `MACHINE.toml` may hold. {}",
                          kHowToRead)) +
         io::markdown_by_table(machine_keys(), 2);
}

std::string axis_page() {
  return page("Axis files",
              fmt::format("What `identify -o AXIS.toml` writes and `--axis-file` takes: mass, load "
                          "and friction of one axis, and what its drive loses between motor and table. {}",
                          kHowToRead)) +
         io::markdown_by_table(io::keys_of<sim::AxisFile>(), 2);
}

std::string controller_page() {
  return page("Controller files",
              fmt::format(
                  "What `controllers/*.toml`, `--controller FILE.toml` and the files of `tune` hold. {}",
                  kHowToRead)) +
         io::markdown_by_table(io::keys_of<sim::ControllerSpec>(), 2);
}

std::string study_page() {
  return page(
             "Study files",
             fmt::format(
                 "What `study STUDY.toml` takes: the machine, what of it varies, controllers and figures of merit. "
                 "Paths count from the folder of the file. [Guide](../guides/study.md). {}",
                 kHowToRead)) +
         io::markdown_by_table(io::keys_of<workflow::StudyFile>(), 2);
}

std::string board_page() {
  return page(
             "Entry files of the board",
             fmt::format(
                 "What `bench ENTRY.toml` takes: somebody's identification or controller. Paths count from the folder "
                 "of the file. [Protocol](../board.md). {}",
                 kHowToRead)) +
         io::markdown_by_table(io::keys_of<workflow::BoardEntry>(), 2);
}

std::string side_page() {
  return page("Side files", kHowToRead) +
         "\n## Beside a log: `LOG.csv.toml`\n\nRead with `LOG.csv` wherever a log is read.\n" +
         io::markdown_by_table(io::side_file_keys(), 3) +
         "\n## What the columns of a log are: `--map-file MAP.toml`\n\nOptions of the verbs that read logs, so that "
         "nothing is typed twice. What is typed counts more.\n" +
         io::markdown_by_table(workflow::map_file_keys(), 3) +
         "\n## The controller of a logged loop: `verify --controller FILE.toml`\n" +
         io::markdown_by_table(io::keys_of<ident::replay::ReplayController>(), 3);
}

// ---- C interface and HAL

std::string limits_of(const capi::Leaf& leaf) {
  if (leaf.choice != nullptr) {
    std::string words;
    for (std::size_t i = 0; i < leaf.choice->word_count; ++i)
      words += fmt::format("{}{} {}", i == 0 ? "" : ", ", i, leaf.choice->words[i]);
    return words;
  }
  if (leaf.kind == STRIBECK_SWITCH) return "0 or 1";
  // Values of the C interface are in SI.
  Quantity si = leaf.field->quantity;
  si.shown = si.unit;
  return io::range_text(si);
}

std::string parameters_table(const Value& initial) {
  std::string out =
      "| Parameter | SI unit | Before it is set | Range or words | Meaning | Has an effect |\n|---|---|---|---|---|---|\n";
  capi::list(initial, [&](const capi::Leaf& leaf) {
    const FieldInfo& f = *leaf.field;
    out += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", leaf.name, f.quantity.unit,
                       std::isnan(leaf.value) ? "left out" : io::number_text(leaf.value),
                       cell(limits_of(leaf)), cell(f.doc), cell(f.condition));
  });
  return out;
}

std::string parameters_page() {
  return page(
             "Parameters of the C interface and of HAL",
             "Names for `stribeck_controller_set()` and `stribeck_plant_set()`, all in SI units. In HAL they carry "
             "`-` for `_`, behind the name of the component and the axis (`ct.0.observer-pole`). \"Left out\" is "
             "NaN. A choice takes the index of its word. A parameter without an effect may keep its value.\n") +
         "\n## Controller, for each axis\n\n" + parameters_table(initial_of(type_of<capi::AxisSettings>)) +
         "\n## Virtual drive\n\n" + parameters_table(initial_of(type_of<plant::AxisParams>));
}

// ---- verbs

/// Names of an option with its value: `-o --output FILE`.
std::string name_of(const DescribedOption& o) {
  std::string name;
  for (const std::string& n : o.names) name += (name.empty() ? "" : " ") + n;
  return o.value.empty() ? name : name + " " + o.value;
}

std::string verb_section(const DescribedVerb& verb) {
  std::string out = fmt::format("\n## {}\n\n{}.\n\n", verb.name, verb.meaning);
  out += "| Option | Default | Meaning |\n|---|---|---|\n";
  for (const DescribedOption& o : verb.options) {
    if (o.help) continue;
    out += fmt::format("| `{}` | {} | {} |\n", cell(name_of(o)), o.required ? "required" : cell(o.initial),
                       cell(o.meaning));
  }
  if (!verb.examples.empty()) out += fmt::format("\n```\n{}\n```\n", verb.examples);
  return out;
}

std::string verbs_page(const DescribedCommand& command) {
  std::string out =
      page("Verbs and options",
           "`stribeck VERB …`; `stribeck VERB --help` shows the same. Exit codes: 0 done, 1 the answer "
           "is no, 2 wrong usage or input.\n");
  for (const DescribedVerb& verb : command.verbs) out += verb_section(verb);
  return out;
}

}  // namespace

void add_reference(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand("reference", "Write the pages of docs/reference");
  verb->group("");
  auto folder = std::make_shared<std::string>();
  auto install = std::make_shared<bool>(false);
  verb->add_option("-o,--output", *folder, "Folder of the pages")->required()->type_name("FOLDER");
  verb->add_flag("--install", *install,
                 "In place of docs/reference: man pages and completion, laid out as below share/");
  verb->callback([folder, install, &app, &action] {
    // The verbs are read now, because the action may run after they are gone.
    const DescribedCommand command = described_command(app, "stribeck " STRIBECK_VERSION);
    action = [folder, install, command] {
      if (*install) {
        write_shell_pages(*folder, command);
        return 0;
      }
      const auto write = [&](const char* name, const std::string& text) {
        io::write_atomically(*folder + "/" + name, text);
      };
      write("machine-file.md", machine_page());
      write("axis-file.md", axis_page());
      write("controller-file.md", controller_page());
      write("study-file.md", study_page());
      write("board-entry.md", board_page());
      write("side-files.md", side_page());
      write("parameters.md", parameters_page());
      write("verbs.md", verbs_page(command));
      return 0;
    };
  });
}

}  // namespace stribeck::cli
