#include <fmt/format.h>
#include <algorithm>

#include <stribeck/io/toml.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {

friction::AxisModel as_model(const ident::Result& result) {
  friction::AxisModel model;
  model.mass = result.mass;
  model.load = result.load;
  model.delay = result.delay;
  model.friction = result.friction;
  return model;
}

namespace {

/// How the scale of the force is given.
std::string way_to_newtons(const std::string& unit) {
  if (unit == "A")
    return "write torque_constant (and lead) below drive of the machine file, or give --gain, e.g. \"95 N/A\"";
  if (unit == "%")
    return "write rated_torque below drive of the machine file, or give --gain, e.g. \"12 N/%\"";
  if (unit == "V") return "give --gain, e.g. \"1048 N/V\"";
  if (unit == "N m")
    return "say how far the axis goes in one turn of the motor with --lead, e.g. \"10 mm\" (a screw behind a gear: the lead over the "
           "ratio), or give the machine file, which knows it";
  return "say what the force is with --map, e.g. percent=\"COLUMN %\" or torque=\"COLUMN N m\", or give --gain";
}

}  // namespace

void require_axis_file_units(const std::string& force_unit, const std::string& position_unit) {
  if (force_unit == "N" && position_unit == "m") return;
  refuse_option(
      "--output",
      fmt::format(
          "an axis file holds newtons and metres, but this log is in {} and {}; {}{}",
          force_unit == "units" ? "a force without a unit" : force_unit, position_unit,
          way_to_newtons(force_unit),
          position_unit == "m"
              ? ""
              : " and --lead (for a rotary axis an angle, --lead \"360 deg\" where the motor turns the table directly)"));
}

friction::AxisModel axis_file_model(const Identification& found, const AxisRecords& axis) {
  const ident::Result& result = found.result;
  require_axis_file_units(result.force_unit, result.position_unit);
  if (found.holding_only && !result.friction.eccentric.empty()) {
    refuse_option("--output",
                  "an axis file needs mass and friction, which a log at standstill does not determine");
  }
  if (axis.one_direction) {
    refuse_option(
        "--output",
        "an axis file holds friction of both directions, but the axis moves in one only; add the motion back");
  }
  if (!(result.mass > 0.0)) {
    std::string warnings;
    for (const std::string& warning : result.warnings) warnings += (warnings.empty() ? "" : "; ") + warning;
    if (!warnings.empty()) warnings = " (warnings of this log: " + warnings + ")";
    refuse_option("--output",
                  "an axis file needs the mass, which this log does not determine; give --mass or add a log "
                  "with acceleration" +
                      warnings);
  }
  return as_model(result);
}

std::optional<control::LostMotionParams> lost_motion_of(const ident::lost_motion::LostMotion& found,
                                                        double mass) {
  if (found.none || !found.total || !(found.total->low() > 0.0)) return {};
  control::LostMotionParams p;
  if (found.backlash_slope) p.backlash_slope = found.backlash_slope->value;
  if (!found.stiffness || !(found.table_friction > 0.0)) {
    p.backlash = found.total->value;
    return p;
  }
  if (found.backlash) p.backlash = found.backlash->value;
  p.stiffness = found.stiffness->value;
  // A backlash that is not determined is a part of the wind-up.
  p.table_friction =
      found.backlash ? found.table_friction : 0.5 * found.stiffness->value * found.total->value;
  if (found.motor_mass > 0.0) p.table_mass = std::max(0.0, mass - found.motor_mass);
  if (found.build_up > 0.0) p.build_up = found.build_up;
  return p;
}

sim::AxisFile axis_file(const Identification& found, const AxisRecords& axis, const OfMachineFile& known) {
  sim::AxisFile file;
  file.model = axis_file_model(found, axis);
  file.model.drive_loop = known.drive_loop;
  file.drive = known.drive;
  file.control_period = known.control_period;
  if (!axis.axis.empty()) file.axis = axis.axis;
  if (axis.rotary) file.rotary = true;
  // A map by direction has its range itself.
  const std::array<double, 2>& range = found.result.velocity_range;
  if (!file.model.friction.identified_range() && range[0] < 0.0 && range[1] > 0.0)
    file.velocity_range = range;
  file.uncertainty = found.result.open;
  if (found.lost_motion) file.lost_motion = lost_motion_of(*found.lost_motion, file.model.mass);
  return file;
}

std::string why_unreadable(const std::string& axis_file) {
  try {
    static_cast<void>(io::read_toml_text<sim::AxisFile>(axis_file, ""));
    return {};
  } catch (const io::InputError& e) {
    const io::Problem& p = e.problems().front();
    return p.key.empty() ? p.message : p.key + ": " + p.message;
  }
}

std::string axis_file_text(const Identification& found, const AxisRecords& axis, std::string_view version,
                           const OfMachineFile& known) {
  std::string text = io::write_toml(
      axis_file(found, axis, known),
      fmt::format("{}{}, identified from {} by stribeck {} ({}).{}",
                  axis.axis.empty() ? "" : "Axis " + axis.axis + ": ", found.result.model, axis.sources,
                  version, ident::name_of(found.result.method),
                  axis.rotary ? "\nThe axis turns: N stands for N m, kg for kg m2, mm for mrad." : ""));
  if (const std::string why = why_unreadable(text); !why.empty())
    refuse_option(
        "--output",
        fmt::format("the model that was found is not physical, so no axis file was written: {} (look "
                    "at the residual in the page of --report: rows that are no motion of this axis, or "
                    "too little motion in one direction)",
                    why));
  return text;
}

}  // namespace stribeck::workflow
