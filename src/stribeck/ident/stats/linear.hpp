#pragma once
/// The matrix decompositions that identification needs, as functions of matrices of any size.
///
/// Eigen's decompositions are templates: each file that calls one compiles it again, which takes four to ten seconds.
/// Here each is compiled once, in the files linear_*.cpp. Everything else of Eigen is used directly.
///
/// Inside ident only: includes Eigen. Real time: no.

#include <Eigen/Core>
#include <optional>

namespace stribeck::ident::stats {

/// XᵀX.
Eigen::MatrixXd gram(const Eigen::MatrixXd& X);
/// AᵀB.
Eigen::MatrixXd cross(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& B);

/// A·x = b for a symmetric positive A, of which only the lower triangle is read.
Eigen::VectorXd solve_ldlt(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
Eigen::MatrixXd inverse_ldlt(const Eigen::MatrixXd& A);

/// A·x = b for any invertible A, with partial pivoting; with full pivoting where A is badly scaled.
Eigen::VectorXd solve_lu(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
Eigen::VectorXd solve_full_lu(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
Eigen::MatrixXd inverse(const Eigen::MatrixXd& A);
Eigen::MatrixXd inverse_full_lu(const Eigen::MatrixXd& A);
/// The same, or nothing where full pivoting shows that A is singular.
std::optional<Eigen::VectorXd> solve_if_regular(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
std::optional<Eigen::MatrixXd> inverse_if_regular(const Eigen::MatrixXd& A);
/// Inverse by the decomposition with partial pivoting.
double determinant(const Eigen::MatrixXd& A);

/// The shortest of all x that minimise |A·x − b|; A may be singular.
Eigen::VectorXd solve_shortest(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& A);

/// Least squares |A·x − b| by Householder reflections with pivoting of columns.
struct LeastSquares {
  Eigen::VectorXd x;
  Eigen::Index rank = 0;  ///< rank of A; where it is below its number of columns, the solution is one of many
};
LeastSquares least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
/// As many solutions as b has columns.
Eigen::MatrixXd least_squares_of_columns(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b);

/// Orthonormal columns that span the same space as those of A.
Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& A);

/// A = V·diag(values)·Vᵀ of a symmetric A, values ascending.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& A);
/// All λ with A·x = λ·B·x, of a symmetric A and a symmetric positive B, ascending.
Eigen::VectorXd generalized_eigenvalues(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// Least squares by singular values, which also show how well A determines x.
struct SingularValues {
  Eigen::VectorXd x;       ///< solution of A·x = b
  Eigen::VectorXd values;  ///< descending
  Eigen::Index rank = 0;
};
SingularValues solve_svd(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace stribeck::ident::stats
