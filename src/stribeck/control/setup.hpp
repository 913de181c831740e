#pragma once
/// The interface of every controller: what it may know of the machine (Setup), and the parts that all laws share (Common).
///
/// A controller for N axes is
///
///   template <std::size_t N> class Name {
///     using Params = NameParams;                                  // fields(), kKind, kLabel; see laws.hpp
///     Name(const Params&, const Setup<N>&);                       // configure only
///     Vec<double, N> step(State&, const path::PathPoint<N>& r, const Vec<double, N>& measured) const;   // [m] → [N]
///   }
///
/// Every controller answers inputs that are not finite with its last forces and Status::kNotFinite, and keeps its forces
/// within ±force_limit. A new law: docs/guides/write-a-controller.md.
/// Real time: safe; constructors configure only.

#include <limits>
#include <stribeck/control/compensation/compensation.hpp>
#include <stribeck/control/gains.hpp>
#include <stribeck/control/tracking_error.hpp>
#include <stribeck/path/reference.hpp>

namespace stribeck::control {

/// Largest number of axes of a machine.
inline constexpr std::size_t kMostAxes = 6;

/// One value for each axis, or for each direction of the path's frame (tangent first). The last value of a shorter list holds for
/// the rest: (20, 40) means 20 along the path and 40 across it, whatever the number of axes.
using PerAxis = FixedVector<double, kMostAxes>;

/// The values of the first N axes or directions; `otherwise` for each where the list is empty.
template <std::size_t N>
constexpr Vec<double, N> spread(const PerAxis& list, double otherwise = 0.0) noexcept {
  Vec<double, N> v;
  for (std::size_t i = 0; i < N; ++i)
    v[i] = list.empty() ? otherwise : list[i < list.size() ? i : list.size() - 1];
  return v;
}

template <std::size_t N>
struct Setup {
  double period = 1e-3;  ///< control period T [s]
  /// Range of the path's parameter after which the path repeats; NaN: it does not repeat.
  double lap = std::numeric_limits<double>::quiet_NaN();
  std::array<CompensationParams, N> compensation;  ///< model of each axis and settings of its compensation
  Vec<double, N> force_limit = spread<N>({}, std::numeric_limits<double>::infinity());  ///< [N]
};

/// Whether the force that acts is known: a drive that closes a loop of its own must report it.
constexpr bool knows_force(const CompensationParams& p) noexcept {
  return !p.model.drive_loop || p.model.drive_loop->force_feedback;
}

/// Without observer and adaptation where the force is not known: they would take what the drive's loop does for a disturbance.
constexpr CompensationParams with_known_force(const CompensationParams& params) noexcept {
  CompensationParams p = params;
  if (!knows_force(p)) {
    p.observer = Observer::kNone;
    p.adaptation.enabled = false;
  }
  return p;
}

/// The parts of a controller that are the same in every law: errors from samples, compensation, limits.
template <std::size_t N>
class Common {
 public:
  struct State {
    std::array<TrackingError, N> error;
    std::array<Compensation::State, N> compensation;
    Vec<double, N> force;  ///< last output [N]
    /// The sample of this axis is a prediction: nothing may be learned from it. Set by supervision (supervisor.hpp).
    std::array<bool, N> bridged{};
    /// The sample may be slightly wild but is used: adaptation rests, observers continue. Set by supervision.
    std::array<bool, N> doubtful{};
    /// Supervision has limited the last force until the sign of the axis is proven: an integral would only wind up. Set by supervision.
    std::array<bool, N> cut{};
    /// Since the last step, as the host measured it; more than 1 after a cycle that was missed. Set by supervision.
    int periods = 1;
    Vec<double, N> change;  ///< running mean of how much the differenced velocity changes in a period [m/s]
    StatusCounter status;
  };

  Common(const Setup<N>& setup, ErrorRate form) noexcept : setup_(setup), form_(form) {
    for (std::size_t i = 0; i < N; ++i) {
      const CompensationParams& c = setup.compensation[i];
      compensation_[i] = Compensation(with_known_force(c), setup.period);
      most_change_[i] = kNoDisturbance * (setup.force_limit[i] * setup.period / c.model.mass +
                                          c.encoder_resolution / setup.period);
    }
  }

  /// Tracking errors of this tick; false, and a status raised, when an input is not finite: the last forces then stay for a period that
  /// no observer sees. Observers take the periods in between, and those that the host missed, for what they are.
  bool begin(State& s, const path::PathPoint<N>& r, const Vec<double, N>& measured) const noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < N; ++i) {
      // A sum that contains an infinite value or NaN is infinite or NaN.
      sum += measured[i] + r.position[i] + r.velocity[i] + r.acceleration[i];
      for (std::size_t k = 0; k < N; ++k)
        sum += r.frame[i][k] + r.frame_rate[i][k] + r.frame_acceleration[i][k];
    }
    const bool finite = isfinite(sum);
    for (std::size_t i = 0; i < N; ++i) pass(s, i, finite ? s.periods - 1 : s.periods);
    if (!finite) {
      s.status.raise(Status::kNotFinite);
      return false;
    }
    for (std::size_t i = 0; i < N; ++i) {
      TrackingError& e = s.error[i];
      const double before = e.started ? e.velocity : r.velocity[i];
      const int periods = e.missed + 1;
      e.update(measured[i], r.position[i], r.velocity[i], setup_.period, form_);
      const bool wild = is_wild(s.change[i], abs(e.velocity - before) / periods, most_change_[i]);
      compensation_[i].observe(s.compensation[i], measured[i], e.velocity, s.bridged[i],
                               s.doubtful[i] || wild);
      compensation_[i].forget_beyond(s.compensation[i], kNoDisturbance * setup_.force_limit[i]);
      // A drive's own loop holds the velocity; an observed one, which follows the force that it makes, would fight it.
      if (form_ == ErrorRate::kObserved && e.moves && !setup_.compensation[i].model.drive_loop &&
          compensation_[i].observes_velocity(s.compensation[i]))
        e.rate = compensation_[i].velocity(s.compensation[i]) - r.velocity[i];
    }
    return true;
  }

  /// Forces [N] from the law's accelerations [m/s²]: M·a + friction + load + d̂, limited.
  Vec<double, N> finish(State& s, const path::PathPoint<N>& r,
                        const Vec<double, N>& acceleration) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      const double added =
          compensation_[i].step(s.compensation[i], r.position[i], r.velocity[i], r.acceleration[i], s.status);
      const double wanted = compensation_[i].mass() * acceleration[i] + added;
      if (!isfinite(wanted)) {
        // A number that overflows: the last force stays, as with an input that is not finite. Observers and adaptation begin anew, or
        // one sample of 1e306 m would stay in them for ever.
        s.status.raise(Status::kNotFinite);
        std::construct_at(&s.compensation[i]);
        continue;
      }
      s.force[i] = clamp_to(wanted, -setup_.force_limit[i], setup_.force_limit[i]);
      if (s.force[i] != wanted) s.status.raise(Status::kOutputLimited);
      compensation_[i].applied(s.compensation[i], s.force[i], s.force[i] != wanted, s.status);
    }
    return s.force;
  }

  [[nodiscard]] static Vec<double, N> error(const State& s) noexcept {
    Vec<double, N> e;
    for (std::size_t i = 0; i < N; ++i) e[i] = s.error[i].e;
    return e;
  }
  [[nodiscard]] static Vec<double, N> rate(const State& s) noexcept {
    Vec<double, N> e;
    for (std::size_t i = 0; i < N; ++i) e[i] = s.error[i].rate;
    return e;
  }
  [[nodiscard]] double mass(std::size_t i) const noexcept { return compensation_[i].mass(); }
  [[nodiscard]] double period() const noexcept { return setup_.period; }

 private:
  /// So many periods without a sample of axis i. After kMostPassed of them, or kMostAtOnce that the host missed in a row, the last velocity
  /// says nothing any more: the error and the observers find the motion again from two samples. A late step must not compute for long.
  void pass(State& s, std::size_t i, int periods) const noexcept {
    TrackingError& e = s.error[i];
    if (!e.started) return;
    if (periods <= kMostAtOnce && e.missed + periods <= kMostPassed) {
      e.missed += periods;
      for (int k = 0; k < periods; ++k) compensation_[i].pass(s.compensation[i]);
      return;
    }
    e.started = e.moves = false;
    e.missed = 0;
    e.rate = 0.0;
    Compensation::wait_for_motion(s.compensation[i]);
  }
  static constexpr int kMostAtOnce = 4;
  static constexpr int kMostPassed = 10;

  /// Whether the differenced velocity changed more than forces can do, and far more than it does otherwise: noise of the encoder may be
  /// larger than both. Adaptation learns nothing from such a sample. One sample cannot lift the mean by much.
  static bool is_wild(double& mean, double change, double most) noexcept {
    constexpr double kFar = 10.0;    // times the mean: noise of any usual distribution stays below
    constexpr double kShare = 0.02;  // of the newest change in the mean: it reaches back about 50 periods
    if (!isfinite(most)) return false;
    const bool wild = change > most && change > kFar * mean;
    // The mean takes this sample as well, but no more of it than this: noise that lasts is learned, one wild sample is not.
    const double bound = 2.0 * mean + most;
    mean += kShare * ((change < bound ? change : bound) - mean);
    return wild;
  }

  /// An estimate of this many force limits comes from a wild sample, and would hold the force at its limit for seconds.
  static constexpr double kNoDisturbance = 4.0;

  Setup<N> setup_;
  ErrorRate form_;
  std::array<Compensation, N> compensation_;
  Vec<double, N> most_change_;  ///< of the velocity in a period, by forces and steps of the encoder [m/s]
};

/// Rᵀ is stored by rows, so R·v is a product with its transpose.
template <std::size_t N>
constexpr Vec<double, N> to_machine(const Mat<double, N>& rt, const Vec<double, N>& local) noexcept {
  Vec<double, N> v;
  for (std::size_t i = 0; i < N; ++i) {
    v[i] = rt[0][i] * local[0];
    for (std::size_t k = 1; k < N; ++k) v[i] = v[i] + rt[k][i] * local[k];
  }
  return v;
}

}  // namespace stribeck::control
