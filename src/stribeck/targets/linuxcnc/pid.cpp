// --to pid: feed-forward and friction for LinuxCNC's stock pid, with stock lincurve and sum2 beside it. Nothing has to be installed.
//
// A drive that takes a velocity makes of its command v_c the force F = K·(v_c − v)·(1 + 1/(T_n·s)). For a force F its command is therefore
//
//   v_c = v + F/K − lowpass(F/K, T_n)      without an integral part  v_c = v + F/K
//
// v: commanded velocity, FF1 = 1; F = m·a + friction(v) + load; K, T_n: friction/drive_loop.hpp.
#include <fmt/format.h>
#include <cmath>

#include <stribeck/io/error.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/targets/linuxcnc/hal_axis.hpp>
#include <stribeck/targets/linuxcnc/lincurve.hpp>
#include <stribeck/targets/steady/approximation.hpp>

namespace stribeck::targets {

namespace {

/// LinuxCNC counts in mm here.
constexpr double kMillimetre = 1e-3;
/// Of the encoder's step: the manual page of pid wants slightly more than half a count.
constexpr double kDeadband = 0.55;

/// HAL lines have nine digits.
double hal_digits(double value) { return with_digits(value, 9); }

bool takes_velocity(const Axis& axis) { return axis.model.drive_loop.has_value(); }

/// Force of one unit of the command [N]: of one mm/s for a drive that takes a velocity.
double force_per_unit(const Axis& axis) {
  if (takes_velocity(axis)) return axis.model.drive_loop->gain * kMillimetre;
  return std::isnan(axis.gain) ? 1.0 : axis.gain;
}

/// What one pid and one lincurve get, in mm and in the unit of the command.
struct PidNumbers {
  double ff1 = 0.0;  ///< of friction
  double ff2 = 0.0;
  double bias = 0.0;
  double force = 1.0;  ///< of one unit [N]
  linuxcnc::Lincurve table;

  explicit PidNumbers(const Axis& axis) : force(force_per_unit(axis)) {
    if (!takes_velocity(axis)) ff1 = hal_digits(nearest_line(axis).viscous * kMillimetre / force);
    ff2 = hal_digits(axis.model.mass * kMillimetre / force);
    bias = hal_digits(axis.model.load / force);
    table = linuxcnc::best_lincurve(axis.model, axis.fastest, kMillimetre);
    for (Corner& c : table.table.corners) c.y = hal_digits(c.y / force - ff1 * c.x);
  }

  [[nodiscard]] double at(double v) const {
    return force * (ff1 * v / kMillimetre + table.table.at(v / kMillimetre));
  }
};

std::string output_unit(const Axis& axis) { return axis.unit.empty() ? "N" : axis.unit; }

std::string set_line(const std::string& pin, double value, const std::string& words) {
  return fmt::format("setp {} {:.9g}  # {}\n", pin, value, words);
}

std::string deadband_line(const Axis& axis) {
  if (std::isnan(axis.resolution))
    return fmt::format(
        "# setp pid.{}.deadband D  # mm: 0.55 of the encoder's step, against hunting between two of them; --resolution writes it\n",
        axis.name);
  return set_line(fmt::format("pid.{}.deadband", axis.name),
                  hal_digits(kDeadband * axis.resolution / kMillimetre),
                  "mm: 0.55 of the encoder's step, against hunting between two of them");
}

/// For a drive that takes a force, a torque or a current.
void write_for_force(const Axis& axis, const PidNumbers& n, Form& form) {
  const std::string unit = output_unit(axis);
  const std::string& name = axis.name;
  const std::string pid = "pid." + name + ".";
  form.text += set_line(pid + "FF0", 0.0, "over the commanded position: nothing") +
               set_line(pid + "FF1", n.ff1, fmt::format("{} per mm/s: viscous friction", unit)) +
               set_line(pid + "FF2", n.ff2,
                        fmt::format("{} per mm/s2: the mass of {} kg", unit,
                                    report::significant(axis.model.mass, 4))) +
               set_line(pid + "bias", n.bias, unit + ": the load, as a weight") + deadband_line(axis);
  form.text += fmt::format(
      "# Coulomb and Stribeck friction over the commanded velocity: x-val in mm/s, y-val in {0}; FF1 has the rest.\n{1}"
      "addf ff.{2} servo-thread\naddf sum.{2} servo-thread\n",
      unit, linuxcnc::lincurve_lines("ff." + name, n.table), name);
  form.to_do =
      "Source the file behind the addf of pid.NAME.do-pid-calcs and in front of that of the outputs; take pid.NAME.output out of the net "
      "that has it, and put sum.NAME.out there. Check first the unit of pid.NAME.output (--gain is the force of one; without it the "
      "numbers are in N) and, with half of the y-val lines, that at a constant positive velocity ff.NAME.out is positive. These numbers are "
      "for a drive that takes a force, a torque or a current. Do not give them to a drive that takes a velocity (analogue, 10 V) or a "
      "position: write drive_loop of the drive into the machine file, identify with it, and export again.";
}

/// For a drive that takes a velocity: the force through the inverse of its loop.
void write_for_velocity(const Axis& axis, const PidNumbers& n, Form& form) {
  const std::string& name = axis.name;
  const std::string pid = "pid." + name + ".";
  const auto& loop = *axis.model.drive_loop;
  constexpr double kUsualPeriod = 1e-3;
  form.text += set_line(pid + "FF0", 0.0, "over the commanded position: nothing") +
               set_line(pid + "FF1", 1.0, "the drive takes a velocity") +
               set_line(pid + "FF2", 0.0, fmt::format("the mass is in sum.{}.gain0", name)) +
               set_line(pid + "bias", 0.0, fmt::format("the load is in sum.{}.offset", name)) +
               deadband_line(axis);
  form.text += fmt::format(
      "# Friction over the commanded velocity: x-val in mm/s, y-val in mm/s, the force divided by the gain of the velocity loop, {} N s/mm.\n{}",
      report::significant(kMillimetre * loop.gain, 4), linuxcnc::lincurve_lines("ff." + name, n.table));
  form.text +=
      set_line("sum." + name + ".gain0", n.ff2,
               fmt::format("mm/s per mm/s2: the mass of {} kg", report::significant(axis.model.mass, 4))) +
      set_line("sum." + name + ".offset", n.bias, "mm/s: the load, as a weight");
  form.text += fmt::format("addf ff.{0} servo-thread\naddf sum.{0} servo-thread\n", name);
  if (loop.integral_time) {
    const double period = axis.control_period.value_or(kUsualPeriod);
    form.text += set_line(
        "lag." + name + ".gain", hal_digits(-std::expm1(-period / *loop.integral_time)),
        fmt::format("1 - exp(-T/Tn): Tn = {} ms of the drive, T = {} ms of servo-thread{}",
                    report::significant(1e3 * *loop.integral_time, 4), report::significant(1e3 * period, 4),
                    axis.control_period ? "" : " (not in the axis file: check it)"));
    form.text += fmt::format(
        "setp lead.{0}.gain1 -1  # what the integral part of the drive makes by itself\n"
        "addf lag.{0} servo-thread\naddf lead.{0} servo-thread\n",
        name);
  }
  form.text += fmt::format("addf cmd.{} servo-thread\n", name);
  form.to_do =
      "Source the file behind the addf of pid.NAME.do-pid-calcs and in front of that of the outputs; take pid.NAME.output out of the net "
      "that has it, and put cmd.NAME.out there: the command of a drive that takes a velocity, in mm/s (scale it where the output is "
      "written). Pgain of pid.NAME is then Kv in 1/s. Check first gain and integral time of the drive's velocity loop against drive_loop of "
      "the axis file and, with half of the y-val lines, that at a constant positive velocity ff.NAME.out is positive.";
}

Form pid_form(const Axis& axis) {
  if (linuxcnc::counts_degrees(axis.said))
    throw io::InputError(
        {axis.file, 0, "axis",
         fmt::format(
             "is {}, which LinuxCNC counts in degrees, and pid writes its numbers in mm (choose --to linuxcnc; if this axis is "
             "linear, give axis its name in the control)",
             axis.said)});
  if (takes_velocity(axis) && axis.model.drive_loop->mode == friction::DriveMode::kPosition)
    throw io::InputError(
        {axis.file, 0, "drive_loop.mode",
         "is position: such a drive follows the commanded position itself, and pid with FF0 = 1 has no place for friction (choose --to linuxcnc, "
         "whose controller moves the commanded position, or --to cia402 for the torque offset of the drive)"});
  if (takes_velocity(axis) && !std::isnan(axis.gain))
    throw io::InputError(
        {{},
         0,
         "--gain",
         fmt::format("does not apply to axis {}: by {} its drive takes a velocity, which is written in mm/s",
                     axis.name, axis.file)});
  const PidNumbers n(axis);
  Form form;
  form.mass = form.load = true;
  form.held = [n](double v) { return n.at(v); };
  (takes_velocity(axis) ? write_for_velocity : write_for_force)(axis, n, form);
  return form;
}

/// Instances of the components that the axes need, and their nets.
struct Components {
  std::string tables, points, sums, lags, nets;

  void add_to(std::string& list, const std::string& name) { list += (list.empty() ? "" : ",") + name; }

  void add(const Axis& axis) {
    const std::string& name = axis.name;
    add_to(tables, "ff." + name);
    add_to(points, fmt::format("{}", PidNumbers(axis).table.table.corners.size()));
    add_to(sums, "sum." + name);
    nets += fmt::format("net {0}-friction-speed joint.{1}.vel-cmd => ff.{0}.in\n", name, axis.number);
    if (!takes_velocity(axis)) {
      nets += fmt::format(
          "net {0}-friction ff.{0}.out => sum.{0}.in1\nnet {0}-pid pid.{0}.output => sum.{0}.in0\n"
          "# sum.{0}.out is the command of the drive.\n",
          name);
      return;
    }
    nets += fmt::format(
        "net {0}-friction ff.{0}.out => sum.{0}.in1\nnet {0}-friction-acceleration joint.{1}.acc-cmd => sum.{0}.in0\n",
        name, axis.number);
    const bool integral = axis.model.drive_loop->integral_time.has_value();
    if (integral) {
      add_to(lags, "lag." + name);
      add_to(sums, "lead." + name);
      nets += fmt::format(
          "net {0}-ahead sum.{0}.out => lag.{0}.in lead.{0}.in0\nnet {0}-lag lag.{0}.out => lead.{0}.in1\n",
          name);
    }
    add_to(sums, "cmd." + name);
    nets += fmt::format(
        "net {0}-offset {1}.{0}.out => cmd.{0}.in1\nnet {0}-pid pid.{0}.output => cmd.{0}.in0\n"
        "# cmd.{0}.out is the command of the drive, a velocity in mm/s.\n",
        name, integral ? "lead" : "sum");
  }
};

std::string pid_head(const std::vector<Axis>& axes) {
  Components all;
  bool force = false, velocity = false;
  for (const Axis& axis : axes) {
    all.add(axis);
    (takes_velocity(axis) ? velocity : force) = true;
  }
  const char* what =
      force && velocity
          ? "# For drives as the axis files have them: of a force, or of a velocity (drive_loop)."
      : force
          ? "# For drives that take a force, a torque or a current, not for those that take a velocity or a position."
          : "# For drives that take a velocity (drive_loop of the axis files).";
  return fmt::format(
      "{}\n"
      "# Beside pid instances with these names (loadrt pid names=pid.{},...). Velocities in mm/s.\n"
      "# Joints are numbered as x, y, z, a, b, c, u, v, w where all axes have such names, else in the order of the files: check them.\n"
      "# Another lincurve, sum2 or lowpass in the configuration: write all names of one component into one loadrt.\n"
      "loadrt lincurve names={} personality={}\nloadrt sum2 names={}\n{}{}",
      what, axes.front().name, all.tables, all.points, all.sums,
      all.lags.empty() ? "" : fmt::format("loadrt lowpass names={}\n", all.lags), all.nets);
}

}  // namespace

extern const SteadyTarget kPid;
const SteadyTarget kPid{.name = "pid",
                        .what = "feed-forward and friction for LinuxCNC's stock pid and lincurve",
                        .comment = "#",
                        .write = pid_form,
                        .extension = ".hal",
                        .head = pid_head,
                        .takes_gain = true,
                        .encoder = true,
                        .linear_only = true};

}  // namespace stribeck::targets
