#include <ceres/jet.h>
#include <ceres/tiny_solver.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <stribeck/friction/gaussian.hpp>
#include <stribeck/ident/map/gaussian_fit.hpp>
#include <stribeck/ident/map/gaussian_projected.hpp>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::map {
namespace {

/// The level may fall to this share of η0 + η1.
constexpr double kLeastLevel = 0.05;
constexpr double kFirmer = 0.2;
constexpr int kPulls = 6;

/// Form that the solver needs. With a number of parameters known at compile time it would be 4 % faster and take 40 s more to compile.
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

VectorXd nonlinear(const std::vector<FitTerm>& terms, const FitSettings& settings) {
  VectorXd p(2 * static_cast<Index>(terms.size()));
  for (std::size_t i = 0; i < terms.size(); ++i) {
    p(2 * static_cast<Index>(i)) = out_of(terms[i].b, settings.lowest_centre, kHighestCentre);
    p(2 * static_cast<Index>(i) + 1) =
        out_of(std::log(terms[i].c), std::log(settings.narrowest), std::log(kWidest));
  }
  return p;
}

/// Whether F − η1·u keeps the sign of the motion with a margin, from rest to the end of the range.
bool opposes(const BranchFit& fit) {
  for (int i = 0; i <= 50; ++i) {
    const double u = i / 50.0;
    if (!(fit.force(u) - fit.eta1 * u > kLeastLevel * std::abs(fit.eta0 + fit.eta1))) return false;
  }
  return fit.eta1 >= 0.0 && fit.eta0 > 0.0;
}

/// Neither F nor a term is larger than the data carry.
bool bounded(const BranchFit& fit, const FitSettings& settings) {
  const auto good = [&](double u) {
    return fit.force(u) <= settings.most_force &&
           std::all_of(fit.terms.begin(), fit.terms.end(), [&](const FitTerm& g) {
             return std::abs(friction::GaussianTerm<double>{g.a, g.b, g.c}.value(u)) <= settings.most_height;
           });
  };
  for (int i = 0; i <= 50; ++i) {
    if (!good(i / 50.0)) return false;
  }
  // A narrow term stands between two of these places.
  return std::all_of(fit.terms.begin(), fit.terms.end(),
                     [&](const FitTerm& g) { return !(g.b > 0.0 && g.b < 1.0) || good(g.b); });
}

bool physical(const BranchFit& fit, const FitSettings& settings) {
  return opposes(fit) && bounded(fit, settings);
}

constexpr int kIterations = 40;
/// Residuals are in units of the noise: a change of the cost by less than this says nothing about the parameters.
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

/// How often the pulls were made firmer.
struct Firmness {
  int line = 0;
  int heights = 0;
};

struct Polished {
  BranchFit fit;
  VectorXd p;
  Firmness firmed;
};

FitSettings firmed(FitSettings settings, const Firmness& times) {
  settings.slope_scale *= std::pow(kFirmer, times.line);
  settings.height_scale *= std::pow(kFirmer, times.heights);
  return settings;
}

/// From a start to a physical fit; η1 is pulled to the straight line and the heights to zero as firmly as they must be.
Polished polish(const Bins& bins, VectorXd p, const FitSettings& settings, double tolerance,
                Firmness times = {}) {
  const auto terms = static_cast<int>(p.size() / 2);
  for (;;) {
    const Projected problem(bins, terms, firmed(settings, times));
    if (terms > 0) p = descend(problem, std::move(p), kIterations, tolerance).p;
    BranchFit fit = problem.result(p.data());
    const bool with_motion = !opposes(fit) && times.line < kPulls;
    const bool too_high = !bounded(fit, settings) && times.heights < kPulls;
    if (terms == 0 || (!with_motion && !too_high)) return {std::move(fit), std::move(p), times};
    times.line += with_motion ? 1 : 0;
    times.heights += too_high ? 1 : 0;
  }
}

/// Van der Corput sequence: evenly spread and the same in every run.
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
constexpr double kSame = 1e-3;  // share of the cost: starts within it have reached the same minimum
constexpr std::size_t kExchanged = 4;
constexpr double kExchangeGain = 0.01;  // share of the cost: with a smaller gain it is the same minimum

struct Place {
  double gain, b, c;
};

/// Places where a further term explains most of the residual; the best few that differ.
std::vector<Place> best_places(const Projected& others, const VectorXd& p, int wanted) {
  const VectorXd residual = others.residual(p.data());
  std::vector<Place> all;
  for (const double c : {0.04, 0.08, 0.16, 0.35, 0.8}) {
    const double step = std::clamp(0.7 * c, 0.05, 0.25);
    for (double b = std::max(-0.1, others.low_centre()); b < 1.2; b += step)
      all.push_back({others.gain(b, c, residual), b, c});
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

/// The terms with one more at each of the places where it explains most.
std::vector<std::vector<FitTerm>> with_one_more(const Bins& bins, const std::vector<FitTerm>& terms,
                                                const FitSettings& settings, int places) {
  const Projected rest(bins, static_cast<int>(terms.size()), settings);
  std::vector<std::vector<FitTerm>> out;
  for (const Place& s : best_places(rest, nonlinear(terms, settings), places)) {
    out.push_back(terms);
    out.back().push_back({0.0, s.b, s.c});
  }
  return out;
}

std::vector<FitTerm> without(std::vector<FitTerm> terms, std::size_t i) {
  terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(i));
  return terms;
}

/// Two terms that nearly cancel each other.
bool cancel(const FitTerm& x, const FitTerm& y) {
  return x.a * y.a < 0.0 && std::abs(x.a + y.a) < 0.5 * std::max(std::abs(x.a), std::abs(y.a));
}

/// A high level with dips is nearly the same curve as a low level with bells between them. It is another minimum, in which every
/// term has another place. Empty where there is no dip.
std::vector<FitTerm> bells_for_dips(const Bins& bins, const std::vector<FitTerm>& terms,
                                    const FitSettings& settings) {
  std::vector<double> edges{0.0};
  for (const FitTerm& g : terms) {
    if (g.a < 0.0 && g.b > 0.0 && g.b < 1.0) edges.push_back(g.b);
  }
  if (edges.size() == 1) return {};
  std::sort(edges.begin(), edges.end());
  // The last bell has the width of the one before it.
  edges.push_back(2.0 * edges.back() - edges[edges.size() - 2]);
  std::vector<FitTerm> out;
  for (std::size_t i = 0; i + 1 < edges.size() && out.size() < terms.size(); ++i) {
    const double gap = edges[i + 1] - edges[i];
    out.push_back({0.0, 0.5 * (edges[i] + edges[i + 1]), std::max(0.5 * gap, 0.05)});
  }
  while (out.size() < terms.size()) out = with_one_more(bins, out, settings, 1).front();
  return out;
}

/// Starts from which another minimum may be reached: a term is placed anew; or both terms of a pair that nearly cancels (together
/// they are the slope of one bell, and neither can leave it alone); or dips become bells.
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

/// In the order of cost, each minimum once, because the rest of the search is for other minima.
void sort(std::vector<Outcome>& tries) {
  std::stable_sort(tries.begin(), tries.end(),
                   [](const Outcome& x, const Outcome& y) { return x.cost < y.cost; });
  tries.erase(
      std::unique(tries.begin(), tries.end(),
                  [](const Outcome& x, const Outcome& y) { return y.cost - x.cost < kSame * x.cost; }),
      tries.end());
}

/// Goes from minimum to lower minimum over the neighbours.
Polished exchanged(const Bins& bins, Polished best, const FitSettings& settings) {
  const double unit = settings.noise * settings.noise;
  for (bool better = true; better;) {
    better = false;
    const FitSettings same = firmed(settings, best.firmed);
    const Projected all(bins, static_cast<int>(best.fit.terms.size()), same);
    std::vector<Outcome> tries;
    for (const std::vector<FitTerm>& terms : neighbours(bins, best.fit.terms, same)) {
      tries.push_back(descend(all, nonlinear(terms, settings), kIterations, kSearchTolerance));
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
  if (exponential) return sum + terms.front().a * std::exp(-u / terms.front().c);
  for (const FitTerm& g : terms) sum += friction::GaussianTerm<double>{g.a, g.b, g.c}.value(u);
  return sum;
}

void BranchFit::gradient(double u, double* out) const noexcept {
  *out++ = 1.0;
  *out++ = u;
  if (exponential) {
    const FitTerm& g = terms.front();
    const double e = std::exp(-u / g.c);
    *out++ = e;
    *out = g.a * e * u / (g.c * g.c);
    return;
  }
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

std::vector<double> stribeck_widths(double slowest, double fastest) {
  // A narrower part is a level, a wider one is a straight line.
  constexpr double kNarrowestPart = 1.5, kWidestPart = 0.7, kRatio = 1.35;
  const double low = kNarrowestPart * slowest, high = kWidestPart * fastest;
  if (!(low > 0.0 && low < high)) return {};
  const int steps = std::max(1, static_cast<int>(std::ceil(std::log(high / low) / std::log(kRatio))));
  std::vector<double> out;
  for (int i = 0; i <= steps; ++i) out.push_back(low * std::pow(high / low, static_cast<double>(i) / steps));
  return out;
}

std::vector<FitTerm> as_gaussians(const FitTerm& exponential) {
  // Heights and widths of the smallest largest error for four terms.
  static constexpr std::array<FitTerm, 4> kUnit{
      {{0.0653, 0.0, 0.0455}, {0.2181, 0.0, 0.2793}, {0.4460, 0.0, 0.9373}, {0.2706, 0.0, 2.3731}}};
  std::vector<FitTerm> out;
  for (const FitTerm& g : kUnit) out.push_back({exponential.a * g.a, 0.0, exponential.c * g.c});
  return out;
}

std::optional<BranchFit> fit_centred(const Bins& bins, const FitSettings& settings, Exponent exponent) {
  if (bins.size() < 10) return std::nullopt;
  const auto n = static_cast<Index>(bins.size());
  const VectorXd root = Eigen::Map<const VectorXd>(bins.weight.data(), n).cwiseSqrt();
  const VectorXd u = Eigen::Map<const VectorXd>(bins.u.data(), n);
  const VectorXd y = Eigen::Map<const VectorXd>(bins.force.data(), n).cwiseProduct(root);
  MatrixXd design(n, 3);
  design.col(0) = root;
  design.col(1) = root.cwiseProduct(u);
  const bool exponential = exponent == Exponent::kOne;
  const auto fit = [&](double c) {
    const Eigen::ArrayXd ratio = u.array() / c;
    if (exponential) {
      design.col(2) = root.array() * (-ratio).exp();
    } else {
      design.col(2) = root.array() * (-ratio.square()).exp();
    }
    const VectorXd x = stats::least_squares(design, y).x;
    BranchFit f;
    f.eta0 = x(0), f.eta1 = x(1);
    f.terms = {{x(2), 0.0, c}};
    f.centred = true;
    f.exponential = exponential;
    f.cost = (y - design * x).squaredNorm();
    return f;
  };
  const std::vector<double> widths = stribeck_widths(bins.u.front(), 1.0);
  if (widths.empty()) return std::nullopt;
  BranchFit best = fit(widths.front());
  const auto take_better = [&](double c) {
    if (c < widths.front() || c > widths.back()) return;
    BranchFit f = fit(c);
    if (f.cost < best.cost) best = std::move(f);
  };
  for (const double c : widths) take_better(c);
  const double step = widths[1] / widths[0];
  for (double half = std::sqrt(step); half > 1.0001; half = std::sqrt(half)) {
    const double at = best.terms.front().c;
    take_better(at / half);
    take_better(at * half);
  }
  return physical(best, settings) ? std::optional(best) : std::nullopt;
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
    tries.push_back(descend(problem, nonlinear(terms, settings), kFirstIterations, kSearchTolerance));
  };
  // One more term at the place where it explains most.
  for (const std::vector<FitTerm>& terms : with_one_more(search, before.terms, settings, settings.polished))
    start(terms);
  // And anywhere else: the best fit need not contain the one with a term less.
  for (int i = 0; n > 1 && i < settings.scattered; ++i) {
    std::vector<FitTerm> terms;
    for (int k = 0; k < n; ++k) {
      const double x = spread(static_cast<unsigned>(i) + settings.first_start, kPrimes[2 * k]);
      const double y = spread(static_cast<unsigned>(i) + settings.first_start, kPrimes[2 * k + 1]);
      // One centre in each part of the range and a little beyond, so that no two starts are equal up to their
      // order.
      terms.push_back({0.0, -0.05 + 1.35 * (k + x) / n, 0.08 * std::pow(8.0, y)});
    }
    start(terms);
  }
  // A fold whose last term was not physical has one term less than the fit of all.
  if (also != nullptr && also->terms.size() == static_cast<std::size_t>(n)) start(also->terms);

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
    // The constraint can only increase the cost.
    if (i > 0 && 2.0 * tries[i].cost * unit > 0.999 * best.fit.cost) break;
    Polished trial = polish(search, tries[i].p, settings, kSearchTolerance);
    if (i == 0 || trial.fit.cost < best.fit.cost) best = std::move(trial);
  }
  if (n > 1 && settings.exchange) best = exchanged(search, std::move(best), settings);
  BranchFit fit = polish(bins, best.p, settings, kTolerance, best.firmed).fit;
  if (!physical(fit, settings)) return std::nullopt;
  return fit;
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
