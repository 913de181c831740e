#pragma once
/// What to run on the machine so that a log of it determines friction and mass.
///
///   pulses  force, open loop: trapezoids in pairs (+, −) of height base·K_u,
///           K_u = 1, 1.5, 3, 4, 5, 6, 7, 8, 8.5, 9
///   jog     position, closed loop: constant speeds forward and back
///   sine    position, closed loop: r = r0 − A + A·cos φ, φ' = ω after one second of run-in from rest; then, if asked for,
///           strokes at constant speed, out and back. A sine has one speed at each place, so that alone it takes a force
///           periodic in position for friction over speed, and a spring for mass; or r = r0 + A·sin φ (Model D)
///   ramp    force, open loop: slowly up to beyond break-away, quickly back, in both directions
///   constant acceleration   position, closed loop: triangles of speed
///   multisine   position, closed loop: strokes at constant speed v, and on them Σ aᵢ/ωᵢ²·cos(ωᵢt + φᵢ), random φᵢ for each stroke,
///           ωᵢ harmonics of one period in about equal ratios; |its speed| ≤ v/2, so that friction never changes its sign
///
/// An axis with friction does not move below the break-away force, and above it the speed depends on the excess. Pulses
/// therefore need a rough estimate of the drive; a slow jog gives the Coulomb force. Base is chosen so that K_u = 4 just moves
/// the axis; smaller scales show the bristle alone. The length of every pulse follows from the speed predicted with 15 % less
/// friction, because the estimate is rough. Friction that the estimate lacks keeps the axis slower than predicted: identify a
/// first run, improve the estimate with rough_drive(), design again.
///
/// Positions can also be written as G-code, for controls that take no table. Forces cannot.
///
/// Position tables start at r0, force tables at rest. A design that would break a limit is not returned.
///
/// Source: thesis §2.3.2 (figs 2.9–2.11), §2.3.3, (2.33), (2.38), §4.4.1, §4.5.3.
/// Not modelled: the machine's own limits of jerk; elasticity.
/// Real time: no.
/// Errors: Refused names the limit, the value asked for and one that would fit; BadDesign also names the parameter of the
/// design that is wrong.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/result.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::ident::excitation {

/// Largest number of rows of a design: some hours at the period of a servo loop, a file of about 100 MB.
inline constexpr std::size_t kMostRows = 2000000;
/// Way that tells a force periodic in position from a load: several turns of the usual screws [m].
inline constexpr double kSeveralTurns = 0.1;

/// A parameter of a design that makes no sense or too many rows.
struct BadDesign : Refused {
  BadDesign(const char* named, const std::string& message) : Refused(message), parameter(named) {}
  const char* parameter;  ///< its name in the design: "rise", "speeds", "period", "periods", "repeats"
};

struct Limits {
  double travel_min = 0.0;    ///< [m]
  double travel_max = 0.0;    ///< [m]
  double speed = 0.0;         ///< [m/s]
  double acceleration = 0.0;  ///< [m/s²]
  double force = 0.0;         ///< [N]
  bool rotary = false;        ///< the axis turns: messages are in deg and N m
};

/// What is known of the drive before the experiment; within 20 % is good enough.
struct RoughDrive {
  double mass = 0.0;     ///< [kg]
  double coulomb = 0.0;  ///< break-away and Coulomb force [N]
  double viscous = 0.0;  ///< [N·s/m]
};

/// A straight line through the identified curve, taken from the direction with the larger friction, and the mass.
RoughDrive rough_drive(const Result& first);

/// The kinds of excitation. EnumNames has the words of options and files.
enum class ExcitationMethod { kPulses, kRamp, kJog, kSine, kPositionSine, kConstantAcceleration, kMultisine };

struct Excitation {
  ExcitationMethod method = ExcitationMethod::kPulses;
  double sample_time = 0.0;   ///< [s]
  std::vector<double> t;      ///< [s]
  std::vector<double> r;      ///< [m]; empty for pulses
  std::vector<double> force;  ///< [N]; empty for closed loop
  std::string says;           ///< in words: duration, travel and what a log of it will determine
};

struct PulseDesign {
  std::vector<double> scales{1.0, 1.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 8.5, 9.0};
  double start = 0.0;    ///< position before the first pulse [m]
  double ramp = 0.2;     ///< of each flank [s]
  double longest = 1.0;  ///< of the flat top [s]
};
Excitation design_pulses(const Limits& limits, const RoughDrive& drive, double sample_time,
                         const PulseDesign& design = {});

/// Speeds of thesis §2.3.3 and §4.4.1 up to `fastest` [m/s], then each a quarter higher, and `fastest` itself.
std::vector<double> jog_speeds(double fastest);

/// Not from slow to fast, so that a friction that changes in time is not taken for friction over speed; the fastest and two
/// others come again at the end, which shows such a change.
std::vector<double> in_mixed_order(std::vector<double> speeds);

struct JogDesign {
  std::vector<double> speeds = jog_speeds(9.0e-3);  ///< [m/s]
  double start = 0.0;                               ///< [m]
  double direction = 1.0;                           ///< of the first stroke: +1 or −1
  bool both_sides = false;  ///< the strokes of every other speed lie on the other side of the start
  double period =
      0.0;  ///< of a term periodic in position: every stroke is a whole number of it long, where it fits [m]
  double way = 0.0;  ///< of the fastest speed without a period, where travel and ten seconds suffice [m]
};
Excitation design_jog(const Limits& limits, double sample_time, const JogDesign& design = {});
/// Takes the slowest speeds out until the jogs have at most kMostRows rows, which short periods reach; eight speeds stay. Returns whether
/// any was taken out.
bool leave_out_slowest(const Limits& limits, double sample_time, JogDesign& design);
/// The fastest speed below the limit that the travel from `start` allows for a second at constant speed [m/s].
double fastest_jog(const Limits& limits, double sample_time, const JogDesign& design = {});

struct SineDesign {
  double start = 0.0;        ///< r0 [m]
  double amplitude = 0.02;   ///< A [m]; the motion goes from r0 to r0 − 2A
  double frequency = 0.475;  ///< ω [rad/s]
  int periods = 4;
  bool from_middle = false;  ///< r0 + A·sin φ instead
  int strokes = 0;           ///< speeds of the strokes after a sine that begins at its end
};
Excitation design_sine(const Limits& limits, double sample_time, const SineDesign& design = {});

struct RampDesign {
  double start = 0.0;  ///< [m]
  /// Time until the force reaches the rough Coulomb force [s]; absent: at most 15 s, shorter where the axis would slip too
  /// far or too fast.
  std::optional<double> rise;
  int repeats = 4;  ///< of each direction
};
Excitation design_ramp(const Limits& limits, const RoughDrive& drive, double sample_time,
                       const RampDesign& design = {});

struct AccelerationDesign {
  double start = 0.0;      ///< [m]
  double direction = 1.0;  ///< of the first stroke: +1 or −1
  double flank =
      1.0;  ///< time from rest to the highest speed [s]; down to a quarter of it where the travel is short
  int repeats = 5;  ///< of each direction
};
/// Flanks of a quarter of the time, and four times as many, where the inertia of the usual ones is less than a third of friction: the mass
/// shows in proportion to the acceleration, and in a longer log only by the root of its length. Rough mass [kg] and friction [N].
AccelerationDesign acceleration_design(const Limits& limits, double start, double mass, double friction);
Excitation design_constant_acceleration(const Limits& limits, double sample_time,
                                        const AccelerationDesign& design = {});

struct MultisineDesign {
  double start = 0.0;      ///< the middle of the strokes [m]
  double direction = 1.0;  ///< of the first stroke: +1 or −1
  double period = 2.0;     ///< of the multisine, rounded to whole rows [s]
  double lowest = 1.0;     ///< first line [Hz]
  std::optional<double>
      highest;  ///< last line [Hz]; absent: 0.8 of half the sampling frequency, at most 400 Hz
  std::optional<double>
      speed;               ///< of the strokes [m/s]; absent: 0.4 of the limit, less where the travel is short
  int periods = 4;         ///< of each stroke; the first one is for settling
  int repeats = 4;         ///< strokes in each direction
  std::uint64_t seed = 1;  ///< of the phases
};
/// The drive says how much of its force is left beside friction.
Excitation design_multisine(const Limits& limits, const RoughDrive& drive, double sample_time,
                            const MultisineDesign& design = {});

/// Unit of an axis in G-code: of a rotary axis, whose positions are arcs at a radius of 1 m, the degree.
enum class GcodeUnit { kMillimetre, kDegree };

/// What stands before a position of this axis in G-code: "X" for x, "X1=" for an axis x1 of a SINUMERIK; empty: G-code has no such axis.
std::string gcode_word(const std::string& axis);
/// Why G-code has no such axis, and the way out; empty: it has.
std::string why_no_gcode(const std::string& axis);

/// The motion as G-code of LinuxCNC's dialect (G21 G90 G64, G1 with a feed for each move) for an axis letter, and of SINUMERIK's
/// where a number follows the letter. A constant speed is one move; other motions are moves of about 20 ms. Refused for forces, which G-code cannot command.
/// Degrees are those of an arc at this radius [m].
std::string as_gcode(const Excitation& excitation, const std::string& axis, const std::string& machine,
                     GcodeUnit unit = GcodeUnit::kMillimetre, double radius = 1.0);

}  // namespace stribeck::ident::excitation

template <>
struct stribeck::EnumNames<stribeck::ident::excitation::ExcitationMethod> {
  using M = stribeck::ident::excitation::ExcitationMethod;
  static constexpr std::array names{
      std::pair{M::kPulses, std::string_view{"pulses"}},
      std::pair{M::kRamp, std::string_view{"ramp"}},
      std::pair{M::kJog, std::string_view{"jog"}},
      std::pair{M::kSine, std::string_view{"sine"}},
      std::pair{M::kPositionSine, std::string_view{"position-sine"}},
      std::pair{M::kConstantAcceleration, std::string_view{"constant-acceleration"}},
      std::pair{M::kMultisine, std::string_view{"multisine"}}};
};
