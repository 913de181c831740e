// Trapezoids of force in pairs.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/excitation/excitation_parts.hpp>

namespace stribeck::ident::excitation {
namespace {

constexpr double kBaseScale =
    4.0;  // the scale that just moves the axis (the thesis uses results from K_u = 4 on)
constexpr double kJustMoves = 1.25;    // its height relative to the Coulomb force
constexpr double kFineness = 0.1;      // share of the friction: resolution of rough data
constexpr double kSlower = 0.8;        // factor between the speeds that are tried where the travel is short
constexpr double kSlowest = 0.02;      // smallest of these, as a share of the first one
constexpr double kHardlyMoves = 1e-3;  // share of the speed limit

struct Outcome {
  double top = 0.0;     // [m/s]
  double travel = 0.0;  // [m]
  double stop = 0.0;    // time until the axis rests [s]
};

double trapezoid(double t, double ramp, double hold) {
  if (t < ramp) return t / ramp;
  if (t < ramp + hold) return 1.0;
  return std::max(0.0, (2.0 * ramp + hold - t) / ramp);
}

/// Simulates one pulse on the rough drive.
Outcome predict(const RoughDrive& d, double height, double ramp, double hold) {
  Outcome o;
  double v = 0.0;
  for (double t = 0.0; t < 60.0; t += kStep) {
    const double f = height * trapezoid(t, ramp, hold);
    if (v <= 0.0 && f <= d.coulomb) {
      if (t >= ramp + hold) {
        o.stop = std::max(t, 2.0 * ramp + hold);
        return o;
      }
      continue;
    }
    v = std::max(0.0, v + kStep * (f - d.coulomb - d.viscous * v) / d.mass);
    o.travel += kStep * v;
    o.top = std::max(o.top, v);
  }
  o.stop = 60.0;
  return o;
}

/// Heights of the pulses. Forces above the limits of drive and acceleration are reduced; those just above friction are reduced
/// least.
struct Heights {
  double base = 0.0;     ///< height for K_u = 1 [N]
  double cap = 0.0;      ///< largest force that is allowed [N]
  double squeeze = 1.0;  ///< factor on the part above the Coulomb force
  double coulomb = 0.0;  ///< [N]

  [[nodiscard]] double of(double scale) const {
    const double height = base * scale;
    return height > coulomb ? coulomb + squeeze * (height - coulomb) : height;
  }
};

Heights heights_of(const Limits& limits, const RoughDrive& drive, const PulseDesign& design) {
  Heights h;
  h.coulomb = drive.coulomb;
  h.base = kJustMoves * drive.coulomb / kBaseScale;
  const double largest = h.base * *std::max_element(design.scales.begin(), design.scales.end());
  h.cap = limits.force > 0.0 ? limits.force : largest;
  if (limits.acceleration > 0.0) h.cap = std::min(h.cap, drive.coulomb + drive.mass * limits.acceleration);
  const double spare = (h.cap - drive.coulomb) / drive.coulomb;
  if (largest > h.cap && spare < kFineness) {
    const char* unit = shown(limits).force;
    throw Refused(fmt::format(
        "pulses: the rough friction is {:.4g} {}, and the limits of force and acceleration ({:.4g} {}) are only {} % above it: too little for a force in open loop; choose sine and constant-acceleration, then give their result with --known",
        drive.coulomb, unit, h.cap, unit, digits(100.0 * spare, 2)));
  }
  if (largest > h.cap) h.squeeze = (h.cap - drive.coulomb) / (largest - drive.coulomb);
  return h;
}

/// One pulse, and the motion of the rough drive under it.
struct Pulse {
  double height = 0.0;  ///< [N]
  double ramp = 0.0;    ///< [s]
  double hold = 0.0;    ///< [s]
  bool slower = false;  ///< slower than the limit permits, because the travel is short
  Outcome outcome;      ///< maximum over the assumed drives
};

bool fits(const Outcome& o, const Limits& limits, double start) {
  return start + 1.2 * o.travel <= limits.travel_max || start - 1.2 * o.travel >= limits.travel_min;
}

/// The longest flat top that keeps the speed below `goal`; the flanks become shorter where they alone are too much.
Pulse longest_pulse(const RoughDrive& easy, double coulomb, double height, double goal, double sample_time,
                    const PulseDesign& design) {
  Pulse p;
  p.height = height;
  p.ramp = design.ramp;
  while (p.ramp > 4.0 * sample_time && predict(easy, height, p.ramp, 0.0).top > goal) p.ramp *= 0.8;
  p.hold = design.longest;
  if (predict(easy, height, p.ramp, p.hold).top > goal) {
    double low = 0.0;
    while (p.hold - low > kStep) {
      const double middle = 0.5 * (low + p.hold);
      (predict(easy, height, p.ramp, middle).top > goal ? p.hold : low) = middle;
    }
    p.hold = low;
  } else if (height <= coulomb) {
    p.hold = 0.3 * design.longest;
  }
  p.outcome = predict(easy, height, p.ramp, p.hold);
  return p;
}

/// Reduces the speed where the travel is too short to come to rest.
Pulse design_pulse(const Limits& limits, const RoughDrive& drive, const RoughDrive& easy, double height,
                   double sample_time, const PulseDesign& design) {
  const double target = kReserve * limits.speed;
  for (double goal = target;; goal *= kSlower) {
    Pulse p = longest_pulse(easy, drive.coulomb, height, goal, sample_time, design);
    p.slower = goal < target;
    if (fits(p.outcome, limits, design.start) || goal < kSlowest * target) return p;
  }
}

/// First towards the side with more room, then back.
void append_pair(const Pulse& p, const Limits& limits, double start, Excitation& e) {
  const double first = limits.travel_max - start >= start - limits.travel_min ? 1.0 : -1.0;
  // A braking axis may need longer than predicted: the time is increased by half.
  const double pause = 1.5 * (p.outcome.stop - 2.0 * p.ramp - p.hold) + kRest;
  for (const double direction : {first, -first}) {
    const double needed = std::ceil((2.0 * p.ramp + p.hold + pause) / e.sample_time);
    check_rows("sample_time", static_cast<double>(e.force.size()) + needed, e.sample_time, "pulses",
               "a longer sample time");
    const auto rows = static_cast<std::size_t>(needed);
    for (std::size_t k = 0; k < rows; ++k) {
      e.force.push_back(direction * p.height *
                        trapezoid(e.sample_time * static_cast<double>(k), p.ramp, p.hold));
    }
  }
}

}  // namespace

Excitation design_pulses(const Limits& limits, const RoughDrive& drive, double sample_time,
                         const PulseDesign& design) {
  return pulses_for(limits, drive, {drive.mass, kDoubt * drive.coulomb, kDoubt * drive.viscous}, false,
                    sample_time, design);
}

Excitation pulses_for(const Limits& limits, const RoughDrive& drive, const RoughDrive& easy, bool guess,
                      double sample_time, const PulseDesign& design) {
  check(limits, sample_time, design.start);
  if (!(drive.mass > 0.0) || !(drive.coulomb > 0.0) || drive.viscous < 0.0) {
    throw Refused(
        "pulses: a rough mass and Coulomb force are needed, both positive; a slow jog gives the latter");
  }
  Excitation e;
  e.method = ExcitationMethod::kPulses;
  e.sample_time = sample_time;
  const Shown u = shown(limits);
  const Heights heights = heights_of(limits, drive, design);
  double top = 0.0;
  double farthest = 0.0;
  int moving = 0;
  bool slower = false;
  std::size_t pairs = 0;
  for (const double scale : design.scales) {
    const Pulse p = design_pulse(limits, drive, easy, heights.of(scale), sample_time, design);
    slower |= p.slower;
    if (!fits(p.outcome, limits, design.start) || p.outcome.top > limits.speed) continue;
    ++pairs;
    top = std::max(top, p.outcome.top);
    farthest = std::max(farthest, p.outcome.travel);
    moving += p.height > drive.coulomb;
    append_pair(p, limits, design.start, e);
  }
  if (moving == 0) {
    throw Refused(fmt::format(
        "pulses: no pulse from {:g} {} that moves the axis stays within the travel of {:g} to {:g} {} and within {:g} {}/s",
        design.start * u.per_metre, u.travel, limits.travel_min * u.per_metre,
        limits.travel_max * u.per_metre, u.travel, limits.speed * u.per_metre, u.travel));
  }
  if (!slower && !guess && top < kHardlyMoves * limits.speed) {
    throw Refused(
        fmt::format("pulses: the axis would reach only {:.3g} of {:g} {}/s; the rough {} of {:g} {} or the "
                    "friction is wrong",
                    top * u.per_metre, limits.speed * u.per_metre, u.travel,
                    limits.rotary ? "inertia" : "mass", drive.mass, u.mass));
  }
  stamp(e, e.force.size());
  e.says = fmt::format(
      "pulses: {:.1f} s, {} pulses, {} pairs of them strong enough to move the axis, up to about "
      "{} {}/s and {} {} from the start. Determines the mass best of all methods, and "
      "friction up to the speed reached; below about {:.2g} {}/s the log shows pre-sliding more than "
      "the steady friction.",
      e.t.back(), 2 * pairs, moving, digits(top * u.per_metre), u.travel, digits(farthest * u.per_metre),
      u.travel, 0.5e-3 * u.per_metre, u.travel);
  if (heights.squeeze < 1.0)
    e.says += fmt::format(" Forces are reduced to {} {}, the limits of force and acceleration.",
                          digits(heights.cap, 4), u.force);
  if (slower) e.says += " Speeds are lower than the limit: the travel is short.";
  return e;
}

}  // namespace stribeck::ident::excitation
