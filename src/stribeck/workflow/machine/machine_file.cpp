#include <fmt/format.h>

#include <stribeck/io/error.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>

namespace stribeck::workflow {

MachineDescription read_description(const std::string& file) {
  return io::read_toml<MachineDescription>(file);
}

sim::Machine read_virtual_machine(const std::string& file) {
  const MachineDescription machine = read_description(file);
  for (const auto& [name, axis] : machine.axes) {
    if (axis.plant) continue;
    throw io::InputError(
        {file, 0, fmt::format("axes.{}.plant", name),
         "missing, expected the truth of a virtual axis (mass, drive, converter, encoder, friction with bristles), "
         "as this simulates the machine (machine, excite, identify, verify and export of axis files do without)"});
  }
  return as_machine(machine);
}

void require_force_limit(const MachineDescription& machine, const std::string& file, std::size_t axis) {
  const auto& [name, a] = machine.axes[axis];
  if (a.force_limit() > 0.0) return;
  throw io::InputError(
      {file, 0, fmt::format("axes.{}.limits.force", name),
       "missing, expected the largest force of the drive (write force = \"500 N\", with your "
       "value, or [axes." +
           name + ".drive] with rated_torque, peak_torque and lead)"});
}

}  // namespace stribeck::workflow
