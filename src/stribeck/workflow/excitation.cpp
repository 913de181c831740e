#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include <stribeck/core/scalar.hpp>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/friction/unbalance.hpp>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/excitation/worst_case.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/excitation.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {

namespace {

using ident::excitation::ExcitationMethod;

/// How much an identified axis may differ from its axis file: it warms up, and carries another workpiece.
constexpr double kOfIdentified = 1.3;

/// A virtual machine breaks nothing: 15 % of friction, as in the thesis, where no range says more.
constexpr double kOfVirtual = 0.85;

/// Adds what the machine file knows of the weight: the range of the load, and the unbalance.
ident::excitation::Doubt with_weight(ident::excitation::Doubt d, const RoughAxis& c, bool expected) {
  d.load_spread = expected ? 0.0 : c.load_spread();
  if (!c.unbalance) return d;
  d.unbalance = expected ? c.unbalance->middle() : c.unbalance->high();
  d.hangs_at = c.unbalance->hangs_at;
  return d;
}

/// What the machine file leaves open of a real axis.
ident::excitation::Doubt doubt_of_file(const RoughAxis& c) {
  return with_weight({c.mass.low(), c.mass.high(), c.friction.low(), c.friction.high(), c.load_force()}, c,
                     false);
}

ident::excitation::Doubt doubt_of(const AxisDescription& axis) {
  const RoughAxis& c = axis.commissioning;
  ident::excitation::Doubt d = doubt_of_file(c);
  if (!axis.plant) return d;
  d.uneven = 1.0;
  if (!c.mass.is_range()) d.mass_low = d.mass_high = c.mass.middle();
  if (!c.friction.is_range()) {
    d.friction_low = kOfVirtual * c.friction.middle();
    d.friction_high = c.friction.middle() / kOfVirtual;
  }
  return d;
}

ident::excitation::Doubt doubt_of(const ident::excitation::RoughDrive& known, double load, bool is_virtual) {
  const double mass = is_virtual ? 1.0 : kOfIdentified;
  const double friction = is_virtual ? 1.0 / kOfVirtual : kOfIdentified;
  return {
      known.mass / mass, known.mass * mass, known.coulomb / friction, known.coulomb * friction, load, 1.0};
}

/// Rough data of the drive from an axis file: its friction at two speeds, the larger of both directions.
ident::excitation::RoughDrive rough_idea(const friction::AxisModel& model, const sim::AxisLimits& limits) {
  ident::Result result;
  result.mass = model.mass;
  constexpr int kPoints = 20;
  for (int i = -kPoints; i <= kPoints; ++i) {
    if (i == 0) continue;
    const double v = 0.9 * limits.speed * i / kPoints;
    const auto p = model.friction.parts(v, 0.0);
    const double f = p.level * sign(v) + p.viscous;
    result.curve.push_back({v, f, f, f});
  }
  return ident::excitation::rough_drive(result);
}

/// The unbalance that was identified.
ident::excitation::Doubt with_identified_unbalance(ident::excitation::Doubt d, const RoughAxis& c,
                                                   const friction::AxisModel& model) {
  d = with_weight(d, c, false);
  for (const auto& term : model.friction.eccentric) {
    if (!friction::is_unbalance(term)) continue;
    d.unbalance = kOfIdentified * term.amplitude;
    d.hangs_at = term.phase;
  }
  return d;
}

/// What is open of an axis that was identified: `drive` is a rough idea of its model.
ident::excitation::Doubt doubt_of_known(const friction::AxisModel& model, const AxisDescription& axis,
                                        const ident::excitation::RoughDrive& drive,
                                        const ident::excitation::Limits& limits) {
  const RoughAxis& rough = axis.commissioning;
  // A range holds for every workpiece, the identified load for the one that was on the table.
  const bool one_load = model.load != 0.0 && !rough.load.is_range();
  ident::excitation::Doubt doubt =
      doubt_of(drive, one_load ? model.load : rough.load_force(), axis.plant.has_value());
  doubt.load_spread = rough.load_spread();
  if (axis.rotary) doubt = with_identified_unbalance(doubt, rough, model);
  if (const auto& spring = model.friction.spring) {
    const double middle = spring->at(0.5 * (limits.travel_min + limits.travel_max));
    doubt.load += middle;
    doubt.load_spread += std::max(std::abs(spring->at(limits.travel_max) - middle),
                                  std::abs(spring->at(limits.travel_min) - middle));
  }
  return doubt;
}

ident::excitation::MultisineDesign multisine_design(const ExcitationOptions& o, bool rotary, double middle) {
  ident::excitation::MultisineDesign design;
  design.start = middle;
  design.periods = o.periods.value_or(design.periods);
  design.repeats = o.repeats.value_or(design.repeats);
  if (o.speeds.size() > 1)
    refuse_option("--speeds", fmt::format("got {} speeds, --method multisine takes one", o.speeds.size()));
  if (!o.speeds.empty())
    design.speed = travel_si("--speeds", o.speeds.front(), quantity("m/s", "mm/s").positive(), rotary);
  if (!o.period.empty()) design.period = option_si("--period", o.period, quantity("s", "s").positive());
  // Two turns of the first line in a period.
  if (!o.period.empty()) design.lowest = 2.0 / design.period;
  if (!o.highest.empty()) design.highest = option_si("--highest", o.highest, quantity("Hz", "Hz").positive());
  return design;
}

bool in_open_loop(const ExcitationOptions& o) {
  return o.method == ExcitationMethod::kPulses || o.method == ExcitationMethod::kRamp;
}

/// A drive that closes a loop of its own takes a velocity or a position.
void refuse_force_of_drive_loop(const ExcitationOptions& o, const std::string& name,
                                const AxisDescription& axis) {
  if (!in_open_loop(o) || !axis.drive_loop) return;
  throw ident::Refused(fmt::format(
      "{}: the drive of axis {} closes a {} loop of its own and takes no force (axes.{}.drive_loop); choose jog, sine, position-sine "
      "or constant-acceleration",
      enum_name(o.method), name, enum_name(axis.drive_loop->mode), name));
}

/// Forces in open loop do not hold what a brake holds now.
void refuse_unsaid_weight(const ExcitationOptions& o, const std::string& name, const AxisDescription& axis) {
  if (!in_open_loop(o) || !o.known.empty() || !axis.weight_unsaid()) return;
  throw ident::Refused(fmt::format(
      "{}: axis {} has a brake, as an axis with a weight has, but the machine file says no weight: without force it may "
      "fall. Write commissioning.{} (0 {} where nothing pulls), or choose jog, sine and constant-acceleration, which hold the "
      "position",
      enum_name(o.method), name, axis.rotary ? "unbalance, or load" : "load", units_of(axis.rotary).force));
}

/// The file of another axis; and in open loop nothing holds a weight that one of the two files does not know.
void refuse_contradiction(const ExcitationOptions& o, const std::string& name, const AxisDescription& axis,
                          const sim::AxisFile& file) {
  if (file.axis && io::lower_case(*file.axis) != io::lower_case(name))
    refuse_option("--known",
                  fmt::format("{} says that it is of axis {}, expected the axis file of {} (its key is axis)",
                              o.known, *file.axis, name));
  const friction::AxisModel& known = file.model;
  const RoughAxis& rough = axis.commissioning;
  if (!in_open_loop(o) || rough.unbalance) return;
  const double told = std::abs(rough.load_force());
  const double apart = std::abs(known.load - rough.load_force()) - rough.load_spread();
  // A load that friction holds either way, or that both files know to a quarter, is no danger.
  if (apart < std::max(0.25 * told, rough.friction.low())) return;
  throw ident::Refused(fmt::format(
      "{}: axis {}: the machine file says a load of {:.4g} {}, {} one of {:.4g} {}: without force the axis may fall. Correct the one "
      "that is wrong, or choose jog, sine and constant-acceleration, which hold the position",
      enum_name(o.method), name, rough.load_force(), units_of(axis.rotary).force, o.known, known.load,
      units_of(axis.rotary).force));
}

ident::excitation::SafeExcitation designed(const ExcitationOptions& o, const MachineDescription& machine,
                                           std::size_t which) {
  const AxisDescription& axis = machine.axes[which].second;
  const ident::excitation::Limits limits{axis.limits.travel_min,   axis.limits.travel_max, axis.limits.speed,
                                         axis.limits.acceleration, axis.force_limit(),     axis.rotary};
  const double middle = 0.5 * (limits.travel_min + limits.travel_max);
  const RoughAxis& rough = axis.commissioning;
  refuse_force_of_drive_loop(o, machine.axes[which].first, axis);
  refuse_unsaid_weight(o, machine.axes[which].first, axis);
  ident::excitation::RoughDrive drive{rough.mass.middle(), rough.friction.middle(), 0.0};
  ident::excitation::Doubt doubt = doubt_of(axis);
  // A design that is refused for the real axis is refused for its virtual one too.
  if (const auto real = doubt_of_file(rough); real.may_fall(limits)) doubt = real;
  if (!o.known.empty()) {
    const auto file = read_axis_file(o.known);
    if (file.rotary.value_or(false) != axis.rotary)
      refuse_option("--known",
                    fmt::format("{} is of a {} axis, axis {} of the machine is {} (give the axis file of {})",
                                o.known, axis.rotary ? "linear" : "rotary", machine.axes[which].first,
                                axis.rotary ? "rotary" : "linear", machine.axes[which].first));
    const friction::AxisModel& model = file.model;
    refuse_contradiction(o, machine.axes[which].first, axis, file);
    drive = rough_idea(model, axis.limits);
    doubt = doubt_of_known(model, axis, drive, limits);
  }
  if (o.method == ExcitationMethod::kJog) {
    ident::excitation::JogDesign jog;
    jog.start = middle;
    jog.both_sides = true;  // the whole travel tells more than half of it: a spring, places
    jog.way = ident::excitation::kSeveralTurns;
    jog.speeds = ident::excitation::in_mixed_order(
        ident::excitation::jog_speeds(ident::excitation::fastest_jog(limits, machine.sample_time, jog)));
    if (!o.speeds.empty()) jog.speeds.clear();
    for (const std::string& speed : o.speeds) {
      jog.speeds.push_back(travel_si("--speeds", speed, quantity("m/s", "mm/s").positive(), axis.rotary));
    }
    if (!o.lead.empty())
      jog.period = travel_si("--lead", o.lead, quantity("m", "mm").positive(), axis.rotary);
    const bool shorter =
        o.speeds.empty() && ident::excitation::leave_out_slowest(limits, machine.sample_time, jog);
    ident::excitation::SafeExcitation e{ident::excitation::design_jog(limits, machine.sample_time, jog), {}};
    if (shorter)
      e.excitation.says +=
          " Slower speeds are left out: at this control period they would take too many rows; give --speeds for those.";
    return e;
  }
  if (o.method == ExcitationMethod::kPulses) {
    ident::excitation::PulseDesign pulses;
    pulses.start = middle;
    return ident::excitation::design_safe_pulses(limits, drive, doubt, machine.sample_time, pulses);
  }
  if (o.method == ExcitationMethod::kRamp) {
    ident::excitation::RampDesign ramp;
    ramp.start = middle;
    ramp.repeats = o.repeats.value_or(ramp.repeats);
    if (!o.rise.empty()) ramp.rise = option_si("--rise", o.rise, quantity("s", "s").positive());
    return ident::excitation::design_safe_ramp(limits, drive, doubt, machine.sample_time, ramp);
  }
  if (o.method == ExcitationMethod::kConstantAcceleration) {
    ident::excitation::AccelerationDesign triangles =
        ident::excitation::acceleration_design(limits, middle, rough.mass.middle(), rough.friction.middle());
    triangles.repeats = o.repeats.value_or(triangles.repeats);
    return {ident::excitation::design_constant_acceleration(limits, machine.sample_time, triangles), {}};
  }
  if (o.method == ExcitationMethod::kMultisine)
    return {ident::excitation::design_multisine(limits, drive, machine.sample_time,
                                                multisine_design(o, axis.rotary, middle)),
            {}};
  if (o.method == ExcitationMethod::kSine) {
    const sim::Commissioning c = as_machine(machine).axes[which].second.commissioning;
    ident::excitation::SineDesign sine{c.sine_offset + c.sine_amplitude, c.sine_amplitude, c.sine_frequency,
                                       o.periods.value_or(kSinePeriods)};
    sine.strokes = o.strokes.value_or(kStrokeSpeeds);
    return {ident::excitation::design_sine(limits, machine.sample_time, sine), {}};
  }
  return {workflow::design(as_machine(machine), which, o.method, o.periods.value_or(kPositionPeriods)), {}};
}

/// The option that sets a parameter of a design; empty: there is none.
std::string option_of(const std::string& parameter, ExcitationMethod method) {
  if (parameter == "period") return method == ExcitationMethod::kMultisine ? "--period" : "--lead";
  if (parameter == "speed") return "--speeds";
  for (const char* same : {"rise", "speeds", "periods", "strokes", "repeats", "highest"}) {
    if (parameter == same) return std::string("--") + same;
  }
  return {};
}

}  // namespace

namespace {

/// An option that shapes the motion of some methods only.
struct MethodOption {
  const char* name;
  bool given;
  std::vector<ExcitationMethod> methods;
};

std::vector<MethodOption> method_options(const ExcitationOptions& o) {
  using enum ExcitationMethod;
  return {{"--periods", o.periods.has_value(), {kSine, kPositionSine, kMultisine}},
          {"--strokes", o.strokes.has_value(), {kSine}},
          {"--repeats", o.repeats.has_value(), {kRamp, kConstantAcceleration, kMultisine}},
          {"--known", !o.known.empty(), {kPulses, kRamp}},
          {"--speeds", !o.speeds.empty(), {kJog, kMultisine}},
          {"--period", !o.period.empty(), {kMultisine}},
          {"--highest", !o.highest.empty(), {kMultisine}},
          {"--lead", !o.lead.empty(), {kJog}},
          {"--rise", !o.rise.empty(), {kRamp}}};
}

}  // namespace

void check_excitation(const ExcitationOptions& o) {
  for (const MethodOption& one : method_options(o)) {
    if (!one.given || std::find(one.methods.begin(), one.methods.end(), o.method) != one.methods.end())
      continue;
    std::vector<std::string> words;
    for (const ExcitationMethod method : one.methods) words.emplace_back(enum_name(method));
    refuse_option(one.name, fmt::format("does not apply to --method {}, only to {}", enum_name(o.method),
                                        fmt::join(words, ", ")));
  }
}

std::vector<std::string> given_method_options(const ExcitationOptions& o) {
  std::vector<std::string> names;
  for (const MethodOption& one : method_options(o)) {
    if (one.given) names.emplace_back(one.name);
  }
  return names;
}

namespace {

/// A motion in closed loop keeps to travel and speed; the drive must be able to follow it.
void check_force(ident::excitation::Excitation& e, const MachineDescription& machine, std::size_t axis) {
  const AxisDescription& a = machine.axes[axis].second;
  const RoughAxis& c = a.commissioning;
  const double limit = a.force_limit();
  const std::string_view unit = units_of(a.rotary).force;
  const ident::excitation::Doubt expected = with_weight(
      {c.mass.middle(), c.mass.middle(), c.friction.middle(), c.friction.middle(), c.load_force()}, c, true);
  const double needed = ident::excitation::force_needed(e.r, e.sample_time, expected);
  const double most = ident::excitation::force_needed(e.r, e.sample_time, doubt_of(a));
  if (needed > limit) {
    throw ident::Refused(fmt::format(
        "{}: needs {} {} of axis {} with the rough mass and friction, its largest force is {} {} (lower "
        "limits.acceleration or limits.speed)",
        enum_name(e.method), ident::digits(needed), unit, machine.axes[axis].first, ident::digits(limit),
        unit));
  }
  e.says += fmt::format(" The drive needs about {} {} of its {} {}", ident::digits(needed), unit,
                        ident::digits(limit), unit);
  e.says += most > limit
                ? fmt::format(
                      "; were mass and friction as large as they may be, {} {}: it would fall behind, and "
                      "the control's limit of the following error must stop it.",
                      ident::digits(most), unit)
                : fmt::format(", {} {} in the worst case.", ident::digits(most), unit);
}

/// A motor turns no faster than its data sheet says, whatever the limit of the axis.
void note_motor_speed(ident::excitation::Excitation& e, const AxisDescription& a) {
  const std::optional<double> top = a.drive ? a.drive->top_speed() : std::nullopt;
  if (!top) return;
  double fastest = 0.0;
  for (std::size_t k = 1; k < e.r.size(); ++k)
    fastest = std::max(fastest, std::abs(e.r[k] - e.r[k - 1]) / e.sample_time);
  if (fastest <= 1.001 * *top) return;
  const AxisUnits& u = units_of(a.rotary);
  e.says += fmt::format(
      " Attention: up to {:.4g} {}/s, and at its largest speed (drive.motor_speed) the motor moves the axis by {:.4g} {}/s: lower "
      "limits.speed, and design again.",
      fastest * u.per_metre, u.travel, *top * u.per_metre, u.travel);
}

/// The drive must hold what rests on it, before anything moves.
void check_weight(ident::excitation::Excitation& e, const MachineDescription& machine, std::size_t axis) {
  const auto& [name, a] = machine.axes[axis];
  const RoughAxis& c = a.commissioning;
  const AxisUnits& u = units_of(a.rotary);
  ident::excitation::Doubt carried = with_weight({0.0, 0.0, 0.0, 0.0, c.load_force()}, c, true);
  carried.load_spread = c.load_spread();
  const double weight = carried.weight(a.limits.travel_min, a.limits.travel_max);
  if (weight == 0.0) return;
  const double limit = a.force_limit();
  const auto what = [&] {
    return fmt::format("{} {} of {}", ident::digits(weight), u.force,
                       c.unbalance ? "unbalance and load" : "load");
  };
  if (weight + c.friction.middle() > limit) {
    throw ident::Refused(fmt::format(
        "{}: axis {} carries {} and {} {} of friction, more than the largest force of its drive, {} {}: it cannot lift it (check "
        "commissioning and drive, e.g. gear, lead, peak)",
        enum_name(e.method), name, what(), ident::digits(c.friction.middle()), u.force, ident::digits(limit),
        u.force));
  }
  const std::optional<double> rated = a.drive ? a.drive->rated() : std::nullopt;
  if (rated && weight > *rated) {
    e.says += fmt::format(
        " Attention: {} is more than the {} {} that the drive gives for long: at rest it becomes hot; hold the axis with its "
        "brake between runs.",
        what(), ident::digits(*rated), u.force);
  }
}

}  // namespace

namespace {

/// What open loop takes for granted of a real axis: nothing pulls where the file says nothing.
std::string balanced(const std::string& name, const AxisDescription& axis) {
  const RoughAxis& rough = axis.commissioning;
  if (axis.rotary)
    return rough.unbalance
               ? std::string()
               : "; the table must be balanced, or upright: the machine file says no commissioning.unbalance";
  if (axis.plant || !rough.load.empty()) return {};
  return fmt::format(
      "; no weight may pull the axis, as on a vertical or inclined one: it would fall, and the machine file says no load (write "
      "axes.{}.commissioning.load, 0 N where nothing pulls)",
      name);
}

/// To a thousandth of the unit, without a sign before zero.
double in_units(double metres, const AxisUnits& units) {
  return std::round(metres * units.per_metre * 1e3) * 1e-3 + 0.0;
}

}  // namespace

std::vector<std::string> safety_notes(const ident::excitation::SafeExcitation& safe,
                                      const MachineDescription& machine, std::size_t axis) {
  const auto& [name, a] = machine.axes[axis];
  const ident::excitation::Excitation& e = safe.excitation;
  const bool open = e.r.empty();
  const double start = open ? 0.5 * (a.limits.travel_min + a.limits.travel_max) : e.r.front();
  const auto [low, high] =
      open ? std::pair(safe.reach.lowest, safe.reach.highest)
           : std::pair(*std::min_element(e.r.begin(), e.r.end()), *std::max_element(e.r.begin(), e.r.end()));
  const std::vector<double>& table = open ? e.force : e.r;
  const auto first = std::find_if(table.begin(), table.end(), [&](double y) { return y != table.front(); });
  const bool up = first == table.end() || *first > table.front();
  const AxisUnits& u = units_of(a.rotary);
  std::vector<std::string> notes{
      fmt::format("begins at {:.6g} {}, at rest", in_units(start, u), u.travel),
      fmt::format("first moves to {}{}", up ? '+' : '-', name),
      fmt::format("needs free room from {:.6g} to {:.6g} {}{}", in_units(low, u), in_units(high, u), u.travel,
                  open ? ", in the worst case of friction and mass" : ""),
      fmt::format(
          "abort outside {:.6g} to {:.6g} {}, above {:.6g} {}/s, above {:.6g} {}{}",
          a.limits.travel_min * u.per_metre, a.limits.travel_max * u.per_metre, u.travel,
          a.limits.speed * u.per_metre, u.travel, a.force_limit(), a.rotary ? "N m at the table" : "N",
          open
              ? balanced(name, a) + "; open loop, nothing holds the position: keep the emergency stop at hand"
              : std::string(", and at the control's limit of the following error"))};
  if (!open)
    notes.emplace_back(
        "counts in the coordinates of the machine: no work offset, tool length or rotation may act");
  return notes;
}

std::string gcode_option(const std::string& axis, const std::string& stem) {
  const std::string word = ident::excitation::gcode_word(axis);
  if (word.empty()) return {};
  return fmt::format(" --gcode {}.{}", stem, word.back() == '=' ? "mpf" : "ngc");
}

std::string with_notes(std::string gcode, const std::vector<std::string>& notes) {
  const bool semicolon = gcode.starts_with(';');  // as SINUMERIK has comments
  std::string head;
  for (std::string note : notes) {
    std::erase_if(note, [](char c) { return c == '(' || c == ')'; });  // they end a comment
    if (semicolon) std::replace(note.begin(), note.end(), ';', ',');
    head += semicolon ? "; " + note + '\n' : '(' + note + ")\n";
  }
  return gcode.insert(gcode.find("\nG") + 1, head);  // before the first line that is no comment
}

ident::excitation::SafeExcitation make_excitation(const ExcitationOptions& o,
                                                  const MachineDescription& machine, std::size_t axis) {
  try {
    ident::excitation::SafeExcitation safe = designed(o, machine, axis);
    check_weight(safe.excitation, machine, axis);
    note_motor_speed(safe.excitation, machine.axes[axis].second);
    if (!safe.excitation.r.empty()) check_force(safe.excitation, machine, axis);
    return safe;
  } catch (const ident::excitation::BadDesign& bad) {
    const std::string option = option_of(bad.parameter, o.method);
    if (option.empty()) throw;
    refuse_option(option, bad.what());
  }
}

}  // namespace stribeck::workflow
