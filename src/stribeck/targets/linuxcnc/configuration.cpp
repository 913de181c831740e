#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <stribeck/io/error.hpp>
#include <stribeck/path/five_axis.hpp>
#include <stribeck/targets/linuxcnc/configuration.hpp>
#include <stribeck/targets/linuxcnc/hal_lines.hpp>
#include <stribeck/targets/linuxcnc/lincurve.hpp>

namespace stribeck::targets::linuxcnc {
namespace {

using Axes = std::vector<HalAxis>;

bool angular(const HalAxis& a) { return a.letter.find_first_of("abc") != std::string::npos; }

/// Length [m] of one machine unit: a millimetre, or a degree at the reference radius (path/five_axis.hpp).
double unit_of(const HalAxis& a) { return angular(a) ? path::TiltingTable{}.radius * kPi / 180.0 : 1e-3; }

/// Name of the machine unit, for people.
std::string_view unit_name(const HalAxis& a) { return angular(a) ? "deg" : "mm"; }

/// Whether one stribeck_contour can control all axes.
bool has_contour(const Configuration& c) {
  return (c.axes.size() == 2 || c.axes.size() == 3) && std::none_of(c.axes.begin(), c.axes.end(), angular);
}

double in_units(const HalAxis& a, double metres) { return metres / unit_of(a); }

std::string number(double x) { return fmt::format("{:.9g}", x); }

/// Where the axis is homed and the drive stands at the start [m]: zero, or the middle of a travel without it.
double home_of(const HalAxis& a) {
  const sim::AxisLimits& l = a.can.limits;
  return l.travel_min <= 0.0 && l.travel_max >= 0.0 ? 0.0 : 0.5 * (l.travel_min + l.travel_max);
}

std::string capital(const HalAxis& a) {
  return std::string(1, static_cast<char>(a.letter.front() - 'a' + 'A'));
}

/// A text for every axis.
std::string each(const Axes& axes, const std::function<std::string(const HalAxis&, std::size_t)>& text) {
  std::string out;
  for (std::size_t i = 0; i < axes.size(); ++i) out += text(axes[i], i);
  return out;
}

std::string names(const Axes& axes, std::string_view prefix) {
  std::string out;
  for (const HalAxis& a : axes) out += fmt::format("{}{}{}", out.empty() ? "" : ",", prefix, a.letter);
  return out;
}

// ---- INI ------------------------------------------------------------------------------------------------

std::string ini(const Configuration& c, bool screen) {
  std::string out = c.comment;
  double speed = 0.0;
  double acceleration = 0.0;
  double angular_speed = 0.0;
  double angular_acceleration = 0.0;
  for (const HalAxis& a : c.axes) {
    double& v = angular(a) ? angular_speed : speed;
    double& w = angular(a) ? angular_acceleration : acceleration;
    v = std::max(v, in_units(a, a.can.limits.speed));
    w = std::max(w, in_units(a, a.can.limits.acceleration));
  }
  std::string geometry;
  std::string coordinates;
  std::string lower;
  for (const HalAxis& a : c.axes) {
    geometry += capital(a);
    coordinates += (coordinates.empty() ? "" : " ") + capital(a);
    lower += a.letter;
  }
  out += fmt::format("[EMC]\nVERSION = 1.1\nMACHINE = {}\nDEBUG = 0\n\n[DISPLAY]\n", c.name);
  if (screen) {
    out +=
        "DISPLAY = axis\nOPEN_FILE = demo.ngc\nPROGRAM_PREFIX = .\nPOSITION_OFFSET = RELATIVE\n"
        "POSITION_FEEDBACK = ACTUAL\nMAX_FEED_OVERRIDE = 1.0\nCYCLE_TIME = 0.1\nINCREMENTS = 5 mm, 1 mm, "
        "0.1 mm, 0.01 mm\n";
    out += fmt::format("GEOMETRY = {}\n", geometry);
    if (speed > 0.0)
      out += fmt::format("DEFAULT_LINEAR_VELOCITY = {}\nMAX_LINEAR_VELOCITY = {}\nMIN_LINEAR_VELOCITY = {}\n",
                         number(0.5 * speed), number(speed), number(0.01 * speed));
    if (angular_speed > 0.0)
      out += fmt::format("DEFAULT_ANGULAR_VELOCITY = {}\nMAX_ANGULAR_VELOCITY = {}\n",
                         number(0.5 * angular_speed), number(angular_speed));
  } else {
    out += "DISPLAY = ./play.py\n";
  }
  out += "\n[TASK]\nTASK = milltask\nCYCLE_TIME = 0.001\n\n[RS274NGC]\nPARAMETER_FILE = machine.var\n";
  out += fmt::format(
      "\n[EMCMOT]\nEMCMOT = motmod\nCOMM_TIMEOUT = 40.0\nBASE_PERIOD = 0\nSERVO_PERIOD = {:.0f}\n",
      1e9 * c.sample_time);
  out += "\n[EMCIO]\nEMCIO = io\nCYCLE_TIME = 0.100\nTOOL_TABLE = tool.tbl\n";
  out += "\n[HAL]\nHALFILE = motion.hal\n";
  out += fmt::format("# Or {}control-pid.hal, control-lincurve.hal.\n",
                     has_contour(c) ? "control-contour.hal, " : "");
  out += "HALFILE = control-axis.hal\nHALFILE = record.hal\n";
  out +=
      "# The drives come last in the thread. A real machine: leave this out, and connect its amplifiers "
      "and encoders.\n"
      "HALFILE = drives.hal\n";
  out += fmt::format("\n[TRAJ]\nCOORDINATES = {}\nLINEAR_UNITS = mm\nANGULAR_UNITS = degree\n", coordinates);
  if (speed > 0.0)
    out += fmt::format(
        "DEFAULT_LINEAR_VELOCITY = {}\nMAX_LINEAR_VELOCITY = {}\nDEFAULT_LINEAR_ACCELERATION = {}\n"
        "MAX_LINEAR_ACCELERATION = {}\n",
        number(0.5 * speed), number(speed), number(acceleration), number(acceleration));
  if (angular_speed > 0.0)
    out += fmt::format(
        "DEFAULT_ANGULAR_VELOCITY = {}\nMAX_ANGULAR_VELOCITY = {}\nDEFAULT_ANGULAR_ACCELERATION = {}\n"
        "MAX_ANGULAR_ACCELERATION = {}\n",
        number(0.5 * angular_speed), number(angular_speed), number(angular_acceleration),
        number(angular_acceleration));
  out += fmt::format("\n[KINS]\nKINEMATICS = trivkins coordinates={}\nJOINTS = {}\n", lower, c.axes.size());
  out += each(c.axes, [](const HalAxis& a, std::size_t i) {
    const sim::AxisLimits& l = a.can.limits;
    const std::string limits =
        fmt::format("MAX_VELOCITY = {}\nMAX_ACCELERATION = {}\nMIN_LIMIT = {}\nMAX_LIMIT = {}\n",
                    number(in_units(a, l.speed)), number(in_units(a, l.acceleration)),
                    number(in_units(a, l.travel_min)), number(in_units(a, l.travel_max)));
    const std::string home = number(in_units(a, home_of(a)));
    return fmt::format(
        "\n[AXIS_{}]\n{}\n[JOINT_{}]\nTYPE = {}\nHOME = {}\nHOME_OFFSET = {}\n# {}\n{}FERROR = "
        "2\nMIN_FERROR = 2\n"
        "HOME_SEARCH_VEL = 0\nHOME_LATCH_VEL = 0\nHOME_SEQUENCE = 0\n",
        capital(a), limits, i, angular(a) ? "ANGULAR" : "LINEAR", home, home, limits_words(a.can, *a.machine),
        limits);
  });
  return out;
}

// ---- HAL ------------------------------------------------------------------------------------------------

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

/// Law learning: where the phase goes, and of which controllers the lap must be known.
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

std::vector<std::string> instances(const Axes& axes) {
  std::vector<std::string> out;
  for (const HalAxis& a : axes) out.push_back("ax." + a.letter);
  return out;
}

std::string axis_control(const Configuration& c) {
  std::string out =
      c.comment + "# One stribeck_axis for each joint. Parameters: docs/guides/linuxcnc.md of Stribeck.\n";
  out += fmt::format("loadrt stribeck_axis names={}\n", names(c.axes, "ax."));
  out += each(c.axes, [&](const HalAxis& a, std::size_t i) {
    std::string text = fmt::format(
        "\naddf ax.{0} servo-thread\nnet {0}-enable => ax.{0}.enable\nnet {0}-cmd => ax.{0}.pos-cmd\n"
        "net {0}-vel => ax.{0}.vel-cmd\nnet {0}-acc => ax.{0}.acc-cmd\nnet {0}-fb => ax.{0}.pos-fb\n"
        "net {0}-force ax.{0}.force\nnet {0}-faulted ax.{0}.faulted => joint.{1}.amp-fault-in\n",
        a.letter, i);
    text += setp("ax." + a.letter, "position-unit", unit_of(a));
    text += setp("ax." + a.letter, "force-limit", a.machine->force_limit());
    return text + controller_lines("ax." + a.letter, a.model, c.omega, c.feedforward);
  });
  return out + learning(instances(c.axes), instances(c.axes));
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
        "net {0}-fb => {1}.pos-fb\nnet {0}-force {1}.force\n",
        a.letter, name);
    text += setp(name, "force-limit", a.machine->force_limit());
    return text + controller_lines(name, a.model, c.omega, c.feedforward);
  });
  std::vector<std::string> controllers;
  for (std::size_t i = 0; i < c.axes.size(); ++i) controllers.push_back(fmt::format("ct.{}", i));
  return out + learning({"ct"}, controllers);
}

/// Viscous friction [N s/m], both directions' mean.
double viscous_of(const friction::AxisModel& model) {
  return std::visit(
      [](const auto& map) { return 0.5 * (map.viscous_coefficient(1.0) + map.viscous_coefficient(-1.0)); },
      model.friction.steady);
}

/// Stock pid at the same gains, in N and machine units; friction beyond FF1 from a lincurve where wanted.
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

/// What halsampler writes: as much of each axis as its 21 columns hold.
std::vector<std::string> recorded_signals(const Configuration& c) {
  std::vector<std::string> signals{"cmd", "fb", "pos", "force"};
  while (signals.size() * c.axes.size() > 20) signals.erase(signals.begin() + (signals.size() > 3 ? 2 : 0));
  return signals;
}

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

/// Unit of a position in the log, for stribeck: degrees as the arcs that machine and axis files mean.
std::string length_unit(const HalAxis& a) {
  return angular(a) ? fmt::format("mm*{}", number(1e3 * unit_of(a))) : "mm";
}

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
    std::string text = fmt::format(
        "\naddf {1} servo-thread\nnet {0}-force => {1}.force\nnet {0}-fb {1}.pos-fb\nnet {0}-pos {1}.pos\n",
        a.letter, name);
    text += setp(name, "position-unit", unit_of(a));
    text += setp(name, "start", in_units(a, home_of(a)));
    text += fmt::format("setp {}.seed {}\n", name, i + 1);
    // Beyond it friction is extrapolated: room for overshoot.
    text += fmt::format("setp {}.highest-speed {}\n", name, number(1.5 * in_units(a, a.can.limits.speed)));
    return text + plant_lines(name, *a.machine);
  });
  return out;
}

// ---- G-code ---------------------------------------------------------------------------------------------

/// Whole tenths of a millimetre or degree.
double rounded(const HalAxis& a, double metres) {
  return std::floor(10.0 * in_units(a, metres) + 1e-9) / 10.0 * unit_of(a);
}

/// Where programs have their middle [m]: zero where that leaves room.
double middle_of(const HalAxis& a) {
  const sim::AxisLimits& l = a.can.limits;
  return l.travel_min <= 0.0 && l.travel_max >= 0.0 &&
                 std::min(-l.travel_min, l.travel_max) > 0.2 * (l.travel_max - l.travel_min)
             ? 0.0
             : rounded(a, 0.5 * (l.travel_min + l.travel_max));
}

/// What is free on both sides of the middle [m].
double room_of(const HalAxis& a) {
  const sim::AxisLimits& l = a.can.limits;
  return std::min(middle_of(a) - l.travel_min, l.travel_max - middle_of(a));
}

/// Coordinate of an axis in a program.
std::string word(const HalAxis& a, double metres) {
  return fmt::format("{}{:.4g}", capital(a), std::round(1e4 * in_units(a, metres)) / 1e4 + 0.0);
}

/// Feed [machine units/min], a number that reads well.
std::string feed(const HalAxis& a, double speed) {
  const double f = 60.0 * in_units(a, speed);
  const double step = std::pow(10.0, std::floor(std::log10(f)) - 1.0);
  return fmt::format("F{:.6g}", std::floor(f / step + 1e-9) * step);
}

/// Two axes in which LinuxCNC knows circles, and its word for their plane.
struct Plane {
  const HalAxis* u;
  const HalAxis* v;
  std::string_view code;
  char i;
  char j;
};

std::vector<Plane> planes(const Configuration& c) {
  const auto find = [&](std::string_view letter) -> const HalAxis* {
    for (const HalAxis& a : c.axes) {
      if (a.letter == letter) return &a;
    }
    return nullptr;
  };
  std::vector<Plane> out;
  if (find("x") != nullptr && find("y") != nullptr) out.push_back({find("x"), find("y"), "G17", 'I', 'J'});
  if (find("x") != nullptr && find("z") != nullptr) out.push_back({find("x"), find("z"), "G18", 'I', 'K'});
  if (find("y") != nullptr && find("z") != nullptr) out.push_back({find("y"), find("z"), "G19", 'J', 'K'});
  return out;
}

/// A full circle about the middle from u = radius; G2 or G3.
std::string circle(const Plane& p, int g, double radius) {
  return fmt::format("G{} {} {} {}{:.4g} {}0", g, word(*p.u, middle_of(*p.u) + radius),
                     word(*p.v, middle_of(*p.v)), p.i, -1e3 * radius, p.j);
}

std::string to_middle(const Configuration& c) {
  std::string out = "G0";
  for (const HalAxis& a : c.axes) out += ' ' + word(a, middle_of(a));
  return out + '\n';
}

std::string demo(const Configuration& c) {
  const std::vector<Plane> ways = planes(c);
  std::string out;
  std::size_t more = 0;
  if (!ways.empty()) {
    const Plane& p = ways.front();
    const sim::AxisLimits& u = p.u->can.limits;
    const sim::AxisLimits& v = p.v->can.limits;
    const double radius = rounded(*p.u, std::min(10e-3, 0.5 * std::min(room_of(*p.u), room_of(*p.v))));
    const double acceleration = std::min(u.acceleration, v.acceleration);
    const double speed =
        std::min({10e-3, 0.8 * std::min(u.speed, v.speed), std::sqrt(0.5 * acceleration * radius)});
    const std::string f = feed(*p.u, speed);
    out += fmt::format(
        "({}: two revolutions in each direction, R = {:.4g} mm at {} mm/min; lines 7 and 9 count)\n", p.code,
        1e3 * radius, f.substr(1));
    out += fmt::format("G21 {} G90 G94 G64 P0.001\n", p.code) + to_middle(c);
    out += fmt::format("G1 {} {} {}\nG4 P0.5\n", word(*p.u, middle_of(*p.u) + radius),
                       word(*p.v, middle_of(*p.v)), f);
    for (const int g : {3, 3, 2, 2}) out += circle(p, g, radius) + '\n';
    out += "G4 P0.5\n" + to_middle(c);
    more = 2;
  } else {
    out += "(forth and back, faster and faster)\nG21 G90 G94 G64 P0.001\n" + to_middle(c);
  }
  for (std::size_t i = 0; i < c.axes.size(); ++i) {
    const HalAxis& a = c.axes[i];
    if (more > 0 && (ways.front().u == &a || ways.front().v == &a)) continue;
    const double way = rounded(a, 0.5 * std::min(20.0 * unit_of(a), room_of(a)));
    for (const double share : {0.1, 0.3, 0.8}) {
      out += fmt::format("G1 {} {}\nG1 {}\n", word(a, middle_of(a) + way),
                         feed(a, share * a.can.limits.speed), word(a, middle_of(a) - way));
    }
    out += fmt::format("G1 {}\n", word(a, middle_of(a)));
  }
  return out + "M2\n";
}

/// Excites every axis: circles are sines of two axes at once; rapid moves are for the mass.
std::string identify(const Configuration& c) {
  std::string out =
      "(Motion that tells friction, screw and mass of every axis. On a machine: clear of everything, "
      "nothing cutting.)\n"
      "(circles are sines, at several speeds and amplitudes; rapid moves are for the mass)\n"
      "G21 G90 G94 G64 P0.001\n" +
      to_middle(c);
  std::vector<const HalAxis*> alone;
  for (const HalAxis& a : c.axes) alone.push_back(&a);
  for (const Plane& p : planes(c)) {
    std::erase(alone, p.u);
    std::erase(alone, p.v);
    const HalAxis& u = *p.u;
    const double room = std::min(room_of(u), room_of(*p.v));
    const double wide = rounded(u, std::min(12e-3, 0.3 * room));
    const double narrow = rounded(u, 7.0 / 12.0 * wide);
    const double acceleration = std::min(u.can.limits.acceleration, p.v->can.limits.acceleration);
    const double fastest = std::min(std::min(u.can.limits.speed, p.v->can.limits.speed),
                                    std::sqrt(0.5 * acceleration * narrow) / 0.94);
    const auto start = [&](double radius) {
      out += fmt::format("G1 {} {}\n", word(u, middle_of(u) + radius), feed(u, 0.53 * fastest));
    };
    out += fmt::format("{}\n", p.code);
    start(wide);
    out += circle(p, 3, wide) + ' ' + feed(u, 0.73 * fastest) + '\n' + circle(p, 3, wide) + '\n';
    start(narrow);
    out += circle(p, 2, narrow) + ' ' + feed(u, 0.94 * fastest) + '\n' + circle(p, 2, narrow) + '\n';
    out += circle(p, 3, narrow) + ' ' + feed(u, 0.125 * fastest) + '\n';
    out += to_middle(c);
  }
  out += "G17\n";
  for (const HalAxis* a : alone) {
    const double way = rounded(*a, std::min(20.0 * unit_of(*a), 0.5 * room_of(*a)));
    for (const double share : {0.1, 0.25, 0.5, 0.75, 0.94}) {
      out += fmt::format("G1 {} {}\nG1 {}\n", word(*a, middle_of(*a) + way),
                         feed(*a, share * a->can.limits.speed), word(*a, middle_of(*a) - way));
    }
    out += to_middle(c);
  }
  out += "(rapid moves: longer, shorter, either way)\no100 repeat [8]\n";
  const auto rapid = [&](std::initializer_list<double> way) {
    out += "  G0";
    std::size_t i = 0;
    for (const HalAxis& a : c.axes) {
      const double most = std::min(3.0 * unit_of(a), 0.5 * room_of(a));
      out += ' ' + word(a, middle_of(a) + *(way.begin() + i % way.size()) * most);
      ++i;
    }
    out += '\n';
  };
  rapid({1.0, 0.83, 0.67});
  out += "  G4 P0.1\n";
  rapid({0.0});
  out += "  G4 P0.1\n";
  rapid({-0.33});
  rapid({0.17, 0.23, 0.3});
  return out + "o100 endrepeat\n" + to_middle(c) + "M2\n";
}

std::string about(const Configuration& c) {
  std::string out = fmt::format(
      "LinuxCNC configuration of the virtual machine \"{}\".\n{}\n"
      "  linuxcnc machine.ini        with the AXIS screen: F1, F2, home all (Ctrl-Home), R\n"
      "  linuxcnc -r headless.ini    plays demo.ngc without a screen, records run.log; STRIBECK_PROGRAM "
      "and STRIBECK_LOG name others\n\n"
      "The components stribeck_*.so must stand in LinuxCNC's module folder (docs/guides/linuxcnc.md of "
      "Stribeck).\n\n",
      c.name, c.comment.substr(2));
  out +=
      "motion.hal            motion and signals\n"
      "control-axis.hal      one stribeck_axis for each joint; the one that both INI files name\n";
  if (has_contour(c)) out += "control-contour.hal   one stribeck_contour for all joints\n";
  out +=
      "control-pid.hal       stock pid at the same gains\n"
      "control-lincurve.hal  the same with the steady friction in the 16 points of lincurve\n"
      "record.hal            halsampler; run.log.toml names its columns\n"
      "drives.hal            the virtual drives; left out on a real machine\n"
      "demo.ngc              a small program within the travel\n"
      "identify.ngc          motion from whose log axis files are made, for each axis:\n"
      "                      stribeck identify run.log --map r=x-cmd --map x=x-fb --map force=x-force -o "
      "x.toml\n"
      "play.py               what headless.ini has for a screen\n"
      "tool.tbl              LinuxCNC's tool table, empty\n"
      "written.txt           by which export knows files that were edited since; it does not write over "
      "them\n"
      "\nChoices of your own, such as law, belong in a HAL file of yours that the INI files name after the "
      "control file: the last setp\n"
      "counts, and a new export writes over neither.\n"
      "\nWhat a run without a screen leaves:\n"
      "run.log               the record; positions in machine units, forces in N. Where rows were lost it "
      "is run.log.incomplete\n"
      "run.log.clocks        median time of each function of the servo thread, in clocks of the processor\n"
      "machine.var           LinuxCNC's own variables\n";
  for (const HalAxis& a : c.axes) {
    if (angular(a)) {
      out += fmt::format(
          "\nAxis {}: one degree is {:.6g} mm of the machine file, which holds rotary axes at a radius of "
          "{:g} mm.\n",
          capital(a), 1e3 * unit_of(a), 1e3 * path::TiltingTable{}.radius);
    }
  }
  return out;
}

}  // namespace

std::vector<std::string> linuxcnc_letters(const sim::Machine& machine, const std::string& file) {
  std::vector<std::string> letters;
  for (const auto& [name, unused] : machine.axes) {
    std::string letter = name;
    if (letter.size() == 1 && letter.front() >= 'A' && letter.front() <= 'Z')
      letter.front() = static_cast<char>(letter.front() - 'A' + 'a');
    if (letter.size() != 1 || letter.find_first_of("xyzabcuvw") == std::string::npos) {
      throw io::InputError(
          {file, 0, "axes." + name,
           "expected one of LinuxCNC's letters x, y, z, a, b, c, u, v, w (rename the axis)"});
    }
    if (std::find(letters.begin(), letters.end(), letter) != letters.end()) {
      throw io::InputError(
          {file, 0, "axes." + name,
           fmt::format("a second axis {}; LinuxCNC does not tell capitals (rename one)", letter)});
    }
    letters.push_back(letter);
  }
  return letters;
}

NamedTexts configuration_files(const Configuration& c) {
  NamedTexts files{{"README", about(c)},
                   {"motion.hal", motion(c)},
                   {"control-axis.hal", axis_control(c)},
                   {"control-pid.hal", pid_control(c, false)},
                   {"control-lincurve.hal", pid_control(c, true)},
                   {"record.hal", record(c)},
                   {"run.log.toml", record_names(c)},
                   {"drives.hal", drives(c)},
                   {"demo.ngc", demo(c)},
                   {"identify.ngc", identify(c)},
                   {"play.py", std::string(kPlay)},
                   {"tool.tbl", ";\n"}};
  if (has_contour(c)) files.emplace_back("control-contour.hal", contour_control(c));
  // Last: with it the configuration is whole.
  files.emplace_back("headless.ini", ini(c, false));
  files.emplace_back("machine.ini", ini(c, true));
  return files;
}

}  // namespace stribeck::targets::linuxcnc
