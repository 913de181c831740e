// Speeds and masses that no machine has: a unit is wrong, mostly by a factor of 1000.
#include <fmt/core.h>

#include <cmath>
#include <stribeck/ident/log/faults/faults.hpp>
#include <stribeck/ident/refused.hpp>

namespace stribeck::ident::log::parts {

void refuse_implausible_drive(const Coverage& c, const RoughFit& rough, const std::string& source,
                              const std::string& force_unit, const std::string& position_unit, Notes& notes) {
  // Linear motors reach 10 m/s, spindles 20 000 rad/s.
  constexpr double kMostSpeed = 30.0;
  constexpr double kMostTurning = 5e4;
  // The tables of the largest gantries weigh some hundred tonnes.
  constexpr double kMostMass = 2e6;
  constexpr double kMostInertia = 1e7;
  const bool turns = turning(position_unit);
  const double fastest = std::max(c.v_max, -c.v_min);
  if (fastest > (turns ? kMostTurning : kMostSpeed)) {
    throw Refused(source +
                  fmt::format(": a speed of {:.4g} {}/s, which no feed drive has: the unit of position or "
                              "time is wrong, perhaps mm for m or ms for s (give the right one with --map "
                              "x=\"COLUMN UNIT\" or t=\"COLUMN UNIT\")",
                              fastest, turns ? "rad" : "m"));
  }
  const bool newton = force_unit == "N" || force_unit == "N m";
  if (!newton || !rough.good || !rough.mass_shows) return;
  if (std::abs(rough.mass) > (turns ? kMostInertia : kMostMass)) {
    throw Refused(source +
                  fmt::format(": a {} of {:.3g} {}, which no feed drive has: the unit of position, time or "
                              "force is wrong, perhaps m for mm or s for ms (give the right one with --map "
                              "x=\"COLUMN UNIT\" or t=\"COLUMN UNIT\")",
                              turns ? "moment of inertia" : "mass", std::abs(rough.mass),
                              turns ? "kg m2" : "kg"));
  }
  // Guides, seals and screws rub with 0.1 to 10 % of the weight; a small motor behind a fine screw with 0.1 %.
  constexpr double kGravity = 9.81;
  constexpr double kLeastFriction = 2e-4;
  const double fastest_friction = std::abs(rough.coulomb) + std::abs(rough.viscous) * fastest;
  if (turns || !rough.friction_shows || fastest_friction > kLeastFriction * kGravity * std::abs(rough.mass))
    return;
  notes.add_all(
      "scale", source, false,
      fmt::format("a mass of {:.3g} kg with {:.3g} N of friction at up to {:.3g} mm/s: hardly any machine "
                  "is so, and the unit of position, time or force may be wrong, perhaps m for mm (give "
                  "the right one with --map x=\"COLUMN UNIT\")",
                  std::abs(rough.mass), fastest_friction, 1e3 * fastest),
      {rough.mass, fastest_friction});
}

}  // namespace stribeck::ident::log::parts
