#include <algorithm>
#include <cmath>
#include <stribeck/ident/methods/jog/jog_parts.hpp>

namespace stribeck::ident::methods::jog {

namespace {

constexpr double kOneSpeed = 0.05;  // share by which speeds left out together may differ

std::vector<Jump> jumps_of(const std::vector<SpeedMean>& mean) {
  constexpr double kLargest = 1.6;    // largest ratio of the two speeds
  constexpr double kVisible = 0.06;   // smallest visible step, as a share of the force
  constexpr double kSteeper = 2.0;    // factor on the slope of the neighbours, per ratio of speeds
  constexpr double kErrors = 2.0;     // standard errors of one direction
  constexpr std::size_t kFewest = 3;  // speeds on either side
  std::vector<Jump> out;
  const auto slope = [&](std::size_t i) {
    return (mean[i + 1].f - mean[i].f) / std::log(mean[i + 1].v / mean[i].v);
  };
  for (std::size_t j = kFewest - 1; j + kFewest < mean.size(); ++j) {
    const SpeedMean& a = mean[j];
    const SpeedMean& b = mean[j + 1];
    const double share = (b.f - a.f) / (0.5 * (std::abs(a.f) + std::abs(b.f)));
    const double errors = std::abs(b.f - a.f) / std::sqrt(a.variance + b.variance);
    const double beside = std::max(std::abs(slope(j - 1)), std::abs(slope(j + 1)));
    if (b.v <= kLargest * a.v && std::abs(share) > kVisible && std::abs(slope(j)) > kSteeper * beside &&
        errors > kErrors) {
      out.push_back({a.v, b.v, share, errors});
    }
  }
  return out;
}

}  // namespace

std::vector<SpeedMean> means_of(const std::vector<Point>& ascending, int side) {
  std::vector<SpeedMean> out;
  for (const Point& p : side_of(ascending, side)) {
    const double v = std::abs(p.v);
    if (out.empty() || v > (1.0 + kOneSpeed) * out.back().v / out.back().n) out.push_back({});
    SpeedMean& m = out.back();
    m.n += 1.0, m.v += v, m.f += p.v > 0.0 ? p.f : -p.f, m.variance += p.error * p.error;
  }
  for (SpeedMean& m : out) m.v /= m.n, m.f /= m.n, m.variance /= m.n * m.n;
  return out;
}

std::optional<Jump> find_jump(const std::vector<Point>& ascending) {
  constexpr double kBoth = 5.0;  // standard errors of both directions together
  std::optional<Jump> found;
  const std::vector<Jump> backward = jumps_of(means_of(ascending, 1));
  for (const Jump& a : jumps_of(means_of(ascending, 0))) {
    for (const Jump& b : backward) {
      const double below = std::max(a.below, b.below);
      const double above = std::min(a.above, b.above);
      const double errors = std::hypot(a.errors, b.errors);
      if (below >= above || a.share * b.share <= 0.0 || errors < kBoth) continue;
      const double share = 0.5 * (a.share + b.share);
      if (!found || std::abs(share) > std::abs(found->share)) found = Jump{below, above, share, errors};
    }
  }
  return found;
}

std::size_t number_folds(std::vector<Point>& points) {
  std::stable_sort(points.begin(), points.end(),
                   [](const Point& a, const Point& b) { return std::abs(a.v) < std::abs(b.v); });
  std::size_t folds = 0;
  double first = 0.0;
  for (Point& p : points) {
    if (folds == 0 || std::abs(p.v) > (1.0 + kOneSpeed) * first) {
      first = std::abs(p.v);
      ++folds;
    }
    p.fold = folds - 1;
  }
  return folds;
}

std::vector<Point> by_record(const std::vector<Point>& points, const std::vector<map::SteadyRun>& runs,
                             const std::vector<log::Record>& records) {
  std::vector<Point> out = points;
  for (Point& p : out) {
    const std::size_t record = runs[p.run].record;
    if (!records[record].r.empty()) continue;
    double rows = 0.0, v = 0.0, f = 0.0, slowest = std::abs(p.v), fastest = slowest;
    for (const Point& q : points) {
      if (runs[q.run].record != record || q.v * p.v < 0.0) continue;
      const auto n = static_cast<double>(runs[q.run].last - runs[q.run].first);
      rows += n, v += n * q.v, f += n * q.f;
      slowest = std::min(slowest, std::abs(q.v));
      fastest = std::max(fastest, std::abs(q.v));
    }
    if (fastest < 1.5 * slowest) p.v = v / rows, p.f = f / rows;
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Point& a, const Point& b) { return std::abs(a.v) < std::abs(b.v); });
  return out;
}

}  // namespace stribeck::ident::methods::jog
