#pragma once
/// Least squares over the models of bristle_model.hpp, their uncertainty, and the prediction of motion that was left out.
///
///   min Σ (e_k/noise)² + Σ ((p − p0)/sd)²       p0, sd: prior mean and standard deviation
///
///   C = H⁻¹·(ZᵀΓZ + P·noise²)·H⁻ᵀ,  H = ZᵀJ + P      Z = J; for a mass from open loop Z holds the programmed force
///
/// Γ holds the autocovariance of the residuals (weight one up to six correlation lengths, falling to zero at twelve). A second
/// C uses the scatter of the sums Zᵀe over whole stretches in its place. The larger half width of the two is taken.
///
/// Source: instrument: Söderström, Errors-in-Variables Methods in System Identification, 2018; stretches as
/// clusters: Liang, Zeger 1986, doi:10.1093/biomet/73.1.13.
/// Inside ident only: includes Eigen.
/// Real time: no.

#include <Eigen/Core>
#include <limits>
#include <stribeck/ident/bristle/bristle_model.hpp>
#include <stribeck/ident/stats/long_run.hpp>
#include <vector>

namespace stribeck::ident::bristle {

/// Options of a fit that only predicts rows that were left out, or that starts another fit.
inline constexpr int kFoldIterations = 6;

/// The prior; an infinite sd says nothing.
struct Prior {
  VectorXd mean;
  VectorXd sd;
};

struct Problem {
  const VectorXd* at;              ///< values of fixed parameters
  const std::vector<Index>* free;  ///< indices of the free parameters
  const std::vector<char>* use;    ///< rows
  const Prior* prior;
  double noise;  ///< of a row, for the weight of the data against the prior [N]
};

struct Solution {
  VectorXd p;  ///< all parameters
  double cost = std::numeric_limits<double>::infinity();
};

/// Least squares over some rows and some parameters.
Solution solve(const Model& model, const Problem& problem, int iterations);

stats::Memory memory_of_rows(const BristlePath& path, const VectorXd& e);

/// Moves from the least-squares solution to that of the instrument. Noise of the force moves the axis, and least squares
/// takes a part of that motion for a smaller mass (−0.2 % on pulses of the biaxial table).
void correct_mass(const Model& model, VectorXd& p, const std::vector<Index>& free, const Prior& prior,
                  double noise);

/// Covariance of the free parameters, with the correlation that the residuals have.
struct Spread {
  MatrixXd stationary;
  MatrixXd clustered;
  double factor = 1.96;
  double cluster_factor = 0.0;  ///< 0: too few stretches
  std::vector<Index> free;

  /// 95 % half width of gᵀp; g has an entry for every parameter.
  [[nodiscard]] double half_width(const VectorXd& g) const;
};

Spread spread_of(const Model& model, const VectorXd& p, const std::vector<Index>& free, const Prior& prior,
                 double noise, Index mass);

/// Squares of held-out residuals for each stretch, over the rows after reversals.
struct HeldOut {
  std::vector<double> square;
  std::vector<double> count;
  [[nodiscard]] double rms() const;
};

HeldOut hold_out(const Model& model, const VectorXd& start, const std::vector<Index>& free,
                 const Prior& prior, double noise, const BristlePath& path);

/// Standard error of the difference in RMS from the best candidate, over stretches.
double error_of_difference(const HeldOut& a, const HeldOut& best);

}  // namespace stribeck::ident::bristle
