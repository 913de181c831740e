// Friction compensations that controls and drives have of their own. Their parameters are told by the manuals that
// docs/guides/export.md names.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include <stribeck/core/number_text.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/targets/steady/approximation.hpp>
#include <stribeck/targets/steady/drive_words.hpp>
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

/// The forces of a table as the ISG kernel takes them: whole numbers, times a scaling factor in 0.1 %.
struct IsgScale {
  int factor = 1000;  ///< frict_comp.scaling_factor
  double unit = 1.0;  ///< force of a one in the table [N]
};

/// The largest factor with which a thousand steps remain below the largest force. With 1 they are thousandths of the control's unit.
IsgScale isg_scale(const Axis& axis, const std::vector<Corner>& points) {
  constexpr double kSteps = 1000.0;
  constexpr double kMost = 2147483647.0;  // SGN32
  double largest = 0.0;
  for (const Corner& c : points) largest = std::max(largest, std::abs(c.y));
  IsgScale scale{1000, axis.gain};
  while (scale.factor > 1 && largest < kSteps * scale.unit) {
    scale.factor /= 10;
    scale.unit *= 0.1;
  }
  if (!(largest <= kMost * scale.unit))
    workflow::refuse_option(
        "--gain",
        fmt::format(
            "friction would be frict_comp.table[].out = {:.4g}, expected at most {:.0f} (check the gain)",
            largest / scale.unit, kMost));
  return scale;
}

Form isg(const Axis& axis) {
  constexpr std::size_t kMost = 20;
  std::vector<Corner> points = nearest_points(axis, kMost);
  const IsgScale scale = isg_scale(axis, points);
  double last = -1.0;
  for (Corner& c : points) {
    last = std::max(std::round(1e6 * c.x), last + 1.0);  // two points of one speed would be a step
    c.x = 1e-6 * last;
    c.y = scale.unit * std::round(c.y / scale.unit);
  }
  Form form;
  form.text =
      fmt::format("frict_comp.mode    3\nfrict_comp.table_entries    {}\nfrict_comp.scaling_factor    {}\n",
                  points.size(), scale.factor);
  for (std::size_t i = 0; i < points.size(); ++i) {
    form.text += fmt::format("frict_comp.table[{0}].in    {1:.0f}\nfrict_comp.table[{0}].out   {2:.0f}\n", i,
                             1e6 * points[i].x, points[i].y / scale.unit);
  }
  form.held = [points](double v) { return signed_force(interpolated(points, std::abs(v)), v); };
  form.to_do = fmt::format(
      "Goes into the compensation value list of the axis; in the axis parameter list, lr_param.frict_comp 1 (P-AXIS-00522) switches it on. "
      ".in counts µm/s, .out steps of {:g} {}: whole numbers, because builds before V3.1.3132.0 (ISG V4.29.0) take no others; scaling_factor, in "
      "0.1 %, brings them to {}. Check first in which unit the drive takes the additive current. reversal_lookahead and position_delay come with "
      "--controller, which tells the loop, or are found on the circle. position_delay counts 0.1 µm; the pages of the maker permit 0 to 10 and "
      "have 30 in an example: where a larger number is written, check whether your build takes it.{}",
      1e-3 * scale.factor, axis.unit, axis.unit, words_of_drive_loop(axis));
  return form;
}

/// Weights of the force: in cycles before a reversal, in 0.1 µm after it.
std::string isg_build_up(TableForce& table, double period) {
  constexpr double kUnit = 1e-7;
  const double cycles = std::round(table.look_ahead / period);
  const double distance = std::round(table.build_up / kUnit);
  table.look_ahead = cycles * period;
  table.build_up = distance * kUnit;
  constexpr double kPermitted = 10.0;
  return fmt::format(
      "frict_comp.reversal_lookahead   {:.0f}\nfrict_comp.position_delay   {:.0f}\n{}", cycles, distance,
      distance > kPermitted
          ? "# position_delay: the pages of the maker permit 0 to 10, check whether your build takes more\n"
          : "");
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
      "Goes into object 3144:03 of the AX8000, which holds what grows with the speed. The {} that do not grow with it belong to "
      "3144:02, static friction torque: {} N m at {}. With 3144:01, static friction spring rate, it is not written: check first in "
      "the manual how the drive lets both act at a reversal. The torque offset of --to cia402 is the whole friction: use that one or these objects, not both. "
      "3141:08 shows the feed-forward that acts.{}",
      ident::Shown("m", "N", axis.rotary).force(line.level),
      report::significant(line.level * radius / motors, 4),
      motors > 1 ? fmt::format("each of the {} motors", motors) : "the motor",
      motors > 1 ? fmt::format(" The factor is that of one motor too: {} says that the axis has {}.",
                               axis.file, motors)
                 : "");
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
    points.push_back({at * tenth, axis.gain * number_in(fmt::format("{:.2f}", force / axis.gain))});
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
      "Goes into the friction table of the ServoOne: CON_SCON_TFric (ID 386) in % of the rated torque of the motor, at the speeds of CON_SCON_TFricSpeed "
      "(ID 387) in rpm, indexes 0 to 4. The load is not in it: its place is CON_SCON_TConst (ID 388). Check first with half the values on the circle; "
      "indexes 3 and 4 act while accelerating alone.";
  return form;
}

Form mitsubishi(const Axis& axis) {
  // The standard setting is twice the friction torque: the step at the reversal is from −F to F, and of unlike directions it is the sum of
  // both, at either reversal.
  constexpr double kMost = 100.0;  // half of the 200 that the manual permits
  const Levels unlike = levels_of(axis, 0.01, false);
  const double wanted = 0.5 * std::round(unlike.positive + unlike.negative);
  const double level = std::min(wanted, kMost);
  Form form;
  form.text = fmt::format("SV027 bit 9 = 1\nSV016 = {:.0f}\nSV041 = 0\n", 2.0 * level);  // 0: as SV016
  form.held = [level, unit = axis.gain](double v) { return signed_force(unit * level, v); };
  form.to_do = fmt::format(
      "Servo parameters, lost-motion compensation type 2; SV016 counts {} of the stall current, twice the friction that does not grow with "
      "the speed. Check first with "
      "half the value on the circle: too much cuts into the contour.",
      axis.unit);
  if (std::abs(unlike.positive - unlike.negative) > 0.5)
    form.to_do += fmt::format(
        " Friction of axis {} is {:.3g} forward and {:.3g} backward: the step at either reversal is their sum, and half of their "
        "difference is an unbalance torque, which has a parameter of its own.",
        axis.name, unlike.positive, unlike.negative);
  if (wanted > kMost)
    form.to_do += fmt::format(
        " Axis {} would need {:.0f}, and the parameter takes at most 200, which is written: check --gain.",
        axis.name, 2.0 * wanted);
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
const SteadyTarget kKeba{.name = "keba",
                         .what = "friction table of the ServoOne, 5 points",
                         .comment = "#",
                         .needs = SteadyNeeds::kGainAndLead,
                         .write = keba,
                         .counts = GainUnit::kPercent};
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
