// Friction of simulators that other people use.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include <stribeck/targets/steady/approximation.hpp>

namespace stribeck::targets {

namespace {

Form mujoco(const Axis& axis) {
  const Line line = nearest_line(axis);
  Form form;
  form.mass = true;
  form.text = fmt::format(
      "<joint name=\"{}\" type=\"slide\" axis=\"1 0 0\" frictionloss=\"{:.9g}\" damping=\"{:.9g}\"/>\n"
      "<!-- mass of the body on this joint: {:.9g} kg -->\n",
      axis.name, line.level, line.viscous, axis.model.mass);
  form.held = [line](double v) { return signed_force(line.at(std::abs(v)), v); };
  form.to_do =
      "Put the joint into the body of the axis in the MJCF file. MuJoCo has one friction for both directions.";
  return form;
}

Form modelica(const Axis& axis) {
  constexpr std::size_t kMost = 20;
  std::vector<Corner> points = nearest_points(axis, kMost);
  // The table of the library begins at rest.
  points.front().x = 0.0;
  Form form;
  std::string table;
  for (const Corner& c : points)
    table += fmt::format("{}{:.9g}, {:.9g}", table.empty() ? "" : "; ", c.x, c.y);
  form.mass = true;
  form.text = fmt::format(
      "Modelica.Mechanics.Translational.Components.SupportFriction {0}_friction(f_pos=[{1}], peak=1);\n"
      "Modelica.Mechanics.Translational.Components.Mass {0}_mass(m={2:.9g});\n",
      axis.name, table, axis.model.mass);
  form.held = [points](double v) { return signed_force(interpolated(points, std::abs(v)), v); };
  form.to_do =
      "Declare both in the model and connect the flanges. The table has speed in m/s and force in N, for both directions.";
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
  const auto squares = [&](const Simscape& s) {
    constexpr int kSpeeds = 400;
    double sum = 0.0;
    for (int i = 0; i <= kSpeeds; ++i) {
      const double v = axis.slowest + (axis.fastest - axis.slowest) * i / kSpeeds;
      const double off = s.at(v) - mean(v);
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
  Form form;
  form.mass = true;
  form.text = fmt::format(
      "brkwy_frc = {:.9g}   N\nCol_frc = {:.9g}   N\nbrkwy_vel = {:.9g}   m/s\nvisc_coef = {:.9g}   N/(m/s)\n% mass = {:.9g} kg\n",
      best.breakaway, best.coulomb, best.speed, best.viscous, axis.model.mass);
  form.held = [best](double v) { return signed_force(best.at(std::abs(v)), v); };
  form.to_do =
      "Parameters of Simscape's block Translational Friction; it has one friction for both directions.";
  return form;
}

}  // namespace

extern const SteadyTarget kMujoco;
const SteadyTarget kMujoco{"mujoco", "frictionloss and damping of a MuJoCo joint", "<!--",
                           SteadyNeeds::kNothing, mujoco};
extern const SteadyTarget kModelica;
const SteadyTarget kModelica{"modelica", "friction table of a Modelica axis", "//", SteadyNeeds::kNothing,
                             modelica};
extern const SteadyTarget kSimscape;
const SteadyTarget kSimscape{"simscape", "parameters of Simscape's Translational Friction", "%",
                             SteadyNeeds::kNothing, simscape};

}  // namespace stribeck::targets
