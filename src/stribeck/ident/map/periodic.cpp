#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <limits>
#include <optional>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/map/periodic.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>
#include <unsupported/Eigen/FFT>

namespace stribeck::ident::map {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Index = Eigen::Index;
using Complex = std::complex<double>;
using friction::EccentricForm;

constexpr std::size_t kFewestGroups = 40;
constexpr double kMostPeriods = 2000.0;   ///< shortest period as a share of the way
constexpr double kGroupSpan = 1.0 / 6.0;  ///< of the shortest period: way over which rows are joined
/// Longer logs are searched for longer periods only: 0.2 s for a million rows.
constexpr double kMostGroups = 1.2e5;
constexpr double kBinSpan = 1.0 / 6.0;  ///< of the shortest period
constexpr double kOversampling = 4.0;   ///< of the spectrum
constexpr int kHighestOrder = 3;        ///< of the polynomial that each pass loses
constexpr double kSlow = 0.25;  ///< share of the residual that a wave too long to tell has: worth a word
constexpr double kTaper = 0.1;  ///< share of a pass at each end
/// Chance of a line that is none, over the whole spectrum.
constexpr double kFalseAlarm = 1e-3;
/// Lines that are as good as one at a whole part of a period that was found.
constexpr double kHarmonicTrials = 16.0;
constexpr int kHighestHarmonic = 12;
constexpr int kTries = 40;
/// Steps of Gauss–Newton end below these shares of the resolution.
constexpr double kRough = 1e-4;
constexpr double kFine = 1e-9;
/// Likelihood ratio e^5 between the two forms.
constexpr double kFormEvidence = 5.0;

enum Form : std::size_t { kSame, kReversing, kForms };

struct Group {
  double x = 0.0;       ///< mean
  double spread = 0.0;  ///< variance of x inside
  double e = 0.0;       ///< mean
  double weight = 0.0;  ///< rows, tapered
  double sign = 1.0;    ///< −1 in backward motion
};

struct Pass {
  std::size_t first = 0;
  std::size_t last = 0;  ///< one behind
};

/// A line in work: a·sin(2πf·u) + b·cos(2πf·u), u from the middle of the way.
struct Line {
  double f = 0.0;
  double start = 0.0;  ///< where the spectrum saw it
  double a = 0.0;
  double b = 0.0;
  Form form = kSame;
};

/// What the lines leave, and its spectrum.
struct Residual {
  VectorXd e;
  std::array<std::vector<double>, kForms> power, amplitude, background, lines;
};

std::string text(const char* format, auto... values) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

void check(const PeriodicRows& rows, const PeriodicOptions& options) {
  for (const double length : {options.shortest, options.longest, options.turn}) {
    if (!std::isfinite(length) || length < 0.0) {
      throw Refused(
          text("periodic terms: period of %g asked for, expected a positive one, or 0 for any", length));
    }
  }
  const std::size_t n = rows.x.size();
  if (rows.e.size() != n || rows.direction.size() != n || rows.record.size() != n || rows.at.size() != n) {
    throw Refused(text("periodic terms: columns of %zu, %zu, %zu, %zu and %zu rows, expected one length", n,
                       rows.e.size(), rows.direction.size(), rows.record.size(), rows.at.size()));
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(rows.x[i]) || !std::isfinite(rows.e[i])) {
      throw Refused(text("periodic terms: row %zu: position or residual is not a finite number", i));
    }
  }
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Chance that the mean of two of `lines` + 1 exponential powers exceeds the others as much: F(2, 2·lines).
double chance(double ratio, double lines) { return std::pow(1.0 + ratio / lines, -lines); }

class Search {
 public:
  Search(const PeriodicRows& rows, const PeriodicOptions& options) : rows_(rows), options_(options) {}

  PeriodicResult run() {
    check(rows_, options_);
    if (!measure() || !join()) return std::move(result_);
    prepare_passes();
    weights();
    if (!(total_ > 0.0)) {
      result_.notes.emplace_back("periodic terms: the residual is zero");
      return std::move(result_);
    }
    std::vector<Line> found;
    std::vector<double> rejected;
    spectrum();
    write_spectrum();
    bool any = true;
    for (int tries = 0; tries < kTries && static_cast<int>(found.size()) < options_.most; ++tries) {
      const auto line = strongest(found, rejected, any);
      any = false;
      if (!line) break;
      std::vector<Line> more = found;
      more.push_back(*line);
      const Residual before = now_;
      if (refine(more, kRough)) {
        spectrum();
        if (stands(more.back())) {
          found = std::move(more);
          any = true;
          continue;
        }
      }
      now_ = before;
      rejected.push_back(line->start);
    }
    report(found);
    return std::move(result_);
  }

 private:
  bool measure() {
    const std::size_t n = rows_.x.size();
    if (n < kFewestGroups) {
      result_.notes.push_back(
          text("periodic terms: %zu rows are too few, expected at least %zu", n, kFewestGroups));
      return false;
    }
    const auto [low, high] = std::minmax_element(rows_.x.begin(), rows_.x.end());
    low_ = *low;
    length_ = *high - *low;
    middle_ = 0.5 * (*low + *high);
    std::vector<double> steps;
    double path = 0.0;
    bool forward = false;
    bool backward = false;
    for (std::size_t i = 0; i < n; ++i) {
      forward |= rows_.direction[i] > 0;
      backward |= rows_.direction[i] < 0;
      if (i == 0 || rows_.record[i] != rows_.record[i - 1]) continue;
      const double d = std::abs(rows_.x[i] - rows_.x[i - 1]);
      if (d > 0.0) steps.push_back(d);
      path += std::min(d, length_ / kMostPeriods);
    }
    both_ = forward && backward;
    standstill_ = !forward && !backward;
    if (!(length_ > 0.0) || steps.empty()) {
      result_.notes.emplace_back("periodic terms: the axis does not move");
      return false;
    }
    shortest_ = options_.shortest > 0.0 ? options_.shortest
                                        : std::max({4.0 * median(std::move(steps)), length_ / kMostPeriods,
                                                    path / (kMostGroups * kGroupSpan)});
    longest_ = options_.longest > 0.0 ? options_.longest : length_ / 3.0;
    if (!(longest_ > 1.5 * shortest_)) {
      result_.notes.push_back(text(
          "periodic terms: the rows are %g apart on a travel of %g: no period lies between the shortest one that they show and a third of the travel; log faster or move farther",
          shortest_ / 4.0, length_));
      return false;
    }
    return true;
  }

  /// Rows of one pass over a short way become one group.
  bool join() {
    const double span = kGroupSpan * shortest_;
    std::size_t i = 0;
    const std::size_t n = rows_.x.size();
    groups_.reserve(std::min<std::size_t>(n, 1u << 16));
    passes_.clear();
    while (i < n) {
      const std::size_t begin = i;
      const double x0 = rows_.x[i];
      double sum_x = 0.0;
      double sum_xx = 0.0;
      double sum_e = 0.0;
      do {
        const double d = rows_.x[i] - x0;
        sum_x += d;
        sum_xx += d * d;
        sum_e += rows_.e[i];
        ++i;
      } while (i < n && same_pass(i) && std::abs(rows_.x[i] - x0) < span);
      if (begin == 0 || !same_pass(begin)) {
        if (!passes_.empty()) passes_.back().last = groups_.size();
        passes_.push_back({groups_.size(), 0});
      }
      const double count = static_cast<double>(i - begin);
      Group g;
      g.x = x0 + sum_x / count;
      g.spread = std::max(0.0, sum_xx / count - std::pow(sum_x / count, 2.0));
      g.e = sum_e / count;
      g.weight = count;
      g.sign = rows_.direction[begin] < 0 ? -1.0 : 1.0;
      groups_.push_back(g);
    }
    passes_.back().last = groups_.size();
    if (groups_.size() < kFewestGroups) {
      result_.notes.push_back(
          text("periodic terms: the rows cover %zu places of the travel, expected at least %zu",
               groups_.size(), kFewestGroups));
      return false;
    }
    return true;
  }

  /// Row i continues the pass of the row before. A jump over a part of the way begins a new one.
  [[nodiscard]] bool same_pass(std::size_t i) const {
    return rows_.record[i] == rows_.record[i - 1] && rows_.direction[i] == rows_.direction[i - 1] &&
           rows_.at[i] > rows_.at[i - 1] && std::abs(rows_.x[i] - rows_.x[i - 1]) < 0.25 * longest_;
  }

  /// Tapers, and an orthonormal basis of the polynomial of each pass under the weights.
  void prepare_passes() {
    const auto n = static_cast<Index>(groups_.size());
    root_.resize(n);
    basis_ = MatrixXd::Zero(n, kHighestOrder + 1);
    now_.e.resize(n);
    for (const Pass& p : passes_) {
      double low = groups_[p.first].x;
      double high = low;
      for (std::size_t i = p.first; i < p.last; ++i) {
        low = std::min(low, groups_[i].x);
        high = std::max(high, groups_[i].x);
      }
      const double way = high - low;
      // A part of the way at standstill has no reversals at its ends.
      const double edge = standstill_ ? 0.0 : kTaper * way;
      for (std::size_t i = p.first; i < p.last; ++i) {
        Group& g = groups_[i];
        const double from_end = std::min(g.x - low, high - g.x);
        if (from_end < edge) g.weight *= std::pow(std::sin(0.5 * kPi * (from_end + 0.01 * edge) / edge), 2.0);
        root_(static_cast<Index>(i)) = std::sqrt(g.weight);
      }
      const int order = std::min(kHighestOrder, static_cast<int>(way / longest_));
      const auto first = static_cast<Index>(p.first);
      const auto rows = static_cast<Index>(p.last - p.first);
      for (int k = 0; k <= order; ++k) {
        VectorXd q(rows);
        for (Index i = 0; i < rows; ++i) {
          const double u =
              way > 0.0 ? 2.0 * (groups_[p.first + static_cast<std::size_t>(i)].x - low) / way - 1.0 : 0.0;
          q(i) = root_(first + i) * std::pow(u, k);
        }
        const double before = q.norm();
        for (int twice = 0; twice < 2; ++twice) {
          for (int j = 0; j < k; ++j) {
            const auto other = basis_.block(first, j, rows, 1);
            q -= other * other.col(0).dot(q);
          }
        }
        if (q.norm() > 1e-9 * before) basis_.block(first, k, rows, 1) = q / q.norm();
      }
    }
    for (Index i = 0; i < n; ++i) now_.e(i) = root_(i) * groups_[static_cast<std::size_t>(i)].e;
    project(now_.e);
    data_ = now_.e;
    total_ = data_.squaredNorm();
  }

  /// Takes the polynomials out of a weighted column.
  void project(Eigen::Ref<VectorXd> column) const {
    for (const Pass& p : passes_) {
      const auto first = static_cast<Index>(p.first);
      const auto rows = static_cast<Index>(p.last - p.first);
      const auto q = basis_.middleRows(first, rows);
      const Eigen::Matrix<double, kHighestOrder + 1, 1> c = q.transpose() * column.segment(first, rows);
      column.segment(first, rows) -= q * c;
    }
  }

  /// Sums of weights over bins of position, both directions, as spectra.
  void weights() {
    const double width = kBinSpan * shortest_;
    const auto wanted = static_cast<std::size_t>(std::ceil(kOversampling * length_ / width));
    size_ = 64;
    while (size_ < wanted) size_ *= 2;
    step_ = 1.0 / (static_cast<double>(size_) * width);
    bin_.resize(groups_.size());
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      bin_[i] = std::min(size_ - 1, static_cast<std::size_t>((groups_[i].x - low_) / width));
    }
    std::vector<double> mass(groups_.size());
    double sum = 0.0, first = 0.0, second = 0.0;
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      const double u = groups_[i].x - middle_;
      mass[i] = groups_[i].weight;
      sum += mass[i];
      first += mass[i] * u;
      second += mass[i] * u * u;
    }
    spread_ = sum > 0.0 ? std::min(length_,
                                   std::sqrt(12.0 * std::max(0.0, second / sum - std::pow(first / sum, 2.0))))
                        : length_;
    transform(mass, weight_);
    lowest_ = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(1.0 / (longest_ * step_) - 1e-9)));
    highest_ = std::min(size_ / 2 - 1, static_cast<std::size_t>(1.0 / (shortest_ * step_)));
  }

  /// Spectra of a sum over groups, forward and backward, in one transformation.
  void transform(const std::vector<double>& values, std::array<std::vector<Complex>, 2>& out) {
    std::vector<Complex> binned(size_, 0.0);
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      binned[bin_[i]] += groups_[i].sign > 0.0 ? Complex(values[i], 0.0) : Complex(0.0, values[i]);
    }
    std::vector<Complex> z;
    fft_.fwd(z, binned);
    for (auto& o : out) o.resize(size_);
    for (std::size_t j = 0; j < size_; ++j) {
      const Complex other = std::conj(z[(size_ - j) % size_]);
      out[0][j] = 0.5 * (z[j] + other);
      out[1][j] = Complex(0.0, -0.5) * (z[j] - other);
    }
  }

  /// Power that a line takes out of the residual, and its amplitude, in both forms.
  void spectrum() {
    std::vector<double> moment(groups_.size());
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      moment[i] = root_(static_cast<Index>(i)) * now_.e(static_cast<Index>(i));
    }
    std::array<std::vector<Complex>, 2> z;
    transform(moment, z);
    for (std::size_t form = 0; form < kForms; ++form) {
      now_.power[form].assign(highest_ + 1, 0.0);
      now_.amplitude[form].assign(highest_ + 1, 0.0);
      if (form == kReversing && !both_) continue;
      const double sign = form == kSame ? 1.0 : -1.0;
      const double sum = weight_[0][0].real() + weight_[1][0].real();
      for (std::size_t j = 1; j <= highest_; ++j) {
        const Complex b = z[0][j] + sign * z[1][j];
        const Complex w = weight_[0][2 * j % size_] + weight_[1][2 * j % size_];
        const double cc = 0.5 * (sum + w.real());
        const double ss = 0.5 * (sum - w.real());
        const double cs = -0.5 * w.imag();
        const double det = cc * ss - cs * cs;
        if (!(det > 1e-6 * sum * sum)) continue;
        const double c = b.real();
        const double s = -b.imag();
        const double p = (ss * c - cs * s) / det;
        const double q = (cc * s - cs * c) / det;
        now_.power[form][j] = p * c + q * s;
        now_.amplitude[form][j] = std::hypot(p, q);
      }
      make_background(form);
    }
  }

  /// Background of a residual that is nothing but lines.
  [[nodiscard]] double smallest() const { return std::numeric_limits<double>::min() + 1e-20 * total_; }

  [[nodiscard]] double lines_per_bin() const { return step_ * length_; }

  /// Mean power of the lines around, from their median: the line itself and its neighbours do not lift it.
  void make_background(std::size_t form) {
    const double near = 12.0 / (length_ * step_);
    std::vector<double> at, level, lines;
    const double first = std::log(static_cast<double>(lowest_));
    const double last = std::log(static_cast<double>(highest_));
    constexpr int kAnchors = 48;
    for (int i = 0; i <= kAnchors; ++i) {
      const double j = std::exp(first + (last - first) * i / kAnchors);
      const auto low = static_cast<std::size_t>(
          std::max(0.6 * static_cast<double>(lowest_), std::min(j / 1.5, j - near)) + 1.0);
      const auto high = std::min(highest_, static_cast<std::size_t>(std::max(1.5 * j, j + near)));
      std::vector<double> part(now_.power[form].begin() + static_cast<std::ptrdiff_t>(low),
                               now_.power[form].begin() + static_cast<std::ptrdiff_t>(high) + 1);
      lines.push_back(std::max(2.0, static_cast<double>(part.size()) * lines_per_bin()));
      at.push_back(std::log(j));
      level.push_back(std::log(std::max(smallest(), median(std::move(part)) / std::log(2.0))));
    }
    now_.background[form].assign(highest_ + 1, 1.0);
    now_.lines[form].assign(highest_ + 1, 2.0);
    std::size_t k = 0;
    for (std::size_t j = lowest_; j <= highest_; ++j) {
      const double x = std::log(static_cast<double>(j));
      while (k + 2 < at.size() && at[k + 1] < x) ++k;
      const double share = at[k + 1] > at[k] ? std::clamp((x - at[k]) / (at[k + 1] - at[k]), 0.0, 1.0) : 0.0;
      now_.background[form][j] = std::exp(level[k] + share * (level[k + 1] - level[k]));
      now_.lines[form][j] = lines[k];
    }
  }

  /// The strongest line of all at first, for where a way is covered unevenly a line is its own background; then the strongest of
  /// those that stand out. (Not the one that stands out most: harmonics far above it do in a background that falls, and its side
  /// lobes would be taken for lines.)
  std::optional<Line> strongest(const std::vector<Line>& found, const std::vector<double>& rejected,
                                bool any) const {
    const double resolution = 1.0 / length_;
    double best = 0.0;
    std::optional<Line> line;
    for (std::size_t form = 0; form < (both_ ? kForms : kReversing); ++form) {
      for (std::size_t j = lowest_ + 1; j < highest_; ++j) {
        const double p = now_.power[form][j];
        if (p < now_.power[form][j - 1] || p < now_.power[form][j + 1]) continue;
        double f = static_cast<double>(j) * step_;
        if (options_.turn > 0.0) {
          const double whole = std::round(f * options_.turn) / options_.turn;
          if (std::abs(whole - f) > 0.3 * resolution) continue;
          f = whole;
        }
        double trials = all_lines();
        bool taken = false;
        for (const Line& other : found) {
          taken |=
              other.form == form && std::abs(other.f - f) < (options_.turn > 0.0 ? 0.7 : 2.0) * resolution;
          const double ratio = std::round(f / other.f);
          if (ratio >= 2.0 && ratio <= kHighestHarmonic && std::abs(f / ratio - other.f) < 0.3 * resolution) {
            trials = std::min(trials, kHarmonicTrials);
          }
        }
        for (const double other : rejected) taken |= std::abs(other - f) < resolution;
        if (taken) continue;
        if (p > best &&
            (any || trials * chance(p / now_.background[form][j], now_.lines[form][j]) < kFalseAlarm)) {
          best = p;
          line = Line{f, f, 0.0, 0.0, static_cast<Form>(form)};
        }
      }
    }
    return line;
  }

  [[nodiscard]] double damping(const Group& g, double f) const {
    return std::max(0.0, 1.0 - 0.5 * std::pow(2.0 * kPi * f, 2.0) * g.spread);
  }

  /// Weighted, projected columns sin, cos and, with amplitudes, ∂/∂f of a line.
  void columns(const Line& line, Eigen::Ref<MatrixXd> out, bool slope) const {
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      const auto k = static_cast<Index>(i);
      const Group& g = groups_[i];
      const double u = g.x - middle_;
      const double w = root_(k) * damping(g, line.f) * (line.form == kReversing ? g.sign : 1.0);
      const double s = w * std::sin(2.0 * kPi * line.f * u);
      const double c = w * std::cos(2.0 * kPi * line.f * u);
      out(k, 0) = s;
      out(k, 1) = c;
      if (slope) out(k, 2) = 2.0 * kPi * u * (line.a * c - line.b * s);
    }
    for (Index j = 0; j < (slope ? 3 : 2); ++j) project(out.col(j));
  }

  /// All lines together; false when one runs away. Leaves now_.e and, per line, the unscaled covariance.
  bool refine(std::vector<Line>& lines, double tolerance) {
    const auto n = static_cast<Index>(groups_.size());
    const auto count = static_cast<Index>(lines.size());
    now_.e = data_;
    if (lines.empty()) return true;
    constexpr int kIterations = 12;
    const bool exact = options_.turn > 0.0;
    MatrixXd X(n, 3 * count);
    for (int iteration = 0; iteration <= kIterations; ++iteration) {
      // Amplitudes at these periods, then one step of the periods.
      const auto linear = [&] {
        MatrixXd B(n, 2 * count);
        for (Index j = 0; j < count; ++j) B.middleCols(2 * j, 2) = X.middleCols(3 * j, 2);
        const MatrixXd gram = B.transpose() * B;
        const VectorXd theta = gram.ldlt().solve(B.transpose() * data_);
        for (Index j = 0; j < count; ++j) {
          lines[static_cast<std::size_t>(j)].a = theta(2 * j);
          lines[static_cast<std::size_t>(j)].b = theta(2 * j + 1);
        }
        now_.e = data_ - B * theta;
        return theta.allFinite();
      };
      for (Index j = 0; j < count; ++j)
        columns(lines[static_cast<std::size_t>(j)], X.middleCols(3 * j, 3), false);
      if (!linear()) return false;
      if (iteration == kIterations || exact) break;
      for (Index j = 0; j < count; ++j)
        columns(lines[static_cast<std::size_t>(j)], X.middleCols(3 * j, 3), true);
      const MatrixXd gram = X.transpose() * X;
      const VectorXd step = gram.ldlt().solve(X.transpose() * now_.e);
      if (!step.allFinite()) return false;
      double largest = 0.0;
      for (Index j = 0; j < count; ++j) {
        Line& line = lines[static_cast<std::size_t>(j)];
        const double limit = 0.2 / length_;
        const double d = std::clamp(step(3 * j + 2), -limit, limit);
        line.f += d;
        largest = std::max(largest, std::abs(d) * length_);
        if (std::abs(line.f - line.start) > 1.0 / length_ || !(line.f > 0.0)) return false;
      }
      if (largest < tolerance) break;
    }
    return true;
  }

  /// The spectrum divides by the whole weight, but passes that are not longer than the period lose most of a line to their polynomial,
  /// and of the noise as much: whole weight over what is left of it at this period.
  [[nodiscard]] double taken_by_passes(const Line& line) const {
    MatrixXd B(static_cast<Index>(groups_.size()), 2);
    columns(line, B, false);
    double whole = 0.0;
    for (const Group& g : groups_) whole += g.weight * std::pow(damping(g, line.f), 2.0);
    return whole / B.squaredNorm();
  }

  /// Mean power of the residual around a line, and from how many lines it is taken.
  [[nodiscard]] std::pair<double, double> local(const Line& line, std::size_t form) const {
    const double at = line.f / step_;
    const double near = 1.0 / (spread_ * step_);
    const double reach = std::max(10.0 * near, 0.15 * at);
    std::vector<double> around;
    std::vector<double> close;
    for (std::size_t j = std::max(std::max<std::size_t>(1, lowest_ / 2),
                                  static_cast<std::size_t>(std::max(1.0, at - reach)));
         j <= highest_ && static_cast<double>(j) <= at + reach; ++j) {
      const double away = std::abs(static_cast<double>(j) - at) / near;
      if (away >= 1.0) around.push_back(now_.power[form][j]);
      if (away >= 0.75 && away < 3.0) close.push_back(now_.power[form][j]);
    }
    if (around.size() < 8) {
      around.assign(now_.power[form].begin() + static_cast<std::ptrdiff_t>(lowest_), now_.power[form].end());
    }
    const double limit = 6.0 * median(around) / std::log(2.0);
    double sum = 0.0;
    for (const double p : around) sum += std::min(p, limit);
    // A line that is not quite constant over the way leaves its own background close by.
    double own = 0.0;
    for (const double p : close) own += p / static_cast<double>(close.size());
    const double level = std::max(own, sum / static_cast<double>(around.size()));
    return {std::max(smallest(), level * taken_by_passes(line)),
            std::max(2.0, static_cast<double>(around.size()) * step_ * spread_)};
  }

  [[nodiscard]] double all_lines() const {
    return std::max(1.0, static_cast<double>(highest_ - lowest_) * lines_per_bin() * (both_ ? 2.0 : 1.0));
  }

  /// What a line takes out, with its background on itself known.
  [[nodiscard]] bool stands(const Line& line) const {
    MatrixXd B(static_cast<Index>(groups_.size()), 2);
    columns(line, B, false);
    const double power = (line.a * B.col(0) + line.b * B.col(1)).squaredNorm();
    const auto [noise, lines] = local(line, line.form);
    return all_lines() * chance(power / noise, lines) < kFalseAlarm;
  }

  void report(std::vector<Line>& found) {
    if (found.empty()) {
      too_long();
      if (!both_ && !standstill_) one_direction();
      return;
    }
    refine(found, kFine);
    spectrum();
    const auto n = static_cast<Index>(groups_.size());
    const auto count = static_cast<Index>(found.size());
    MatrixXd X(n, 3 * count);
    for (Index j = 0; j < count; ++j)
      columns(found[static_cast<std::size_t>(j)], X.middleCols(3 * j, 3), true);
    MatrixXd gram = X.transpose() * X;
    const bool exact = options_.turn > 0.0;
    if (exact) {
      // Periods are given: their columns stand apart.
      for (Index j = 0; j < count; ++j) {
        gram.row(3 * j + 2).setZero();
        gram.col(3 * j + 2).setZero();
        gram(3 * j + 2, 3 * j + 2) = 1.0;
      }
    }
    const VectorXd scale = gram.diagonal().cwiseSqrt();
    const MatrixXd inverse = (scale.asDiagonal().inverse() * gram * scale.asDiagonal().inverse()).inverse();
    for (Index j = 0; j < count; ++j) {
      const Line& line = found[static_cast<std::size_t>(j)];
      Eigen::Matrix3d C;
      for (Index p = 0; p < 3; ++p) {
        for (Index q = 0; q < 3; ++q) {
          C(p, q) = inverse(3 * j + p, 3 * j + q) / (scale(3 * j + p) * scale(3 * j + q));
        }
      }
      if (exact) C(2, 2) = 0.0;
      result_.terms.push_back(term_of(line, C, X, j));
    }
    std::stable_sort(result_.terms.begin(), result_.terms.end(),
                     [](const auto& a, const auto& b) { return a.term.amplitude > b.term.amplitude; });
    number_harmonics();
    if (!both_ && !standstill_) one_direction();
    bool mixed = false;
    for (const Line& a : found) {
      for (const Line& b : found) mixed |= a.form < b.form && std::abs(a.f - b.f) < 1.0 / length_;
    }
    if (mixed) {
      result_.notes.emplace_back(
          "periodic terms: one period has a part that keeps its sign and one that reverses with the "
          "direction; a delay between force and position looks the same");
    }
  }

  /// A wave of more than the longest period that explains much of the residual: it may be one, or a drift.
  void too_long() {
    constexpr int kWaves = 24;
    constexpr std::size_t kEnough = 5000;  // groups: the waves are long
    const std::size_t stride = groups_.size() / kEnough + 1;
    double best = 0.0;
    for (int k = 0; k < kWaves; ++k) {
      const double f = (0.75 + (length_ / longest_ - 0.75) * k / kWaves) / length_;
      for (const Form form : {kSame, kReversing}) {
        if (form == kReversing && !both_) continue;
        // e, sin, cos about their means in each pass.
        Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
        for (const Pass& p : passes_) {
          double weight = 0.0;
          Eigen::Vector3d sum = Eigen::Vector3d::Zero();
          for (std::size_t i = p.first; i < p.last; i += stride) {
            const Group& g = groups_[i];
            const double angle = 2.0 * kPi * f * (g.x - middle_);
            const double sign = form == kReversing ? g.sign : 1.0;
            const Eigen::Vector3d b(g.e, sign * std::sin(angle), sign * std::cos(angle));
            weight += g.weight;
            sum += g.weight * b;
            gram += g.weight * b * b.transpose();
          }
          if (weight > 0.0) gram -= sum * sum.transpose() / weight;
        }
        const Eigen::Vector2d moment = gram.block<2, 1>(1, 0);
        const double taken = moment.dot(gram.block<2, 2>(1, 1).ldlt().solve(moment));
        if (gram(0, 0) > 0.0 && taken > best * gram(0, 0)) best = taken / gram(0, 0);
      }
    }
    if (!(best > kSlow)) return;
    result_.cannot_tell.push_back(text(
        "periodic terms of more than %.3g mm, which do not fit three times into %.3g mm of travel: a slow change with the position is %.0f %% of the residual; move farther",
        1e3 * longest_, 1e3 * length_, 100.0 * best));
  }

  void one_direction() {
    result_.cannot_tell.emplace_back(
        "periodic terms: whether they reverse with the direction cannot be told: one direction only");
  }

  PeriodicTerm term_of(const Line& line, const Eigen::Matrix3d& C, const MatrixXd& X, Index j) {
    PeriodicTerm t;
    const double A = std::hypot(line.a, line.b);
    const double psi = std::atan2(line.b, line.a);
    t.term.amplitude = A;
    t.term.period = 1.0 / line.f;
    t.term.phase = std::remainder(2.0 * kPi * line.f * middle_ - psi, 2.0 * kPi);
    t.term.form = line.form == kSame ? EccentricForm::kAdditive : EccentricForm::kProportional;
    const auto background = local(line, line.form);
    const double noise = background.first;
    const double factor = stats::student_factor(std::min(1e4, 2.0 * background.second));
    const auto half = [&](const Eigen::Vector3d& g) {
      return factor * std::sqrt(0.5 * noise * std::max(0.0, g.dot(C * g)));
    };
    const double amplitude = half({line.a / A, line.b / A, 0.0});
    const double frequency = half({0.0, 0.0, 1.0});
    const double phase = half({line.b / (A * A), -line.a / (A * A), 2.0 * kPi * middle_});
    t.amplitude = {A - amplitude, A + amplitude};
    t.period = {t.term.period * (1.0 - frequency / line.f), t.term.period * (1.0 + frequency / line.f)};
    t.phase = {t.term.phase - phase, t.term.phase + phase};

    // Both forms against the residual with this line put back.
    const VectorXd own = X.col(3 * j) * line.a + X.col(3 * j + 1) * line.b;
    const VectorXd e = now_.e + own;
    const auto taken = [&](Form form) {
      Line other = line;
      other.form = form;
      MatrixXd B(X.rows(), 3);
      columns(other, B, false);
      const Eigen::Matrix2d gram = B.leftCols(2).transpose() * B.leftCols(2);
      const Eigen::Vector2d moment = B.leftCols(2).transpose() * e;
      return moment.dot(gram.ldlt().solve(moment));
    };
    const double power = taken(line.form);
    t.share = std::clamp(power / total_, 0.0, 1.0);
    t.signal_to_background = std::sqrt(power / noise);
    if (both_) {
      const double other = taken(line.form == kSame ? kReversing : kSame);
      const double level = std::max(noise, local(line, line.form == kSame ? kReversing : kSame).first);
      t.form_told = power - other > kFormEvidence * level;
      if (!t.form_told) {
        result_.cannot_tell.push_back(text(
            "periodic terms: the data do not tell whether the term of period %g reverses with the direction",
            t.term.period));
      }
    } else {
      // Held at standstill there is no direction to reverse with.
      t.form_told = standstill_;
    }
    return t;
  }

  /// Each term belongs to the longest period that it divides.
  void number_harmonics() {
    for (PeriodicTerm& t : result_.terms) {
      double longest = t.term.period;
      for (const PeriodicTerm& other : result_.terms) {
        const double ratio = other.term.period / t.term.period;
        const double whole = std::round(ratio);
        const double tolerance = std::max(0.2 * other.term.period / length_,
                                          (other.period.high - other.period.low) / other.term.period);
        if (other.term.period > longest && whole >= 2.0 && whole <= kHighestHarmonic &&
            std::abs(ratio / whole - 1.0) < tolerance) {
          longest = other.term.period;
          t.harmonic = static_cast<int>(whole);
        }
      }
      if (options_.turn > 0.0) t.harmonic = static_cast<int>(std::lround(options_.turn / t.term.period));
    }
  }

  /// At most 400 lines, each the largest of its neighbourhood.
  void write_spectrum() {
    constexpr int kLines = 400;
    const double ratio = static_cast<double>(highest_) / static_cast<double>(lowest_);
    std::vector<SpectrumLine> lines;
    std::size_t j = lowest_;
    for (int i = 1; i <= kLines && j <= highest_; ++i) {
      const double end = static_cast<double>(lowest_) * std::pow(ratio, static_cast<double>(i) / kLines);
      SpectrumLine line;
      for (; j <= highest_ && static_cast<double>(j) <= end + 1e-9; ++j) {
        const double a = std::max(now_.amplitude[kSame][j], now_.amplitude[kReversing][j]);
        if (line.period == 0.0 || a > line.amplitude) line = {1.0 / (static_cast<double>(j) * step_), a};
      }
      if (line.period > 0.0) lines.push_back(line);
    }
    result_.spectrum.assign(lines.rbegin(), lines.rend());
  }

  const PeriodicRows& rows_;
  const PeriodicOptions& options_;
  PeriodicResult result_;
  double low_ = 0.0;
  double length_ = 0.0;
  double spread_ = 0.0;  // length of a way covered evenly that would tell periods as well
  double middle_ = 0.0;
  double shortest_ = 0.0;
  double longest_ = 0.0;
  bool both_ = false;
  bool standstill_ = false;
  std::vector<Group> groups_;
  std::vector<Pass> passes_;
  VectorXd root_;   // of the weights
  MatrixXd basis_;  // of the polynomials, by pass
  VectorXd data_;   // weighted, projected
  Residual now_;    // data_ less the lines
  double total_ = 0.0;
  std::size_t size_ = 0;  // of the transformation
  double step_ = 0.0;     // of frequency [1/m]
  std::size_t lowest_ = 1;
  std::size_t highest_ = 1;
  std::vector<std::size_t> bin_;
  Eigen::FFT<double> fft_;
  std::array<std::vector<Complex>, 2> weight_;
};

}  // namespace

PeriodicResult find_periodic(const PeriodicRows& rows, const PeriodicOptions& options) {
  return Search(rows, options).run();
}

}  // namespace stribeck::ident::map
