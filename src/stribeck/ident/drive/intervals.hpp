#pragma once
/// Covariance of the linear terms and the map, and the residual of the force.
///
///   C = B·S·Bᵀ      S: long-run covariance of multiplier·residual (long_run.hpp), or that of stationary noise;
///                   the larger of the two standard errors is used
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
  /// Share of each map parameter that lies in directions which the data do not determine.
  std::vector<double> unseen;
  double factor = 1.96;  ///< half width divided by standard error

  /// Standard error of hᵀθ, θ = (linear terms, map).
  [[nodiscard]] double error_of(const VectorXd& h) const;
  /// Standard error of one parameter.
  [[nodiscard]] double error_at(std::size_t i) const;
  /// A vector of zeros for a derivative with respect to θ.
  [[nodiscard]] VectorXd zero() const { return VectorXd::Zero(long_run.rows()); }
};

/// The fit with the linear terms that belong to the chosen map.
LinearFit with_terms_of(const MapChoice& choice, const Terms& terms, LinearFit fit);

/// `fit` is one that with_terms_of() returned.
Intervals intervals(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                    const MapChoice& choice);

}  // namespace stribeck::ident::drive
