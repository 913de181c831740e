// Complete orthogonal decomposition of linear.hpp.
#include <Eigen/QR>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::stats {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd solve_shortest(const MatrixXd& A, const VectorXd& b) {
  return A.completeOrthogonalDecomposition().solve(b);
}
MatrixXd pseudo_inverse(const MatrixXd& A) { return A.completeOrthogonalDecomposition().pseudoInverse(); }

}  // namespace stribeck::ident::stats
