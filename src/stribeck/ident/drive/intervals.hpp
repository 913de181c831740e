#pragma once
/// Covariance of the linear terms and the map, and the residual of the force.
///
///   C = B·S·Bᵀ      S: long-run covariance of multiplier·residual (long_run.hpp), or that of stationary noise;
///                   the largest standard error stands
///
/// A shift that was not found, but not given either, is a nuisance: its column takes part with the value 0 and what is
/// known before, a delay of a row or two (kDelayDeviation). Several records: the scores of the records against each other
/// are a third form, which sees what differs from run to run.
///
/// At each speed, Newey–West has only the few passes through that speed, and by chance its variance is often too small. The
/// stationary form pools all rows but misses noise that depends on speed. Directions of the map that the data do not determine
/// are removed from B: the curve over the data does not change along them.
///
/// Inside ident only. Real time: no.

#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/drive/map_choice.hpp>
#include <stribeck/ident/stats/long_run.hpp>
#include <vector>

namespace stribeck::ident::drive {

struct Intervals {
  std::vector<double> residual;  ///< of each row [N]
  MatrixXd long_run;             ///< covariance of linear terms and map
  MatrixXd stationary;           ///< the same under stationary noise
  MatrixXd between;              ///< the same from the difference of the records; zero for one record
  std::size_t linear = 0;        ///< terms before those of the map
  double shift_error = 0.0;      ///< standard error of the shift, found or not [rows]; 0: given
  /// Share of each map parameter that lies in directions which the data do not see.
  std::vector<double> unseen;
  double factor = 1.96;  ///< half width divided by standard error

  /// Standard error of hᵀθ, θ = (linear terms, map).
  [[nodiscard]] double error_of(const VectorXd& h) const;
  /// Standard error of one parameter.
  [[nodiscard]] double error_at(std::size_t i) const;
  /// A vector of zeros for a derivative with respect to θ.
  [[nodiscard]] VectorXd zero() const { return VectorXd::Zero(long_run.rows()); }
};

/// What is known of a delay before the log is seen: standard deviation [rows].
inline constexpr double kDelayDeviation = 1.5;

/// The fit with the linear terms that belong to the chosen map.
LinearFit with_terms_of(const MapChoice& choice, const Terms& terms, LinearFit fit);

/// `fit` as from with_terms_of(). `shift_known`: it was given, or the records have different sample times.
Intervals intervals(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                    const MapChoice& choice, bool shift_known);

}  // namespace stribeck::ident::drive
