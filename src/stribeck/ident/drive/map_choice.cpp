#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/drive/map_choice.hpp>

namespace stribeck::ident::drive {
namespace {

/// Sums by block and bin of the residual of the linear terms: for the fit, and for judging with terms fitted without the block.
std::array<map::SideSums, map::kSides> sums_left(const AlignedLog& log, const Rows& rows, const Terms& terms,
                                                 const LinearFit& fit) {
  std::array<map::SideSums, map::kSides> sums;
  for (std::size_t s = 0; s < map::kSides; ++s) {
    sums[s].grid = rows.grid[s];
    const std::vector<double> zero(static_cast<std::size_t>(rows.grid[s].bins));
    const map::BlockSums empty{zero, zero, zero, zero};
    sums[s].block.assign(rows.blocks, empty);
    sums[s].held.assign(rows.blocks, empty);
  }
  const std::size_t q = terms.count();
  std::vector<double> c(q + 1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t s = rows.side[i];
    const auto b = static_cast<std::size_t>(rows.bin[i]);
    const double speed = std::abs(velocity_of(log, rows, i));
    const double force = terms.fill(log, rows, i, c.data()) - fit.load;
    double full = force, held = force;
    const VectorXd& other = fit.held_out[rows.block[i]];
    for (std::size_t j = 0; j < q; ++j) {
      full -= fit.value(static_cast<Index>(j)) * c[j];
      held -= other(static_cast<Index>(j)) * c[j];
    }
    const auto add = [&](map::BlockSums& block, double f) {
      f *= map::kDirection[s];
      block.n[b] += 1.0;
      block.v[b] += speed;
      block.f[b] += f;
      block.ff[b] += f * f;
    };
    add(sums[s].block[rows.block[i]], full);
    add(sums[s].held[rows.block[i]], held);
  }
  return sums;
}

/// Normal equations of linear terms and map together.
struct Normal {
  MatrixXd A;
  VectorXd b;

  /// Adds one bin; `sum` has the layout of the bins.
  void add_bin(const map::StaticFit& map, int side, const VectorXd& sum, const SumsLayout& at,
               const std::vector<std::size_t>& multiplier) {
    const double rows = sum(static_cast<Index>(at.rows()));
    if (rows <= 0.0) return;
    const double speed = sum(static_cast<Index>(at.speed())) / rows;
    const auto Q = static_cast<Index>(at.terms);
    const auto [first, count] = map.span(side);
    const auto F = Q + static_cast<Index>(first);
    const auto N = static_cast<Index>(count);
    VectorXd g(N);
    map.gradient(side, speed, g.data());
    const double now = map.force(side, speed);
    const double d = map::kDirection[static_cast<std::size_t>(side)];
    for (Index i = 0; i < Q; ++i) {
      const double z = sum(static_cast<Index>(multiplier[static_cast<std::size_t>(i)]));
      A.block(i, F, 1, N) += d * z * g.transpose();
      b(i) -= d * now * z;
      A.block(F, i, N, 1) += d * sum(i) * g;
    }
    A.block(F, F, N, N) += rows * g * g.transpose();
    b.segment(F, N) += (d * sum(static_cast<Index>(at.force())) - rows * now) * g;
  }
};

/// The sums of a bin over all blocks but one.
VectorXd sum_without(const Sums& sums, std::size_t side, std::size_t bin, std::size_t without) {
  VectorXd sum = VectorXd::Zero(static_cast<Index>(sums.layout.size()));
  for (std::size_t k = 0; k < sums.blocks; ++k) {
    if (k != without) sum += sums.of(side, k, bin).first(sums.layout.size());
  }
  return sum;
}

const char* const kTogether = "with periodic terms: ";

}  // namespace

MapChoice choose_map(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                     const DriveFitOptions& options) {
  map::StaticOptions statics;
  statics.terms = options.terms;
  statics.most_terms = options.most_terms;
  statics.symmetric = options.symmetric;
  MapChoice out{map::choose_static(sums_left(log, rows, terms, fit), statics), std::nullopt};
  out.map.fit.load += fit.load;
  for (map::StaticFit& rival : out.map.rivals) rival.load += fit.load;
  for (map::StaticFit& simple : out.map.simple) simple.load += fit.load;
  return out;
}

JointFit fit_jointly(const map::StaticFit& start, const LinearFit& fit, std::size_t without) {
  const Sums& sums = fit.sums;
  const SumsLayout& at = sums.layout;
  const auto Q = static_cast<Index>(at.terms), P = static_cast<Index>(start.parameters());
  const auto W = static_cast<Index>(at.columns());
  MatrixXd cross = MatrixXd::Zero(W, W);
  for (std::size_t k = 0; k < sums.blocks; ++k) {
    if (k != without) cross += sums.products[k];
  }
  JointFit out{start, VectorXd::Zero(Q), false};
  constexpr int kSteps = 8;
  for (int step = 0; step < kSteps; ++step) {
    Normal normal{MatrixXd::Zero(Q + P, Q + P), VectorXd::Zero(Q + P)};
    for (Index i = 0; i < Q; ++i) {
      const auto by = static_cast<Index>(fit.multiplier[static_cast<std::size_t>(i)]);
      for (Index j = 0; j < Q; ++j) normal.A(i, j) = cross(by, j);
      normal.b(i) = cross(by, static_cast<Index>(at.force()));
    }
    for (int s = 0; s < map::kSides; ++s) {
      const auto side = static_cast<std::size_t>(s);
      for (std::size_t bin = 0; bin < sums.bins[side]; ++bin)
        normal.add_bin(out.map, s, sum_without(sums, side, bin, without), at, fit.multiplier);
    }
    const VectorXd scale = normal.A.diagonal().cwiseAbs().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::FullPivLU<MatrixXd> lu(scale.asDiagonal() * normal.A * scale.asDiagonal());
    if (!lu.isInvertible()) return out;
    const VectorXd x = scale.asDiagonal() * lu.solve(scale.asDiagonal() * normal.b);
    if (!x.allFinite()) return out;
    out.linear = x.head(Q);
    if (out.map.move(x.tail(P)) < 1e-6) break;
  }
  out.good = out.map.plausible();
  return out;
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

MapChoice with_joint_fits(MapChoice choice, const LinearFit& fit) {
  map::StaticChoice& map = choice.map;
  const std::size_t blocks = fit.sums.blocks;
  choice.joint.reset();
  std::vector<JointFit> fits;
  std::vector<std::vector<double>> losses{map.block_loss};
  std::vector<std::size_t> parameters{map.fit.parameters()};
  for (const map::StaticFit& start : map.simple) {
    JointFit joint = fit_jointly(start, fit, blocks);
    if (!joint.good) continue;
    std::vector<double> loss;
    for (std::size_t k = 0; k < blocks; ++k)
      loss.push_back(loss_of(fit_jointly(joint.map, fit, k), fit.sums, k));
    losses.push_back(std::move(loss));
    parameters.push_back(joint.map.parameters());
    fits.push_back(std::move(joint));
  }
  const map::Picked picked = map::pick(losses, parameters, map.tested);
  for (std::size_t i = 0; i < fits.size(); ++i) {
    Candidate c;
    c.name = kTogether + fits[i].map.name();
    c.parameters = static_cast<int>(parameters[i + 1]);
    c.held_out_rms = picked.rms[i + 1];
    c.standard_error = picked.error[i + 1];
    c.chosen = picked.chosen == i + 1;
    map.candidates.push_back(std::move(c));
  }
  if (picked.chosen == 0) return choice;
  const std::size_t together = map.candidates.size() - fits.size();
  for (std::size_t i = 0; i < together; ++i) map.candidates[i].chosen = false;
  const JointFit& best = fits[picked.chosen - 1];
  map.rivals.clear();
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (picked.equal[i + 1] && i + 1 != picked.chosen) map.rivals.push_back(fits[i].map);
  }
  map.fit = best.map;
  map.block_loss = losses[picked.chosen];
  map.held_out_rms = picked.rms[picked.chosen];
  choice.joint = best.linear;
  return choice;
}

}  // namespace stribeck::ident::drive
