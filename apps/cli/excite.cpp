#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string_view>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <apps/cli/trace_page.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/path/five_axis.hpp>
#include <stribeck/targets/linuxcnc/hal_axis.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/excitation.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/plan/excitation_plan.hpp>
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
  std::vector<std::string> wanted;
  std::optional<double> minutes;  ///< absent: kMinutes
};

constexpr double kMinutes = 5.0;

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

/// How G-code counts an axis.
struct GcodeCount {
  ident::excitation::GcodeUnit unit = ident::excitation::GcodeUnit::kMillimetre;
  double radius = 1.0;  ///< of the arc that stands for an angle in the machine file [m]
  std::string note;     ///< empty: nothing to say
};

/// A, B and C are counted in degrees, also where the machine file does not call them rotary.
GcodeCount count_of(const AxisExcitation& axis) {
  using ident::excitation::GcodeUnit;
  if (axis.rotary) return {GcodeUnit::kDegree, 1.0, {}};
  const std::string word = ident::excitation::gcode_word(axis.axis);
  if (!targets::linuxcnc::counts_degrees(std::string_view(word).substr(0, 1))) return {};
  const double radius = path::TiltingTable{}.radius;
  return {
      GcodeUnit::kDegree, radius,
      fmt::format(
          "axis {} has no rotary = true in the machine file, but controls count {} in degrees: one degree is {:.4g} mm of the file, an arc "
          "at a radius of {:g} mm; rename the axis if it is linear",
          axis.axis, word.front(), 1e3 * radius * kPi / 180.0, 1e3 * radius)};
}

/// Chooses the logs by what is wanted, and writes the reference of each into the folder.
int plan(const ExciteCommand& o) {
  std::vector<std::string> given = given_method_options(o.what);
  std::erase(given, "--known");  // --for knows what to do with it
  for (const auto& [option, is_given] :
       {std::pair("--gcode", !o.gcode.empty()), std::pair("--report", !o.common.report.empty()),
        std::pair("--plots", !o.common.plots.empty())}) {
    if (is_given) given.emplace_back(option);
  }
  if (!given.empty())
    refuse_option(given.front(), "does not go with --for, which designs several logs (use --method)");
  check_distinct({o.machine, o.what.known}, {o.output, o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);  // the JSON file
  PlanOptions options{o.machine, o.axis, {}, 60.0 * o.minutes.value_or(kMinutes), o.what.known};
  for (const std::string& word : o.wanted) options.wanted.push_back(*enum_value<Wanted>(word));
  const OutputFolder folder(o.output);
  const ExcitationPlan plan = [&] {
    Progress progress("logs tried", o.common.quiet);
    return plan_excitation(options, [&](std::size_t done, std::size_t all) { progress(done, all); });
  }();
  std::string files;
  for (const std::size_t i : plan.chosen) {
    ExcitationOptions what;
    what.method = plan.candidates[i].method;
    if (what.method == ExcitationMethod::kPulses) what.known = o.what.known;
    const std::string file = fmt::format("{}/{}-{}.csv", o.output, o.axis, enum_name(what.method));
    const AxisExcitation axis = excite_axis(what, o.machine, o.axis);
    io::write_csv(file, axis.log);
    files += fmt::format("{}: it {}.\n", file, fmt::join(axis.notes, "; "));
  }
  write_json(o.common.json, to_json(plan), made_from({o.machine, o.what.known}));
  say(o.common, text_of(plan) + files);
  return 0;
}

int excite(const ExciteCommand& o) {
  if (!o.wanted.empty()) return plan(o);
  if (o.minutes) refuse_option("--minutes", "goes with --for, which chooses the logs (leave it out)");
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
    if (const std::string why = ident::excitation::why_no_gcode(o.axis); !why.empty())
      refuse_option(o.gcode.empty() ? "--output" : "--gcode", why);
    const GcodeCount count = count_of(axis);
    std::vector<std::string> notes = axis.notes;
    if (!count.note.empty()) notes.push_back(count.note);
    io::write_atomically(path, with_notes(ident::excitation::as_gcode(e, o.axis, io::one_line(axis.machine),
                                                                      count.unit, count.radius),
                                          notes));
    if (!count.note.empty()) say(o.common, fmt::format("G-code: {}.\n", count.note));
  }
  if (!is_gcode(o.output)) io::write_csv(o.output, axis.log);
  const report::Made made = made_from({o.machine, o.what.known});
  report_log(o.common, made, axis.log,
             fmt::format("Excitation of axis {}: {}", o.axis, enum_name(o.what.method)),
             fmt::format("{} Safety: it {}.", e.says, fmt::join(axis.notes, "; ")));
  write_json(o.common.json, to_json(axis), made);
  say(o.common, fmt::format("{}\nSafety: it {}.\nReference in {} ({} rows).\n", e.says,
                            fmt::join(axis.notes, "; "), o.output, e.t.size()));
  if (!o.gcode.empty()) say(o.common, fmt::format("G-code in {}.\n", o.gcode));
  if (axis.of_lathe && (!o.gcode.empty() || is_gcode(o.output)))
    say(o.common,
        "A lathe may count X in diameter, the G-code counts the travel: switch diameter programming off before (SINUMERIK DIAMOF, LinuxCNC "
        "G8). A log in diameter is read with --map x=\"COLUMN 0.5 mm\".\n");
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
      ->check(one_of(words_of<ExcitationMethod>()));
  verb->add_option("--axis", o->axis, "Axis of the machine")->required()->type_name("NAME");
  verb->add_option(
          "-o,--output", o->output,
          "CSV to write, with the columns t, r or t, u, f; G-code if the name ends in .ngc, .nc or .gcode; with --for a folder")
      ->required()
      ->type_name("REF.csv|DIR");
  verb->add_option(
          "--for", o->wanted,
          "In place of --method: what is wanted of the axis (mass, friction, bristles, delay). The methods are tried on a virtual axis, and those that tell it are written")
      ->delimiter(',')
      ->check(one_of(words_of<Wanted>()));
  verb->add_option("--minutes", o->minutes,
                   fmt::format("With --for: longest time of all logs together (left out: {:g})", kMinutes))
      ->check(number_from(0.1, 1000));
  verb->add_option(
          "--gcode", o->gcode,
          "G-code of the same motion (positions only): for an axis letter in LinuxCNC's dialect, for a name as X1 in SINUMERIK's")
      ->type_name("REF.ngc");
  verb->add_option(
          "--periods", o->what.periods,
          fmt::format(
              "Number of periods: sine (left out: {}), position-sine (left out: 4), or multisine, of each stroke (left out: 4, the first one is for settling)",
              kSinePeriods))
      ->check(whole_from(1, 1000));
  verb->add_option(
          "--strokes", o->what.strokes,
          fmt::format("Speeds of the strokes that follow a sine, out and back through the travel: they "
                      "tell a force that belongs to the place from friction over speed (left out: "
                      "{}; 0: the sine alone, as in the thesis)",
                      kStrokeSpeeds))
      ->check(whole_from(0, 10));
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
      "Examples:\n  stribeck excite machines/biaxial-table.toml --method sine --axis x -o x-sine.csv\n"
      "  stribeck excite machines/biaxial-table.toml --for mass,friction,bristles --minutes 5 --axis x -o logs");
  verb->callback([o, &action] {
    if (o->method.empty() == o->wanted.empty())
      refuse_option("--method",
                    "expected either --method, or --for with what is wanted (--for mass,friction)");
    if (!o->method.empty()) o->what.method = *enum_value<ExcitationMethod>(o->method);
    action = [o] { return excite(*o); };
  });
}

}  // namespace stribeck::cli
