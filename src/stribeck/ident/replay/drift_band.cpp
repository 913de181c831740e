#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <stribeck/ident/replay/drift_band.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::replay {
namespace {

constexpr std::size_t kDraws = 199;
constexpr std::size_t kPoints = 400;
constexpr double kBlocks = 4.0;        // in the record, on average: as long as errors that last for a stroke
constexpr double kStandstill = 0.005;  // of the top speed: here the level of friction damps
constexpr double kInterval = 0.95;
constexpr auto kAtInterval = static_cast<std::size_t>(kInterval * static_cast<double>(kDraws + 1)) - 1;

/// Slope of friction over the mass at the decimated rows [1/s].
std::vector<double> damping(const friction::AxisModel& model, const log::Record& record,
                            const ForceError& force, const std::vector<double>& v) {
  double top = 0.0;
  for (const double s : v) {
    if (std::isfinite(s)) top = std::max(top, std::abs(s));
  }
  const double slow = kStandstill * top;
  std::vector<double> rate(force.row.size());
  for (std::size_t i = 0; i < rate.size(); ++i) {
    const std::size_t k = force.row[i];
    const double now = std::isfinite(v[k]) ? v[k] : 0.0;
    if (std::abs(now) < slow) {
      rate[i] = model.friction.parts(slow, record.x[k]).level / slow;
    } else {
      const auto at = [&](double s) {
        const auto p = model.friction.parts(s, record.x[k]);
        return p.level * (s > 0.0 ? 1.0 : -1.0) + p.viscous;
      };
      rate[i] = (at(now + 0.1 * slow) - at(now - 0.1 * slow)) / (0.2 * slow);
    }
    rate[i] /= model.mass;
  }
  return rate;
}

}  // namespace

DriftBand drift_band(const friction::AxisModel& model, const log::Record& record, const ForceError& force,
                     const OpenLoop& open) {
  DriftBand band;
  const std::size_t n = force.row.size();
  if (n < 2 || !std::isfinite(force.own_relative)) return band;
  const double h = record.sample_time * static_cast<double>(force.factor);
  const std::vector<double> rate = damping(model, record, force, open.measured_velocity);
  std::vector<double> keep(n), push(n);  // of one step: v ← keep·v + push·e
  double grown = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    grown = std::max(0.0, grown - rate[i] * h);
    band.growth = std::max(band.growth, grown);
    keep[i] = std::exp(-std::clamp(rate[i] * h, -1.0, 50.0));
    push[i] = h / model.mass / (1.0 + std::max(0.0, rate[i] * h));
  }
  const std::size_t step = (n + kPoints - 1) / kPoints;
  std::vector<std::size_t> points;
  for (std::size_t i = n - 1; i > 0; i = i > step ? i - step : 0) points.push_back(i);
  std::reverse(points.begin(), points.end());
  std::vector<std::vector<double>> sizes(points.size());
  std::mt19937_64 random(1);
  const auto below = [&](std::size_t limit) { return static_cast<std::size_t>(random() % limit); };
  const auto mean_block = static_cast<std::size_t>(std::max(1.0, static_cast<double>(n) / kBlocks));
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    double v = 0.0, x = 0.0;
    std::size_t from = below(n), point = 0;
    for (std::size_t i = 0; i < n; ++i) {
      from = below(mean_block) == 0 ? below(n) : from + 1 == n ? 0 : from + 1;
      const double before = v;
      v = keep[i] * v + push[i] * (force.measured[from] - force.modelled[from]);
      x += 0.5 * h * (before + v);
      if (point < points.size() && i == points[point]) sizes[point++].push_back(std::abs(x));
    }
  }
  std::size_t inside = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double half = stats::nth_smallest(std::move(sizes[p]), kAtInterval);
    const std::size_t k = force.row[points[p]];
    band.row.push_back(k);
    band.half.push_back(half);
    inside += std::abs(open.free.x[k] - record.x[k]) <= half ? 1 : 0;
  }
  band.end = band.half.back();
  band.inside = static_cast<double>(inside) / static_cast<double>(points.size());
  return band;
}

}  // namespace stribeck::ident::replay
