// Products, LDLᵀ and LU of linear.hpp.
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::stats {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd gram(const MatrixXd& X) { return X.transpose() * X; }
MatrixXd cross(const Eigen::Ref<const MatrixXd>& A, const Eigen::Ref<const MatrixXd>& B) {
  return A.transpose() * B;
}

VectorXd solve_ldlt(const MatrixXd& A, const VectorXd& b) { return A.ldlt().solve(b); }

MatrixXd inverse_ldlt(const MatrixXd& A) { return A.ldlt().solve(MatrixXd::Identity(A.rows(), A.cols())); }

VectorXd solve_lu(const MatrixXd& A, const VectorXd& b) { return A.partialPivLu().solve(b); }
VectorXd solve_full_lu(const MatrixXd& A, const VectorXd& b) { return A.fullPivLu().solve(b); }
MatrixXd inverse(const MatrixXd& A) { return A.inverse(); }
MatrixXd inverse_full_lu(const MatrixXd& A) { return A.fullPivLu().inverse(); }

std::optional<VectorXd> solve_if_regular(const MatrixXd& A, const VectorXd& b) {
  const auto lu = A.fullPivLu();
  return lu.isInvertible() ? std::optional<VectorXd>(lu.solve(b)) : std::nullopt;
}
std::optional<MatrixXd> inverse_if_regular(const MatrixXd& A) {
  const auto lu = A.fullPivLu();
  return lu.isInvertible() ? std::optional<MatrixXd>(lu.inverse()) : std::nullopt;
}

double determinant(const MatrixXd& A) { return A.determinant(); }

}  // namespace stribeck::ident::stats
