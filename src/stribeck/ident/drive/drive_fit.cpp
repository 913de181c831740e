#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stribeck/ident/drive/drive_fit_parts.hpp>

namespace stribeck::ident::drive {
namespace {

/// exp(−6) = 0.25 % of the swing at a reversal is left beyond six relaxation lengths.
constexpr double kRelaxations = 6.0;
constexpr double kSmallSpeed = 0.04;  // of the largest: below it only the lag and the bristle are seen
constexpr double kSlowestLoop = 0.6;  // [s] that a position follows its reference by

}  // namespace

Result DriveFit::run() {
  prepare();
  pilot();
  if (!options_.shift) find_shift();
  settle();
  map::StaticChoice choice = choose();
  if (options_.periodic) choice = try_periodic(std::move(choice));
  choice_ = std::move(choice);
  intervals();
  return finish();
}

void DriveFit::prepare() {
  if (records_.empty()) throw Refused("identification: no record given");
  motions_.reserve(records_.size()), force_.reserve(records_.size());
  for (const log::Record& r : records_) {
    const auto wrong = log::problems(r);
    if (!wrong.empty()) throw Refused(wrong.front());
    if (r.force_unit != records_.front().force_unit || r.position_unit != records_.front().position_unit) {
      throw Refused(r.source + ": its force is in " + r.force_unit + " and its position in " +
                    r.position_unit + ", expected " + records_.front().force_unit + " and " +
                    records_.front().position_unit + " as in " + records_.front().source);
    }
    log::MotionOptions motion;
    motion.cut_off = options_.cut_off;
    shift_ = options_.shift.value_or(-0.5);
    motion.shift = shift_;
    motion.smoothed_force = &force_.emplace_back();
    motions_.push_back(log::reconstruct(r, motion));
    predict(r, motions_.back());
    if (motions_.back().loop == log::Loop::kAutomatic) {
      warn(r.source +
           ": no reference and no programmed force: the mass rests on smoothed accelerations alone");
    }
  }
}

void DriveFit::predict(const log::Record& record, log::Motion& m) {
  predicted_.emplace_back();
  if (m.loop != log::Loop::kClosed || record.r.empty()) return;
  const std::vector<double> r = log::smooth_like(m, record.r);
  const auto n = static_cast<std::ptrdiff_t>(r.size());
  std::vector<double> rate(r.size(), 0.0);
  for (std::size_t k = 1; k + 1 < r.size(); ++k) rate[k] = (r[k + 1] - r[k - 1]) / (2.0 * m.sample_time);
  std::vector<std::ptrdiff_t> lags{-1, 0, 1, 2, 3, 4};
  const auto longest =
      std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(kSlowestLoop / m.sample_time), n / 8);
  while (lags.back() * 4 / 3 + 1 <= longest) lags.push_back(lags.back() * 4 / 3 + 1);
  const auto count = static_cast<Index>(lags.size());
  const auto row = [&](std::ptrdiff_t k, VectorXd& c) {
    for (Index j = 0; j < count; ++j) {
      const std::ptrdiff_t at = std::clamp<std::ptrdiff_t>(k - lags[static_cast<std::size_t>(j)], 0, n - 1);
      c(j) = rate[static_cast<std::size_t>(at)];
    }
  };
  MatrixXd normal = MatrixXd::Zero(count, count);
  VectorXd right = VectorXd::Zero(count), c(count);
  const std::ptrdiff_t step = n / 20000 + 1;
  for (std::ptrdiff_t k = m.reach; k + m.reach < n; k += step) {
    row(k, c);
    normal.selfadjointView<Eigen::Lower>().rankUpdate(c);
    right += c * m.v[static_cast<std::size_t>(k)];
  }
  // Neighbouring lags see nearly the same: a weak pull keeps their weights small.
  normal.diagonal().array() += 1e-6 * normal.trace() / static_cast<double>(count);
  const VectorXd h = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
  std::vector<double>& v = predicted_.back();
  v.assign(r.size(), 0.0);
  // Lag by lag over pieces that stay in the cache.
  constexpr std::ptrdiff_t kPiece = 2048;
  for (std::ptrdiff_t from = 0; from < n; from += kPiece) {
    const std::ptrdiff_t to = std::min(n, from + kPiece);
    for (Index j = 0; j < count; ++j) {
      const std::ptrdiff_t lag = lags[static_cast<std::size_t>(j)];
      const std::ptrdiff_t inner = std::clamp(lag, from, to), outer = std::clamp(n + lag, inner, to);
      for (std::ptrdiff_t k = from; k < inner; ++k) v[static_cast<std::size_t>(k)] += h(j) * rate.front();
      Eigen::Map<VectorXd>(v.data() + inner, outer - inner) +=
          h(j) * Eigen::Map<const VectorXd>(rate.data() + (inner - lag), outer - inner);
      for (std::ptrdiff_t k = outer; k < to; ++k) v[static_cast<std::size_t>(k)] += h(j) * rate.back();
    }
  }
  for (std::size_t k = 1; k + 1 < r.size(); ++k)
    m.instrument[k] = (v[k + 1] - v[k - 1]) / (2.0 * m.sample_time);
}

Level DriveFit::level() {
  bare_ = line_;
  Level l;
  for (std::size_t s = 0; s < map::kSides; ++s) {
    for (double& f : bare_[s].force) f -= map::kDirection[s] * offset_;
    l.viscous[s] = std::max(0.0, bare_[s].line().slope);
  }
  l.map = &bare_;
  return l;
}

void DriveFit::pilot() {
  double stroke = 0.0;
  double hysteresis = 0.0;
  for (const log::Motion& m : motions_) {
    stroke = std::max(stroke, m.stroke);
    hysteresis = std::max(hysteresis, 20.0 * m.position_noise);
    for (std::size_t k = 0; k < m.rows(); ++k) {
      double& top = top_[m.v[k] > 0.0 ? 0 : 1];
      if (m.valid(k)) top = std::max(top, std::abs(m.v[k]));
    }
  }
  near_ = std::max(hysteresis, 2e-3 * stroke);
  gather(near_, kSmallSpeed, 0.0);
  thin_out();
  mass_ = options_.mass.value_or(0.0);
  solve(false);
  solve(true);
}

void DriveFit::settle() {
  take_all();
  const Relaxation relaxation = find_relaxation(motions_, level(), mass_, offset_, near_);
  const double length = relaxation.length;
  const auto lag = [&] {
    if (length > 0.0) find_lag(motions_, level(), relaxation, rows_);
  };
  if (length > 0.0) {
    result_.break_away_distance = length;
    gather(kRelaxations * length, 0.5 * kSmallSpeed, length);
  } else {
    gather(near_, kSmallSpeed, 0.0);
    warn(
        "no reversal of motion in the log: the distance to break away is not known and nothing is left out "
        "for it");
  }
  thin_out();
  if (shift_free_) ask();
  if (length > 0.0) {
    lag();
    solve(true);
    lag();
  }
  solve(true);
  if (!options_.shift) judge_shift();
  if (!thin_) return;
  take_all();
  lag();
  if (shift_free_) ask();
  solve(true);
}

namespace {

/// Of the held-out force: what another explanation must leave less to be taken.
constexpr double kBetter = 0.9;
/// A programmed force under its hold belongs to the middle of its row.
constexpr double kNoShift = -0.5;

double shift_of(const Result& r) {
  for (const Parameter& p : r.parameters) {
    if (p.name == "force_shift") return p.value;
  }
  return 0.0;
}

}  // namespace

Result identify_drive(const std::vector<log::Record>& records, const DriveFitOptions& options) {
  Result result = DriveFit(records, options).run();
  const double shift = shift_of(result);
  if (shift == 0.0 || !result.friction.eccentric.empty() || !options.periodic) return result;
  // A loop that works against a force periodic in position looks like a shift, and a wrong shift hides the term.
  DriveFitOptions without = options;
  without.shift = kNoShift;
  Result other = DriveFit(records, without).run();
  if (other.friction.eccentric.empty() || !(other.held_out_rms < kBetter * result.held_out_rms))
    return result;
  other.warnings.push_back(text(
      "the force seemed to be %.3g ms %s than its motion; with periodic terms instead, the residual is %.3g in place of %.3g %s, so no shift is removed",
      1e3 * std::abs(shift), shift > 0.0 ? "later" : "earlier", other.held_out_rms, result.held_out_rms,
      other.force_unit.c_str()));
  return other;
}

}  // namespace stribeck::ident::drive
