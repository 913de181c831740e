#include <ceres/jet.h>
#include <ceres/tiny_solver.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stribeck/friction/gaussian.hpp>
#include <stribeck/ident/gaussian_fit.hpp>

namespace stribeck::ident {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Index = Eigen::Index;

// Centres may lie beyond the range on both sides (Table 2.3 has one at 1.47 of it).
constexpr double kLowestCentre = -0.6;
constexpr double kHighestCentre = 1.7;
constexpr double kWidest = 2.0;
/// The level may fall to this share of η0 + η1.
constexpr double kLeastLevel = 0.05;
constexpr double kFirmer = 0.2;
constexpr int kPulls = 6;
/// The straight line may take this share of the smallest friction per speed.
constexpr double kMostViscous = 0.6;

/// (lo, hi) ↔ the whole line.
double into(double p, double lo, double hi) { return lo + (hi - lo) / (1.0 + std::exp(-p)); }
double out_of(double x, double lo, double hi) {
  const double s = std::clamp((x - lo) / (hi - lo), 1e-6, 1.0 - 1e-6);
  return std::log(s / (1.0 - s));
}
double slope(double p, double lo, double hi) {
  const double s = 1.0 / (1.0 + std::exp(-p));
  return (hi - lo) * s * (1.0 - s);
}

/// Least squares with the heights and the straight line eliminated.
class Projected {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  Projected(const Bins& bins, int terms, const FitSettings& settings)
      : terms_(terms), settings_(settings), rows_(static_cast<Index>(bins.size())) {
    u_ = Eigen::Map<const VectorXd>(bins.u.data(), rows_);
    root_ = Eigen::Map<const VectorXd>(bins.weight.data(), rows_).cwiseSqrt() / settings.noise;
    // Below the bins: one row for each pull, terms first, then η1 and η0.
    pulls_ = terms > 0 ? terms + 2 : 0;
    y_ = VectorXd::Zero(rows_ + pulls_);
    y_.head(rows_) = Eigen::Map<const VectorXd>(bins.force.data(), rows_).cwiseProduct(root_);
    design_ = MatrixXd::Zero(rows_ + pulls_, 2 + terms);
    design_.col(0).head(rows_) = root_;
    design_.col(1).head(rows_) = root_.cwiseProduct(u_);
    for (int i = 0; i < terms; ++i) design_(rows_ + i, 2 + i) = 1.0 / settings.height_scale;
    if (terms > 0) {
      const VectorXd line = design_.topLeftCorner(rows_, 2).colPivHouseholderQr().solve(y_.head(rows_));
      double viscous = std::max(0.0, line(1));
      for (std::size_t k = 0; k < bins.size(); ++k)
        viscous = std::min(viscous, kMostViscous * bins.force[k] / bins.u[k]);
      design_(rows_ + terms, 1) = 1.0 / settings.slope_scale;
      y_(rows_ + terms) = viscous / settings.slope_scale;
      design_(rows_ + terms + 1, 0) = 1.0 / settings.slope_scale;
      y_(rows_ + terms + 1) = line(0) / settings.slope_scale;
    }
    prepare();
  }

  [[nodiscard]] int NumResiduals() const { return static_cast<int>(rows_) + pulls_; }
  [[nodiscard]] int NumParameters() const { return 2 * terms_; }

  [[nodiscard]] double low_width() const { return std::log(settings_.narrowest); }
  [[nodiscard]] static double high_width() { return std::log(kWidest); }

  bool operator()(const double* p, double* residuals, double* jacobian) const {
    evaluate(p);
    Eigen::Map<VectorXd> r(residuals, NumResiduals());
    r = y_ - design_ * linear_;
    if (jacobian == nullptr) return true;
    Eigen::Map<MatrixXd> j(jacobian, NumResiduals(), NumParameters());
    for (int i = 0; i < terms_; ++i) {
      const double c = width_[i];
      const auto d = ((u_.array() - centre_[i]) / c).eval();
      const auto g = (design_.col(2 + i).head(rows_).array() * (2.0 * linear_(2 + i))).eval();
      j.col(2 * i).setZero();
      j.col(2 * i + 1).setZero();
      j.col(2 * i).head(rows_) = -(g * d / c).matrix() * slope(p[2 * i], kLowestCentre, kHighestCentre);
      // c = exp(q): ∂c/∂q = c.
      j.col(2 * i + 1).head(rows_) = -(g * d * d).matrix() * slope(p[2 * i + 1], low_width(), high_width());
    }
    j -= thin_ * (thin_.transpose() * j).eval();
    return true;
  }

  [[nodiscard]] BranchFit result(const double* p) const {
    evaluate(p);
    BranchFit fit;
    fit.eta0 = linear_(0);
    fit.eta1 = linear_(1);
    for (int i = 0; i < terms_; ++i) fit.terms.push_back({linear_(2 + i), centre_[i], width_[i]});
    fit.cost = (y_ - design_ * linear_).head(rows_).squaredNorm() * settings_.noise * settings_.noise;
    return fit;
  }

  /// What a further term of this centre and width would take off the cost.
  [[nodiscard]] double gain(double centre, double width, const VectorXd& residual) const {
    VectorXd g = VectorXd::Zero(rows_ + pulls_);
    g.head(rows_) = column(centre, width);
    g -= thin_ * (thin_.transpose() * g).eval();
    const double along = g.dot(residual);
    const double pull = 1.0 / (settings_.height_scale * settings_.height_scale);
    return along * along / (g.squaredNorm() + pull);
  }
  [[nodiscard]] VectorXd residual(const double* p) const {
    evaluate(p);
    return y_ - design_ * linear_;
  }

 private:
  [[nodiscard]] VectorXd column(double centre, double width) const {
    return (root_.array() * (-((u_.array() - centre) / width).square()).exp()).matrix();
  }
  void evaluate(const double* p) const {
    for (int i = 0; i < terms_; ++i) {
      centre_[i] = into(p[2 * i], kLowestCentre, kHighestCentre);
      width_[i] = std::exp(into(p[2 * i + 1], low_width(), high_width()));
      design_.col(2 + i).head(rows_) = column(centre_[i], width_[i]);
    }
    // Modified Gram–Schmidt: the pulls keep the columns independent enough, and it is a fifth of the time of
    // Householder's form on so few columns. The first two columns never change.
    const Index n = design_.cols();
    for (Index j = kFixed; j < n; ++j) {
      thin_.col(j) = design_.col(j);
      for (Index i = 0; i < j; ++i) {
        const double along = thin_.col(i).dot(thin_.col(j));
        upper_(i, j) = along;
        thin_.col(j) -= along * thin_.col(i);
      }
      upper_(j, j) = thin_.col(j).norm();
      thin_.col(j) /= upper_(j, j);
    }
    linear_ = upper_.topLeftCorner(n, n).triangularView<Eigen::Upper>().solve(thin_.transpose() * y_);
  }
  /// The orthogonal form of the columns that stand still.
  void prepare() {
    thin_ = design_;
    upper_ = MatrixXd::Zero(design_.cols(), design_.cols());
    upper_(0, 0) = thin_.col(0).norm();
    thin_.col(0) /= upper_(0, 0);
    upper_(0, 1) = thin_.col(0).dot(thin_.col(1));
    thin_.col(1) -= upper_(0, 1) * thin_.col(0);
    upper_(1, 1) = thin_.col(1).norm();
    thin_.col(1) /= upper_(1, 1);
  }

  static constexpr Index kFixed = 2;
  int terms_;
  int pulls_ = 0;
  FitSettings settings_;
  Index rows_;
  VectorXd u_, root_, y_;
  mutable MatrixXd design_, thin_, upper_;
  mutable VectorXd linear_;
  mutable double centre_[16] = {};
  mutable double width_[16] = {};
};

VectorXd nonlinear(const std::vector<FitTerm>& terms, double narrowest) {
  VectorXd p(2 * static_cast<Index>(terms.size()));
  for (std::size_t i = 0; i < terms.size(); ++i) {
    p(2 * static_cast<Index>(i)) = out_of(terms[i].b, kLowestCentre, kHighestCentre);
    p(2 * static_cast<Index>(i) + 1) = out_of(std::log(terms[i].c), std::log(narrowest), std::log(kWidest));
  }
  return p;
}

/// F − η1·u keeps the sign of the motion, with something to spare, from rest to the end of the range.
bool opposes(const BranchFit& fit) {
  for (int i = 0; i <= 50; ++i) {
    const double u = i / 50.0;
    if (!(fit.force(u) - fit.eta1 * u > kLeastLevel * std::abs(fit.eta0 + fit.eta1))) return false;
  }
  return fit.eta1 >= 0.0 && fit.eta0 > 0.0;
}

struct Outcome {
  VectorXd p;
  double cost = 0.0;
};

Outcome descend(const Projected& problem, VectorXd p, int iterations) {
  ceres::TinySolver<Projected> solver;
  solver.options.max_num_iterations = iterations;
  // Residuals are in units of the noise: a change of 1e-4 says nothing about the parameters.
  solver.options.function_tolerance = 1e-4;
  solver.options.parameter_tolerance = 1e-7;
  solver.options.gradient_tolerance = 1e-8;
  solver.options.initial_trust_region_radius = 10.0;
  solver.Solve(problem, &p);
  return {std::move(p), solver.summary.final_cost};
}

/// From a start to a fit that opposes the motion; η1 is pulled to the straight line as firmly as it must be.
BranchFit polish(const Bins& bins, VectorXd p, FitSettings settings, int iterations) {
  const auto terms = static_cast<int>(p.size() / 2);
  for (int attempt = 0;; ++attempt) {
    const Projected problem(bins, terms, settings);
    if (terms > 0) p = descend(problem, std::move(p), iterations).p;
    BranchFit fit = problem.result(p.data());
    if (terms == 0 || attempt == kPulls || opposes(fit)) return fit;
    settings.slope_scale *= kFirmer;
  }
}

/// Van der Corput sequence: evenly spread, the same in every run.
double spread(unsigned i, unsigned base) {
  double x = 0.0;
  for (double share = 1.0 / base; i > 0; i /= base, share /= base) x += share * (i % base);
  return x;
}

constexpr int kIterations = 40;
constexpr int kFirstIterations = 6;  // before the worse starts are given up
constexpr std::size_t kSearchBins = 40;
constexpr std::size_t kFinalists = 4;

}  // namespace

Bins joined(const Bins& bins, std::size_t wanted) {
  const std::size_t group = std::max<std::size_t>(1, (bins.size() + wanted - 1) / wanted);
  Bins out;
  for (std::size_t i = 0; i < bins.size(); i += group) {
    double w = 0, u = 0, f = 0;
    for (std::size_t j = i; j < std::min(i + group, bins.size()); ++j) {
      w += bins.weight[j];
      u += bins.weight[j] * bins.u[j];
      f += bins.weight[j] * bins.force[j];
    }
    out.u.push_back(u / w);
    out.force.push_back(f / w);
    out.weight.push_back(w);
  }
  return out;
}

double BranchFit::force(double u) const noexcept {
  double sum = eta0 + eta1 * u;
  for (const FitTerm& g : terms) sum += friction::GaussianTerm<double>{g.a, g.b, g.c}.value(u);
  return sum;
}

void BranchFit::gradient(double u, double* out) const noexcept {
  *out++ = 1.0;
  *out++ = u;
  // The law itself on jets: a, b, c are the three directions.
  using Jet = ceres::Jet<double, 3>;
  for (const FitTerm& g : terms) {
    const friction::GaussianTerm<Jet> term{Jet(g.a, 0), Jet(g.b, 1), Jet(g.c, 2)};
    const auto slopes = term.value(Jet(u)).v;
    *out++ = slopes[0];
    if (!centred) *out++ = slopes[1];
    *out++ = slopes[2];
  }
}

std::optional<BranchFit> fit_centred(const Bins& bins, const FitSettings& settings) {
  if (bins.size() < 10) return std::nullopt;
  const auto n = static_cast<Index>(bins.size());
  const VectorXd root = Eigen::Map<const VectorXd>(bins.weight.data(), n).cwiseSqrt();
  const VectorXd u = Eigen::Map<const VectorXd>(bins.u.data(), n);
  const VectorXd y = Eigen::Map<const VectorXd>(bins.force.data(), n).cwiseProduct(root);
  MatrixXd design(n, 3);
  design.col(0) = root;
  design.col(1) = root.cwiseProduct(u);
  const auto fit = [&](double log_width) {
    const double c = std::exp(log_width);
    design.col(2) = root.array() * (-(u / c).array().square()).exp();
    const VectorXd x = design.colPivHouseholderQr().solve(y);
    BranchFit f;
    f.eta0 = x(0), f.eta1 = x(1);
    f.terms = {{x(2), 0.0, c}};
    f.centred = true;
    f.cost = (y - design * x).squaredNorm();
    return f;
  };
  // A width below the second bin, or one that covers the range, is a level or a straight line again.
  const double lowest = std::log(std::max(settings.narrowest, 2.0 * bins.u.front()));
  const double highest = std::log(0.7);
  if (!(lowest < highest)) return std::nullopt;
  constexpr int kCoarse = 24;
  const double step = (highest - lowest) / kCoarse;
  BranchFit best = fit(lowest);
  double at = lowest;
  for (int i = 1; i <= kCoarse; ++i) {
    BranchFit f = fit(lowest + step * i);
    if (f.cost < best.cost) best = std::move(f), at = lowest + step * i;
  }
  for (double half = 0.5 * step; half > 1e-4; half *= 0.5) {
    for (const double p : {at - half, at + half}) {
      if (p < lowest || p > highest) continue;
      BranchFit f = fit(p);
      if (f.cost < best.cost) best = std::move(f), at = p;
    }
  }
  return opposes(best) ? std::optional(best) : std::nullopt;
}

BranchFit fit_line(const Bins& bins, const FitSettings& settings) { return polish(bins, {}, settings, 1); }

std::optional<BranchFit> fit_one_more(const Bins& bins, const BranchFit& before, const FitSettings& settings,
                                      const BranchFit* also) {
  static constexpr unsigned kPrimes[] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};
  const int n = static_cast<int>(before.terms.size()) + 1;
  const auto wanted = 2 + 3 * static_cast<std::size_t>(n);
  if (bins.size() < 2 * wanted || 2 * static_cast<std::size_t>(n) > std::size(kPrimes)) return std::nullopt;
  const Bins coarse = joined(bins, kSearchBins);
  const Bins& search = coarse.size() >= wanted + 4 ? coarse : bins;
  const Projected problem(search, n, settings);
  std::vector<Outcome> tries;

  // One more term where it explains most.
  const Projected smaller(search, n - 1, settings);
  const VectorXd residual = smaller.residual(nonlinear(before.terms, settings.narrowest).data());
  struct Start {
    double gain, b, c;
  };
  std::vector<Start> starts;
  for (const double c : {0.04, 0.08, 0.16, 0.35, 0.8}) {
    const double step = std::clamp(0.7 * c, 0.05, 0.25);
    for (double b = -0.1; b < 1.2; b += step) starts.push_back({smaller.gain(b, c, residual), b, c});
  }
  std::stable_sort(starts.begin(), starts.end(),
                   [](const Start& x, const Start& y) { return x.gain > y.gain; });
  std::vector<Start> chosen;
  for (const Start& s : starts) {
    const bool close = std::any_of(chosen.begin(), chosen.end(), [&](const Start& t) {
      return std::abs(s.b - t.b) < 0.7 * std::max(s.c, t.c) && std::abs(std::log(s.c / t.c)) < 0.8;
    });
    if (!close) chosen.push_back(s);
    if (static_cast<int>(chosen.size()) == settings.polished) break;
  }
  for (const Start& s : chosen) {
    std::vector<FitTerm> terms = before.terms;
    terms.push_back({0.0, s.b, s.c});
    tries.push_back(descend(problem, nonlinear(terms, settings.narrowest), kFirstIterations));
  }
  // And anywhere: the best fit need not hold the one with a term less.
  for (int i = 0; n > 1 && i < settings.scattered; ++i) {
    std::vector<FitTerm> terms;
    for (int k = 0; k < n; ++k) {
      const double x = spread(static_cast<unsigned>(i) + settings.first_start, kPrimes[2 * k]);
      const double y = spread(static_cast<unsigned>(i) + settings.first_start, kPrimes[2 * k + 1]);
      // One centre in each part of the range and a little beyond, so that no two starts are the same up to
      // order.
      terms.push_back({0.0, -0.05 + 1.35 * (k + x) / n, 0.08 * std::pow(8.0, y)});
    }
    tries.push_back(descend(problem, nonlinear(terms, settings.narrowest), kFirstIterations));
  }
  if (also != nullptr)
    tries.push_back(descend(problem, nonlinear(also->terms, settings.narrowest), kFirstIterations));
  const auto cheaper = [](const Outcome& x, const Outcome& y) { return x.cost < y.cost; };
  std::stable_sort(tries.begin(), tries.end(), cheaper);
  if (tries.size() > kFinalists) tries.resize(kFinalists);
  for (Outcome& t : tries) t = descend(problem, std::move(t.p), kIterations);
  std::stable_sort(tries.begin(), tries.end(), cheaper);
  BranchFit best;
  for (std::size_t i = 0; i < tries.size(); ++i) {
    BranchFit fit = polish(bins, tries[i].p, settings, kIterations);
    const bool first = i == 0 || fit.cost < best.cost;
    if (first) best = std::move(fit);
    // The best of all starts was not in the way of the constraint: the others are only worse.
    if (i == 0 && 2.0 * tries[0].cost * settings.noise * settings.noise > 0.9 * best.cost) break;
  }
  return best;
}

std::vector<BranchFit> fit_ladder(const Bins& bins, int most, const FitSettings& settings) {
  std::vector<BranchFit> ladder{fit_line(bins, settings)};
  while (static_cast<int>(ladder.size()) <= most) {
    std::optional<BranchFit> next = fit_one_more(bins, ladder.back(), settings);
    if (!next) break;
    ladder.push_back(std::move(*next));
  }
  return ladder;
}

}  // namespace stribeck::ident
