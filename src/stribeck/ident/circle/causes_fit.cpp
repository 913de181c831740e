#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/causes_parts.hpp>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::circle {
namespace {

constexpr double kDegree = kPi / 180.0;

/// Mean over the laps of each step: what repeats from lap to lap, with fewer rows for the search of a pitch.
CauseRows mean_laps(const CauseRows& all) {
  CauseRows out = all;
  out.rows.clear();
  const int steps = static_cast<int>(std::floor(2.0 * kPi / all.step));
  std::vector<double> angle;
  std::vector<double> error;
  std::vector<double> progress;
  std::vector<CauseRow> cells;
  const auto close = [&] {
    for (std::size_t k = 0; k < cells.size(); ++k) {
      if (cells[k].samples == 0) continue;
      cells[k].angle = angle[k] / cells[k].samples;
      cells[k].error = error[k] / cells[k].samples;
      cells[k].progress = progress[k] / cells[k].samples;
      out.rows.push_back(cells[k]);
    }
  };
  int run = -1;
  for (const CauseRow& row : all.rows) {
    if (row.run != run) {
      close();
      run = row.run;
      cells.assign(static_cast<std::size_t>(steps), CauseRow{});
      angle.assign(cells.size(), 0.0);
      error.assign(cells.size(), 0.0);
      progress.assign(cells.size(), 0.0);
    }
    // Laps are brought to the same angles; a lap is no whole number of steps.
    const double within = row.angle - 2.0 * kPi * std::floor(row.angle / (2.0 * kPi));
    const auto k = std::min(static_cast<std::size_t>(within / all.step), cells.size() - 1);
    const int samples = cells[k].samples;
    cells[k] = row;
    cells[k].at = k;
    cells[k].samples = samples + 1;
    angle[k] += within;
    error[k] += row.error;
    progress[k] += row.progress;
  }
  close();
  return out;
}

/// For each of `count` pitches, `first`, `first` + `step`, … periods per metre: how much its two columns lower the squared rest.
std::vector<double> gains_of(const CauseFit& fit, const CauseRows& rows, int axis, double first, double step,
                             Eigen::Index count) {
  const Eigen::Index n = fit.rest.size();
  Eigen::MatrixXd waves(n, 2 * count);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double a = rows.rows[fit.used[static_cast<std::size_t>(i)]].angle;
    const double along = axis == 0 ? std::cos(a) : std::sin(a);
    const double travel = 2.0 * kPi * rows.radius * along;
    std::complex<double> wave = along * std::polar(1.0, travel * first);
    // From one pitch to the next the phase of a row turns by the same angle. The product is written out: that of std::complex looks
    // for NaN each time.
    const std::complex<double> turn = count > 1 ? std::polar(1.0, travel * step) : 1.0;
    for (Eigen::Index k = 0; k < count; ++k) {
      waves(i, 2 * k) = wave.real();
      waves(i, 2 * k + 1) = wave.imag();
      wave = {wave.real() * turn.real() - wave.imag() * turn.imag(),
              wave.real() * turn.imag() + wave.imag() * turn.real()};
    }
  }
  // Only what the other columns do not explain already counts.
  const Eigen::MatrixXd cross = fit.X.transpose() * waves;
  const Eigen::MatrixXd explained = fit.inverse * cross;
  const Eigen::VectorXd with = waves.transpose() * fit.rest;
  std::vector<double> out(static_cast<std::size_t>(count), 0.0);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto two = waves.middleCols(2 * k, 2);
    const Eigen::Matrix2d own =
        two.transpose() * two - cross.middleCols(2 * k, 2).transpose() * explained.middleCols(2 * k, 2);
    const Eigen::Vector2d y = with.segment(2 * k, 2);
    const double det = own(0, 0) * own(1, 1) - own(0, 1) * own(1, 0);
    if (!(det > 1e-6 * own(0, 0) * own(1, 1))) continue;
    out[static_cast<std::size_t>(k)] =
        (y(0) * y(0) * own(1, 1) - 2.0 * y(0) * y(1) * own(0, 1) + y(1) * y(1) * own(0, 0)) / det;
  }
  return out;
}

/// The pitch that lowers the rest most, beside those that are known.
class PitchSearch {
 public:
  PitchSearch(const CauseRows& rows, const std::vector<Pitch>& known)
      : rows_(rows), known_(known), fit_(fit_with_window(rows, design_of(rows, known))) {}

  void over_all(double step) {
    if (fit_.rest.size() == 0) return;
    const double slow = 1.25 / rows_.radius;
    for (const int axis : {0, 1}) {
      for (double f = slow; f <= fastest(); f += static_cast<double>(kAtOnce) * step) {
        const std::vector<double> gains = gains_of(fit_, rows_, axis, f, step, kAtOnce);
        for (Eigen::Index k = 0; k < kAtOnce; ++k) {
          const double at = f + static_cast<double>(k) * step;
          if (at <= fastest() && !is_known(axis, at)) take(axis, at, gains[static_cast<std::size_t>(k)]);
        }
      }
    }
  }
  void from(const Pitch& pitch) {
    take(pitch.axis, 1.0 / pitch.length,
         gains_of(fit_, rows_, pitch.axis, 1.0 / pitch.length, 0.0, 1).front());
  }
  void finer(double step) {
    for (double finer = 0.25 * step; finer > 0.001 * step && gain_ > 0.0; finer *= 0.5) {
      const double f = 1.0 / best_.length;
      const std::vector<double> gains = gains_of(fit_, rows_, best_.axis, f - finer, 2.0 * finer, 2);
      take(best_.axis, f - finer, gains[0]);
      take(best_.axis, f + finer, gains[1]);
    }
  }
  [[nodiscard]] bool clear(double times) const {
    if (!(gain_ > 0.0)) return false;
    const auto count = static_cast<double>(fit_.rest.size());
    return gain_ >= times * std::max(fit_.variance * count - gain_, 0.0) / count;
  }
  /// A pitch at the upper end of the search may be the alias of a shorter one.
  [[nodiscard]] bool at_the_end() const {
    return gain_ > 0.0 && 1.0 / best_.length > fastest() - kApart / rows_.radius;
  }
  [[nodiscard]] const Pitch& best() const { return best_; }

 private:
  static constexpr double kApart = 0.75;
  static constexpr Eigen::Index kAtOnce = 16;

  /// Four steps in a period.
  [[nodiscard]] double fastest() const { return 0.25 / (rows_.radius * rows_.step); }
  /// Two pitches of one axis are told apart where they differ by most of a period over the diameter.
  [[nodiscard]] bool is_known(int axis, double per_metre) const {
    return std::any_of(known_.begin(), known_.end(), [&](const Pitch& p) {
      return p.axis == axis && std::abs(1.0 / p.length - per_metre) < kApart / rows_.radius;
    });
  }
  void take(int axis, double per_metre, double gain) {
    if (gain <= gain_) return;
    gain_ = gain;
    best_ = {axis, 1.0 / per_metre};
  }

  const CauseRows& rows_;
  std::vector<Pitch> known_;
  CauseFit fit_;
  double gain_ = 0.0;
  Pitch best_;
};

/// The windows of a fit.
class WindowSearch {
 public:
  WindowSearch(const CauseRows& rows, const Design& design) : rows_(rows), design_(design) {}

  /// The same for both axes.
  [[nodiscard]] CauseFit common() const {
    std::vector<CauseFit> fits;
    double least = HUGE_VAL;
    for (const double degrees : kWindows) {
      fits.push_back(with(degrees * kDegree, degrees * kDegree));
      if (fits.back().rest.size() > 0) least = std::min(least, fits.back().variance);
    }
    for (CauseFit& fit : fits) {
      if (fit.rest.size() > 0 && fit.variance <= kChance * least) return std::move(fit);
    }
    return std::move(fits.front());
  }
  /// Peaks that reach farther, of one axis or of both.
  [[nodiscard]] CauseFit wider(CauseFit fit) const {
    constexpr double kClear = 0.8;
    const double before = fit.variance;
    for (const double degrees : {45.0, 60.0}) {
      const double w = degrees * kDegree;
      CauseFit best;
      for (const Windows& tried : {Windows{w, fit.windows[1]}, Windows{fit.windows[0], w}, Windows{w, w}}) {
        CauseFit other = with(tried[0], tried[1]);
        if (other.rest.size() == 0 || is_against_itself(other)) continue;
        if (best.rest.size() == 0 || other.variance * kChance < best.variance) best = std::move(other);
      }
      if (best.rest.size() > 0 && best.variance < kClear * std::min(before, fit.variance))
        fit = std::move(best);
    }
    return fit;
  }
  /// The axis whose peaks are short.
  [[nodiscard]] CauseFit shorter_of_one_axis(CauseFit fit) const {
    const double most = kChance * fit.variance;
    for (const std::size_t axis : {0U, 1U}) {
      for (const double degrees : kWindows) {
        Windows tried = fit.windows;
        tried[axis] = degrees * kDegree;
        if (tried[axis] >= fit.windows[axis]) break;
        CauseFit other = with(tried[0], tried[1]);
        if (other.rest.size() == 0 || other.variance > most) continue;
        fit = std::move(other);
        break;
      }
    }
    return fit;
  }

 private:
  /// Whether columns are larger than the error that they explain: with so little of each quadrant left they take each other away.
  [[nodiscard]] bool is_against_itself(const CauseFit& fit) const {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const CauseRow& row : rows_.rows) low = std::min(low, row.error), high = std::max(high, row.error);
    for (Eigen::Index j = 0; j < fit.X.cols(); ++j) {
      if (fit.X.col(j).cwiseAbs().maxCoeff() * std::abs(fit.coefficients(j)) > high - low) return true;
    }
    return false;
  }
  static constexpr std::array<double, 8> kWindows{2.0, 4.0, 6.0, 9.0, 13.0, 18.0, 24.0, 32.0};
  // What is left of a peak outside the window raises the variance; this much is chance.
  static constexpr double kChance = 1.03;

  [[nodiscard]] CauseFit with(double x, double y) const { return fit_causes(rows_, design_, {x, y}); }

  const CauseRows& rows_;
  const Design& design_;
};

}  // namespace

CauseFit fit_causes(const CauseRows& rows, const Design& design, const Windows& windows, double before) {
  CauseFit fit;
  fit.windows = windows;
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    const double behind = after_reversal(rows.rows[i]);
    const double window = windows[static_cast<std::size_t>(last_border(rows.rows[i]) % 2)];
    if (behind >= window && behind <= 0.5 * kPi - before) fit.used.push_back(i);
  }
  const auto n = static_cast<Eigen::Index>(fit.used.size());
  const int p = design.columns.count;
  if (n < 2 * p) return fit;
  fit.X.resize(n, p);
  Eigen::VectorXd y(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t row = fit.used[static_cast<std::size_t>(i)];
    fit.X.row(i) = design.X.row(static_cast<Eigen::Index>(row));
    y(i) = rows.rows[row].error;
  }
  fit.inverse = stats::inverse(stats::gram(fit.X));
  fit.coefficients = fit.inverse * (fit.X.transpose() * y);
  fit.rest = y - fit.X * fit.coefficients;
  fit.variance = fit.rest.squaredNorm() / static_cast<double>(n - p);
  return fit;
}

CauseFit fit_with_window(const CauseRows& rows, const Design& design) {
  WindowSearch search(rows, design);
  CauseFit fit = search.common();
  // Short windows leave nothing out that matters; from one direction the few rows behind long ones do not tell the causes apart.
  constexpr double kLong = 12.0 * kDegree;
  if (fit.rest.size() == 0 || fit.window() < kLong || !rows.both_directions) return fit;
  fit = search.wider(std::move(fit));
  return search.shorter_of_one_axis(std::move(fit));
}

bool centre_drifts(const CauseRows& rows) {
  constexpr double kWindow = 13.0 * kDegree;
  constexpr double kMuch = 0.85;    // of the variance is left
  constexpr double kCertain = 4.0;  // standard errors
  constexpr double kAlike = 10.0;   // neighbours resemble each other: as if ten rows were one
  CauseRows with = rows;
  with.drifts = true;
  const Windows windows{kWindow, kWindow};
  const CauseFit plain = fit_causes(rows, design_of(rows, {}), windows);
  const Design design = design_of(with, {});
  const CauseFit fit = fit_causes(with, design, windows);
  if (plain.rest.size() == 0 || fit.rest.size() == 0 || !fit.coefficients.allFinite() ||
      !(fit.variance < kMuch * plain.variance))
    return false;
  return std::any_of(design.columns.causes.begin(), design.columns.causes.end(), [&](const CauseColumns& c) {
    if (c.kind != CauseKind::kDrift) return false;
    const double error =
        std::sqrt(kAlike * fit.variance *
                  std::max(fit.inverse(c.first, c.first), fit.inverse(c.first + 1, c.first + 1)));
    return std::hypot(fit.coefficients(c.first), fit.coefficients(c.first + 1)) > kCertain * error;
  });
}

std::vector<Pitch> find_pitches(const CauseRows& all) {
  constexpr std::size_t kMost = 2;
  // The square of the rest that a pure chance takes off is chi-squared with two degrees of freedom, the largest of some hundred
  // pitches about 13; rows that resemble their neighbours take off more.
  constexpr double kClear = 40.0;
  const CauseRows rows = mean_laps(all);
  const double step = 1.0 / (10.0 * rows.radius);
  std::vector<Pitch> found;
  while (found.size() < kMost) {
    PitchSearch search(rows, found);
    search.over_all(step);
    search.finer(step);
    if (!search.clear(kClear) || search.at_the_end()) break;
    found.push_back(search.best());
  }
  // Searches each pitch again with the others in the fit, until none moves: what one of them leaves was in the first search of the other.
  constexpr int kPasses = 8;
  constexpr double kStill = 1e-3;  // of a step
  for (int pass = 0; pass < (found.size() > 1 ? kPasses : 1); ++pass) {
    double moved = 0.0;
    for (std::size_t k = 0; k < found.size(); ++k) {
      std::vector<Pitch> others = found;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
      PitchSearch search(rows, others);
      search.from(found[k]);
      search.finer(step);
      moved = std::max(moved, std::abs(1.0 / search.best().length - 1.0 / found[k].length) / step);
      found[k] = search.best();
    }
    if (moved < kStill) break;
  }
  return found;
}

std::vector<double> rest_of_rows(const CauseRows& rows, const Design& design, const CauseFit& fit) {
  const Eigen::VectorXd fitted = design.X * fit.coefficients;
  std::vector<double> rest;
  for (std::size_t i = 0; i < rows.rows.size(); ++i)
    rest.push_back(rows.rows[i].error - fitted(static_cast<Eigen::Index>(i)));
  return rest;
}

}  // namespace stribeck::ident::circle
