#include <fmt/format.h>

#include <stribeck/targets/steady/table_source.hpp>

namespace stribeck::targets {

namespace {

Form write_c(const Axis& axis) {
  const SourceTables tables(axis);
  Form form;
  form.held = [tables](double v) { return tables.at(v); };
  form.periodic = form.mass = form.load = true;
  const std::string& n = axis.name;
  const auto arrays = [&](const char* side, const std::vector<Corner>& points) {
    return fmt::format(
        "static const double {0}_{1}_speed[{2}] = {{{3}}}; /* m/s */\n"
        "static const double {0}_{1}_force[{2}] = {{{4}}}; /* N */\n",
        n, side, points.size(), speeds_of(points), forces_of(points));
  };
  form.text = "#include <math.h>\n";
  form.text += fmt::format(
      "static const double {}_mass = {:.9e}; /* kg */\nstatic const double {}_load = {:.9e}; /* N */\n", n,
      axis.model.mass, n, axis.model.load);
  form.text += arrays("positive", tables.positive) + arrays("negative", tables.negative);
  form.text += fmt::format(
      "static double {0}_at(const double *speed, const double *force, int count, double s) {{\n"
      "  int i = 1;\n"
      "  if (s <= speed[0]) return force[0];\n"
      "  if (s >= speed[count - 1]) return force[count - 1];\n"
      "  while (s > speed[i]) ++i;\n"
      "  return force[i - 1] + (force[i] - force[i - 1]) * (s - speed[i - 1]) / (speed[i] - speed[i - 1]);\n"
      "}}\n"
      "/* Friction [N] at a velocity [m/s] and a position [m], as in the log that it was identified from. */\n"
      "static double {0}_friction(double velocity, double position) {{\n"
      "  double level = 0.0, other = 0.0;\n",
      n);
  for (const auto& t : axis.model.friction.eccentric) {
    form.text += fmt::format("  {} += {:.9e} * sin({:.9e} * position - {:.9e});\n",
                             t.form == friction::EccentricForm::kAdditive ? "other" : "level", t.amplitude,
                             2.0 * kPi / t.period, t.phase);
  }
  if (const auto& spring = axis.model.friction.spring)
    form.text += fmt::format(
        "  other += {0:.9e} * ((position < {2:.9e} ? {2:.9e} : position > {3:.9e} ? {3:.9e} : position) - {1:.9e});\n",
        spring->stiffness, spring->zero_at, spring->lowest(), spring->highest());
  form.text += fmt::format(
      "  (void)position;\n"
      "  if (velocity > 0.0) return other + level + {0}_at({0}_positive_speed, {0}_positive_force, {1}, velocity);\n"
      "  if (velocity < 0.0) return other - level - {0}_at({0}_negative_speed, {0}_negative_force, {2}, -velocity);\n"
      "  return other;\n"
      "}}\n"
      "/* Force [N] for a motion of the command: acceleration [m/s2]. */\n"
      "static double {0}_force(double acceleration, double velocity, double position) {{\n"
      "  return {0}_mass * acceleration + {0}_friction(velocity, position) + {0}_load;\n"
      "}}\n",
      n, tables.positive.size(), tables.negative.size());
  form.to_do =
      "Include the file and add NAME_force() of the commanded motion to the force of the position loop. Check its sign first: "
      "at a constant positive velocity it must push in the positive direction.";
  return form;
}

}  // namespace

extern const SteadyTarget kC;
const SteadyTarget kC{"c", "C source with fixed tables", "/*", SteadyNeeds::kNothing, write_c};

}  // namespace stribeck::targets
