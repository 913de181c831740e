#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <apps/cli/commands.hpp>
#include <apps/cli/learn.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/io/toml.hpp>

namespace stribeck::cli {
namespace {

struct Options {
  Common common;
  std::string machine;
  std::string method;
  std::string axis;
  std::string output;
  int periods = kSinePeriods;
  std::string known;
};

/// The rough idea that an axis file gives: its friction at two speeds, the larger direction.
ident::RoughDrive rough_idea(const std::string& axis_file, const sim::AxisLimits& limits) {
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
  return ident::rough_drive(result);
}

int excite(const Options& o) {
  check_distinct({o.machine, o.known}, {o.output, o.common.json});
  check_outputs(o.common);
  check_writable(o.output);
  const sim::Machine machine = load_machine(o.machine);
  const std::size_t axis = axis_index(machine, o.machine, o.axis);
  const ident::Excitation e = design(
      machine, axis, o.method, o.periods,
      o.known.empty() ? std::nullopt : std::optional(rough_idea(o.known, machine.axes[axis].second.limits)));
  sim::Recording table;
  table.t = e.t;
  table.r = e.r;
  table.f = e.force;
  const double gain = machine.axes[axis].second.plant.force_gain();
  for (const double f : e.force) table.u.push_back(f / gain);
  io::Log log = as_log(table);
  log.metadata = {{"machine", machine.name}, {"axis", o.axis}, {"method", o.method}};
  io::write_csv(o.output, log);
  report_log(o.common.report, log, fmt::format("Excitation of axis {}: {}", o.axis, o.method), e.says);
  write_json(o.common.json, {{"schema", "stribeck.excite/1"},
                             {"machine", machine.name},
                             {"axis", o.axis},
                             {"method", o.method},
                             {"rows", e.t.size()},
                             {"duration_s", e.t.back()},
                             {"says", e.says}});
  say(o.common, fmt::format("{}\nReference in {} ({} rows).\n", e.says, o.output, e.t.size()));
  return 0;
}

}  // namespace

void add_excite(CLI::App& app, Action& action) {
  auto* verb =
      app.add_subcommand("excite", "What to run on the machine so that a log of it tells friction and mass");
  auto o = std::make_shared<Options>();
  verb->add_option("machine", o->machine, "Machine file")->required()->type_name("MACHINE.toml");
  verb->add_option("--method", o->method, "pulses (force, open loop), jog or sine (position, closed loop)")
      ->required()
      ->check(CLI::IsMember({"pulses", "jog", "sine"}));
  verb->add_option("--axis", o->axis, "Axis of the machine")->required()->type_name("NAME");
  verb->add_option("-o,--output", o->output, "CSV to write: t, r or t, u, f")
      ->required()
      ->type_name("REF.csv");
  verb->add_option("--periods", o->periods, "Periods of the sine")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb->add_option("--known", o->known,
                   "Axis file of an earlier identification: pulses then cover all speeds of the axis")
      ->type_name("AXIS.toml");
  add_common(*verb, o->common);
  verb->footer(
      "Example:\n  stribeck excite machines/biaxial-table.toml --method sine --axis x -o x-sine.csv");
  verb->callback([o, &action] { action = [o] { return excite(*o); }; });
}

}  // namespace stribeck::cli
