// What a machine file says, in the numbers that follow from it.
#include <fmt/format.h>

#include <cmath>
#include <stribeck/ident/excitation/worst_case.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>

namespace stribeck::workflow {
namespace {

using report::short_number;
using report::significant;

/// A value or a range, and how far the truth may be.
Explained rough(const char* what, const Rough& r, std::string_view unit) {
  if (r.is_range()) {
    return {what, fmt::format("{} to {} {}", short_number(r.low()), short_number(r.high()), unit),
            "as certain as you say: excitations are safe inside this range"};
  }
  return {what, fmt::format("{} {}", short_number(r.middle()), unit),
          fmt::format("a single value is treated as {} to {} {}; give a range to allow stronger excitations",
                      significant(r.low(), 3), significant(r.high(), 3), unit)};
}

class Explanation {
 public:
  Explanation(const MachineDescription& machine, std::size_t axis)
      : a_(machine.axes[axis].second), u_(units_of(a_.rotary)), period_(machine.sample_time) {
    out_.name = machine.axes[axis].first;
  }

  ExplainedAxis made() {
    limits();
    drive();
    drive_loop();
    known();
    proposals();
    lacks();
    draw();
    return std::move(out_);
  }

 private:
  void add(std::string what, std::string value, std::string note = {}) {
    out_.lines.push_back({std::move(what), std::move(value), std::move(note)});
  }

  [[nodiscard]] std::string travel(double x) const {
    return fmt::format("{} {}", short_number(x * u_.per_metre), u_.travel);
  }
  [[nodiscard]] std::string fine(double x) const {
    return fmt::format("{} {}", significant(x * u_.per_metre_fine, 3), u_.fine);
  }

  /// "176 N", "120 to 300 N"; empty where there is none.
  [[nodiscard]] std::string load_text() const {
    const Rough& load = a_.commissioning.load;
    if (load.is_range())
      return fmt::format("{} to {} {}", short_number(load.low()), short_number(load.high()), u_.force);
    return load.middle() == 0.0 ? "" : fmt::format("{} {}", short_number(load.middle()), u_.force);
  }

  /// What rests on the drive: expected, or the most that may be.
  [[nodiscard]] double weight(bool expected) const {
    const RoughAxis& c = a_.commissioning;
    ident::excitation::Doubt d;
    d.load = c.load_force();
    if (!expected) d.load_spread = c.load_spread();
    if (c.unbalance) {
      d.unbalance = expected ? c.unbalance->middle() : c.unbalance->high();
      d.hangs_at = c.unbalance->hangs_at;
    }
    return d.weight(a_.limits.travel_min, a_.limits.travel_max);
  }

  void limits() {
    const sim::AxisLimits& l = a_.limits;
    if (a_.rotary) add("rotary", "yes", std::string(kRotaryInResults));
    add("travel", fmt::format("{} to {}", travel(l.travel_min), travel(l.travel_max)));
    std::string note =
        fmt::format("{} {}, {} in one control period", short_number(l.speed * u_.per_metre_per_second),
                    u_.fast, fine(l.speed * period_));
    if (const auto top = a_.drive ? a_.drive->top_speed() : std::nullopt) {
      note += fmt::format("; the motor allows {} {}/s", significant(*top * u_.per_metre, 4), u_.travel);
      if (*top < l.speed) note += ", which is less: lower it";
    }
    add("speed", travel(l.speed) + "/s", note);
    add("acceleration", travel(l.acceleration) + "/s2",
        fmt::format("top speed after {} s and {} {}", significant(l.speed / l.acceleration, 3),
                    significant(0.5 * u_.per_metre * l.speed * l.speed / l.acceleration, 3), u_.travel) +
            implausible());
    out_.numbers["travel_mm"] = {l.travel_min * 1e3, l.travel_max * 1e3};
    out_.numbers["speed_mm_per_s"] = l.speed * 1e3;
  }

  /// What no machine has: most likely a slip of a unit, mm/min for m/min, m/s² for mm/s².
  [[nodiscard]] std::string implausible() const {
    const sim::AxisLimits& l = a_.limits;
    constexpr double kGravity = 9.80665;        // [m/s²]
    constexpr double kMost = 1000.0;            // of it
    constexpr double kTurn = 2.0 * kPi - 1e-3;  // [rad]
    const double needed = 0.5 * l.speed * l.speed / l.acceleration, there = l.travel_max - l.travel_min;
    // An axis with a whole turn of travel may go on turning.
    const bool endless = a_.rotary && there >= kTurn;
    if (needed > there && !endless)
      return fmt::format(
          ". Attention: the travel is {} {}, so that the axis never reaches its speed: check the units of speed and acceleration",
          short_number(there * u_.per_metre), u_.travel);
    if (!a_.rotary && l.acceleration > kMost * kGravity)
      return fmt::format(". Attention: that is {} times gravity: check the unit of acceleration",
                         significant(l.acceleration / kGravity, 3));
    if (l.speed < l.acceleration * period_)
      return fmt::format(
          ". Attention: that is less than one control period, {} ms: check the units of speed, acceleration and sample_time",
          short_number(1e3 * period_));
    return {};
  }

  void drive() {
    const double force = a_.force_limit();
    const double per_volt = a_.force_per_volt();
    const std::optional<double> rated = a_.drive ? a_.drive->rated() : std::nullopt;
    if (rated) {
      const auto r = a_.drive->radius();
      const int motors = a_.drive->motors;
      const std::string both =
          motors > 1 ? fmt::format(" of one motor or of their mean, \"{} {}/%\" for the sum of {} columns",
                                   significant(*rated / 100.0 / motors, 6), u_.force, motors)
                     : std::string();
      add(a_.rotary ? "torque at 100 %" : "force at 100 %", force_text(*rated),
          fmt::format("1 ‰ (CiA 402) is {}; for logs in percent: --gain \"{} {}/%\"{}",
                      force_text(*rated / 1e3), significant(*rated / 100.0, 6), u_.force, both));
      if (r)
        add("travel per turn",
            fmt::format("{} {} of the motor", significant(2.0 * u_.per_metre * kPi * *r, 6), u_.travel),
            a_.drive->gear < 1.0
                ? fmt::format(
                      "the gear speeds up, {0} turns for one of the motor: a reduction is written {0} or {0}:1",
                      significant(1.0 / a_.drive->gear, 4))
                : std::string());
      out_.numbers["force_at_100_percent_N"] = *rated;
    }
    if (const std::string doubt = a_.drive ? a_.drive->constant_doubt() : std::string(); !doubt.empty())
      add("Attention", doubt);
    if (per_volt > 0.0) add(a_.rotary ? "torque per volt" : "force per volt", force_text(per_volt) + "/V");
    if (force > 0.0) {
      std::string note = a_.limits.force                 ? "as limits.force says"
                         : a_.drive && a_.drive->peak()  ? "peak or limit of the drive"
                         : a_.drive && a_.drive->rated() ? "rated: the file says no peak and no limit"
                                                         : "of the virtual drive";
      const double spare = force - a_.commissioning.friction.middle() - weight(true);
      note += fmt::format("; less friction and {} it accelerates by {} {}/s2",
                          a_.commissioning.unbalance ? "unbalance" : "load",
                          significant(spare / a_.commissioning.mass.middle() * u_.per_metre, 3), u_.travel);
      if (spare <= 0.0)
        note += ": it cannot lift it, every excitation is refused";
      else if (spare < a_.commissioning.mass.middle() * a_.limits.acceleration)
        note += ", which is below the limit of acceleration: lower that";
      add(a_.rotary ? "largest torque" : "largest force", force_text(force), note);
      out_.numbers["largest_force_N"] = force;
    }
    if (const auto rotor = a_.drive ? a_.drive->reflected_mass() : std::nullopt) {
      add(a_.rotary ? "rotor at the table" : "rotor as mass",
          fmt::format("{} {}", significant(*rotor, 3), u_.mass),
          *rotor < a_.commissioning.mass.middle()
              ? fmt::format("included in the {} below", mass_word())
              : fmt::format(
                    "more than the {0} below, which must contain it: check rotor inertia, gear, lead and {0}",
                    mass_word()));
      out_.numbers["reflected_mass_kg"] = *rotor;
    }
    const double step = a_.name_plate().encoder_resolution;
    if (step > 0.0) {
      add("encoder", fmt::format("{} {}", significant(step * u_.per_metre_fine, 4), u_.fine),
          fmt::format("one step in one control period is {} {}/s",
                      significant(step / period_ * u_.per_metre, 3), u_.travel));
      out_.numbers["encoder_resolution_um"] = step * 1e6;
    }
  }

  /// The loop that the drive closes itself, as a controller is told it.
  void drive_loop() {
    const friction::DriveLoop* simulated =
        a_.plant && a_.plant->drive_loop ? &a_.plant->drive_loop->loop : nullptr;
    const friction::DriveLoop* told = a_.drive_loop ? &*a_.drive_loop : simulated;
    if (told == nullptr) return;
    constexpr double kSame = 0.05;  // of the gain
    const bool position = told->mode == friction::DriveMode::kPosition;
    const double bandwidth = told->gain / (2.0 * kPi * a_.commissioning.mass.middle());
    std::string note = fmt::format("with the {} below its velocity loop reaches about {} Hz", mass_word(),
                                   significant(bandwidth, 2));
    if (told->integral_time)
      note += fmt::format(", integral time {} ms", significant(1e3 * *told->integral_time, 4));
    if (position && told->position_gain)
      note += fmt::format(", Kv {} 1/s = {} (m/min)/mm", significant(*told->position_gain, 4),
                          significant(0.06 * *told->position_gain, 4));
    if (simulated != nullptr &&
        (simulated->mode != told->mode || std::abs(simulated->gain - told->gain) > kSame * simulated->gain))
      note += fmt::format(
          "; plant.drive_loop has another loop, {} with a gain of {} N s/m: controllers would be told this one, and drive that one",
          enum_name(simulated->mode), significant(simulated->gain, 4));
    add("drive loop",
        fmt::format("{}, {} {}s/{}", position ? "position" : "velocity", significant(told->gain, 4),
                    a_.rotary ? "N m " : "N ", a_.rotary ? "rad" : "m"),
        note);
  }

  void known() {
    const RoughAxis& c = a_.commissioning;
    out_.lines.push_back(rough(mass_word(), c.mass, u_.mass));
    out_.lines.push_back(rough("friction", c.friction, u_.force));
    falls_ = weight(false) >= c.friction.low() || a_.weight_unsaid();
    const char* what =
        falls_ ? "the axis may fall without force: open-loop excitations are refused" : "friction holds it";
    if (!load_text().empty()) add("load", load_text(), c.unbalance ? "" : what);
    if (c.unbalance) {
      add("unbalance",
          fmt::format("{} {}{}", significant(c.unbalance->middle(), 3), u_.force,
                      c.unbalance->hangs_at
                          ? fmt::format(", hangs down at {}", travel(*c.unbalance->hangs_at))
                          : ", hangs down at an angle that is not known"),
          what);
    }
    if (a_.weight_unsaid()) {
      add("weight", "none said",
          fmt::format("the brake lets it be expected: write {} of commissioning; until then {}",
                      a_.rotary ? "unbalance or load" : "load", what));
    }
    if (falls_ && (!a_.drive || !a_.drive->brake))
      add("brake", "none said", "an axis that falls needs one: write brake = true if it has one");
    out_.numbers["may_fall"] = falls_;
  }

  void proposals() {
    const Proposal p = propose(a_, period_);
    add("omega",
        fmt::format("{} rad/s ({} Hz)", significant(p.omega.value, 3),
                    significant(p.omega.value / (2.0 * kPi), 3)),
        p.omega.reason);
    add("observer pole", significant(p.observer_pole.value, 3) + " rad/s", p.observer_pole.reason);
    add("sine",
        fmt::format("{} ± {} at {} rad/s", travel(p.sine_offset.value), travel(p.sine_amplitude.value),
                    significant(p.sine_frequency.value, 3)),
        p.sine_amplitude.reason + "; " + p.sine_frequency.reason);
    // Forces in open loop are neither for an axis that falls nor for a drive that closes a loop of its own.
    add("to excite",
        falls_ || a_.drive_loop ? "jog, sine, position-sine, constant-acceleration"
                                : "jog, sine, constant-acceleration; then pulses --known",
        "jog: friction from the lowest speed; constant-acceleration: mass; sine: reversals");
    out_.numbers["omega_rad_per_s"] = p.omega.value;
    out_.numbers["observer_pole_per_s"] = p.observer_pole.value;
  }

  void lacks() {
    if (!(a_.force_limit() > 0.0))
      out_.lacks.push_back("excite: the largest force, limits.force or drive with rated_torque and lead");
    if (!(a_.name_plate().encoder_resolution > 0.0))
      out_.lacks.push_back("a proposal of omega that suits the encoder: commissioning.encoder_resolution");
    if (!a_.drive && !a_.plant)
      out_.lacks.push_back("force from percent or torque in logs: drive with rated_torque and lead");
    if (!a_.plant)
      out_.lacks.push_back(
          "simulate, compare, tune: plant, the truth of a virtual axis (a real machine has none)");
  }

  void draw() {
    std::vector<std::string> parts;
    if (a_.drive) {
      const DriveData& d = *a_.drive;
      parts.push_back(d.motors > 1 ? fmt::format("{} motors", d.motors)
                      : d.radius() ? std::string("motor")
                                   : std::string(a_.rotary ? "torque motor" : "linear motor"));
      if (d.gear != 1.0) parts.push_back("gear " + short_number(d.gear));
      if (d.lead && !a_.rotary) parts.push_back("screw " + travel(*d.lead));
      if (d.lead && a_.rotary && d.gear == 1.0) parts.emplace_back("direct drive");
      if (d.pulley_diameter) parts.push_back("pulley Ø" + travel(*d.pulley_diameter));
      if (d.travel_per_turn) parts.push_back(travel(*d.travel_per_turn) + " per turn");
    } else {
      parts.emplace_back("drive");
    }
    parts.push_back(fmt::format("{} {}, {} {}", a_.rotary ? "table" : "axis", out_.name,
                                short_number(a_.commissioning.mass.middle()), u_.mass));
    if (!load_text().empty()) parts.push_back("load " + load_text());
    if (const auto& unbalance = a_.commissioning.unbalance)
      parts.push_back(fmt::format("unbalance {} {}", significant(unbalance->middle(), 3), u_.force));
    out_.drawing = report::joined(parts, " -- ") +
                   fmt::format("   |{} … {}|", travel(a_.limits.travel_min), travel(a_.limits.travel_max));
  }

  [[nodiscard]] std::string force_text(double force) const {
    return fmt::format("{} {}", significant(force, 4), u_.force);
  }
  [[nodiscard]] const char* mass_word() const { return a_.rotary ? "inertia" : "mass"; }

  const AxisDescription& a_;
  const AxisUnits& u_;
  double period_;
  bool falls_ = false;
  ExplainedAxis out_;
};

}  // namespace

ExplainedAxis explain(const MachineDescription& machine, std::size_t axis) {
  return Explanation(machine, axis).made();
}

}  // namespace stribeck::workflow
