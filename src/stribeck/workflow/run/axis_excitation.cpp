#include <array>
#include <nlohmann/json.hpp>
#include <optional>

#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>
#include <stribeck/workflow/run/axis_excitation.hpp>

namespace stribeck::workflow {
namespace {

/// Of safety_notes(), in their order; the last one is not there in open loop.
constexpr std::array<const char*, 5> kNoteNames{"start", "direction", "room", "abort", "coordinates"};

/// Column for drives that take percent of their rated torque or force (CiA 402: per mille, ten times the number).
void add_percent(io::Log& log, const AxisDescription& axis, const std::vector<double>& force) {
  const std::optional<double> rated = axis.drive ? axis.drive->rated() : std::nullopt;
  if (!rated || force.empty()) return;
  io::Column column{"percent", "%", {}};
  for (const double f : force) column.values.push_back(100.0 * f / *rated);
  log.columns.push_back(std::move(column));
}

/// Lengths as angles, forces as torques.
void show_as_rotary(io::Log& log) {
  for (io::Column& c : log.columns) {
    if (c.unit_text == "N") c.unit_text = kRotaryUnits.force;
    if (c.unit_text != kLinearUnits.travel) continue;
    c.unit_text = kRotaryUnits.travel;
    for (double& x : c.values) x *= kRotaryUnits.per_metre / kLinearUnits.per_metre;
  }
}

bool may_be_lathe(const MachineDescription& machine) {
  std::string letters;
  for (const auto& [name, axis] : machine.axes) {
    if (!axis.rotary) letters += ident::excitation::gcode_word(name).substr(0, 1);
  }
  return letters.find('X') != std::string::npos && letters.find('Z') != std::string::npos &&
         letters.find('Y') == std::string::npos;
}

}  // namespace

AxisExcitation excite_axis(const ExcitationOptions& options, const std::string& machine_file,
                           const std::string& axis) {
  const MachineDescription machine = read_description(machine_file);
  const std::size_t index = axis_index(as_machine(machine), machine_file, axis);
  require_force_limit(machine, machine_file, index);
  ident::excitation::SafeExcitation safe = make_excitation(options, machine, index);
  AxisExcitation out{machine.name, axis, options.method, {}, safety_notes(safe, machine, index), {}};
  out.of_lathe = may_be_lathe(machine) && ident::excitation::gcode_word(axis).starts_with('X');
  const ident::excitation::Excitation& e = safe.excitation;
  sim::Recording table;
  table.t = e.t;
  table.r = e.r;
  table.f = e.force;
  if (const double gain = machine.axes[index].second.force_per_volt(); gain > 0.0) {
    for (const double f : e.force) table.u.push_back(f / gain);
  }
  out.log = as_log(table);
  if (machine.axes[index].second.rotary) show_as_rotary(out.log);
  add_percent(out.log, machine.axes[index].second, e.force);
  out.log.metadata = {
      {"machine", machine.name}, {"axis", axis}, {"method", std::string(enum_name(options.method))}};
  if (machine.axes[index].second.rotary && !e.force.empty())
    out.log.metadata.emplace_back("f", "torque at the table; that of the motor is less by the gear");
  for (std::size_t i = 0; i < out.notes.size(); ++i)
    out.log.metadata.emplace_back(kNoteNames.at(i), out.notes[i]);
  out.excitation = std::move(safe.excitation);
  out.rotary = machine.axes[index].second.rotary;
  return out;
}

nlohmann::ordered_json to_json(const AxisExcitation& e) {
  return {{"schema", "stribeck.excite/1"},
          {"machine", e.machine},
          {"axis", e.axis},
          {"method", enum_name(e.method)},
          {"rows", e.excitation.t.size()},
          {"duration_s", e.excitation.t.back()},
          {"says", e.excitation.says},
          {"safety", e.notes}};
}

}  // namespace stribeck::workflow
