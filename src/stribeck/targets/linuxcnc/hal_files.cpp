#include <fmt/format.h>
#include <string_view>
#include <variant>

#include <stribeck/targets/linuxcnc/configuration.hpp>
#include <stribeck/targets/linuxcnc/hal_lines.hpp>
#include <stribeck/targets/linuxcnc/lincurve.hpp>

namespace stribeck::targets::linuxcnc {

std::string motion(const Configuration& c) {
  std::string out = c.comment;
  out +=
      "# Motion, and the signals that controllers and drives meet on.\n"
      "loadrt [KINS]KINEMATICS\n"
      "loadrt [EMCMOT]EMCMOT base_period_nsec=[EMCMOT]BASE_PERIOD servo_period_nsec=[EMCMOT]SERVO_PERIOD "
      "num_joints=[KINS]JOINTS\n"
      "addf motion-command-handler servo-thread\naddf motion-controller servo-thread\n\n";
  out += each(c.axes, [](const HalAxis& a, std::size_t i) {
    return fmt::format(
        "net {0}-enable joint.{1}.amp-enable-out\nnet {0}-cmd joint.{1}.motor-pos-cmd\nnet {0}-vel "
        "joint.{1}.vel-cmd\n"
        "net {0}-acc joint.{1}.acc-cmd\nnet {0}-fb => joint.{1}.motor-pos-fb\n",
        a.letter, i);
  });
  out +=
      "\nnet estop-loop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in\n"
      "net tool-prepare-loop iocontrol.0.tool-prepare => iocontrol.0.tool-prepared\n"
      "net tool-change-loop iocontrol.0.tool-change => iocontrol.0.tool-changed\n"
      "\n# For law 3, learning: the way since the program's last \"M62 P0\" is the place in the lap. "
      "Uncomment these lines and those\n"
      "# of learning in the control file (docs/guides/linuxcnc.md of Stribeck).\n"
      "# loadrt edge names=lap.begin\n"
      "# loadrt integ names=lap.way\n"
      "# setp lap.begin.in-edge 0  # rising\n"
      "# addf lap.begin servo-thread\n"
      "# addf lap.way servo-thread\n"
      "# net lap-begin motion.digital-out-00 => lap.begin.in\n"
      "# net lap-reset lap.begin.out => lap.way.reset\n"
      "# net path-speed motion.current-vel => lap.way.in\n"
      "# net lap-phase lap.way.out\n";
  return out;
}

namespace {

/// The law learning: where the phase is connected, and the controllers that need the lap.
std::string learning(const std::vector<std::string>& phases, const std::vector<std::string>& controllers) {
  std::string out =
      "\n# With law 3, learning, also: the place in the lap, and the lap's length in machine units, "
      "rounded up to a hundredth\n"
      "# (62.84: a circle of 10 mm). Where it is too short nothing is learned.\n# net lap-phase =>";
  for (const std::string& name : phases) out += fmt::format(" {}.phase", name);
  out += '\n';
  for (const std::string& name : controllers) out += fmt::format("# setp {}.learning.lap 62.84\n", name);
  return out;
}

/// How a machine tells the controllers of late cycles.
std::string lateness(const std::vector<std::string>& controllers) {
  std::string out =
      "\n# On a machine, not with virtual drives, which count in periods: the controller is told of late cycles\n";
  for (const std::string& name : controllers) out += fmt::format("# setp {}.watch-lateness 1\n", name);
  return out;
}

std::vector<std::string> instances(const Axes& axes) {
  std::vector<std::string> out;
  for (const HalAxis& a : axes) out.push_back("ax." + a.letter);
  return out;
}

}  // namespace

namespace {

/// The outputs of a controller to its drive: a force, or for a drive with a loop of its own a command with a force offset beside it;
/// the force that acts is then the one that the drive reports.
std::string output_lines(const HalAxis& a, const std::string& controller) {
  if (!a.model.drive_loop) return fmt::format("net {}-force {}.force\n", a.letter, controller);
  return fmt::format(
      "net {0}-command {1}.command\nnet {0}-offset {1}.offset\nnet {0}-force => {1}.force-fb\n", a.letter,
      controller);
}

}  // namespace

std::string axis_control(const Configuration& c) {
  std::string out =
      c.comment + "# One stribeck_axis for each joint. Parameters: docs/guides/linuxcnc.md of Stribeck.\n";
  out += fmt::format("loadrt stribeck_axis names={}\n", names(c.axes, "ax."));
  out += each(c.axes, [&](const HalAxis& a, std::size_t i) {
    std::string text = fmt::format(
        "\naddf ax.{0} servo-thread\nnet {0}-enable => ax.{0}.enable\nnet {0}-cmd => ax.{0}.pos-cmd\n"
        "net {0}-vel => ax.{0}.vel-cmd\nnet {0}-acc => ax.{0}.acc-cmd\nnet {0}-fb => ax.{0}.pos-fb\n",
        a.letter);
    text += output_lines(a, "ax." + a.letter);
    text += fmt::format("net {0}-faulted ax.{0}.faulted => joint.{1}.amp-fault-in\n", a.letter, i);
    text += setp("ax." + a.letter, "position-unit", unit_of(a));
    text += setp("ax." + a.letter, "force-limit", a.machine->force_limit());
    return text + supervision_lines("ax." + a.letter, *a.machine) +
           controller_lines("ax." + a.letter, a.model, c.omega, c.feedforward);
  });
  return out + learning(instances(c.axes), instances(c.axes)) + lateness(instances(c.axes));
}

std::string contour_control(const Configuration& c) {
  std::string out = c.comment +
                    "# One stribeck_contour for all joints, law the same for all. Parameters: "
                    "docs/guides/linuxcnc.md of Stribeck.\n";
  out += fmt::format("loadrt stribeck_contour names=ct axes={}\naddf ct servo-thread\n", c.axes.size());
  out += fmt::format("net {}-enable => ct.enable\nnet faulted ct.faulted =>", c.axes.front().letter);
  out += each(c.axes, [](const HalAxis&, std::size_t i) { return fmt::format(" joint.{}.amp-fault-in", i); });
  out += '\n' + setp("ct", "position-unit", unit_of(c.axes.front()));
  out += each(c.axes, [&](const HalAxis& a, std::size_t i) {
    const std::string name = fmt::format("ct.{}", i);
    std::string text = fmt::format(
        "\nnet {0}-cmd => {1}.pos-cmd\nnet {0}-vel => {1}.vel-cmd\nnet {0}-acc => {1}.acc-cmd\n"
        "net {0}-fb => {1}.pos-fb\n",
        a.letter, name);
    text += output_lines(a, name);
    text += setp(name, "force-limit", a.machine->force_limit());
    return text + supervision_lines(name, *a.machine) +
           controller_lines(name, a.model, c.omega, c.feedforward);
  });
  std::vector<std::string> controllers;
  for (std::size_t i = 0; i < c.axes.size(); ++i) controllers.push_back(fmt::format("ct.{}", i));
  return out + learning({"ct"}, controllers) + lateness({"ct"});
}

namespace {

/// Viscous friction [N s/m], mean of both directions.
double viscous_of(const friction::AxisModel& model) {
  return std::visit(
      [](const auto& map) { return 0.5 * (map.viscous_coefficient(1.0) + map.viscous_coefficient(-1.0)); },
      model.friction.steady);
}

}  // namespace

namespace {

/// LinuxCNC's own pid in front of a drive with a loop of its own: a position loop for a velocity drive, the commanded position for a
/// position drive. Friction is left to the drive.
std::string pid_of_loop(const HalAxis& a, double omega) {
  const bool by_position = a.model.drive_loop->mode == friction::DriveMode::kPosition;
  return fmt::format(
      "\naddf pid.{0}.do-pid-calcs servo-thread\nnet {0}-enable => pid.{0}.enable\n"
      "net {0}-cmd => pid.{0}.command\nnet {0}-fb => pid.{0}.feedback\nnet {0}-command pid.{0}.output\n"
      "setp pid.{0}.Pgain {1}\nsetp pid.{0}.FF0 {2}\nsetp pid.{0}.FF1 {3}\nsetp pid.{0}.error-previous-target 0\n",
      a.letter, number(by_position ? 0.0 : 0.5 * omega), by_position ? 1 : 0, by_position ? 0 : 1);
}

}  // namespace

/// LinuxCNC's own pid with the same gains, in N and machine units; friction beyond FF1 from a lincurve where requested.
std::string pid_control(const Configuration& c, bool with_lincurve) {
  std::string out = c.comment;
  out += with_lincurve ? "# Stock parts: pid, and friction over the commanded velocity from lincurve.\n"
                       : "# Stock pid with velocity and acceleration feed-forward.\n";
  out += fmt::format("loadrt pid names={}\n", names(c.axes, "pid."));
  std::vector<Lincurve> tables;
  if (with_lincurve) {
    std::string points;
    for (const HalAxis& a : c.axes) {
      tables.push_back(best_lincurve(a.model, a.can.limits.speed, unit_of(a)));
      points += fmt::format("{}{}", points.empty() ? "" : ",", tables.back().table.corners.size());
    }
    out += fmt::format("loadrt lincurve names={} personality={}\nloadrt sum2 names={}\n",
                       names(c.axes, "ff."), points, names(c.axes, "sum."));
  }
  out += each(c.axes, [&](const HalAxis& a, std::size_t i) {
    if (a.model.drive_loop) return pid_of_loop(a, c.omega);
    const double unit = unit_of(a);
    const double mass = a.model.mass;
    const std::string pid = "pid." + a.letter;
    std::string text = fmt::format(
        "\naddf {1}.do-pid-calcs servo-thread\nnet {0}-enable => {1}.enable\n"
        "net {0}-cmd => {1}.command\nnet {0}-fb => {1}.feedback\n",
        a.letter, pid);
    if (with_lincurve) {
      text += fmt::format(
          "addf ff.{0} servo-thread\naddf sum.{0} servo-thread\nnet {0}-vel => ff.{0}.in\n"
          "net {0}-pid {1}.output => sum.{0}.in0\nnet {0}-ff ff.{0}.out => sum.{0}.in1\nnet {0}-force "
          "sum.{0}.out\n",
          a.letter, pid);
    } else {
      text += fmt::format("net {}-force {}.output\n", a.letter, pid);
    }
    const auto set = [&](std::string_view pin, double value) {
      text += fmt::format("setp {}.{} {}\n", pid, pin, number(value));
    };
    set("Pgain", mass * c.omega * c.omega * unit);
    set("Dgain", 2.0 * mass * c.omega * unit);
    set("FF1", with_lincurve ? 0.0 : viscous_of(a.model) * unit);
    set("FF2", mass * unit);
    set("bias", a.model.load);
    set("maxoutput", a.machine->force_limit());
    set("error-previous-target", 0.0);
    if (with_lincurve) {
      text += fmt::format("# {}\n", lincurve_words(tables[i], a.model, fmt::format("{}/s", unit_name(a)))) +
              lincurve_lines("ff." + a.letter, tables[i]);
    }
    return text;
  });
  return out;
}

namespace {

/// Columns of halsampler: as many signals of each axis as its 21 columns can hold.
std::vector<std::string> recorded_signals(const Configuration& c) {
  std::vector<std::string> signals{"cmd", "fb", "pos", "force"};
  while (signals.size() * c.axes.size() > 20) signals.erase(signals.begin() + (signals.size() > 3 ? 2 : 0));
  return signals;
}

}  // namespace

bool records_command(const Configuration& c) { return recorded_signals(c).front() == "cmd"; }

std::string record(const Configuration& c) {
  const std::vector<std::string> signals = recorded_signals(c);
  std::string out = c.comment;
  out +=
      "# What halsampler writes; run.log.toml names the columns for stribeck. Before the drives in the "
      "thread: the encoder and\n"
      "# the force of one row belong to the same sample.\n";
  out += fmt::format("loadrt sampler depth=20000 cfg={}s\naddf sampler.0 servo-thread\n",
                     std::string(signals.size() * c.axes.size(), 'f'));
  out += "setp sampler.0.enable 0\n";
  std::size_t pin = 0;
  out += each(c.axes, [&](const HalAxis& a, std::size_t) {
    std::string text;
    for (const std::string& s : signals)
      text += fmt::format("net {}-{} => sampler.0.pin.{}\n", a.letter, s, pin++);
    return text;
  });
  out += fmt::format("net line motion.program-line => sampler.0.pin.{}\n", pin);
  return out;
}

namespace {

/// Unit of a position in the log for stribeck: degrees as the arcs that machine and axis files use.
std::string length_unit(const HalAxis& a) {
  return angular(a) ? fmt::format("mm*{}", number(1e3 * unit_of(a))) : "mm";
}

}  // namespace

std::string record_names(const Configuration& c) {
  std::string out = c.comment + "columns = [\n";
  out += each(c.axes, [&](const HalAxis& a, std::size_t) {
    std::string text = " ";
    for (const std::string& s : recorded_signals(c))
      text += fmt::format(" \"{}-{} {}\",", a.letter, s, s == "force" ? "N" : length_unit(a));
    return text + '\n';
  });
  return out + fmt::format("  \"line\",\n]\nsample_time = \"{} ms\"\n", number(1e3 * c.sample_time));
}

std::string drives(const Configuration& c) {
  std::string out = c.comment + "# The virtual drives in place of amplifiers, motors, screws and encoders.\n";
  out += fmt::format("loadrt stribeck_plant names={}\n", names(c.axes, "pl."));
  out += each(c.axes, [&](const HalAxis& a, std::size_t i) {
    const std::string name = "pl." + a.letter;
    std::string text = fmt::format("\naddf {} servo-thread\n", name);
    text +=
        a.machine->plant.drive_loop
            ? fmt::format(
                  "net {0}-command => {1}.command\nnet {0}-offset => {1}.offset\nnet {0}-force {1}.force-fb\n",
                  a.letter, name)
            : fmt::format("net {0}-force => {1}.force\n", a.letter, name);
    text += fmt::format("net {0}-fb {1}.pos-fb\nnet {0}-pos {1}.pos\n", a.letter, name);
    text += setp(name, "position-unit", unit_of(a));
    text += setp(name, "start", in_units(a, home_of(a)));
    text += fmt::format("setp {}.seed {}\n", name, i + 1);
    // Beyond it friction is extrapolated: a margin for overshoot.
    text += fmt::format("setp {}.highest-speed {}\n", name, number(1.5 * in_units(a, a.can.limits.speed)));
    return text + plant_lines(name, *a.machine);
  });
  return out;
}

}  // namespace stribeck::targets::linuxcnc
