#include <algorithm>
#include <cmath>
#include <complex>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/residual/residual_parts.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <unsupported/Eigen/FFT>

namespace stribeck::ident::residual {
namespace {

using Complex = std::complex<double>;

constexpr double kSegment = 4.0;        // [s]
constexpr std::size_t kShortest = 256;  // rows of a segment
constexpr std::size_t kLongest = 8192;
constexpr double kLowest = 4.0;       // [Hz]: below it the programmed motion stands in every residual
constexpr double kFewestTurns = 8.0;  // of a line in a segment
constexpr double kStandsOut = 12.0;   // times the background around, in power
constexpr std::size_t kShown = 300;

std::size_t segment_of(const Left& left) {
  std::size_t size = kShortest;
  while (2 * size <= kLongest && 2 * size <= left.raw.size() &&
         static_cast<double>(2 * size) * left.motion.sample_time <= kSegment)
    size *= 2;
  return size;
}

/// Mean power of segments that overlap by half, as squares of amplitudes.
struct Power {
  std::size_t size = 0;
  double period = 0.0;
  std::vector<double> residual, position;
  double segments = 0.0;

  void add(const Left& left) {
    const std::size_t n = left.raw.size();
    if (n < size) return;
    if (residual.empty()) residual.assign(size / 2, 0.0), position.assign(size / 2, 0.0);
    std::vector<std::uint8_t> counts(n, 0);
    for (const std::size_t k : left.counted) counts[k] = 1;
    std::vector<double> e(size), x(size);
    std::vector<Complex> spectrum;
    Eigen::FFT<double> fft;
    for (std::size_t begin = 0; begin + size <= n; begin += size / 2) {
      double weight = 0.0, whole = 0.0;
      const double x0 = left.record->x[begin],
                   slope = (left.record->x[begin + size - 1] - x0) / static_cast<double>(size - 1);
      for (std::size_t i = 0; i < size; ++i) {
        const double w = 0.5 - 0.5 * std::cos(2.0 * kPi * static_cast<double>(i) / static_cast<double>(size));
        const std::size_t k = begin + i;
        whole += w;
        weight += counts[k] != 0 ? w : 0.0;
        e[i] = w * left.raw[k];
        x[i] = w * (left.record->x[k] - x0 - slope * static_cast<double>(i));
      }
      if (weight < 0.3 * whole) continue;
      const auto take = [&](std::vector<double>& y, double scale, std::vector<double>& out) {
        fft.fwd(spectrum, y);
        for (std::size_t j = 0; j < size / 2; ++j) out[j] += std::norm(spectrum[j]) * scale * scale;
      };
      take(e, 2.0 / weight, residual);
      take(x, 2.0 / whole, position);
      segments += 1.0;
    }
  }
  void finish() {
    for (auto* y : {&residual, &position}) {
      for (double& p : *y) p /= std::max(1.0, segments);
    }
  }
  [[nodiscard]] double frequency(double bin) const { return bin / (static_cast<double>(size) * period); }
};

/// Median power of the bins around, without the line itself.
double background(const std::vector<double>& power, std::size_t j, std::size_t lowest) {
  const std::size_t reach = std::max<std::size_t>(12, j / 3);
  std::vector<double> around;
  for (std::size_t i = std::max(lowest, j > reach ? j - reach : 0); i < std::min(power.size(), j + reach + 1);
       ++i) {
    if (i + 4 < j || i > j + 4) around.push_back(power[i]);
  }
  return around.size() < 8 ? kInfinity : stats::median(std::move(around)) / std::log(2.0);
}

}  // namespace

void find_lines(const std::vector<Left>& left, double mass, Quality& quality) {
  Power power;
  const Left* longest = nullptr;
  for (const Left& l : left) {
    if (longest == nullptr || l.raw.size() > longest->raw.size()) longest = &l;
  }
  if (longest == nullptr || longest->raw.size() < kShortest) return;
  power.period = longest->motion.sample_time;
  power.size = segment_of(*longest);
  for (const Left& l : left) {
    if (std::abs(l.motion.sample_time - power.period) < 1e-6 * power.period) power.add(l);
  }
  if (power.segments == 0.0) return;
  power.finish();
  const auto lowest = static_cast<std::size_t>(
      std::max(kFewestTurns, std::ceil(kLowest * static_cast<double>(power.size) * power.period)));
  const std::size_t count = power.residual.size();
  // A line under this window stands in three bins with amplitudes 1/2, 1 and 1/2 of it.
  const auto amplitude = [&](const std::vector<double>& y, std::size_t j) {
    const double sum = y[j - 1] + y[j] + y[j + 1];
    return std::sqrt(sum / 1.5);
  };
  std::size_t best = 0;
  for (std::size_t j = lowest; j + 1 < count; ++j) {
    const double p = power.residual[j];
    if (p < power.residual[j - 1] || p < power.residual[j + 1]) continue;
    if (best != 0 && p < power.residual[best]) continue;
    if (p > kStandsOut * background(power.residual, j, lowest)) best = j;
  }
  const std::size_t step = std::max<std::size_t>(1, (count - lowest + kShown - 1) / kShown);
  for (std::size_t j = lowest; j < count; j += step) {
    std::size_t most = j;
    for (std::size_t i = j; i < std::min(count, j + step); ++i) {
      if (power.residual[i] > power.residual[most]) most = i;
    }
    quality.spectrum.push_back({power.frequency(static_cast<double>(most)), std::sqrt(power.residual[most])});
  }
  if (best == 0) return;
  const double l = std::sqrt(power.residual[best - 1]), m = std::sqrt(power.residual[best]),
               r = std::sqrt(power.residual[best + 1]);
  // Under this window the neighbours tell the place between the bins.
  const double off = r > l ? (2.0 * r - m) / (r + m) : -(2.0 * l - m) / (l + m);
  Line line;
  line.frequency = power.frequency(static_cast<double>(best) + std::clamp(off, -0.5, 0.5));
  line.amplitude = amplitude(power.residual, best);
  line.moves = mass * std::pow(2.0 * kPi * line.frequency, 2.0) * amplitude(power.position, best);
  double wide = 0.0;
  for (std::size_t i = best > 6 ? best - 6 : 1; i < std::min(count, best + 7); ++i) wide += power.residual[i];
  line.narrow = wide < 1.6 * 1.5 * line.amplitude * line.amplitude;
  quality.strongest = line;
}

}  // namespace stribeck::ident::residual
