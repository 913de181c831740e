#pragma once
/// Model A: mass, Coulomb and viscous friction by unbiased least squares from trapezoidal pulses.
///
///   w[k+1] = θ1·w[k] + θ2·(f[k−1] + f[k])/2 − θ3·PV[k] − θ4·NV[k]      w[k] = (x[k] − x[k−1])/T
///   α2 = (1 − θ1)/θ2,  α0⁺ = θ3/θ2,  α0⁻ = θ4/θ2 (signed, negative)
///   m  = T/θ2 (forward Euler, as printed)      m = −α2·T/ln θ1 (exact: θ1 is the pole exp(−α2·T/m))
///
/// PV, NV = 1 where w > v_d, w < −v_d. Rows with |w| ≤ v_d, and rows across which w leaves the band, are
/// dropped.
///
/// "Unbiased" is in contrast to the simple fit without PV and NV, which takes Coulomb friction for inertia and viscosity;
/// that fit is returned beside it. Two errors of the printed description are corrected: rows inside the dead band count there as
/// "no friction", and the force of a row is sample k alone although a backward difference lies half a sample earlier.
///
/// Neighbouring rows carry nearly the same disturbance, so the intervals hold for correlated residuals. They
/// describe scatter, not the error of a model with only Coulomb friction and one viscous coefficient.
///
/// Jogs at constant speeds correct the viscous coefficient: ViscousCorrection below.
///
/// Source: thesis (2.11)–(2.20), §2.3.2; Erkorkmaz, Altintas 2001, doi:10.1016/S0890-6955(01)00003-7.
/// Not modelled: Stribeck rise, pre-sliding, anything but a straight line in each direction.
/// Real time: no.
/// Errors: Refused.

#include <array>
#include <optional>
#include <stribeck/friction/conventional.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/methods/jog/jog.hpp>
#include <stribeck/ident/result.hpp>
#include <vector>

namespace stribeck::ident::methods {

struct LeastSquaresAOptions {
  std::optional<double> dead_band;  ///< v_d [m/s]; absent: 0.5 mm/s, at most a tenth of the top speed
  int curve_points = 24;            ///< each direction
  double viscous_from =
      1e-3;  ///< jogs from this speed on give the slope, from a fifth of the fastest one where that is less [m/s]
  Solver solver = Solver::kDerivatives;  ///< of the Stribeck part
};

/// Friction at one constant speed.
struct ObservedFriction {
  double speed = 0.0;     ///< signed [m/s]
  double observer = 0.0;  ///< mean of the disturbance observer [N]
  double kalman = 0.0;    ///< mean of the Kalman estimate [N]
  double error = 0.0;     ///< standard error of either [N]
};

/// Conventional parameters from the means of one observer over jogs, with the mass from the pulses:
///
///   disturbance observer  v̂' = (f − d̂)/m − 40·(v̂ − v),  d̂' = 400·m·(v̂ − v)       both poles at 20 rad/s
///   Kalman                x, v, d from f and x; d a random walk
///
/// The straight line through the means from 1 mm/s on gives α2 and α0±. What lies above this line at lower speeds is the
/// Stribeck part (2.9).
struct ViscousCorrection {
  double alpha2 = 0.0;                                 ///< [N·s/m]
  Interval alpha2_interval;                            ///< 95 %
  double alpha0_positive = 0.0;                        ///< [N]
  double alpha0_negative = 0.0;                        ///< [N], signed
  std::optional<friction::Stribeck<double>> stribeck;  ///< of both directions; absent: no rise at low speeds
};

struct LeastSquaresA {
  std::array<double, 4> theta{};
  double mass_exact = 0.0;       ///< as in `result` [kg]
  double mass_euler = 0.0;       ///< [kg]
  double alpha2 = 0.0;           ///< [N·s/m]
  double alpha0_positive = 0.0;  ///< [N]
  double alpha0_negative = 0.0;  ///< [N], signed
  double simple_mass = 0.0;      ///< of the simple fit: all rows, no Coulomb friction, force of sample k [kg]
  double simple_alpha2 = 0.0;    ///< [N·s/m]
  double dead_band = 0.0;        ///< v_d as used: slower rows are not fitted [m/s]
  std::vector<ObservedFriction> jogs;         ///< in the order of the log
  std::optional<ViscousCorrection> observer;  ///< the one used in `result`, where jogs were given
  std::optional<ViscousCorrection> kalman;
  Result result;
};

LeastSquaresA identify_least_squares_a(const std::vector<log::Record>& records,
                                       const LeastSquaresAOptions& options = {});

/// The same, with the viscous correction from jogs.
LeastSquaresA identify_least_squares_a(const std::vector<log::Record>& pulses,
                                       const std::vector<log::Record>& jogs,
                                       const LeastSquaresAOptions& options = {});

}  // namespace stribeck::ident::methods
