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

}  // namespace stribeck::ident::replay
