// Householder reflections of linear.hpp.
#include <Eigen/QR>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::stats {

using Eigen::MatrixXd;
using Eigen::VectorXd;

LeastSquares least_squares(const MatrixXd& A, const VectorXd& b) {
  const auto qr = A.colPivHouseholderQr();
  return {qr.solve(b), qr.rank()};
}
MatrixXd least_squares_of_columns(const MatrixXd& A, const MatrixXd& b) {
  const auto qr = A.colPivHouseholderQr();
  MatrixXd x(A.cols(), b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j) x.col(j) = qr.solve(VectorXd(b.col(j)));
  return x;
}

MatrixXd orthonormal_columns(const MatrixXd& A) {
  return Eigen::HouseholderQR<MatrixXd>(A).householderQ() * MatrixXd::Identity(A.rows(), A.cols());
}

}  // namespace stribeck::ident::stats
