#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/methods/jog/jog_parts.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::methods::jog {

namespace {

constexpr std::size_t kFewestFolds = 6;  // with fewer, nothing can be chosen by leaving out
constexpr double kMisses = 2.5;          // misfit up to which the curve describes the means

/// Mean square of the residual of a fit, in standard errors of the means; 1 for a true model.
double misfit(const Fit& fit, const std::vector<Point>& points) {
  // No mean counts as more exact than a typical one, because the subtracted periodic term has errors too.
  const double typical = typical_error(points);
  if (!(typical > 0.0)) return 0.0;
  double sum = 0.0;
  for (const Point& p : points) sum += std::pow((p.f - fit(p.v)) / std::max(p.error, typical), 2.0);
  return sum / std::max(1.0, static_cast<double>(points.size()) - static_cast<double>(fit.parameters()));
}

std::vector<Kind> candidates(const JogOptions& options, bool both) {
  std::vector<Kind> kinds;
  if (options.terms) {
    kinds.push_back(*options.terms == 0 ? Kind{Family::kLines, 0} : Kind{Family::kGaussians, *options.terms});
  } else {
    kinds = {{Family::kLine, 0}, {Family::kStribeck, 0}, {Family::kFreeStribeck, 0}};
    if (both) {
      for (const Family f : {Family::kLines, Family::kCommonStribeck, Family::kOwnStribeck})
        kinds.push_back({f, 0});
      for (int n = 1; options.gaussians && n <= kMostGaussians; ++n) kinds.push_back({Family::kGaussians, n});
    }
  }
  return kinds;
}

struct Tried {
  Fit fit;
  std::vector<double> loss;  ///< mean square of each fold; empty: too few speeds to leave one out
  double mean = 0.0;
};

/// Mean square of each of the first `judged` folds when the others are fitted; empty where a fold cannot be left out.
std::vector<double> held_out(const Kind& kind, const std::vector<Point>& points, std::size_t judged,
                             const Fitter& fitter, std::vector<Ladders>& ladders) {
  std::vector<double> loss;
  for (std::size_t k = 0; k < judged; ++k) {
    std::vector<Point> rest;
    for (const Point& p : points) {
      if (p.fold != k) rest.push_back(p);
    }
    const auto part = fitter.fit(kind, rest, ladders[k]);
    if (!part) return {};
    double square = 0.0, n = 0.0;
    for (const Point& p : points) {
      if (p.fold == k) square += std::pow(p.f - (*part)(p.v), 2.0), n += 1.0;
    }
    loss.push_back(square / n);
  }
  return loss;
}

/// All candidates that the points determine, judged on the speeds that were left out.
std::vector<Tried> try_all(const std::vector<Kind>& kinds, const std::vector<Point>& points,
                           std::size_t folds, const Fitter& fitter, double low, double high) {
  // The fastest speed is never left out: beyond the others a curve is not determined, and rich candidates would be penalised.
  const std::size_t judged = folds - 1;
  std::vector<Tried> tried;
  std::vector<Ladders> ladders(folds + 1);  // for each fold left out, and last for all points
  for (const Kind& kind : kinds) {
    const auto whole = fitter.fit(kind, points, ladders.back());
    if (!whole || !opposes(*whole, low, high)) continue;
    Tried t;
    t.fit = *whole;
    if (folds >= kFewestFolds) t.loss = held_out(kind, points, judged, fitter, ladders);
    // Too few speeds to leave one out: only the simplest candidate remains.
    if (t.loss.empty() && !tried.empty()) continue;
    for (const double l : t.loss) t.mean += l / static_cast<double>(t.loss.size());
    tried.push_back(std::move(t));
  }
  return tried;
}

/// Standard error of the difference in mean square from the best.
double error_of_difference(const Tried& t, const Tried& best) {
  if (t.loss.empty() || best.loss.empty()) return 0.0;
  const auto n = static_cast<double>(t.loss.size());
  const double difference = t.mean - best.mean;
  double square = 0.0;
  for (std::size_t k = 0; k < t.loss.size(); ++k) {
    square += std::pow(t.loss[k] - best.loss[k] - difference, 2.0);
  }
  return std::sqrt(square / (n * (n - 1.0)));
}

/// Of the candidates that predict as well as the best one, the simplest that does not clearly miss means with small
/// errors.
std::size_t simplest(const std::vector<Tried>& tried, const std::vector<double>& error, std::size_t best,
                     const std::vector<Point>& points) {
  std::vector<std::size_t> equal;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tried.size(); ++i) {
    const bool compared = !tried[i].loss.empty() && !tried[best].loss.empty();
    if (!compared && i != best) continue;
    if (compared && tried[i].mean - tried[best].mean > error[i]) continue;
    equal.push_back(i);
    least = std::min(least, misfit(tried[i].fit, points));
  }
  std::size_t chosen = best;
  bool found = false;
  for (const std::size_t i : equal) {
    if (misfit(tried[i].fit, points) > std::max(kMisses, 2.0 * least)) continue;
    if (!found || tried[i].fit.parameters() < tried[chosen].fit.parameters()) chosen = i;
    found = true;
  }
  return chosen;
}

}  // namespace

double typical_error(const std::vector<Point>& points) {
  std::vector<double> errors;
  for (const Point& p : points) errors.push_back(p.error);
  return stats::median(std::move(errors));
}

Chosen choose(const std::vector<Point>& points, std::size_t folds, const Fitter& fitter,
              const JogOptions& options, bool both, double low, double high) {
  const std::vector<Tried> tried = try_all(candidates(options, both), points, folds, fitter, low, high);
  if (tried.empty()) {
    throw Refused(
        fmt::format("jog: {} mean forces at {} speeds do not give a friction that opposes the motion{}",
                    points.size(), folds, options.terms ? "; fewer Gaussians need fewer speeds" : ""));
  }
  Chosen out;
  std::size_t best = 0;
  for (std::size_t i = 1; i < tried.size(); ++i) {
    if (!tried[i].loss.empty() && (tried[best].loss.empty() || tried[i].mean < tried[best].mean)) best = i;
  }
  std::vector<double> error;
  for (const Tried& t : tried) error.push_back(error_of_difference(t, tried[best]));
  const std::size_t chosen = simplest(tried, error, best, points);
  for (std::size_t i = 0; i < tried.size(); ++i) {
    Candidate c;
    c.name = name_of(tried[i].fit.kind);
    c.terms = tried[i].fit.kind.terms;
    c.parameters = static_cast<int>(tried[i].fit.parameters());
    c.held_out_rms = tried[i].loss.empty() ? kNaN : std::sqrt(tried[i].mean);
    c.standard_error = c.held_out_rms > 0.0 ? error[i] / (2.0 * c.held_out_rms) : 0.0;
    c.chosen = i == chosen;
    out.candidates.push_back(std::move(c));
  }
  out.fit = tried[chosen].fit;
  out.chosen_by_leaving_out = !tried[chosen].loss.empty();
  if (out.chosen_by_leaving_out) out.held_out = std::sqrt(tried[chosen].mean);
  return out;
}

}  // namespace stribeck::ident::methods::jog
