#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/ident/drive/map/joint_fit.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <utility>
#include <vector>

namespace stribeck::ident::drive {
namespace {

using Family = map::StaticFit::Family;

constexpr int kRounds = 2;  ///< over the directions
constexpr int kSteps = 8;   ///< of Gauss–Newton

/// The sums over the blocks of a fit.
class Pooled {
 public:
  Pooled(const LinearFit& fit, std::size_t without) : fit_(fit), at_(fit.sums.layout) {
    const Sums& sums = fit.sums;
    const auto W = static_cast<Index>(at_.columns());
    cross_ = MatrixXd::Zero(W, W);
    for (std::size_t k = 0; k < sums.blocks; ++k) {
      if (k != without) cross_ += sums.products[k];
    }
    for (std::size_t s = 0; s < map::kSides; ++s) {
      slowest_[s] = std::numeric_limits<double>::infinity();
      for (std::size_t b = 0; b < sums.bins[s]; ++b) {
        VectorXd sum = VectorXd::Zero(static_cast<Index>(at_.size()));
        for (std::size_t k = 0; k < sums.blocks; ++k) {
          if (k != without) sum += sums.of(s, k, b).first(at_.size());
        }
        const double rows = sum(static_cast<Index>(at_.rows()));
        if (rows <= 0.0) continue;
        const double speed = sum(static_cast<Index>(at_.speed())) / rows;
        slowest_[s] = std::min(slowest_[s], speed);
        fastest_[s] = std::max(fastest_[s], speed);
        bins_[s].push_back({rows, speed, std::move(sum)});
      }
    }
  }

  [[nodiscard]] double slowest(std::size_t s) const noexcept { return slowest_[s]; }
  [[nodiscard]] double fastest(std::size_t s) const noexcept { return fastest_[s]; }

  /// Σ residual² [N²].
  [[nodiscard]] double loss(const JointFit& joint) const {
    const std::size_t q = at_.terms;
    VectorXd h = VectorXd::Zero(static_cast<Index>(at_.columns()));
    h.head(static_cast<Index>(q)) = -joint.linear;
    h(static_cast<Index>(at_.force())) = 1.0;
    double sum = h.dot(cross_ * h);
    for (std::size_t s = 0; s < map::kSides; ++s) {
      for (const Bin& bin : bins_[s]) {
        const double f = joint.map.force(static_cast<int>(s), bin.speed);
        const double left =
            bin.sum(static_cast<Index>(at_.force())) - joint.linear.dot(bin.sum.head(static_cast<Index>(q)));
        sum += -2.0 * map::kDirection[s] * f * left + bin.rows * f * f;
      }
    }
    return sum;
  }

  /// Whether the friction at rest, which no row shows, stays near the largest one at the speeds of the rows: of both directions
  /// together, so that a load cancels.
  [[nodiscard]] bool bounded(const map::StaticFit& map) const {
    double at_rest = 0.0, seen = 0.0;
    for (std::size_t s = 0; s < map::kSides; ++s) {
      const int side = static_cast<int>(s);
      double most = -std::numeric_limits<double>::infinity();
      for (const Bin& bin : bins_[s]) most = std::max(most, map.force(side, bin.speed));
      seen += most;
      at_rest += map.force(side, 0.0);
    }
    return at_rest <= map::kMostForce * std::abs(seen);
  }

  /// One step of Gauss–Newton with the parameters `fixed` of the map held: exact where only linear ones remain. Returns the
  /// largest relative change, or a negative number where the data do not determine it.
  double step(JointFit& joint, const std::vector<Index>& fixed) const;

 private:
  struct Bin {
    double rows, speed;
    VectorXd sum;  ///< in the layout of the bins
  };

  const LinearFit& fit_;
  SumsLayout at_;
  MatrixXd cross_;
  std::array<std::vector<Bin>, map::kSides> bins_;
  std::array<double, map::kSides> slowest_{}, fastest_{};
};

double Pooled::step(JointFit& joint, const std::vector<Index>& fixed) const {
  const auto Q = static_cast<Index>(at_.terms), P = static_cast<Index>(joint.map.parameters());
  MatrixXd A = MatrixXd::Zero(Q + P, Q + P);
  VectorXd b = VectorXd::Zero(Q + P);
  for (Index i = 0; i < Q; ++i) {
    const auto by = static_cast<Index>(fit_.multiplier[static_cast<std::size_t>(i)]);
    A.block(i, 0, 1, Q) = cross_.block(by, 0, 1, Q);
    b(i) = cross_(by, static_cast<Index>(at_.force()));
  }
  for (std::size_t s = 0; s < map::kSides; ++s) {
    const int side = static_cast<int>(s);
    const auto [first, count] = joint.map.span(side);
    const auto F = Q + static_cast<Index>(first);
    const auto N = static_cast<Index>(count);
    const double d = map::kDirection[s];
    VectorXd g(N);
    for (const Bin& bin : bins_[s]) {
      joint.map.gradient(side, bin.speed, g.data());
      const double now = joint.map.force(side, bin.speed);
      for (Index i = 0; i < Q; ++i) {
        const double z = bin.sum(static_cast<Index>(fit_.multiplier[static_cast<std::size_t>(i)]));
        A.block(i, F, 1, N) += d * z * g.transpose();
        b(i) -= d * now * z;
        A.block(F, i, N, 1) += d * bin.sum(i) * g;
      }
      A.block(F, F, N, N) += bin.rows * g * g.transpose();
      b.segment(F, N) += (d * bin.sum(static_cast<Index>(at_.force())) - bin.rows * now) * g;
    }
  }
  for (const Index i : fixed) {
    const double size = std::max(A(Q + i, Q + i), 1e-300);
    A.row(Q + i).setZero();
    A.col(Q + i).setZero();
    A(Q + i, Q + i) = size;
    b(Q + i) = 0.0;
  }
  const VectorXd scale = A.diagonal().cwiseAbs().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const std::optional<VectorXd> scaled =
      stats::solve_if_regular(scale.asDiagonal() * A * scale.asDiagonal(), scale.asDiagonal() * b);
  if (!scaled) return -1.0;
  const VectorXd x = scale.asDiagonal() * *scaled;
  if (!x.allFinite()) return -1.0;
  joint.linear = x.head(Q);
  return joint.map.move(x.tail(P));
}

/// The width of a Stribeck part, the values that are tried, and the parameter of the map that it is.
struct Width {
  std::size_t side = 0;
  Index parameter = 0;
  std::vector<double> tried;

  [[nodiscard]] double& of(map::StaticFit& map) const {
    return map.family == Family::kByDirection ? map.branch[side].terms.front().c : map.v0;
  }
};

std::vector<Width> widths_of(const map::StaticFit& map, const Pooled& sums) {
  std::vector<Width> out;
  if (map.family == Family::kSymmetricStribeck) {
    const std::size_t s = sums.slowest(0) < sums.slowest(1) ? 0 : 1;
    out.push_back({0, static_cast<Index>(map.parameters()) - 1,
                   map::stribeck_widths(sums.slowest(s), sums.fastest(s))});
  }
  if (map.family != Family::kByDirection) return out;
  for (std::size_t s = 0; s < map::kSides; ++s) {
    if (!map.branch[s].centred || map.branch[s].terms.empty()) continue;
    const auto [first, count] = map.span(static_cast<int>(s));
    out.push_back({s, static_cast<Index>(first + count) - 1,
                   map::stribeck_widths(sums.slowest(s) / map.top[s], sums.fastest(s) / map.top[s])});
  }
  return out;
}

/// Every width in turn at the place where the residual is smallest, with everything else fitted.
void scan_widths(const Pooled& sums, const std::vector<Width>& widths, JointFit& best) {
  std::vector<Index> fixed;
  for (const Width& w : widths) {
    fixed.push_back(w.parameter);
    if (!w.tried.empty()) w.of(best.map) = std::clamp(w.of(best.map), w.tried.front(), w.tried.back());
  }
  double least = std::numeric_limits<double>::infinity();
  const auto try_width = [&](const Width& w, double width) {
    JointFit trial = best;
    w.of(trial.map) = width;
    if (sums.step(trial, fixed) < 0.0 || !sums.bounded(trial.map)) return;
    const double loss = sums.loss(trial);
    if (loss < least) least = loss, best = std::move(trial);
  };
  for (int round = 0; round < kRounds; ++round) {
    for (const Width& w : widths) {
      for (const double width : w.tried) try_width(w, width);
    }
  }
}

}  // namespace

JointFit fit_jointly(const map::StaticFit& start, const LinearFit& fit, std::size_t without) {
  const Pooled sums(fit, without);
  const std::vector<Width> widths = widths_of(start, sums);
  JointFit plain{start, VectorXd::Zero(static_cast<Index>(fit.sums.layout.terms)), false};
  JointFit scanned = plain;
  // From the start alone, which may lie outside the widths that are scanned; the first step may make the residual larger.
  for (int i = 0; i < kSteps; ++i) {
    const double moved = sums.step(plain, {});
    if (moved < 0.0) break;
    plain.good = true;
    if (moved < 1e-6) break;
  }
  plain.good = plain.good && plain.map.plausible() && sums.bounded(plain.map);
  if (widths.empty()) return plain;
  scan_widths(sums, widths, scanned);
  double least = sums.loss(scanned);
  for (int i = 0; i < kSteps; ++i) {
    JointFit next = scanned;
    const double moved = sums.step(next, {});
    if (moved < 0.0 || !(sums.loss(next) < least) || !sums.bounded(next.map)) break;
    least = sums.loss(next);
    scanned = std::move(next);
    if (moved < 1e-6) break;
  }
  scanned.good = std::isfinite(least) && scanned.map.plausible() && sums.bounded(scanned.map);
  if (!scanned.good) return plain;
  return plain.good && sums.loss(plain) < least ? plain : scanned;
}

double loss_of(const JointFit& joint, const Sums& sums, std::size_t block) {
  const std::size_t q = sums.layout.terms;
  VectorXd h = VectorXd::Zero(static_cast<Index>(sums.layout.columns()));
  h.head(static_cast<Index>(q)) = -joint.linear;
  h(static_cast<Index>(sums.layout.force())) = 1.0;
  double loss = h.dot(sums.products[block] * h);
  for (int s = 0; s < map::kSides; ++s) {
    const auto side = static_cast<std::size_t>(s);
    for (std::size_t bin = 0; bin < sums.bins[side]; ++bin) {
      const BinSums t = sums.of(side, block, bin);
      if (t.rows() <= 0.0) continue;
      const double f = joint.map.force(s, t.speed() / t.rows());
      double left = t.force();
      for (std::size_t j = 0; j < q; ++j) left -= joint.linear(static_cast<Index>(j)) * t.column(j);
      loss += -2.0 * map::kDirection[side] * f * left + t.rows() * f * f;
    }
  }
  return loss;
}

}  // namespace stribeck::ident::drive
