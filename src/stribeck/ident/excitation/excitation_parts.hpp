#pragma once
/// Inside of excitation.hpp: what every design checks and writes. Each design has its own file.
/// Real time: no.

#include <cstddef>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/excitation/excitation.hpp>
#include <string>

namespace stribeck::ident::excitation {

inline constexpr double kReserve = 0.95;  ///< share of the speed limit that is used
/// Share of the friction with which speeds are predicted, because the estimate of the drive is rough.
inline constexpr double kDoubt = 0.85;
inline constexpr double kRest = 0.15;  ///< pause between motions, after the axis has stopped [s]
inline constexpr double kStep = 1e-3;  ///< time step of the prediction [s]

/// The units of messages. An axis that turns is carried as one that moves at a radius of 1 m, and read in degrees.
struct Shown {
  double per_metre = 1e3;
  const char* travel = "mm";
  const char* force = "N";
  const char* mass = "kg";
};
inline Shown shown(const Limits& l) noexcept {
  return l.rotary ? Shown{180.0 / kPi, "deg", "N m", "kg m2"} : Shown{};
}

/// Pulses whose length follows from the `easy` drive, which goes farthest; with a `guess` of it nothing is said about pulses that
/// hardly move the expected one.
Excitation pulses_for(const Limits& limits, const RoughDrive& drive, const RoughDrive& easy, bool guess,
                      double sample_time, const PulseDesign& design);

/// A stroke out and back at constant speed, with a short rest after each.
struct Strokes {
  double start = 0.0;      ///< [m]
  double direction = 1.0;  ///< of the first stroke: +1 or −1
  double speed = 0.0;      ///< [m/s]
  double ramp = 0.0;       ///< of each flank [s]
  double flat = 0.0;       ///< at constant speed [s]
};
void append(const Strokes& strokes, Excitation& e);

/// Flanks of a stroke with half of the permitted acceleration, and the longest time of constant speed in the room.
struct Profile {
  double ramp = 0.0;     ///< [s]
  double longest = 0.0;  ///< [s]
};
Profile profile_of(const Limits& limits, double sample_time, double room, double speed);

/// Refuses limits without speed or travel, and a start outside the travel.
void check(const Limits& l, double sample_time, double start);

/// Refuses designs with too many rows before anything is filled. The number of rows is no integer here, because one that is
/// asked for may not fit an integer.
void check_rows(const char* parameter, double rows, double sample_time, const std::string& what,
                const std::string& way_out);

/// Times of that many rows.
void stamp(Excitation& e, std::size_t rows);

/// Refuses positions beyond travel, speed or acceleration.
void check_positions(const Excitation& e, const Limits& l);

}  // namespace stribeck::ident::excitation
