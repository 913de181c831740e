#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/replay/friction_change.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::replay {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Mean speed of some rows, and friction of the model against the motion there.
struct Place {
  double speed = 0.0, friction = 0.0;
};
Place mean_of(const ForceRows& of, std::span<const std::size_t> rows) {
  Place mean;
  for (const std::size_t k : rows) {
    mean.speed += std::abs(of.velocity[k]);
    mean.friction += of.velocity[k] > 0.0 ? of.friction[k] : -of.friction[k];
  }
  mean.speed /= static_cast<double>(rows.size());
  mean.friction /= static_cast<double>(rows.size());
  return mean;
}

}  // namespace

double FrictionChange::certain() const noexcept {
  return std::isfinite(share) && std::isfinite(half_width)
             ? std::max(0.0, std::abs(share) - half_width - varies)
             : 0.0;
}

FrictionChanges friction_changes(const ForceRows& of, const std::vector<std::size_t>& rows) {
  constexpr std::size_t kFewest = 50;
  constexpr double kTold = 0.1;          // half width of what is told
  constexpr double kOfLoad = 0.05;       // that a counterbalance varies by
  constexpr double kFewestOfSide = 0.2;  // of the rows
  if (rows.size() < kFewest) return {};
  Eigen::MatrixXd X(static_cast<Index>(rows.size()), 4);
  VectorXd missed(X.rows());
  for (Index i = 0; i < X.rows(); ++i) {
    const std::size_t k = rows[static_cast<std::size_t>(i)];
    const double v = of.velocity[k];
    X.row(i) << (v > 0.0 ? 1.0 : -1.0), v, of.acceleration[k], 1.0;
    missed(i) = of.measured[k] - of.modelled[k];
  }
  const VectorXd scale = X.colwise().norm().cwiseMax(1e-300);
  X = X * scale.cwiseInverse().asDiagonal();
  const auto inverse = stats::inverse_if_regular(stats::gram(X));
  if (!inverse) return {};
  const VectorXd by = *inverse * (X.transpose() * missed);
  const stats::Uncertainty uncertainty(X, missed - X * by, *inverse, std::vector<int>(rows.size(), 0), rows);
  std::vector<std::size_t> by_speed = rows;
  std::sort(by_speed.begin(), by_speed.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(of.velocity[a]) < std::abs(of.velocity[b]);
  });
  // `side`: 1 forward, −1 backward, 0 both, where a load does not count.
  const auto change_at = [&](const Place& at, double side) -> FrictionChange {
    if (!(at.friction > 0.0)) return {};
    VectorXd share = VectorXd::Zero(4);
    share(0) = 1.0 / (scale(0) * at.friction);
    share(1) = at.speed / (scale(1) * at.friction);
    share(3) = side / (scale(3) * at.friction);
    const FrictionChange change{share.dot(by), uncertainty.half_width(share), at.speed,
                                std::abs(side) * kOfLoad * std::abs(of.load) / at.friction};
    return change.half_width < std::max(kTold, 0.25 * std::abs(change.share)) ? change : FrictionChange{};
  };
  const std::span<const std::size_t> sorted(by_speed);
  const std::size_t fifth = by_speed.size() / 5;
  FrictionChanges out;
  out.slow = change_at(mean_of(of, sorted.first(fifth)), 0.0);
  out.fast = change_at(mean_of(of, sorted.last(fifth)), 0.0);
  const auto middle = std::stable_partition(by_speed.begin(), by_speed.end(),
                                            [&](std::size_t k) { return of.velocity[k] > 0.0; });
  const auto forward = static_cast<std::size_t>(middle - by_speed.begin());
  const std::size_t backward = by_speed.size() - forward;
  if (static_cast<double>(std::min(forward, backward)) < kFewestOfSide * static_cast<double>(by_speed.size()))
    return out;
  out.forward = change_at(mean_of(of, sorted.first(forward)), 1.0);
  out.backward = change_at(mean_of(of, sorted.last(backward)), -1.0);
  const VectorXd load = VectorXd::Unit(4, 3) / scale(3);
  out.load = load.dot(by);
  out.load_half_width = uncertainty.half_width(load);
  return out;
}

}  // namespace stribeck::ident::replay
