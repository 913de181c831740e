#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stribeck/ident/residual/residual_parts.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>
#include <vector>

namespace stribeck::ident::residual {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kKnots = 7;  // of speed, each direction
constexpr double kApart = 0.02;    // of the top speed, between knots

/// Share of column j, of unit length, that the others do not explain; `products` of all columns with each other. (The
/// inverse does not tell it where they explain all of it.)
double told_of(const MatrixXd& products, Index j) {
  const Index p = products.cols();
  std::vector<Index> others;
  for (Index i = 0; i < p; ++i) {
    if (i != j) others.push_back(i);
  }
  const MatrixXd among = products(others, others);
  const VectorXd with = products(others, j);
  return std::max(0.0, 1.0 - with.dot(stats::pseudo_inverse(among) * with));
}

}  // namespace

Columns model_columns(const Rows& rows) {
  Columns columns{[](const Row& r) { return r.a; }};
  for (const double side : {1.0, -1.0}) {
    std::vector<double> speed;
    for (const Row& r : rows.rows) {
      if (r.sign == side) speed.push_back(std::abs(r.v));
    }
    if (speed.empty()) continue;
    std::vector<double> knots;
    std::sort(speed.begin(), speed.end());
    for (std::size_t i = 0; i < kKnots; ++i) {
      const double v = speed[i * (speed.size() - 1) / (kKnots - 1)];
      if (knots.empty() || v > knots.back() + kApart * speed.back()) knots.push_back(v);
    }
    for (std::size_t i = 0; i < knots.size(); ++i) {
      columns.emplace_back([=](const Row& r) {
        if (r.sign != side) return 0.0;
        const double v = std::clamp(std::abs(r.v), knots.front(), knots.back());
        if (i > 0 && v < knots[i]) return std::max(0.0, (v - knots[i - 1]) / (knots[i] - knots[i - 1]));
        if (i + 1 < knots.size() && v > knots[i])
          return std::max(0.0, (knots[i + 1] - v) / (knots[i + 1] - knots[i]));
        return 1.0;
      });
    }
  }
  return columns;
}

Fit fit(const Rows& rows, const Columns& columns, double Row::*target) {
  Fit out;
  const auto n = static_cast<Index>(rows.rows.size());
  const auto p = static_cast<Index>(columns.size());
  out.X.resize(n, p);
  VectorXd e(n);
  std::vector<int> record;
  std::vector<std::size_t> at;
  for (Index i = 0; i < n; ++i) {
    const Row& r = rows.rows[static_cast<std::size_t>(i)];
    for (Index j = 0; j < p; ++j) out.X(i, j) = columns[static_cast<std::size_t>(j)](r);
    e(i) = r.*target;
    record.push_back(r.record);
    at.push_back(r.at);
  }
  const VectorXd scale = out.X.colwise().norm().cwiseMax(1e-300);
  const MatrixXd scaled = out.X * scale.cwiseInverse().asDiagonal();
  const MatrixXd products = stats::gram(scaled);
  const MatrixXd inverse = stats::pseudo_inverse(products);
  out.theta = inverse * (scaled.transpose() * e);
  out.left = e - scaled * out.theta;
  out.square = out.left.squaredNorm();
  const stats::Uncertainty uncertainty(scaled, out.left, inverse, record, at);
  for (Index j = 0; j < p; ++j) {
    out.half.push_back(uncertainty.half_width(VectorXd::Unit(p, j)) / scale(j));
    out.told.push_back(told_of(products, j));
  }
  out.theta = out.theta.cwiseQuotient(scale);
  return out;
}

}  // namespace stribeck::ident::residual
