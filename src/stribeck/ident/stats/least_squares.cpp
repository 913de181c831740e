#include <ceres/tiny_solver.h>

#include <stribeck/ident/stats/least_squares.hpp>

namespace stribeck::ident::stats {
namespace {

/// Residuals as TinySolver expects them.
struct Function {
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  const Residuals* residuals;

  [[nodiscard]] int NumResiduals() const { return residuals->count(); }
  [[nodiscard]] int NumParameters() const { return residuals->parameters(); }
  bool operator()(const double* p, double* r, double* jacobian) const {
    return residuals->evaluate(p, r, jacobian);
  }
};

}  // namespace

Descent minimise_squares(const Residuals& residuals, Eigen::VectorXd& p, const DescentOptions& options) {
  ceres::TinySolver<Function> solver;
  solver.options.max_num_iterations = options.iterations;
  solver.options.gradient_tolerance = options.gradient_tolerance;
  solver.options.parameter_tolerance = options.parameter_tolerance;
  solver.options.function_tolerance = options.function_tolerance;
  solver.options.initial_trust_region_radius = options.trust_region;
  return {solver.Solve({&residuals}, &p).final_cost};
}

}  // namespace stribeck::ident::stats
