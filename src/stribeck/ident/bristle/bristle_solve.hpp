#pragma once
/// Least squares over the models of bristle_model.hpp, how uncertain it is, and what it predicts of motion that
/// was left out.
///
///   min Σ (e_k/noise)² + Σ ((p − p0)/sd)²       p0, sd: what is believed before
///
///   C = H⁻¹·(ZᵀΓZ + P·noise²)·H⁻ᵀ,  H = ZᵀJ + P      Z = J, but for a mass from open loop the programmed force
///
/// Γ holds the autocovariance of the residuals (flat top to six memories, falling to zero at twelve); a second C
/// takes the scatter of the sums Zᵀe of whole stretches for it. The larger half width stands.
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

/// Of a fit that only predicts rows that were left out, or starts another one.
inline constexpr int kFoldIterations = 6;

/// What is believed before; an infinite sd says nothing.
struct Prior {
  VectorXd mean;
  VectorXd sd;
};

struct Problem {
  const VectorXd* at;              ///< values of fixed parameters
  const std::vector<Index>* free;  ///< numbers of the others
  const std::vector<char>* use;    ///< rows
  const Prior* prior;
  double noise;  ///< [N], of a row, for the weight against the prior
};

struct Solution {
  VectorXd p;  ///< all parameters
  double cost = std::numeric_limits<double>::infinity();
};

/// Least squares over some rows and some parameters.
Solution solve(const Model& model, const Problem& problem, int iterations);

stats::Memory memory_of_rows(const BristlePath& path, const VectorXd& e);

/// From the least-squares solution to that of the instrument: force noise moves the axis, so that least squares
/// takes part of it for less mass (−0.2 % on pulses of the biaxial table).
void correct_mass(const Model& model, VectorXd& p, const std::vector<Index>& free, const Prior& prior,
                  double noise);

/// Covariance of the free parameters under the residuals' own correlation.
struct Spread {
  MatrixXd stationary;
  MatrixXd clustered;
  double factor = 1.96;
  double cluster_factor = 0.0;  ///< 0: too few stretches
  std::vector<Index> free;

  /// 95 % half width of gᵀp; g over all parameters.
  [[nodiscard]] double half_width(const VectorXd& g) const;
};

Spread spread_of(const Model& model, const VectorXd& p, const std::vector<Index>& free, const Prior& prior,
                 double noise, Index mass);

/// Squares of held-out residuals per stretch, over the rows after reversals.
struct HeldOut {
  std::vector<double> square;
  std::vector<double> count;
  [[nodiscard]] double rms() const;
};

HeldOut hold_out(const Model& model, const VectorXd& start, const std::vector<Index>& free,
                 const Prior& prior, double noise, const BristlePath& path);

/// Standard error of the difference in RMS from the best, over stretches.
double error_of_difference(const HeldOut& a, const HeldOut& best);

}  // namespace stribeck::ident::bristle
