// --to ros2_control: tables of friction as parameters in YAML, and beside them the controller that adds it to an effort command.
#include <fmt/format.h>

#include <stribeck/targets/ros2/source.hpp>
#include <stribeck/targets/steady/drive_words.hpp>
#include <stribeck/targets/steady/table_source.hpp>

namespace stribeck::targets {

namespace {

/// Units of a joint: a slide in m and N, or with --lead the motor in rad and N m.
struct JointUnits {
  double radius = 1.0;  ///< travel of the axis per unit of the joint [m]
  const char* position = "m";
  const char* force = "N";
  const char* mass = "kg";
};

JointUnits joint_units(const Axis& axis) {
  if (std::isnan(axis.lead)) return {};
  return {axis.lead / (2.0 * kPi), "rad", "N m", "kg m2"};
}

std::vector<Corner> joint_table(const std::vector<Corner>& points, double radius) {
  std::vector<Corner> out;
  for (const Corner& c : points) {
    out.push_back({with_digits(c.x / radius, 10), with_digits(c.y * radius, 10)});
  }
  return out;
}

std::string list_line(const char* key, const std::string& numbers, const std::string& unit) {
  return fmt::format("      {}: [{}]{}\n", key, numbers, unit.empty() ? "" : "  # " + unit);
}

std::string joint_periodic(const Axis& axis, const JointUnits& u) {
  std::string amplitude, period, phase, proportional;
  for (const auto& t : axis.model.friction.eccentric) {
    const char* comma = amplitude.empty() ? "" : ", ";
    amplitude += fmt::format("{}{:.9e}", comma, t.amplitude * u.radius);
    period += fmt::format("{}{:.9e}", comma, t.period / u.radius);
    phase += fmt::format("{}{:.9e}", comma, t.phase);
    proportional += fmt::format("{}{}", comma, t.form == friction::EccentricForm::kProportional);
  }
  if (amplitude.empty()) return {};
  return list_line("amplitude", amplitude, u.force) + list_line("period", period, u.position) +
         list_line("phase", phase, "rad") +
         list_line("proportional", proportional, "to the sign of the velocity");
}

std::string joint_spring(const Axis& axis, const JointUnits& u) {
  const auto& spring = axis.model.friction.spring;
  if (!spring) return {};
  return fmt::format("      spring_stiffness: {:.9e}  # {}/{}\n", spring->stiffness * u.radius * u.radius,
                     u.force, u.position) +
         list_line("spring_positions",
                   fmt::format("{:.9e}, {:.9e}, {:.9e}", spring->lowest() / u.radius,
                               spring->zero_at / u.radius, spring->highest() / u.radius),
                   fmt::format("{}: lowest, without force, highest", u.position));
}

Form ros2_form(const Axis& axis) {
  const JointUnits u = joint_units(axis);
  const SourceTables tables(axis);
  const std::vector<Corner> positive = joint_table(tables.positive, u.radius);
  const std::vector<Corner> negative = joint_table(tables.negative, u.radius);
  Form form;
  form.periodic = form.mass = form.load = true;
  form.held = [=](double v) {
    const std::vector<Corner>& side = v < 0.0 ? negative : positive;
    return signed_force(interpolated(side, std::abs(v) / u.radius) / u.radius, v);
  };
  // Quoted: y is a boolean in YAML 1.1.
  form.text = fmt::format("    \"{}\":\n      mass: {:.9e}  # {}\n      load: {:.9e}  # {}\n", axis.name,
                          axis.model.mass * u.radius * u.radius, u.mass, axis.model.load * u.radius, u.force);
  const std::string speed = fmt::format("{}/s", u.position);
  form.text += list_line("speed_positive", speeds_of(positive), speed) +
               list_line("force_positive", forces_of(positive), u.force) +
               list_line("speed_negative", speeds_of(negative), speed) +
               list_line("force_negative", forces_of(negative), u.force) + joint_periodic(axis, u) +
               joint_spring(axis, u);
  form.to_do =
      std::string(
          "Give the YAML file to the controller manager, and friction_feedforward.cpp to a package of yours; its head tells what else the "
          "package needs. The controller before it writes effort and the commanded velocity into its references. Nothing here was tried "
          "under ROS. Check first that at a constant positive velocity it adds a positive effort.") +
      words_of_drive_loop(axis);
  return form;
}

std::string ros2_head(const std::vector<Axis>& axes) {
  std::string joints;
  for (const Axis& a : axes) joints += fmt::format("{}\"{}\"", joints.empty() ? "" : ", ", a.name);
  return fmt::format(
      "controller_manager:\n  ros__parameters:\n    friction_feedforward:\n"
      "      type: stribeck_friction/FrictionFeedforward\n"
      "friction_feedforward:\n  ros__parameters:\n    joints: [{}]\n",
      joints);
}

}  // namespace

extern const SteadyTarget kRos2Control;
const SteadyTarget kRos2Control{
    .name = "ros2_control",
    .what = "parameters for ros2_control in YAML, and the controller that uses them in C++",
    .comment = "#",
    .write = ros2_form,
    .extension = ".yaml",
    .head = ros2_head,
    .beside = Beside{"friction_feedforward.cpp", kFrictionFeedforward},
    .takes_lead = true};

}  // namespace stribeck::targets
