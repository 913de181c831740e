#include <gtest/gtest.h>

#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::stats::linear_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// By hand: A·(1, 2, 3) = b, det A = 18.
MatrixXd symmetric() {
  MatrixXd A(3, 3);
  A << 4.0, 1.0, 0.0, 1.0, 3.0, 1.0, 0.0, 1.0, 2.0;
  return A;
}
VectorXd solution() { return VectorXd{{1.0, 2.0, 3.0}}; }
VectorXd right() { return VectorXd{{6.0, 10.0, 8.0}}; }

TEST(Linear, EverySolverGivesTheSolutionByHand) {
  const MatrixXd A = symmetric();
  for (const VectorXd& x : {solve_ldlt(A, right()), solve_lu(A, right()), solve_full_lu(A, right()),
                            solve_shortest(A, right()), least_squares(A, right()).x, solve_svd(A, right()).x,
                            VectorXd(least_squares_of_columns(A, right())), VectorXd(inverse(A) * right()),
                            VectorXd(inverse_full_lu(A) * right()), VectorXd(pseudo_inverse(A) * right())}) {
    EXPECT_LT((x - solution()).norm(), 1e-12) << x.transpose();
  }
  EXPECT_NEAR(determinant(A), 18.0, 1e-12);
}

// Two equal columns: of x0 + x1 = 2 the shortest solution is (1, 1), and the rank is 1.
TEST(Linear, SingularMatricesGiveTheShortestSolutionAndTheirRank) {
  const MatrixXd A = MatrixXd::Ones(3, 2);
  const VectorXd b = VectorXd::Constant(3, 2.0);
  EXPECT_LT((solve_shortest(A, b) - VectorXd::Ones(2)).norm(), 1e-12);
  EXPECT_EQ(least_squares(A, b).rank, 1);
  EXPECT_EQ(solve_svd(A, b).rank, 1);
  EXPECT_NEAR(solve_svd(A, b).values(0), std::sqrt(6.0), 1e-12);
  EXPECT_LT((pseudo_inverse(A) - MatrixXd::Constant(2, 3, 1.0 / 6.0)).norm(), 1e-12);
}

// Closed form: [[2, 1], [1, 2]] has the values 1 and 3.
TEST(Linear, EigenvaluesAscendAndVectorsRebuildTheMatrix) {
  MatrixXd A(2, 2);
  A << 2.0, 1.0, 1.0, 2.0;
  const SymmetricEigen e = symmetric_eigen(A);
  EXPECT_NEAR(e.values(0), 1.0, 1e-12);
  EXPECT_NEAR(e.values(1), 3.0, 1e-12);
  EXPECT_LT((e.vectors * e.values.asDiagonal() * e.vectors.transpose() - A).norm(), 1e-12);
}

TEST(Linear, OrthonormalColumnsSpanTheSameSpace) {
  const MatrixXd A = symmetric().leftCols(2);
  const MatrixXd Q = orthonormal_columns(A);
  EXPECT_LT((gram(Q) - MatrixXd::Identity(2, 2)).norm(), 1e-12);
  EXPECT_LT((cross(Q.leftCols(1), 2.0 * Q) - Eigen::RowVector2d(2.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((Q * (Q.transpose() * A) - A).norm(), 1e-12);
}

}  // namespace
}  // namespace stribeck::ident::stats::linear_test
