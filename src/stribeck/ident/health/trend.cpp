#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

#include <stribeck/ident/health/trend.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::health {
namespace {

constexpr double kTwoSided = 1.96;    // 95 %
constexpr std::size_t kShortest = 3;  // measurements of a piece
constexpr std::size_t kReferenceReadings = 10;
constexpr double kLevelPrior = 0.5;     // of the scale
constexpr double kSlopePrior = 0.002;   // of the scale, per day
constexpr double kScatterPrior = 0.01;  // of the scale
constexpr double kScatterWorth = 4.0;   // measurements
constexpr double kWild = 3.5;           // scatters from the neighbours, from which a value is an outlier
constexpr std::size_t kNeighbours = 5;
constexpr double kNormal =
    1.4826;  // half the width of the middle half of a normal distribution to its standard deviation

/// Standard deviation of one value, from half the width of the shortest interval that holds half of the differences y_{i+lag} − y_i. It does
/// not notice a step, across which `lag` of them stand, as long as these are no more than half; 0 where they may be more.
double scatter_at(const std::vector<double>& y, std::size_t lag) {
  std::vector<double> d;
  for (std::size_t i = lag; i < y.size(); ++i) d.push_back(y[i] - y[i - lag]);
  const std::size_t half = (d.size() + 1) / 2;
  if (half + lag > d.size()) return 0.0;
  std::sort(d.begin(), d.end());
  double shortest = kInfinity;
  for (std::size_t i = 0; i + half <= d.size(); ++i) shortest = std::min(shortest, d[i + half - 1] - d[i]);
  return kNormal * 0.5 * shortest / std::numbers::sqrt2;
}

double scatter_of(const std::vector<double>& y, const std::vector<Reading>& readings, double scale) {
  const auto n = static_cast<double>(y.size());
  const double prior = kScatterPrior * scale;
  constexpr std::size_t kEnough = 6;
  if (y.size() >= kEnough) {
    const double near = std::pow(scatter_at(y, 1), 2.0);
    const double far = std::pow(scatter_at(y, 3), 2.0);
    // Of noise with the correlation ρ from one measurement to the next, far/near = 1 + ρ + ρ². Few measurements tell little of it.
    const double excess = near > 0.0 ? std::clamp(far / near - 1.0, 0.0, 0.75) * n / (n + 20.0) : 0.0;
    const double rho = 0.5 * (std::sqrt(1.0 + 4.0 * excess) - 1.0);
    const double found = std::max(near, far) * (1.0 + rho) / (1.0 - rho);
    return std::sqrt((kScatterWorth * prior * prior + n * found) / (kScatterWorth + n));
  }
  // The interval of one measurement also holds errors that are the same every day: it is used while there are few measurements.
  std::vector<double> own;
  for (const Reading& r : readings) own.push_back(r.half_width / kTwoSided);
  return std::max(prior, stats::median(own));
}

/// Moves single wild values to where their neighbours allow.
std::vector<double> without_outliers(const std::vector<double>& y, double scatter) {
  std::vector<double> out = y;
  const std::size_t n = y.size();
  const std::size_t window = std::min(n, kNeighbours);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t from = std::min(i < 2 ? 0 : i - 2, n - window);
    const auto begin = y.begin() + static_cast<std::ptrdiff_t>(from);
    const double middle = stats::median({begin, begin + static_cast<std::ptrdiff_t>(window)});
    out[i] = std::clamp(y[i], middle - kWild * scatter, middle + kWild * scatter);
  }
  return out;
}

/// Change per degree from differences over days to a month; NaN where the temperatures do not tell it.
double effect_of_temperature(const std::vector<Reading>& readings) {
  constexpr std::size_t kFew = 20;
  constexpr double kSpan = 3.0;
  std::vector<const Reading*> known;
  for (const Reading& r : readings) {
    if (std::isfinite(r.temperature)) known.push_back(&r);
  }
  if (known.size() < kFew || known.size() != readings.size()) return kNaN;
  const auto [low, high] = std::minmax_element(
      known.begin(), known.end(), [](auto* a, auto* b) { return a->temperature < b->temperature; });
  if ((*high)->temperature - (*low)->temperature < kSpan) return kNaN;
  constexpr std::array<double, 4> kApart{2.0, 5.0, 14.0, 30.0};  // [day]
  constexpr double kMonth = 31.0;
  constexpr double kHalfADay = 0.5;
  std::vector<std::array<double, 2>> pairs;
  for (std::size_t i = 0; i < known.size(); ++i) {
    std::size_t last = i;
    for (const double apart : kApart) {
      std::size_t before = last;
      while (before > 0 && known[i]->day - known[before]->day < apart - kHalfADay) --before;
      const double days = known[i]->day - known[before]->day;
      if (before == last || days < apart - kHalfADay || days > kMonth) continue;
      last = before;
      pairs.push_back(
          {known[i]->temperature - known[before]->temperature, known[i]->value - known[before]->value});
    }
  }
  if (pairs.size() < kFew) return kNaN;
  double slope = 0.0;
  // Least absolute values by weights: pairs across a step count little.
  for (int round = 0; round < 30; ++round) {
    std::vector<double> rest;
    for (const auto& [dt, dy] : pairs) rest.push_back(std::abs(dy - slope * dt));
    const double unit = std::max(stats::median(rest), 1e-300);
    double top = 0.0, bottom = 0.0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double weight = round == 0 ? 1.0 : 1.0 / std::max(1.0, rest[i] / unit);
      top += weight * pairs[i][0] * pairs[i][1];
      bottom += weight * pairs[i][0] * pairs[i][0];
    }
    if (!(bottom > 0.0)) return kNaN;
    slope = top / bottom;
  }
  return slope;
}

/// Level and slope of the readings from `from` up to, not including, `to`.
struct Piece {
  double middle = 0.0;  ///< [day]
  double level = 0.0;   ///< there
  double slope = 0.0;
  double level_variance = 0.0;
  double slope_variance = 0.0;
  double evidence = 0.0;  ///< logarithm, without what all divisions share

  [[nodiscard]] double at(double day) const { return level + slope * (day - middle); }
  [[nodiscard]] double variance_at(double day) const {
    return level_variance + slope_variance * (day - middle) * (day - middle);
  }
};

class Pieces {
 public:
  Pieces(const std::vector<double>& day, const std::vector<double>& y, double scatter, double scale)
      : noise_(scatter * scatter),
        level_prior_(std::pow(kLevelPrior * scale, 2.0)),
        slope_prior_(std::pow(kSlopePrior * scale, 2.0)),
        origin_(day.front()),
        centre_(stats::median(y)),
        sums_(y.size() + 1) {
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double t = day[i] - origin_, v = y[i] - centre_;
      sums_[i + 1] = {sums_[i][0] + t, sums_[i][1] + t * t, sums_[i][2] + v, sums_[i][3] + v * v,
                      sums_[i][4] + t * v};
    }
  }

  [[nodiscard]] Piece fit(std::size_t from, std::size_t to) const {
    const auto n = static_cast<double>(to - from);
    std::array<double, 5> s{};
    for (std::size_t k = 0; k < s.size(); ++k) s[k] = sums_[to][k] - sums_[from][k];
    const double mean_t = s[0] / n, mean_v = s[2] / n;
    const double tt = std::max(0.0, s[1] - n * mean_t * mean_t);
    const double tv = s[4] - n * mean_t * mean_v;
    const double vv = std::max(0.0, s[3] - n * mean_v * mean_v);
    const double level_information = n / noise_, slope_information = tt / noise_;
    Piece p;
    p.middle = origin_ + mean_t;
    p.level_variance = 1.0 / (level_information + 1.0 / level_prior_);
    p.slope_variance = 1.0 / (slope_information + 1.0 / slope_prior_);
    p.level = centre_ + p.level_variance * level_information * mean_v;
    p.slope = p.slope_variance * tv / noise_;
    p.evidence =
        -0.5 *
        (vv / noise_ + mean_v * mean_v / (level_prior_ + noise_ / n) +
         std::log((1.0 + level_prior_ * level_information) * (1.0 + slope_prior_ * slope_information)) -
         p.slope * tv / noise_);
    return p;
  }

 private:
  double noise_, level_prior_, slope_prior_, origin_, centre_;
  std::vector<std::array<double, 5>> sums_;  ///< of t, t², y, y², t·y
};

double log_add(double a, double b) {
  const double high = std::max(a, b), apart = std::min(a, b) - high;
  constexpr double kNothing = -40.0;  // below the rounding of the sum
  return std::isinf(high) || apart < kNothing ? high : high + std::log1p(std::exp(apart));
}

/// The likeliest division, and the probability that a piece begins at each reading.
struct Division {
  std::vector<std::size_t> begins;  ///< of each piece, the first one 0
  std::vector<double> probability;
};

Division divide(const Pieces& pieces, std::size_t n) {
  const double change = std::log(kChange);
  std::vector<double> best(n + 1, -kInfinity);
  std::vector<std::size_t> from(n + 1, 0);
  std::vector<std::vector<double>> evidence(n + 1);
  best[0] = -change;  // the first piece is no change
  for (std::size_t to = kShortest; to <= n; ++to) {
    evidence[to].resize(to);
    for (std::size_t i = 0; i + kShortest <= to; ++i) {
      const double e = evidence[to][i] = pieces.fit(i, to).evidence + change;
      if (best[i] + e > best[to]) {
        best[to] = best[i] + e;
        from[to] = i;
      }
    }
  }
  Division out;
  out.probability.resize(n, 0.0);
  for (std::size_t to = n; to > 0; to = from[to]) out.begins.push_back(from[to]);
  std::reverse(out.begins.begin(), out.begins.end());
  if (out.begins.size() == 1) return out;  // no change point
  std::vector<double> before(n + 1, -kInfinity), after(n + 1, -kInfinity);
  before[0] = -change;
  after[n] = 0.0;
  for (std::size_t to = kShortest; to <= n; ++to) {
    for (std::size_t i = 0; i + kShortest <= to; ++i)
      before[to] = log_add(before[to], before[i] + evidence[to][i]);
  }
  for (std::size_t i = n - kShortest + 1; i-- > 0;) {
    for (std::size_t to = i + kShortest; to <= n; ++to)
      after[i] = log_add(after[i], after[to] + evidence[to][i]);
  }
  for (std::size_t i = 1; i < n; ++i) out.probability[i] = std::exp(before[i] + after[i] - before[n]);
  return out;
}

/// Probability of a border within a week of reading i, but at least at its neighbours, and no farther than half the way to the borders
/// `before` and `behind` it; and where it lies.
void locate(const std::vector<Reading>& readings, const std::vector<double>& probability, std::size_t before,
            std::size_t i, std::size_t behind, Step& step) {
  constexpr double kWeek = 7.0;
  std::size_t low = i, high = i;
  const auto near = [&](std::size_t k) {
    if (2 * k <= before + i || 2 * k >= i + behind) return false;  // nearer to another border
    return std::abs(readings[k].day - readings[i].day) <= kWeek || k + 2 == i || k == i + 2 || k + 1 == i ||
           k == i + 1;
  };
  while (low > 1 && near(low - 1)) --low;
  while (high + 1 < readings.size() && near(high + 1)) ++high;
  double sum = 0.0;
  for (std::size_t k = low; k <= high; ++k) sum += probability[k];
  step.probability = std::min(1.0, sum);
  double passed = 0.0;
  step.earliest = readings[low].day;
  step.latest = readings[high].day;
  bool begun = false;
  for (std::size_t k = low; k <= high; ++k) {
    passed += probability[k] / sum;
    if (!begun && passed >= 0.025) {
      step.earliest = readings[k].day;
      begun = true;
    }
    if (passed >= 0.975) {
      step.latest = readings[k].day;
      break;
    }
  }
}

void mark_undone(std::vector<Step>& steps) {
  for (std::size_t i = 0; i < steps.size(); ++i) {
    double back = 0.0;
    for (std::size_t k = i + 1; k < steps.size(); ++k) back += steps[k].change;
    steps[i].undone = back * steps[i].change < 0.0 && std::abs(back) >= 0.5 * std::abs(steps[i].change);
  }
}

/// A step that takes back another one that was itself no return. `limit`: of a step.
void mark_restoring(std::vector<Step>& steps, double limit) {
  for (std::size_t k = 1; k < steps.size(); ++k) {
    double rest = steps[k].change;  // of the number, from what it was before step i
    for (std::size_t i = k; i-- > 0 && !steps[k].restores;) {
      rest += steps[i].change;
      steps[k].restores = !steps[i].restores && steps[i].change * steps[k].change < 0.0 &&
                          std::abs(rest) < limit && std::abs(rest) <= 0.5 * std::abs(steps[i].change);
    }
  }
}

/// The last readings that differ from those before and are too few for a piece of their own.
std::optional<Pending> pending_of(const Trend& trend, const std::vector<Reading>& readings,
                                  const TrendOptions& options) {
  const std::vector<double>& y = trend.values;
  const double limit = std::max(options.step_limit * options.scale, kWild * trend.scatter);
  std::size_t begin = 0;  // of what the axis is since its last step
  while (!trend.steps.empty() && readings[begin].day < trend.steps.back().day) ++begin;
  for (std::size_t tests = kShortest - 1; tests > 0; --tests) {
    if (y.size() < begin + kShortest + tests) continue;
    const std::size_t end = y.size() - tests;
    const std::size_t from = std::max(begin, end - std::min(end, kNeighbours));
    const double before = stats::median(
        {y.begin() + static_cast<std::ptrdiff_t>(from), y.begin() + static_cast<std::ptrdiff_t>(end)});
    double sum = 0.0, nearest = kInfinity;
    for (std::size_t i = end; i < y.size(); ++i) {
      sum += y[i] - before;
      nearest = std::min(nearest, std::abs(y[i] - before));
    }
    const double mean = sum / static_cast<double>(tests);
    // Readings on both sides cancel each other in the mean.
    if (nearest > limit && std::abs(mean) >= nearest) return Pending{tests, mean};
  }
  return {};
}

}  // namespace

Trend trend_of(const std::vector<Reading>& readings, const TrendOptions& options) {
  Trend out;
  const std::size_t n = readings.size();
  for (const Reading& r : readings) out.values.push_back(r.value);
  if (n < kShortest) return out;
  out.per_degree = effect_of_temperature(readings);
  if (std::isfinite(out.per_degree)) {
    for (std::size_t i = 0; i < n; ++i)
      out.values[i] -= out.per_degree * (readings[i].temperature - readings.front().temperature);
  }
  out.drift_limit = options.drift_limit;
  out.scatter = scatter_of(out.values, readings, options.scale);
  const std::vector<double> y = without_outliers(out.values, out.scatter);
  std::vector<double> day;
  for (const Reading& r : readings) day.push_back(r.day);
  const Pieces pieces(day, y, out.scatter, options.scale);
  const Division division = divide(pieces, n);
  std::vector<Piece> fits;
  for (std::size_t k = 0; k < division.begins.size(); ++k) {
    const std::size_t begin = division.begins[k];
    const std::size_t end = k + 1 < division.begins.size() ? division.begins[k + 1] : n;
    fits.push_back(pieces.fit(begin, end));
    for (std::size_t i = begin; i < end; ++i)
      out.curve.push_back(
          {day[i], fits.back().at(day[i]), kTwoSided * std::sqrt(fits.back().variance_at(day[i]))});
    if (k == 0) continue;
    const double border = 0.5 * (day[begin - 1] + day[begin]);
    Step step;
    step.day = day[begin];
    step.change = fits[k].at(border) - fits[k - 1].at(border);
    const double deviation = std::sqrt(fits[k].variance_at(border) + fits[k - 1].variance_at(border));
    step.half_width = kTwoSided * deviation;
    locate(readings, division.probability, division.begins[k - 1], begin, end, step);
    if (step.probability < kSure || std::abs(step.change) < 3.0 * deviation) continue;
    step.beyond_limit = std::abs(step.change) >= options.step_limit * options.scale;
    out.steps.push_back(step);
  }
  mark_undone(out.steps);
  mark_restoring(out.steps, options.step_limit * options.scale);
  const std::size_t first = division.begins.size() > 1 ? division.begins[1] : n;
  const double middle = day[(std::min(first, kReferenceReadings) - 1) / 2];
  out.reference = fits.front().at(middle);
  out.now = fits.back().at(day.back());
  out.slope = fits.back().slope;
  out.drift_half_width =
      kTwoSided * std::sqrt(fits.front().variance_at(middle) + fits.back().variance_at(day.back()));
  out.stepped = std::any_of(out.steps.begin(), out.steps.end(), [](const Step& s) { return s.matters(); });
  out.drifted =
      std::abs(out.now - out.reference) - out.drift_half_width > options.drift_limit * options.scale;
  out.pending = pending_of(out, readings, options);
  return out;
}

}  // namespace stribeck::ident::health
