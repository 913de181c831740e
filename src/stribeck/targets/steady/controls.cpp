// Friction compensations that controls and drives have of their own. Their parameters are told by the manuals that
// docs/guides/export.md names.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include <stribeck/ident/shown.hpp>
#include <stribeck/targets/steady/approximation.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::targets {

namespace {

/// Coulomb friction by direction, in steps of the control's number: the level of the nearest line, without what grows with the speed,
/// because these numbers act at a reversal, or beside a feed-forward of the speed.
struct Levels {
  double positive = 0.0;  ///< [control's unit]
  double negative = 0.0;
  std::function<double(double)> held;
};
Levels levels_of(const Axis& axis, double step, bool both) {
  const double unit = axis.gain;
  const auto rounded = [&](double direction) {
    const Line line = direction == 0.0 ? nearest_line(axis) : nearest_line(axis, direction);
    return step * std::round(line.level / unit / step);
  };
  Levels l;
  l.positive = rounded(both ? 0.0 : 1.0);
  l.negative = rounded(both ? 0.0 : -1.0);
  l.held = [=](double v) { return signed_force(unit * (v < 0.0 ? l.negative : l.positive), v); };
  return l;
}

/// Points over the speed for both directions, forces in the control's unit with the given decimals.
std::vector<Corner> rounded_points(const Axis& axis, std::size_t points, int decimals) {
  std::vector<Corner> out = nearest_points(axis, points);
  for (Corner& c : out) c.y = axis.gain * std::stod(fmt::format("{:.{}f}", c.y / axis.gain, decimals));
  return out;
}

Form isg(const Axis& axis) {
  constexpr std::size_t kMost = 20;
  std::vector<Corner> points = rounded_points(axis, kMost, 3);
  double last = -1.0;
  for (Corner& c : points) {
    last = std::max(std::round(1e6 * c.x), last + 1.0);  // two points of one speed would be a step
    c.x = 1e-6 * last;
  }
  Form form;
  for (std::size_t i = 0; i < points.size(); ++i) {
    form.text += fmt::format("frict_comp.table[{0}].in    {1:.0f}\nfrict_comp.table[{0}].out   {2:.3f}\n", i,
                             1e6 * points[i].x, points[i].y / axis.gain);
  }
  form.held = [points](double v) { return signed_force(interpolated(points, std::abs(v)), v); };
  form.to_do = fmt::format(
      "Goes into the axis parameter list, with P-AXIS-00522 on; .in counts µm/s, .out counts {}. Check first in which unit the drive "
      "takes the additive current. reversal_lookahead and position_delay come with --controller, which tells the loop, or are found on the "
      "circle; position_delay counts 0.1 µm here: check that in the manual of the control, because its pages differ.",
      axis.unit);
  return form;
}

/// Weights of the force: in cycles before a reversal, in 0.1 µm after it.
std::string isg_build_up(TableForce& table, double period) {
  constexpr double kUnit = 1e-7;
  const double cycles = std::round(table.look_ahead / period);
  const double distance = std::round(table.build_up / kUnit);
  table.look_ahead = cycles * period;
  table.build_up = distance * kUnit;
  return fmt::format("frict_comp.reversal_lookahead   {:.0f}\nfrict_comp.position_delay   {:.0f}\n", cycles,
                     distance);
}

Form ax8000(const Axis& axis) {
  // Torque of one motor per angular speed of the motor.
  const double radius = axis.lead / (2.0 * kPi);
  const int motors = axis.drive ? axis.drive->motors.value_or(1) : 1;
  const Line line = nearest_line(axis);
  const double factor = with_digits(line.viscous * radius * radius / motors, 6);
  Form form;
  form.text = fmt::format("3144:03 = {:.6g} (N m s/rad, dynamic friction factor)\n", factor);
  form.held = [=](double v) { return motors * factor / (radius * radius) * v; };
  form.to_do = fmt::format(
      "Goes into object 3144:03 of the AX8000. It holds viscous friction alone: {} that do not grow with the speed are not in it. The "
      "torque offset of --to cia402 is the whole friction: use that one or this one, not both. 3141:08 shows the feed-forward that acts.",
      ident::Shown("m", "N", axis.rotary).force(line.level));
  return form;
}

/// Points at whole tenths of a turn per minute, each at the friction of its speed.
std::vector<Corner> points_at_tenths(const Axis& axis, std::size_t most) {
  const double tenth = axis.lead / 600.0;  // [m/s]
  std::vector<Corner> points;
  for (const Corner& c : nearest_points(axis, most)) {
    const double last = points.empty() ? -1.0 : std::round(points.back().x / tenth);
    const double at = std::max(std::round(c.x / tenth), last + 1.0);
    const double v = std::clamp(at * tenth, axis.slowest, axis.fastest);
    const double force = 0.5 * (axis.friction(v) - axis.friction(-v));
    points.push_back({at * tenth, axis.gain * std::stod(fmt::format("{:.2f}", force / axis.gain))});
  }
  return points;
}

Form keba(const Axis& axis) {
  constexpr std::size_t kMost = 5;
  const std::vector<Corner> points = points_at_tenths(axis, kMost);
  Form form;
  for (std::size_t i = 0; i < points.size(); ++i) {
    form.text += fmt::format("index {}: {:.1f} rpm, {:.2f} {}\n", i, 60.0 * points[i].x / axis.lead,
                             points[i].y / axis.gain, axis.unit);
  }
  form.held = [points](double v) { return signed_force(interpolated(points, std::abs(v)), v); };
  form.to_do =
      "Goes into the friction table of the ServoOne (indexes 0 to 4). Check first that the table counts in the unit of --gain; "
      "indexes 3 and 4 act while accelerating alone.";
  return form;
}

Form mitsubishi(const Axis& axis) {
  // The standard setting is twice the friction torque; the step at the reversal is from −F to F.
  Levels l = levels_of(axis, 0.5, false);
  // SV041 = 0 means the value of SV016.
  if (l.negative == 0.0 && l.positive != 0.0) l.negative = 0.5;
  Form form;
  form.text = fmt::format("SV027 bit 9 = 1\nSV016 = {:.0f}\nSV041 = {:.0f}\n", 2.0 * l.positive,
                          l.positive == l.negative ? 0.0 : 2.0 * l.negative);
  form.held = [l, unit = axis.gain](double v) {
    return signed_force(unit * (v < 0.0 ? l.negative : l.positive), v);
  };
  form.to_do = fmt::format(
      "Servo parameters, lost-motion compensation type 2; SV016 counts {} of the stall current, twice the friction that does not grow with "
      "the speed. Check first with "
      "half the value on the circle: too much cuts into the contour.",
      axis.unit);
  return form;
}

Form pmac(const Axis& axis) {
  const Levels l = levels_of(axis, 1.0, true);
  constexpr double kFull = 32767.0;
  const double largest = std::max(l.positive, l.negative);
  if (!(largest <= kFull))
    workflow::refuse_option(
        "--gain", fmt::format("friction would be Ixx68 = {:.4g}, expected at most {:g} (check the gain)",
                              largest, kFull));
  Form form;
  form.text = fmt::format("Ixx68 = {:.0f}\n", l.positive);
  form.held = l.held;
  form.to_do =
      "Ixx68 of the motor xx, in bits of its 16-bit output (32 767 are 100 %), by the sign of the commanded velocity. What grows with the "
      "speed is not in it: it belongs to the velocity feed-forward Ixx32.";
  return form;
}

Form indradrive(const Axis& axis) {
  const Levels l = levels_of(axis, 0.1, true);
  Form form;
  form.text = fmt::format("S-0-0155 = {:.1f} {}\n", l.positive, axis.unit);
  form.held = l.held;
  form.to_do =
      "S-0-0155, friction torque compensation. Check first what 100 % means in the drive, and compare the circle with half the "
      "value.";
  return form;
}

}  // namespace

extern const SteadyTarget kIsg;
const SteadyTarget kIsg{.name = "isg",
                        .what = "friction table of the ISG kernel and TwinCAT CNC (TF5200), 20 points",
                        .comment = "#",
                        .needs = SteadyNeeds::kGain,
                        .write = isg,
                        .build_up = isg_build_up,
                        .linear_only = true};
extern const SteadyTarget kAx8000;
const SteadyTarget kAx8000{"ax8000", "viscous friction factor of the AX8000", "#", SteadyNeeds::kLead,
                           ax8000};
extern const SteadyTarget kKeba;
const SteadyTarget kKeba{"keba", "friction table of the ServoOne, 5 points", "#", SteadyNeeds::kGainAndLead,
                         keba};
extern const SteadyTarget kMitsubishi;
const SteadyTarget kMitsubishi{.name = "mitsubishi",
                               .what = "lost-motion compensation type 2, SV016 and SV041",
                               .comment = "#",
                               .needs = SteadyNeeds::kGain,
                               .write = mitsubishi,
                               .counts = GainUnit::kPercent};
extern const SteadyTarget kPmac;
const SteadyTarget kPmac{.name = "pmac",
                         .what = "friction feed-forward Ixx68",
                         .comment = "#",
                         .needs = SteadyNeeds::kGain,
                         .write = pmac,
                         .counts = GainUnit::kBits};
extern const SteadyTarget kIndraDrive;
const SteadyTarget kIndraDrive{.name = "indradrive",
                               .what = "friction torque compensation S-0-0155",
                               .comment = "#",
                               .needs = SteadyNeeds::kGain,
                               .write = indradrive,
                               .counts = GainUnit::kPercent};

}  // namespace stribeck::targets
