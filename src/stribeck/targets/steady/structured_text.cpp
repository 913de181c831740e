#include <fmt/format.h>
#include <cmath>

#include <stribeck/targets/steady/table_source.hpp>

namespace stribeck::targets {

namespace {

std::string array_of(const std::string& name, const std::string& numbers, std::size_t count) {
  return fmt::format("  {} : ARRAY[0..{}] OF LREAL := [{}];\n", name, count - 1, numbers);
}

/// Function of IEC 61131-3. `result` is the type of what it returns, from the force F in N.
std::string function_of(const Axis& axis, const SourceTables& tables, const std::string& type,
                        const std::string& result) {
  const std::string& n = axis.name;
  std::string out = fmt::format(
      "FUNCTION {}_force : {}\n"
      "VAR_INPUT\n"
      "  acceleration : LREAL; (* of the command, m/s2 *)\n"
      "  velocity : LREAL; (* of the command, m/s *)\n"
      "  position : LREAL; (* of the command, m *)\n"
      "END_VAR\n"
      // Behind constants some compilers take these for constants too.
      "VAR\n"
      "  i : INT;\n"
      "  s, level, other, F : LREAL;\n"
      "END_VAR\n"
      "VAR CONSTANT\n"
      "  mass : LREAL := {:.9e}; (* kg *)\n"
      "  load : LREAL := {:.9e}; (* N *)\n",
      n, type, axis.model.mass, axis.model.load);
  out += array_of("speed_p", speeds_of(tables.positive), tables.positive.size());
  out += array_of("force_p", forces_of(tables.positive), tables.positive.size());
  out += array_of("speed_n", speeds_of(tables.negative), tables.negative.size());
  out += array_of("force_n", forces_of(tables.negative), tables.negative.size());
  out +=
      "END_VAR\n"
      "s := ABS(velocity);\n"
      "level := 0.0;\n"
      "other := 0.0;\n";
  const auto side = [&](const char* when, const char* side_of, std::size_t count) {
    const std::string speed = fmt::format("speed_{}", side_of);
    const std::string force = fmt::format("force_{}", side_of);
    return fmt::format(
        "{0} THEN\n"
        "  IF s <= {1}[0] THEN\n"
        "    level := {2}[0];\n"
        "  ELSIF s >= {1}[{3}] THEN\n"
        "    level := {2}[{3}];\n"
        "  ELSE\n"
        "    i := 1;\n"
        "    WHILE s > {1}[i] DO\n"
        "      i := i + 1;\n"
        "    END_WHILE;\n"
        "    level := {2}[i - 1] + ({2}[i] - {2}[i - 1]) * (s - {1}[i - 1]) / ({1}[i] - {1}[i - 1]);\n"
        "  END_IF;\n",
        when, speed, force, count - 1);
  };
  out += side("IF velocity > 0.0", "p", tables.positive.size());
  out += side("ELSIF velocity < 0.0", "n", tables.negative.size()) + "END_IF;\n";
  for (const auto& t : axis.model.friction.eccentric) {
    out += fmt::format("{0} := {0} + {1:.9e} * SIN({2:.9e} * position - {3:.9e});\n",
                       t.form == friction::EccentricForm::kAdditive ? "other" : "level", t.amplitude,
                       2.0 * kPi / t.period, t.phase);
  }
  if (const auto& spring = axis.model.friction.spring)
    out += fmt::format("other := other + {0:.9e} * (LIMIT({2:.9e}, position, {3:.9e}) - {1:.9e});\n",
                       spring->stiffness, spring->zero_at, spring->lowest(), spring->highest());
  out +=
      "IF velocity < 0.0 THEN\n"
      "  level := -level;\n"
      "ELSIF velocity = 0.0 THEN\n"
      "  level := 0.0;\n"
      "END_IF;\n"
      "F := mass * acceleration + level + other + load;\n";
  out += result;
  return out + "END_FUNCTION\n";
}

Form write_structured_text(const Axis& axis) {
  const SourceTables tables(axis);
  Form form;
  form.held = [tables](double v) { return tables.at(v); };
  form.periodic = form.mass = form.load = true;
  form.text = function_of(axis, tables, "LREAL", fmt::format("{}_force := F;\n", axis.name));
  form.to_do =
      "Call NAME_force in the cyclic task with the commanded motion and add its result to the force of the axis. Check its sign "
      "first: at a constant positive velocity it must push in the positive direction.";
  return form;
}

/// CiA 402 counts 60B2h in thousandths of the rated torque.
Form write_per_mille(const Axis& axis) {
  const double unit = axis.gain;
  const SourceTables tables(axis);
  Form form;
  form.held = [tables, unit](double v) { return unit * std::round(tables.at(v) / unit); };
  form.periodic = form.mass = form.load = true;
  const std::string& n = axis.name;
  form.text = function_of(axis, tables, "INT",
                          fmt::format("F := F / {:.9e}; (* N of one per mille of the rated torque *)\n"
                                      "IF F > 32767.0 THEN\n"
                                      "  F := 32767.0;\n"
                                      "ELSIF F < -32767.0 THEN\n"
                                      "  F := -32767.0;\n"
                                      "END_IF;\n"
                                      "{}_force := LREAL_TO_INT(F);\n",
                                      unit, n));
  form.to_do =
      "Map object 60B2h (torque offset) into the cyclic data and write NAME_force() to it in every cycle, in per mille of the rated "
      "torque. Check first that the drive counts 60B2h in per mille (object 6076h is the rated torque) and that a positive value "
      "pushes in the positive direction.";
  return form;
}

}  // namespace

extern const SteadyTarget kStructuredText;
const SteadyTarget kStructuredText{"structured-text", "function for a PLC after IEC 61131-3", "(*",
                                   SteadyNeeds::kNothing, write_structured_text};
extern const SteadyTarget kCia402;
const SteadyTarget kCia402{.name = "cia402",
                           .what = "torque offset 60B2h in per mille, as Structured Text",
                           .comment = "(*",
                           .needs = SteadyNeeds::kGain,
                           .write = write_per_mille,
                           .counts = GainUnit::kPerMille};

}  // namespace stribeck::targets
