#pragma once
/// The force that a controller adds to its feedback on one axis: friction feed-forward, load, and the estimate of an observer.
///
///   f_add = F_friction(r) + load + d̂ + m·(r̈ over the hold − r̈)
///
///   steady    F of the steady map at the reference velocity and position of this sample, as in the thesis
///   dynamic   pre-sliding over the same map, mean over the coming hold, computation delay included
///             (friction_feedforward.hpp); the acceleration likewise
///   reversal  the same hold, with the build-up after a reversal as a function of distance (reversal_feedforward.hpp)
///
/// Friction follows the reference, not the measurement: the sign of a measured velocity near zero is noise, and the force would
/// chatter. Sign: F > 0 for ṙ > 0. Observers get the force that really acted, later by the delay. With adaptation the model is
/// corrected while the machine runs (friction_rls.hpp). If a guarded loop oscillates, a disturbance observer of a third of the
/// bandwidth takes the place of the Kalman observer; if it still does, the estimate goes by halves (oscillation_guard.hpp).
/// Source: thesis (2.25) and chapter 3 for the steady form; docs/theory/feedforward.md for the rest. A delay must not be
/// longer than kMostDelay periods. Not modelled: adaptation corrects dynamic and reversal feed-forward only.
/// Real time: safe; the constructor configure only. Errors: none of its own; inputs must be finite (setup.hpp).

#include <array>
#include <stribeck/control/compensation/compensation_settings.hpp>
#include <stribeck/control/compensation/drift_monitor.hpp>
#include <stribeck/control/compensation/friction_feedforward.hpp>
#include <stribeck/control/compensation/friction_rls.hpp>
#include <stribeck/control/compensation/oscillation_guard.hpp>
#include <stribeck/control/compensation/reversal_feedforward.hpp>
#include <stribeck/control/observers/adaptive_friction.hpp>
#include <stribeck/control/observers/disturbance_observer.hpp>
#include <stribeck/control/observers/kalman_observer.hpp>
#include <stribeck/control/tracking_error.hpp>
#include <stribeck/core/status.hpp>
#include <stribeck/friction/axis_model.hpp>

namespace stribeck::control {

/// Longest delay in periods.
inline constexpr std::size_t kMostDelay = 8;

/// Whether a compensation can take a delay [s] into account.
constexpr bool delay_fits(double delay, double period) noexcept {
  return delay <= static_cast<double>(kMostDelay) * period;
}

struct CompensationParams : CompensationSettings<double> {
  friction::AxisModel model;         ///< identified model of the axis
  double encoder_resolution = 1e-7;  ///< Kalman: step of the encoder [m]
  bool guarded = false;              ///< back off when the loop oscillates (oscillation_guard.hpp)

  /// From the sample to the beginning of the hold [s], at most 8 periods: that of the model.
  [[nodiscard]] double delay() const noexcept { return model.delay_or_none(); }

  static constexpr auto fields() {
    using P = CompensationParams;
    return std::tuple_cat(std::tuple{embedded(&P::model)}, CompensationSettings<double>::fields(),
                          std::tuple{field("encoder_resolution", &P::encoder_resolution,
                                           quantity("m", "nm").positive(), "step of the encoder"),
                                     field("guarded", &P::guarded, "back off when the loop oscillates")});
  }
};

class Compensation {
 public:
  struct State {
    DisturbanceObserver::State disturbance;
    KalmanObserver::State kalman;
    AdaptiveFriction::State adaptive;
    FrictionFeedforward::State feedforward;
    ReversalFeedforward::State reversal;
    FrictionRls::State adaptation;
    DriftMonitor::State drift;
    OscillationGuard::State guard;
    double friction = 0.0;  ///< feed-forward of the last step [N]
    double estimate = 0.0;  ///< d̂ of the last step [N]
    double balance =
        0.0;  ///< feed-forward and d̂ in the last step: the part of the force that accelerates nothing [N]
    double last_acceleration = 0.0;  ///< of the reference [m/s²]
    double last_velocity = 0.0;      ///< of the reference [m/s]
    double last_jerk = 0.0;          ///< of the reference [m/s³]
    double inertia_force = 0.0;      ///< mass × acceleration at the last step [N]
    bool started = false;
    int samples = 0;       ///< of the encoder in a row, up to 2: take_over()
    bool limited = false;  ///< the last force was limited
    bool slower = false;   ///< the disturbance observer has taken the place of the Kalman observer
    double calming = 0.0;  ///< time for which the oscillation that caused this may go on [s]
    /// Commanded forces, and the feed-forward in each of them, newest first [N].
    std::array<double, kMostDelay + 3> force{};
    std::array<double, kMostDelay + 3> feedforward_history{};
    /// Part of the change from period to period that comes from steps of θ [N].
    std::array<double, kMostDelay + 3> change_by_theta_history{};
  };

  Compensation() = default;
  Compensation(const CompensationParams& params, double period) noexcept
      : params_(params),
        period_(period),
        observer_(disturbance_pole(params), params.model.mass, period),
        adaptive_(params.adaptive_gain, params.model.mass, period),
        kalman_(
            params.observer == Observer::kKalman
                ? KalmanObserver(params.disturbance_density
                                     ? *params.disturbance_density
                                     : KalmanObserver::density(params.observer_pole,
                                                               params.encoder_resolution, params.model.mass),
                                 params.encoder_resolution * params.encoder_resolution / 12.0,
                                 params.model.mass, period)
                : KalmanObserver()),
        feedforward_(params.model.friction, period),
        adaptation_(adaptation_of(params), followed(params), params.encoder_resolution, params.delay(),
                    period) {
    if (params.feedforward == Feedforward::kReversal)
      reversal_ = ReversalFeedforward(params.reversal, params.model.friction, period);
    if (params.guarded)
      guard_ =
          OscillationGuard(kSwing * params.model.friction.parts(0.0, 0.0).level +
                               kRattle * params.model.mass * params.encoder_resolution / (period * period),
                           period);
    whole_ = whole_periods(params.delay(), period);
    rest_ = periods_of(params.delay(), period) - static_cast<double>(whole_);
    past_ = whole_ + (rest_ > 0.0 ? 1 : 0) + (params.adaptation.enabled ? 1 : 0);
  }

  /// A delay [s] in whole periods, as far as past commands are kept: the force of that many periods ago acts, or begins to.
  static std::size_t whole_periods(double delay, double period) noexcept {
    return static_cast<std::size_t>(periods_of(delay, period));
  }

  /// Takes the position of the encoder [m] and its differenced velocity [m/s]. Call it once per period, before step().
  /// `bridged`: both are predictions; observers continue by their models, and estimates stay. `doubtful`: the sample may be wrong;
  /// adaptation uses the motion of the reference instead and learns nothing.
  void observe(State& s, double position, double velocity, bool bridged = false,
               bool doubtful = false) const noexcept {
    const double net = force_beside_friction(s);
    if (take_over(s, position, velocity, bridged)) {
      // The estimates begin with the motion that the axis has.
    } else if (bridged) {
      carry_on(s, net, velocity);
    } else if (params_.observer == Observer::kDisturbance) {
      s.estimate = observer_.step(s.disturbance, net, velocity);
    } else if (params_.observer == Observer::kKalman) {
      const double of_kalman = kalman_.step(s.kalman, net, position);
      const double of_disturbance = observer_.step(s.disturbance, net, velocity);
      s.estimate = s.slower ? of_disturbance : of_kalman;
    } else if (params_.observer == Observer::kAdaptive) {
      s.estimate = adaptive_.step(s.adaptive, net, velocity);
    }
    if (!adaptation_.enabled()) return;
    adapt(s, doubtful ? s.adaptation.position + period_ * middle_velocity(s) : position,
          !s.limited && s.guard.trust == 1.0 && !(s.calming > 0.0), bridged || doubtful);
  }

  /// A whole period that passes without a sample and without a step of the controller: the last force stays. Observers continue by their
  /// models, and estimates stay.
  void pass(State& s) const noexcept {
    if (!s.started) return;
    if (s.samples == kTakenOver) {
      const double net = force_beside_friction(s);
      if (params_.observer == Observer::kAdaptive) {
        adaptive_.predict(s.adaptive, net);
      } else {
        carry_on(s, net, s.disturbance.velocity);
      }
    }
    if (adaptation_.enabled()) adapt(s, s.adaptation.position + period_ * middle_velocity(s), false, true);
    remember(s, s.force[0], s.feedforward_history[0], 0.0);
    // The reference goes on meanwhile.
    s.last_velocity += period_ * s.last_acceleration;
    s.last_jerk = 0.0;
  }

  /// After so many periods without a sample that the motion is not known any more: the next samples show it. Estimates stay.
  static void wait_for_motion(State& s) noexcept { s.samples = 0; }

  /// Begins the observers anew where the estimate is beyond this force [N], which nothing at the axis can be; infinite: never.
  void forget_beyond(State& s, double force) const noexcept {
    if (!(abs(s.estimate) > force)) return;
    s.disturbance = {};
    s.kalman = {};
    s.adaptive = {};
    s.estimate = 0.0;
    s.samples = 1;  // the next one shows the motion
  }

  /// Force to add [N] for the reference now: position [m], velocity [m/s], acceleration [m/s²].
  double step(State& s, double reference, double velocity, double acceleration,
              StatusCounter& status) const noexcept {
    s.friction = params_.model.load;
    double inertia_change = 0.0;
    if (params_.feedforward != Feedforward::kNone) {
      if (!params_.model.friction.covers(velocity)) status.raise(Status::kOutsideVelocityRange);
    }
    if (params_.feedforward == Feedforward::kSteady) {
      const auto p = params_.model.friction.parts(velocity, reference);
      s.friction += p.level * sign(velocity) + p.viscous + p.additive;
    } else if (params_.feedforward != Feedforward::kNone) {
      const double jerk = s.started ? jerk_of(s, velocity, acceleration) : 0.0;
      s.last_jerk = jerk;
      const MotionAhead now{reference, velocity, acceleration, jerk};
      const double delay = params_.delay() + adaptation_.delay(s.adaptation);
      const MotionAhead coming = now.later(delay);
      if (velocity == 0.0 && acceleration == 0.0) hand_over(s, reference);
      const double middle = 0.5 * period_;
      const double accelerates = coming.acceleration + middle * jerk;
      const FrictionScales scales = adaptation_.scales(s.adaptation);
      s.friction += params_.feedforward == Feedforward::kDynamic
                        ? feedforward_.step(s.feedforward, now, delay, scales).sum()
                        : reversal_.step(s.reversal, coming, velocity, scales).sum();
      if (adaptation_.enabled())
        s.friction += adaptation_.extra(s.adaptation, coming.position_at(middle), accelerates);
      inertia_change = params_.model.mass * (accelerates - acceleration);
    }
    s.started = true;
    s.last_acceleration = acceleration;
    s.last_velocity = velocity;
    s.inertia_force = inertia_change + params_.model.mass * acceleration;
    s.balance = s.friction + s.guard.trust * s.estimate;
    return s.friction + inertia_change + s.guard.trust * s.estimate;
  }

  /// Tells the observers the force [N] that was commanded after limits.
  void applied(State& s, double force, bool limited, StatusCounter& status) const noexcept {
    if (s.calming > 0.0) {
      s.calming -= period_;
      s.guard.run = 0;
    }
    const double beyond = force - s.friction - s.inertia_force;
    if (params_.guarded && guard_.step(s.guard, guard_factor(s) * beyond, s.last_velocity)) {
      status.raise(Status::kOscillation);
      if (params_.observer == Observer::kKalman && !s.slower) {
        s.slower = true;
        s.calming = kCalming;
        s.guard.trust = 1.0;
        adaptation_.forget(s.adaptation);  // what it learned during the oscillation is wrong
      } else {
        adaptation_.halve(s.adaptation);
      }
    }
    remember(s, force, s.friction, follows_adaptation() ? s.adaptation.feedforward_change_by_theta : 0.0);
    s.limited = limited;
  }

  [[nodiscard]] double mass() const noexcept { return params_.model.mass; }
  /// Whether velocity() may replace the differenced velocity: not after the loop has oscillated.
  [[nodiscard]] bool observes_velocity(const State& s) const noexcept {
    return observes_velocity(params_, s);
  }
  [[nodiscard]] static bool observes_velocity(const CompensationParams& params, const State& s) noexcept {
    return params.observer == Observer::kKalman && !s.slower && s.guard.trust == 1.0;
  }
  /// Velocity of the Kalman observer [m/s].
  [[nodiscard]] double velocity(const State& s) const noexcept { return s.kalman.estimate[1]; }
  [[nodiscard]] bool adapts() const noexcept { return adaptation_.enabled(); }
  /// Change of friction since identification; meaningful with adaptation only.
  [[nodiscard]] Drift drift(const State& s) const noexcept {
    return DriftMonitor::report(s.drift, s.adaptation, period_);
  }

  /// The same with the disturbance observer that takes the place of a Kalman observer when the loop oscillates.
  static CompensationParams calmed(CompensationParams p) noexcept {
    p.observer_pole = disturbance_pole(p);
    p.observer = Observer::kDisturbance;
    p.disturbance_density.reset();
    return p;
  }

 private:
  /// Whether friction is fed forward over a distance because the model has no pre-sliding.
  static bool assumes_build_up(const CompensationParams& p) noexcept {
    return p.feedforward == Feedforward::kReversal && !friction::has_pre_sliding(p.model.friction.dynamics);
  }
  /// The model that adaptation compares with the measured motion. Where a build-up is assumed, bristles over the same distance: with a
  /// step at the reversal, adaptation would take every build-up for a level that has fallen.
  static friction::AxisModel followed(const CompensationParams& p) noexcept {
    friction::AxisModel model = p.model;
    if (!assumes_build_up(p)) return model;
    const double distance = p.reversal.mean_distance();
    const double level = model.friction.parts(0.0, 0.0).level;
    if (distance > 0.0 && level > 0.0)
      model.friction.dynamics = friction::LuGre<double>{level / distance, 0.0, {}};
    return model;
  }
  static AdaptationParams adaptation_of(const CompensationParams& p) noexcept {
    AdaptationParams a = p.adaptation;
    if (assumes_build_up(p)) a.noise_share = max_of(a.noise_share, kAssumedBuildUp);
    return a;
  }
  /// Least noise then, as a share of the level: a distance of half or twice the true one misses a third of the level, as root mean
  /// square over three distances. A part of it is found as the scale of the stiffness.
  static constexpr double kAssumedBuildUp = 0.2;
  static constexpr double kMoves = 2.0;  ///< steps of the encoder in a period that are a motion

  [[nodiscard]] bool follows_adaptation() const noexcept {
    return params_.feedforward == Feedforward::kDynamic || params_.feedforward == Feedforward::kReversal;
  }

  /// An axis may be in motion when the controller begins. Two samples in a row show its velocity, and the observers begin with it: one
  /// that began at rest would make a force of mass times speed. Answers whether this sample was used for that alone.
  bool take_over(State& s, double position, double velocity, bool bridged) const noexcept {
    if (s.samples == kTakenOver) return false;
    s.samples = bridged ? 0 : s.samples + 1;
    if (bridged) return true;  // a predicted sample shows no motion
    const bool known = s.samples == kTakenOver;
    const bool moves = known && abs(velocity) * period_ > kMoves * params_.encoder_resolution;
    if (known) s.kalman.estimate[1] = s.disturbance.velocity = s.adaptive.velocity = moves ? velocity : 0.0;
    if (known && !moves) return false;
    s.kalman.estimate[0] = position;
    s.kalman.started = true;
    return true;
  }
  static constexpr int kTakenOver = 2;

  /// A period without a sample: the estimates of the observers do not change.
  void carry_on(State& s, double net, double velocity) const noexcept {
    if (params_.observer == Observer::kDisturbance) {
      observer_.predict(s.disturbance, net);
    } else if (params_.observer == Observer::kKalman) {
      kalman_.predict(s.kalman, net);
      observer_.predict(s.disturbance, net);
    } else if (params_.observer == Observer::kAdaptive) {
      s.adaptive.velocity = velocity;
    }
  }

  /// The force that acted on the axis over the last period, without what was fed forward in it [N].
  [[nodiscard]] double force_beside_friction(const State& s) const noexcept {
    return force_acting(s.force) - force_acting(s.feedforward_history);
  }
  /// Velocity of the reference in the middle of the last period; exactly 0 where it rests [m/s].
  [[nodiscard]] double middle_velocity(const State& s) const noexcept {
    const double middle = 0.5 * period_;
    return s.last_velocity + middle * (s.last_acceleration + 0.5 * middle * s.last_jerk);
  }
  /// One period of the adaptation, which has seen the axis at this position [m].
  void adapt(State& s, double position, bool learn, bool bridged) const noexcept {
    adaptation_.step(s.adaptation, force_acting(s.force) - params_.model.load,
                     force_acting(s.feedforward_history) - force_acting(s.feedforward_history, 1) -
                         force_acting(s.change_by_theta_history),
                     position, middle_velocity(s), s.last_acceleration + 0.5 * period_ * s.last_jerk, learn,
                     bridged);
    if (!isfinite(norm(s.adaptation.theta)))
      std::construct_at(&s.adaptation);  // numbers overflowed: it begins anew
    DriftMonitor::step(s.drift, s.adaptation, s.last_velocity != 0.0, period_);
  }
  /// Stores what was commanded for the coming period, before what was commanded earlier [N].
  void remember(State& s, double force, double friction, double change_by_theta) const noexcept {
    for (std::size_t i = past_; i > 0; --i) {
      s.force[i] = s.force[i - 1];
      s.feedforward_history[i] = s.feedforward_history[i - 1];
      s.change_by_theta_history[i] = s.change_by_theta_history[i - 1];
    }
    s.force[0] = force;
    s.feedforward_history[0] = friction;
    s.change_by_theta_history[0] = change_by_theta;
  }

  /// At rest, friction balances whatever acts on the axis, and creeps. What the observer has found of that goes into the bristle, so
  /// that the next start begins from there; the sum does not jump.
  void hand_over(State& s, double reference) const noexcept {
    const bool observed = params_.observer == Observer::kDisturbance || params_.observer == Observer::kKalman;
    // After an oscillation the observer's estimate must not come back through the bristle.
    if (!observed || !s.started || s.guard.trust < 1.0 || params_.feedforward != Feedforward::kDynamic)
      return;
    const double share = period_ / (period_ + kHandOver);
    const double moved = feedforward_.shift(s.feedforward.bristle, share * s.estimate, reference,
                                            adaptation_.scales(s.adaptation));
    s.estimate -= moved;
    s.disturbance.disturbance -= moved;
    s.kalman.estimate[2] -= moved;
    // Past commands are corrected as if this had been part of their feed-forward.
    for (double& force : s.feedforward_history) force += moved;
  }

  /// The jerk of the reference, if it will continue. A step of acceleration, as trapezoidal planners make it, is no jerk: the
  /// velocity of the period before does not show it.
  [[nodiscard]] double jerk_of(const State& s, double velocity, double acceleration) const noexcept {
    const double change = (acceleration - s.last_acceleration) / period_;
    const double felt = 2.0 * ((velocity - s.last_velocity) / period_ - s.last_acceleration) / period_;
    return clamp_to(felt, min_of(change, 0.0), max_of(change, 0.0));
  }

  /// Pole of the disturbance observer [1/s]; beside a Kalman observer, a third of the Kalman observer's bandwidth.
  static double disturbance_pole(const CompensationParams& p) noexcept {
    if (p.observer != Observer::kKalman) return p.observer_pole;
    return kSlower * (p.disturbance_density ? KalmanObserver::bandwidth(*p.disturbance_density,
                                                                        p.encoder_resolution, p.model.mass)
                                            : p.observer_pole);
  }
  static constexpr double kSlower = 1.0 / 3.0;
  /// Factor on the force that the guard sees. To replace a Kalman observer without need costs little, so swings of half the size count.
  [[nodiscard]] double guard_factor(const State& s) const noexcept {
    return params_.observer == Observer::kKalman && !s.slower ? 2.0 : 1.0;
  }
  /// After the change of observers the oscillation may take this long to end [s].
  static constexpr double kCalming = 0.5;

  /// Time constant of that transfer [s].
  static constexpr double kHandOver = 0.1;
  /// Threshold of the guard as a share of the level of friction at rest.
  static constexpr double kSwing = 0.6;
  /// The same as a multiple of the answer to one encoder step with a gain of 1/T.
  static constexpr double kRattle = 0.3;

  /// None where it is not a number.
  static double periods_of(double delay, double period) noexcept {
    const double periods = delay / period;
    return periods > 0.0 ? min_of(periods, static_cast<double>(kMostDelay)) : 0.0;
  }

  /// Mean over the last period of the commanded values, later by the delay.
  [[nodiscard]] double force_acting(const std::array<double, kMostDelay + 3>& commanded,
                                    std::size_t periods_ago = 0) const noexcept {
    const std::size_t i = whole_ + periods_ago;
    if (rest_ == 0.0) return commanded[i];
    return (1.0 - rest_) * commanded[i] + rest_ * commanded[i + 1];
  }

  CompensationParams params_;
  double period_ = 1e-3;
  DisturbanceObserver observer_;
  AdaptiveFriction adaptive_;
  KalmanObserver kalman_;
  FrictionFeedforward feedforward_;
  ReversalFeedforward reversal_;
  FrictionRls adaptation_;
  OscillationGuard guard_;
  std::size_t whole_ = 0;  ///< delay in whole periods
  double rest_ = 0.0;
  std::size_t past_ = 0;  ///< past commands that are still needed besides the newest
};

}  // namespace stribeck::control
