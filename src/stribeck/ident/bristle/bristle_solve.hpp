#pragma once
/// Least squares over the models of bristle_model.hpp, how uncertain it is, and what it predicts of motion that
/// was left out.
///
///   min Σ (e_k/noise)² + Σ ((p − p0)/sd)²       p0, sd: what is believed before
///
///   C = H⁻¹·(ZᵀΓZ + P·noise²)·H⁻ᵀ,  H = ZᵀJ + P      Z = J, but for a mass from open loop the programmed force
///
/// Γ holds the autocovariance of the residuals (flat top to six memories, falling to zero at twelve); a second C
/// takes the scatter of the sums Zᵀe of whole stretches for it. The larger half width stands.
///
/// Source: instrument: Söderström, Errors-in-Variables Methods in System Identification, 2018; stretches as
/// clusters: Liang, Zeger 1986, doi:10.1093/biomet/73.1.13.
/// Inside ident only: includes Eigen and Ceres.
/// Real time: no.

#include <ceres/tiny_solver.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stribeck/ident/bristle/bristle_model.hpp>
#include <stribeck/ident/stats/long_run.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>
#include <vector>

namespace stribeck::ident::bristle {

inline constexpr int kFoldIterations = 6;
inline constexpr int kFolds = 4;
/// Fewer stretches say nothing about their scatter.
inline constexpr int kLeastClusters = 8;

/// What is believed before; an infinite sd says nothing.
struct Prior {
  VectorXd mean;
  VectorXd sd;
};

struct Problem {
  const VectorXd* at;              ///< values of fixed parameters
  const std::vector<Index>* free;  ///< numbers of the others
  const std::vector<char>* use;    ///< rows
  const Prior* prior;
  double noise;  ///< [N], of a row, for the weight against the prior
};

/// Least squares over some rows and some parameters.
template <class Case>
class Fit {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  Fit(const Model<Case>& model, const Problem& problem) : model_(&model), problem_(problem) {
    used_ = static_cast<Index>(std::count(problem.use->begin(), problem.use->end(), 1));
  }
  [[nodiscard]] int NumResiduals() const {
    return static_cast<int>(used_ + static_cast<Index>(problem_.free->size()));
  }
  [[nodiscard]] int NumParameters() const { return static_cast<int>(problem_.free->size()); }

  [[nodiscard]] VectorXd full(const double* p) const {
    VectorXd all = *problem_.at;
    for (std::size_t i = 0; i < problem_.free->size(); ++i) all((*problem_.free)[i]) = p[i];
    return all;
  }

  bool operator()(const double* p, double* residuals, double* jacobian) const {
    const VectorXd all = full(p);
    if (!all.allFinite() || all.cwiseAbs().maxCoeff() > 1e4) return false;
    model_->evaluate(all, e_, jacobian != nullptr ? &j_ : nullptr);
    if (!e_.allFinite()) return false;
    const auto free = static_cast<Index>(problem_.free->size());
    Eigen::Map<VectorXd> r(residuals, NumResiduals());
    Eigen::Map<MatrixXd> j(jacobian, jacobian != nullptr ? NumResiduals() : 0, free);
    Index row = 0;
    for (Index k = 0; k < e_.size(); ++k) {
      if ((*problem_.use)[static_cast<std::size_t>(k)] == 0) continue;
      r(row) = e_(k) / problem_.noise;
      if (jacobian != nullptr) {
        for (Index c = 0; c < free; ++c)
          j(row, c) = j_(k, (*problem_.free)[static_cast<std::size_t>(c)]) / problem_.noise;
      }
      ++row;
    }
    if (jacobian != nullptr) j.bottomRows(free).setZero();
    for (Index c = 0; c < free; ++c, ++row) {
      const Index at = (*problem_.free)[static_cast<std::size_t>(c)];
      const double sd = problem_.prior->sd(at);
      r(row) = (all(at) - problem_.prior->mean(at)) / sd;
      if (jacobian != nullptr) j(row, c) = 1.0 / sd;
    }
    return jacobian == nullptr || j.allFinite();
  }

 private:
  const Model<Case>* model_;
  Problem problem_;
  Index used_ = 0;
  mutable VectorXd e_;
  mutable MatrixXd j_;
};

struct Solution {
  VectorXd p;  ///< all parameters
  double cost = std::numeric_limits<double>::infinity();
};

template <class Case>
Solution solve(const Model<Case>& model, const Problem& problem, int iterations) {
  const Fit<Case> fit(model, problem);
  ceres::TinySolver<Fit<Case>> solver;
  solver.options.max_num_iterations = iterations;
  solver.options.function_tolerance = 1e-6;
  solver.options.parameter_tolerance = 1e-6;
  solver.options.gradient_tolerance = 1e-8;
  solver.options.initial_trust_region_radius = 100.0;
  VectorXd p(static_cast<Index>(problem.free->size()));
  for (std::size_t i = 0; i < problem.free->size(); ++i)
    p(static_cast<Index>(i)) = (*problem.at)((*problem.free)[i]);
  const auto summary = solver.Solve(fit, &p);
  Solution s;
  s.p = fit.full(p.data());
  if (std::isfinite(summary.final_cost) && s.p.allFinite()) s.cost = summary.final_cost;
  return s;
}

/// Row k − l of the list lies l rows before row k in one record.
inline bool apart(const BristlePath& path, std::size_t k, std::size_t l) {
  const PathRow& a = path.rows[k];
  const PathRow& b = path.rows[k - l];
  return a.record == b.record && a.at - b.at == l;
}

inline stats::Memory memory_of_rows(const BristlePath& path, const VectorXd& e) {
  std::vector<int> record;
  std::vector<std::size_t> at;
  for (const PathRow& row : path.rows) {
    record.push_back(row.record);
    at.push_back(row.at);
  }
  return stats::memory_of({e.data(), e.data() + e.size()}, record, at);
}

/// Jacobian of the free parameters and what the residuals are made orthogonal to: the same, but for the mass
/// (number `mass`, negative: none) the programmed force.
template <class Case>
void sensitivities(const Model<Case>& model, const VectorXd& p, const std::vector<Index>& free, Index mass,
                   VectorXd& e, MatrixXd& J, MatrixXd& Z) {
  MatrixXd all;
  model.evaluate(p, e, &all);
  J.resize(e.size(), static_cast<Index>(free.size()));
  for (Index c = 0; c < J.cols(); ++c) J.col(c) = all.col(free[static_cast<std::size_t>(c)]);
  Z = J;
  for (Index c = 0; c < J.cols(); ++c) {
    if (free[static_cast<std::size_t>(c)] == mass) Z.col(c) = model.force();
  }
}

inline MatrixXd weight_of(const Prior& prior, const std::vector<Index>& free, double noise) {
  MatrixXd P = MatrixXd::Zero(static_cast<Index>(free.size()), static_cast<Index>(free.size()));
  for (Index c = 0; c < P.cols(); ++c) {
    const double sd = prior.sd(free[static_cast<std::size_t>(c)]);
    P(c, c) = noise * noise / (sd * sd);
  }
  return P;
}

/// From the least-squares solution to that of the instrument: force noise moves the axis, so that least squares
/// takes part of it for less mass (−0.2 % on pulses of the biaxial table).
template <class Case>
void correct_mass(const Model<Case>& model, VectorXd& p, const std::vector<Index>& free, const Prior& prior,
                  double noise) {
  VectorXd q = p;
  VectorXd e;
  MatrixXd J;
  MatrixXd Z;
  const Index mass = model.own() + kMass;
  const MatrixXd P = weight_of(prior, free, noise);
  for (int i = 0; i < 4; ++i) {
    sensitivities(model, q, free, mass, e, J, Z);
    VectorXd pull(P.cols());
    for (Index c = 0; c < P.cols(); ++c) {
      const Index at = free[static_cast<std::size_t>(c)];
      pull(c) = q(at) - prior.mean(at);
    }
    const VectorXd step = (Z.transpose() * J + P).fullPivLu().solve(-(Z.transpose() * e) - P * pull);
    // A step that leaves the neighbourhood is no correction.
    if (!step.allFinite() || step.cwiseAbs().maxCoeff() > 1.0) return;
    for (Index c = 0; c < P.cols(); ++c) q(free[static_cast<std::size_t>(c)]) += step(c);
  }
  p = q;
}

/// Covariance of the free parameters under the residuals' own correlation.
struct Spread {
  MatrixXd stationary;
  MatrixXd clustered;
  double factor = 1.96;
  double cluster_factor = 0.0;  ///< 0: too few stretches
  std::vector<Index> free;

  /// 95 % half width of gᵀp; g over all parameters.
  [[nodiscard]] double half_width(const VectorXd& g) const {
    VectorXd part(static_cast<Index>(free.size()));
    for (std::size_t i = 0; i < free.size(); ++i) part(static_cast<Index>(i)) = g(free[i]);
    const double a = factor * std::sqrt(std::max(0.0, part.dot(stationary * part)));
    const double b = cluster_factor * std::sqrt(std::max(0.0, part.dot(clustered * part)));
    return std::max(a, b);
  }
};

template <class Case>
Spread spread_of(const Model<Case>& model, const VectorXd& p, const std::vector<Index>& free,
                 const Prior& prior, double noise, Index mass) {
  const BristlePath& path = model.path();
  VectorXd e;
  MatrixXd J;
  MatrixXd Z;
  sensitivities(model, p, free, mass, e, J, Z);
  const stats::Memory memory = memory_of_rows(path, e);
  const auto n = static_cast<Index>(free.size());
  // Autocovariance, with a flat top up to six memories and a straight fall to zero at twelve.
  const auto lags = std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(12.0 * memory.rows)), 2, 400);
  const auto rows = static_cast<std::size_t>(e.size());
  std::vector<double> gamma(lags + 1, 0.0);
  const double scale = 1.0 / static_cast<double>(std::max<Index>(1, e.size() - n));
  std::size_t longest = 0;
  for (std::size_t l = 0; l <= lags; ++l) {
    for (std::size_t k = l; k < rows; ++k) {
      if (!apart(path, k, l)) continue;
      gamma[l] += e(static_cast<Index>(k)) * e(static_cast<Index>(k - l)) * scale;
    }
    const double w = std::min(1.0, 2.0 * (1.0 - static_cast<double>(l) / static_cast<double>(lags + 1)));
    gamma[l] *= w;
    if (std::abs(gamma[l]) > 0.0) longest = l;
  }
  MatrixXd filtered = gamma[0] * Z;
  for (std::size_t l = 1; l <= longest; ++l) {
    for (std::size_t k = l; k < rows; ++k) {
      if (!apart(path, k, l)) continue;
      const auto i = static_cast<Index>(k);
      const auto j = static_cast<Index>(k - l);
      filtered.row(i) += gamma[l] * Z.row(j);
      filtered.row(j) += gamma[l] * Z.row(i);
    }
  }
  const MatrixXd P = weight_of(prior, free, noise);
  const MatrixXd inverse = (Z.transpose() * J + P).fullPivLu().inverse();
  // What is believed before is noise of its own.
  const MatrixXd prior_part = noise * noise * P;
  Spread out;
  out.free = free;
  out.stationary = inverse * (Z.transpose() * filtered + prior_part) * inverse.transpose();
  const double independent = static_cast<double>(rows) / (2.0 * memory.rows);
  out.factor = stats::student_factor(std::max(3.0, independent - static_cast<double>(n)));

  std::vector<VectorXd> scores;
  int last = -1;
  for (std::size_t k = 0; k < rows; ++k) {
    if (path.rows[k].stretch != last) scores.push_back(VectorXd::Zero(n));
    last = path.rows[k].stretch;
    scores.back() += Z.row(static_cast<Index>(k)).transpose() * e(static_cast<Index>(k));
  }
  const auto clusters = static_cast<int>(scores.size());
  if (clusters >= kLeastClusters) {
    MatrixXd S = prior_part;
    for (const VectorXd& s : scores)
      S += s * s.transpose() * (static_cast<double>(clusters) / (clusters - 1));
    out.clustered = inverse * S * inverse.transpose();
    out.cluster_factor = stats::student_factor(clusters - 1.0);
  } else {
    out.clustered = MatrixXd::Zero(n, n);
  }
  return out;
}

/// Squares of held-out residuals per stretch, over the rows after reversals.
struct HeldOut {
  std::vector<double> square;
  std::vector<double> count;
  [[nodiscard]] double rms() const {
    const double n = std::accumulate(count.begin(), count.end(), 0.0);
    return n > 0.0 ? std::sqrt(std::accumulate(square.begin(), square.end(), 0.0) / n)
                   : std::numeric_limits<double>::quiet_NaN();
  }
};

template <class Case>
HeldOut hold_out(const Model<Case>& model, const VectorXd& start, const std::vector<Index>& free,
                 const Prior& prior, double noise, const BristlePath& path) {
  HeldOut out;
  out.square.assign(static_cast<std::size_t>(path.stretches), 0.0);
  out.count = out.square;
  // Two neighbours go together, so that every part has both directions.
  const int group = path.stretches >= 2 * kFolds ? 2 : 1;
  const int folds = std::min(kFolds, path.stretches);
  for (int fold = 0; fold < folds && folds > 1; ++fold) {
    std::vector<char> use;
    for (const PathRow& row : path.rows) use.push_back(row.stretch / group % folds == fold ? 0 : 1);
    if (std::count(use.begin(), use.end(), 1) < static_cast<std::ptrdiff_t>(free.size())) continue;
    const Solution s = solve(model, {&start, &free, &use, &prior, noise}, kFoldIterations);
    VectorXd e;
    model.evaluate(s.p, e, nullptr, false);
    for (std::size_t k = 0; k < path.rows.size(); ++k) {
      if (use[k] != 0 || !path.rows[k].turning) continue;
      const auto at = static_cast<std::size_t>(path.rows[k].stretch);
      out.square[at] += e(static_cast<Index>(k)) * e(static_cast<Index>(k));
      out.count[at] += 1.0;
    }
  }
  return out;
}

/// Standard error of the difference in RMS from the best, over stretches.
inline double error_of_difference(const HeldOut& a, const HeldOut& best) {
  const double n = std::accumulate(a.count.begin(), a.count.end(), 0.0);
  double groups = 0.0;
  double mean = 0.0;
  for (std::size_t g = 0; g < a.count.size(); ++g) {
    if (a.count[g] == 0.0) continue;
    groups += 1.0;
    mean += a.square[g] - best.square[g];
  }
  if (groups < 2.0 || n == 0.0) return 0.0;
  mean /= groups;
  double sum = 0.0;
  for (std::size_t g = 0; g < a.count.size(); ++g) {
    if (a.count[g] == 0.0) continue;
    const double d = a.square[g] - best.square[g] - mean;
    sum += d * d;
  }
  return std::sqrt(sum * groups / (groups - 1.0)) / n / (a.rms() + best.rms());
}

}  // namespace stribeck::ident::bristle
