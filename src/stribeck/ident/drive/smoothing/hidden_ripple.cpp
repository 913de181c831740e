#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/drive/smoothing/hidden_ripple.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace stribeck::ident::drive {
namespace {

constexpr double kMoves = 0.02;           // of the top speed
constexpr double kClip = 5.0;             // medians: steps of the acceleration are no ripple
constexpr double kStandsOut = 8.0;        // times the median of the spectrum
constexpr double kFewestPeriods = 5.0;    // in the travel
constexpr double kRowsPerPeriod = 4.0;    // at most speeds
constexpr double kStepsPerPeriod = 8.0;   // of the encoder
constexpr std::size_t kMostBins = 16384;  // of position
constexpr std::size_t kBinsPerPeriod = 4;
constexpr std::size_t kFewestRows = 1000;
constexpr double kMostSpeeds = 0.7;    // quantile
constexpr double kAbove = 2.0;         // cut-off over the frequency at that speed
constexpr double kHighestShare = 0.8;  // of half the rate

/// A row in motion: where, how fast, and the force that the window takes off.
struct TakenOff {
  double x = 0.0, speed = 0.0, force = 0.0, sign = 1.0;
};

std::vector<TakenOff> taken_off_rows(const AlignedLog& log) {
  double top = 0.0;
  for (const log::Motion& m : log.motions) {
    for (std::size_t k = 0; k < m.rows(); ++k) {
      if (m.valid(k)) top = std::max(top, std::abs(m.v[k]));
    }
  }
  std::vector<TakenOff> rows;
  for (std::size_t i = 0; i < log.motions.size(); ++i) {
    const log::Motion& m = log.motions[i];
    const std::vector<double> force = log::align_force(log.records[i].f, log.shift);
    for (std::size_t k = 0; k < m.rows(); ++k) {
      if (!m.valid(k) || std::abs(m.v[k]) < kMoves * top) continue;
      rows.push_back({m.x[k], std::abs(m.v[k]), force[k] - m.f[k], m.v[k] > 0.0 ? 1.0 : -1.0});
    }
  }
  std::vector<double> sizes;
  for (const TakenOff& r : rows) sizes.push_back(std::abs(r.force));
  if (sizes.empty()) return rows;
  const double most = kClip * stats::median(std::move(sizes));
  for (TakenOff& r : rows) r.force = std::clamp(r.force, -most, most);
  return rows;
}

struct Peak {
  double period = 0.0, amplitude = 0.0, over_median = 0.0;
};

/// The largest amplitude of the force over position, and how far it stands out.
Peak peak_of(const std::vector<TakenOff>& rows, double low, double travel, double shortest, bool reverses) {
  std::size_t bins = 64;
  while (bins < kMostBins && static_cast<double>(bins) * shortest < kBinsPerPeriod * travel) bins *= 2;
  std::vector<double> sum(4 * bins, 0.0);  // zeros behind: peaks between the lines of the travel
  for (const TakenOff& r : rows) {
    const auto b = static_cast<std::size_t>((r.x - low) / travel * static_cast<double>(bins));
    sum[std::min(b, bins - 1)] += reverses ? r.sign * r.force : r.force;
  }
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<std::complex<double>> lines;
  fft.fwd(lines, sum);
  const auto first = static_cast<std::size_t>(4.0 * kFewestPeriods);
  const auto last = std::min(lines.size() - 1, static_cast<std::size_t>(4.0 * travel / shortest));
  if (last < first + 100) return {};
  std::vector<double> size;
  for (std::size_t j = first; j <= last; ++j)
    size.push_back(2.0 * std::abs(lines[j]) / static_cast<double>(rows.size()));
  const auto top = std::max_element(size.begin(), size.end());
  const auto at = static_cast<double>(first + static_cast<std::size_t>(top - size.begin()));
  const double usual = stats::median(size);
  return {4.0 * travel / at, *top, usual > 0.0 ? *top / usual : 0.0};
}

}  // namespace

std::optional<HiddenRipple> find_hidden_ripple(const AlignedLog& log, double least) {
  const double T = log.records.front().sample_time;
  const std::vector<TakenOff> rows = taken_off_rows(log);
  if (rows.size() < kFewestRows) return {};
  std::vector<double> speeds;
  double low = rows.front().x, high = low, step = 0.0;
  for (const TakenOff& r : rows) {
    speeds.push_back(r.speed);
    low = std::min(low, r.x), high = std::max(high, r.x);
  }
  for (const log::Motion& m : log.motions) step = std::max(step, m.position_noise);
  const double usual = stats::quantile(speeds, kMostSpeeds);
  const double shortest =
      std::max({kRowsPerPeriod * usual * T, kStepsPerPeriod * step, (high - low) * 4.0 / kMostBins});
  if (!(high - low > kFewestPeriods * shortest)) return {};
  Peak best;
  for (const bool reverses : {false, true}) {
    const Peak p = peak_of(rows, low, high - low, shortest, reverses);
    if (p.over_median > best.over_median) best = p;
  }
  if (!(best.over_median > kStandsOut) || !(best.amplitude > least)) return {};
  return HiddenRipple{best.period, best.amplitude,
                      std::min(kAbove * usual / best.period, kHighestShare * 0.5 / T)};
}

}  // namespace stribeck::ident::drive
