#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <stribeck/ident/drive/map/level_drift.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::drive {
namespace {

constexpr std::size_t kFewestRows = 500;
constexpr std::size_t kMostLogs =
    12;  ///< more are the repeated runs of one machine: their mean is what is asked for
constexpr double kShareDeviation = 0.3;  ///< prior standard deviation of a share
constexpr double kWorthCounting = 0.02;  ///< share of friction, as the warning of a drift has it
constexpr double kSeen = 2.0;            ///< of the 95 % half width
constexpr double kAroundSpeed = 0.15;    ///< share of a speed: rows that count as its own
constexpr double kLowestLevel = 0.5;     ///< of the mean: no axis loses more

/// Columns of one log; the first log has no level of its own.
constexpr Index kOrders = 3;
Index columns_of(std::size_t logs) { return kOrders * static_cast<Index>(logs) - 1; }
Index column(std::size_t log, Index order) { return kOrders * static_cast<Index>(log) + order - 1; }

/// A log that was cut at gaps is several records, one after the other in time: it drifts as one.
struct Logs {
  std::vector<std::size_t> of_record;
  std::vector<double> begin, end;  ///< [s]
};
Logs logs_of_records(std::span<const log::Record> records) {
  Logs out;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const bool goes_on =
        r > 0 && records[r].source == records[r - 1].source && records[r].t.front() > records[r - 1].t.back();
    if (!goes_on) out.begin.push_back(records[r].t.front()), out.end.push_back(0.0);
    out.end.back() = records[r].t.back();
    out.of_record.push_back(out.end.size() - 1);
  }
  return out;
}

void basis(double tau, double* p) { p[0] = 1.0, p[1] = tau, p[2] = 0.5 * (3.0 * tau * tau - 1.0); }

/// Share of friction of a row, as a function of the parameters.
VectorXd shares_of(const AlignedLog& log, const Logs& logs, int record, std::size_t at) {
  const std::size_t g = logs.of_record[static_cast<std::size_t>(record)];
  const double t = log.records[static_cast<std::size_t>(record)].t[at];
  double p[kOrders];
  basis(2.0 * (t - logs.begin[g]) / (logs.end[g] - logs.begin[g]) - 1.0, p);
  VectorXd out = VectorXd::Zero(columns_of(logs.end.size()));
  for (Index order = g == 0 ? 1 : 0; order < kOrders; ++order) out(column(g, order)) = p[order];
  return out;
}

/// The mean over the time of all logs.
VectorXd mean_over_time(const Logs& logs) {
  VectorXd out = VectorXd::Zero(columns_of(logs.end.size()));
  double all = 0.0;
  for (std::size_t g = 0; g < logs.end.size(); ++g) all += logs.end[g] - logs.begin[g];
  for (std::size_t g = 1; g < logs.end.size(); ++g) out(column(g, 0)) = (logs.end[g] - logs.begin[g]) / all;
  return out;
}

}  // namespace

LevelDrift::LevelDrift(const AlignedLog& log, const Rows& rows, const map::StaticFit& map,
                       const std::vector<double>& residual)
    : grid_(rows.grid) {
  const std::vector<std::size_t> used = sample(rows);
  const Logs logs = logs_of_records(log.records);
  if (used.size() < kFewestRows || logs.end.size() > kMostLogs) return;
  const Index Q = columns_of(logs.end.size());
  const auto n = static_cast<Index>(used.size());
  MatrixXd X(n, Q);
  VectorXd y(n);
  std::vector<int> record(used.size());
  std::vector<std::size_t> at(used.size());
  std::array<MatrixXd, map::kSides> mean;  // of the shares, and of the columns and the residual, in each bin
  std::array<MatrixXd, map::kSides> sums;
  std::array<VectorXd, map::kSides> count;
  for (std::size_t s = 0; s < map::kSides; ++s) {
    const Index bins = rows.grid[s].bins;
    mean[s] = MatrixXd::Zero(bins, Q), sums[s] = MatrixXd::Zero(bins, Q + 1), count[s] = VectorXd::Zero(bins);
  }
  for (Index k = 0; k < n; ++k) {
    const std::size_t i = used[static_cast<std::size_t>(k)];
    const std::size_t s = rows.side[i];
    const int bin = rows.bin[i];
    const VectorXd share = shares_of(log, logs, rows.record[i], rows.at[i]);
    const double friction =
        map.force(static_cast<int>(s), std::abs(velocity_of(log, rows, i))) - map::kDirection[s] * map.load;
    X.row(k) = friction * share.transpose();
    y(k) = map::kDirection[s] * residual[i];
    mean[s].row(bin) += share.transpose();
    sums[s].row(bin).head(Q) += X.row(k);
    sums[s](bin, Q) += y(k);
    count[s](bin) += 1.0;
    record[static_cast<std::size_t>(k)] = rows.record[i], at[static_cast<std::size_t>(k)] = rows.at[i];
  }
  for (Index k = 0; k < n; ++k) {
    const std::size_t i = used[static_cast<std::size_t>(k)];
    const std::size_t s = rows.side[i];
    X.row(k) -= sums[s].row(rows.bin[i]).head(Q) / count[s](rows.bin[i]);
    y(k) -= sums[s](rows.bin[i], Q) / count[s](rows.bin[i]);
  }
  const MatrixXd normal = X.transpose() * X;
  const double noise = y.squaredNorm() / static_cast<double>(n);
  const MatrixXd prior = MatrixXd::Identity(Q, Q) * (noise / (kShareDeviation * kShareDeviation));
  const MatrixXd inverse = stats::inverse(normal + prior);
  const VectorXd share = inverse * (X.transpose() * y);
  const stats::Uncertainty uncertainty(X, y - X * share, inverse, record, at);
  for (std::size_t g = 0; g < logs.end.size(); ++g) {
    for (const Index order : {0, 1}) {  // a curvature alone is no drift
      if (g == 0 && order == 0) continue;
      const Index j = column(g, order);
      const double half = uncertainty.half_width(VectorXd::Unit(Q, j));
      found_ = found_ || (std::abs(share(j)) > kSeen * half && std::abs(share(j)) > kWorthCounting);
    }
  }
  if (!found_) return;
  const VectorXd whole = mean_over_time(logs);
  for (std::size_t s = 0; s < map::kSides; ++s) {
    for (Index b = 0; b < rows.grid[s].bins; ++b) {
      if (!(count[s](b) > 0.0)) {
        bins_[s].emplace_back();
        continue;
      }
      const VectorXd g = mean[s].row(b).transpose() / count[s](b) - whole;
      const double half = uncertainty.half_width(g);
      bins_[s].push_back({count[s](b), std::abs(g.dot(share)) + half, half});
    }
  }
  const double over_time = whole.dot(share);
  for (const std::size_t g : logs.of_record) {
    Course course{logs.begin[g], logs.end[g], {}, 0.0};
    const double slope = share(column(g, 1));
    if (std::abs(slope) > kWorthCounting &&
        std::abs(slope) > kSeen * uncertainty.half_width(VectorXd::Unit(Q, column(g, 1))))
      course.rise = 2.0 * slope;
    for (Index order = g == 0 ? 1 : 0; order < kOrders; ++order)
      course.share[static_cast<std::size_t>(order)] = share(column(g, order));
    course.share[0] -= over_time;
    courses_.push_back(course);
  }
}

double LevelDrift::level(const log::Record& record, std::size_t number, std::size_t row) const {
  if (!found_) return 1.0;
  const Course& c = courses_[number];
  double p[kOrders];
  basis(2.0 * (record.t[row] - c.begin) / (c.end - c.begin) - 1.0, p);
  return std::max(kLowestLevel, 1.0 + c.share[0] * p[0] + c.share[1] * p[1] + c.share[2] * p[2]);
}

std::vector<log::Record> at_mean_level(const AlignedLog& log, const LevelDrift& drift, double mass,
                                       double load) {
  std::vector<log::Record> out(log.records.begin(), log.records.end());
  const auto later = static_cast<std::ptrdiff_t>(std::lround(log.shift));
  for (std::size_t n = 0; n < out.size(); ++n) {
    const log::Motion& m = log.motions[n];
    const std::vector<double> force = log::align_force(log.force[n], log.shift);
    log::Record& r = out[n];
    for (std::size_t k = 0; k < r.f.size(); ++k) {
      // The force of row k belongs to the motion of the row that the shift says.
      const auto of_motion =
          std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(k) - later, 0, std::ssize(r.f) - 1);
      const auto i = static_cast<std::size_t>(of_motion);
      const double friction = force[i] - mass * m.a[i] - load;
      if (!m.valid(i) || !std::isfinite(friction)) continue;
      r.f[k] -= friction * (1.0 - 1.0 / drift.level(log.records[n], n, i));
    }
  }
  return out;
}

double LevelDrift::largest(int side, double speed, double Bin::*what) const {
  if (!found_) return 0.0;
  const auto s = static_cast<std::size_t>(side);
  const map::Grid& grid = grid_[s];
  const double wide = std::max(1.5 * grid.width(speed), kAroundSpeed * speed);
  double most = 0.0;
  for (int b = grid.bin(speed - wide); b <= grid.bin(speed + wide); ++b) {
    const Bin& bin = bins_[s][static_cast<std::size_t>(b)];
    if (bin.rows > 0.0) most = std::max(most, bin.*what);
  }
  return most;
}

}  // namespace stribeck::ident::drive
