#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/digits.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>
#include <stribeck/workflow/machine/description.hpp>

namespace stribeck::workflow {
namespace {

constexpr double kSampledWell = 0.2;  // ω·T
constexpr double kOfDelay =
    0.3;  // ω times one and a half periods and the delay: 43 degrees of margin with eight periods
constexpr double kRipple = 0.15;       // of the friction, by one step of the encoder
constexpr double kShort = 1e-3;        // [s]: what a force does over less is hardly seen in the motion
constexpr double kSpike = 0.1;         // of the force limit, by one step of the encoder over a shorter period
constexpr double kStiff = 80.0;        // [rad/s]
constexpr double kSlowest = 5.0;       // [rad/s]: below it no loop holds against friction
constexpr double kRippleAtMost = 0.5;  // of the friction, where friction would hold the axis too far off
constexpr double kOff = 0.005;         // of the travel, by which friction may hold the axis off its reference
constexpr double kLongestPeriod = 30.0;  // of the sine [s]
constexpr double kShareOfTravel = 1.0 / 3.0;
constexpr double kShareOfSpeed = 0.9;
constexpr double kShareOfAcceleration = 0.5;

Proposed from_file(double value) { return {value, "as the machine file says"}; }

Proposed omega_of(const AxisDescription& axis, double period) {
  const AxisUnits& units = units_of(axis.rotary);
  const double delay =
      axis.plant ? (axis.plant->delay_periods + axis.plant->delay_fraction.value_or(0.0)) * period : 0.0;
  const double sampled = kSampledWell / period, late = kOfDelay / (1.5 * period + delay);
  const double step = axis.name_plate().encoder_resolution;
  const double mass = axis.commissioning.mass.middle();
  const double friction = axis.commissioning.friction.middle();
  // The difference of two encoder values puts a step into the force of one period alone.
  const bool brief = period < kShort;
  const double limit = axis.name_plate().force;
  const double spike = brief && limit > 0.0 ? kSpike * limit * period : kInfinity;
  const double impulse = std::min(kRipple * friction * std::max(period, kShort), spike);
  const double quiet = step > 0.0 ? impulse / (2.0 * mass * step) : kInfinity;
  const double off = kOff * (axis.limits.travel_max - axis.limits.travel_min);
  const double firm = std::min(std::sqrt(friction / (mass * off)), quiet * kRippleAtMost / kRipple);
  Proposed p{std::min({sampled, late, std::max(quiet, firm), kStiff}), {}};
  if (p.value == firm) {
    p.reason = fmt::format(
        "below it friction alone would hold the axis more than {:.3g} {} off its reference; one step of the encoder "
        "({:.4g} {}) moves the force by {} % of the friction",
        friction / (mass * firm * firm) * units.per_metre, units.travel, step * units.per_metre_fine,
        units.fine, ident::digits(100.0 * kRipple * firm / quiet, 2));
  } else if (p.value == quiet) {
    p.reason = fmt::format(
        "above it one step of the encoder ({:.4g} {}) would move the force by more than {:.0f} % of {}",
        step * units.per_metre_fine, units.fine, 100.0 * (impulse == spike ? kSpike : kRipple),
        impulse == spike ? "its limit"
        : brief          ? "the friction, as a mean over 1 ms"
                         : "the friction");
  } else if (delay > 0.0 && p.value == late) {
    p.reason =
        fmt::format("{:g} over one and a half control periods and the delay of {:.3g} ms: margins stay",
                    kOfDelay, 1e3 * delay);
  } else if (p.value == sampled) {
    p.reason = fmt::format("{:g} over the control period: the loop is sampled well", kSampledWell);
  } else {
    p.reason = "elasticity of a common drive is not excited";
  }
  if (p.value < kSlowest) {
    p = {std::min({kSlowest, sampled, late}),
         fmt::format(
             "the least that holds an axis; the encoder is coarse: one step moves the force by {:.2g} {}",
             2.0 * kSlowest * mass * step / period, units.force)};
  }
  return p;
}

}  // namespace

sim::NamePlate AxisDescription::name_plate() const {
  sim::NamePlate own = plant ? sim::NamePlate::of(*plant) : sim::NamePlate{};
  if (drive) {
    own.force = drive->peak().value_or(own.force > 0.0 ? own.force : drive->rated().value_or(0.0));
    own.encoder_resolution = drive->resolution().value_or(own.encoder_resolution);
  }
  return {limits.force.value_or(own.force),
          commissioning.encoder_resolution.value_or(own.encoder_resolution)};
}

double AxisDescription::force_per_volt() const {
  if (plant) return plant->force_gain();
  if (drive && drive->rated() && drive->voltage_at_rated) return *drive->rated() / *drive->voltage_at_rated;
  return 0.0;
}

Proposal propose(const AxisDescription& axis, double sample_time) {
  const RoughAxis& c = axis.commissioning;
  const sim::AxisLimits& limits = axis.limits;
  Proposal p;
  p.omega = c.omega ? from_file(*c.omega) : omega_of(axis, sample_time);
  p.observer_pole =
      c.observer_pole
          ? from_file(*c.observer_pole)
          : Proposed{0.5 * p.omega.value, "half of omega: slower than the loop, faster than friction drifts"};
  p.sine_offset = c.sine_offset
                      ? from_file(*c.sine_offset)
                      : Proposed{0.5 * (limits.travel_min + limits.travel_max), "middle of the travel"};
  const double third = kShareOfTravel * (limits.travel_max - limits.travel_min);
  const double short_enough = kShareOfSpeed * limits.speed * kLongestPeriod / (2.0 * kPi);
  p.sine_amplitude =
      c.sine_amplitude ? from_file(*c.sine_amplitude)
      : third <= short_enough || c.sine_frequency
          ? Proposed{third, "a third of the travel on both sides of the middle"}
          : Proposed{short_enough, fmt::format("a period of {:g} s at this speed", kLongestPeriod)};
  if (c.sine_frequency) {
    p.sine_frequency = from_file(*c.sine_frequency);
    return p;
  }
  const double by_speed = kShareOfSpeed * limits.speed / p.sine_amplitude.value;
  const double by_acceleration =
      std::sqrt(kShareOfAcceleration * limits.acceleration / p.sine_amplitude.value);
  p.sine_frequency =
      by_speed <= by_acceleration
          ? Proposed{by_speed,
                     fmt::format("reaches {:.4g} {}/s, {:.0f} % of the speed limit",
                                 by_speed * p.sine_amplitude.value * units_of(axis.rotary).per_metre,
                                 units_of(axis.rotary).travel, 100.0 * kShareOfSpeed)}
          : Proposed{by_acceleration,
                     fmt::format("uses {:.0f} % of the acceleration limit", 100.0 * kShareOfAcceleration)};
  return p;
}

sim::Machine as_machine(const MachineDescription& d) {
  sim::Machine machine;
  machine.name = d.name;
  machine.origin = d.origin;
  machine.sample_time = d.sample_time;
  for (const auto& [name, a] : d.axes) {
    sim::MachineAxis axis;
    if (a.plant) axis.plant = *a.plant;
    axis.limits = a.limits;
    axis.published = a.published;
    axis.drive_loop = a.drive_loop;
    axis.rotary = a.rotary;
    const Proposal p = propose(a, d.sample_time);
    const RoughAxis& c = a.commissioning;
    axis.commissioning = {c.mass.middle(),        c.friction.middle(), p.omega.value,
                          p.observer_pole.value,  p.sine_offset.value, p.sine_amplitude.value,
                          p.sine_frequency.value, c.encoder_resolution};
    // What the data sheet of the drive says goes before what the simulation would make of the true one.
    if (a.drive) {
      // Rounded numbers of a data sheet may be a little above those of the simulated drive.
      if (const auto peak = a.drive->peak(); peak && !axis.limits.force)
        axis.limits.force = a.plant ? std::min(*peak, sim::NamePlate::of(*a.plant).force) : *peak;
      if (!axis.commissioning.encoder_resolution)
        axis.commissioning.encoder_resolution = a.drive->resolution();
    }
    machine.axes.emplace_back(name, std::move(axis));
  }
  return machine;
}

}  // namespace stribeck::workflow
