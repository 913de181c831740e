// A force that rises slowly beyond break-away.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/excitation/excitation_parts.hpp>

namespace stribeck::ident::excitation {
namespace {

constexpr double kBeyond = 1.3;            // peak of a ramp relative to the rough Coulomb force
constexpr double kBack = 0.2;              // time from the peak to zero [s]
constexpr double kHardlySlips = 10e-6;     // some bristle lengths [m]
constexpr double kFewestRampRows = 100.0;  // of a rise; with fewer rows it is no ramp from rest

// A light axis with little friction must be stopped soon after it slips.
constexpr double kShortestRise = 0.1;  // [s]

/// What to do where the axis would go too far or too fast.
std::string way_out(const RampDesign& design, double rise) {
  if (design.rise) return fmt::format("; take a shorter rise (--rise), now {:.3g} s", rise);
  return fmt::format(
      ", even with a rise of {:.3g} s; the friction is known too roughly for a force in open loop: take a jog, which begins at "
      "0.01 mm/s and shows break-away at each reversal, and give its result with --known",
      rise);
}

struct Slipped {
  double top = 0.0;     // [m/s]
  double travel = 0.0;  // [m]
  double end = 0.0;     // time until the axis rests [s]
};

double ramp_force(double t, double up, double peak) {
  return t < up ? peak * t / up : std::max(0.0, peak * (1.0 - (t - up) / kBack));
}

/// Motion of an axis with less friction than assumed, once it slips.
Slipped predict_slip(const RoughDrive& easy, double up, double peak, double enough) {
  Slipped s;
  double v = 0.0, t = 0.0;
  while ((t < up + kBack || (v > 0.0 && t < 2.0 * up + 60.0)) && s.travel < enough) {
    const double f = ramp_force(t, up, peak);
    if (v > 0.0 || f > easy.coulomb) {
      v = std::max(0.0, v + kStep * (f - easy.coulomb - easy.viscous * v) / easy.mass);
      s.travel += kStep * v;
      s.top = std::max(s.top, v);
    }
    t += kStep;
  }
  s.end = t;
  return s;
}

}  // namespace

Excitation design_ramp(const Limits& limits, const RoughDrive& drive, double sample_time,
                       const RampDesign& design) {
  constexpr double kLongestRise = 15.0;  // [s]
  check(limits, sample_time, design.start);
  if (!(drive.mass > 0.0) || !(drive.coulomb > 0.0) || !(design.rise.value_or(1.0) > 0.0) ||
      design.repeats < 1) {
    throw Refused(
        "ramp: a rough mass and Coulomb force, a time of rise and a number of repeats are needed, all "
        "positive");
  }
  const double peak = kBeyond * drive.coulomb;
  const Shown u = shown(limits);
  if (limits.force > 0.0 && peak > limits.force) {
    throw Refused(fmt::format("ramp: needs {:.4g} {}, the limit of force is {:.4g} {}", peak, u.force,
                              limits.force, u.force));
  }
  const RoughDrive easy{drive.mass, kDoubt * drive.coulomb, kDoubt * drive.viscous};
  const double room = std::min(limits.travel_max - design.start, design.start - limits.travel_min);
  double rise = design.rise.value_or(kLongestRise);
  const double shortest = std::max(kShortestRise, kFewestRampRows * sample_time);
  if (design.rise && rise < kFewestRampRows * sample_time) {
    throw BadDesign(
        "rise",
        fmt::format(
            "ramp: got {:g} s, expected at least {:g} s, {:g} rows (a faster rise is not a slow ramp)", rise,
            kFewestRampRows * sample_time, kFewestRampRows));
  }
  check_rows(design.rise ? "rise" : "repeats",
             2.0 * design.repeats * (kBeyond * rise + kBack + 2.0 * kRest + 0.5) / sample_time, sample_time,
             fmt::format("ramp: {} ramps in each direction with a rise of {:g} s", design.repeats, rise),
             "a shorter rise or fewer repeats");
  Slipped slipped = predict_slip(easy, kBeyond * rise, peak, 2.0 * room);
  while (!design.rise && 0.9 * rise >= shortest &&
         (slipped.top > limits.speed || 1.5 * slipped.travel > room)) {
    rise *= 0.9;
    slipped = predict_slip(easy, kBeyond * rise, peak, 2.0 * room);
  }
  if (slipped.top > limits.speed) {
    throw Refused(fmt::format(
        "ramp: the axis may reach {:.3g} {}/s after it slips, the limit of speed is {:g} {}/s{}",
        slipped.top * u.per_metre, u.travel, limits.speed * u.per_metre, u.travel, way_out(design, rise)));
  }
  if (1.5 * slipped.travel > room) {
    throw Refused(fmt::format(
        "ramp: the axis may move {:.3g} {} after it slips, the nearer end of the travel is {:.3g} {} away{}",
        slipped.travel * u.per_metre, u.travel, room * u.per_metre, u.travel, way_out(design, rise)));
  }
  if (slipped.travel < kHardlySlips) {
    throw Refused(fmt::format(
        "ramp: the axis would slip by {:.3g} {} only; the rough {} of {:g} {} or the friction is wrong",
        slipped.travel * u.per_metre, u.travel, limits.rotary ? "inertia" : "mass", drive.mass, u.mass));
  }
  const double up = kBeyond * rise;
  Excitation e;
  e.method = ExcitationMethod::kRamp;
  e.sample_time = sample_time;
  const double whole = std::max(slipped.end, up + kBack) + 2.0 * kRest + 0.5;
  check_rows(design.rise ? "rise" : "repeats", 2.0 * design.repeats * whole / sample_time, sample_time,
             fmt::format("ramp: {} ramps in each direction with a rise of {:g} s", design.repeats, rise),
             "a shorter rise or fewer repeats");
  const auto rows = static_cast<std::size_t>(std::ceil(whole / sample_time));
  for (int i = 0; i < design.repeats; ++i) {
    for (const double direction : {1.0, -1.0}) {
      for (std::size_t k = 0; k < rows; ++k) {
        e.force.push_back(direction * ramp_force(sample_time * static_cast<double>(k), up, peak));
      }
    }
  }
  stamp(e, e.force.size());
  e.says = fmt::format(
      "ramp: {:.1f} s, {} ramps in each direction, up to {:.4g} {} with {:.3g} {}/s; after the slip "
      "the axis moves up to about {} {}. Determines the force and the distance of break-away; "
      "does not determine friction at speed or the mass.",
      e.t.back(), design.repeats, peak, u.force, peak / up, u.force, digits(slipped.travel * u.per_metre, 2),
      u.travel);
  return e;
}

}  // namespace stribeck::ident::excitation
