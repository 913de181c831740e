#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/map/constant_speed.hpp>
#include <stribeck/ident/map/run_periodic.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::map {
namespace {

constexpr std::size_t kPointsOfRun = 120;  // means over which the periodic term is fitted
constexpr double kWorthwhile = 0.25;       // share of the scatter of these means
constexpr double kPointsOfPeriod = 8.0;    // points in the shortest period that they can show
constexpr double kSlowRipple = 0.7;     // periods per second, below which the axis does not follow the ripple
constexpr double kPeriodsOfSlow = 4.0;  // number that the slow runs must contain
constexpr double kPeriodsOfLongest = 1.5;  // number of the longest period that the longest stretch contains

/// Means over parts of the runs, for the periodic term.
struct Points {
  std::vector<double> x, f, direction;
  std::vector<int> run;
};

Points points_of(const std::vector<log::Record>& records, const std::vector<SteadyRun>& runs) {
  Points out;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const SteadyRun& run = runs[i];
    const log::Record& rec = records[run.record];
    const std::size_t rows = run.last - run.first + 1;
    const std::size_t step = std::max<std::size_t>(1, rows / kPointsOfRun);
    for (std::size_t k = run.first; k + step <= run.last + 1; k += step) {
      out.x.push_back(mean_over(rec.x, k, k + step));
      out.f.push_back(mean_over(rec.f, k, k + step));
      out.direction.push_back(run.speed > 0.0 ? 1.0 : -1.0);
      out.run.push_back(static_cast<int>(i));
    }
  }
  return out;
}

struct PeriodicFit {
  double period = 0.0, cosine = 0.0, sine = 0.0;
  bool proportional = false;
  double left = std::numeric_limits<double>::infinity();  // Σ residual² with only the means of the runs
};

/// Least squares of cosine and sine together with the mean of every run; the better of the two forms.
PeriodicFit fit_periodic(const Points& p, std::size_t runs, double period) {
  std::vector<double> n(runs), c(runs), s(runs), f(runs);
  const std::size_t size = p.x.size();
  std::vector<double> cosine(size), sine(size);
  for (std::size_t i = 0; i < size; ++i) {
    cosine[i] = std::cos(2.0 * kPi * p.x[i] / period);
    sine[i] = std::sin(2.0 * kPi * p.x[i] / period);
    const auto r = static_cast<std::size_t>(p.run[i]);
    n[r] += 1.0, c[r] += cosine[i], s[r] += sine[i], f[r] += p.f[i];
  }
  // A run has one direction, so the factor sgn v only changes the sign of the products with the force.
  double cc = 0, cs = 0, ss = 0, ff = 0;
  double cf[2] = {0, 0}, sf[2] = {0, 0};
  for (std::size_t i = 0; i < size; ++i) {
    const auto r = static_cast<std::size_t>(p.run[i]);
    const double a = cosine[i] - c[r] / n[r];
    const double b = sine[i] - s[r] / n[r];
    const double e = p.f[i] - f[r] / n[r];
    cc += a * a, cs += a * b, ss += b * b, ff += e * e;
    cf[0] += a * e, sf[0] += b * e;
    cf[1] += p.direction[i] * a * e, sf[1] += p.direction[i] * b * e;
  }
  PeriodicFit best;
  best.period = period;
  best.left = ff;
  const double det = cc * ss - cs * cs;
  if (!(det > 1e-6 * cc * ss)) return best;
  for (const int form : {0, 1}) {
    const double x = (ss * cf[form] - cs * sf[form]) / det;
    const double y = (cc * sf[form] - cs * cf[form]) / det;
    const double left = ff - x * cf[form] - y * sf[form];
    if (left < best.left) best = {period, x, y, form == 1, left};
  }
  return best;
}

/// The best period near `start`; `step` in periods per metre.
PeriodicFit refined(const Points& p, std::size_t runs, const PeriodicFit& start, double step) {
  PeriodicFit best = start;
  for (double fine = step / 2.0; fine > step / 200.0; fine /= 2.0) {
    for (const double sign_of : {1.0, -1.0}) {
      const PeriodicFit w = fit_periodic(p, runs, 1.0 / (1.0 / best.period + sign_of * fine));
      if (w.left < best.left) best = w;
    }
  }
  return best;
}

std::optional<PeriodicFit> search(const Points& p, const std::vector<SteadyRun>& runs,
                                  const std::optional<double>& given) {
  if (p.x.empty() || (given && *given == 0.0)) return {};
  const auto [low, high] = std::minmax_element(p.x.begin(), p.x.end());
  const double span = *high - *low;
  double longest = 0.0;
  std::vector<double> steps;
  for (const SteadyRun& run : runs) longest = std::max(longest, run.way);
  for (std::size_t i = 1; i < p.x.size(); ++i) {
    if (p.run[i] == p.run[i - 1]) steps.push_back(std::abs(p.x[i] - p.x[i - 1]));
  }
  if (steps.empty() || !(span > 0.0)) return {};
  const double none = fit_periodic(p, runs.size(), 1e9 * span).left;
  PeriodicFit best;
  const auto consider = [&](double period) {
    const PeriodicFit w = fit_periodic(p, runs.size(), period);
    if (w.left < best.left) best = w;
  };
  if (given) {
    consider(*given);
  } else {
    const double shortest = std::max(kPointsOfPeriod * stats::median(std::move(steps)), span / 200.0);
    const double step = 0.25 / span;  // in periods per metre
    for (double q = kPeriodsOfLongest / longest; q <= 1.0 / shortest; q += step) consider(1.0 / q);
    best = refined(p, runs.size(), best, step);
  }
  if (!(best.left < (1.0 - kWorthwhile) * none) && !given) return {};
  // At higher speeds the axis follows the ripple, and the force contains the acceleration of that.
  Points slow;
  double way = 0.0;
  for (const SteadyRun& run : runs) {
    if (std::abs(run.speed) <= kSlowRipple * best.period) way += run.way;
  }
  for (std::size_t i = 0; i < p.x.size(); ++i) {
    if (std::abs(runs[static_cast<std::size_t>(p.run[i])].speed) > kSlowRipple * best.period) continue;
    slow.x.push_back(p.x[i]);
    slow.f.push_back(p.f[i]);
    slow.direction.push_back(p.direction[i]);
    slow.run.push_back(p.run[i]);
  }
  if (way < kPeriodsOfSlow * best.period) return best;
  const PeriodicFit again = fit_periodic(slow, runs.size(), best.period);
  return given ? again : refined(slow, runs.size(), again, 0.25 / way);
}

}  // namespace

std::optional<friction::Eccentric<double>> find_run_periodic(const std::vector<log::Record>& records,
                                                             const std::vector<SteadyRun>& runs,
                                                             const std::optional<double>& period) {
  const std::optional<PeriodicFit> fit = search(points_of(records, runs), runs, period);
  if (!fit) return std::nullopt;
  friction::Eccentric<double> e;
  e.period = fit->period;
  e.amplitude = std::hypot(fit->cosine, fit->sine);
  // sin(θ − φ) = cos φ·sin θ − sin φ·cos θ
  e.phase = std::atan2(-fit->cosine, fit->sine);
  e.form = fit->proportional ? friction::EccentricForm::kProportional : friction::EccentricForm::kAdditive;
  return e;
}

}  // namespace stribeck::ident::map
