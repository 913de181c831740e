#include <fmt/format.h>

#include <algorithm>
#include <stribeck/sim/study/loop_margins.hpp>
#include <stribeck/targets/linuxcnc/loop_warnings.hpp>

namespace stribeck::targets::linuxcnc {

namespace {

bool unstable_with(const plant::AxialMode& mode, const HalAxis& a, const Configuration& c) {
  control::Setup<1> setup;
  setup.period = c.sample_time;
  setup.compensation[0].model.mass = a.model.mass;
  setup.compensation[0].model.delay = std::min(a.model.delay_or_none(), control::kMostDelay * c.sample_time);
  return !sim::loop_margins<1>(control::ContouringParams::critical(c.omega, c.omega), setup, {mode}).stable;
}

}  // namespace

std::vector<std::string> loop_warnings(const Configuration& c) {
  std::vector<std::string> all;
  for (const HalAxis& a : c.axes) {
    const auto& mode = a.machine->plant.axial_mode;
    if (mode && unstable_with(*mode, a, c))
      all.push_back(fmt::format(
          "{}: a loop of {:.6g} rad/s is unstable with the axial mode of {:.6g} Hz that the machine "
          "file has (lower --omega)",
          a.letter, c.omega, mode->frequency));
    const double level = a.model.friction.parts(0.0, 0.0).level;
    const double moved = 2.0 * level / (a.model.mass * c.omega * c.omega);
    if (moved > a.machine->limits.speed / c.omega)
      all.push_back(fmt::format(
          "{}: at a reversal of friction a loop of {:.6g} rad/s leaves its command by up to {:.2g} {}; supervision of "
          "the following error allows for it (raise --omega)",
          a.letter, c.omega, in_units(a, moved), unit_name(a)));
  }
  return all;
}

}  // namespace stribeck::targets::linuxcnc
