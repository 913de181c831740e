// A force that another device recorded: late by more than any drive delays it, or by a clock that runs at another rate.
#include <fmt/core.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/ident/log/faults/faults.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::log::parts {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kOfDrives = 0.025;  // [s] a delay that the fit finds by itself
constexpr double kReach = 1.0;       // [s] of the search, either way
constexpr double kBend = 0.01;       // [s] of the second difference, either way
constexpr std::size_t kMostRows = 3000;
constexpr double kMostLags = 1000.0;
constexpr double kExplained = 0.05;  // of the squares of the force may be left
constexpr double kInertia = 0.1;     // of the squares must be that of inertia
constexpr double kMuchLess = 0.25;   // of the squares that a delay of a drive leaves
constexpr double kLess = 0.8;        // the same where the best delay of a drive is the longest

struct Lag {
  double rows = 0.0;
  double left =
      1.0;  ///< share of the squares of the force about its mean that no rigid axis with friction explains
};

/// Rows from `first` to `last` (not included) of one table, and what a rigid axis with friction makes of its motion.
class Stretch {
 public:
  Stretch(const Table& m, std::size_t first, std::size_t last) : f_(m.f) {
    const double T = m.sample_time;
    const auto w = static_cast<std::size_t>(std::max(1.0, std::round(kBend / T)));
    first = std::max(first, w);
    last = std::min(last, m.rows() > w ? m.rows() - w : 0);
    if (last < first + kFewestRows) return;
    const std::size_t stride = 1 + (last - first) / kMostRows;
    const double span = static_cast<double>(w) * T;
    std::vector<double> a, v;
    for (std::size_t k = first; k < last; k += stride) {
      at_.push_back(k);
      a.push_back((m.x[k + w] - 2.0 * m.x[k] + m.x[k - w]) / (span * span));
      v.push_back((m.x[k + w] - m.x[k - w]) / (2.0 * span));
    }
    double top = 0.0;
    for (const double s : v) top = std::max(top, std::abs(s));
    if (!(top > 0.0)) return;
    MatrixXd design(std::ssize(at_), 4);
    for (Index i = 0; i < design.rows(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      constexpr double kSlow = 1e-3;  // of the top speed: friction has no direction
      design.row(i) << 1.0, v[k],
          std::abs(v[k]) > kSlow * top ? std::copysign(1.0, v[k]) : v[k] / (kSlow * top), a[k];
    }
    basis_ = design.householderQr().householderQ() * MatrixXd::Identity(design.rows(), design.cols());
  }

  [[nodiscard]] bool tells() const { return basis_.rows() > 0; }

  /// With the force of `late` rows later.
  [[nodiscard]] VectorXd force(std::ptrdiff_t late) const {
    VectorXd f(basis_.rows());
    const auto n = static_cast<std::ptrdiff_t>(f_.size());
    for (Index i = 0; i < f.size(); ++i) {
      const auto k = static_cast<std::ptrdiff_t>(at_[static_cast<std::size_t>(i)]) + late;
      f(i) = f_[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, n - 1))];
    }
    return f;
  }

  /// What is left with the force `late` rows later than the motion.
  [[nodiscard]] double left(std::ptrdiff_t late) const {
    const VectorXd f = force(late);
    const double about_mean = (f.array() - f.mean()).square().sum();
    if (!(about_mean > 0.0)) return 1.0;
    return std::max(0.0, f.squaredNorm() - (basis_.transpose() * f).squaredNorm()) / about_mean;
  }

  /// Share of the squares that inertia alone explains. Friction of a slow motion turns over with the distance after a reversal, which looks
  /// like a delay.
  [[nodiscard]] double inertia(std::ptrdiff_t late) const {
    const VectorXd f = force(late);
    const double about_mean = (f.array() - f.mean()).square().sum();
    return about_mean > 0.0 ? std::pow(basis_.col(3).dot(f), 2.0) / about_mean : 0.0;
  }

  /// The best of middle − reach … middle + reach, to a part of a row.
  [[nodiscard]] Lag best(std::ptrdiff_t middle, std::ptrdiff_t reach) const {
    const auto step = std::max<std::ptrdiff_t>(
        1, static_cast<std::ptrdiff_t>(std::ceil(2.0 * static_cast<double>(reach) / kMostLags)));
    std::ptrdiff_t at = middle;
    double least = std::numeric_limits<double>::infinity();
    const auto look = [&](std::ptrdiff_t late) {
      const double l = left(late);
      if (l < least) least = l, at = late;
    };
    for (std::ptrdiff_t late = middle - reach; late <= middle + reach; late += step) look(late);
    for (std::ptrdiff_t late = at - step + 1, end = at + step; late < end; ++late) look(late);
    const double before = left(at - 1), after = left(at + 1);
    const double bend = before - 2.0 * least + after;
    const double part = bend > 0.0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
    return {static_cast<double>(at) + part, least};
  }

 private:
  const std::vector<double>& f_;
  std::vector<std::size_t> at_;
  MatrixXd basis_;  ///< orthonormal: constant, velocity, direction, acceleration
};

/// The force of row k is that of row k + late + rate·k; rows beyond the ends are cut.
Table moved(const Table& m, double late, double rate) {
  const auto n = static_cast<double>(m.rows());
  Table out = m;
  std::size_t first = m.rows(), last = 0;
  for (std::size_t k = 0; k < m.rows(); ++k) {
    const double at = static_cast<double>(k) * (1.0 + rate) + late;
    if (at < 0.0 || at > n - 1.0) continue;
    const auto before = static_cast<std::size_t>(at);
    const double part = at - static_cast<double>(before);
    out.f[k] = part > 0.0 ? (1.0 - part) * m.f[before] + part * m.f[before + 1] : m.f[before];
    first = std::min(first, k), last = k + 1;
  }
  return first < last ? slice(out, first, last) : m;
}

/// The delays of parts of a table on a straight line over its rows.
struct Drift {
  double late = 0.0;  ///< at the first row [rows]
  double rate = 0.0;  ///< rows per row
  double over = 0.0;  ///< from end to end [rows]
};

/// None where the delay is the same all along, or the parts do not tell it.
std::optional<Drift> drift_of(const Table& m, double late) {
  constexpr std::size_t kParts = 8, kFewestParts = 5;
  constexpr std::ptrdiff_t kAround = 60;  // rows
  constexpr double kLeast = 3.0;          // rows
  constexpr double kLeastTime = 2e-3;     // [s]
  constexpr double kOff = 0.1;            // of the drift, RMS
  std::vector<double> x, y;
  for (std::size_t i = 0; i < kParts; ++i) {
    const std::size_t first = i * m.rows() / kParts, last = (i + 1) * m.rows() / kParts;
    const Stretch part(m, first, last);
    if (!part.tells()) continue;
    const Lag lag = part.best(static_cast<std::ptrdiff_t>(std::round(late)), kAround);
    if (lag.left > kExplained || part.inertia(std::lround(lag.rows)) < kInertia) continue;
    x.push_back(0.5 * static_cast<double>(first + last));
    y.push_back(lag.rows);
  }
  if (x.size() < kFewestParts) return {};
  MatrixXd design(std::ssize(x), 2);
  design.col(0).setOnes();
  design.col(1) = Eigen::Map<const VectorXd>(x.data(), std::ssize(x));
  const Eigen::Map<const VectorXd> lags(y.data(), std::ssize(y));
  const VectorXd line = design.householderQr().solve(lags);
  const double over = line(1) * static_cast<double>(m.rows());
  const double off = (lags - design * line).norm() / std::sqrt(static_cast<double>(x.size()));
  if (std::abs(over) < std::max(kLeast, kLeastTime / m.sample_time) || off > kOff * std::abs(over)) return {};
  return Drift{line(0), line(1), over};
}

/// Whether a rigid axis with friction explains clearly more of the stretched force. Friction that builds up over a distance moves the delays
/// of slow parts as a clock would.
bool explains_more(const Table& before, const Table& after) {
  constexpr double kClearly = 0.8;  // of the squares that are left
  const auto usual = static_cast<std::ptrdiff_t>(std::ceil(kOfDrives / before.sample_time));
  const Stretch plain(before, 0, before.rows()), stretched(after, 0, after.rows());
  return stretched.tells() && stretched.best(0, usual).left < kClearly * plain.best(0, usual).left;
}

/// Rows of the clock from the begin of `longest` to that of `m`; absent where both are not of one recording.
std::optional<double> rows_between(const Table& longest, const Table& m) {
  if (m.run != longest.run || m.t.empty()) return {};
  return (m.t.front() - longest.t.front()) / longest.sample_time;
}

/// A force whose delay grows in a straight line is stretched, in all pieces of the recording.
void straighten_clock(std::vector<Table>& tables, const Table& longest, Notes& notes) {
  const std::optional<Drift> drift = drift_of(longest, 0.0);
  if (!drift) return;
  std::vector<Table> mended;
  for (const Table& m : tables) {
    const std::optional<double> from = rows_between(longest, m);
    if (!from) return;
    mended.push_back(moved(m, drift->late + drift->rate * *from, drift->rate));
  }
  if (!explains_more(longest, mended[static_cast<std::size_t>(&longest - tables.data())])) return;
  const std::string source = longest.source;
  const double T = longest.sample_time;
  tables = std::move(mended);
  notes.add_all(
      "late", source, true,
      fmt::format(
          "the force gets {:.4g} ms {} from the first row to the last ({:.0f} ppm): the clocks of two "
          "devices run at different rates; the force was stretched by that",
          1e3 * std::abs(drift->over) * T, drift->over > 0.0 ? "later" : "earlier",
          1e6 * std::abs(drift->rate)),
      {drift->over * T, drift->rate});
}

}  // namespace

void align_late_force(std::vector<Table>& tables, Notes& notes) {
  if (!notes.wanted("late")) return;
  auto longest = std::max_element(tables.begin(), tables.end(),
                                  [](const Table& a, const Table& b) { return a.rows() < b.rows(); });
  // Of pulses in open loop, with their rests, another part of the motion may look like the answer.
  if (longest->x.empty() || longest->r.empty()) return;
  const double T = longest->sample_time;
  const Stretch all(*longest, 0, longest->rows());
  if (!all.tells()) return;
  const auto usual = static_cast<std::ptrdiff_t>(std::ceil(kOfDrives / T));
  const auto reach =
      static_cast<std::ptrdiff_t>(std::min(kReach / T, 0.1 * static_cast<double>(longest->rows())));
  if (reach <= usual) return;
  const Lag of_drive = all.best(0, usual);
  const bool at_border = std::abs(of_drive.rows) > static_cast<double>(usual) - 1.0;
  if (of_drive.left > kExplained || at_border) {
    const Lag far = all.best(0, reach);
    const bool better = far.left < kExplained && all.inertia(std::lround(far.rows)) > kInertia &&
                        far.left < (at_border ? kLess : kMuchLess) * of_drive.left;
    const double late = std::round(far.rows);
    if (better && std::abs(late) > static_cast<double>(usual)) {
      for (Table& m : tables) m = moved(m, late, 0.0);
      notes.add_all(
          "late", longest->source, true,
          fmt::format(
              "the force is {:.4g} ms ({:g} rows) {} than the motion, more than a drive delays it: two devices "
              "recorded them, or their columns were put together with an offset; the force was moved by that",
              1e3 * std::abs(late) * T, std::abs(late), late > 0.0 ? "later" : "earlier"),
          {late * T});
    }
  }
  straighten_clock(tables, *longest, notes);
}

}  // namespace stribeck::ident::log::parts
