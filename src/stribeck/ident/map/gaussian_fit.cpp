#include <ceres/jet.h>
#include <ceres/tiny_solver.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <stribeck/friction/gaussian.hpp>
#include <stribeck/ident/map/gaussian_fit.hpp>

namespace stribeck::ident::map {
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

constexpr int kMostTerms = 6;

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

  [[nodiscard]] int residuals() const { return static_cast<int>(rows_) + pulls_; }

  [[nodiscard]] int parameters() const { return 2 * terms_; }

  [[nodiscard]] double low_width() const { return std::log(settings_.narrowest); }
  [[nodiscard]] static double high_width() { return std::log(kWidest); }

  bool operator()(const double* p, double* residuals, double* jacobian) const {
    evaluate(p);
    Eigen::Map<VectorXd>(residuals, residual_.size()) = residual_;
    if (jacobian == nullptr) return true;
    Eigen::Map<MatrixXd> j(jacobian, residual_.size(), 2 * terms_);
    for (int i = 0; i < terms_; ++i) {
      const double c = width_[i];
      auto by_centre = j.col(2 * i), by_width = j.col(2 * i + 1);
      by_centre.tail(pulls_).setZero();
      by_width.tail(pulls_).setZero();
      const double by = -2.0 * linear_(2 + i) / c * slope(p[2 * i], kLowestCentre, kHighestCentre);
      by_centre.head(rows_).array() =
          by / c * design_.col(2 + i).head(rows_).array() * (u_.array() - centre_[i]);
      // c = exp(q): ∂c/∂q = c.
      const double ratio =
          slope(p[2 * i + 1], low_width(), high_width()) / slope(p[2 * i], kLowestCentre, kHighestCentre);
      by_width.head(rows_).array() = ratio * by_centre.head(rows_).array() * (u_.array() - centre_[i]);
      // Column by column: the general product packs its operands, which costs more than so few columns are.
      for (Index k = 0; k < thin_.cols(); ++k) {
        by_centre -= thin_.col(k).dot(by_centre) * thin_.col(k);
        by_width -= thin_.col(k).dot(by_width) * thin_.col(k);
      }
    }
    return true;
  }

  [[nodiscard]] BranchFit result(const double* p) const {
    evaluate(p);
    BranchFit fit;
    fit.eta0 = linear_(0);
    fit.eta1 = linear_(1);
    for (int i = 0; i < terms_; ++i) fit.terms.push_back({linear_(2 + i), centre_[i], width_[i]});
    fit.cost = residual_.head(rows_).squaredNorm() * settings_.noise * settings_.noise;
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
  [[nodiscard]] const VectorXd& residual(const double* p) const {
    evaluate(p);
    return residual_;
  }

 private:
  [[nodiscard]] VectorXd column(double centre, double width) const {
    return (root_.array() * (-((u_.array() - centre) / width).square()).exp()).matrix();
  }
  void evaluate(const double* p) const {
    // The solver asks for the derivatives where it has just asked for the residuals.
    if (fresh_ && std::equal(p, p + 2 * terms_, at_)) return;
    fresh_ = true;
    std::copy(p, p + 2 * terms_, at_);
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
    residual_ = y_;
    for (Index j = 0; j < n; ++j) {
      linear_(j) = thin_.col(j).dot(residual_);
      residual_ -= linear_(j) * thin_.col(j);
    }
    for (Index j = n - 1; j >= 0; --j) {
      linear_(j) /= upper_(j, j);
      for (Index i = 0; i < j; ++i) linear_(i) -= upper_(i, j) * linear_(j);
    }
  }
  /// The orthogonal form of the columns that stand still.
  void prepare() {
    linear_.resize(design_.cols());
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
  mutable VectorXd linear_, residual_;
  mutable bool fresh_ = false;
  mutable double at_[2 * kMostTerms] = {};
  mutable double centre_[kMostTerms] = {};
  mutable double width_[kMostTerms] = {};
};

/// As the solver wants it. Were the number of parameters known to the compiler, it would be 4 % faster, and 40 s of compiling.
struct Problem {
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };
  const Projected& projected;
  [[nodiscard]] int NumResiduals() const { return projected.residuals(); }
  [[nodiscard]] int NumParameters() const { return projected.parameters(); }
  bool operator()(const double* p, double* residuals, double* jacobian) const {
    return projected(p, residuals, jacobian);
  }
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

constexpr int kIterations = 40;
/// Residuals are in units of the noise: such a change of the cost says nothing about the parameters.
constexpr double kTolerance = 1e-4;

struct Outcome {
  VectorXd p;
  double cost = 0.0;
};

Outcome descend(const Projected& problem, VectorXd p, int iterations, double tolerance = kTolerance) {
  if (p.size() == 0) return {p, 0.5 * problem.residual(p.data()).squaredNorm()};
  ceres::TinySolver<Problem> solver;
  solver.options.max_num_iterations = iterations;
  solver.options.function_tolerance = tolerance;
  solver.options.parameter_tolerance = 1e-7;
  solver.options.gradient_tolerance = 1e-8;
  solver.options.initial_trust_region_radius = 10.0;
  solver.Solve({problem}, &p);
  return {std::move(p), solver.summary.final_cost};
}

struct Polished {
  BranchFit fit;
  VectorXd p;
  int firmed = 0;  // how often the pull was made firmer
};

FitSettings firmed(FitSettings settings, int times) {
  settings.slope_scale *= std::pow(kFirmer, times);
  return settings;
}

/// From a start to a fit that opposes the motion; η1 is pulled to the straight line as firmly as it must be.
Polished polish(const Bins& bins, VectorXd p, const FitSettings& settings, double tolerance, int times = 0) {
  const auto terms = static_cast<int>(p.size() / 2);
  for (;; ++times) {
    const Projected problem(bins, terms, firmed(settings, times));
    if (terms > 0) p = descend(problem, std::move(p), kIterations, tolerance).p;
    BranchFit fit = problem.result(p.data());
    if (terms == 0 || times == kPulls || opposes(fit)) return {std::move(fit), std::move(p), times};
  }
}

/// Van der Corput sequence: evenly spread, the same in every run.
double spread(unsigned i, unsigned base) {
  double x = 0.0;
  for (double share = 1.0 / base; i > 0; i /= base, share /= base) x += share * (i % base);
  return x;
}

// Starts are given up in two steps.
constexpr int kFirstIterations = 3, kSecondIterations = 6;
constexpr std::size_t kSecond = 32, kFinalists = 12;
constexpr std::size_t kSearchBins = 40;
constexpr double kSearchTolerance = 1e-2;
constexpr double kSame = 1e-3;  // of the cost: starts that have reached one minimum
constexpr std::size_t kExchanged = 4;
constexpr double kExchangeGain = 0.01;  // of the cost: less is no other minimum

struct Place {
  double gain, b, c;
};

/// Where a further term explains most of what the others leave, the best few that differ.
std::vector<Place> best_places(const Projected& others, const VectorXd& p, int wanted) {
  const VectorXd residual = others.residual(p.data());
  std::vector<Place> all;
  for (const double c : {0.04, 0.08, 0.16, 0.35, 0.8}) {
    const double step = std::clamp(0.7 * c, 0.05, 0.25);
    for (double b = -0.1; b < 1.2; b += step) all.push_back({others.gain(b, c, residual), b, c});
  }
  std::stable_sort(all.begin(), all.end(), [](const Place& x, const Place& y) { return x.gain > y.gain; });
  std::vector<Place> chosen;
  for (const Place& s : all) {
    const bool close = std::any_of(chosen.begin(), chosen.end(), [&](const Place& t) {
      return std::abs(s.b - t.b) < 0.7 * std::max(s.c, t.c) && std::abs(std::log(s.c / t.c)) < 0.8;
    });
    if (!close) chosen.push_back(s);
    if (static_cast<int>(chosen.size()) == wanted) break;
  }
  return chosen;
}

/// The terms and one more, at each of the places where it explains most.
std::vector<std::vector<FitTerm>> with_one_more(const Bins& bins, const std::vector<FitTerm>& terms,
                                                const FitSettings& settings, int places) {
  const Projected rest(bins, static_cast<int>(terms.size()), settings);
  std::vector<std::vector<FitTerm>> out;
  for (const Place& s : best_places(rest, nonlinear(terms, settings.narrowest), places)) {
    out.push_back(terms);
    out.back().push_back({0.0, s.b, s.c});
  }
  return out;
}

std::vector<FitTerm> without(std::vector<FitTerm> terms, std::size_t i) {
  terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(i));
  return terms;
}

/// Two terms of which little more than the difference is left.
bool cancel(const FitTerm& x, const FitTerm& y) {
  return x.a * y.a < 0.0 && std::abs(x.a + y.a) < 0.5 * std::max(std::abs(x.a), std::abs(y.a));
}

/// A high level with dips is nearly the same curve as a low one with bells between them: another minimum, and no
/// term is where it was. Empty where there is no dip.
std::vector<FitTerm> bells_for_dips(const Bins& bins, const std::vector<FitTerm>& terms,
                                    const FitSettings& settings) {
  std::vector<double> edges{0.0};
  for (const FitTerm& g : terms) {
    if (g.a < 0.0 && g.b > 0.0 && g.b < 1.0) edges.push_back(g.b);
  }
  if (edges.size() == 1) return {};
  std::sort(edges.begin(), edges.end());
  // The last bell is as wide as the one before it.
  edges.push_back(2.0 * edges.back() - edges[edges.size() - 2]);
  std::vector<FitTerm> out;
  for (std::size_t i = 0; i + 1 < edges.size() && out.size() < terms.size(); ++i) {
    const double gap = edges[i + 1] - edges[i];
    out.push_back({0.0, 0.5 * (edges[i] + edges[i + 1]), std::max(0.5 * gap, 0.05)});
  }
  while (out.size() < terms.size()) out = with_one_more(bins, out, settings, 1).front();
  return out;
}

/// Starts from which another minimum may be reached: a term is set anew, or both of a pair that nearly cancels (it is
/// the slope of one bell, and neither can leave it alone), or dips become bells.
std::vector<std::vector<FitTerm>> neighbours(const Bins& bins, const std::vector<FitTerm>& terms,
                                             const FitSettings& settings) {
  std::vector<std::vector<FitTerm>> out;
  const auto join = [&](std::vector<std::vector<FitTerm>> more) {
    std::move(more.begin(), more.end(), std::back_inserter(out));
  };
  for (std::size_t i = 0; i < terms.size(); ++i) {
    join(with_one_more(bins, without(terms, i), settings, settings.polished));
    for (std::size_t j = 0; j < i; ++j) {
      if (!cancel(terms[i], terms[j])) continue;
      const auto others = without(without(terms, i), j);
      for (const auto& one : with_one_more(bins, others, settings, settings.polished))
        join(with_one_more(bins, one, settings, 1));
    }
  }
  if (auto bells = bells_for_dips(bins, terms, settings); !bells.empty()) out.push_back(std::move(bells));
  return out;
}

/// Least cost first, each minimum once: the rest of the search is for others.
void sort(std::vector<Outcome>& tries) {
  std::stable_sort(tries.begin(), tries.end(),
                   [](const Outcome& x, const Outcome& y) { return x.cost < y.cost; });
  tries.erase(
      std::unique(tries.begin(), tries.end(),
                  [](const Outcome& x, const Outcome& y) { return y.cost - x.cost < kSame * x.cost; }),
      tries.end());
}

/// From minimum to lower minimum over the neighbours.
Polished exchanged(const Bins& bins, Polished best, const FitSettings& settings) {
  const double unit = settings.noise * settings.noise;
  for (bool better = true; better;) {
    better = false;
    const FitSettings same = firmed(settings, best.firmed);
    const Projected all(bins, static_cast<int>(best.fit.terms.size()), same);
    std::vector<Outcome> tries;
    for (const std::vector<FitTerm>& terms : neighbours(bins, best.fit.terms, same)) {
      tries.push_back(descend(all, nonlinear(terms, settings.narrowest), kIterations, kSearchTolerance));
    }
    sort(tries);
    const double goal = (1.0 - kExchangeGain) * best.fit.cost;
    for (std::size_t i = 0; i < std::min(kExchanged, tries.size()); ++i) {
      if (2.0 * tries[i].cost * unit > goal) break;
      Polished trial = polish(bins, std::move(tries[i].p), settings, kSearchTolerance);
      if (trial.fit.cost < std::min(goal, best.fit.cost)) best = std::move(trial), better = true;
    }
  }
  return best;
}

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

BranchFit fit_line(const Bins& bins, const FitSettings& settings) {
  return polish(bins, {}, settings, kTolerance).fit;
}

std::optional<BranchFit> fit_one_more(const Bins& bins, const BranchFit& before, const FitSettings& settings,
                                      const BranchFit* also) {
  static constexpr unsigned kPrimes[] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};
  const int n = static_cast<int>(before.terms.size()) + 1;
  const auto wanted = 2 + 3 * static_cast<std::size_t>(n);
  if (bins.size() < 2 * wanted || n > kMostTerms) return std::nullopt;
  const Bins coarse = joined(bins, kSearchBins);
  const Bins& search = coarse.size() >= wanted + 4 ? coarse : bins;
  const Projected problem(search, n, settings);
  std::vector<Outcome> tries;
  const auto start = [&](const std::vector<FitTerm>& terms) {
    tries.push_back(
        descend(problem, nonlinear(terms, settings.narrowest), kFirstIterations, kSearchTolerance));
  };
  // One more term where it explains most.
  for (const std::vector<FitTerm>& terms : with_one_more(search, before.terms, settings, settings.polished))
    start(terms);
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
    start(terms);
  }
  if (also != nullptr) start(also->terms);

  const auto go_on = [&](std::size_t most, int iterations) {
    sort(tries);
    if (tries.size() > most) tries.resize(most);
    for (Outcome& t : tries) t = descend(problem, std::move(t.p), iterations, kSearchTolerance);
  };
  if (tries.size() > kSecond) go_on(kSecond, kSecondIterations);
  go_on(kFinalists, kIterations);
  sort(tries);
  const double unit = settings.noise * settings.noise;
  Polished best;
  for (std::size_t i = 0; i < tries.size(); ++i) {
    // The constraint can only cost.
    if (i > 0 && 2.0 * tries[i].cost * unit > 0.999 * best.fit.cost) break;
    Polished trial = polish(search, tries[i].p, settings, kSearchTolerance);
    if (i == 0 || trial.fit.cost < best.fit.cost) best = std::move(trial);
  }
  if (n > 1 && settings.exchange) best = exchanged(search, std::move(best), settings);
  return polish(bins, best.p, settings, kTolerance, best.firmed).fit;
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

}  // namespace stribeck::ident::map
