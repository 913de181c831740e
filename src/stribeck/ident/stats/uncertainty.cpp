#include <algorithm>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/stats/long_run.hpp>
#include <stribeck/ident/stats/quantiles.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::stats {

Uncertainty::Uncertainty(const Eigen::MatrixXd& X, const Eigen::VectorXd& e, const Eigen::MatrixXd& inverse,
                         const std::vector<int>& record, const std::vector<std::size_t>& at) {
  const Eigen::Index n = X.rows();
  const Eigen::Index p = X.cols();
  const Memory memory = memory_of({e.data(), e.data() + n}, record, at);
  LongRun moments(static_cast<std::size_t>(p), memory);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(k);
    double* row = moments.row(record[i], at[i]);
    for (Eigen::Index j = 0; j < p; ++j) row[j] += X(k, j) * e(k);
  }
  const std::vector<double> raw = moments.covariance();
  const double rows = static_cast<double>(n) / (2.0 * memory.rows);
  const double freedom = std::max(3.0, rows - static_cast<double>(p));
  const double correction = std::max(1.0, rows / freedom);
  long_run_ =
      correction * inverse * Eigen::Map<const Eigen::MatrixXd>(raw.data(), p, p) * inverse.transpose();
  stationary_ = correction * 2.0 * memory.rows * e.squaredNorm() / static_cast<double>(n) * inverse *
                (X.transpose() * X) * inverse.transpose();
  factor_ = student_factor(freedom);
}

double Uncertainty::half_width(const Eigen::VectorXd& g) const {
  const double long_run = g.dot(long_run_ * g), stationary = g.dot(stationary_ * g);
  // Columns that are not independent: nothing is known.
  if (!std::isfinite(long_run + stationary)) return kInfinity;
  return factor_ * std::sqrt(std::max({0.0, long_run, stationary}));
}

}  // namespace stribeck::ident::stats
