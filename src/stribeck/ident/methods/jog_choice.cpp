#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/ident/methods/jog_parts.hpp>
#include <stribeck/ident/refused.hpp>
#include <utility>

namespace stribeck::ident::methods::jog {

namespace {

constexpr std::size_t kFewestFolds = 6;  // below it nothing can be chosen by leaving out
constexpr double kMisses = 2.5;          // misfit up to which nothing is missing

/// Mean square of what a fit leaves, in standard errors of the means; 1 for a true model.
double misfit(const Fit& fit, const std::vector<Point>& points) {
  // No mean is trusted beyond a typical one: what was taken off for the screw has errors too.
  const double typical = typical_error(points);
  if (!(typical > 0.0)) return 0.0;
  double sum = 0.0;
  for (const Point& p : points) sum += std::pow((p.f - fit(p.v)) / std::max(p.error, typical), 2.0);
  return sum / std::max(1.0, static_cast<double>(points.size()) - static_cast<double>(fit.parameters()));
}

}  // namespace

double typical_error(const std::vector<Point>& points) {
  std::vector<double> errors;
  for (const Point& p : points) errors.push_back(p.error);
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

Chosen choose(const std::vector<Point>& points, std::size_t folds, const Fitter& fitter,
              const JogOptions& options, bool both, double low, double high) {
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
  struct Tried {
    Fit fit;
    std::vector<double> loss;  // mean square of each fold
    double mean = 0.0;
  };
  // The fastest speed is not left out: beyond the others a curve is not determined, and rich ones would pay for it.
  const std::size_t judged = folds - 1;
  std::vector<Tried> tried;
  std::vector<Ladders> ladders(folds + 1);  // of each fold left out, the last of all points
  for (const Kind& kind : kinds) {
    const auto whole = fitter.fit(kind, points, ladders.back());
    if (!whole || !opposes(*whole, low, high)) continue;
    Tried t;
    t.fit = *whole;
    bool complete = folds >= kFewestFolds;
    for (std::size_t k = 0; complete && k < judged; ++k) {
      std::vector<Point> rest;
      for (const Point& p : points) {
        if (p.fold != k) rest.push_back(p);
      }
      const auto part = fitter.fit(kind, rest, ladders[k]);
      if (!part) {
        complete = false;
        break;
      }
      double square = 0.0, n = 0.0;
      for (const Point& p : points) {
        if (p.fold == k) square += std::pow(p.f - (*part)(p.v), 2.0), n += 1.0;
      }
      t.loss.push_back(square / n);
    }
    // Too few speeds to leave one out: only the simplest stays.
    if (!complete && !tried.empty()) continue;
    if (!complete) t.loss.clear();
    for (const double l : t.loss) t.mean += l / static_cast<double>(t.loss.size());
    tried.push_back(std::move(t));
  }
  if (tried.empty()) {
    throw Refused(text("jog: %zu mean forces at %zu speeds do not give a friction that opposes the motion%s",
                       points.size(), folds, options.terms ? "; fewer Gaussians need fewer speeds" : ""));
  }
  Chosen out;
  std::size_t best = 0;
  for (std::size_t i = 1; i < tried.size(); ++i) {
    if (!tried[i].loss.empty() && (tried[best].loss.empty() || tried[i].mean < tried[best].mean)) best = i;
  }
  std::vector<double> error(tried.size(), 0.0);
  std::vector<std::size_t> equal;  // as good held out as the best
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tried.size(); ++i) {
    double difference = 0.0;
    if (!tried[i].loss.empty() && !tried[best].loss.empty()) {
      const auto n = static_cast<double>(judged);
      difference = tried[i].mean - tried[best].mean;
      double square = 0.0;
      for (std::size_t k = 0; k < judged; ++k) {
        square += std::pow(tried[i].loss[k] - tried[best].loss[k] - difference, 2.0);
      }
      error[i] = std::sqrt(square / (n * (n - 1.0)));
    } else if (i != best) {
      continue;
    }
    if (difference > error[i]) continue;
    equal.push_back(i);
    least = std::min(least, misfit(tried[i].fit, points));
  }
  // Of these the simplest that does not plainly miss what the means say with their small errors.
  std::size_t chosen = best;
  bool found = false;
  for (const std::size_t i : equal) {
    if (misfit(tried[i].fit, points) > std::max(kMisses, 2.0 * least)) continue;
    if (!found || tried[i].fit.parameters() < tried[chosen].fit.parameters()) chosen = i;
    found = true;
  }
  for (std::size_t i = 0; i < tried.size(); ++i) {
    Candidate c;
    c.name = name_of(tried[i].fit.kind);
    c.terms = tried[i].fit.kind.terms;
    c.parameters = static_cast<int>(tried[i].fit.parameters());
    c.held_out_rms =
        tried[i].loss.empty() ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(tried[i].mean);
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
