#pragma once
/// Model C: mass and velocity–friction map of an axis from runs through all speeds (sine, pulses).
///
///   f = m·a + F(v) + noise          F: Gaussian-augmented map, one branch for each direction
///
/// Mass, without any model of F: rows of equal velocity have equal friction, so within narrow bins of
/// velocity only m·a is left. Instruments (motion.hpp) take the place of the measured acceleration.
///
/// Bristles: after a reversal friction follows the way slid, dF/ds = σ0·(1 − F/g(v)). σ0 is estimated from
/// the rows after reversals. Rows nearer than six relaxation lengths g/σ0 are left out, and so are rows whose
/// speed changes too much within one length; the small lag that remains is calculated and taken off.
///
/// Map: means over bins, fitted for 0 … 6 terms (gaussian_fit.hpp). The number of terms is the smallest whose
/// error on held-out motion is within one standard error of the best, taken from paired differences over
/// blocks of motion. The thesis's rule (peaks of the smoothed map, border counted) is reported beside it.
///
/// Intervals: delta method under correlated noise (long_run.hpp; white-noise intervals would be several times
/// too narrow), plus what the models that the data cannot tell apart differ by. The map is valid on the
/// speeds that were fitted; friction/gaussian.hpp says what happens beyond.
///
/// Source: thesis §2.4.3; Robinson 1988, doi:10.2307/1912705 (mass); Buckland, Burnham, Augustin 1997,
/// doi:10.2307/2533961 (spread of models).
/// Not modelled: friction that depends on position, temperature or load.
/// Real time: no.
/// Errors: Refused, with the reason.

#include <optional>
#include <stribeck/ident/record.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/result.hpp>
#include <vector>

namespace stribeck::ident {

struct VelocityMapOptions {
  std::optional<double> mass;  ///< known mass [kg]; absent: estimated
  std::optional<int> terms;    ///< Gaussians of each branch; absent: chosen from the data
  int most_terms = 6;          ///< largest number that is tried
  int bins = 160;              ///< of velocity, each direction
  int curve_points = 24;       ///< each direction
  int map_points = 600;        ///< for plots, each direction
};

Result identify_velocity_map(const std::vector<Record>& records, const VelocityMapOptions& options = {});

}  // namespace stribeck::ident
