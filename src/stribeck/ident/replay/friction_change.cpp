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

/// Mean speed of a fifth of the rows around a rank, and friction of the model against the motion there.
struct End {
  double speed = 0.0, friction = 0.0;
};
End end_of(const ForceRows& of, const std::vector<std::size_t>& by_speed, bool slow) {
  const std::size_t fifth = by_speed.size() / 5;
  const std::size_t from = slow ? 0 : by_speed.size() - fifth;
  End end;
  for (std::size_t j = from; j < from + fifth; ++j) {
    const std::size_t k = by_speed[j];
    end.speed += std::abs(of.velocity[k]);
    end.friction += of.velocity[k] > 0.0 ? of.friction[k] : -of.friction[k];
  }
  end.speed /= static_cast<double>(fifth);
  end.friction /= static_cast<double>(fifth);
  return end;
}

}  // namespace

double FrictionChange::certain() const noexcept {
  return std::isfinite(share) && std::isfinite(half_width) ? std::max(0.0, std::abs(share) - half_width)
                                                           : 0.0;
}

FrictionChanges friction_changes(const ForceRows& of, const std::vector<std::size_t>& rows) {
  constexpr std::size_t kFewest = 50;
  constexpr double kTold = 0.1;  // half width of what is told
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
  const auto change_at = [&](const End& end) -> FrictionChange {
    if (!(end.friction > 0.0)) return {};
    VectorXd share = VectorXd::Zero(4);
    share(0) = 1.0 / (scale(0) * end.friction);
    share(1) = end.speed / (scale(1) * end.friction);
    const FrictionChange change{share.dot(by), uncertainty.half_width(share), end.speed};
    return change.half_width < std::max(kTold, 0.25 * std::abs(change.share)) ? change : FrictionChange{};
  };
  return {change_at(end_of(of, by_speed, true)), change_at(end_of(of, by_speed, false))};
}

}  // namespace stribeck::ident::replay
