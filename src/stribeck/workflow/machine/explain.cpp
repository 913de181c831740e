// What a machine file says, in the numbers that follow from it.
#include <fmt/format.h>

#include <cmath>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>

namespace stribeck::workflow {
namespace {

using report::short_number;
using report::significant;

std::string mm(double x) { return short_number(x * 1e3) + " mm"; }

/// A value or a range, and how far the truth may be.
Explained rough(const char* what, const Rough& r, const char* unit) {
  if (r.is_range()) {
    return {what, fmt::format("{} to {} {}", short_number(r.low()), short_number(r.high()), unit),
            "as certain as you say: excitations are safe inside this range"};
  }
  return {what, fmt::format("{} {}", short_number(r.middle()), unit),
          fmt::format("one value: excitations are safe from {} to {} {}; a range makes them stronger",
                      significant(r.low(), 3), significant(r.high(), 3), unit)};
}

class Explanation {
 public:
  Explanation(const MachineDescription& machine, std::size_t axis)
      : a_(machine.axes[axis].second), period_(machine.sample_time) {
    out_.name = machine.axes[axis].first;
  }

  ExplainedAxis made() {
    limits();
    drive();
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

  void limits() {
    const sim::AxisLimits& l = a_.limits;
    add("travel", fmt::format("{} to {}", mm(l.travel_min), mm(l.travel_max)));
    std::string note = fmt::format("{} m/min, {} in one control period", short_number(l.speed * 60.0),
                                   significant(l.speed * period_ * 1e6, 3) + " µm");
    if (const auto top = a_.drive ? a_.drive->top_speed() : std::nullopt) {
      note += fmt::format("; the motor allows {} mm/s", significant(*top * 1e3, 4));
      if (*top < l.speed) note += ", which is less: lower it";
    }
    add("speed", short_number(l.speed * 1e3) + " mm/s", note);
    add("acceleration", short_number(l.acceleration * 1e3) + " mm/s2",
        fmt::format("top speed after {} s and {}", significant(l.speed / l.acceleration, 3),
                    significant(0.5e3 * l.speed * l.speed / l.acceleration, 3) + " mm"));
    out_.numbers["travel_mm"] = {l.travel_min * 1e3, l.travel_max * 1e3};
    out_.numbers["speed_mm_per_s"] = l.speed * 1e3;
  }

  void drive() {
    const double force = a_.force_limit();
    const double per_volt = a_.force_per_volt();
    const std::optional<double> rated = a_.drive ? a_.drive->rated() : std::nullopt;
    if (rated) {
      const auto r = a_.drive->radius();
      add("force at 100 %", significant(*rated, 4) + " N",
          fmt::format("1 ‰ (CiA 402) is {} N; for logs in percent: --gain \"{} N/%\"",
                      significant(*rated / 1e3, 4), significant(*rated / 100.0, 6)));
      if (r) add("travel per turn", significant(2e3 * kPi * *r, 6) + " mm of the motor");
      out_.numbers["force_at_100_percent_N"] = *rated;
    }
    if (per_volt > 0.0) add("force per volt", significant(per_volt, 4) + " N/V");
    if (force > 0.0) {
      std::string note = a_.limits.force                 ? "as limits.force says"
                         : a_.drive && a_.drive->peak()  ? "peak or limit of the drive"
                         : a_.drive && a_.drive->rated() ? "rated: the file says no peak and no limit"
                                                         : "of the virtual drive";
      const double spare = force - a_.commissioning.friction.middle() - std::abs(a_.commissioning.load);
      note += fmt::format("; less friction and load it accelerates by {} mm/s2",
                          significant(spare / a_.commissioning.mass.middle() * 1e3, 3));
      if (spare < a_.commissioning.mass.middle() * a_.limits.acceleration)
        note += ", which is below the limit of acceleration: lower that";
      add("largest force", significant(force, 4) + " N", note);
      out_.numbers["largest_force_N"] = force;
    }
    if (const auto rotor = a_.drive ? a_.drive->reflected_mass() : std::nullopt) {
      add("rotor as mass", significant(*rotor, 3) + " kg", "part of the mass below, which is the whole");
      out_.numbers["reflected_mass_kg"] = *rotor;
    }
    const double step = a_.name_plate().encoder_resolution;
    if (step > 0.0) {
      add("encoder", significant(step * 1e6, 4) + " µm",
          fmt::format("one step in one control period is {} mm/s", significant(step / period_ * 1e3, 3)));
      out_.numbers["encoder_resolution_um"] = step * 1e6;
    }
  }

  void known() {
    const RoughAxis& c = a_.commissioning;
    out_.lines.push_back(rough("mass", c.mass, "kg"));
    out_.lines.push_back(rough("friction", c.friction, "N"));
    falls_ = std::abs(c.load) >= c.friction.low();
    if (c.load != 0.0) {
      add("load", short_number(c.load) + " N",
          falls_ ? "the axis may fall without force: open-loop excitations are refused"
                 : "friction holds it");
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
        fmt::format("{} ± {} at {} rad/s", mm(p.sine_offset.value), mm(p.sine_amplitude.value),
                    significant(p.sine_frequency.value, 3)),
        p.sine_frequency.reason);
    add("to excite",
        falls_ ? "jog, sine, position-sine, constant-acceleration"
               : "jog, sine, constant-acceleration; then pulses --known",
        "jog: friction from the lowest speed; constant-acceleration: mass; sine: reversals");
    out_.numbers["omega_rad_per_s"] = p.omega.value;
    out_.numbers["observer_pole_per_s"] = p.observer_pole.value;
  }

  void lacks() {
    if (!(a_.force_limit() > 0.0))
      out_.lacks.push_back("excite: the largest force, limits.force or drive with rated_torque and lead");
    if (!(a_.name_plate().encoder_resolution > 0.0))
      out_.lacks.push_back("to propose omega with regard to the encoder: commissioning.encoder_resolution");
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
                                   : std::string("linear motor"));
      if (d.gear != 1.0) parts.push_back("gear " + short_number(d.gear));
      if (d.lead) parts.push_back("screw " + mm(*d.lead));
      if (d.pulley_diameter) parts.push_back("pulley Ø" + mm(*d.pulley_diameter));
      if (d.travel_per_turn) parts.push_back(mm(*d.travel_per_turn) + " per turn");
    } else {
      parts.emplace_back("drive");
    }
    parts.push_back(fmt::format("axis {}, {} kg", out_.name, short_number(a_.commissioning.mass.middle())));
    if (a_.commissioning.load != 0.0) parts.push_back("load " + short_number(a_.commissioning.load) + " N");
    out_.drawing = report::joined(parts, " -- ") +
                   fmt::format("   |{} … {}|", mm(a_.limits.travel_min), mm(a_.limits.travel_max));
  }

  const AxisDescription& a_;
  double period_;
  bool falls_ = false;
  ExplainedAxis out_;
};

}  // namespace

ExplainedAxis explain(const MachineDescription& machine, std::size_t axis) {
  return Explanation(machine, axis).made();
}

}  // namespace stribeck::workflow
