#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/log/filter.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <string>
#include <utility>

namespace stribeck::ident::log {
namespace {

/// Largest allowed share of noise in the spread of the acceleration.
constexpr double kNoiseShare = 0.01;
constexpr int kWidestBox = 40;
constexpr double kBoxesHalfPower = 0.2619;  ///< share of the rows of a box: (sin πy / πy)³ = 1/√2
constexpr double kHysteresis = 10.0;
/// Boxes of the instrument, for a window of j.
constexpr int calmer(int j) { return 2 * j + 2; }

/// Three boxes of 2j+1 rows as running sums; rows whose kernel reaches over an end keep their value. Sums use differences from the
/// first value, so that a position far from zero costs no digits.
std::vector<double> smooth(const std::vector<double>& x, int j) {
  const std::size_t n = x.size();
  const auto half = static_cast<std::size_t>(3 * j);
  if (j == 0 || n < 2 * half + 1) return x;
  const auto width = static_cast<std::size_t>(2 * j + 1);
  const double scale = 1.0 / static_cast<double>(width);
  const double origin = x.front();
  std::vector<double> from(n);
  std::vector<double> to(n);
  for (std::size_t k = 0; k < n; ++k) from[k] = x[k] - origin;
  std::size_t length = n;
  for (int pass = 0; pass < 3; ++pass) {
    double sum = 0.0;
    for (std::size_t k = 0; k < width; ++k) sum += from[k];
    to[0] = sum * scale;
    for (std::size_t k = width; k < length; ++k) {
      sum += from[k] - from[k - width];
      to[k - width + 1] = sum * scale;
    }
    length -= width - 1;
    std::swap(from, to);
  }
  std::vector<double> y(x);
  for (std::size_t k = 0; k < length; ++k) y[k + half] = from[k] + origin;
  return y;
}

std::vector<double> second_difference(const std::vector<double>& x, double T) {
  std::vector<double> a(x.size(), 0.0);
  const double scale = 1.0 / (T * T);
  for (std::size_t k = 1; k + 1 < x.size(); ++k) a[k] = ((x[k + 1] - x[k]) - (x[k] - x[k - 1])) * scale;
  return a;
}

/// The value below which this share of the magnitudes lies; 0 for an empty list.
double quantile_of_magnitude(std::vector<double> values, double share) {
  return values.empty() ? 0.0 : stats::quantile(stats::magnitudes(std::move(values)), share);
}

/// Whether the second differences of a force are noise of a sensor: several times finer steps than they are can be read, and each is
/// undone by the next.
bool measured_noise(const std::vector<double>& second, double usual, double step) {
  constexpr double kSteps = 3.0;
  constexpr double kUndone = -0.3;  // correlation of neighbours; of white noise −2/3
  if (!(usual > kSteps * step)) return false;
  const double limit = 4.0 * usual;  // without the edges of pulses
  double square = 0.0, product = 0.0;
  for (std::size_t k = 1; k < second.size(); ++k) {
    if (std::abs(second[k]) > limit || std::abs(second[k - 1]) > limit) continue;
    square += second[k] * second[k], product += second[k] * second[k - 1];
  }
  return square > 0.0 && product < kUndone * square;
}

/// A programmed force is piecewise smooth: almost all of its second differences are at the resolution of the
/// converter.
bool programmed(const std::vector<double>& f) {
  std::vector<double> second;
  for (std::size_t k = 1; k + 1 < f.size(); ++k) second.push_back(f[k + 1] - 2.0 * f[k] + f[k - 1]);
  const auto [low, high] = std::minmax_element(f.begin(), f.end());
  const double usual = quantile_of_magnitude(second, 0.5);
  return usual < 1e-3 * (*high - *low) && !measured_noise(second, usual, quantum(f));
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
    // >= : of equal extremes the last one, where the axis leaves
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

/// At a speed of whole steps per row a coarse encoder shows no noise either. Where more than half of the rows are such and the others are
/// whole steps too, only the others count.
void leave_out_whole_steps(std::vector<double>& fourth) {
  constexpr double kZero = 1e-6;  // of the largest
  double largest = 0.0;
  for (const double d : fourth) largest = std::max(largest, std::abs(d));
  std::vector<double> others;
  for (const double d : fourth) {
    if (std::abs(d) > kZero * largest) others.push_back(d);
  }
  // Few are the corners of a smooth motion, which has no noise.
  if (20 * others.size() < fourth.size() || 2 * others.size() > fourth.size()) return;
  double step = largest;
  for (const double d : others) step = std::min(step, std::abs(d));
  const auto whole = std::count_if(others.begin(), others.end(), [&](double d) {
    const double n = d / step;
    return std::abs(n - std::round(n)) < 0.01;
  });
  if (10 * static_cast<std::size_t>(whole) > 9 * others.size()) fourth = std::move(others);
}

}  // namespace

double position_noise(const std::vector<double>& x) {
  std::vector<double> fourth;
  fourth.reserve(x.size());
  for (std::size_t k = 2; k + 2 < x.size(); ++k) {
    if (x[k + 2] == x[k - 2]) continue;  // at rest a coarse encoder shows no noise
    fourth.push_back(x[k - 2] - 4.0 * x[k - 1] + 6.0 * x[k] - 4.0 * x[k + 1] + x[k + 2]);
  }
  leave_out_whole_steps(fourth);
  // Quantile without the peaks of reversals. Counts of an encoder have few values, so that a quantile alone would be one of
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
  if (!(motion.cut_off > 0.0)) return smooth(column, motion.window);
  return forward_backward(butterworth(4, motion.cut_off * 2.0 * motion.sample_time), column);
}

double cut_off_of(const Motion& motion) {
  if (motion.cut_off > 0.0) return motion.cut_off;
  if (motion.window == 0) return std::numeric_limits<double>::quiet_NaN();
  return kBoxesHalfPower / ((2.0 * motion.window + 1.0) * motion.sample_time);
}

Passed passed_by(const Motion& motion) {
  if (motion.cut_off > 0.0) return [](double ratio) { return 1.0 / (1.0 + std::pow(ratio, 8.0)); };
  if (motion.window == 0) return nullptr;
  return [](double ratio) {
    const double angle = kPi * kBoxesHalfPower * ratio;
    if (!(angle > 0.0)) return 1.0;
    return angle < kPi ? std::pow(std::sin(angle) / angle, 3.0) : 0.0;
  };
}

std::vector<double> align_force(const std::vector<double>& f, double shift) {
  std::vector<double> out(f.size());
  align_force(f, shift, 0, f.size(), out);
  return out;
}

void align_force(const std::vector<double>& f, double shift, std::size_t from, std::size_t to,
                 std::vector<double>& out) {
  // Area of the triangle over [−1, 1] to the left of s.
  const auto area = [](double s) {
    return s < 0.0 ? 0.5 * (s + 1.0) * (s + 1.0) : 1.0 - 0.5 * (1.0 - s) * (1.0 - s);
  };
  const double late = shift + 0.5;
  const double whole = std::floor(late);
  const double part = late - whole;
  // The holds that begin at whole − 1, whole and whole + 1 rows after k, less `late`, cover the triangle.
  const double w[3] = {area(-part), area(1.0 - part) - area(-part), 1.0 - area(1.0 - part)};
  const auto n = static_cast<std::ptrdiff_t>(f.size());
  const auto begin = static_cast<std::ptrdiff_t>(from), end = static_cast<std::ptrdiff_t>(to);
  const auto first = static_cast<std::ptrdiff_t>(whole) - 1;
  const auto held = [&](std::ptrdiff_t k) {
    double sum = 0.0;
    for (std::ptrdiff_t i = 0; i < 3; ++i)
      sum += w[i] * f[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k + first + i, 0, n - 1))];
    return sum;
  };
  // Rows whose three holds lie inside need no clamping.
  const std::ptrdiff_t inner = std::clamp(-first, begin, end);
  const std::ptrdiff_t outer = std::clamp(n - 2 - first, inner, end);
  double* o = out.data();
  const double* g = f.data();
  for (std::ptrdiff_t k = begin; k < inner; ++k) o[k] = held(k);
  for (std::ptrdiff_t k = inner, j = inner + first; k < outer; ++k, ++j)
    o[k] = w[0] * g[j] + w[1] * g[j + 1] + w[2] * g[j + 2];
  for (std::ptrdiff_t k = outer; k < end; ++k) o[k] = held(k);
}

std::vector<double> calm_velocity(const Motion& m) {
  const int j = calmer(m.window);
  const std::vector<double> x = smooth(m.x, j);
  std::vector<double> v = m.v;
  const std::size_t reach = calm_reach(m);
  for (std::size_t k = reach; k + reach < x.size(); ++k) v[k] = (x[k + 1] - x[k - 1]) / (2.0 * m.sample_time);
  return v;
}

std::size_t calm_reach(const Motion& m) {
  return static_cast<std::size_t>(m.reach + 3 * calmer(m.window) + 1);
}

double calm_noise(const Motion& m) {
  const double size = m.position_noise / (m.sample_time * m.sample_time);
  return size * size * second_difference_variance(box_weights(calmer(m.window)));
}

Motion reconstruct(const Record& record, const MotionOptions& options) {
  const double T = record.sample_time;
  Motion m;
  m.sample_time = T;
  m.loop = record.loop;
  m.skip = record.skip;
  if (m.loop == Loop::kAutomatic) {
    m.loop = !record.r.empty() ? Loop::kClosed : programmed(record.f) ? Loop::kOpen : Loop::kAutomatic;
  }
  m.position_noise = position_noise(record.x);
  const auto [low, high] = std::minmax_element(record.x.begin(), record.x.end());
  m.stroke = *high - *low;

  m.window = options.window;
  if (m.window < 0) {
    // The spread is measured through a long window, so that it contains motion and no noise.
    const int longest = std::min(kWidestBox, static_cast<int>(record.x.size() / 60));
    const std::vector<double> calm = second_difference(smooth(record.x, std::min(longest, 10)), T);
    double square = 0.0;
    for (const double a : calm) square += a * a;
    const double allowed = kNoiseShare * std::sqrt(square / static_cast<double>(calm.size())) * T * T;
    m.window = 0;
    while (m.window < longest &&
           m.position_noise * std::sqrt(second_difference_variance(box_weights(m.window))) > allowed)
      ++m.window;
  }
  if (options.cut_off > 0.0) {
    if (!(options.cut_off * 2.0 * T < 1.0)) {
      throw Refused(record.source + ": a cut-off of " + std::to_string(options.cut_off) +
                    " Hz, expected less than half the sampling frequency of the log");
    }
    m.window = 0;
    m.cut_off = options.cut_off;
    // A step response has settled to a hundredth after 0.75 periods of the edge.
    m.reach = static_cast<int>(std::ceil(0.75 / (options.cut_off * T))) + 1;
  } else {
    m.reach = 3 * m.window + 1;
  }
  const int late = static_cast<int>(std::ceil(std::abs(options.shift + 0.5)));
  m.reach += late;

  m.x = smooth_like(m, record.x);
  std::vector<double> force = smooth_like(m, record.f);
  m.f = align_force(force, options.shift);
  if (options.smoothed_force != nullptr) *options.smoothed_force = std::move(force);
  const std::vector<double>& x = m.x;
  m.a = second_difference(x, T);
  m.v.assign(x.size(), 0.0);
  for (std::size_t k = 1; k + 1 < x.size(); ++k) m.v[k] = (x[k + 1] - x[k - 1]) / (2.0 * T);
  if (m.loop == Loop::kOpen) {
    m.instrument = m.f;
  } else if (m.loop == Loop::kClosed && !record.r.empty()) {
    m.instrument = second_difference(smooth_like(m, record.r), T);
  } else {
    m.instrument = second_difference(smooth(m.x, calmer(m.window)), T);
  }
  find_reversals(record.x, std::max(kHysteresis * m.position_noise, 1e-7 * m.stroke), m);
  return m;
}

}  // namespace stribeck::ident::log
