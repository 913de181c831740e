#include <Eigen/Core>
#include <algorithm>
#include <stribeck/ident/drive/aligned_log.hpp>
#include <stribeck/ident/log/filter.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <string>
#include <utility>

namespace stribeck::ident::drive {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSlowestLoop = 0.6;  // [s] longest time by which a position lags behind its reference

/// Delays [rows] at which the velocity of the reference may act.
std::vector<std::ptrdiff_t> delays(double sample_time, std::ptrdiff_t rows) {
  std::vector<std::ptrdiff_t> out{-1, 0, 1, 2, 3, 4};
  const auto longest =
      std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(kSlowestLoop / sample_time), rows / 8);
  while (out.back() * 4 / 3 + 1 <= longest) out.push_back(out.back() * 4 / 3 + 1);
  return out;
}

/// Weight of each delay, from least squares on the measured velocity.
VectorXd weights_of(const std::vector<double>& rate, const log::Motion& m,
                    const std::vector<std::ptrdiff_t>& lags) {
  const auto n = static_cast<std::ptrdiff_t>(rate.size());
  const auto count = static_cast<Eigen::Index>(lags.size());
  MatrixXd normal = MatrixXd::Zero(count, count);
  VectorXd right = VectorXd::Zero(count), c(count);
  const std::ptrdiff_t step = n / 20000 + 1;
  for (std::ptrdiff_t k = m.reach; k + m.reach < n; k += step) {
    for (Eigen::Index j = 0; j < count; ++j) {
      const std::ptrdiff_t at = std::clamp<std::ptrdiff_t>(k - lags[static_cast<std::size_t>(j)], 0, n - 1);
      c(j) = rate[static_cast<std::size_t>(at)];
    }
    normal.selfadjointView<Eigen::Lower>().rankUpdate(c);
    right += c * m.v[static_cast<std::size_t>(k)];
  }
  // Neighbouring delays have nearly the same effect: a weak pull keeps their weights small.
  normal.diagonal().array() += 1e-6 * normal.trace() / static_cast<double>(count);
  return stats::solve_ldlt(normal, right);
}

/// Σ h_j·rate(k − l_j); the first and last values continue beyond the ends.
std::vector<double> weighted(const std::vector<double>& rate, const std::vector<std::ptrdiff_t>& lags,
                             const VectorXd& h) {
  const auto n = static_cast<std::ptrdiff_t>(rate.size());
  std::vector<double> v(rate.size(), 0.0);
  // One delay after the other, over pieces that stay in the cache.
  constexpr std::ptrdiff_t kPiece = 2048;
  for (std::ptrdiff_t from = 0; from < n; from += kPiece) {
    const std::ptrdiff_t to = std::min(n, from + kPiece);
    for (Eigen::Index j = 0; j < h.size(); ++j) {
      const std::ptrdiff_t lag = lags[static_cast<std::size_t>(j)];
      const std::ptrdiff_t inner = std::clamp(lag, from, to), outer = std::clamp(n + lag, inner, to);
      for (std::ptrdiff_t k = from; k < inner; ++k) v[static_cast<std::size_t>(k)] += h(j) * rate.front();
      Eigen::Map<VectorXd>(v.data() + inner, outer - inner) +=
          h(j) * Eigen::Map<const VectorXd>(rate.data() + (inner - lag), outer - inner);
      for (std::ptrdiff_t k = outer; k < to; ++k) v[static_cast<std::size_t>(k)] += h(j) * rate.back();
    }
  }
  return v;
}

void require_one_axis(const log::Record& r, const log::Record& first) {
  const auto wrong = log::problems(r);
  if (!wrong.empty()) throw Refused(wrong.front());
  if (r.force_unit != first.force_unit || r.position_unit != first.position_unit) {
    throw Refused(r.source + ": its force is in " + r.force_unit + " and its position in " + r.position_unit +
                  ", expected " + first.force_unit + " and " + first.position_unit + " as in " +
                  first.source);
  }
}

/// Whether the reference asks for most of the acceleration, or the measured motion is too noisy to stand in for it.
bool asks_for_motion(const std::vector<double>& predicted, const log::Motion& m) {
  constexpr double kMost = 0.5;    // of the square
  constexpr double kNoisy = 0.05;  // of the square
  const std::vector<double> v = log::calm_velocity(m);
  double own = 0.0, asked = 0.0, both = 0.0, rows = 0.0;
  const std::size_t edge = log::calm_reach(m) + 1;
  for (std::size_t k = edge; k + edge < v.size(); ++k) {
    const double a = (v[k + 1] - v[k - 1]) / (2.0 * m.sample_time);
    const double r = (predicted[k + 1] - predicted[k - 1]) / (2.0 * m.sample_time);
    own += a * a, asked += r * r, both += a * r, rows += 1.0;
  }
  return both * both >= kMost * own * asked || log::calm_noise(m) * rows > kNoisy * own;
}

/// Whether the noise of the position is next to nothing in the acceleration. A calmer motion is then no better instrument than the
/// acceleration itself, and a worse one where it reaches over reversals.
bool quiet(const log::Motion& m) {
  constexpr double kQuiet = 1e-3;  // of the square
  double square = 0.0, rows = 0.0;
  for (std::size_t k = 0; k < m.rows(); ++k) {
    if (m.sliding(k, 0.0)) square += m.a[k] * m.a[k], rows += 1.0;
  }
  const double size = m.position_noise / (m.sample_time * m.sample_time);
  const double noise = size * size * log::second_difference_variance(log::box_weights(m.window));
  return noise * rows < kQuiet * square;
}

}  // namespace

std::vector<double> predicted_velocity(const log::Record& record, const log::Motion& m) {
  if (m.loop != log::Loop::kClosed || record.r.empty()) return {};
  const std::vector<double> r = log::smooth_like(m, record.r);
  std::vector<double> rate(r.size(), 0.0);
  for (std::size_t k = 1; k + 1 < r.size(); ++k) rate[k] = (r[k + 1] - r[k - 1]) / (2.0 * m.sample_time);
  const std::vector<std::ptrdiff_t> lags = delays(m.sample_time, static_cast<std::ptrdiff_t>(r.size()));
  return weighted(rate, lags, weights_of(rate, m, lags));
}

AlignedLog reconstruct_all(std::span<const log::Record> records, double cut_off, std::optional<double> shift,
                           Notes& notes, bool mass_is_given) {
  if (records.empty()) throw Refused("identification: no record given");
  AlignedLog out;
  out.records = records;
  out.shift = shift.value_or(kHeldForce);
  for (const log::Record& r : records) {
    require_one_axis(r, records.front());
    std::vector<double> force;
    log::MotionOptions options;
    options.cut_off = cut_off;
    options.shift = out.shift;
    options.smoothed_force = &force;
    log::Motion m = log::reconstruct(r, options);
    std::vector<double> v = predicted_velocity(r, m);
    // The force of a loop that works on the noise of its encoder agrees with the noise of this very motion.
    const bool alone = v.empty() ? m.loop == log::Loop::kAutomatic : !asks_for_motion(v, m);
    if (alone) v = log::calm_velocity(m);
    if (alone && !(m.cut_off > 0.0) && quiet(m)) {
      m.instrument = m.a;
    } else {
      for (std::size_t k = 1; k + 1 < v.size(); ++k)
        m.instrument[k] = (v[k + 1] - v[k - 1]) / (2.0 * m.sample_time);
    }
    if (m.loop == log::Loop::kAutomatic && !mass_is_given) {
      std::string text =
          r.source +
          ": no reference and no programmed force: the mass is found from smoothed accelerations alone";
      // A log with gaps has many records.
      if (std::find(notes.warnings.begin(), notes.warnings.end(), text) == notes.warnings.end())
        notes.warn(std::move(text));
    }
    out.motions.push_back(std::move(m));
    out.force.push_back(std::move(force));
    out.predicted.push_back(std::move(v));
  }
  return out;
}

}  // namespace stribeck::ident::drive
