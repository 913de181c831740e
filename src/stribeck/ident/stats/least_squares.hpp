#pragma once
/// Nonlinear least squares by Levenberg–Marquardt: min ½·Σ rᵢ(p)², from a start that is near enough.
///
/// Ceres's TinySolver, compiled once for any number of residuals and parameters.
///
/// Inside ident only: includes Eigen. Real time: no.

#include <Eigen/Core>

namespace stribeck::ident::stats {

/// Residuals of a model and their derivatives.
class Residuals {
 public:
  virtual ~Residuals() = default;
  [[nodiscard]] virtual int count() const = 0;
  [[nodiscard]] virtual int parameters() const = 0;
  /// `jacobian` is count × parameters, column by column; nullptr where only the residuals are needed.
  /// Returns false where the model is not defined at p.
  virtual bool evaluate(const double* p, double* residuals, double* jacobian) const = 0;
};

struct DescentOptions {
  int iterations = 50;
  double gradient_tolerance = 1e-10;
  double parameter_tolerance = 1e-8;
  double function_tolerance = 1e-6;
  double trust_region = 1e4;  ///< radius at the start
};

struct Descent {
  double cost = 0.0;  ///< ½·Σ rᵢ² at the end; may be NaN
};

/// Moves p from the start to the nearest minimum.
Descent minimise_squares(const Residuals& residuals, Eigen::VectorXd& p, const DescentOptions& options = {});

}  // namespace stribeck::ident::stats
