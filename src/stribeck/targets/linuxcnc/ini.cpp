#include <fmt/format.h>
#include <algorithm>

#include <stribeck/targets/linuxcnc/configuration.hpp>

namespace stribeck::targets::linuxcnc {

namespace {

/// Largest value of all axes, in machine units; 0: there is no such axis.
struct Fastest {
  double speed = 0.0;
  double acceleration = 0.0;
  double angular_speed = 0.0;
  double angular_acceleration = 0.0;
};

Fastest fastest_of(const Configuration& c) {
  Fastest most;
  for (const HalAxis& a : c.axes) {
    double& v = angular(a) ? most.angular_speed : most.speed;
    double& w = angular(a) ? most.angular_acceleration : most.acceleration;
    v = std::max(v, in_units(a, a.can.limits.speed));
    w = std::max(w, in_units(a, a.can.limits.acceleration));
  }
  return most;
}

std::string axis_screen(const Fastest& most, const std::string& geometry) {
  std::string out;
  out +=
      "DISPLAY = axis\nOPEN_FILE = demo.ngc\nPROGRAM_PREFIX = .\nPOSITION_OFFSET = RELATIVE\n"
      "POSITION_FEEDBACK = ACTUAL\nMAX_FEED_OVERRIDE = 1.0\nCYCLE_TIME = 0.1\nINCREMENTS = 5 mm, 1 mm, "
      "0.1 mm, 0.01 mm\n";
  out += fmt::format("GEOMETRY = {}\n", geometry);
  if (most.speed > 0.0)
    out += fmt::format("DEFAULT_LINEAR_VELOCITY = {}\nMAX_LINEAR_VELOCITY = {}\nMIN_LINEAR_VELOCITY = {}\n",
                       number(0.5 * most.speed), number(most.speed), number(0.01 * most.speed));
  if (most.angular_speed > 0.0)
    out += fmt::format("DEFAULT_ANGULAR_VELOCITY = {}\nMAX_ANGULAR_VELOCITY = {}\n",
                       number(0.5 * most.angular_speed), number(most.angular_speed));
  return out;
}

std::string trajectory(const Fastest& most, const std::string& coordinates) {
  std::string out =
      fmt::format("\n[TRAJ]\nCOORDINATES = {}\nLINEAR_UNITS = mm\nANGULAR_UNITS = degree\n", coordinates);
  if (most.speed > 0.0)
    out += fmt::format(
        "DEFAULT_LINEAR_VELOCITY = {}\nMAX_LINEAR_VELOCITY = {}\nDEFAULT_LINEAR_ACCELERATION = {}\n"
        "MAX_LINEAR_ACCELERATION = {}\n",
        number(0.5 * most.speed), number(most.speed), number(most.acceleration), number(most.acceleration));
  if (most.angular_speed > 0.0)
    out += fmt::format(
        "DEFAULT_ANGULAR_VELOCITY = {}\nMAX_ANGULAR_VELOCITY = {}\nDEFAULT_ANGULAR_ACCELERATION = {}\n"
        "MAX_ANGULAR_ACCELERATION = {}\n",
        number(0.5 * most.angular_speed), number(most.angular_speed), number(most.angular_acceleration),
        number(most.angular_acceleration));
  return out;
}

std::string joint(const HalAxis& a, std::size_t i) {
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
}

}  // namespace

std::string ini(const Configuration& c, bool screen) {
  std::string out = c.comment;
  const Fastest most = fastest_of(c);
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
    out += axis_screen(most, geometry);
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
  out += trajectory(most, coordinates);
  out += fmt::format("\n[KINS]\nKINEMATICS = trivkins coordinates={}\nJOINTS = {}\n", lower, c.axes.size());
  return out + each(c.axes, joint);
}

}  // namespace stribeck::targets::linuxcnc
