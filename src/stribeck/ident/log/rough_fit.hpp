#pragma once
/// A linear fit of force by motion that is only good enough to find signs, and to tell what explains the force.
///
///   f = m·a + c·v + F·sgn v + k·x + f0, where the force is logged `delay` rows later than the motion
///
/// Long logs are represented by blocks of rows, spread over all tables. Force and motion pass the same window.
///
/// Inside this folder only: includes Eigen. Real time: no.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <stribeck/ident/log/condition_parts.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <vector>

namespace stribeck::ident::log::parts {

inline constexpr int kColumns = 5;  ///< a, v, sgn v, x, 1
using Vector = Eigen::Matrix<double, kColumns, 1>;

/// A block of rows of one table, with its motion.
struct Block {
  const Table* table = nullptr;
  std::size_t first = 0;
  Motion motion;
  std::vector<double> x;      ///< measured from the middle of the travel
  std::vector<double> force;  ///< as logged
  std::vector<double> f;      ///< through the window of the motion
};

/// Passes a force, with one value for each row of the block, through the window of the motion.
void smooth_force(Block& block, const std::vector<double>& force);

/// Blocks of up to `most` rows in all, spread evenly over the tables.
std::vector<Block> blocks_of(const std::vector<Table>& tables, std::size_t most);

/// Sums over rows that pair motion and force at one delay.
struct Sums {
  Eigen::Matrix<double, kColumns, kColumns> a = Eigen::Matrix<double, kColumns, kColumns>::Zero();
  Vector b = Vector::Zero();
  double ff = 0.0;
  double f = 0.0;
  std::size_t n = 0;
  std::size_t forward = 0;

  /// Residual sum of squares with the columns marked in `use`; the coefficients of the others are 0.
  double solve(const std::array<bool, kColumns>& use, Vector& c) const;
};

/// Coefficients for the delay with the smallest mean square.
struct Fit {
  Vector c = Vector::Zero();
  Sums sums;
  double rss = std::numeric_limits<double>::infinity();  ///< mean square of the residual [N²]
  int delay = 0;
};

/// Speed below which a row counts as standstill.
double slowest_moving(const std::vector<Block>& blocks);

/// Tries delays of at most `most` rows.
Fit best_fit(const std::vector<Block>& blocks, double slowest, int most = 100);

RoughFit as_rough(const Fit& fit);

/// Model force at the rows of a block, as the force column has it.
std::vector<double> predicted(const Block& block, const Fit& fit);

}  // namespace stribeck::ident::log::parts
