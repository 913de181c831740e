#pragma once
/// Uncertainty of a linear least-squares estimate when neighbouring rows carry nearly the same noise.
///
///   y = X·θ + e,   C = (XᵀX)⁻¹·S·(XᵀX)⁻¹,   half width of gᵀθ = t_{0.975}·√(gᵀCg)
///
/// S is the long-run covariance of the rows X_k·e_k (long_run.hpp), or that of stationary noise, (1 + 2Σρ)·σ²·XᵀX; the larger of
/// the two half widths is used. With instruments Z in place of X, `inverse` is (ZᵀX)⁻¹ and C = (ZᵀX)⁻¹·S·(XᵀZ)⁻¹. The degrees of
/// freedom are the number of independent rows, N/(1 + 2Σρ), less the number of parameters.
///
/// Inside ident only: includes Eigen.
/// Real time: no.

#include <Eigen/Core>
#include <cstddef>
#include <stribeck/ident/stats/quantiles.hpp>
#include <vector>

namespace stribeck::ident::stats {

class Uncertainty {
 public:
  /// record and at say where in time a row lies, as in memory_of().
  Uncertainty(const Eigen::MatrixXd& X, const Eigen::VectorXd& e, const Eigen::MatrixXd& inverse,
              const std::vector<int>& record, const std::vector<std::size_t>& at);

  /// 95 % half width of gᵀθ.
  [[nodiscard]] double half_width(const Eigen::VectorXd& g) const;

 private:
  Eigen::MatrixXd long_run_;
  Eigen::MatrixXd stationary_;
  double factor_ = 0.0;
};

}  // namespace stribeck::ident::stats
