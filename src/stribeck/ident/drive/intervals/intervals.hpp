#pragma once
/// Covariance of the linear terms and the map, and the residual of the force.
///
///   C = B·S·Bᵀ      S: long-run covariance of multiplier·residual (long_run.hpp), or that of stationary noise;
///                   the largest standard error stands
///
/// A shift that was not found, but not given either, is a nuisance parameter: its column takes part with the value 0 and what is
/// known before, a delay of a row or two (kDelayDeviation). Several records: the scores of the records against each other
/// are a third form, which sees what differs from run to run. Where that is far more than noise, it is multiplied by Student's factor for
/// the number of records, at least three: of two records an interval is still too narrow.
///
/// At each speed, Newey–West has only the few passes through that speed, and by chance its variance is often too small. The
/// stationary form pools all rows but misses noise that depends on speed. Directions of the map that the data do not determine
/// are removed from B: the curve over the data does not change along them.
///
/// A map of few parameters is chosen where noise hides its error. `Misfit` measures that error at each speed, from the mean of
/// the residual over the rows around it.
///
/// A filter of the drive that was taken off the force (filter_search.hpp) has an error, which moves the terms.
///
/// Two further forms ask the data instead of a model of noise: fits without each block of motion (the jackknife), and a fit on
/// the rows above a fifth of the top speed. Friction that has not settled, or that no term describes, moves the mass there.
///
/// Inside ident only. Real time: no.

#include <optional>
#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/drive/map/map_choice.hpp>
#include <stribeck/ident/stats/long_run.hpp>
#include <vector>

namespace stribeck::ident::drive {

/// By how much the map differs from the friction of the rows around a speed.
class Misfit {
 public:
  Misfit() = default;
  /// `memory`: integrated correlation of the residual [rows].
  Misfit(const AlignedLog& log, const Rows& rows, const std::vector<double>& residual, double memory);

  /// What is left of the difference when its own noise is taken off [N].
  [[nodiscard]] double at(int side, double speed) const;

 private:
  [[nodiscard]] double within(int side, double speed, double wide) const;
  struct Bin {
    double rows = 0.0, passes = 0.0;
    double speed = 0.0, left = 0.0;  ///< sums; `left` against the motion
  };
  std::array<std::vector<Bin>, map::kSides> bins_;
  std::array<map::Grid, map::kSides> grid_;
  double variance_ = 0.0;  ///< of the residual [N²]
  double memory_ = 0.5;
};

struct Intervals {
  std::vector<double> residual;  ///< of each row [N]
  Misfit misfit;
  MatrixXd long_run;         ///< covariance of linear terms and map
  MatrixXd stationary;       ///< the same under stationary noise
  MatrixXd between;          ///< the same from the difference of the records; zero for one record
  double few_records = 1.0;  ///< factor of that form where the records clearly differ: their number is small
  MatrixXd folds;            ///< the same from fits without each block of motion, of the linear terms
  VectorXd unsettled;        ///< change of θ when only fast rows count, beyond its noise
  VectorXd filtered;         ///< what the error of the drive's filter adds to θ
  VectorXd held;  ///< what a shift adds that the rows show but that explains too little to be taken
  double untaken_shift = 0.0;  ///< that shift, from a held force on [rows]; 0: none
  std::size_t linear = 0;      ///< terms before those of the map
  double shift_error = 0.0;    ///< standard error of the shift, found or not [rows]; 0: given
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
