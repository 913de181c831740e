#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string_view>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <apps/cli/trace_page.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/excitation.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/run/axis_excitation.hpp>

namespace stribeck::cli {
namespace {

using ident::excitation::ExcitationMethod;

struct ExciteCommand {
  Common common;
  std::string machine;
  ExcitationOptions what;
  std::string method;
  std::string axis;
  std::string output;
  std::string gcode;
};

bool is_gcode(const std::string& path) {
  return path.ends_with(".ngc") || path.ends_with(".nc") || path.ends_with(".gcode");
}

/// G-code commands positions and cannot command forces.
void check_gcode(const ExciteCommand& o) {
  if (o.gcode.empty() && !is_gcode(o.output)) return;
  const bool force = o.what.method == ExcitationMethod::kPulses || o.what.method == ExcitationMethod::kRamp;
  if (force) {
    refuse_option(
        o.gcode.empty() ? "--output" : "--gcode",
        fmt::format(
            "G-code cannot ask for forces, which --method {} needs (write a CSV, or choose a method that "
            "moves positions)",
            enum_name(o.what.method)));
  }
}

int excite(const ExciteCommand& o) {
  check_excitation(o.what);
  check_gcode(o);
  check_distinct({o.machine, o.what.known}, {o.output, o.gcode, o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);
  io::check_writable(o.output);
  io::check_writable(o.gcode);
  const AxisExcitation axis = excite_axis(o.what, o.machine, o.axis);
  const ident::excitation::Excitation& e = axis.excitation;
  for (const std::string& path : {is_gcode(o.output) ? o.output : std::string(), o.gcode}) {
    if (path.empty()) continue;
    const auto unit =
        axis.rotary ? ident::excitation::GcodeUnit::kDegree : ident::excitation::GcodeUnit::kMillimetre;
    io::write_atomically(
        path,
        with_notes(ident::excitation::as_gcode(e, o.axis, io::one_line(axis.machine), unit), axis.notes));
  }
  if (!is_gcode(o.output)) io::write_csv(o.output, axis.log);
  const report::Made made = made_from({o.machine, o.what.known});
  report_log(o.common, made, axis.log,
             fmt::format("Excitation of axis {}: {}", o.axis, enum_name(o.what.method)), e.says);
  write_json(o.common.json, to_json(axis), made);
  say(o.common, fmt::format("{}\nSafety: it {}.\nReference in {} ({} rows).\n", e.says,
                            fmt::join(axis.notes, "; "), o.output, e.t.size()));
  if (!o.gcode.empty()) say(o.common, fmt::format("G-code in {}.\n", o.gcode));
  return 0;
}

}  // namespace

void add_excite(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "excite", "Design a motion or force whose log determines friction and mass of an axis");
  auto o = std::make_shared<ExciteCommand>();
  verb->add_option("machine", o->machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option(
          "--method", o->method,
          "In open loop (force): pulses, ramp (break-away). In closed loop (position): jog, sine, "
          "position-sine (periodic terms of the screw), constant-acceleration (mass), multisine (frequency response)")
      ->required()
      ->check(one_of(words_of<ExcitationMethod>()));
  verb->add_option("--axis", o->axis, "Axis of the machine")->required()->type_name("NAME");
  verb->add_option(
          "-o,--output", o->output,
          "CSV to write, with the columns t, r or t, u, f; G-code if the name ends in .ngc, .nc or .gcode")
      ->required()
      ->type_name("REF.csv");
  verb->add_option("--gcode", o->gcode, "G-code of the same motion (positions only)")->type_name("REF.ngc");
  verb->add_option(
          "--periods", o->what.periods,
          fmt::format(
              "Number of periods: sine (left out: {}), position-sine (left out: 4), or multisine, of each stroke (left out: 4, the first one is for settling)",
              kSinePeriods))
      ->check(whole_from(1, 1000));
  verb->add_option(
          "--repeats", o->what.repeats,
          "Number of repeats in each direction: ramp (left out: 4), constant-acceleration (left out: 5) or multisine (left out: 4)")
      ->check(whole_from(1, 1000));
  verb->add_option(
          "--speeds", o->what.speeds,
          "Speeds of jog, e.g. \"0.1 mm/s\" \"2 mm/s\"; left out: those of the thesis up to the axis's limit. Of multisine one, that of its strokes; left out: 0.4 of the limit, or less")
      ->type_name("SPEED");
  verb->add_option("--period", o->what.period,
                   "Period of multisine; its first line has two turns in it (left out: 2 s)")
      ->type_name("TIME");
  verb->add_option(
          "--highest", o->what.highest,
          "Highest frequency of multisine (left out: 0.8 of half the sampling frequency, at most 400 Hz)")
      ->type_name("FREQUENCY");
  verb->add_option("--lead", o->what.lead,
                   "Lead of the screw: the travel of each jog is then a whole number of turns")
      ->type_name("LENGTH");
  verb->add_option(
          "--rise", o->what.rise,
          "Time in which ramp reaches the rough friction (left out: as the limits allow, up to 15 s)")
      ->type_name("TIME");
  verb->add_option("--known", o->what.known,
                   "Axis file of an earlier identification: pulses then cover all speeds of the axis, "
                   "ramps end at its friction")
      ->type_name("AXIS.toml");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Example:\n  stribeck excite machines/biaxial-table.toml --method sine --axis x -o x-sine.csv");
  verb->callback([o, &action] {
    o->what.method = *enum_value<ExcitationMethod>(o->method);
    action = [o] { return excite(*o); };
  });
}

}  // namespace stribeck::cli
