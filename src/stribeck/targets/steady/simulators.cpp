// Friction of simulators that other people use.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include <stribeck/targets/steady/approximation.hpp>

namespace stribeck::targets {

namespace {

/// A number as these texts show it.
double shown(double value) { return with_digits(value, 9); }

Form mujoco(const Axis& axis) {
  Line line = nearest_line(axis);
  line.level = shown(line.level);
  line.viscous = shown(line.viscous);
  Form form;
  form.mass = true;
  form.text = fmt::format(
      "    <body name=\"{0}\">\n"
      "      <joint name=\"{0}\" type=\"slide\" axis=\"1 0 0\" frictionloss=\"{1:.9g}\" damping=\"{2:.9g}\"/>\n"
      "      <geom type=\"box\" size=\"0.1 0.1 0.1\" mass=\"{3:.9g}\" contype=\"0\" conaffinity=\"0\"/>\n"
      "    </body>\n",
      axis.name, line.level, line.viscous, axis.model.mass);
  form.held = [line](double v) { return signed_force(line.at(std::abs(v)), v); };
  form.to_do =
      "The file is a model of its own, with one body for each axis; put its joint into the body of your axis. MuJoCo has one friction for both "
      "directions, and a body at rest creeps, because its constraints are soft. Check first the step of the simulation: 1 ms or less.";
  return form;
}

std::vector<Corner> shown(std::vector<Corner> points) {
  for (Corner& c : points) c = {shown(c.x), shown(c.y)};
  return points;
}

/// Rows "speed, force" of a matrix of Modelica.
std::string modelica_table(const std::vector<Corner>& points) {
  std::string table;
  for (const Corner& c : points)
    table += fmt::format("{}{:.9g}, {:.9g}", table.empty() ? "" : "; ", c.x, c.y);
  return table;
}

Form modelica(const Axis& axis) {
  constexpr std::size_t kMost = 20;
  std::vector<Corner> points = shown(nearest_points(axis, kMost));
  // The table of the library begins at rest.
  points.front().x = 0.0;
  Form form;
  form.mass = true;
  if (std::isnan(axis.lead)) {
    form.text = fmt::format(
        "Modelica.Mechanics.Translational.Components.SupportFriction {0}_friction(f_pos=[{1}], peak=1);\n"
        "Modelica.Mechanics.Translational.Components.Mass {0}_mass(m={2:.9g});\n",
        axis.name, modelica_table(points), axis.model.mass);
    form.to_do =
        "Declare both in the model and connect the flanges. The table has speed in m/s and force in N, for both directions. --lead writes "
        "BearingFriction at the motor instead. Check first that a constant velocity needs the force of the table.";
  } else {
    // At the motor: w = v·2π/lead, torque = force·lead/2π.
    const double radius = axis.lead / (2.0 * kPi);
    for (Corner& c : points) c = {shown(c.x / radius), shown(c.y * radius)};
    form.text = fmt::format(
        "Modelica.Mechanics.Rotational.Components.BearingFriction {0}_friction(tau_pos=[{1}], peak=1);\n"
        "Modelica.Mechanics.Rotational.Components.Inertia {0}_inertia(J={2:.9g});\n",
        axis.name, modelica_table(points), axis.model.mass * radius * radius);
    for (Corner& c : points) c = {c.x * radius, c.y / radius};
    form.to_do =
        "Declare both in the model and connect the flanges. The table has speed in rad/s and torque in N m at the motor, for both "
        "directions. Check first that a constant speed needs the torque of the table.";
  }
  form.held = [points](double v) { return signed_force(interpolated(points, std::abs(v)), v); };
  return form;
}

/// Simscape's translational friction at a speed.
struct Simscape {
  double breakaway = 0.0;
  double coulomb = 0.0;
  double speed = 1.0;  ///< breakaway friction velocity [m/s]
  double viscous = 0.0;

  [[nodiscard]] double at(double v) const noexcept {
    const double stribeck = v / (speed * std::sqrt(2.0));
    const double arctangent = v / (speed / 10.0);
    return std::sqrt(2.0 * std::exp(1.0)) * (breakaway - coulomb) * std::exp(-stribeck * stribeck) *
               stribeck +
           coulomb * std::tanh(arctangent) + viscous * v;
  }
};

Form simscape(const Axis& axis) {
  const auto mean = [&](double v) { return 0.5 * (axis.friction(v) - axis.friction(-v)); };
  // Speeds in equal ratios, since the part of Stribeck is a small part of the range. Below its breakaway velocity the block passes through
  // zero, whatever its numbers: what counts there is the level from which it falls.
  const auto squares = [&](const Simscape& s) {
    constexpr int kSpeeds = 400;
    double sum = 0.0;
    for (int i = 0; i <= kSpeeds; ++i) {
      const double v = axis.slowest * std::pow(axis.fastest / axis.slowest, static_cast<double>(i) / kSpeeds);
      const double off = (v < s.speed ? s.breakaway : s.at(v)) - mean(v);
      sum += off * off;
    }
    return sum;
  };
  // The Stribeck speed by a search over its logarithm; for each, level and slope from the upper half of the speeds.
  Simscape best;
  double least = -1.0;
  Axis upper = axis;
  for (int i = 0; i <= 60; ++i) {
    Simscape s;
    s.speed = axis.slowest * std::pow(axis.fastest / axis.slowest, i / 60.0) / 3.0;
    upper.slowest = std::min(std::max(6.0 * s.speed, axis.slowest), 0.7 * axis.fastest);
    const Line line = nearest_line(upper);
    s.coulomb = line.level;
    s.viscous = line.viscous;
    s.breakaway = std::max(mean(std::max(s.speed, axis.slowest)), s.coulomb);
    const double sum = squares(s);
    if (least >= 0.0 && sum >= least) continue;
    least = sum;
    best = s;
  }
  best = {shown(best.breakaway), shown(best.coulomb), shown(best.speed), shown(best.viscous)};
  Form form;
  form.mass = true;
  form.text = fmt::format(
      "brkwy_frc = {:.9g}   N\nCol_frc = {:.9g}   N\nbrkwy_vel = {:.9g}   m/s\nvisc_coef = {:.9g}   N/(m/s)\n% mass = {:.9g} kg\n",
      best.breakaway, best.coulomb, best.speed, best.viscous, axis.model.mass);
  form.held = [best](double v) { return signed_force(best.at(std::abs(v)), v); };
  form.from = best.speed;
  form.to_do =
      "Parameters of Simscape's block Translational Friction; it has one friction for both directions, and passes through zero within a "
      "tenth of brkwy_vel. Check first that the variables have these units in the block.";
  return form;
}

}  // namespace

extern const SteadyTarget kMujoco;
const SteadyTarget kMujoco{
    .name = "mujoco",
    .what = "MJCF model with frictionloss and damping of MuJoCo joints",
    .comment = "<!--",
    .write = mujoco,
    .extension = ".xml",
    .begin = "<mujoco model=\"axes\">\n  <option timestep=\"0.001\" gravity=\"0 0 0\"/>\n  <worldbody>\n",
    .end = "  </worldbody>\n</mujoco>\n",
    .simulator = true,
    .linear_only = true};
extern const SteadyTarget kModelica;
const SteadyTarget kModelica{.name = "modelica",
                             .what = "friction table of a Modelica axis",
                             .comment = "//",
                             .write = modelica,
                             .simulator = true,
                             .takes_lead = true,
                             .linear_only = true};
extern const SteadyTarget kSimscape;
const SteadyTarget kSimscape{.name = "simscape",
                             .what = "parameters of Simscape's Translational Friction",
                             .comment = "%",
                             .write = simscape,
                             .simulator = true,
                             .linear_only = true};

}  // namespace stribeck::targets
