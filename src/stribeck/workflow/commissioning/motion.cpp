#include <fmt/format.h>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <stribeck/core/number_text.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/workflow/commissioning/parts.hpp>

namespace stribeck::workflow::commissioning {
namespace {

constexpr double kLook = 0.02;      // between two looks at the machine [s]
constexpr double kPatience = 60.0;  // beyond the time that a motion takes [s]
constexpr double kToBegin = 2.0;    // until a motion shows [s]
constexpr double kToSayWhy = 0.05;  // after a machine went off [s]
constexpr int kLibraryFault = 100;  // of the components, docs/guides/linuxcnc.md

std::string fault_in_words(int fault) {
  if (fault > kLibraryFault) return "its supervision has stopped it, docs/guides/faults.md";
  switch (fault) {
    case 1:
      return "its encoder is not a number";
    case 2:
      return "its command is not a number";
    case 3:
      return "its encoder jumped";
    case 4:
      return "its encoder stands while the command goes on";
    case 5:
      return "it is too far from the command";
    case 6:
      return "a parameter was refused";
    default:
      return "a fault of the controller";
  }
}

std::string fault_of_controllers(Work& work) {
  for (const RunningAxis& a : work.axes.axes) {
    for (const HalItem& p : work.machine.pins(a.controller + ".fault")) {
      const int fault = std::atoi(p.value.c_str());
      if (p.name == a.controller + ".fault" && fault != 0)
        return fmt::format("axis {}: {} (fault {} of {})", a.name, fault_in_words(fault), fault,
                           a.controller);
    }
  }
  return {};
}

}  // namespace

void Work::found(const std::string& text) {
  says.push_back(text);
  dialogue.say(text);
}

void Work::ask(const std::string& motion) const {
  dialogue.say(motion);
  if (!dialogue.agree(motion)) throw Stopped("not begun: the motion was not agreed to");
}

Trouble trouble(Work& work, const MachineState& state) {
  if (std::string fault = fault_of_controllers(work); !fault.empty()) return {std::move(fault), state.estop};
  if (!state.errors.empty()) return {"LinuxCNC says: " + state.errors.front()};
  if (!state.on) {
    // What switched it off may say why a moment later.
    work.machine.sleep(kToSayWhy);
    if (const auto late = work.machine.state().errors; !late.empty())
      return {"LinuxCNC says: " + late.front()};
    return {state.estop ? "the emergency stop was pressed" : "the machine was switched off", true};
  }
  for (const RunningAxis& a : work.axes.axes) {
    const JointState& j = state.joints.at(static_cast<std::size_t>(a.joint));
    if (j.at_limit) return {fmt::format("axis {}: a limit of joint {} is active", a.name, a.joint)};
    if (j.fault) return {fmt::format("axis {}: the amplifier of joint {} has a fault", a.name, a.joint)};
  }
  return {};
}

void stop_for(const Trouble& trouble) {
  if (trouble.by_hand) throw StoppedByHand(trouble.why);
  throw Stopped(trouble.why);
}

void refuse_offsets(Work& work) {
  if (const std::string offsets = work.machine.state().offsets; !offsets.empty())
    throw Stopped(fmt::format(
        "offsets are active ({}), and the motions are planned in machine coordinates: in G54, note the values, take them off (G10 L2 P1 with 0 for every axis that is "
        "named and R0, G92.1, G49) and repeat the stage",
        offsets));
}

void wait_for_motion(Work& work, double seconds) {
  bool begun = false;
  int still = 0;
  for (double waited = 0.0; waited < seconds + kPatience; waited += kLook) {
    const MachineState state = work.machine.state();
    if (const Trouble why = trouble(work, state); why.any()) {
      work.machine.stop();
      stop_for(why);
    }
    begun = begun || state.moving || waited > kToBegin;
    still = state.moving ? 0 : still + 1;
    if (begun && still >= 2) return;
    work.machine.sleep(kLook);
  }
  work.machine.stop();
  throw Stopped(fmt::format("a motion that takes {:.3g} s has not ended", seconds));
}

void jog(Work& work, const RunningAxis& axis, double speed, double distance) {
  const double unit = work.axes.unit;
  const auto joint = static_cast<std::size_t>(axis.joint);
  const double from = work.machine.state().joints.at(joint).command;
  work.machine.jog(axis.joint, speed / unit, distance / unit);
  const double seconds = std::abs(distance) / speed;
  for (double waited = 0.0; waited < seconds + kPatience; waited += kLook) {
    const MachineState state = work.machine.state();
    if (const Trouble why = trouble(work, state); why.any()) {
      work.machine.stop();
      stop_for(why);
    }
    const double went = state.joints.at(joint).command - from;
    if (std::abs(went * unit - distance) < 1e-3 * std::abs(distance)) return;
    work.machine.sleep(kLook);
  }
  work.machine.stop();
  throw Stopped(fmt::format("axis {}: a move of {:.3g} mm has not ended", axis.name, 1e3 * distance));
}

void run_program(Work& work, const std::string& name, const std::string& gcode, double seconds,
                 const std::string& record) {
  refuse_offsets(work);
  const std::string program = work.folder + '/' + name + ".ngc";
  io::write_atomically(program, gcode);
  if (!record.empty()) work.machine.begin_record(work.axes.sampler, record);
  work.machine.run(program);
  wait_for_motion(work, seconds);
  if (!record.empty()) work.machine.end_record();
}

double value_in_hal(RunningMachine& machine, const std::string& name) {
  for (const HalItem& p : machine.parameters(name)) {
    if (p.name == name) return number_in(p.value);
  }
  return kNaN;
}

double tighten(Work& work, ChangedValues& changed, const RunningAxis& axis, double ferror) {
  const std::string name = axis.controller + ".ferror-limit";
  const double own = value_in_hal(work.machine, name) * work.axes.unit;
  if (own <= ferror) return own;
  changed.set({{name, fmt::format("{:.9g}", ferror / work.axes.unit)}});
  return ferror;
}

void require_ready(Work& work) {
  const MachineState state = work.machine.state();
  if (!state.homed()) throw Stopped("the machine is not homed (home it, or repeat: --stage check)");
  refuse_offsets(work);
  if (state.on) return;
  work.ask(state.estop ? "Releases the emergency stop and switches the machine on."
                       : "Switches the machine on.");
  if (state.estop) work.machine.release_emergency_stop();
  work.machine.switch_on();
  work.machine.sleep(0.2);
  if (const Trouble why = trouble(work, work.machine.state()); why.any()) stop_for(why);
}

}  // namespace stribeck::workflow::commissioning
