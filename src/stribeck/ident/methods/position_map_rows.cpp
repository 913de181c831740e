#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/methods/position_map_parts.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::methods::position_map {
namespace {

constexpr std::size_t kFewestRows = 60;
/// Travel after a reversal that is left out, as a share of the stroke and a multiple of the noise of x.
constexpr double kExcludedStroke = 2e-3;
constexpr double kExcludedNoise = 20.0;
constexpr double kSlowest = 0.02;  ///< share of the largest speed
/// The window of the motion reaches over at most this share of the stroke; otherwise it would remove short periods.
constexpr double kWindowTravel = 1.0 / 400.0;
constexpr std::size_t kMostGroups = 100000;

std::vector<log::Motion> motions_of(const std::vector<log::Record>& records,
                                    const PositionMapOptions& options, Result& result) {
  std::vector<log::Motion> motions;
  for (const log::Record& r : records) {
    const auto wrong = log::problems(r);
    if (!wrong.empty()) throw Refused(wrong.front());
    if (r.force_unit != records.front().force_unit || r.position_unit != records.front().position_unit) {
      throw Refused(r.source + ": force in " + r.force_unit + " over " + r.position_unit + ", expected " +
                    records.front().force_unit + " over " + records.front().position_unit +
                    " as in the first log");
    }
    log::Motion m = log::reconstruct(r);
    const auto fast = static_cast<std::size_t>(0.95 * static_cast<double>(m.rows()));
    const double travel = stats::nth_smallest(stats::magnitudes(m.v), fast) * r.sample_time;
    if (travel > 0.0 && m.window * travel > kWindowTravel * m.stroke) {
      m = log::reconstruct(r, {static_cast<int>(kWindowTravel * m.stroke / travel)});
    }
    if (m.loop == log::Loop::kAutomatic && !options.mass) {
      result.warnings.push_back(
          r.source +
          ": no reference and no programmed force: the mass is found from smoothed accelerations alone");
    }
    motions.push_back(std::move(m));
  }
  return motions;
}

/// Limits that select the rows of a record.
struct Wanted {
  double exclude = 0.0;  ///< [m]
  double slowest = 0.0;  ///< [m/s]; NaN where nothing moves

  bool operator()(const log::Motion& m, std::size_t k) const {
    return m.v[k] * m.direction[k] >= slowest && m.sliding(k, exclude);
  }
};

/// Finds the largest speed, and counts the selected rows by direction.
Wanted choose_rows(Rows& rows) {
  double stroke = 0.0;
  double noise = 0.0;
  for (const log::Motion& m : rows.motions) {
    stroke = std::max(stroke, m.stroke);
    noise = std::max(noise, m.position_noise);
    for (std::size_t k = 0; k < m.rows(); ++k)
      rows.top = m.valid(k) ? std::max(rows.top, std::abs(m.v[k])) : rows.top;
  }
  const Wanted wanted{std::max(kExcludedStroke * stroke, kExcludedNoise * noise),
                      rows.top > 0.0 ? kSlowest * rows.top : kNaN};
  std::size_t count[2] = {0, 0};
  for (const log::Motion& m : rows.motions) {
    for (std::size_t k = 0; k < m.rows(); ++k) count[m.direction[k] > 0] += wanted(m, k) ? 1u : 0u;
  }
  rows.rows = count[0] + count[1];
  rows.both = count[0] >= kFewestRows && count[1] >= kFewestRows;
  if (stroke < kExcludedNoise * noise) {
    throw Refused(
        "the axis hardly moves in this log: its position changes by no more than its noise; move it over its travel in both "
        "directions");
  }
  if (rows.rows < 2 * kFewestRows) {
    throw Refused(fmt::format(
        "position map: {} rows of sliding motion, expected at least {}; move over several periods "
        "of the screw in both directions",
        rows.rows, 2 * kFewestRows));
  }
  return wanted;
}

/// Joins neighbouring selected rows of one stretch.
void join(const Wanted& wanted, Rows& rows) {
  rows.together = 1 + rows.rows / kMostGroups;
  int blocks = -1;
  for (std::size_t r = 0; r < rows.motions.size(); ++r) {
    const log::Motion& m = rows.motions[r];
    int stretch = -1;
    for (std::size_t k = 0; k < m.rows(); ++k) {
      if (!wanted(m, k)) continue;
      if (m.stretch[k] != stretch) ++blocks, stretch = m.stretch[k];
      Group* last = rows.groups.empty() ? nullptr : &rows.groups.back();
      if (last != nullptr && last->block == blocks && last->rows < rows.together &&
          last->first + last->rows == k) {
        ++last->rows;
      } else {
        rows.groups.push_back({static_cast<int>(r), k, 1, static_cast<double>(m.direction[k]), blocks});
      }
    }
  }
}

}  // namespace

Parameter parameter(std::string name, double value, const char* unit, const char* shown, double half,
                    bool seen) {
  Parameter p;
  p.name = std::move(name);
  p.value = value;
  p.unit = unit;
  p.shown = shown;
  p.ci_low = value - half;
  p.ci_high = value + half;
  p.identifiable = seen && std::isfinite(half) && half < std::abs(value);
  return p;
}

VectorXd Rows::mean_of(const std::vector<std::vector<double>>& columns) const {
  VectorXd out(static_cast<Index>(groups.size()));
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const Group& g = groups[i];
    const std::vector<double>& c = columns[static_cast<std::size_t>(g.record)];
    double sum = 0.0;
    for (std::size_t k = g.first; k < g.first + g.rows; ++k) sum += c[k];
    out(static_cast<Index>(i)) = sum / static_cast<double>(g.rows);
  }
  return out;
}

Rows gather(const std::vector<log::Record>& records, const PositionMapOptions& options, Result& result) {
  Rows rows;
  rows.records = &records;
  rows.motions = motions_of(records, options, result);
  join(choose_rows(rows), rows);
  const auto column = [&](std::vector<double> log::Motion::*which) {
    std::vector<std::vector<double>> columns;
    for (const log::Motion& m : rows.motions) columns.push_back(m.*which);
    return rows.mean_of(columns);
  };
  rows.y = column(&log::Motion::f);
  rows.a = column(&log::Motion::a);
  rows.instrument = column(&log::Motion::instrument);
  rows.v = column(&log::Motion::v);
  std::vector<std::vector<double>> positions;
  for (const log::Record& record : records) positions.push_back(record.x);
  rows.x = rows.mean_of(positions);
  rows.s.resize(rows.y.size());
  for (Index i = 0; i < rows.s.size(); ++i) rows.s(i) = rows.groups[static_cast<std::size_t>(i)].sign;
  if (options.mass) rows.y -= *options.mass * rows.a;
  rows.middle = 0.5 * (rows.x.minCoeff() + rows.x.maxCoeff());
  rows.length = rows.x.maxCoeff() - rows.x.minCoeff();
  rows.slowest = rows.v.cwiseAbs().minCoeff();
  return rows;
}

}  // namespace stribeck::ident::methods::position_map
