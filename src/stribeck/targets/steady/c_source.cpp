#include <fmt/format.h>
#include <algorithm>

#include <stribeck/io/error.hpp>
#include <stribeck/targets/steady/drive_words.hpp>
#include <stribeck/targets/steady/table_source.hpp>

namespace stribeck::targets {

namespace {

/// The force of a motion, without bristles: x_force(acceleration, velocity, position).
std::string plain_force(const std::string& axis) {
  return fmt::format(
      "/* Force [N] for a motion of the command: acceleration [m/s2]. */\n"
      "static double {0}_force(double acceleration, double velocity, double position) {{\n"
      "  return {0}_mass * acceleration + {0}_friction(velocity, position) + {0}_load;\n"
      "}}\n",
      axis);
}

/// Numbers of the stops, in two arrays, or of the one bristle.
std::string bristle_constants(const std::string& axis, const friction::BuildUp& bristles) {
  if (bristles.stops.empty())
    return fmt::format("static const double {}_distance = {:.9e}; /* m/N */\n", axis, bristles.distance);
  const StopLists stops = lists_of(bristles);
  const std::size_t count = bristles.stops.size();
  return fmt::format(
      "static const double {0}_weight[{1}] = {{{2}}}; /* share of the friction */\n"
      "static const double {0}_stiffness[{1}] = {{{3}}}; /* N/m */\n",
      axis, count, stops.weights, stops.stiffness);
}

/// The same with friction that builds up after a reversal (pre_sliding.hpp): x_force(memory, acceleration, velocity, position).
std::string force_with_memory(const std::string& axis, const friction::BuildUp& bristles) {
  const std::size_t count = std::max<std::size_t>(bristles.stops.size(), 1);
  std::string out =
      bristle_constants(axis, bristles) +
      fmt::format(
          "/* What the axis remembers; begin with zeros: struct {0}_memory m = {{0}}; */\n"
          "struct {0}_memory {{\n"
          "  int begun, backward;\n"
          "  double before;    /* m */\n"
          "  double built[{1}]; /* N */\n"
          "}};\n"
          "/* Force [N] for a motion of the command: acceleration [m/s2]. Once in every cycle, also at standstill. */\n"
          "static double {0}_force(struct {0}_memory *m, double acceleration, double velocity, double position) {{\n"
          "  const double change = position - m->before;\n"
          "  /* A position that wraps, or is set anew, goes against the velocity. */\n"
          "  const double travel = m->begun && change * velocity > 0.0 ? change : 0.0;\n"
          "  double level, other, friction = 0.0;\n"
          "  m->begun = 1;\n"
          "  m->before = position;\n"
          "  if (velocity != 0.0) m->backward = velocity < 0.0;\n"
          "  {0}_parts(velocity, m->backward, position, &level, &other);\n",
          axis, count);
  if (bristles.stops.empty()) {
    out += fmt::format(
        "  if (level > 0.0 && travel != 0.0) {{\n"
        "    const double sliding = travel > 0.0 ? level : -level;\n"
        "    m->built[0] = sliding + (m->built[0] - sliding) * exp(-fabs(travel) / ({0}_distance * level));\n"
        "  }}\n"
        "  friction = m->built[0];\n",
        axis);
  } else {
    out += fmt::format(
        "  for (int i = 0; i < {1}; ++i) {{\n"
        "    if (level > 0.0) {{\n"
        "      const double most = {0}_weight[i] * level, now = m->built[i] + {0}_stiffness[i] * travel;\n"
        "      m->built[i] = travel > 0.0 && now > most ? most : travel < 0.0 && now < -most ? -most : now;\n"
        "    }}\n"
        "    friction += m->built[i];\n"
        "  }}\n",
        axis, count);
  }
  return out + fmt::format("  return {0}_mass * acceleration + friction + other + {0}_load;\n}}\n", axis);
}

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
      "/* Friction against the motion [N], and forces that do not turn with it. */\n"
      "static void {0}_parts(double velocity, int backward, double position, double *against, double *beside) {{\n"
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
      "  *against = level + (backward ? {0}_at({0}_negative_speed, {0}_negative_force, {2}, -velocity)\n"
      "                               : {0}_at({0}_positive_speed, {0}_positive_force, {1}, velocity));\n"
      "  *beside = other;\n"
      "}}\n"
      "/* Friction [N] while sliding at a velocity [m/s] and a position [m], as in the log that it was identified from. */\n"
      "static inline double {0}_friction(double velocity, double position) {{\n"
      "  double level, other;\n"
      "  {0}_parts(velocity, velocity < 0.0, position, &level, &other);\n"
      "  return other + (velocity > 0.0 ? level : velocity < 0.0 ? -level : 0.0);\n"
      "}}\n",
      n, tables.positive.size(), tables.negative.size());
  form.bristles = friction::build_up_of(axis.model.friction.dynamics);
  form.pre_sliding = form.bristles.has_value();
  form.text += form.bristles ? force_with_memory(n, *form.bristles) : plain_force(n);
  form.to_do =
      form.bristles
          ? "Include the file, keep a struct NAME_memory for each axis, call NAME_force() once in every "
            "cycle with the commanded motion, and add it to "
          : "Include the file and add NAME_force() of the commanded motion to ";
  form.to_do +=
      place_of_force(axis, "the force of the position loop") +
      ". Check its sign first: at a constant positive velocity it must push in the positive direction." +
      words_of_end(axis, tables) + words_of_drive_loop(axis);
  return form;
}

/// Beside axis x, whose table is x_positive_force, the function of an axis x_positive would have the same name.
void check_c_names(const std::vector<Axis>& axes) {
  for (const Axis& one : axes) {
    for (const Axis& other : axes) {
      if (other.name == one.name + "_positive" || other.name == one.name + "_negative")
        throw io::InputError(
            {other.file, 0, "axis",
             fmt::format(
                 "{0}_force of axis {0} would be the name of a table of axis {1} (give another name, --name)",
                 other.name, one.name)});
    }
  }
}

}  // namespace

extern const SteadyTarget kC;
const SteadyTarget kC{.name = "c",
                      .what = "C source with fixed tables",
                      .comment = "/*",
                      .write = write_c,
                      .on_circle = true,
                      .check_names = check_c_names};

}  // namespace stribeck::targets
