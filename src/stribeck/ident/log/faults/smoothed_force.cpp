// A force that the drive smoothed before it logged it, and one with a line of its own: both are named, not mended.
#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stribeck/ident/log/faults/faults.hpp>
#include <stribeck/ident/log/rough_fit.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::log::parts {
namespace {

constexpr double kAfterReversal = 5e-3;  // of the stroke

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// f + τ·df/dt = m·a + c·v + F·sgn v + k·x + f0 is what a filter of first order makes of the law. A pure delay looks like it at
/// first order in τ only, so that delays are tried as well.
struct SmoothedFit {
  double rest = std::numeric_limits<double>::infinity();          ///< mean square with the filter
  double rest_without = std::numeric_limits<double>::infinity();  ///< and without, each at its best delay
  double time = 0.0;                                              ///< τ [s]
  double mean_square = 0.0;
};

/// Normal equations of all blocks; rows are a, v, sgn v, x, 1, −df/dt.
struct Normal {
  Matrix6 a = Matrix6::Zero();
  Vector6 b = Vector6::Zero();
  double ff = 0.0;
  std::size_t n = 0;

  [[nodiscard]] double rest(int columns, Vector6& c) const {
    const Eigen::MatrixXd part = a.topLeftCorner(columns, columns);
    const Eigen::VectorXd scale = part.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd even = scale.asDiagonal() * part * scale.asDiagonal();
    even.diagonal().array() += 1e-9;
    const Eigen::VectorXd right = scale.asDiagonal() * b.head(columns);
    const Eigen::VectorXd solution = scale.asDiagonal() * stats::solve_ldlt(even, right);
    c.setZero();
    c.head(columns) = solution;
    const double sum = ff - 2.0 * solution.dot(b.head(columns)) + solution.dot(part * solution);
    return std::max(0.0, sum) / static_cast<double>(n);
  }
};

Normal normal_of(const std::vector<Block>& blocks, int delay, double slowest) {
  Normal s;
  for (const Block& b : blocks) {
    const auto n = static_cast<std::ptrdiff_t>(b.motion.rows());
    for (std::ptrdiff_t k = 0; k < n; ++k) {
      const std::ptrdiff_t j = k + delay;
      if (j < 1 || j + 1 >= n) continue;
      const auto row = static_cast<std::size_t>(k);
      const auto at = static_cast<std::size_t>(j);
      // Soon after a reversal friction rises over a distance, which looks like a filter.
      if (!b.motion.sliding(row, kAfterReversal * b.motion.stroke)) continue;
      if (!b.motion.valid(at - 1) || !b.motion.valid(at + 1)) continue;
      const double v = b.motion.v[row];
      if (std::abs(v) < slowest) continue;
      Vector6 x;
      x << b.motion.a[row], v, v > 0.0 ? 1.0 : -1.0, b.x[row], 1.0,
          -(b.f[at + 1] - b.f[at - 1]) / (2.0 * b.motion.sample_time);
      s.a.noalias() += x * x.transpose();
      s.b += x * b.f[at];
      s.ff += b.f[at] * b.f[at];
      ++s.n;
    }
  }
  return s;
}

SmoothedFit fit_smoothed(const std::vector<Block>& blocks, double slowest) {
  const double T = blocks.front().motion.sample_time;
  const int late = std::clamp(static_cast<int>(std::ceil(0.05 / T)), 1, 30);
  SmoothedFit best;
  for (int d = -1; d <= late; ++d) {
    const Normal s = normal_of(blocks, d, slowest);
    if (s.n < 200) continue;
    Vector6 c;
    const double without = s.rest(5, c);
    const double with = s.rest(6, c);  // sets c
    // Within a row it is the part of a delay that whole rows leave.
    const bool delay = std::abs(c[5]) <= blocks.front().motion.sample_time;
    best.rest_without = std::min(best.rest_without, delay ? std::min(with, without) : without);
    if (with < best.rest) {
      best.rest = with;
      best.time = c[5];
      best.mean_square = s.ff / static_cast<double>(s.n);
    }
  }
  return best;
}

/// Amplitudes of the real series y, whose length is a power of two, under a Hann window; bins 0 … N/2.
std::vector<double> amplitudes(const std::vector<double>& y) {
  const std::size_t n = y.size();
  std::vector<double> re(n), im(n, 0.0);
  double mean = 0.0;
  for (const double value : y) mean += value / static_cast<double>(n);
  for (std::size_t k = 0, j = 0; k < n; ++k) {
    const double w =
        0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
    re[j] = w * (y[k] - mean);
    std::size_t bit = n >> 1;
    for (; bit > 0 && (j & bit) != 0; bit >>= 1) j ^= bit;
    j |= bit;
  }
  for (std::size_t length = 2; length <= n; length <<= 1) {
    for (std::size_t k = 0; k < length / 2; ++k) {
      const double angle = -2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(length);
      const double c = std::cos(angle), s = std::sin(angle);
      for (std::size_t i = k; i < n; i += length) {
        const std::size_t j = i + length / 2;
        const double tr = c * re[j] - s * im[j], ti = c * im[j] + s * re[j];
        re[j] = re[i] - tr, im[j] = im[i] - ti;
        re[i] += tr, im[i] += ti;
      }
    }
  }
  std::vector<double> out(n / 2 + 1);
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] = 4.0 / static_cast<double>(n) * std::hypot(re[k], im[k]);
  return out;
}

struct Line {
  double hertz = 0.0;
  double amplitude = 0.0;
};

/// A line that stands in the spectra of most pieces: what is periodic in position moves with the speed.
Line line_of(const std::vector<std::vector<double>>& rests, double T) {
  constexpr std::size_t kLength = 512;
  std::vector<std::vector<double>> spectra;
  for (const std::vector<double>& rest : rests) {
    for (std::size_t first = 0; first + kLength <= rest.size(); first += kLength)
      spectra.push_back(amplitudes({rest.begin() + static_cast<std::ptrdiff_t>(first),
                                    rest.begin() + static_cast<std::ptrdiff_t>(first + kLength)}));
  }
  if (spectra.size() < 6) return {};
  // In three of four pieces at least so strong.
  std::vector<double> common(kLength / 2 + 1);
  std::vector<double> at(spectra.size());
  for (std::size_t b = 0; b < common.size(); ++b) {
    for (std::size_t i = 0; i < spectra.size(); ++i) at[i] = spectra[i][b];
    common[b] = stats::quantile(at, 0.25);
  }
  constexpr std::size_t kNear = 3, kAround = 16;
  constexpr double kStandsOut = 8.0;
  Line best;
  for (std::size_t b = kNear + 3; b + kNear + 1 < common.size(); ++b) {
    if (common[b] < common[b - 1] || common[b] < common[b + 1]) continue;
    std::vector<double> around;
    for (std::size_t i = b > kAround ? b - kAround : 1; i < std::min(b + kAround, common.size()); ++i) {
      if (i + kNear < b || i > b + kNear) around.push_back(common[i]);
    }
    if (common[b] < kStandsOut * stats::median(around) || common[b] < best.amplitude) continue;
    // The top of a parabola through the logarithms: a Hann window's peak is nearly one.
    const double l = std::log(common[b - 1]), m = std::log(common[b]), r = std::log(common[b + 1]);
    const double shift = std::abs(l - 2.0 * m + r) > 0.0 ? 0.5 * (l - r) / (l - 2.0 * m + r) : 0.0;
    best = {(static_cast<double>(b) + shift) / (static_cast<double>(kLength) * T), common[b]};
  }
  return best;
}

}  // namespace

void name_smoothed_force(const std::vector<Table>& tables, Notes& notes) {
  if (!notes.wanted("smoothed") && !notes.wanted("line")) return;
  const std::vector<Block> blocks = blocks_of(tables, 40000);
  if (blocks.empty()) return;
  const double slowest = slowest_moving(blocks);
  const Fit fit = best_fit(blocks, slowest);
  const RoughFit rough = as_rough(fit);
  if (!rough.good || rough.r_squared < 0.5 || !rough.mass_shows) return;
  const double T = blocks.front().motion.sample_time;
  const std::string& source = tables.front().source;
  const SmoothedFit smooth = fit_smoothed(blocks, slowest);
  if (smooth.time > 2.5 * T && smooth.rest < 0.5 * smooth.rest_without &&
      smooth.rest > 1e-12 * smooth.mean_square) {
    notes.add_all(
        "smoothed", source, false,
        fmt::format(
            "the force looks smoothed by a filter of about {:.2g} ms ({:.3g} Hz) before it was logged: "
            "with it a rough fit leaves {:.3g} instead of {:.3g}. identify takes a filter off where it finds one (force_filter); "
            "where it does not, mass and friction are biased: log the signal before the filter, or switch the smoothing off",
            1e3 * smooth.time, 0.5 / (std::numbers::pi * smooth.time), std::sqrt(smooth.rest),
            std::sqrt(smooth.rest_without)),
        {smooth.time});
  }
  if (std::any_of(tables.begin(), tables.end(), [](const Table& m) { return quiet(m.f); })) return;
  std::vector<std::vector<double>> rests;
  double square = 0.0;
  std::size_t count = 0;
  for (const Block& b : blocks) {
    std::vector<double> rest = predicted(b, fit);
    for (std::size_t k = 0; k < rest.size(); ++k) {
      rest[k] = b.force[k] - rest[k];
      square += rest[k] * rest[k];
    }
    count += rest.size();
    rests.push_back(std::move(rest));
  }
  const Line line = line_of(rests, T);
  const double rms = std::sqrt(square / static_cast<double>(std::max<std::size_t>(1, count)));
  if (line.amplitude < 0.1 * std::abs(rough.coulomb) || line.amplitude < 0.5 * rms) return;
  // What the rough fit leaves repeats with the motion; its harmonics are no lines.
  double reversals = 0.0, seconds = 0.0;
  for (const Block& b : blocks) {
    reversals += static_cast<double>(b.motion.reversals.size());
    seconds += T * static_cast<double>(b.motion.rows());
  }
  constexpr double kHarmonics = 20.0;
  if (line.hertz < kHarmonics * 0.5 * reversals / seconds) return;
  const double mains = std::min(std::abs(line.hertz / 50.0 - std::round(line.hertz / 50.0)) * 50.0,
                                std::abs(line.hertz / 60.0 - std::round(line.hertz / 60.0)) * 60.0);
  notes.add_all(
      "line", source, false,
      fmt::format(
          "the force swings at {:.1f} Hz by {:.3g} whatever the speed, {}: {}; it is not in the model",
          line.hertz, line.amplitude,
          line.amplitude < std::abs(rough.coulomb)
              ? fmt::format("{:.0f} % of the Coulomb friction",
                            100.0 * line.amplitude / std::abs(rough.coulomb))
              : fmt::format("more than the Coulomb friction of {:.3g}", std::abs(rough.coulomb)),
          mains < 0.5 ? "hum of the mains, or a vibration" : "a vibration from outside or of the axis"),
      {line.hertz, line.amplitude});
}

}  // namespace stribeck::ident::log::parts
