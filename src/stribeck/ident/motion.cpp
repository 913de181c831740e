#include <algorithm>
#include <cmath>
#include <stribeck/ident/motion.hpp>

namespace stribeck::ident {
namespace {

/// Largest allowed share of noise in the spread of the acceleration.
constexpr double kNoiseShare = 0.01;
constexpr int kWidestBox = 40;
constexpr double kHysteresis = 10.0;

/// Three boxes of 2j+1 rows, convolved; 6j+1 weights.
std::vector<double> kernel(int j) {
  std::vector<double> k{1.0};
  const auto width = static_cast<std::size_t>(2 * j + 1);
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<double> next(k.size() + width - 1, 0.0);
    for (std::size_t i = 0; i < k.size(); ++i) {
      for (std::size_t b = 0; b < width; ++b) next[i + b] += k[i] / static_cast<double>(width);
    }
    k = std::move(next);
  }
  return k;
}

/// Variance of the second difference of smoothed white noise of variance 1.
double second_difference_gain(int j) {
  std::vector<double> k = kernel(j);
  k.insert(k.begin(), 2, 0.0);
  k.insert(k.end(), 2, 0.0);
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < k.size(); ++i) {
    const double d = k[i - 1] - 2.0 * k[i] + k[i + 1];
    sum += d * d;
  }
  return sum;
}

std::vector<double> smooth(const std::vector<double>& x, const std::vector<double>& weights) {
  const std::size_t half = weights.size() / 2;
  if (half == 0) return x;
  std::vector<double> y(x);
  for (std::size_t k = half; k + half < x.size(); ++k) {
    double sum = weights[half] * x[k];
    for (std::size_t i = 1; i <= half; ++i) sum += weights[half + i] * (x[k - i] + x[k + i]);
    y[k] = sum;
  }
  return y;
}

std::vector<double> second_difference(const std::vector<double>& x, double T) {
  std::vector<double> a(x.size(), 0.0);
  const double scale = 1.0 / (T * T);
  for (std::size_t k = 1; k + 1 < x.size(); ++k) a[k] = ((x[k + 1] - x[k]) - (x[k] - x[k - 1])) * scale;
  return a;
}

/// The value below which a share of the magnitudes lies; 0 for none.
double quantile_of_magnitude(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  for (double& x : values) x = std::abs(x);
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// A programmed force is piecewise smooth: its second differences are nearly all at the resolution of the
/// converter.
bool programmed(const std::vector<double>& f) {
  std::vector<double> second;
  for (std::size_t k = 1; k + 1 < f.size(); ++k) second.push_back(f[k + 1] - 2.0 * f[k] + f[k - 1]);
  const auto [low, high] = std::minmax_element(f.begin(), f.end());
  return quantile_of_magnitude(std::move(second), 0.5) < 1e-3 * (*high - *low);
}

void find_reversals(const std::vector<double>& x, double hysteresis, Motion& m) {
  const std::size_t n = x.size();
  m.direction.assign(n, 1);
  m.stretch.assign(n, 0);
  m.distance.assign(n, 0.0);
  std::size_t low = 0;
  std::size_t high = 0;
  int direction = 0;
  std::vector<std::pair<std::size_t, int>> starts;  // row of the extreme, direction after it
  for (std::size_t k = 0; k < n; ++k) {
    // >= : of equal extremes the last, when the axis leaves.
    if (x[k] >= x[high]) high = k;
    if (x[k] <= x[low]) low = k;
    if (direction <= 0 && x[k] - x[low] > hysteresis) {
      starts.emplace_back(low, 1);
      direction = 1;
      high = k;
    } else if (direction >= 0 && x[high] - x[k] > hysteresis) {
      starts.emplace_back(high, -1);
      direction = -1;
      low = k;
    }
  }
  for (std::size_t s = 0; s < starts.size(); ++s) {
    const std::size_t first = s == 0 ? 0 : starts[s].first;
    const std::size_t last = s + 1 < starts.size() ? starts[s + 1].first : n;
    for (std::size_t k = first; k < last; ++k) {
      m.direction[k] = static_cast<std::int8_t>(starts[s].second);
      m.stretch[k] = static_cast<int>(s);
      m.distance[k] = std::max(0.0, starts[s].second * (x[k] - x[starts[s].first]));
    }
    m.reversals.push_back(starts[s].first);
  }
}

}  // namespace

double position_noise(const std::vector<double>& x) {
  std::vector<double> fourth;
  for (std::size_t k = 2; k + 2 < x.size(); ++k) {
    if (x[k + 2] == x[k - 2]) continue;  // at rest a coarse encoder shows no noise
    fourth.push_back(x[k - 2] - 4.0 * x[k - 1] + 6.0 * x[k] - 4.0 * x[k + 1] + x[k + 2]);
  }
  // Without the jolts of reversals. Counts of an encoder are few values: a quantile alone would be one of
  // them.
  const double limit = 4.0 * quantile_of_magnitude(fourth, 0.6827);
  double square = 0.0;
  std::size_t count = 0;
  for (const double d : fourth) {
    if (std::abs(d) > limit) continue;
    square += d * d;
    ++count;
  }
  return count > 0 ? std::sqrt(square / (70.0 * static_cast<double>(count))) : 0.0;
}

std::vector<double> smooth_like(const Motion& motion, const std::vector<double>& column) {
  return smooth(column, kernel(motion.window));
}

Motion reconstruct(const Record& record, const MotionOptions& options) {
  const double T = record.sample_time;
  Motion m;
  m.sample_time = T;
  m.loop = record.loop;
  if (m.loop == Loop::kAutomatic) {
    m.loop = !record.r.empty() ? Loop::kClosed : programmed(record.f) ? Loop::kOpen : Loop::kAutomatic;
  }
  m.position_noise = position_noise(record.x);
  const auto [low, high] = std::minmax_element(record.x.begin(), record.x.end());
  m.stroke = *high - *low;

  m.window = options.window;
  if (m.window < 0) {
    // The spread is taken from a long window, so that it is motion and not noise.
    const int longest = std::min(kWidestBox, static_cast<int>(record.x.size() / 60));
    const std::vector<double> calm = second_difference(smooth(record.x, kernel(std::min(longest, 10))), T);
    double square = 0.0;
    for (const double a : calm) square += a * a;
    const double allowed = kNoiseShare * std::sqrt(square / static_cast<double>(calm.size())) * T * T;
    m.window = 0;
    while (m.window < longest && m.position_noise * std::sqrt(second_difference_gain(m.window)) > allowed)
      ++m.window;
  }
  m.reach = 3 * m.window + 1;

  const std::vector<double> weights = kernel(m.window);
  const std::vector<double> x = smooth(record.x, weights);
  const std::vector<double> f = smooth(record.f, weights);
  m.a = second_difference(x, T);
  m.v.assign(x.size(), 0.0);
  m.f.assign(x.size(), 0.0);
  for (std::size_t k = 1; k + 1 < x.size(); ++k) {
    m.v[k] = (x[k + 1] - x[k - 1]) / (2.0 * T);
    m.f[k] = 0.5 * (f[k - 1] + f[k]);
  }
  if (m.loop == Loop::kOpen) {
    m.instrument = m.f;
  } else if (m.loop == Loop::kClosed && !record.r.empty()) {
    m.instrument = second_difference(smooth(record.r, weights), T);
  } else {
    m.instrument = second_difference(smooth(record.x, kernel(3 * m.window + 3)), T);
  }
  find_reversals(record.x, std::max(kHysteresis * m.position_noise, 1e-7 * m.stroke), m);
  return m;
}

}  // namespace stribeck::ident
