#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stribeck/ident/drive/shift.hpp>
#include <stribeck/ident/drive/smoothing/before_filter.hpp>
#include <stribeck/ident/drive/smoothing/filter_search.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>
#include <utility>
#include <vector>

namespace stribeck::ident::drive {
namespace {

// In rows.
constexpr double kLeastDelay = 0.75;
constexpr double kLeastTime = 0.5;
constexpr double kSameTime = 0.02;

constexpr double kKnown =
    0.04;  ///< of the time: error of the slope, and of a filter that is not quite of first order
constexpr double kVague = 0.3;        ///< half width as a share of the time
constexpr double kCertain = 2.5;      ///< standard errors of the difference of two residuals
constexpr double kLeastPart = 0.01;   ///< of the squares of the slow residual
constexpr double kMuch = 0.3;         ///< the same, where nearly all strong ones are less
constexpr double kGridPiece = 3.0;    ///< of the slow residual, in delays
constexpr double kPiece = 5.0;        ///< of the slow residual, in times of the filter
constexpr std::size_t kFewest = 100;  ///< rows with a column
constexpr std::size_t kFewestPieces = 30;

/// A value at every row of every record; records without have no values.
using Column = std::vector<std::vector<double>>;

/// Behind a filter of first order that begins settled; `time` in rows.
void pass(std::vector<double>& f, double time) {
  const double share = 1.0 - std::exp(-1.0 / time);
  double y = f.empty() ? 0.0 : f.front();
  for (double& value : f) value = y += share * (value - y);
}

/// d/dt G_τ[f̂] at every row [N], by row.
Column slope_of_filtered(const AlignedLog& log, const Terms& terms, const LinearFit& fit, double time) {
  Column out(log.records.size());
  for (std::size_t r = 0; r < out.size(); ++r) {
    if (log.predicted[r].empty()) continue;
    std::vector<double> f(log.motions[r].rows());
    for (std::size_t k = 0; k < f.size(); ++k) f[k] = asked_force(log, terms, fit, r, k);
    pass(f, time);
    out[r].assign(f.size(), 0.0);
    for (std::size_t k = 1; k + 1 < f.size(); ++k) out[r][k] = 0.5 * (f[k + 1] - f[k - 1]);
  }
  return out;
}

/// A column about the means of its bins, less what the columns of the fit take of it, at the rows that have one.
struct Beside {
  std::vector<std::size_t> used;
  VectorXd column;
  VectorXd moved;  ///< what one unit of the column adds to each linear term
};

std::optional<Beside> beside_fit(const AlignedLog& log, const Rows& rows, const Terms& terms,
                                 const LinearFit& fit, const Column& column) {
  Beside out;
  std::array<std::vector<double>, map::kSides> sum, count;
  for (std::size_t s = 0; s < map::kSides; ++s)
    sum[s].assign(static_cast<std::size_t>(rows.grid[s].bins), 0.0), count[s] = sum[s];
  const auto value = [&](std::size_t i) {
    return column[static_cast<std::size_t>(rows.record[i])][rows.at[i]];
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (column[static_cast<std::size_t>(rows.record[i])].empty()) continue;
    out.used.push_back(i);
    sum[rows.side[i]][static_cast<std::size_t>(rows.bin[i])] += value(i);
    count[rows.side[i]][static_cast<std::size_t>(rows.bin[i])] += 1.0;
  }
  if (out.used.size() < kFewest) return {};
  const auto n = static_cast<Index>(out.used.size()), q = static_cast<Index>(terms.count());
  MatrixXd X(n, q), Z(n, q);
  out.column.resize(n);
  std::vector<double> row(terms.count() + 1);
  for (Index k = 0; k < n; ++k) {
    const std::size_t i = out.used[static_cast<std::size_t>(k)], s = rows.side[i];
    const auto b = static_cast<std::size_t>(rows.bin[i]);
    out.column(k) = value(i) - sum[s][b] / count[s][b];
    if (q == 0) continue;
    terms.fill(log, rows, i, row.data());
    X.row(k) = Eigen::Map<const VectorXd>(row.data(), q);
    const BinSums means = fit.sums.of(s, b);
    X.row(k) -= means.first(terms.count()) / means.rows();
    Z.row(k) = X.row(k);
    if (!terms.known_mass && fit.multiplier.front() != 0)
      Z(k, 0) = mass_instrument(log, rows, fit, i) - means.mass_instrument() / means.rows();
    if (terms.shift)
      Z(k, q - 1) =
          shift_instrument(log, rows, i, row[terms.count() - 1]) - means.shift_instrument() / means.rows();
  }
  out.moved = VectorXd::Zero(q);
  if (q > 0) {
    const std::optional<VectorXd> moved =
        stats::solve_if_regular(Z.transpose() * X, Z.transpose() * out.column);
    const std::optional<VectorXd> taken =
        stats::solve_if_regular(X.transpose() * Z, X.transpose() * out.column);
    if (!moved || !taken) return {};
    out.moved = *moved;
    // Only instruments, so that no noise of the motion is in it.
    out.column -= Z * *taken;
  }
  if (!(out.column.squaredNorm() > 0.0)) return {};
  return out;
}

/// A correction of the time and its 95 % half width [rows].
struct Step {
  double by = 0.0;
  double half_width = 0.0;
};

/// Whether nearly all values of one residual that are more than noise, in either of two, are smaller than those of the other. Noise is
/// what half of the values stay below; taking a filter off makes more of it.
bool strong_ones_are_less(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double kStrong = 4.0;  // times the median
  constexpr double kSignTest = 3.0;
  std::vector<double> sizes;
  for (std::size_t j = 0; j < a.size(); ++j) sizes.push_back(std::max(std::abs(a[j]), std::abs(b[j])));
  const double least = kStrong * stats::median(sizes);
  double strong = 0.0, less = 0.0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    if (!(std::max(std::abs(a[j]), std::abs(b[j])) > least)) continue;
    strong += 1.0, less += std::abs(a[j]) < std::abs(b[j]) ? 1.0 : 0.0;
  }
  return 2.0 * less - strong > kSignTest * std::sqrt(strong);
}

/// Whether the squares of one residual are less than those of another at the same rows, beyond chance. The few corners of a motion may have
/// nearly all of the squares, and a scatter as wide as their sum: where much of it goes, it is enough that nearly all of them do.
bool is_less(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() < kFewestPieces) return false;
  const auto n = static_cast<double>(a.size());
  double sum = 0.0, squares = 0.0, all = 0.0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    const double less = b[j] * b[j] - a[j] * a[j];
    sum += less, squares += less * less, all += b[j] * b[j];
  }
  const double mean = sum / n, error = std::sqrt(std::max(0.0, squares / n - mean * mean) / n);
  if (sum > kMuch * all && strong_ones_are_less(a, b)) return true;
  return mean > kCertain * error && sum > kLeastPart * all;
}

class Search {
 public:
  Search(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit, double shift,
         const std::optional<double>& given)
      : log_(log),
        logged_(log.force),
        rows_(sampled(rows)),
        terms_(terms),
        fit_(fit),
        shift_(shift),
        given_(given) {
    terms_.shift = !given_;
  }

  /// Time and half width [rows].
  std::optional<std::pair<double, double>> run() {
    std::optional<std::pair<double, Step>> found = best_time();
    if (!found || found->second.half_width > kVague * found->first) {
      use_calm_motion();
      found = best_time();
    }
    if (!found) return {};
    const auto [time, last] = *found;
    const double half = std::hypot(last.half_width, kKnown * time);
    if (time < 1.5 * kLeastTime || half > kVague * time || std::abs(last.by) > half) return {};
    take_off(time);
    const auto piece = static_cast<std::size_t>(std::max(6.0, std::round(kPiece * time)));
    const std::vector<double> with = slow_residual(piece);
    take_off(0.0);
    if (!is_less(with, slow_residual(piece))) return {};
    return std::pair{time, half};
  }

 private:
  /// The force that the reference of a soft loop asks for jumps at other rows than the one of the axis.
  void use_calm_motion() {
    for (std::size_t r = 0; r < log_.motions.size(); ++r) {
      log::Motion& m = log_.motions[r];
      std::vector<double>& v = log_.predicted[r];
      if (v.empty()) continue;
      v = log::calm_velocity(m);
      for (std::size_t k = 1; k + 1 < v.size(); ++k)
        m.instrument[k] = (v[k + 1] - v[k - 1]) / (2.0 * m.sample_time);
    }
  }

  /// Takes a filter of this time off the logged force and fits shift and terms.
  void take_off(double time) {
    for (std::size_t r = 0; r < logged_.size(); ++r)
      log_.force[r] = time > 0.0 ? before_filter(logged_[r], time) : logged_[r];
    align(log_, given_.value_or(shift_ - time), rows_);
    fit_ = given_ ? solve(log_, rows_, terms_, &fit_) : refine_shift(log_, rows_, terms_, std::move(fit_));
  }

  /// The secant method, from the time on a coarse grid that leaves the least slow residual to its neighbours.
  std::optional<std::pair<double, Step>> best_time() {
    constexpr int kMostSteps = 10;
    constexpr std::array kGrid{0.0, 0.25, 0.5, 0.75, 1.0, 1.4, 2.0, 3.0};  // of the delay
    const double delay = shift_ - kHeldForce;
    const auto piece = static_cast<std::size_t>(std::max(6.0, std::round(kGridPiece * delay)));
    std::size_t best = 1;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i + 1 < kGrid.size(); ++i) {
      take_off(kGrid[i] * delay);
      double squares = 0.0;
      for (const double mean : slow_residual(piece)) squares += mean * mean;
      if (squares < least) least = squares, best = i;
    }
    double low = std::max(kLeastTime, kGrid[best - 1] * delay), high = kGrid[best + 1] * delay + 1.0;
    double time = kGrid[best] * delay, before = 0.0;
    std::optional<Step> last;
    for (int i = 0; i < kMostSteps; ++i) {
      take_off(time);
      const std::optional<Step> step = step_at(time);
      if (!step) return {};
      (step->by > 0.0 ? low : high) = time;
      double next = std::clamp(time + step->by, 0.5 * time, 2.0 * time);
      if (last && step->by != last->by) next = time - step->by * (time - before) / (step->by - last->by);
      if (!(next > low) || !(next < high)) next = 0.5 * (low + high);
      before = time;
      last = step;
      if (std::abs(next - time) < kSameTime || high - low < kSameTime) return std::pair{next, *step};
      time = next;
    }
    return std::pair{before, *last};
  }

  [[nodiscard]] std::optional<Step> step_at(double time) const {
    const std::optional<Beside> found =
        beside_fit(log_, rows_, terms_, fit_, slope_of_filtered(log_, terms_, fit_, time));
    if (!found) return {};
    const std::size_t n = found->used.size();
    VectorXd e(static_cast<Index>(n)), slope(static_cast<Index>(n));
    std::vector<int> record(n);
    std::vector<std::size_t> at(n);
    std::vector<double> row(terms_.count() + 1);
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t i = found->used[j];
      e(static_cast<Index>(j)) = residual_of(log_, rows_, terms_, fit_, i, row);
      slope(static_cast<Index>(j)) = logged_slope(static_cast<std::size_t>(rows_.record[i]), rows_.at[i]);
      record[j] = rows_.record[i], at[j] = rows_.at[i];
    }
    const auto by = [&](const VectorXd& column, const VectorXd& residual) {
      const double product = column.dot(slope);
      const stats::Uncertainty error(column, residual, MatrixXd::Constant(1, 1, 1.0 / product), record, at);
      return Step{-column.dot(residual) / product, error.half_width(VectorXd::Ones(1))};
    };
    const Step all = by(found->column, e);
    // Friction that drifts leaves much, and nothing of it within a stretch.
    const Step within = by(within_stretches(found->column, found->used), within_stretches(e, found->used));
    const Step& better = within.half_width < all.half_width ? within : all;
    if (!std::isfinite(better.by) || !std::isfinite(better.half_width)) return {};
    return better;
  }

  /// A column less its mean over each stretch.
  [[nodiscard]] VectorXd within_stretches(VectorXd column, const std::vector<std::size_t>& used) const {
    for (Index from = 0; from < column.size();) {
      const int stretch = rows_.stretch[used[static_cast<std::size_t>(from)]];
      Index to = from;
      while (to < column.size() && rows_.stretch[used[static_cast<std::size_t>(to)]] == stretch) ++to;
      column.segment(from, to - from).array() -= column.segment(from, to - from).mean();
      from = to;
    }
    return column;
  }

  /// Change of the logged force from row to row where that of a row of motion is [N].
  [[nodiscard]] double logged_slope(std::size_t record, std::size_t row) const {
    const std::vector<double>& f = logged_[record];
    const double at =
        std::clamp(static_cast<double>(row) + log_.shift, 1.0, static_cast<double>(f.size()) - 3.0);
    const auto k = static_cast<std::size_t>(at);
    const double share = at - static_cast<double>(k);
    return 0.5 * ((1.0 - share) * (f[k + 1] - f[k - 1]) + share * (f[k + 2] - f[k]));
  }

  /// Means of the residual over pieces of this many rows [N].
  [[nodiscard]] std::vector<double> slow_residual(std::size_t piece) const {
    std::vector<double> columns(terms_.count() + 1), out;
    double part = 0.0;
    std::size_t count = 0, first = 0;
    const auto end_stretch = [&] {
      double mean = 0.0;
      for (std::size_t j = first; j < out.size(); ++j)
        mean += out[j] / static_cast<double>(out.size() - first);
      for (std::size_t j = first; j < out.size(); ++j) out[j] -= mean;
      first = out.size();
    };
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const bool next = i > 0 && rows_.record[i] == rows_.record[i - 1] && rows_.at[i] == rows_.at[i - 1] + 1;
      if (!next) part = 0.0, count = 0;
      if (i > 0 && rows_.stretch[i] != rows_.stretch[i - 1]) end_stretch();
      part += residual_of(log_, rows_, terms_, fit_, i, columns);
      if (++count < piece) continue;
      out.push_back(part / static_cast<double>(piece));
      part = 0.0, count = 0;
    }
    end_stretch();
    return out;
  }

  AlignedLog log_;
  std::vector<std::vector<double>> logged_;  ///< force of each record with the filter
  Rows rows_;
  Terms terms_;
  LinearFit fit_;
  double shift_;                 ///< of the force with its filter [rows]
  std::optional<double> given_;  ///< of the force before it [rows]
};

}  // namespace

std::optional<ForceFilter> find_filter(const AlignedLog& log, const Rows& rows, const Terms& terms,
                                       const LinearFit& fit, double shift,
                                       const std::optional<double>& given) {
  const bool measured = std::none_of(log.predicted.begin(), log.predicted.end(),
                                     [](const std::vector<double>& v) { return v.empty(); });
  if (!measured || !(shift - kHeldForce > kLeastDelay)) return {};
  const auto found = Search(log, rows, terms, fit, shift, given).run();
  if (!found) return {};
  const double period = log.records.front().sample_time;
  return ForceFilter{period * found->first, period * found->second};
}

VectorXd moved_by_filter(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                         double time) {
  const std::optional<Beside> found =
      beside_fit(log, rows, terms, fit, slope_of_filtered(log, terms, fit, time));
  return found ? found->moved : VectorXd::Zero(static_cast<Index>(terms.count()));
}

}  // namespace stribeck::ident::drive
