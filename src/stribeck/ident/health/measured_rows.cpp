#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/ident/health/measured_rows.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::health {
namespace {

constexpr std::size_t kMostRows = 30000;  // more add time and no knowledge
constexpr std::size_t kPlaces = 4;
constexpr double kAfterReversal = 1.0 / 400.0;  // of the stroke

}  // namespace

Rows rows_of(const std::vector<log::Record>& records, double shift) {
  std::size_t all = 0;
  for (const log::Record& r : records) all += r.x.size();
  const std::size_t stride = 1 + all / kMostRows;
  Rows rows;
  for (std::size_t n = 0; n < records.size(); ++n) {
    if (records[n].force_unit != "N" || records[n].position_unit != "m")
      throw Refused(
          fmt::format("{}: got a force in {} and a position in {}, expected N and m (--gain, --lead)",
                      records[n].source, records[n].force_unit, records[n].position_unit));
    log::MotionOptions options;
    options.shift = shift;
    const log::Motion motion = log::reconstruct(records[n], options);
    const double exclude = std::max(kAfterReversal * motion.stroke, 10.0 * motion.position_noise);
    for (std::size_t k = 0; k < motion.rows(); k += stride) {
      if (!motion.sliding(k, exclude) || motion.v[k] == 0.0) continue;
      if (!records[n].skip.empty() && records[n].skip[k] != 0) continue;
      rows.x.push_back(motion.x[k]);
      rows.v.push_back(motion.v[k]);
      rows.a.push_back(motion.a[k]);
      rows.f.push_back(motion.f[k]);
      rows.record.push_back(static_cast<int>(n));
      rows.at.push_back(k / stride);
      rows.duration += static_cast<double>(stride) * motion.sample_time;
    }
  }
  if (rows.size() < 10 * kFewRows)
    throw Refused(fmt::format("{}: only {} rows of sliding, expected {} (record the whole motion)",
                              records.empty() ? std::string("no log") : records.front().source, rows.size(),
                              10 * kFewRows));
  return rows;
}

std::vector<double> constant_speeds(const std::vector<double>& speed) {
  constexpr double kWidth = 0.04;  // of the logarithm
  constexpr double kShare = 0.03, kMost = 0.6;
  const double top = *std::max_element(speed.begin(), speed.end());
  std::vector<std::size_t> bins(250, 0);
  for (const double v : speed) {
    const auto bin = static_cast<std::size_t>(std::log(top / v) / kWidth);
    if (bin < bins.size()) ++bins[bin];
  }
  std::vector<double> found;
  double held = 0.0;
  const auto all = static_cast<double>(speed.size());
  for (std::size_t b = 0; b < bins.size(); ++b) {
    const std::size_t before = b > 0 ? bins[b - 1] : 0, after = b + 1 < bins.size() ? bins[b + 1] : 0;
    const auto near = static_cast<double>(before + bins[b] + after);
    if (bins[b] < before || bins[b] <= after || near < kShare * all) continue;
    std::vector<double> inside;
    for (const double v : speed) {
      if (std::abs(std::log(top / v) / kWidth - static_cast<double>(b) - 0.5) <= 1.5) inside.push_back(v);
    }
    found.insert(found.begin(), stats::median(inside));
    held += near / all;
  }
  return found.size() >= 2 && held >= kMost ? found : std::vector<double>{};
}

double rounded(double value, double per_unit) { return std::round(value * per_unit) / per_unit + 0.0; }

std::pair<std::size_t, double> between(const std::vector<double>& speeds, double v) {
  const auto above = std::upper_bound(speeds.begin(), speeds.end(), v);
  if (above == speeds.begin()) return {0, 0.0};
  if (above == speeds.end()) return {speeds.size() - 1, 0.0};
  const auto i = static_cast<std::size_t>(above - speeds.begin()) - 1;
  return {i, (v - speeds[i]) / (speeds[i + 1] - speeds[i])};
}

bool within(const std::vector<double>& speeds, double v) {
  return v >= speeds.front() / kOutside && v <= speeds.back() * kOutside;
}

std::vector<std::array<std::size_t, 2>> counts_of(const Rows& rows, const std::vector<double>& speeds,
                                                  double from, double to) {
  std::vector<std::array<std::size_t, 2>> counts(speeds.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double v = std::abs(rows.v[k]);
    if (!within(speeds, v) || rows.x[k] < from || rows.x[k] > to) continue;
    const auto [i, share] = between(speeds, v);
    ++counts[i + (share > 0.5 ? 1 : 0)][rows.v[k] > 0.0];
  }
  return counts;
}

std::vector<double> borders_of(const Rows& rows, const std::vector<double>& speeds) {
  const auto [low, high] = std::minmax_element(rows.x.begin(), rows.x.end());
  std::vector<double> borders;
  for (std::size_t j = 0; j <= kPlaces; ++j)
    borders.push_back(rounded(*low + (*high - *low) * static_cast<double>(j) / kPlaces, 1e6));
  for (std::size_t j = 0; j < kPlaces; ++j) {
    const auto counts = counts_of(rows, speeds, borders[j], borders[j + 1]);
    const auto both = std::count_if(counts.begin(), counts.end(),
                                    [](const auto& c) { return c[0] >= kFewRows && c[1] >= kFewRows; });
    if (2 * both < static_cast<std::ptrdiff_t>(speeds.size()) || both < 2) return {};
  }
  return borders;
}

}  // namespace stribeck::ident::health
