#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/bristle/bristle_solve.hpp>
#include <stribeck/ident/stats/least_squares.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/quantiles.hpp>

namespace stribeck::ident::bristle {
namespace {

constexpr int kFolds = 4;
/// How far the sum of squares may be from the one that a step promised, as a share of what it promised to take off.
constexpr double kAsPromised = 0.2;
constexpr double kHardlyAny = 1e-4;  ///< of the sum of squares: a promise too small to be compared
/// Fewer stretches do not show their scatter.
constexpr int kLeastClusters = 8;

/// Least squares over some rows and some parameters.
class Fit : public stats::Residuals {
 public:
  Fit(const Model& model, const Problem& problem) : model_(&model), problem_(problem) {
    used_ = static_cast<Index>(std::count(problem.use->begin(), problem.use->end(), 1));
  }
  [[nodiscard]] int count() const override {
    return static_cast<int>(used_ + static_cast<Index>(problem_.free->size()));
  }
  [[nodiscard]] int parameters() const override { return static_cast<int>(problem_.free->size()); }

  [[nodiscard]] VectorXd full(const double* p) const {
    VectorXd all = *problem_.at;
    for (std::size_t i = 0; i < problem_.free->size(); ++i) all((*problem_.free)[i]) = p[i];
    return all;
  }

  bool evaluate(const double* p, double* residuals, double* jacobian) const override {
    const VectorXd all = full(p);
    if (!all.allFinite() || all.cwiseAbs().maxCoeff() > 1e4) return false;
    model_->evaluate(all, e_, jacobian != nullptr ? &j_ : nullptr);
    if (!e_.allFinite()) return false;
    const auto free = static_cast<Index>(problem_.free->size());
    Eigen::Map<VectorXd> r(residuals, count());
    Eigen::Map<MatrixXd> j(jacobian, jacobian != nullptr ? count() : 0, free);
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
  const Model* model_;
  Problem problem_;
  Index used_ = 0;
  mutable VectorXd e_;
  mutable MatrixXd j_;
};

/// Row k − l of the list must lie l rows before row k in the same record.
bool apart(const BristlePath& path, std::size_t k, std::size_t l) {
  const PathRow& a = path.rows[k];
  const PathRow& b = path.rows[k - l];
  return a.record == b.record && a.at - b.at == l;
}

/// Number of rows of the list that lie before each without a gap in the same record.
std::vector<std::size_t> rows_before(const BristlePath& path) {
  std::vector<std::size_t> before(path.rows.size(), 0);
  for (std::size_t k = 1; k < before.size(); ++k) before[k] = apart(path, k, 1) ? before[k - 1] + 1 : 0;
  return before;
}

/// Jacobian of the free parameters, and the matrix to which the residuals are made orthogonal. Both are equal, except for the mass
/// (number `mass`, negative: none), where the second is the programmed force.
void sensitivities(const Model& model, const VectorXd& p, const std::vector<Index>& free, Index mass,
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

MatrixXd weight_of(const Prior& prior, const std::vector<Index>& free, double noise) {
  MatrixXd P = MatrixXd::Zero(static_cast<Index>(free.size()), static_cast<Index>(free.size()));
  for (Index c = 0; c < P.cols(); ++c) {
    const double sd = prior.sd(free[static_cast<std::size_t>(c)]);
    P(c, c) = noise * noise / (sd * sd);
  }
  return P;
}

}  // namespace

Solution solve(const Model& model, const Problem& problem, int iterations) {
  const Fit fit(model, problem);
  stats::DescentOptions options;
  options.iterations = iterations;
  options.function_tolerance = 1e-6;
  options.parameter_tolerance = 1e-6;
  options.gradient_tolerance = 1e-8;
  options.trust_region = 100.0;
  VectorXd p(static_cast<Index>(problem.free->size()));
  for (std::size_t i = 0; i < problem.free->size(); ++i)
    p(static_cast<Index>(i)) = (*problem.at)((*problem.free)[i]);
  const double cost = stats::minimise_squares(fit, p, options).cost;
  Solution s;
  s.p = fit.full(p.data());
  if (std::isfinite(cost) && s.p.allFinite()) s.cost = cost;
  return s;
}

stats::Memory memory_of_rows(const BristlePath& path, const VectorXd& e) {
  std::vector<int> record;
  std::vector<std::size_t> at;
  for (const PathRow& row : path.rows) {
    record.push_back(row.record);
    at.push_back(row.at);
  }
  return stats::memory_of({e.data(), e.data() + e.size()}, record, at);
}

void correct_mass(const Model& model, VectorXd& p, const std::vector<Index>& free, const Prior& prior,
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
    const VectorXd step = stats::solve_full_lu(Z.transpose() * J + P, -(Z.transpose() * e) - P * pull);
    // A step that leaves the neighbourhood is not a valid correction.
    if (!step.allFinite() || step.cwiseAbs().maxCoeff() > 1.0) return;
    for (Index c = 0; c < P.cols(); ++c) q(free[static_cast<std::size_t>(c)]) += step(c);
  }
  p = q;
}

double Spread::half_width(const VectorXd& g) const {
  VectorXd part(static_cast<Index>(free.size()));
  for (std::size_t i = 0; i < free.size(); ++i) part(static_cast<Index>(i)) = g(free[i]);
  const double a = factor * std::sqrt(std::max(0.0, part.dot(stationary * part)));
  const double b = cluster_factor * std::sqrt(std::max(0.0, part.dot(clustered * part)));
  return std::max(a, b);
}

Spread spread_of(const Model& model, const VectorXd& p, const std::vector<Index>& free, const Prior& prior,
                 double noise, Index mass) {
  const BristlePath& path = model.path();
  VectorXd e;
  MatrixXd J;
  MatrixXd Z;
  sensitivities(model, p, free, mass, e, J, Z);
  const stats::Memory memory = memory_of_rows(path, e);
  const auto n = static_cast<Index>(free.size());
  // Autocovariance with weight one up to six correlation lengths, falling linearly to zero at twelve.
  const auto lags = std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(12.0 * memory.rows)), 2, 400);
  const auto rows = static_cast<std::size_t>(e.size());
  std::vector<double> gamma(lags + 1, 0.0);
  const double scale = 1.0 / static_cast<double>(std::max<Index>(1, e.size() - n));
  const std::vector<std::size_t> before = rows_before(path);
  std::size_t longest = 0;
  for (std::size_t l = 0; l <= lags; ++l) {
    for (std::size_t k = l; k < rows; ++k) {
      if (before[k] < l) continue;
      gamma[l] += e(static_cast<Index>(k)) * e(static_cast<Index>(k - l)) * scale;
    }
    const double w = std::min(1.0, 2.0 * (1.0 - static_cast<double>(l) / static_cast<double>(lags + 1)));
    gamma[l] *= w;
    if (std::abs(gamma[l]) > 0.0) longest = l;
  }
  // A row of Z is a column here, so that its numbers lie side by side.
  const MatrixXd across = Z.transpose();
  MatrixXd filtered = gamma[0] * across;
  for (std::size_t l = 1; l <= longest; ++l) {
    for (std::size_t k = l; k < rows; ++k) {
      if (before[k] < l) continue;
      const auto i = static_cast<Index>(k);
      const auto j = static_cast<Index>(k - l);
      filtered.col(i) += gamma[l] * across.col(j);
      filtered.col(j) += gamma[l] * across.col(i);
    }
  }
  const MatrixXd P = weight_of(prior, free, noise);
  const MatrixXd inverse = stats::inverse_full_lu(Z.transpose() * J + P);
  // The prior adds noise of its own.
  const MatrixXd prior_part = noise * noise * P;
  Spread out;
  out.free = free;
  out.stationary = inverse * (across * filtered.transpose() + prior_part) * inverse.transpose();
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

double HeldOut::rms() const {
  const double n = std::accumulate(count.begin(), count.end(), 0.0);
  return n > 0.0 ? std::sqrt(std::accumulate(square.begin(), square.end(), 0.0) / n) : kNaN;
}

namespace {

/// Residuals and derivatives at the solution of all rows.
struct Linear {
  VectorXd e;
  MatrixXd J;
};

/// The solution without the rows that are not used, by one step of Gauss and Newton from that of all rows. Empty where the sum of squares
/// does not fall as the step promises: then it has to be searched.
std::optional<VectorXd> by_one_step(const Model& model, const Problem& problem, const Linear& at) {
  const auto n = static_cast<Index>(problem.free->size());
  const double weight = 1.0 / (problem.noise * problem.noise);
  MatrixXd A = MatrixXd::Zero(n, n);
  VectorXd b = VectorXd::Zero(n);
  const auto cost = [&](const VectorXd& p, const VectorXd& e) {
    double sum = 0.0;
    for (Index k = 0; k < e.size(); ++k)
      sum += (*problem.use)[static_cast<std::size_t>(k)] != 0 ? weight * e(k) * e(k) : 0.0;
    for (const Index i : *problem.free)
      sum += std::pow((p(i) - problem.prior->mean(i)) / problem.prior->sd(i), 2.0);
    return sum;
  };
  for (Index k = 0; k < at.e.size(); ++k) {
    if ((*problem.use)[static_cast<std::size_t>(k)] == 0) continue;
    A.noalias() += weight * at.J.row(k).transpose() * at.J.row(k);
    b.noalias() += weight * at.e(k) * at.J.row(k).transpose();
  }
  for (Index c = 0; c < n; ++c) {
    const Index i = (*problem.free)[static_cast<std::size_t>(c)];
    const double own = std::pow(problem.prior->sd(i), -2.0);
    A(c, c) += own;
    b(c) += own * ((*problem.at)(i)-problem.prior->mean(i));
  }
  const VectorXd step = stats::solve_full_lu(A, -b);
  if (!step.allFinite() || step.cwiseAbs().maxCoeff() > 1.0) return {};
  VectorXd p = *problem.at;
  for (Index c = 0; c < n; ++c) p((*problem.free)[static_cast<std::size_t>(c)]) += step(c);
  VectorXd e;
  model.evaluate(p, e, nullptr);
  const double before = cost(*problem.at, at.e), after = cost(p, e), promised = -b.dot(step);
  const double scale = std::max(promised, kHardlyAny * before);
  if (!(std::abs(before - promised - after) < kAsPromised * scale)) return {};
  return p;
}

}  // namespace

HeldOut hold_out(const Model& model, const VectorXd& start, const std::vector<Index>& free,
                 const Prior& prior, double noise, const BristlePath& path) {
  HeldOut out;
  out.square.assign(static_cast<std::size_t>(path.stretches), 0.0);
  out.count = out.square;
  // Two neighbours stay together, so that every part has both directions.
  const int group = path.stretches >= 2 * kFolds ? 2 : 1;
  const int folds = std::min(kFolds, path.stretches);
  Linear whole;
  MatrixXd instruments;
  sensitivities(model, start, free, -1, whole.e, whole.J, instruments);
  for (int fold = 0; fold < folds && folds > 1; ++fold) {
    std::vector<char> use;
    for (const PathRow& row : path.rows) use.push_back(row.stretch / group % folds == fold ? 0 : 1);
    if (std::count(use.begin(), use.end(), 1) < static_cast<std::ptrdiff_t>(free.size())) continue;
    const Problem problem{&start, &free, &use, &prior, noise};
    const std::optional<VectorXd> near = by_one_step(model, problem, whole);
    VectorXd e;
    model.evaluate(near ? *near : solve(model, problem, kFoldIterations).p, e, nullptr, false);
    for (std::size_t k = 0; k < path.rows.size(); ++k) {
      if (use[k] != 0 || !path.rows[k].turning) continue;
      const auto at = static_cast<std::size_t>(path.rows[k].stretch);
      out.square[at] += e(static_cast<Index>(k)) * e(static_cast<Index>(k));
      out.count[at] += 1.0;
    }
  }
  return out;
}

double error_of_difference(const HeldOut& a, const HeldOut& best) {
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
