#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include <stribeck/report/text.hpp>
#include <stribeck/workflow/commissioning/parts.hpp>
#include <stribeck/workflow/commissioning/sign.hpp>

namespace stribeck::workflow::commissioning {
namespace {

constexpr double kFirstMove = 0.05e-3;   // [m]
constexpr double kFirstTime = 0.2;       // of it [s]
constexpr double kSignFerror = 0.08e-3;  // the controller stops there [m]
constexpr double kWeakest = 0.25;        // first force, as a share of the least friction
constexpr double kMostOfForce = 0.5;     // of the largest force of the drive
constexpr double kSettle = 0.1;          // [s]
constexpr double kBrake = 0.3;           // until a brake holds the axis [s]
constexpr double kFell = 0.3e-3;         // an axis that is held does not move that far in a try [m]

using Values = std::vector<std::pair<std::string, std::string>>;

std::string text_of(double value) { return fmt::format("{:.9g}", value); }

/// Forces with which the sign is tried, the smallest first; a drive with a loop of its own is tried once.
std::vector<double> forces_to_try(const RunningAxis& a) {
  if (!a.takes_force) return {0.0};
  std::vector<double> out;
  const double most = std::min(1.5 * a.rough.friction.high(), kMostOfForce * a.force_limit);
  for (double f = kWeakest * a.rough.friction.low(); f < most; f *= 2.0) out.push_back(f);
  out.push_back(most);
  return out;
}

/// A small force does not hold a weight that the machine file does not know.
void refuse_unsaid_weight(const Work& work) {
  for (const RunningAxis& a : work.axes.axes) {
    const auto described = std::find_if(work.description.axes.begin(), work.description.axes.end(),
                                        [&](const auto& axis) { return axis.first == a.name; });
    if (!a.takes_force || !described->second.weight_unsaid()) continue;
    throw Stopped(fmt::format(
        "axis {}: it has a brake, as an axis with a weight has, but the machine file says no weight: with the small forces of this "
        "stage it may fall. Write axes.{}.commissioning.load (0 N where nothing pulls)",
        a.name, a.name));
  }
}

/// Where the axes are [m].
std::vector<double> places_of(Work& work) {
  const MachineState state = work.machine.state();
  std::vector<double> out;
  for (const RunningAxis& a : work.axes.axes)
    out.push_back(state.joints.at(static_cast<std::size_t>(a.joint)).position * work.axes.unit);
  return out;
}

/// An axis that a weight has moved since it was at `before`. The machine is off.
void refuse_fall(Work& work, const std::vector<double>& before) {
  work.machine.sleep(kBrake);
  const std::vector<double> now = places_of(work);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const RunningAxis& a = work.axes.axes[i];
    const double moved = now[i] - before[i];
    if (!a.takes_force || std::abs(moved) < kFell) continue;
    throw Stopped(fmt::format(
        "axis {}: it fell: it stands {} mm to {}{} of where it was before it was switched on with little more than {} N for its load. "
        "It is not tried again. Look at commissioning.load of the machine file (size and sign), and at the time the brake takes to "
        "close",
        a.name, report::significant(1e3 * std::abs(moved), 3), moved < 0.0 ? '-' : '+', a.name,
        report::significant(std::abs(a.rough.load_force()), 4)));
  }
}

/// Little force on every axis, and a little more on one: nobody knows the sign of the others either. The machine is off.
void weaken(Work& work, ChangedValues& changed, const RunningAxis& tried, double force) {
  for (const RunningAxis& a : work.axes.axes) {
    Values values{{a.controller + ".feedforward", "0"},
                  {a.controller + ".observer", "0"},
                  {a.controller + ".adaptation.enabled", "0"}};
    const double own = &a == &tried ? force : forces_to_try(a).front();
    if (a.takes_force) {
      // The loop has no force left for a load: the controller carries that of the machine file, or else its own.
      const std::string name = a.controller + ".load";
      const double known = value_in_hal(work.machine, name);
      double carried = std::abs(a.rough.load_force());
      if (a.rough.load.empty() && std::isfinite(known)) carried = std::abs(known);
      if (!a.rough.load.empty() && std::isfinite(known))
        values.emplace_back(name, text_of(a.rough.load_force()));
      values.emplace_back(a.controller + ".force-limit", text_of(carried + a.rough.load_spread() + own));
    }
    changed.set(values);
    tighten(work, changed, a, kSignFerror);
  }
}

/// An axis with a wrong sign may oscillate in its bristles, or run away, as soon as its loop is closed: faults of its supervision.
void refuse_unrest(Work& work) {
  constexpr int kWrongSign = 105;
  constexpr int kOscillation = 109;
  for (const RunningAxis& a : work.axes.axes) {
    for (const HalItem& p : work.machine.pins(a.controller + ".fault")) {
      const int fault = std::atoi(p.value.c_str());
      if (p.name != a.controller + ".fault" || (fault != kWrongSign && fault != kOscillation)) continue;
      work.machine.switch_off();
      throw Stopped(fmt::format(
          "axis {}: it oscillates or runs away in closed loop even with a small force (fault {} of {}). The sign of the force or of the "
          "encoder is wrong (change one of the two: the scale of the drive's output, or of the encoder)",
          a.name, fault, a.controller));
    }
  }
}

/// Switches on with little force, and records what moves.
void switch_on_weak(Work& work) {
  // The end of a try switches the machine off; an emergency stop is somebody's.
  if (work.machine.state().estop)
    throw StoppedByHand("the emergency stop is active (release it and repeat the stage)");
  work.machine.begin_record(work.axes.sampler, work.folder + "/on.log");
  std::string refused;
  try {
    work.machine.switch_on();
  } catch (const MachineError& e) {
    refused = e.what();
  }
  work.machine.sleep(kSettle);
  work.machine.end_record();
  refuse_unrest(work);
  if (!refused.empty()) throw MachineError(refused);
}

/// Moves one axis with little force and records it.
SignTest try_sign(Work& work, ChangedValues& changed, const RunningAxis& a, double force) {
  RunningMachine& machine = work.machine;
  machine.switch_off();
  weaken(work, changed, a, force);
  switch_on_weak(work);
  const std::string file = fmt::format("{}/sign-{}.log", work.folder, a.name);
  machine.begin_record(work.axes.sampler, file);
  machine.sleep(kSettle);
  std::string stopped;
  try {
    jog(work, a, kFirstMove / kFirstTime, kFirstMove);
    machine.sleep(kSettle);
  } catch (const StoppedByHand&) {
    machine.end_record();
    throw;
  } catch (const Stopped& e) {
    stopped = e.what();
  }
  machine.end_record();
  const auto rows = read_record(work.axes, file);
  const auto at = static_cast<std::size_t>(&a - work.axes.axes.data());
  const SignTest test = judge_sign(rows[at], a.resolution);
  if (test.sign == Sign::kNotSeen) refuse_unrest(work);
  if (stopped.empty() && test.sign == Sign::kRight) {
    try {
      jog(work, a, kFirstMove / kFirstTime, -kFirstMove);
    } catch (const StoppedByHand&) {
      throw;
    } catch (const Stopped&) {
      // It was stopped at the small force; what it has shown holds.
    }
  }
  machine.switch_off();
  static_cast<void>(machine.state());  // its messages are known
  return test;
}

io::Json find_sign(Work& work, ChangedValues& changed, const RunningAxis& a) {
  SignTest test;
  double force = 0.0;
  for (const double f : forces_to_try(a)) {
    force = f;
    const std::vector<double> before = places_of(work);
    test = try_sign(work, changed, a, f);
    refuse_fall(work, before);
    if (test.sign != Sign::kNotSeen) break;
  }
  const std::string with =
      a.takes_force ? fmt::format(" with at most {} N", report::significant(force, 3)) : "";
  if (test.sign == Sign::kWrong)
    throw Stopped(fmt::format(
        "axis {}: it moves against its command: {} um{}, {} um at the farthest. The sign of the force or of the encoder is wrong "
        "(change one of the two: the scale of the drive's output, or of the encoder)",
        a.name, report::significant(1e6 * test.moved, 3), with, report::significant(1e6 * test.farthest, 3)));
  if (test.sign == Sign::kNotSeen)
    throw Stopped(fmt::format(
        "axis {}: it did not move{} (moved {} um, expected more than {} um): look at brake, enable of the drive, emergency stop and "
        "encoder",
        a.name, with, report::significant(1e6 * test.moved, 3), report::significant(1e6 * test.needed, 3)));
  work.found(fmt::format("axis {}: force and encoder have the same sign: {} um{}, {} um at the farthest",
                         a.name, report::significant(1e6 * test.moved, 3), with,
                         report::significant(1e6 * test.farthest, 3)));
  return {{"axis", a.name},
          {"moved_um", 1e6 * test.moved},
          {"farthest_um", 1e6 * test.farthest},
          {"force_N", force}};
}

void home_all(Work& work) {
  RunningMachine& machine = work.machine;
  machine.switch_on();
  machine.sleep(kSettle);
  static_cast<void>(machine.state());  // messages of the tries before
  if (!machine.state().homed()) {
    work.ask("Homes all joints, as the INI file says.");
    machine.home();
    for (double waited = 0.0; !machine.state().homed(); waited += kSettle) {
      const MachineState state = machine.state();
      if (const Trouble why = trouble(work, state); why.any()) {
        machine.stop();
        stop_for(why);
      }
      if (waited > 600.0) throw Stopped("homing has not ended");
      machine.sleep(kSettle);
    }
  }
  for (const RunningAxis& a : work.axes.axes) {
    const double at = machine.state().joints.at(static_cast<std::size_t>(a.joint)).position * work.axes.unit;
    if (at < a.limits.travel_min || at > a.limits.travel_max)
      throw Stopped(fmt::format("axis {}: it is at {} mm, outside of its travel (move it inside by hand)",
                                a.name, report::significant(1e3 * at, 5)));
  }
}

}  // namespace

io::Json check(Work& work) {
  for (const RunningAxis& a : work.axes.axes)
    work.found(fmt::format("axis {}: joint {}, controller {}, travel {} to {} mm, up to {} mm/s and {} mm/s2",
                           a.name, a.joint, a.controller, report::significant(1e3 * a.limits.travel_min, 6),
                           report::significant(1e3 * a.limits.travel_max, 6),
                           report::significant(1e3 * a.limits.speed, 4),
                           report::significant(1e3 * a.limits.acceleration, 4)));
  for (const std::string& text : work.axes.warnings) work.found("warning: " + text);
  refuse_unsaid_weight(work);
  refuse_offsets(work);
  const bool estop = work.machine.state().estop;
  work.ask(fmt::format(
      "Keep the emergency stop within reach. {} the machine off and on and moves each axis by 0.05 mm, first with a force that "
      "is less than its friction, then with more, until the encoder shows the direction.",
      estop ? "Releases the emergency stop, switches" : "Switches"));
  if (estop) work.machine.release_emergency_stop();
  ChangedValues changed(work.machine, work.folders.path(kForAWhile));
  io::Json axes = io::Json::array();
  for (const RunningAxis& a : work.axes.axes) axes.push_back(find_sign(work, changed, a));
  changed.give_back();
  home_all(work);
  return {{"axes", axes}};
}

}  // namespace stribeck::workflow::commissioning
