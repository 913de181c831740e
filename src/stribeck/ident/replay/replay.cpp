#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/replay/replay.hpp>
#include <stribeck/ident/replay/replay_axis.hpp>
#include <stribeck/ident/replay/replay_loop.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <string>
#include <utility>

namespace stribeck::ident::replay {
namespace {

constexpr double kMostSubsteps = 4096.0;

/// Data of a record that a replay needs, computed once.
struct Course {
  const log::Record& record;
  log::Motion motion;
  std::vector<double> v;  ///< measured [m/s], NaN where not known
  double speed = 0.0;     ///< largest measured [m/s]

  explicit Course(const log::Record& r) : record(r), motion(log::reconstruct(r)), v(motion.v) {
    for (std::size_t k = 0; k < v.size(); ++k) {
      if (!r.v.empty()) {
        v[k] = r.v[k];
      } else if (!motion.valid(k)) {
        v[k] = kNaN;
      }
      if (std::isfinite(v[k])) speed = std::max(speed, std::abs(v[k]));
    }
    if (!(speed > 0.0)) throw Refused(r.source + ": the axis does not move, so that nothing can be verified");
  }
  [[nodiscard]] Start first() const { return start_of(record, 0, motion.position_noise); }
};

/// The held forces that act from t[k] to t[k+1]: that of row `row` for `share` of the period, then the next one.
struct Delay {
  std::ptrdiff_t whole = 0;
  double part = 0.0;  ///< of a period, 0 … 1

  Delay(double seconds, double period) {
    const double samples = seconds / period;
    whole = static_cast<std::ptrdiff_t>(std::floor(samples));
    part = samples - static_cast<double>(whole);
    if (part < 1e-9) part = 0.0;
  }
  template <class Axis, class Force>
  void advance(Axis& axis, std::size_t k, double period, const Force& force) const {
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(k) - whole;
    if (part > 0.0) axis.advance(force(row - 1), part * period);
    axis.advance(force(row), (1.0 - part) * period);
  }
};

void check(const friction::AxisModel& model, const log::Record& record, const ReplayOptions& options) {
  const auto wrong = log::problems(record);
  if (!wrong.empty()) throw Refused(wrong.front());
  if (!(model.mass > 0.0) || !std::isfinite(model.mass) || !std::isfinite(model.load))
    throw Refused(fmt::format("replay: mass {:g} kg, load {:g} N; expected a positive mass and a finite load",
                              model.mass, model.load));
  if (!(std::abs(options.delay) <= 100.0 * record.sample_time))
    throw Refused(fmt::format("replay: delay of {:g} s, expected at most 100 samples of {:g} s",
                              options.delay, record.sample_time));
}

void check_level(const friction::AxisModel& model, const Course& course) {
  // Friction that drives would run away. Files with it are refused elsewhere; this is for a model made in memory.
  double proportional = 0.0;
  for (const auto& term : model.friction.eccentric) {
    if (term.form == friction::EccentricForm::kProportional) proportional += term.amplitude;
  }
  for (int i = -200; i < 200; ++i) {
    const double v = course.speed * (i + 0.5) / 200.0;
    const double level =
        std::visit([v](const auto& m) { return m.parts(v, 0.0).level; }, model.friction.steady);
    if (!(level - proportional > 0.0)) {
      throw Refused(
          fmt::format("replay: friction without its viscous part is {:.4g} N at {:.4g} m/s, expected above 0",
                      level - proportional, v));
    }
  }
}

/// Stores row k of the prediction; refuses a run that has diverged.
template <class Axis>
void keep(const Axis& axis, std::size_t k, const Course& course, const friction::AxisModel& model,
          Replay& out) {
  constexpr double kFarOff = 1e4;
  const double v = axis.v();
  if (!(std::abs(v) < kFarOff * course.speed) || !std::isfinite(axis.x())) {
    throw Diverged(fmt::format(
        "{}: the motion of the model diverges from row {} on ({:.3g} m/s): its friction is too small for this force (check the sign of the force, the mass and the units)",
        course.record.source, k + 1, v));
  }
  out.x[k] = axis.x();
  out.v[k] = v;
  constexpr double kBeyond = 1.02;  // a loop overshoots, and the map hardly bends there
  out.outside += model.friction.covers(v / kBeyond) ? 0 : 1;
}

void score(const Course& course, bool force, Replay& out) {
  const log::Record& r = course.record;
  double dv = 0.0;
  double vv = 0.0;
  double dx = 0.0;
  double df = 0.0;
  double ff = 0.0;
  std::size_t rows = 0;
  out.position_most = 0.0;
  for (std::size_t k = 0; k < out.x.size(); ++k) {
    if (std::isfinite(course.v[k])) {
      dv += std::pow(out.v[k] - course.v[k], 2);
      vv += std::pow(course.v[k], 2);
      ++rows;
    }
    const double e = out.x[k] - r.x[k];
    dx += e * e;
    out.position_most = std::max(out.position_most, std::abs(e));
    df += std::pow(out.f[k] - r.f[k], 2);
    ff += std::pow(r.f[k], 2);
  }
  const auto n = static_cast<double>(out.x.size());
  out.position_rms = std::sqrt(dx / n);
  if (rows > 0) {
    out.velocity_rms = std::sqrt(dv / static_cast<double>(rows));
    out.velocity_relative = std::sqrt(dv / vv);
  }
  if (!force) return;
  out.force_rms = std::sqrt(df / n);
  if (ff > 0.0) out.force_relative = std::sqrt(df / ff);
}

}  // namespace

void check_substeps(double n, double dt, const char* what) {
  if (n <= kMostSubsteps) return;
  throw Diverged(fmt::format(
      "replay: {} {:.3g} sub-steps in a hold of {:.4g} s, more than {:g} (check mass and units, use the "
      "model without dynamics or a softer one)",
      what, n, dt, kMostSubsteps));
}

Start start_of(const log::Record& record, std::size_t row, double noise) {
  using Eigen::Index;
  constexpr std::size_t kFewest = 4;
  constexpr std::size_t kMost = 60;
  const double T = record.sample_time;
  Start start{record.x[row], 0.0};
  // As many rows as a parabola describes to within the noise: few where the axis starts at once, many where
  // the encoder is coarse.
  for (std::size_t n = kFewest; n <= kMost && row + n <= record.x.size(); n += 2) {
    Eigen::MatrixXd X(static_cast<Index>(n), 3);
    Eigen::VectorXd y(static_cast<Index>(n));
    for (std::size_t i = 0; i < n; ++i) {
      const auto s = static_cast<double>(i);
      X.row(static_cast<Index>(i)) << 1.0, s, s * s;
      y(static_cast<Index>(i)) = record.x[row + i] - record.x[row];
    }
    const Eigen::Vector3d c = stats::least_squares(X, y).x;
    const double left = std::sqrt((y - X * c).squaredNorm() / static_cast<double>(n - 3));
    if (n > kFewest && !(left <= 1.5 * noise)) break;
    const double deviation = std::max(left, noise) * std::sqrt(stats::inverse(stats::gram(X))(1, 1));
    start.v = std::abs(c(1)) > 3.0 * deviation ? c(1) / T : 0.0;
  }
  return start;
}

namespace {

/// Rows at which the axis turns and then travels by a thousandth of its stroke at least: at rest it turns often, within micrometres.
std::vector<std::size_t> turns_of(const std::vector<double>& x, double stroke) {
  constexpr double kLeastTravel = 1e-3;
  const double least = kLeastTravel * stroke;
  std::vector<std::size_t> turns;
  std::size_t low = 0;
  std::size_t high = 0;
  int direction = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (x[k] >= x[high]) high = k;
    if (x[k] <= x[low]) low = k;
    if (direction <= 0 && x[k] - x[low] > least) {
      if (direction < 0) turns.push_back(low);
      direction = 1;
      high = k;
    } else if (direction >= 0 && x[high] - x[k] > least) {
      if (direction > 0) turns.push_back(high);
      direction = -1;
      low = k;
    }
  }
  return turns;
}

/// Starts and measured velocities; nothing is predicted yet.
OpenLoop course_of(const Course& course) {
  OpenLoop out;
  out.measured_velocity = course.v;
  out.starts = {0};
  for (const std::size_t k : course.motion.reversals) {
    if (k > 0 && k < course.v.size() && std::isfinite(course.v[k])) out.starts.push_back(k);
  }
  out.reversals = turns_of(course.record.x, course.motion.stroke);
  for (Replay* replay : {&out.free, &out.restarted}) {
    replay->x.assign(course.v.size(), kNaN);
    replay->v = replay->x;
    replay->f = course.record.f;
  }
  return out;
}

}  // namespace

OpenLoop not_replayed(const log::Record& record) { return course_of(Course(record)); }

OpenLoop replay_open_loop(const friction::AxisModel& model, const log::Record& record,
                          const ReplayOptions& options) {
  check(model, record, options);
  const Course course(record);
  check_level(model, course);
  const std::size_t n = record.x.size();
  const double T = record.sample_time;
  const Delay delay(options.delay, T);
  const auto force = [&](std::ptrdiff_t k) {
    return record.f[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, std::ssize(record.f) - 1))];
  };
  OpenLoop out = course_of(course);
  for (Replay* replay : {&out.free, &out.restarted}) {
    with_axis(model.mass, model.load, model.friction, course.speed, [&](auto& axis) {
      const Start start = course.first();
      axis.place(start.x, start.v);
      axis.settle(force(-delay.whole));
      std::size_t next = 1;
      for (std::size_t k = 0; k < n; ++k) {
        if (replay == &out.restarted && next < out.starts.size() && k == out.starts[next]) {
          axis.place(record.x[k], course.v[k]);
          ++next;
        }
        keep(axis, k, course, model, *replay);
        if (k + 1 < n) delay.advance(axis, k, T, force);
      }
    });
    score(course, false, *replay);
  }
  return out;
}

Replay replay_closed_loop(const friction::AxisModel& model, const ReplayController& controller,
                          const log::Record& record, const ReplayOptions& options) {
  check(model, record, options);
  if (record.r.empty())
    throw Refused(record.source + ": no reference in the log, which a closed-loop replay follows");
  if (options.delay < 0.0)
    throw Refused(fmt::format(
        "replay: got a delay of {:g} s, expected at least 0: in closed loop a force acts after it is commanded",
        options.delay));
  const Course course(record);
  check_level(model, course);
  const std::size_t n = record.x.size();
  const double T = record.sample_time;
  const Delay delay(options.delay, T);
  Replay out;
  out.x.resize(n);
  out.v.resize(n);
  out.f.resize(n);
  with_axis(model.mass, model.load, model.friction, course.speed, [&](auto& axis) {
    const Start start = course.first();
    axis.place(start.x, start.v);
    axis.settle(record.f[0]);
    ControlLoop loop(controller, record, start);
    const auto force = [&](std::ptrdiff_t k) {
      return k < 0 ? record.f[0] : out.f[static_cast<std::size_t>(k)];
    };
    for (std::size_t k = 0; k < n; ++k) {
      keep(axis, k, course, model, out);
      out.f[k] = loop.force(k, out.x) + (options.added.empty() ? 0.0 : options.added[k]);
      if (k + 1 < n) delay.advance(axis, k, T, force);
    }
  });
  score(course, true, out);
  return out;
}

}  // namespace stribeck::ident::replay
