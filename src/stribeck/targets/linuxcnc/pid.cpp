// --to pid: feed-forward and friction for LinuxCNC's stock pid, with stock lincurve and sum2 beside it. Nothing has to be installed.
#include <fmt/format.h>

#include <stribeck/report/text.hpp>
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

/// What one pid and one lincurve get, in mm and in the unit of pid.output.
struct PidNumbers {
  double ff1 = 0.0;
  double ff2 = 0.0;
  double bias = 0.0;
  double force = 1.0;  ///< of one unit of pid.output [N]
  linuxcnc::Lincurve table;

  explicit PidNumbers(const Axis& axis) : force(std::isnan(axis.gain) ? 1.0 : axis.gain) {
    ff1 = hal_digits(nearest_line(axis).viscous * kMillimetre / force);
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

Form pid_form(const Axis& axis) {
  const PidNumbers n(axis);
  const std::string unit = output_unit(axis);
  const std::string& name = axis.name;
  Form form;
  form.mass = form.load = true;
  form.held = [n](double v) { return n.at(v); };
  const auto set = [&](const char* pin, double value, const std::string& words) {
    form.text += fmt::format("setp pid.{}.{} {:.9g}  # {}\n", name, pin, value, words);
  };
  set("FF0", 0.0, "over the commanded position: nothing");
  set("FF1", n.ff1, fmt::format("{} per mm/s: viscous friction", unit));
  set("FF2", n.ff2,
      fmt::format("{} per mm/s2: the mass of {} kg", unit, report::significant(axis.model.mass, 4)));
  set("bias", n.bias, unit + ": the load, as a weight");
  if (std::isnan(axis.resolution)) {
    form.text += fmt::format(
        "# setp pid.{}.deadband D  # mm: 0.55 of the encoder's step, against hunting between two of them; --resolution writes it\n",
        name);
  } else {
    set("deadband", hal_digits(kDeadband * axis.resolution / kMillimetre),
        "mm: 0.55 of the encoder's step, against hunting between two of them");
  }
  form.text += fmt::format(
      "# Coulomb and Stribeck friction over the commanded velocity: x-val in mm/s, y-val in {0}; FF1 has the rest.\n{1}"
      "addf ff.{2} servo-thread\naddf sum.{2} servo-thread\n",
      unit, linuxcnc::lincurve_lines("ff." + name, n.table), name);
  form.to_do =
      "Source the file behind the addf of pid.NAME.do-pid-calcs and in front of that of the outputs; take pid.NAME.output out of the net "
      "that has it, and put sum.NAME.out there. Check first the unit of pid.NAME.output (--gain is the force of one; without it the "
      "numbers are in N) and, with half of the y-val lines, that at a constant positive velocity ff.NAME.out is positive. These numbers are "
      "for a drive that takes a force, a torque or a current. Do not give them to a drive that takes a velocity (analogue, 10 V) or a "
      "position: its FF1 is 1, and --to linuxcnc --machine FILE writes its loop.";
  return form;
}

std::string pid_head(const std::vector<Axis>& axes) {
  std::string tables, sums, points, nets;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::string& name = axes[i].name;
    const char* comma = i == 0 ? "" : ",";
    tables += fmt::format("{}ff.{}", comma, name);
    sums += fmt::format("{}sum.{}", comma, name);
    points += fmt::format("{}{}", comma, PidNumbers(axes[i]).table.table.corners.size());
    nets += fmt::format(
        "net {0}-friction-speed joint.{1}.vel-cmd => ff.{0}.in\nnet {0}-friction ff.{0}.out => sum.{0}.in1\n"
        "net {0}-pid pid.{0}.output => sum.{0}.in0\n# sum.{0}.out is the command of the drive.\n",
        name, axes[i].number);
  }
  return fmt::format(
      "# For drives that take a force, a torque or a current, not for those that take a velocity or a position.\n"
      "# Beside pid instances with these names (loadrt pid names=pid.{},...). Velocities in mm/s.\n"
      "# Joints are numbered as x, y, z, a, b, c, u, v, w where all axes have such names, else in the order of the files: check them.\n"
      "# Another lincurve or sum2 in the configuration: write all names of one component into one loadrt.\n"
      "loadrt lincurve names={} personality={}\nloadrt sum2 names={}\n{}",
      axes.front().name, tables, points, sums, nets);
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
