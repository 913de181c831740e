#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stribeck/ident/frequency/stretches.hpp>
#include <stribeck/ident/log/condition.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::frequency {
namespace {

constexpr double kLongestLag = 0.05;   ///< of a difference that shows the direction [s]
constexpr double kOfQuantum = 4.0;     ///< steps of the encoder within such a difference
constexpr double kStanding = 0.1;      ///< of the median speed
constexpr std::size_t kShortest = 64;  ///< rows of a stretch
constexpr std::size_t kShortestRepeat = 32;
constexpr double kRepeats = 0.01;  ///< of the spread of increments: what may differ after a period
constexpr double kVaries = 1e-9;   ///< of the mean increment, squared

/// Differences of x over `lag` rows about each row.
std::vector<double> differences(const std::vector<double>& x, std::size_t lag) {
  std::vector<double> d(x.size(), 0.0);
  for (std::size_t k = 0; k < x.size(); ++k) {
    const std::size_t a = k > lag / 2 ? k - lag / 2 : 0;
    const std::size_t b = std::min(a + lag, x.size() - 1);
    d[k] = (x[b] - x[b > lag ? b - lag : 0]) / static_cast<double>(lag);
  }
  return d;
}

double median_size(const std::vector<double>& d) {
  std::vector<double> sizes;
  for (const double v : d) {
    if (v != 0.0) sizes.push_back(std::abs(v));
  }
  return sizes.empty() ? 0.0 : stats::median(std::move(sizes));
}

/// Increments of z, and their mean square about the mean.
struct Increments {
  std::vector<double> d;
  double spread = 0.0;
  double mean = 0.0;

  Increments(const std::vector<double>& z, const Stretch& s) {
    for (std::size_t k = s.begin; k + 1 < s.end; ++k) d.push_back(z[k + 1] - z[k]);
    for (const double v : d) mean += v;
    mean /= static_cast<double>(std::max<std::size_t>(1, d.size()));
    for (const double v : d) spread += (v - mean) * (v - mean);
    spread /= static_cast<double>(std::max<std::size_t>(1, d.size()));
  }
  /// Mean square of what differs after n rows, of twice the spread; stops early above `most`.
  [[nodiscard]] double change(std::size_t n, double most) const {
    const std::size_t rows = d.size() - n;
    const double limit = most * 2.0 * spread * static_cast<double>(rows);
    double sum = 0.0;
    for (std::size_t k = 0; k < rows && sum <= limit; ++k) sum += (d[k + n] - d[k]) * (d[k + n] - d[k]);
    return sum / (2.0 * spread * static_cast<double>(rows));
  }
};

}  // namespace

std::vector<Stretch> sliding_stretches(const log::Record& record) {
  const std::vector<double>& x = record.x;
  std::vector<Stretch> out;
  if (x.size() < kShortest) return out;
  const double quantum = log::quantum(x);
  const auto longest = static_cast<std::size_t>(std::max(2.0, kLongestLag / record.sample_time));
  std::size_t lag = 2;
  std::vector<double> d = differences(x, lag);
  while (lag < longest && median_size(d) * static_cast<double>(lag) < kOfQuantum * quantum)
    d = differences(x, lag = std::min(longest, 2 * lag));
  const double standing = kStanding * median_size(d);
  const auto direction = [&](std::size_t k) {
    if (!record.skip.empty() && record.skip[k] != 0) return 0;
    return d[k] > standing ? 1 : d[k] < -standing ? -1 : 0;
  };
  std::size_t begin = 0;
  for (std::size_t k = 1; k <= x.size(); ++k) {
    if (k < x.size() && direction(k) == direction(begin)) continue;
    if (direction(begin) != 0 && k - begin >= kShortest) out.push_back({begin, k});
    begin = k;
  }
  return out;
}

std::size_t repeat_of(const std::vector<double>& z, const Stretch& stretch) {
  const Increments all(z, stretch);
  if (all.d.size() < 3 * kShortestRepeat || all.spread <= kVaries * all.mean * all.mean) return 0;
  // A stretch begins and ends with rows in which the excitation grows: its middle decides.
  const std::size_t cut = all.d.size() / 6;
  const Increments inner(z, {stretch.begin + cut, stretch.end - cut});
  if (inner.spread <= kVaries * inner.mean * inner.mean) return 0;
  std::size_t best = 0;
  double least = kRepeats;
  for (std::size_t n = kShortestRepeat; 2 * n <= inner.d.size(); ++n) {
    const double now = inner.change(n, least);
    // A multiple of the period repeats as well as the period.
    if (now < least && (best == 0 || now < 0.3 * least)) {
      best = n;
      least = now;
    }
  }
  return best;
}

Stretch settled_part(const std::vector<double>& z, const Stretch& stretch, std::size_t rows) {
  if (stretch.rows() < 3 * rows) return {};
  const Increments all(z, stretch);
  const double most = std::sqrt(all.spread);
  // The longest run of rows that are repeated a period later.
  Stretch best;
  std::size_t begin = 0;
  for (std::size_t k = 0; k + rows <= all.d.size(); ++k) {
    const bool same = k + rows < all.d.size() && std::abs(all.d[k + rows] - all.d[k]) < 0.3 * most;
    if (same) continue;
    if (k - begin > best.rows()) best = {begin, k};
    begin = k + 1;
  }
  if (best.rows() < 2 * rows) return {};
  return {stretch.begin + best.begin + rows, stretch.begin + best.end + rows};
}

}  // namespace stribeck::ident::frequency
