#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/methods/equal_speed.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/quantiles.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::methods {
namespace {

constexpr double kOneSpeed = 0.05;   // share by which forward and backward speeds of a pair may differ
constexpr double kConstant = 0.001;  // probability below which half sums do not agree
constexpr std::size_t kFewestPairs = 60;
constexpr double kSlowestOfEqual = 0.02;  // share of the largest speed at which the bins begin

struct Row {
  int record;
  std::size_t at;
  std::size_t bin;
  double v, a, f, z, x;
};

/// Travel in which friction settles after a reversal.
double after_reversal(const log::Record& record, double stroke) {
  constexpr double kUsual = 50e-6, kShareOfTurn = 2e-3;
  return record.turns() ? kShareOfTurn * stroke : kUsual;
}

/// Rows of sliding, with the bin of speed of each; bins for v < 0 follow those for v > 0.
std::vector<Row> rows_of(const std::vector<log::Record>& records, const EqualSpeedOptions& options,
                         double& top) {
  std::vector<Row> rows;
  top = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const auto wrong = log::problems(records[r]);
    if (!wrong.empty()) throw Refused(wrong.front());
    const log::Motion m = log::reconstruct(records[r]);
    const double exclude = options.exclude.value_or(after_reversal(records[r], m.stroke));
    // In open loop the instrument is a force: it has another unit but gives the same estimate.
    for (std::size_t k = 0; k < m.rows(); ++k) {
      if (!m.sliding(k, exclude)) continue;
      rows.push_back({static_cast<int>(r), k, 0, m.v[k], m.a[k], m.f[k], m.instrument[k], m.x[k]});
      top = std::max(top, std::abs(m.v[k]));
    }
  }
  std::vector<Row> kept;
  for (Row& row : rows) {
    const double share = std::abs(row.v) / top;
    if (share < kSlowestOfEqual) continue;
    const int bin = std::min(options.bins - 1, static_cast<int>((share - kSlowestOfEqual) /
                                                                (1.0 - kSlowestOfEqual) * options.bins));
    row.bin = static_cast<std::size_t>(bin + (row.v > 0.0 ? 0 : options.bins));
    kept.push_back(row);
  }
  return kept;
}

}  // namespace

LoadEstimate load_of(const std::vector<map::SteadyRun>& runs) {
  LoadEstimate out;
  std::vector<map::SteadyRun> sorted = runs;
  std::stable_sort(sorted.begin(), sorted.end(), [](const map::SteadyRun& a, const map::SteadyRun& b) {
    return std::abs(a.speed) < std::abs(b.speed);
  });
  for (std::size_t i = 0; i < sorted.size();) {
    double n[2] = {0, 0}, f[2] = {0, 0}, variance[2] = {0, 0}, speed = 0.0;
    std::size_t j = i;
    for (; j < sorted.size() && std::abs(sorted[j].speed) <= (1.0 + kOneSpeed) * std::abs(sorted[i].speed);
         ++j) {
      const int side = sorted[j].speed > 0.0 ? 0 : 1;
      n[side] += 1.0, f[side] += sorted[j].force, variance[side] += sorted[j].error * sorted[j].error;
      speed += std::abs(sorted[j].speed);
    }
    if (n[0] > 0.0 && n[1] > 0.0) {
      const double forward = f[0] / n[0];
      const double backward = f[1] / n[1];
      out.pairs.push_back({speed / (n[0] + n[1]), 0.5 * (forward + backward), 0.5 * (forward - backward),
                           0.5 * std::sqrt(variance[0] / (n[0] * n[0]) + variance[1] / (n[1] * n[1]))});
    }
    i = j;
  }
  if (out.pairs.empty()) return out;
  const auto n = static_cast<double>(out.pairs.size());
  double sum = 0.0, variance = 0.0, spread = 0.0, weights = 0.0, weighted = 0.0, chi = 0.0;
  for (const SpeedPair& p : out.pairs) {
    sum += p.load, variance += p.error * p.error;
    const double w = 1.0 / std::max(p.error * p.error, 1e-300);
    weights += w, weighted += w * p.load;
  }
  out.value = sum / n;
  for (const SpeedPair& p : out.pairs) {
    spread += (p.load - out.value) * (p.load - out.value);
    chi += std::pow((p.load - weighted / weights) / std::max(p.error, 1e-150), 2.0);
  }
  out.constant = n < 2.0 || stats::chi_squared_above(std::min(chi, 1e6), n - 1.0) > kConstant;
  if (n >= 2.0) {
    const double half =
        stats::student_factor(n - 1.0) * std::sqrt(std::max(variance / n, spread / (n - 1.0)) / n);
    out.interval = {out.value - half, out.value + half};
  }
  return out;
}

Result identify_gravity(const std::vector<log::Record>& records, const map::SteadyOptions& options) {
  if (records.empty()) throw Refused("gravity: no record given");
  const map::SteadyRuns found = map::find_steady_runs(records, options);
  const LoadEstimate load = load_of(found.runs);
  if (load.pairs.empty()) {
    throw Refused(fmt::format(
        "gravity: got {} stretches of constant speed, but none of the speeds in both directions; run each speed forward and back (excite --method jog)",
        found.runs.size()));
  }
  Result r;
  r.method = Method::kGravity;
  r.set_steady(SteadyModel::kNone);
  r.force_unit = records.front().force_unit;
  r.position_unit = records.front().position_unit;
  r.mass = std::numeric_limits<double>::quiet_NaN();
  r.load = load.value;
  const bool told = load.interval.low > 0.0 || load.interval.high < 0.0;
  r.parameters.push_back({"load", load.value, "N", "N", load.interval.low, load.interval.high, told});
  r.warnings = found.notes;
  if (!load.constant) {
    r.warnings.push_back(
        "half the sum of both directions varies with the speed by more than its errors: friction differs between the directions, and a part of the load may be that difference");
  }
  if (load.pairs.size() == 1)
    r.cannot_tell.push_back("interval of the load: only one speed was run in both directions");
  r.cannot_tell.push_back("mass: constant speeds do not determine it");
  r.cannot_tell.push_back(
      "load and a Coulomb friction that differs between the directions cannot be distinguished");
  for (const SpeedPair& p : load.pairs) {
    const double half = 1.96 * p.error;
    r.curve.push_back({p.speed, p.friction, p.friction - half, p.friction + half});
  }
  for (std::size_t i = load.pairs.size(); i-- > 0;) {
    const SpeedPair& p = load.pairs[i];
    const double half = 1.96 * p.error;
    r.curve.insert(r.curve.begin() + static_cast<std::ptrdiff_t>(load.pairs.size() - 1 - i),
                   {-p.speed, -p.friction, -p.friction - half, -p.friction + half});
  }
  r.velocity_range = {-load.pairs.back().speed, load.pairs.back().speed};
  for (const map::SteadyRun& run : found.runs) {
    r.rows += run.last - run.first + 1;
    r.map.push_back({run.speed, run.force - load.value, run.speed > 0.0 ? 1 : -1});
  }
  return r;
}

MassEstimate mass_at_equal_speed(const std::vector<log::Record>& records, const EqualSpeedOptions& options) {
  MassEstimate out;
  double top = 0.0;
  const std::vector<Row> rows = rows_of(records, options, top);
  out.rows = rows.size();
  if (rows.size() < kFewestPairs) return out;
  struct Sum {
    double n = 0, a = 0, f = 0, z = 0;
  };
  std::vector<Sum> bins(2 * static_cast<std::size_t>(options.bins));
  for (const Row& row : rows) {
    Sum& s = bins[row.bin];
    s.n += 1.0, s.a += row.a, s.f += row.f, s.z += row.z;
  }
  const auto n = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd z(n, 1);
  Eigen::VectorXd a(n), f(n);
  std::vector<int> record;
  std::vector<std::size_t> at;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    const Sum& s = bins[row.bin];
    z(i, 0) = row.z - s.z / s.n;
    a(i) = row.a - s.a / s.n;
    f(i) = row.f - s.f / s.n;
    record.push_back(row.record);
    at.push_back(row.at);
  }
  if (!options.periods.empty()) {
    // The periodic columns are projected out of all three, so that they do not depend on the periodic force.
    const auto columns = static_cast<Eigen::Index>(2 * options.periods.size());
    Eigen::MatrixXd w(n, columns);
    Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(bins.size()), columns);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Row& row = rows[static_cast<std::size_t>(i)];
      for (std::size_t p = 0; p < options.periods.size(); ++p) {
        const double phase = 2.0 * kPi * row.x / options.periods[p];
        w(i, static_cast<Eigen::Index>(2 * p)) = std::sin(phase);
        w(i, static_cast<Eigen::Index>(2 * p + 1)) = std::cos(phase);
      }
      mean.row(static_cast<Eigen::Index>(row.bin)) += w.row(i) / bins[row.bin].n;
    }
    for (Eigen::Index i = 0; i < n; ++i)
      w.row(i) -= mean.row(static_cast<Eigen::Index>(rows[static_cast<std::size_t>(i)].bin));
    const Eigen::MatrixXd normal = stats::gram(w);
    const auto partial_out = [&](Eigen::Ref<Eigen::VectorXd> column) {
      column -= w * stats::solve_ldlt(normal, w.transpose() * column);
    };
    partial_out(z.col(0));
    partial_out(a);
    partial_out(f);
  }
  const double cross = z.col(0).dot(a);
  if (!(std::abs(cross) > 1e-9 * z.norm() * a.norm())) return out;
  out.value = z.col(0).dot(f) / cross;
  const Eigen::VectorXd e = f - out.value * a;
  const Eigen::MatrixXd inverse = Eigen::MatrixXd::Constant(1, 1, 1.0 / cross);
  // With an instrument: (ZᵀA)⁻¹·S·(AᵀZ)⁻¹ replaces (XᵀX)⁻¹·S·(XᵀX)⁻¹. For the stationary form XᵀX is z̃ᵀz̃, which gives the
  // scale.
  const double scale = cross / z.squaredNorm();
  const stats::Uncertainty uncertainty(z * scale, e, inverse / scale, record, at);
  const double half = uncertainty.half_width(Eigen::VectorXd::Ones(1));
  out.interval = {out.value - half, out.value + half};
  return out;
}

Result identify_constant_acceleration(const std::vector<log::Record>& records,
                                      const EqualSpeedOptions& options) {
  if (records.empty()) throw Refused("constant acceleration: no record given");
  const MassEstimate mass = mass_at_equal_speed(records, options);
  if (!std::isfinite(mass.value) || !(mass.value > 0.0) || !(mass.interval.low > 0.0)) {
    throw Refused(fmt::format(
        "constant acceleration: no mass comes out of {} rows of sliding ({:.4g}, interval {:.4g} to "
        "{:.4g}); the axis must pass the same speed accelerating and braking, see excite --method "
        "constant-acceleration",
        mass.rows, mass.value, mass.interval.low, mass.interval.high));
  }
  Result r;
  r.method = Method::kConstantAcceleration;
  r.set_steady(SteadyModel::kNone);
  r.force_unit = records.front().force_unit;
  r.position_unit = records.front().position_unit;
  r.mass = mass.value;
  r.mass_interval = mass.interval;
  r.rows = mass.rows;
  r.parameters.push_back({"mass", mass.value, "kg", "N s2/mm", mass.interval.low, mass.interval.high, true});
  double top = 0.0;
  const auto bins = static_cast<std::size_t>(options.bins);
  std::vector<double> n(2 * bins), v(2 * bins), f(2 * bins), ff(2 * bins);
  for (const Row& row : rows_of(records, options, top)) {
    const double left = row.f - mass.value * row.a;
    n[row.bin] += 1.0, v[row.bin] += row.v, f[row.bin] += left, ff[row.bin] += left * left;
  }
  double low = 0.0, high = 0.0;
  for (std::size_t i = 0; i < 2 * bins; ++i) {
    const std::size_t b = i < bins ? 2 * bins - 1 - i : i - bins;
    if (n[b] < 2.0) continue;
    const double mean = f[b] / n[b];
    // Scatter of the rows, not an interval of the mean, because neighbouring rows are not independent.
    const double half = 1.96 * std::sqrt(std::max(0.0, ff[b] / n[b] - mean * mean));
    r.curve.push_back({v[b] / n[b], mean, mean - half, mean + half});
    r.map.push_back({v[b] / n[b], mean, b < bins ? 1 : -1});
    low = std::min(low, v[b] / n[b]);
    high = std::max(high, v[b] / n[b]);
  }
  r.velocity_range = {low, high};
  r.cannot_tell.push_back(
      "a model of friction: the points are the force less that of the mass, load included");
  return r;
}

}  // namespace stribeck::ident::methods
