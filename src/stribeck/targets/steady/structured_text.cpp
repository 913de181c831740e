#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include <stribeck/io/error.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/targets/steady/drive_words.hpp>
#include <stribeck/targets/steady/table_source.hpp>

namespace stribeck::targets {

namespace {

std::string array_of(const std::string& name, const std::string& numbers, std::size_t count) {
  return fmt::format("  {} : ARRAY[0..{}] OF LREAL := [{}];\n", name, count - 1, numbers);
}

/// Numbers of the stops, in two arrays, or of the one bristle.
std::string constants_of(const friction::BuildUp& bristles) {
  if (bristles.stops.empty())
    return fmt::format("  distance : LREAL := {:.9e}; (* m/N *)\n", bristles.distance);
  const StopLists stops = lists_of(bristles);
  return array_of("weight", stops.weights, bristles.stops.size()) +
         array_of("stiffness", stops.stiffness, bristles.stops.size());
}

/// Makes of the friction `level` against the motion the signed one that has built up over the commanded travel (pre_sliding.hpp).
std::string built_up(const friction::BuildUp& bristles) {
  std::string out =
      "travel := position - before;\n"
      // A position that wraps, or is set anew, goes against the velocity.
      "IF NOT begun OR travel * velocity <= 0.0 THEN\n"
      "  travel := 0.0;\n"
      "END_IF;\n"
      "begun := TRUE;\n"
      "before := position;\n";
  // The state is a force: it stays at a reversal, also where the friction of the other direction is another one.
  if (bristles.stops.empty())
    return out +
           "IF level > 0.0 AND travel > 0.0 THEN\n"
           "  built := level + (built - level) * EXP(-travel / (distance * level));\n"
           "ELSIF level > 0.0 AND travel < 0.0 THEN\n"
           "  built := -level + (built + level) * EXP(travel / (distance * level));\n"
           "END_IF;\n"
           "level := built;\n";
  return out + fmt::format(
                   "built := 0.0;\n"
                   "FOR i := 0 TO {} DO\n"
                   "  IF level > 0.0 THEN\n"
                   "    stop[i] := stop[i] + stiffness[i] * travel;\n"
                   "    IF travel > 0.0 THEN\n"
                   "      stop[i] := MIN(stop[i], weight[i] * level);\n"
                   "    ELSIF travel < 0.0 THEN\n"
                   "      stop[i] := MAX(stop[i], -weight[i] * level);\n"
                   "    END_IF;\n"
                   "  END_IF;\n"
                   "  built := built + stop[i];\n"
                   "END_FOR;\n"
                   "level := built;\n",
                   bristles.stops.size() - 1);
}

/// The lines that find the level of one direction in its table; `when` is the line before them.
std::string side_of_table(const char* when, const char* side, std::size_t count) {
  const std::string speed = fmt::format("speed_{}", side);
  const std::string force = fmt::format("force_{}", side);
  return fmt::format(
      "{0}\n"
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
}

/// Function block of IEC 61131-3. `type` and `result` are those of its output, from the force F in N.
std::string block_of(const Axis& axis, const SourceTables& tables, const std::string& type,
                     const std::string& result) {
  const std::string& n = axis.name;
  const auto bristles = friction::build_up_of(axis.model.friction.dynamics);
  std::string out = fmt::format(
      "FUNCTION_BLOCK {}_force\n"
      "VAR_INPUT\n"
      "  acceleration : LREAL; (* of the command, m/s2 *)\n"
      "  velocity : LREAL; (* of the command, m/s *)\n"
      "  position : LREAL; (* of the command, m *)\n"
      "END_VAR\n"
      "VAR_OUTPUT\n"
      "  force : {};\n"
      "END_VAR\n"
      // Behind constants some compilers take these for constants too.
      "VAR\n"
      "  i : INT;\n"
      "  forward : BOOL;\n"
      "  s, level, other, F : LREAL;\n",
      n, type);
  if (bristles) {
    out += "  begun : BOOL;\n  before, travel, built : LREAL;\n";
    if (!bristles->stops.empty())
      out += fmt::format("  stop : ARRAY[0..{}] OF LREAL;\n", bristles->stops.size() - 1);
  }
  out += fmt::format(
      "END_VAR\n"
      "VAR CONSTANT\n"
      "  mass : LREAL := {:.9e}; (* kg *)\n"
      "  load : LREAL := {:.9e}; (* N *)\n",
      axis.model.mass, axis.model.load);
  out += array_of("speed_p", speeds_of(tables.positive), tables.positive.size());
  out += array_of("force_p", forces_of(tables.positive), tables.positive.size());
  out += array_of("speed_n", speeds_of(tables.negative), tables.negative.size());
  out += array_of("force_n", forces_of(tables.negative), tables.negative.size());
  if (bristles) out += constants_of(*bristles);
  out +=
      "END_VAR\n"
      "IF velocity > 0.0 THEN\n"
      "  forward := TRUE;\n"
      "ELSIF velocity < 0.0 THEN\n"
      "  forward := FALSE;\n"
      "END_IF;\n"
      "s := ABS(velocity);\n"
      "other := 0.0;\n";
  out += side_of_table("IF forward THEN", "p", tables.positive.size());
  out += side_of_table("ELSE", "n", tables.negative.size()) + "END_IF;\n";
  for (const auto& t : axis.model.friction.eccentric) {
    out += fmt::format("{0} := {0} + {1:.9e} * SIN({2:.9e} * position - {3:.9e});\n",
                       t.form == friction::EccentricForm::kAdditive ? "other" : "level", t.amplitude,
                       2.0 * kPi / t.period, t.phase);
  }
  if (const auto& spring = axis.model.friction.spring)
    out += fmt::format("other := other + {0:.9e} * (LIMIT({2:.9e}, position, {3:.9e}) - {1:.9e});\n",
                       spring->stiffness, spring->zero_at, spring->lowest(), spring->highest());
  out += bristles ? built_up(*bristles)
                  : std::string(
                        "IF velocity < 0.0 THEN\n"
                        "  level := -level;\n"
                        "ELSIF velocity = 0.0 THEN\n"
                        "  level := 0.0;\n"
                        "END_IF;\n");
  out += "F := mass * acceleration + level + other + load;\n" + result;
  return out + "END_FUNCTION_BLOCK\n";
}

/// What both forms have in common.
Form form_of(const Axis& axis) {
  Form form;
  form.periodic = form.mass = form.load = true;
  form.bristles = friction::build_up_of(axis.model.friction.dynamics);
  form.pre_sliding = form.bristles.has_value();
  return form;
}

Form write_structured_text(const Axis& axis) {
  const SourceTables tables(axis);
  Form form = form_of(axis);
  form.held = [tables](double v) { return tables.at(v); };
  form.text = block_of(axis, tables, "LREAL", "force := F;\n");
  form.to_do =
      "Declare an instance of NAME_force, call it once in every cycle with the commanded motion, and add its output force to " +
      place_of_force(axis, "the force of the axis") +
      ". Check its sign first: at a constant positive velocity it must push in the positive direction." +
      words_of_end(axis, tables) + words_of_drive_loop(axis);
  return form;
}

/// CiA 402 counts 60B2h in thousandths of the rated torque.
Form write_per_mille(const Axis& axis) {
  const double unit = axis.gain;
  const SourceTables tables(axis);
  Form form = form_of(axis);
  form.held = [tables, unit](double v) { return unit * std::round(tables.at(v) / unit); };
  form.text = block_of(axis, tables, "INT",
                       fmt::format("F := F / {:.9e}; (* N of one per mille of the rated torque *)\n"
                                   "IF F > 32767.0 THEN\n"
                                   "  F := 32767.0;\n"
                                   "ELSIF F < -32767.0 THEN\n"
                                   "  F := -32767.0;\n"
                                   "END_IF;\n"
                                   "force := LREAL_TO_INT(F);\n",
                                   unit));
  form.to_do =
      "Map object 60B2h (torque offset) into the cyclic data; declare an instance of NAME_force, call it once in every cycle with the commanded "
      "motion, and write its output force, in per mille of the rated torque, to the object. Check first that the drive counts 60B2h in per mille "
      "(object 6076h is the rated torque) and that a positive value pushes in the positive direction." +
      words_of_end(axis, tables);
  if (const auto& loop = axis.model.drive_loop; loop && !loop->force_offset)
    form.to_do +=
        " The axis file says that the drive takes no force offset (drive_loop.force_offset): check that it has the object.";
  return form;
}

/// IEC 61131-3 ignores the case of names and permits no two underscores in a row; NAME_force begins with that of the axis.
void check_block_names(const std::vector<Axis>& axes) {
  std::vector<std::string> known;
  for (const Axis& axis : axes) {
    if (axis.name.find("__") != std::string::npos || axis.name.ends_with('_'))
      throw io::InputError(
          {axis.file, 0, "axis",
           fmt::format(
               "{}_force would have two underscores in a row, which IEC 61131-3 does not permit (give "
               "another name, --name)",
               axis.name)});
    const std::string plain = io::lower_case(axis.name);
    if (std::find(known.begin(), known.end(), plain) != known.end())
      throw io::InputError(
          {axis.file, 0, "axis",
           fmt::format(
               "a second axis is called {}: IEC 61131-3 does not distinguish small and capital letters "
               "(give another name, --name)",
               axis.name)});
    known.push_back(plain);
  }
}

}  // namespace

extern const SteadyTarget kStructuredText;
const SteadyTarget kStructuredText{.name = "structured-text",
                                   .what = "function block for a PLC after IEC 61131-3",
                                   .comment = "(*",
                                   .write = write_structured_text,
                                   .on_circle = true,
                                   .check_names = check_block_names};
extern const SteadyTarget kCia402;
const SteadyTarget kCia402{.name = "cia402",
                           .what = "torque offset 60B2h in per mille, as Structured Text",
                           .comment = "(*",
                           .needs = SteadyNeeds::kGain,
                           .write = write_per_mille,
                           .on_circle = true,
                           .check_names = check_block_names,
                           .counts = GainUnit::kPerMille};

}  // namespace stribeck::targets
