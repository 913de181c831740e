#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include <stribeck/ident/drive/load/lost_share.hpp>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::drive {
namespace {

constexpr double kSpan = 20e-3;  // [s]
constexpr double kSlow = 0.01;   // of the top speed
constexpr std::size_t kFewest = 200;

struct Means {
  std::vector<double> v, a, f;
};

std::size_t rows_of(double span, const log::Record& r) {
  return static_cast<std::size_t>(std::max(1.0, std::round(span / r.sample_time)));
}

/// The mean force over the triangle with which a second difference weighs the acceleration, where the axis moves in one direction.
void add_means(const log::Record& r, Means& out, double& top) {
  const std::size_t h = rows_of(kSpan, r);
  if (r.x.size() != r.f.size() || r.x.size() < 2 * h + 1) return;
  const double span = static_cast<double>(h) * r.sample_time;
  const auto count = static_cast<double>(h * h);
  for (std::size_t k = h; k + h < r.x.size(); k += std::max<std::size_t>(1, h / 2)) {
    const double before = r.x[k] - r.x[k - h], behind = r.x[k + h] - r.x[k];
    double f = 0.0;
    bool skipped = false;
    for (std::size_t i = 0; i < h; ++i) {
      const auto weight = static_cast<double>(h - i) / count;
      f += weight * (i == 0 ? r.f[k] : r.f[k - i] + r.f[k + i]);
      skipped = skipped || (!r.skip.empty() && (r.skip[k - i] != 0 || r.skip[k + i] != 0));
    }
    if (skipped || !(before * behind > 0.0)) continue;
    out.v.push_back(0.5 * (before + behind) / span);
    out.a.push_back((behind - before) / (span * span));
    out.f.push_back(f);
    top = std::max(top, std::abs(out.v.back()));
  }
}

/// Square of what is left, and the last coefficient with its standard error.
struct Left {
  double rss = 0.0, last = 0.0, error = 0.0;
};

Left left_by(const Eigen::MatrixXd& X, const Eigen::VectorXd& y) {
  const Eigen::VectorXd norm = X.colwise().norm().cwiseMax(1e-300);
  const Eigen::MatrixXd scaled = X * norm.cwiseInverse().asDiagonal();
  const Eigen::VectorXd c = stats::least_squares(scaled, y).x;
  const Eigen::Index last = X.cols() - 1;
  const double rss = (y - scaled * c).squaredNorm();
  const double variance = stats::pseudo_inverse(stats::gram(scaled))(last, last);
  return {rss, c(last) / norm(last),
          std::sqrt(variance * rss / static_cast<double>(std::max<Eigen::Index>(1, X.rows() - X.cols()))) /
              norm(last)};
}

}  // namespace

std::optional<LostShare> lost_share(const std::vector<log::Record>& records) {
  constexpr double kByMotion = 0.7;  // of the square that is left: a column of the motion alone
  constexpr double kByForce = 0.6;   // the same by the column of the force
  constexpr double kNearlyAll = 0.25, kMuchBraking = 0.05;  // where the motion alone does not show it
  constexpr double kLeast = 0.01, kMost = 0.5;
  constexpr double kBraking = 0.01;  // of the rows
  constexpr double kAlike = 5.0;  // neighbours resemble each other: standard errors are that much too small
  Means m;
  double top = 0.0;
  for (const log::Record& r : records) add_means(r, m, top);
  std::vector<std::size_t> used;
  std::size_t braking = 0, forward = 0;
  for (std::size_t i = 0; i < m.v.size(); ++i) {
    if (!(std::abs(m.v[i]) > kSlow * top)) continue;
    used.push_back(i);
    braking += m.f[i] * m.v[i] < 0.0 ? 1 : 0;
    forward += m.v[i] > 0.0 ? 1 : 0;
  }
  const auto all = static_cast<double>(used.size());
  if (used.size() < kFewest || static_cast<double>(braking) < kBraking * all || forward == 0 ||
      forward == used.size())
    return {};
  constexpr Eigen::Index kColumns = 12;
  Eigen::MatrixXd X(static_cast<Eigen::Index>(used.size()), kColumns + 1);
  Eigen::VectorXd f(X.rows()), of_motion(X.rows()), of_force(X.rows());
  for (Eigen::Index row = 0; row < X.rows(); ++row) {
    const std::size_t i = used[static_cast<std::size_t>(row)];
    const double v = m.v[i], sign = v > 0.0 ? 1.0 : -1.0, ahead = v > 0.0 ? 1.0 : 0.0;
    Eigen::Index j = 0;
    const auto put = [&](double value) { X(row, j++) = value; };
    for (const double value : {m.a[i], 1.0, sign, v, ahead * v, v * std::abs(v)}) put(value);
    for (const double share : {0.02, 0.1, 0.4}) {
      const double near = std::exp(-std::abs(v) / (share * top));
      put(sign * near);
      put(ahead * near);
    }
    f(row) = m.f[i];
    of_motion(row) = std::abs(m.a[i]) * sign;
    of_force(row) = std::abs(m.f[i]) * sign;
  }
  const Left plain = left_by(X.leftCols(kColumns), f);
  X.col(kColumns) = of_motion;
  const bool by_motion = left_by(X, f).rss < kByMotion * plain.rss;
  X.col(kColumns) = of_force;
  const Left with = left_by(X, f);
  const bool by_force_alone =
      with.rss<kNearlyAll * plain.rss&& static_cast<double>(braking)> kMuchBraking * all;
  if (!by_motion && !by_force_alone) return {};
  if (!(with.rss < kByForce * plain.rss) || !(with.last > kLeast) || !(with.last < kMost)) return {};
  // What else is in |f|, such as the build-up of friction after reversals, is no noise.
  const double beside = by_motion ? 0.1 : 0.2;
  return LostShare{with.last, std::hypot(1.96 * kAlike * with.error, beside * with.last)};
}

void as_driving(double share, log::Record& r) {
  const std::size_t h = rows_of(0.5 * kSpan, r);
  const double factor = (1.0 + share) / (1.0 - share);
  const std::vector<double> logged = r.f;
  for (std::size_t k = h; k + h < r.x.size() && k < logged.size(); ++k) {
    const double before = r.x[k] - r.x[k - h], behind = r.x[k + h] - r.x[k];
    // At rest and at a reversal nobody knows: as driving.
    if (before * behind > 0.0 && logged[k] * behind < 0.0) r.f[k] = factor * logged[k];
  }
}

}  // namespace stribeck::ident::drive
