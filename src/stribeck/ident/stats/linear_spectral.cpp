// Eigenvalues and singular values of linear.hpp.
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::stats {

using Eigen::MatrixXd;
using Eigen::VectorXd;

SymmetricEigen symmetric_eigen(const MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

VectorXd generalized_eigenvalues(const MatrixXd& A, const MatrixXd& B) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(A, B, Eigen::EigenvaluesOnly).eigenvalues();
}

SingularValues solve_svd(const MatrixXd& A, const VectorXd& b) {
  const Eigen::JacobiSVD<MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.solve(b), svd.singularValues(), svd.rank()};
}

}  // namespace stribeck::ident::stats
