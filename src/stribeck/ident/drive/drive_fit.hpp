#pragma once
/// The general identification: from records of any motion to mass, load, friction, periodic terms and the shift
/// between force and motion, with intervals and a choice of the model.
///
///   f(k + s) = m·a(k) + load + F(v) + Σ terms periodic in x + noise
///
/// Partially linear: rows of equal velocity have equal friction, so that within narrow bins of velocity only
/// the other terms are left. They are estimated first, without any model of F; F is then fitted to what remains
/// over the bins (static_fit.hpp), which loses nothing and costs a hundredth of the rows.
///
///   s         shift of the force, to a fraction of a row: least residual, then Gauss–Newton (motion.hpp); where
///             it is within three standard errors of −½ the force acts under its zero-order hold, as commanded
///   m         instruments (motion.hpp) take the place of the noisy acceleration; plain_mass shows the difference
///   reversals rows in which friction has not settled are left out, the lag that remains is taken off
///             (relaxation.hpp); what happens there is the matter of bristle_fit.hpp
///   periodic  searched in the residual (periodic.hpp), kept if held-out motion is better for them
///   drift     friction or offset that moves with time is warned of
///
/// Intervals: delta method under correlated noise (long_run.hpp; white-noise intervals are several times too
/// narrow) plus what models that the data cannot tell apart differ by.
///
/// Source: Robinson 1988, doi:10.2307/1912705; Buckland, Burnham, Augustin 1997, doi:10.2307/2533961.
/// Not modelled: friction that depends on temperature or load; elasticity.
/// Real time: no.
/// Errors: Refused, with the reason.

#include <optional>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/result.hpp>
#include <vector>

namespace stribeck::ident::drive {

struct DriveFitOptions {
  std::optional<double> mass;   ///< known mass [kg]; absent: estimated
  std::optional<double> shift;  ///< known shift of the force [rows]; absent: estimated
  std::optional<int> terms;     ///< Gaussians of each branch; absent: chosen from the data
  int most_terms = 6;           ///< largest number that is tried
  bool symmetric = true;        ///< try symmetric families, which tell a load from friction
  bool periodic = true;         ///< search terms periodic in position
  bool dynamics = true;         ///< estimate pre-sliding from reversals
  double cut_off = 0.0;         ///< Butterworth filter instead of the chosen window [Hz]; 0: window
  int bins = 160;               ///< of velocity, each direction
  int curve_points = 24;        ///< each direction
  int map_points = 600;         ///< for plots, each direction
};

Result identify_drive(const std::vector<log::Record>& records, const DriveFitOptions& options = {});

}  // namespace stribeck::ident::drive
