#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

#include <stribeck/core/number_text.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/commissioning/parts.hpp>

namespace stribeck::workflow::commissioning {
namespace {

/// Of lengths and speeds that are compared: INI files have rounded numbers.
constexpr double kRounding = 1e-6;
constexpr std::size_t kDepth = 20000;  ///< of a sampler that is loaded here

std::optional<double> number_of_ini(RunningMachine& machine, const std::string& section,
                                    const std::string& key) {
  const std::vector<std::string> found = machine.ini(section, key);
  if (found.empty()) return std::nullopt;
  const double value = number_in(found.front());
  if (!std::isfinite(value))
    throw Stopped(
        fmt::format("[{}]{} of the INI file: got {}, expected a number", section, key, found.front()));
  return value;
}

/// Letters of the joints of trivkins, in their order.
std::string coordinates_of(RunningMachine& machine) {
  const std::vector<std::string> kinematics = machine.ini("KINS", "KINEMATICS");
  if (kinematics.empty() || !kinematics.front().starts_with("trivkins"))
    throw Stopped(
        "[KINS]KINEMATICS: expected trivkins (each joint is one axis; other kinematics are commissioned from logs: "
        "stribeck commission --logs)");
  const std::string& text = kinematics.front();
  const std::size_t at = text.find("coordinates=");
  std::string letters;
  if (at == std::string::npos) {
    letters = "XYZABCUVW";
  } else {
    for (const char c : text.substr(at + 12)) {
      if (std::isalpha(static_cast<unsigned char>(c)) == 0) break;
      letters += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
  }
  return letters;
}

std::string signal_of(RunningMachine& machine, const std::string& pin) {
  for (const HalItem& p : machine.pins(pin)) {
    if (p.name == pin) return p.signal;
  }
  return {};
}

bool has_pin(RunningMachine& machine, const std::string& pin) { return !machine.pins(pin).empty(); }

/// The controller that gets the position command of the joint.
void find_controller(RunningMachine& machine, RunningAxis& axis) {
  const std::string joint = fmt::format("joint.{}.", axis.joint);
  axis.command_signal = signal_of(machine, joint + "motor-pos-cmd");
  axis.encoder_signal = signal_of(machine, joint + "motor-pos-fb");
  for (const HalItem& p : machine.pins("*.pos-cmd")) {
    const std::string prefix = p.name.substr(0, p.name.size() - 8);
    if (p.signal.empty() || p.signal != axis.command_signal || !has_pin(machine, prefix + ".friction-ff"))
      continue;
    axis.controller = axis.component = prefix;
    if (!has_pin(machine, prefix + ".enable")) axis.component = prefix.substr(0, prefix.rfind('.'));
    break;
  }
  if (axis.controller.empty() || axis.encoder_signal.empty())
    throw Stopped(fmt::format(
        "axis {}: no stribeck_axis or stribeck_contour has the signal of {}motor-pos-cmd on its pos-cmd (put one in "
        "place of pid: docs/guides/linuxcnc.md; without one the way is stribeck commission --logs)",
        axis.name, joint));
}

/// Force of the drive: what the controller puts out, or what the drive reports.
void find_force(RunningMachine& machine, RunningAxis& axis) {
  axis.takes_force = !std::isfinite(value_in_hal(machine, axis.controller + ".drive-loop.mode"));
  const std::string pin = axis.controller + (axis.takes_force ? ".force" : ".force-fb");
  axis.force_signal = signal_of(machine, pin);
  if (axis.force_signal.empty()) {
    if (!axis.takes_force)
      throw Stopped(fmt::format(
          "axis {}: {} has no signal, and without the force that the drive reports nothing can be identified (connect it)",
          axis.name, pin));
    axis.force_signal = fmt::format("stribeck-{}-force", axis.name);
    machine.hal({{"net", axis.force_signal, pin}});
  }
  const double unit = value_in_hal(machine, axis.component + ".force-unit");
  if (unit > 0.0) axis.force_unit = unit;
}

/// The narrower of both, and a word where the INI file permits more than the machine file.
void narrow(RunningMachine& machine, RunningAxes& all, RunningAxis& axis) {
  const std::string joint = fmt::format("JOINT_{}", axis.joint);
  const std::string letter = fmt::format("AXIS_{}", axis.letter);
  std::vector<std::string> wider;
  const sim::AxisLimits described = axis.limits;
  const auto limit = [&](const std::string& section, const char* key, double sim::AxisLimits::*which,
                         double sign, const char* name, const char* unit) {
    const std::optional<double> given = number_of_ini(machine, section, key);
    if (!given) return;
    const double value = *given * all.unit;
    double& own = axis.limits.*which;
    if (sign * (value - described.*which) > kRounding)
      wider.push_back(fmt::format("[{}]{} is {} {}, {} of the machine file {} {}", section, key,
                                  report::significant(1e3 * value, 5), unit, name,
                                  report::significant(1e3 * described.*which, 5), unit));
    if (sign * (own - value) > 0.0) own = value;
  };
  for (const std::string& section : {joint, letter}) {
    limit(section, "MIN_LIMIT", &sim::AxisLimits::travel_min, -1.0, "travel_min", "mm");
    limit(section, "MAX_LIMIT", &sim::AxisLimits::travel_max, 1.0, "travel_max", "mm");
    limit(section, "MAX_VELOCITY", &sim::AxisLimits::speed, 1.0, "speed", "mm/s");
    limit(section, "MAX_ACCELERATION", &sim::AxisLimits::acceleration, 1.0, "acceleration", "mm/s2");
  }
  if (!wider.empty())
    throw Stopped(fmt::format(
        "axis {}: LinuxCNC permits more than the machine can do: {} (correct one of the two files)",
        axis.name, report::joined(wider, "; ")));
  if (!(axis.limits.travel_max > axis.limits.travel_min))
    throw Stopped(fmt::format("axis {}: INI file and machine file have no travel in common", axis.name));
}

void check_units(RunningMachine& machine, const RunningAxes& all, const RunningAxis& axis) {
  const double unit = value_in_hal(machine, axis.component + ".position-unit");
  if (std::abs(unit - all.unit) > kRounding * all.unit)
    throw Stopped(
        fmt::format("axis {}: {}.position-unit is {:.6g} m, expected {:.6g} m, as [TRAJ]LINEAR_UNITS says",
                    axis.name, axis.component, unit, all.unit));
}

/// What a person has to look at.
void warn(RunningMachine& machine, RunningAxes& all, const RunningAxis& axis) {
  if (signal_of(machine, axis.component + ".faulted").empty())
    all.warnings.push_back(fmt::format(
        "axis {}: {}.faulted is not connected to joint.{}.amp-fault-in: LinuxCNC does not stop when the controller stops",
        axis.name, axis.component, axis.joint));
  if ((axis.rough.load_force() != 0.0 || axis.rough.load_spread() != 0.0) &&
      signal_of(machine, axis.component + ".brake").empty())
    all.warnings.push_back(fmt::format(
        "axis {}: it has a load, and {}.brake is not connected: without another brake it falls when the machine is off",
        axis.name, axis.component));
  const std::optional<double> ferror = number_of_ini(machine, fmt::format("JOINT_{}", axis.joint), "FERROR");
  const double own = value_in_hal(machine, axis.controller + ".ferror-limit");
  if (ferror && *ferror < own)
    all.warnings.push_back(fmt::format(
        "axis {}: [JOINT_{}]FERROR is {:.6g}, below {}.ferror-limit {:.6g}: LinuxCNC stops before the controller does",
        axis.name, axis.joint, *ferror, axis.controller, own));
}

/// Signals of the pins of every sampler, by its number.
std::map<int, std::vector<std::string>> samplers(RunningMachine& machine) {
  std::map<int, std::vector<std::string>> out;
  for (const HalItem& p : machine.pins("sampler.*")) {
    int number = 0;
    int pin = 0;
    if (std::sscanf(p.name.c_str(), "sampler.%d.pin.%d", &number, &pin) != 2)
      continue;  // NOLINT(cert-err34-c)
    std::vector<std::string>& columns = out[number];
    if (columns.size() <= static_cast<std::size_t>(pin)) columns.resize(static_cast<std::size_t>(pin) + 1);
    columns[static_cast<std::size_t>(pin)] = p.signal;
  }
  return out;
}

/// Loads a sampler behind the last controller: force and encoder of one row belong to the same period.
void load_sampler(RunningMachine& machine, const RunningAxes& all, const std::vector<std::string>& signals) {
  const std::vector<std::string> order = machine.functions();
  std::size_t place = 0;
  for (const RunningAxis& a : all.axes) {
    const auto at = std::find(order.begin(), order.end(), a.component);
    if (at == order.end())
      throw Stopped(fmt::format("axis {}: {} does not run in the servo thread", a.name, a.component));
    place = std::max(place, static_cast<std::size_t>(at - order.begin()) + 1);
  }
  std::vector<std::vector<std::string>> commands{
      {"loadrt", "sampler", fmt::format("depth={}", kDepth), "cfg=" + std::string(signals.size(), 'f')},
      {"setp", "sampler.0.enable", "0"}};
  for (std::size_t i = 0; i < signals.size(); ++i)
    commands.push_back({"net", signals[i], fmt::format("sampler.0.pin.{}", i)});
  commands.push_back({"addf", "sampler.0", "servo-thread", fmt::format("{}", place + 1)});
  machine.hal(commands);
}

void find_sampler(RunningMachine& machine, RunningAxes& all) {
  std::vector<std::string> needed;
  for (const RunningAxis& a : all.axes)
    needed.insert(needed.end(), {a.command_signal, a.encoder_signal, a.force_signal});
  std::map<int, std::vector<std::string>> there = samplers(machine);
  if (there.empty()) {
    load_sampler(machine, all, needed);
    there = samplers(machine);
  }
  std::string lacks;
  for (const auto& one : there) {
    const std::vector<std::string>& columns = one.second;
    const auto missing = std::find_if(needed.begin(), needed.end(), [&](const std::string& s) {
      return std::find(columns.begin(), columns.end(), s) == columns.end();
    });
    if (missing == needed.end()) {
      all.sampler = one.first;
      all.columns = columns;
      return;
    }
    lacks = *missing;
  }
  throw Stopped(fmt::format(
      "no sampler of this configuration has all signals, {} is missing (add it to the sampler, or leave out its loadrt: "
      "this command then loads one)",
      lacks));
}

}  // namespace

const RunningAxis& RunningAxes::axis(const std::string& name) const {
  return *std::find_if(axes.begin(), axes.end(), [&](const RunningAxis& a) { return a.name == name; });
}

std::size_t RunningAxes::column(const std::string& signal) const {
  return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), signal) - columns.begin());
}

RunningAxes find_axes(RunningMachine& machine, const MachineDescription& description,
                      const std::string& only) {
  RunningAxes all;
  const MachineState state = machine.state();
  if (!(state.units_per_mm > 0.0)) throw Stopped("[TRAJ]LINEAR_UNITS is missing");
  all.unit = 1e-3 / state.units_per_mm;
  const std::string letters = coordinates_of(machine);
  const std::optional<double> period = number_of_ini(machine, "EMCMOT", "SERVO_PERIOD");
  if (!period) throw Stopped("[EMCMOT]SERVO_PERIOD is missing (write it in nanoseconds, e.g. 1000000)");
  all.period = 1e-9 * *period;
  if (std::abs(all.period - description.sample_time) > 1e-3 * description.sample_time)
    throw Stopped(fmt::format(
        "[EMCMOT]SERVO_PERIOD is {:.6g} ms, sample_time of the machine file {:.6g} ms (correct one of the two files)",
        1e3 * all.period, 1e3 * description.sample_time));
  for (const auto& [name, described] : description.axes) {
    if (!only.empty() && name != only) continue;
    RunningAxis axis;
    axis.name = name;
    axis.letter = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
    const std::size_t joint = letters.find(axis.letter);
    if (name.size() != 1 || described.rotary ||
        std::string_view("XYZUVW").find(axis.letter) == std::string::npos || joint == std::string::npos ||
        joint >= state.joints.size() || letters.find(axis.letter, joint + 1) != std::string::npos)
      throw Stopped(fmt::format(
          "axis {}: expected a linear axis X, Y, Z, U, V or W with one joint of LinuxCNC, whose joints are {} (--axis chooses "
          "one axis; others are commissioned from logs: stribeck commission --logs)",
          name, letters.substr(0, state.joints.size())));
    axis.joint = static_cast<int>(joint);
    axis.limits = described.limits;
    axis.rough = described.commissioning;
    axis.force_limit = described.force_limit();
    if (!(axis.force_limit > 0.0))
      throw Stopped(fmt::format(
          "axis {}: the largest force of its drive is not known (write limits.force into the machine file)",
          name));
    axis.resolution = described.name_plate().encoder_resolution;
    find_controller(machine, axis);
    find_force(machine, axis);
    check_units(machine, all, axis);
    narrow(machine, all, axis);
    warn(machine, all, axis);
    all.axes.push_back(std::move(axis));
  }
  if (all.axes.empty())
    throw Stopped(fmt::format("--axis: the machine file has no axis {}", io::printable(only)));
  find_sampler(machine, all);
  return all;
}

}  // namespace stribeck::workflow::commissioning
