#include <algorithm>
#include <cmath>
#include <stribeck/ident/replay/moving_rows.hpp>

namespace stribeck::ident::replay {
namespace {

constexpr double kAround = 0.25;  // [s], either way

/// Rows around each row, within the record.
struct Around {
  std::size_t reach = 1, rows = 0;
  [[nodiscard]] std::size_t from(std::size_t k) const { return k - std::min(k, reach); }
  [[nodiscard]] std::size_t to(std::size_t k) const { return std::min(rows, k + reach + 1); }
};

/// Deviation of the velocity from a straight line over these rows, and its mean [m/s].
struct Swing {
  double mean = 0.0, deviation = 0.0, most = 0.0;
};
Swing swing_of(std::span<const double> v) {
  const auto n = static_cast<double>(v.size());
  Swing out;
  double slope = 0.0, square = 0.0;
  for (std::size_t k = 0; k < v.size(); ++k) {
    const double t = static_cast<double>(k) - 0.5 * (n - 1.0);
    out.mean += v[k] / n, slope += t * v[k], square += t * t;
    out.most = std::max(out.most, std::abs(v[k]));
  }
  slope /= std::max(square, 1.0);
  for (std::size_t k = 0; k < v.size(); ++k) {
    const double t = static_cast<double>(k) - 0.5 * (n - 1.0);
    out.deviation += std::pow(v[k] - out.mean - slope * t, 2.0) / n;
  }
  out.deviation = std::sqrt(out.deviation);
  return out;
}

/// Whether the reference stands still over these rows of the record.
bool held(const std::vector<double>& reference, std::size_t from, std::size_t to) {
  if (reference.empty()) return false;
  return std::all_of(reference.begin() + static_cast<std::ptrdiff_t>(from),
                     reference.begin() + static_cast<std::ptrdiff_t>(to + 1),
                     [&](double r) { return r == reference[from]; });
}

}  // namespace

std::vector<std::size_t> moving_rows(const RestRows& rows, std::span<const std::size_t> used) {
  constexpr double kRest = 0.01;         // of the top speed
  constexpr double kSlowFeed = 0.001;    // of the top speed
  constexpr double kShown = 5.0;         // times the noise
  constexpr double kSlow = 0.05;         // of the top speed
  constexpr double kSwings = 1.0 / 3.0;  // of the mean speed
  double top = 0.0;
  for (const std::size_t i : used) top = std::max(top, std::abs(rows.velocity[i]));
  // Where the velocity alone was logged no encoder shows a slow feed.
  const double least = rows.record.integrated
                           ? kRest * top
                           : std::min(kRest * top, std::max(kSlowFeed * top, kShown * rows.noise));
  const Around around{static_cast<std::size_t>(std::max(1L, std::lround(kAround / rows.period))),
                      rows.velocity.size()};
  std::vector<std::size_t> moving;
  for (const std::size_t i : used) {
    if (std::abs(rows.velocity[i]) < least) continue;
    if (std::abs(rows.velocity[i]) < kSlow * top) {
      const std::size_t from = around.from(i), to = around.to(i);
      const Swing s = swing_of(rows.velocity.subspan(from, to - from));
      if (s.most < kSlow * top && s.deviation > kSwings * std::abs(s.mean)) continue;
      if (held(rows.record.r, rows.row[from], rows.row[to - 1])) continue;
    }
    moving.push_back(i);
  }
  return moving;
}

namespace {

/// Share of its full size, with the sign of the motion, that friction has at each row when it builds up exponentially over a distance [m].
std::vector<double> built_up(std::span<const double> x, double distance) {
  std::vector<double> z(x.size(), 0.0);
  for (std::size_t k = 1; k < x.size(); ++k) {
    const double moved = x[k] - x[k - 1];
    z[k] = z[k - 1] + ((moved > 0.0 ? 1.0 : -1.0) - z[k - 1]) * -std::expm1(-std::abs(moved) / distance);
  }
  return z;
}

}  // namespace

std::vector<std::size_t> settled_rows(const SettlingRows& rows, std::vector<std::size_t> moving) {
  constexpr int kShortest = 16, kLongest = 7;  // halvings of the travel
  constexpr double kExplains = 0.5;            // of the squares
  constexpr double kBuiltUp = 0.9;
  constexpr std::size_t kFewest = 50;
  const auto [low, high] = std::minmax_element(rows.x.begin(), rows.x.end());
  const auto left = [&](const std::vector<double>* z) {
    double mean = 0.0, square = 0.0;
    for (const std::size_t i : moving) {
      const double share = z != nullptr ? std::abs((*z)[rows.row[i]]) : 1.0;
      const double sign = z != nullptr && (*z)[rows.row[i]] * rows.friction[i] < 0.0 ? -1.0 : 1.0;
      const double e = rows.measured[i] - rows.modelled[i] + rows.friction[i] * (1.0 - sign * share);
      mean += e, square += e * e;
    }
    return square - mean * mean / static_cast<double>(moving.size());
  };
  double least = kExplains * left(nullptr);
  std::vector<double> best;
  for (int k = kShortest; k >= kLongest; --k) {
    std::vector<double> z = built_up(rows.x, std::ldexp(*high - *low, -k));
    const double now = left(&z);
    if (now < least) least = now, best = std::move(z);
  }
  if (best.empty()) return moving;
  std::vector<std::size_t> settled;
  for (const std::size_t i : moving) {
    const double z = best[rows.row[i]];
    if (std::abs(z) > kBuiltUp && z * rows.friction[i] > 0.0) settled.push_back(i);
  }
  return settled.size() < kFewest ? moving : settled;
}

}  // namespace stribeck::ident::replay
