#pragma once
/// The general identification: from records of any motion to mass, load, friction, periodic terms and the shift
/// between force and motion, with intervals and a choice of the model.
///
///   f(k + s) = m·a(k) + load + F(v) + Σ terms periodic in x + noise
///
/// Partially linear model: rows of equal velocity have equal friction, so within narrow bins of velocity only the other terms
/// remain. They are estimated first, without any model of F. Then F is fitted to what remains, over the bins (static_fit.hpp).
/// The fit over bins loses no information and needs a hundredth of the time.
///
///   s         shift of the force, to a fraction of a row: least residual, then Gauss–Newton (motion.hpp). Where it is
///             within three standard errors of −½, the force acts as commanded, under its zero-order hold
///   m         an instrument (motion.hpp) replaces the noisy acceleration; plain_mass shows the difference
///   reversals rows in which friction has not settled are left out, and the remaining lag is subtracted (relaxation.hpp);
///             bristle_fit.hpp models these rows
///   periodic  searched in the residual (periodic.hpp), kept if they improve the prediction of held-out motion
///   places    friction that differs along the travel (places.hpp), kept on the same condition
///   filter    through which the drive passed the force (smoothing/filter_search.hpp): then everything is fitted anew on the force before it
///   drift     friction or offset that changes with time causes a warning
///
/// Intervals: delta method under correlated noise (long_run.hpp), because white-noise intervals are several times too narrow;
/// added is the spread between models that the data cannot tell apart.
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
  std::optional<double> shift;  ///< known shift of the force, without its filter [rows]; absent: estimated
  bool search_shift = true;     ///< false: as commanded at first, judged beside periodic terms only
  bool filter = true;           ///< search for a filter of the drive on the force
  std::optional<int> terms;     ///< Gaussians of each branch; absent: chosen from the data
  int most_terms = 6;           ///< largest number that is tried
  bool symmetric = true;        ///< try symmetric families, which separate a load from friction
  bool balanced = false;  ///< no load is searched in the reversals; what differs by direction is friction
  bool weighted = false;  ///< a load is known to pull: half of what differs by direction is taken for it
  bool periodic = true;   ///< search for terms periodic in position
  bool places = true;     ///< search for friction that differs along the travel
  bool dynamics = true;   ///< estimate pre-sliding from reversals
  double cut_off = 0.0;   ///< Butterworth filter instead of the chosen window [Hz]; 0: window
  double control_period = 0.0;  ///< over which a command is held, in a log of every n-th one [s]; 0: a row
  int bins = 160;               ///< of velocity, each direction
  int curve_points = 120;       ///< each direction; straight lines between them are right to 0.02 % of a bump
  int map_points = 600;         ///< for plots, each direction
};

Result identify_drive(const std::vector<log::Record>& records, const DriveFitOptions& options = {});

}  // namespace stribeck::ident::drive
