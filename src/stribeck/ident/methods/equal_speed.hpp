#pragma once
/// Load and mass from two runs through the same speed, without any model of friction.
///
///   load   g = (F(+v) + F(−v))/2             forward and backward at one speed, where friction is the same
///   mass   m = Σ z̃·f̃ / Σ z̃·ã                rows of one direction and nearly one speed, where friction is the
///                                            same, while accelerating and while braking
///
/// ~: less the mean over the row's bin of speed. z is the instrument of motion.hpp (acceleration of the reference), so that
/// noise of the measured position does not bias the mass. A run of constant acceleration (triangles of speed, thesis §4.5.3)
/// or a sine serves equally well.
///
/// The load is called constant when the half sums of all speeds agree within their errors. If they do not, friction differs
/// between the directions, and no run at constant speed can then separate it from a load.
///
/// Source: thesis §4.5.3; Robinson 1988, doi:10.2307/1912705.
/// Not modelled: friction that depends on acceleration (rows near a reversal are left out); friction that depends on position,
/// except with the given periods.
/// Real time: no.
/// Errors: Refused, with the reason.

#include <optional>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/map/steady_runs.hpp>
#include <stribeck/ident/result.hpp>
#include <vector>

namespace stribeck::ident::methods {

/// One speed that was run forward and backward.
struct SpeedPair {
  double speed = 0.0;     ///< [m/s]
  double load = 0.0;      ///< half the sum [N]
  double friction = 0.0;  ///< half the difference [N]
  double error = 0.0;     ///< standard error of either [N]
};

struct LoadEstimate {
  double value = std::numeric_limits<double>::quiet_NaN();  ///< [N]; NaN: no speed was run in both directions
  Interval interval;                                        ///< 95 %, with the spread over the speeds
  bool constant = false;
  std::vector<SpeedPair> pairs;  ///< ascending speed
};
LoadEstimate load_of(const std::vector<map::SteadyRun>& runs);

/// Method "gravity": load and friction from constant speeds in both directions, nothing fitted.
Result identify_gravity(const std::vector<log::Record>& records, const map::SteadyOptions& options = {});

struct EqualSpeedOptions {
  std::optional<double>
      exclude{};  ///< left out after reversals [m]; absent: 50 um, of an angle a five hundredth of the stroke
  int bins = 60;  ///< of speed, each direction
  /// Periods of forces periodic in position [m], which would otherwise be taken for inertia.
  std::vector<double> periods;
};

struct MassEstimate {
  double value = std::numeric_limits<double>::quiet_NaN();  ///< [kg]
  Interval interval;                                        ///< 95 %
  std::size_t rows = 0;
};
MassEstimate mass_at_equal_speed(const std::vector<log::Record>& records,
                                 const EqualSpeedOptions& options = {});

/// Method "constant-acceleration": the mass first; friction is the rest of the force, as means over bins of speed.
Result identify_constant_acceleration(const std::vector<log::Record>& records,
                                      const EqualSpeedOptions& options = {});

}  // namespace stribeck::ident::methods
