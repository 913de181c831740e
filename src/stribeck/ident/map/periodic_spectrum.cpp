#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/ident/map/periodic_parts.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::map::periodic {
namespace {

constexpr double kBinSpan = 1.0 / 6.0;  ///< share of the shortest period
constexpr double kOversampling = 4.0;   ///< of the spectrum
/// Probability of a false line, over the whole spectrum.
constexpr double kFalseAlarm = 1e-3;
/// Lines at a harmonic of a period found that count as equal to it.
constexpr double kHarmonicTrials = 16.0;

/// Probability that the mean of two of `lines` + 1 exponential powers exceeds the mean of the others by this ratio: F(2, 2·lines).
double chance(double ratio, double lines) { return std::pow(1.0 + ratio / lines, -lines); }

/// Smallest background, for a residual that contains nothing but lines.
double smallest(const Data& data) { return std::numeric_limits<double>::min() + 1e-20 * data.total; }

double lines_per_bin(const Data& data, const FrequencyGrid& grid) { return grid.step * data.length; }

double all_lines(const Data& data, const FrequencyGrid& grid) {
  return std::max(1.0, static_cast<double>(grid.highest - grid.lowest) * lines_per_bin(data, grid) *
                           (data.both ? 2.0 : 1.0));
}

/// Spectra of a sum over groups, forward and backward, in one transform.
void transform(const Data& data, const FrequencyGrid& grid, const std::vector<double>& values,
               std::array<std::vector<Complex>, 2>& out) {
  std::vector<Complex> binned(grid.size, 0.0);
  for (std::size_t i = 0; i < data.groups.size(); ++i) {
    binned[grid.bin[i]] += data.groups[i].sign > 0.0 ? Complex(values[i], 0.0) : Complex(0.0, values[i]);
  }
  std::vector<Complex> z;
  grid.fft.fwd(z, binned);
  for (auto& o : out) o.resize(grid.size);
  for (std::size_t j = 0; j < grid.size; ++j) {
    const Complex other = std::conj(z[(grid.size - j) % grid.size]);
    out[0][j] = 0.5 * (z[j] + other);
    out[1][j] = Complex(0.0, -0.5) * (z[j] - other);
  }
}

/// Mean power of the surrounding lines, from their median: the line itself and its neighbours do not raise it.
void make_background(const Data& data, const FrequencyGrid& grid, std::size_t form, Residual& left) {
  const double near = 12.0 / (data.length * grid.step);
  std::vector<double> at, level, lines;
  const double first = std::log(static_cast<double>(grid.lowest));
  const double last = std::log(static_cast<double>(grid.highest));
  constexpr int kAnchors = 48;
  for (int i = 0; i <= kAnchors; ++i) {
    const double j = std::exp(first + (last - first) * i / kAnchors);
    const auto low = static_cast<std::size_t>(
        std::max(0.6 * static_cast<double>(grid.lowest), std::min(j / 1.5, j - near)) + 1.0);
    const auto high = std::min(grid.highest, static_cast<std::size_t>(std::max(1.5 * j, j + near)));
    std::vector<double> part(left.power[form].begin() + static_cast<std::ptrdiff_t>(low),
                             left.power[form].begin() + static_cast<std::ptrdiff_t>(high) + 1);
    lines.push_back(std::max(2.0, static_cast<double>(part.size()) * lines_per_bin(data, grid)));
    at.push_back(std::log(j));
    level.push_back(std::log(std::max(smallest(data), stats::median(std::move(part)) / std::log(2.0))));
  }
  left.background[form].assign(grid.highest + 1, 1.0);
  left.lines[form].assign(grid.highest + 1, 2.0);
  std::size_t k = 0;
  for (std::size_t j = grid.lowest; j <= grid.highest; ++j) {
    const double x = std::log(static_cast<double>(j));
    while (k + 2 < at.size() && at[k + 1] < x) ++k;
    const double share = at[k + 1] > at[k] ? std::clamp((x - at[k]) / (at[k + 1] - at[k]), 0.0, 1.0) : 0.0;
    left.background[form][j] = std::exp(level[k] + share * (level[k + 1] - level[k]));
    left.lines[form][j] = lines[k];
  }
}

/// The spectrum divides by the whole weight. Passes not longer than the period lose most of a line, and as much of the noise, to their
/// polynomial. This is the ratio of the whole weight to the remaining one at this period.
double taken_by_passes(const Data& data, const Line& line) {
  MatrixXd B(static_cast<Index>(data.groups.size()), 2);
  columns(data, line, B, false);
  double whole = 0.0;
  for (const Group& g : data.groups) whole += g.weight * std::pow(damping(data, g, line.f), 2.0);
  return whole / B.squaredNorm();
}

/// What the term takes off the residual of each pass when it is fitted to the other passes [N²], B its columns, e the residual
/// with the term still in it. A disturbance in time is a line over the position in a pass of steady speed, and in that pass only.
std::vector<double> gain_by_pass(const Data& data, const MatrixXd& B, const VectorXd& e) {
  const Eigen::Matrix2d gram = B.transpose() * B;
  const Eigen::Vector2d moment = B.transpose() * e;
  std::vector<double> gain;
  for (const Pass& p : data.passes) {
    const auto first = static_cast<Index>(p.first);
    const auto rows = static_cast<Index>(p.last - p.first);
    const auto own = B.middleRows(first, rows);
    const auto left = e.segment(first, rows);
    const Eigen::Matrix2d others = gram - own.transpose() * own;
    if (!(others.determinant() > 1e-6 * gram.determinant())) continue;
    const VectorXd y = own * others.ldlt().solve(moment - own.transpose() * left);
    gain.push_back(y.dot(2.0 * left - y));
  }
  return gain;
}

/// The passes tell of each other: the term holds in those that it was not fitted to.
bool holds_in_other_passes(const Data& data, const Line& line, const MatrixXd& B, const VectorXd& left) {
  constexpr std::size_t kFewest = 3;
  constexpr double kErrors = 2.0;  // standard errors of the sum
  if (data.standstill) return true;
  const std::vector<double> gain = gain_by_pass(data, B, left + line.a * B.col(0) + line.b * B.col(1));
  if (gain.size() < kFewest) return true;
  const auto n = static_cast<double>(gain.size());
  double sum = 0.0, square = 0.0;
  for (const double g : gain) sum += g;
  for (const double g : gain) square += std::pow(g - sum / n, 2.0);
  return sum > kErrors * std::sqrt(square * n / (n - 1.0));
}

}  // namespace

FrequencyGrid frequencies(const Data& data) {
  FrequencyGrid grid;
  const double width = kBinSpan * data.shortest;
  const auto wanted = static_cast<std::size_t>(std::ceil(kOversampling * data.length / width));
  grid.size = 64;
  while (grid.size < wanted) grid.size *= 2;
  grid.step = 1.0 / (static_cast<double>(grid.size) * width);
  grid.bin.resize(data.groups.size());
  for (std::size_t i = 0; i < data.groups.size(); ++i) {
    grid.bin[i] = std::min(grid.size - 1, static_cast<std::size_t>((data.groups[i].x - data.low) / width));
  }
  std::vector<double> mass(data.groups.size());
  double sum = 0.0, first = 0.0, second = 0.0;
  for (std::size_t i = 0; i < data.groups.size(); ++i) {
    const double u = data.groups[i].x - data.middle;
    mass[i] = data.groups[i].weight;
    sum += mass[i];
    first += mass[i] * u;
    second += mass[i] * u * u;
  }
  grid.spread =
      sum > 0.0
          ? std::min(data.length, std::sqrt(12.0 * std::max(0.0, second / sum - std::pow(first / sum, 2.0))))
          : data.length;
  transform(data, grid, mass, grid.weight);
  grid.lowest =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(1.0 / (data.longest * grid.step) - 1e-9)));
  grid.highest = std::min(grid.size / 2 - 1, static_cast<std::size_t>(1.0 / (data.shortest * grid.step)));
  return grid;
}

void spectrum(const Data& data, const FrequencyGrid& grid, Residual& left) {
  std::vector<double> moment(data.groups.size());
  for (std::size_t i = 0; i < data.groups.size(); ++i) {
    moment[i] = data.root(static_cast<Index>(i)) * left.e(static_cast<Index>(i));
  }
  std::array<std::vector<Complex>, 2> z;
  transform(data, grid, moment, z);
  for (std::size_t form = 0; form < kForms; ++form) {
    left.power[form].assign(grid.highest + 1, 0.0);
    left.amplitude[form].assign(grid.highest + 1, 0.0);
    if (form == kReversing && !data.both) continue;
    const double sign = form == kSame ? 1.0 : -1.0;
    const double sum = grid.weight[0][0].real() + grid.weight[1][0].real();
    for (std::size_t j = 1; j <= grid.highest; ++j) {
      const Complex b = z[0][j] + sign * z[1][j];
      const Complex w = grid.weight[0][2 * j % grid.size] + grid.weight[1][2 * j % grid.size];
      const double cc = 0.5 * (sum + w.real());
      const double ss = 0.5 * (sum - w.real());
      const double cs = -0.5 * w.imag();
      const double det = cc * ss - cs * cs;
      if (!(det > 1e-6 * sum * sum)) continue;
      const double c = b.real();
      const double s = -b.imag();
      const double p = (ss * c - cs * s) / det;
      const double q = (cc * s - cs * c) / det;
      left.power[form][j] = p * c + q * s;
      left.amplitude[form][j] = std::hypot(p, q);
    }
    make_background(data, grid, form, left);
  }
}

/// First the strongest line of all: where the travel is covered unevenly, as by jogs from one place, a line spreads over its
/// neighbours and raises its own background. Then the strongest of those that stand out. (Not the one with the largest ratio: in a
/// falling background, side lobes of the strongest line would be taken for terms.)
std::optional<Line> strongest(const Data& data, const FrequencyGrid& grid, const Residual& left,
                              const PeriodicOptions& options, const std::vector<Line>& found,
                              const std::vector<double>& rejected, bool any, double apart) {
  const double resolution = 1.0 / data.length;
  double best = 0.0;
  std::optional<Line> line;
  for (std::size_t form = 0; form < (data.both ? kForms : kReversing); ++form) {
    for (std::size_t j = grid.lowest + 1; j < grid.highest; ++j) {
      const double p = left.power[form][j];
      if (p < left.power[form][j - 1] || p < left.power[form][j + 1]) continue;
      double f = static_cast<double>(j) * grid.step;
      if (options.turn > 0.0) {
        const double whole = std::round(f * options.turn) / options.turn;
        if (std::abs(whole - f) > 0.3 * resolution) continue;
        f = whole;
      }
      double trials = all_lines(data, grid);
      bool taken = false;
      for (const Line& other : found) {
        taken |=
            other.form == form && std::abs(other.f - f) < (options.turn > 0.0 ? 0.7 : apart) * resolution;
        const double ratio = std::round(f / other.f);
        if (ratio >= 2.0 && ratio <= kHighestHarmonic && std::abs(f / ratio - other.f) < 0.3 * resolution) {
          trials = std::min(trials, kHarmonicTrials);
        }
      }
      for (const double other : rejected) taken |= std::abs(other - f) < resolution;
      if (taken) continue;
      if (p > best &&
          (any || trials * chance(p / left.background[form][j], left.lines[form][j]) < kFalseAlarm)) {
        best = p;
        line = Line{f, f, 0.0, 0.0, static_cast<Form>(form), options.turn > 0.0};
      }
    }
  }
  return line;
}

std::pair<double, double> local(const Data& data, const FrequencyGrid& grid, const Residual& left,
                                const Line& line, std::size_t form) {
  const double at = line.f / grid.step;
  const double near = 1.0 / (grid.spread * grid.step);
  const double reach = std::max(10.0 * near, 0.15 * at);
  std::vector<double> around;
  std::vector<double> close;
  for (std::size_t j = std::max(std::max<std::size_t>(1, grid.lowest / 2),
                                static_cast<std::size_t>(std::max(1.0, at - reach)));
       j <= grid.highest && static_cast<double>(j) <= at + reach; ++j) {
    const double away = std::abs(static_cast<double>(j) - at) / near;
    if (away >= 1.0) around.push_back(left.power[form][j]);
    if (away >= 0.75 && away < 3.0) close.push_back(left.power[form][j]);
  }
  if (around.size() < 8) {
    around.assign(left.power[form].begin() + static_cast<std::ptrdiff_t>(grid.lowest),
                  left.power[form].end());
  }
  const double limit = 6.0 * stats::median(around) / std::log(2.0);
  double sum = 0.0;
  for (const double p : around) sum += std::min(p, limit);
  // A term that is not quite constant over the travel raises the background close to it.
  double own = 0.0;
  for (const double p : close) own += p / static_cast<double>(close.size());
  const double level = std::max(own, sum / static_cast<double>(around.size()));
  return {std::max(smallest(data), level * taken_by_passes(data, line)),
          std::max(2.0, static_cast<double>(around.size()) * grid.step * grid.spread)};
}

bool stands(const Data& data, const FrequencyGrid& grid, const Residual& left, const Line& line) {
  MatrixXd B(static_cast<Index>(data.groups.size()), 2);
  columns(data, line, B, false);
  if (!holds_in_other_passes(data, line, B, left.e)) return false;
  const double power = (line.a * B.col(0) + line.b * B.col(1)).squaredNorm();
  const auto [noise, lines] = local(data, grid, left, line, line.form);
  return all_lines(data, grid) * chance(power / noise, lines) < kFalseAlarm;
}

}  // namespace stribeck::ident::map::periodic
