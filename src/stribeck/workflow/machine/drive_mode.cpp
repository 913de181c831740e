#include <stribeck/workflow/machine/drive_mode.hpp>

namespace stribeck::workflow {
namespace {

constexpr std::string_view kWithOffset = "-offset";

plant::DriveLoop usual_loop(const plant::AxisParams& axis, friction::DriveMode mode, bool offset) {
  plant::DriveLoop d;
  d.loop.mode = mode;
  d.loop.gain = axis.total_mass() * 2.0 * kPi * 200.0;
  d.loop.integral_time = 10e-3;
  if (mode == friction::DriveMode::kPosition) {
    d.loop.position_gain = 60.0;
    d.loop.velocity_feedforward = 1.0;
    d.position_resolution = 1e-9;
  }
  d.loop.force_offset = offset;
  d.loop.force_feedback = true;
  if (offset) d.offset_resolution = 1e-3 * sim::NamePlate::of(axis).force;
  d.cycle = 250e-6;
  d.delay_cycles = 1;
  d.motor_resolution = 0.6e-9;
  return d;
}

}  // namespace

std::vector<std::string> drive_modes() {
  std::vector<std::string> all{"force"};
  for (const auto& [mode, name] : EnumNames<friction::DriveMode>::names) {
    all.emplace_back(name);
    all.push_back(std::string(name) + std::string(kWithOffset));
  }
  return all;
}

void set_drive_mode(sim::Machine& machine, std::string_view mode) {
  const bool offset = mode.ends_with(kWithOffset);
  if (offset) mode.remove_suffix(kWithOffset.size());
  const auto command = enum_value<friction::DriveMode>(mode);
  for (auto& [name, axis] : machine.axes) {
    axis.drive_loop.reset();
    axis.plant.drive_loop.reset();
    if (command) axis.plant.drive_loop = usual_loop(axis.plant, *command, offset);
  }
}

}  // namespace stribeck::workflow
