#include <stribeck/workflow/machine/of_machine_file.hpp>

namespace stribeck::workflow {

OfMachineFile of_machine_file(const MachineDescription& machine, std::string_view axis) {
  const AxisDescription& a = machine.axis(axis);
  OfMachineFile known;
  friction::DriveNumbers numbers;
  if (a.drive) {
    numbers.rated_force = a.drive->rated();
    numbers.force_per_ampere = a.drive->per_ampere();
    if (const auto radius = a.drive->radius()) numbers.travel_per_turn = 2.0 * kPi * *radius;
    if (a.drive->motors > 1) numbers.motors = a.drive->motors;
  }
  numbers.encoder_resolution = a.commissioning.encoder_resolution;
  if (!numbers.encoder_resolution && a.drive) numbers.encoder_resolution = a.drive->resolution();
  if (numbers.any()) known.drive = numbers;
  known.drive_loop = a.drive_loop;
  if (!known.drive_loop && a.plant && a.plant->drive_loop) known.drive_loop = a.plant->drive_loop->loop;
  if (machine.sample_time > 0.0) known.control_period = machine.sample_time;
  return known;
}

}  // namespace stribeck::workflow
