#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/targets/linuxcnc/axis_lines.hpp>
#include <stribeck/targets/target.hpp>

namespace stribeck::cli {
namespace {

struct ExportCommand {
  Common common;
  std::string to;
  targets::ExportRequest what;
};

std::vector<std::string> target_names() {
  std::vector<std::string> names;
  for (const targets::Target& t : targets::all_targets()) names.emplace_back(t.name);
  return names;
}

std::string target_list() {
  std::string out = "The program or control";
  for (const targets::Target& t : targets::all_targets()) out += fmt::format("; {}: {}", t.name, t.writes);
  return out;
}

int run_export(const ExportCommand& o) {
  const std::vector<std::string> inputs = inputs_of(o.what);
  check_distinct(inputs, {o.what.output, o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);
  targets::ExportRequest request = o.what;
  request.command = typed_command();
  const std::string notes = targets::axis_notes(request);
  targets::Exported written;
  {
    Progress progress("", o.common.quiet);
    request.progress = [&progress](std::string_view what, std::size_t done, std::size_t all) {
      progress(what, done, all);
    };
    written = targets::find_target(o.to)->write(request);
  }
  written.text += notes;
  write_json(o.common.json, written.json, made_from(inputs));
  say(o.common, written.text);
  return 0;
}

/// The loop, and the circle on which the contour error is predicted.
void add_circle_options(CLI::App& verb, targets::ExportRequest& what) {
  verb.add_option(
          "--controller", what.controller,
          "For sinumerik, tnc and fanuc: file of a cascade with the gains of the machine, e.g. a changed controllers/cascade.toml; left out: cascade, built in; for isg, c, structured-text, cia402 and all, where it adds what depends on the loop")
      ->type_name("NAME|FILE.toml");
  verb.add_option(
          "--period", what.period,
          "With a prediction on a circle (sinumerik, tnc, fanuc; isg, c, structured-text, cia402 and all with --controller): period of the position loop; left out: that of --machine or of the axis files, else 1 ms")
      ->type_name("TIME");
  verb.add_option(
          "--size", what.size,
          "With a prediction on a circle (sinumerik, tnc, fanuc; isg, c, structured-text, cia402 and all with --controller): radius of the circle on which the contour error is predicted; left out: 10 mm")
      ->type_name("LENGTH");
  verb.add_option(
          "--machine", what.machine,
          "With a prediction on a circle (sinumerik, tnc, fanuc; isg, c, structured-text, cia402 and all with --controller): virtual machine for the prediction; left out: axes that are what was identified")
      ->type_name("MACHINE.toml");
}

}  // namespace

void add_export(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand("export", "Write identified parameters in the format of another program");
  auto o = std::make_shared<ExportCommand>();
  verb->add_option(
          "files", o->what.files,
          "Axis files written by identify, to export controllers; or one machine file, to export a whole configuration or its virtual drives")
      ->required()
      ->type_name("FILE.toml");
  verb->add_option("--to", o->to, target_list())->required()->check(one_of(target_names()));
  verb->add_option(
          "-o,--output", o->what.output,
          "File to write (NAME.hal for linuxcnc); a folder for --to all, and for a machine file, of which it becomes a whole configuration")
      ->required()
      ->type_name("FILE|FOLDER");
  verb->add_option(
          "--name", o->what.names,
          "Name of each axis in the target; left out: as the axis files say, else x, y, …; in HAL ax.x, ax.y, …, or pl.x, … of drives, ff.x, … of tables")
      ->type_name("NAME");
  verb->add_option("--omega", o->what.omega,
                   std::string("Double pole of the position loops; left out: ") + targets::linuxcnc::kOmega +
                       ", or what the machine file has for commissioning")
      ->type_name("FREQUENCY");
  verb->add_option(
          "--feedforward", o->what.feedforward,
          "none, steady, dynamic or reversal; left out: dynamic where the file has bristles, else reversal")
      ->check(one_of(words_of<control::Feedforward>()));
  verb->add_flag(
      "--lincurve", o->what.lincurve,
      "For axis files: write the steady friction as a table of 16 points for LinuxCNC's stock component lincurve, and print the error of that table");
  verb->add_option(
          "--speed", o->what.speed,
          "Largest speed of a table or a fit; for sinumerik, tnc and fanuc, and for all with --controller, the feed on the circle; left out: that of the identified range, on a circle as far as the acceleration of the machine, or 1 m/s2, permits")
      ->type_name("SPEED");
  verb->add_option(
          "--gain", o->what.gain,
          "For controls that count in a unit of their own: the force of one unit at the axis, e.g. \"12.5 N/%\" or \"140 N/A\"; of axes with different drives \"x=12.5 N/%,y=20 N/%\"; left out: from drive of the axis files")
      ->type_name("FORCE/UNIT");
  verb->add_option(
          "--lead", o->what.lead,
          "For controls that count at the motor: travel of the axis per turn of the motor, e.g. \"10 mm\" or \"x=10 mm,y=5 mm\"; left out: from drive of the axis files")
      ->type_name("LENGTH");
  verb->add_option(
          "--resolution", o->what.resolution,
          "For pid, and for all: step of the encoder on the axis, for the deadband; left out: that of the axis files, else none is written")
      ->type_name("LENGTH");
  verb->add_option(
          "--zero", o->what.zero,
          "For moteus, and for all: position of the axis at which the encoder of the motor reads zero; left out: 0 mm")
      ->type_name("LENGTH");
  verb->add_option(
          "--parameters", o->what.parameters,
          "For a configuration, parameters of its controllers: identified (from simulated logs of this machine, the default) or commissioning (the rough values of the machine file)")
      ->check(one_of({"identified", "commissioning"}));
  verb->add_option(
          "--axis-file", o->what.axis_files,
          "For a configuration: axis file written by identify, to be used for this axis; repeat for more axes")
      ->type_name("AXIS=FILE");
  add_circle_options(*verb, o->what);
  add_common(*verb, o->common, Page::kNone);
  refuse_empty_options(*verb);
  verb->footer(
      "Examples:\n  stribeck export machines/triaxial-tool.toml --to linuxcnc -o triaxial\n"
      "  stribeck export x.toml y.toml --to linuxcnc --omega \"60 rad/s\" -o axes.hal\n"
      "  stribeck export x.toml --to linuxcnc --lincurve --speed \"100 mm/s\" -o lincurve.hal\n"
      "  stribeck export x.toml --to cia402 --gain \"12.5 N/%\" -o x.st\n"
      "  stribeck export x.toml y.toml --to sinumerik --controller loop.toml --period \"2 ms\" --speed \"50 mm/s\" -o qec.arc\n"
      "  stribeck export x.toml y.toml --to all -o exports\n"
      "  stribeck export x.toml y.toml --to all --controller loop.toml -o exports");
  verb->callback([o, &action] { action = [o] { return run_export(*o); }; });
}

}  // namespace stribeck::cli
