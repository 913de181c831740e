#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <apps/cli/trace_page.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::cli {
namespace {

struct Options {
  Common common;
  std::string machine;
  std::string method;
  std::string axis;
  std::string output;
  std::string gcode;
  std::string known;
  std::string lead;
  std::string rise;
  std::vector<std::string> speeds;
  std::optional<int> periods;
  std::optional<int> repeats;
};

/// The rough idea that an axis file gives: its friction at two speeds, the larger direction.
ident::excitation::RoughDrive rough_idea(const std::string& axis_file, const sim::AxisLimits& limits) {
  const auto model = io::read_toml<friction::AxisModel>(axis_file);
  ident::Result result;
  result.mass = model.mass;
  constexpr int kPoints = 20;
  for (int i = -kPoints; i <= kPoints; ++i) {
    if (i == 0) continue;
    const double v = 0.9 * limits.speed * i / kPoints;
    const auto p = model.friction.parts(v, 0.0);
    const double f = p.level * sign(v) + p.viscous;
    result.curve.push_back({v, f, f, f});
  }
  return ident::excitation::rough_drive(result);
}

bool is_gcode(const std::string& path) {
  return path.ends_with(".ngc") || path.ends_with(".nc") || path.ends_with(".gcode");
}

/// Options of one method are refused with another, not ignored.
void check_options(const Options& o) {
  const auto only = [&](bool given, const char* option, std::initializer_list<std::string_view> methods) {
    if (!given || std::find(methods.begin(), methods.end(), o.method) != methods.end()) return;
    refuse_option(
        option, fmt::format("does not apply to --method {}, only to {}", o.method, fmt::join(methods, ", ")));
  };
  only(o.periods.has_value(), "--periods", {"sine", "position-sine"});
  only(o.repeats.has_value(), "--repeats", {"ramp", "constant-acceleration"});
  only(!o.known.empty(), "--known", {"pulses", "ramp"});
  only(!o.speeds.empty(), "--speeds", {"jog"});
  only(!o.lead.empty(), "--lead", {"jog"});
  only(!o.rise.empty(), "--rise", {"ramp"});
  if (!o.gcode.empty() || is_gcode(o.output)) {
    const bool force = o.method == "pulses" || o.method == "ramp";
    if (force) {
      refuse_option(
          o.gcode.empty() ? "--output" : "--gcode",
          fmt::format(
              "G-code cannot ask for forces, which --method {} needs (write a CSV, or choose a method that "
              "moves positions)",
              o.method));
    }
  }
}

ident::excitation::Excitation design(const Options& o, const sim::Machine& machine, std::size_t which) {
  const sim::MachineAxis& axis = machine.axes[which].second;
  const ident::excitation::Limits limits{axis.limits.travel_min, axis.limits.travel_max, axis.limits.speed,
                                         axis.limits.acceleration, axis.force_limit()};
  const double middle = 0.5 * (limits.travel_min + limits.travel_max);
  const std::optional<ident::excitation::RoughDrive> known =
      o.known.empty() ? std::nullopt : std::optional(rough_idea(o.known, axis.limits));
  if (o.method == "jog") {
    ident::excitation::JogDesign jog;
    jog.start = middle;
    jog.speeds =
        ident::excitation::jog_speeds(ident::excitation::fastest_jog(limits, machine.sample_time, jog));
    if (!o.speeds.empty()) jog.speeds.clear();
    for (const std::string& speed : o.speeds) {
      jog.speeds.push_back(option_si("--speeds", speed, quantity("m/s", "mm/s").positive()));
    }
    if (!o.lead.empty()) jog.period = option_si("--lead", o.lead, quantity("m", "mm").positive());
    return ident::excitation::design_jog(limits, machine.sample_time, jog);
  }
  if (o.method == "ramp") {
    ident::excitation::RampDesign ramp;
    ramp.start = middle;
    ramp.repeats = o.repeats.value_or(ramp.repeats);
    if (!o.rise.empty()) ramp.rise = option_si("--rise", o.rise, quantity("s", "s").positive());
    return ident::excitation::design_ramp(limits,
                                          known.value_or(ident::excitation::RoughDrive{
                                              axis.commissioning.mass, axis.commissioning.friction, 0.0}),
                                          machine.sample_time, ramp);
  }
  if (o.method == "constant-acceleration") {
    ident::excitation::AccelerationDesign triangles;
    triangles.start = middle;
    triangles.repeats = o.repeats.value_or(triangles.repeats);
    return ident::excitation::design_constant_acceleration(limits, machine.sample_time, triangles);
  }
  const int periods = o.method == "position-sine" ? kPositionPeriods : kSinePeriods;
  return cli::design(machine, which, o.method, o.periods.value_or(periods), known);
}

/// The option that sets a parameter of a design; empty: none does.
std::string option_of(const std::string& parameter) {
  if (parameter == "period") return "--lead";
  for (const char* same : {"rise", "speeds", "periods", "repeats"}) {
    if (parameter == same) return std::string("--") + same;
  }
  return {};
}

int excite(const Options& o) {
  check_options(o);
  check_distinct({o.machine, o.known}, {o.output, o.gcode, o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);
  io::check_writable(o.output);
  io::check_writable(o.gcode);
  const sim::Machine machine = load_machine(o.machine);
  const std::size_t axis = axis_index(machine, o.machine, o.axis);
  const ident::excitation::Excitation e = [&] {
    try {
      return design(o, machine, axis);
    } catch (const ident::excitation::BadDesign& bad) {
      const std::string option = option_of(bad.parameter);
      if (option.empty()) throw;
      refuse_option(option, bad.what());
    }
  }();
  for (const std::string& path : {is_gcode(o.output) ? o.output : std::string(), o.gcode}) {
    if (!path.empty()) io::write_atomically(path, ident::excitation::as_gcode(e, o.axis, machine.name));
  }
  sim::Recording table;
  table.t = e.t;
  table.r = e.r;
  table.f = e.force;
  const double gain = machine.axes[axis].second.plant.force_gain();
  for (const double f : e.force) table.u.push_back(f / gain);
  io::Log log = as_log(table);
  log.metadata = {{"machine", machine.name}, {"axis", o.axis}, {"method", o.method}};
  if (!is_gcode(o.output)) io::write_csv(o.output, log);
  report_log(o.common.report, log, fmt::format("Excitation of axis {}: {}", o.axis, o.method), e.says);
  write_json(o.common.json, {{"schema", "stribeck.excite/1"},
                             {"machine", machine.name},
                             {"axis", o.axis},
                             {"method", o.method},
                             {"rows", e.t.size()},
                             {"duration_s", e.t.back()},
                             {"says", e.says}});
  say(o.common, fmt::format("{}\nReference in {} ({} rows).\n", e.says, o.output, e.t.size()));
  if (!o.gcode.empty()) say(o.common, fmt::format("G-code in {}.\n", o.gcode));
  return 0;
}

}  // namespace

void add_excite(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "excite", "Design a motion or force whose log determines friction and mass of an axis");
  auto o = std::make_shared<Options>();
  verb->add_option("machine", o->machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option("--method", o->method,
                   "In open loop (force): pulses, ramp (break-away). In closed loop (position): jog, sine, "
                   "position-sine (periodic terms of the screw), constant-acceleration (mass)")
      ->required()
      ->check(one_of({"pulses", "ramp", "jog", "sine", "position-sine", "constant-acceleration"}));
  verb->add_option("--axis", o->axis, "Axis of the machine")->required()->type_name("NAME");
  verb->add_option(
          "-o,--output", o->output,
          "CSV to write, with the columns t, r or t, u, f; G-code if the name ends in .ngc, .nc or .gcode")
      ->required()
      ->type_name("REF.csv");
  verb->add_option("--gcode", o->gcode, "G-code of the same motion (positions only)")->type_name("REF.ngc");
  verb->add_option(
          "--periods", o->periods,
          fmt::format("Number of periods: sine (left out: {}) or position-sine (left out: 4)", kSinePeriods))
      ->check(whole_from(1, 1000));
  verb->add_option(
          "--repeats", o->repeats,
          "Number of repeats in each direction: ramp (left out: 4) or constant-acceleration (left out: 5)")
      ->check(whole_from(1, 1000));
  verb->add_option(
          "--speeds", o->speeds,
          "Speeds of jog, e.g. \"0.1 mm/s\" \"2 mm/s\"; left out: those of the thesis up to the axis's limit")
      ->type_name("SPEED");
  verb->add_option("--lead", o->lead,
                   "Lead of the screw: the travel of each jog is then a whole number of turns")
      ->type_name("LENGTH");
  verb->add_option(
          "--rise", o->rise,
          "Time in which ramp reaches the rough friction (left out: as the limits allow, up to 15 s)")
      ->type_name("TIME");
  verb->add_option("--known", o->known,
                   "Axis file of an earlier identification: pulses then cover all speeds of the axis, "
                   "ramps end at its friction")
      ->type_name("AXIS.toml");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Example:\n  stribeck excite machines/biaxial-table.toml --method sine --axis x -o x-sine.csv");
  verb->callback([o, &action] { action = [o] { return excite(*o); }; });
}

}  // namespace stribeck::cli
