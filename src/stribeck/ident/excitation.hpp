#pragma once
/// What to run on the machine so that a log of it determines friction and mass.
///
///   pulses  force, open loop: trapezoids in pairs (+, −) of height base·K_u,
///           K_u = 1, 1.5, 3, 4, 5, 6, 7, 8, 8.5, 9
///   jog     position, closed loop: constant speeds forward and back
///   sine    position, closed loop: r = r0 − A + A·cos φ, φ' = ω after one second of run-in from rest
///
/// An axis with friction does not move below the force of break-away, and above it the speed depends on how
/// much above: pulses need a rough idea of the drive (a slow jog gives the Coulomb force). Base is chosen so
/// that K_u = 4 just moves the axis; smaller scales show the bristle alone. The length of every pulse follows
/// from the speed predicted with 15 % less friction, since the idea is rough. Friction that it leaves out
/// keeps the axis slower than predicted: identify a first run, make a better idea of it with rough_drive(),
/// design again.
///
/// Position tables start at r0; force tables start at rest. A design that would break a limit is not
/// returned.
///
/// Source: thesis §2.3.2 (figs 2.9–2.11), §2.3.3, (2.33).
/// Not modelled: the machine's own limits of jerk; elasticity.
/// Real time: no.
/// Errors: Refused names the limit, what was asked and what would fit.

#include <stribeck/ident/record.hpp>
#include <stribeck/ident/result.hpp>
#include <string>
#include <vector>

namespace stribeck::ident {

struct Limits {
  double travel_min = 0.0;    ///< [m]
  double travel_max = 0.0;    ///< [m]
  double speed = 0.0;         ///< [m/s]
  double acceleration = 0.0;  ///< [m/s²]
  double force = 0.0;         ///< [N]
};

/// What is known of the drive before the experiment; 20 % is good enough.
struct RoughDrive {
  double mass = 0.0;     ///< [kg]
  double coulomb = 0.0;  ///< break-away and Coulomb force [N]
  double viscous = 0.0;  ///< [N·s/m]
};

/// The straight line through an identified curve, its larger side, and the mass.
RoughDrive rough_drive(const Result& first);

struct Excitation {
  std::string method;         ///< "pulses", "jog", "sine"
  double sample_time = 0.0;   ///< [s]
  std::vector<double> t;      ///< [s]
  std::vector<double> r;      ///< [m]; empty for pulses
  std::vector<double> force;  ///< [N]; empty for closed loop
  std::string says;           ///< how long, how far, what it will determine
};

struct PulseDesign {
  std::vector<double> scales{1.0, 1.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 8.5, 9.0};
  double start = 0.0;    ///< position before the first pulse [m]
  double ramp = 0.2;     ///< of each flank [s]
  double longest = 1.0;  ///< of the flat top [s]
};
Excitation design_pulses(const Limits& limits, const RoughDrive& drive, double sample_time,
                         const PulseDesign& design = {});

struct JogDesign {
  std::vector<double> speeds{0.01e-3, 0.02e-3, 0.05e-3, 0.1e-3, 0.2e-3, 0.3e-3, 0.5e-3, 0.75e-3, 1e-3,
                             2e-3,    3e-3,    4e-3,    5e-3,   6e-3,   7e-3,   8e-3,   9e-3};  ///< [m/s]
  double start = 0.0;                                                                           ///< [m]
  double direction = 1.0;  ///< first way: +1 or −1
};
Excitation design_jog(const Limits& limits, double sample_time, const JogDesign& design = {});

struct SineDesign {
  double start = 0.0;        ///< r0 [m]
  double amplitude = 0.02;   ///< A [m]; the motion goes from r0 to r0 − 2A
  double frequency = 0.475;  ///< ω [rad/s]
  int periods = 4;
};
Excitation design_sine(const Limits& limits, double sample_time, const SineDesign& design = {});

}  // namespace stribeck::ident
