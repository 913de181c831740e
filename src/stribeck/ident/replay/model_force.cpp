#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/log/filter.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/replay/model_force.hpp>
#include <stribeck/ident/replay/moving_rows.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>
#include <utility>

namespace stribeck::ident::replay {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Column = std::vector<double>;

constexpr int kOrder = 4;
constexpr double kHighestShare = 0.8;  // of half the rate, for the low-pass of a slow log
constexpr std::size_t kFewestRows = 40;
constexpr int kPasses = 4;  // of Gauss–Newton; the shift moves by less than 1e-3 rows in the last one
constexpr int kFarPasses = 12;
constexpr double kFarStep = 10.0;     // rows
constexpr double kWorthShift = 0.25;  // rows: what a shift must differ by to be used
constexpr double kToldShift = 1e-4;   // share of the column of the shift that model errors do not explain
constexpr double kWorthGain = 0.98;   // of the error: what a shift must leave at most
constexpr double kWholePart = 0.01, kWorthPhase = 0.1 * kPi;

Column derivative(const Column& y, double T) {
  const std::size_t n = y.size();
  Column d(n);
  for (std::size_t k = 1; k + 1 < n; ++k) d[k] = (y[k + 1] - y[k - 1]) / (2.0 * T);
  d[0] = (y[1] - y[0]) / T;
  d[n - 1] = (y[n - 1] - y[n - 2]) / T;
  return d;
}

struct Filtered {
  double period = 0.0;  ///< T [s]
  Column x, v, a;
};

double within_pi(double angle) { return std::remainder(angle, 2.0 * kPi); }

/// Shift and phases that belong together, and the last step towards them.
struct OwnFit {
  double shift = 0.0;         ///< [rows]
  std::vector<double> phase;  ///< of the periodic terms [rad]
  MatrixXd X;
  VectorXd e, step;
  double rms = 0.0;  ///< [N]
};

class Scored {
 public:
  Scored(const friction::AxisModel& model, const log::Record& record, const ForceOptions& options)
      : model_(model), record_(record), options_(options) {
    const double T = record.sample_time;
    out_.cut_off = std::min(options.cut_off, kHighestShare * 0.5 / T);
    const auto most = static_cast<std::size_t>(std::max(1L, std::lround(options.row_time / T)));
    out_.factor = log::decimation_up_to(most);
    out_.band = out_.factor > 1 ? kHighestShare * 0.5 / (T * static_cast<double>(out_.factor)) : out_.cut_off;
  }

  ForceError run() {
    const std::size_t n = record_.x.size();
    if (n < options_.drop + kFewestRows * out_.factor) return std::move(out_);
    motion_ = motion_of(record_.x);
    out_.measured = thin(record_.f);
    out_.velocity = thin(motion_.v);
    out_.acceleration = thin(motion_.a);
    pick_rows();
    if (used_.size() < kFewestRows) return std::move(out_);
    filed_ = force_of(model_.friction, motion_);
    pick_moving_rows();
    score();
    if (std::optional<Scored> settled = where_settled()) return std::move(settled->out_);
    return std::move(out_);
  }

 private:
  [[nodiscard]] Column thin(const Column& column) const {
    const Column kept(column.begin() + static_cast<std::ptrdiff_t>(options_.drop), column.end());
    return out_.factor > 1 ? log::decimate(kept, out_.factor) : kept;
  }

  /// Row of the record behind each decimated one, counted back from the end as decimate() does; rows that count.
  void pick_rows() {
    const std::size_t n = record_.x.size();
    const std::size_t m = out_.measured.size();
    out_.row.resize(m);
    for (std::size_t i = 0; i < m; ++i) {
      out_.row[i] = n - 1 - (m - 1 - i) * out_.factor;
      if (record_.skip.empty() || record_.skip[out_.row[i]] == 0) used_.push_back(i);
    }
  }

  [[nodiscard]] Filtered motion_of(const Column& x) const {
    Filtered m;
    m.period = record_.sample_time;
    m.x = log::forward_backward(log::butterworth(kOrder, out_.cut_off * 2.0 * m.period), x);
    m.v = derivative(m.x, m.period);
    m.a = derivative(m.v, m.period);
    return m;
  }

  [[nodiscard]] Column force_of(const friction::Model& friction, const Filtered& m) const {
    Column f = friction_along(friction, m.x, m.v, m.period, record_.f[0] - model_.load);
    for (std::size_t k = 0; k < f.size(); ++k) f[k] += model_.mass * m.a[k] + model_.load;
    return f;
  }

  /// As a share of the force less a constant one, and RMS.
  [[nodiscard]] std::pair<double, double> error_of(const Column& modelled, double constant,
                                                   const std::vector<std::size_t>& rows) const {
    if (rows.empty()) return {kNaN, kNaN};
    double ee = 0.0, ff = 0.0;
    for (const std::size_t i : rows) {
      ee += std::pow(out_.measured[i] - modelled[i], 2.0);
      ff += std::pow(out_.measured[i] - constant, 2.0);
    }
    return {ff > 0.0 ? std::sqrt(ee / ff) : kNaN, std::sqrt(ee / static_cast<double>(rows.size()))};
  }

  /// The middle between the mean forces of both directions [N]: that of the log, so that all models are shares of the same force. Of one
  /// direction alone it is not known: 0.
  [[nodiscard]] double constant_force() const {
    std::array<double, 2> sum{}, rows{};
    for (const std::size_t i : moving_) {
      const std::size_t side = motion_.v[out_.row[i]] > 0.0 ? 0 : 1;
      sum[side] += out_.measured[i], rows[side] += 1.0;
    }
    return rows[0] > 0.0 && rows[1] > 0.0 ? 0.5 * (sum[0] / rows[0] + sum[1] / rows[1]) : 0.0;
  }

  /// Deviation of the velocity by white noise of the position, which the low-pass leaves up to its cut-off [m/s].
  [[nodiscard]] double velocity_noise() const {
    const double share = 2.0 * out_.cut_off * record_.sample_time;  // of half the sampling frequency
    return log::position_noise(record_.x) * 2.0 * kPi * out_.cut_off * std::sqrt(share / 3.0);
  }

  /// At rest a model without pre-sliding knows no force.
  void pick_moving_rows() {
    const RestRows rests{record_, out_.row, out_.velocity, velocity_noise(),
                         record_.sample_time * static_cast<double>(out_.factor)};
    moving_ = moving_rows(rests, used_);
    out_.at_rest = left_out();
    take_moving_rows();
  }
  void take_moving_rows() {
    fitted_ = moving_.size() < kFewestRows ? used_ : moving_;
    load_ = constant_force();
    out_.moving = moving_.size();
  }
  [[nodiscard]] double left_out() const {
    return 1.0 - static_cast<double>(moving_.size()) / static_cast<double>(used_.size());
  }
  void score() {
    errors_ = errors_of_model();
    std::tie(out_.relative, out_.rms) = error_of(thin(filed_), 0.0, used_);
    if (options_.of_log) share_of_log();
    fit_own();
    std::tie(out_.moving_relative, out_.moving_rms) = error_of(out_.modelled, load_, moving_);
    compare_friction();
  }

  /// While friction builds up after a reversal, a model without pre-sliding knows no force either. Whether it does so is asked only where
  /// no shift explains the force: a late force looks alike.
  [[nodiscard]] std::optional<Scored> where_settled() const {
    constexpr double kBad = 0.1, kMost = 0.1;  // of the force; of the rows
    const bool asked = !friction::has_pre_sliding(model_.friction.dynamics) && moving_.size() >= kFewestRows;
    if (!asked || !(out_.own_relative > kBad) || out_.of_rests()) return {};
    Column friction = filed_;
    for (std::size_t k = 0; k < friction.size(); ++k) friction[k] -= model_.mass * motion_.a[k] + model_.load;
    const double late = expected_shift(model_, record_, options_.control_period) / record_.sample_time;
    const Column measured = thin(log::align_force(record_.f, late));
    Scored other = *this;
    other.risen_ = 0, other.out_.or_pre_sliding = false;
    other.moving_ = settled_rows({motion_.x, out_.row, measured, thin(filed_), thin(friction)}, moving_);
    other.out_.unsettled = other.left_out() - out_.at_rest;
    if (!(other.out_.unsettled > 0.0) || other.out_.unsettled > kMost) return {};
    other.take_moving_rows();
    other.score();
    return other.out_.of_rests() ? std::optional<Scored>(std::move(other)) : std::nullopt;
  }

  /// Of the rows whose friction the model tells.
  void compare_friction() {
    friction::Model sliding = model_.friction;
    sliding.eccentric.clear();
    sliding.spring.reset();
    std::vector<std::size_t> told;
    for (const std::size_t i : moving_) {
      if (std::abs(out_.velocity[i]) >= options_.told_from) told.push_back(i);
    }
    if (!moving_.empty())
      out_.untold = 1.0 - static_cast<double>(told.size()) / static_cast<double>(moving_.size());
    const Column friction =
        thin(friction_along(sliding, motion_.x, motion_.v, motion_.period, record_.f[0] - model_.load));
    out_.friction = friction_changes(
        {out_.measured, out_.modelled, friction, out_.velocity, out_.acceleration, model_.load}, told);
  }

  /// Friction that rises after each reversal over a distance [m], with the sign of the motion.
  [[nodiscard]] Column risen_over(double distance) const {
    Column risen(motion_.x.size());
    double z = 0.0;
    for (std::size_t k = 1; k < risen.size(); ++k) {
      const double moved = motion_.x[k] - motion_.x[k - 1];
      z += ((moved > 0.0 ? 1.0 : -1.0) - z) * -std::expm1(-std::abs(moved) / distance);
      risen[k] = z;
    }
    return risen;
  }

  /// What a wrong mass, friction, load, pre-sliding or a spring leaves: a model that is wrong in these is not late.
  [[nodiscard]] MatrixXd errors_of_model() {
    // Sliding friction is that of v and sgn v; only bristles change it otherwise.
    const bool bristles = friction::has_pre_sliding(model_.friction.dynamics);
    std::vector<Column> columns(bristles ? 6 : 5);
    for (std::size_t k = 0; k < motion_.x.size(); ++k) {
      const double v = motion_.v[k];
      columns[0].push_back(motion_.a[k]);
      columns[1].push_back(v);
      columns[2].push_back(v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0);
      columns[3].push_back(motion_.x[k] - motion_.x.front());
      columns[4].push_back(1.0);
      if (bristles) columns[5].push_back(filed_[k] - model_.mass * motion_.a[k]);
    }
    // Without bristles in the model a force that rises over a distance after a reversal looks late at every one.
    if (!bristles) {
      for (const double distance : {4e-6, 20e-6}) columns.push_back(risen_over(distance)), ++risen_;
    }
    MatrixXd X(static_cast<Index>(fitted_.size()), std::ssize(columns));
    for (Index j = 0; j < X.cols(); ++j) {
      const Column c = thin(columns[static_cast<std::size_t>(j)]);
      for (std::size_t i = 0; i < fitted_.size(); ++i) X(static_cast<Index>(i), j) = c[fitted_[i]];
      const double norm = X.col(j).norm();
      if (norm > 0.0) X.col(j) *= std::sqrt(static_cast<double>(fitted_.size())) / norm;
    }
    return X;
  }

  /// Columns of the shift (unless it is known), of sine and cosine of each periodic term, and beside a shift those of the model's errors.
  [[nodiscard]] MatrixXd regressors(const Column& modelled, bool shift_known) const {
    const auto& terms = model_.friction.eccentric;
    const Index first = shift_known ? 0 : 1;
    const Index behind = first + 2 * static_cast<Index>(terms.size());
    MatrixXd X(static_cast<Index>(fitted_.size()), behind + (shift_known ? 0 : errors_.cols()));
    if (!shift_known) X.rightCols(errors_.cols()) = errors_;
    const auto put = [&](Index j, const Column& column) {
      const Column c = thin(column);
      for (std::size_t i = 0; i < fitted_.size(); ++i) X(static_cast<Index>(i), j) = -c[fitted_[i]];
    };
    if (first > 0) put(0, derivative(modelled, 1.0));
    Index j = first;
    for (const auto& term : terms) {
      Column s(motion_.x.size()), c(motion_.x.size());
      for (std::size_t k = 0; k < s.size(); ++k) {
        const double angle = 2.0 * kPi * motion_.x[k] / term.period;
        const double sign =
            term.form == friction::EccentricForm::kAdditive || motion_.v[k] > 0.0 ? -1.0 : 1.0;
        s[k] = sign * std::sin(angle);
        c[k] = sign * std::cos(angle);
      }
      put(j++, s);
      put(j++, c);
    }
    return X;
  }

  void share_of_log();
  [[nodiscard]] std::optional<double> far_shift(double from) const;
  [[nodiscard]] OwnFit fit_from(double shift, bool shift_known) const;
  [[nodiscard]] OwnFit best_fit(double expected) const;
  void fit_own();
  [[nodiscard]] double phase_used(std::size_t j) const;
  void judge(const OwnFit& fit);

  const friction::AxisModel& model_;
  const log::Record& record_;
  const ForceOptions& options_;
  Filtered motion_;
  Column filed_;                     ///< force of the model as it stands, at every row [N]
  std::vector<std::size_t> used_;    ///< decimated rows that count
  std::vector<std::size_t> moving_;  ///< those in which the axis moves
  std::vector<std::size_t> fitted_;  ///< those that tell shift and phases: of a rest nothing is known
  MatrixXd errors_;                  ///< errors_of_model()
  Index risen_ = 0;                  ///< columns of pre-sliding, the last ones of them
  double load_ = 0.0;                ///< constant force of the log [N]
  ForceError out_;
};

void Scored::share_of_log() {
  constexpr double kUniform = 3.4641016151377544;  // width of a uniform distribution of deviation 1
  const std::size_t n = record_.x.size();
  std::mt19937_64 random(1);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 - 0.5; };
  const double noise = log::position_noise(record_.x);
  Column noisy(n), coarse = record_.x, moved(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) noisy[k] = record_.x[k] + noise * kUniform * uniform();
  // Every other row from its neighbours, by a cubic.
  for (std::size_t k = 3; k + 3 < n; k += 2)
    coarse[k] = (9.0 * (record_.x[k - 1] + record_.x[k + 1]) - record_.x[k - 3] - record_.x[k + 3]) / 16.0;
  for (std::size_t k = 0; k + 1 < n; ++k) moved[k] = uniform() * (record_.f[k + 1] - record_.f[k]);
  const Column plain = thin(filed_), late = thin(moved);
  std::array<Column, 2> other;
  other[0] = thin(force_of(model_.friction, motion_of(noisy)));
  other[1] = thin(force_of(model_.friction, motion_of(coarse)));
  const auto share = [&](const std::vector<std::size_t>& rows) {
    double sum = 0.0, ff = 0.0;
    for (const std::size_t i : rows) {
      sum +=
          std::pow(other[0][i] - plain[i], 2.0) + std::pow(other[1][i] - plain[i], 2.0) + late[i] * late[i];
      ff += std::pow(out_.measured[i] - load_, 2.0);
    }
    return ff > 0.0 ? std::sqrt(sum / ff) : kNaN;
  };
  out_.of_log = share(used_);
  out_.of_log_moving = share(moving_);
}

/// The shift alone, from far off: beside a fast periodic term the next least sum of squares is a period away. Absent where the motion does
/// not tell it from the errors of the model.
std::optional<double> Scored::far_shift(double from) const {
  friction::Model plain = model_.friction;
  plain.eccentric.clear();
  const Column modelled = model_.friction.eccentric.empty() ? filed_ : force_of(plain, motion_);
  const Column model_thin = thin(modelled), slope = thin(derivative(modelled, 1.0));
  VectorXd late(static_cast<Index>(fitted_.size())), e(late.size());
  for (Index i = 0; i < late.size(); ++i) late(i) = -slope[fitted_[static_cast<std::size_t>(i)]];
  const double whole = late.squaredNorm();
  // From far off, the first step would take a late force for pre-sliding.
  const MatrixXd sliding = errors_.leftCols(errors_.cols() - risen_);
  late -= sliding * stats::least_squares(sliding, late).x;
  const double square = late.squaredNorm();
  if (!(square > kToldShift * whole)) return {};
  double shift = from;
  for (int pass = 0; pass < kFarPasses; ++pass) {
    const Column measured = thin(log::align_force(record_.f, shift));
    for (Index i = 0; i < e.size(); ++i) {
      const std::size_t row = fitted_[static_cast<std::size_t>(i)];
      e(i) = measured[row] - model_thin[row];
    }
    const double step = std::clamp(late.dot(e) / square, -kFarStep, kFarStep);
    shift = std::clamp(shift + step, -kMostShift, kMostShift);
    if (std::abs(step) < 0.05) break;
  }
  return shift;
}

OwnFit Scored::fit_from(double shift, bool shift_known) const {
  OwnFit fit;
  fit.shift = shift;
  friction::Model friction = model_.friction;
  for (const auto& term : friction.eccentric) fit.phase.push_back(term.phase);
  fit.e.resize(static_cast<Index>(fitted_.size()));
  Column whole = filed_, modelled = thin(whole);
  for (int pass = 0; pass < kPasses; ++pass) {
    for (std::size_t j = 0; j < fit.phase.size(); ++j) friction.eccentric[j].phase = fit.phase[j];
    if (pass > 0 && !fit.phase.empty()) {  // only the phases move the force of the model
      whole = force_of(friction, motion_);
      modelled = thin(whole);
    }
    const Column measured = thin(log::align_force(record_.f, fit.shift));
    for (std::size_t i = 0; i < fitted_.size(); ++i)
      fit.e(static_cast<Index>(i)) = measured[fitted_[i]] - modelled[fitted_[i]];
    fit.rms = fit.e.norm() / std::sqrt(static_cast<double>(fitted_.size()));
    if (pass == 0 || !fit.phase.empty()) fit.X = regressors(whole, shift_known);
    if (fit.X.cols() == 0) break;
    fit.step = stats::least_squares(fit.X, fit.e).x;
    if (pass + 1 == kPasses) break;
    Index j = 0;
    if (!shift_known)
      fit.shift = std::clamp(fit.shift + std::clamp(fit.step(j++), -2.0, 2.0), -kMostShift, kMostShift);
    for (std::size_t i = 0; i < fit.phase.size(); ++i, j += 2) {
      const double A = friction.eccentric[i].amplitude;
      const double s = A * std::cos(fit.phase[i]) + fit.step(j),
                   c = -A * std::sin(fit.phase[i]) + fit.step(j + 1);
      fit.phase[i] = std::atan2(-c, s);
    }
  }
  return fit;
}

/// Without periodic terms one least sum of squares is near. Beside them the search from far off takes a part of their force for a
/// shift, so the search begins at the expected one as well.
OwnFit Scored::best_fit(double expected) const {
  const std::optional<double> far = far_shift(expected);
  if (!far) return fit_from(expected, true);
  OwnFit best = fit_from(*far, false);
  if (model_.friction.eccentric.empty()) return best;
  OwnFit near = fit_from(expected, false);
  return near.rms < best.rms ? std::move(near) : std::move(best);
}

void Scored::fit_own() {
  const double T = record_.sample_time;
  const double expected = expected_shift(model_, record_, options_.control_period) / T;
  const bool given = options_.shift.has_value();
  OwnFit fit = given ? fit_from(*options_.shift / T, true) : best_fit(expected);
  judge(fit);
  if (!given && out_.shifted) {
    // A shift that brings the force hardly closer to the model is none: beside it, errors of the model and amplitudes were free.
    OwnFit unshifted = fit_from(expected, true);
    if (fit.rms > kWorthGain * unshifted.rms) {
      fit = std::move(unshifted);
      judge(fit);
    }
  }
  if (!given && out_.shifted && risen_ > 0) {
    // Begun where no shift is, the same fit stays there where pre-sliding explains the force.
    constexpr double kStays = 0.5;
    const double near = fit_from(expected, false).shift;
    out_.or_pre_sliding = std::abs(near - expected) < kStays * std::abs(fit.shift - expected);
  }
  const double shift = given || out_.shifted ? fit.shift : expected;
  out_.measured = thin(log::align_force(record_.f, shift));
  out_.modelled = thin(filed_);
  std::tie(out_.filed_relative, out_.filed_rms) = error_of(out_.modelled, load_, used_);
  std::tie(out_.own_relative, out_.own_rms) = std::tie(out_.filed_relative, out_.filed_rms);
  if (fit.phase.empty()) return;
  friction::Model friction = model_.friction;
  for (std::size_t j = 0; j < fit.phase.size(); ++j) friction.eccentric[j].phase = phase_used(j);
  out_.modelled = thin(force_of(friction, motion_));
  std::tie(out_.own_relative, out_.own_rms) = error_of(out_.modelled, load_, used_);
}

/// Phase of a term in this record. What the record does not tell moves with a term that it is a whole part of, as a new
/// homing position moves both; else it stays.
double Scored::phase_used(std::size_t j) const {
  const RecordPhase& own = out_.phases[j];
  if (own.determined) return own.found;
  for (const RecordPhase& p : out_.phases) {
    const double ratio = p.period / own.period;
    if (p.determined && ratio > 1.5 && std::abs(ratio - std::round(ratio)) < kWholePart)
      return own.stored + (p.found - p.stored) * std::round(ratio);
  }
  return own.stored;
}

void Scored::judge(const OwnFit& fit) {
  const double T = record_.sample_time;
  const auto& [shift, phase, X, e, step, rms] = fit;
  out_.shift = shift * T;
  out_.shift_half = 0.0;
  out_.shifted = false;
  out_.phases.clear();
  if (X.cols() == 0) return;
  const MatrixXd inverse = stats::pseudo_inverse(stats::gram(X));
  const stats::Uncertainty uncertainty(X, e - X * step, inverse, std::vector<int>(fitted_.size(), 0),
                                       fitted_);
  Index j = 0;
  if (X.cols() > 2 * std::ssize(phase)) {
    const double half = uncertainty.half_width(VectorXd::Unit(X.cols(), j++));
    const double off = std::abs(shift - expected_shift(model_, record_, options_.control_period) / T);
    out_.shift_half = half * T;
    out_.shifted = std::isfinite(half) && std::abs(shift) < kMostShift && off > std::max(half, kWorthShift);
  }
  for (std::size_t i = 0; i < phase.size(); ++i, j += 2) {
    const auto& term = model_.friction.eccentric[i];
    const double s = term.amplitude * std::cos(phase[i]) + step(j);
    const double c = -term.amplitude * std::sin(phase[i]) + step(j + 1);
    const double size = std::hypot(s, c);
    VectorXd along = VectorXd::Zero(X.cols()), across = along;
    along(j) = s / size, along(j + 1) = c / size;
    across(j) = c / (size * size), across(j + 1) = -s / (size * size);
    RecordPhase one;
    one.period = term.period;
    one.stored = term.phase;
    one.found = term.phase + within_pi(phase[i] - term.phase);
    one.half_width = uncertainty.half_width(across);
    one.determined = uncertainty.half_width(along) < size && one.half_width < 0.5 * kPi;
    one.differs = one.determined && std::abs(one.found - one.stored) > std::max(one.half_width, kWorthPhase);
    out_.phases.push_back(one);
  }
}

}  // namespace

// A held force belongs to the motion half of its hold later, without any delay (log/motion.hpp).
double expected_shift(const friction::AxisModel& model, const log::Record& record, double control_period) {
  return -0.5 * log::hold_of(control_period, record.sample_time) - model.delay_or_none();
}

ForceError force_error(const friction::AxisModel& model, const log::Record& record,
                       const ForceOptions& options) {
  const auto wrong = log::problems(record);
  if (!wrong.empty()) throw Refused(wrong.front());
  return Scored(model, record, options).run();
}

}  // namespace stribeck::ident::replay
