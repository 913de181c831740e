// Products, LDLᵀ and LU of linear.hpp.
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::stats {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd gram(const MatrixXd& X) { return X.transpose() * X; }

VectorXd solve_ldlt(const MatrixXd& A, const VectorXd& b) { return A.ldlt().solve(b); }

VectorXd solve_lu(const MatrixXd& A, const VectorXd& b) { return A.partialPivLu().solve(b); }
VectorXd solve_full_lu(const MatrixXd& A, const VectorXd& b) { return A.fullPivLu().solve(b); }
MatrixXd inverse(const MatrixXd& A) { return A.inverse(); }
MatrixXd inverse_full_lu(const MatrixXd& A) { return A.fullPivLu().inverse(); }
double determinant(const MatrixXd& A) { return A.determinant(); }

}  // namespace stribeck::ident::stats
