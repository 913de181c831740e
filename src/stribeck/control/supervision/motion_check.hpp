#pragma once
/// Judges the motion of one axis against the force that it was given: encoder stuck, wrong sign, speed, following
/// error, saturation, oscillation.
///
///   push run     periods for which f − load has kept its sign with |f − load| ≥ push, counted once the delay is over
///   wrong sign   in a push run, moving against it:   |v| − |v₀| + ½·(push/m)·t > 5 steps/T + ½·(push/m)·5 ms,
///                and farther than 5 µm and 10 steps. A sound axis that moves against a force loses push/m of its speed per time,
///                and more by friction; half of it is asked for, so that the mass may be twice the model's.
///   frozen       in a push run, |x − x₀| ≤ 2 steps:   ½·(push/2m)·t² > 20 µm and 20 steps. Friction takes at most half of push.
///   overspeed    |v| > speed + 5 steps/T              following error   |e| > limit + time·|ṙ|
///   saturated    at the limit for longer than a time  oscillation       twice found (oscillation_guard.hpp) with swings of half the
///                                                                       force limit, and more than friction that turns over explains
///   e is the error that the law itself uses: a law that slows the reference down is judged against the slowed reference.
/// Source: Stribeck's own; docs/theory/supervision.md.
/// Not modelled: an external force above push, which is taken for a wrong sign or a blocked axis; both are reasons to stop.
/// Real time: safe.

#include <stribeck/control/compensation/oscillation_guard.hpp>
#include <stribeck/control/supervision/fault.hpp>
#include <stribeck/control/supervision/limits.hpp>

namespace stribeck::control {

class MotionCheck {
 public:
  struct State {
    int pushed = 0;          ///< length of the push run [periods]
    double direction = 0.0;  ///< of the push run
    bool against = false;    ///< the axis moves against it
    double begin_speed = 0.0;
    double begin_position = 0.0;
    int against_periods = 0;
    double anchor = 0.0;  ///< position at which the encoder has stood since
    int still_periods = 0;
    int limited_periods = 0;
    OscillationGuard::State guard;
  };
  /// State of an axis in this period.
  struct Motion {
    double position = 0.0;        ///< [m]
    double velocity = 0.0;        ///< smoothed [m/s]
    double error = 0.0;           ///< e [m]
    double reference_rate = 0.0;  ///< ṙ [m/s]
    double force = 0.0;           ///< for the coming period [N]
    double feedback = 0.0;        ///< part of the force beyond the feed-forward [N]
    bool limited = false;         ///< the force was limited
    bool bridged = false;         ///< position is a prediction
  };

  MotionCheck() = default;
  explicit MotionCheck(const SupervisionLimits& l) noexcept : l_(l) {
    if (isfinite(l.swing)) guard_ = OscillationGuard(l.swing, l.period);
  }

  Fault step(State& s, const Motion& m) const noexcept {
    Fault found = Fault::kNone;
    if (!m.bridged) {
      if (abs(m.velocity) > l_.speed + l_.rattle()) found = Fault::kOverspeed;
      if (abs(m.error) > l_.following + l_.following_time * abs(m.reference_rate))
        found = Fault::kFollowingError;
      const bool pushed = s.pushed > l_.late_periods + kSettled;
      if (stands_still(s, m, pushed)) found = Fault::kEncoderFrozen;
      if (runs_away(s, m, pushed)) found = Fault::kWrongSign;
    }
    s.limited_periods = m.limited ? s.limited_periods + 1 : 0;
    if (s.limited_periods > l_.saturation_periods && found == Fault::kNone) found = Fault::kSaturated;
    guard_.step(s.guard, m.feedback, m.reference_rate);
    if (s.guard.found >= kFound && found == Fault::kNone) found = Fault::kOscillation;
    take(s, m.force - l_.load);
    return found;
  }

 private:
  static constexpr int kSettled = 2;  ///< periods until a force shows in a difference of positions
  static constexpr std::uint32_t kFound = 2;
  static constexpr double kLeastTravel = 5e-6;   ///< against the force [m]
  static constexpr double kLeastSlip = 20e-6;    ///< travel that the encoder must have missed [m]
  static constexpr double kReactionTime = 5e-3;  ///< [s]

  void take(State& s, double net) const noexcept {
    const double direction = abs(net) >= l_.push ? sign(net) : 0.0;
    if (direction == 0.0 || direction != s.direction) {
      s.pushed = 0;
      s.against = false;
      s.still_periods = 0;
    }
    s.direction = direction;
    if (direction != 0.0 && s.pushed < 1000000) ++s.pushed;
  }

  bool stands_still(State& s, const Motion& m, bool pushed) const noexcept {
    if (abs(m.position - s.anchor) > 2.0 * l_.step || !pushed) {
      s.anchor = m.position;
      s.still_periods = 0;
      return false;
    }
    ++s.still_periods;
    const double t = l_.period * s.still_periods;
    return 0.25 * l_.push / l_.mass * t * t > max_of(kLeastSlip, 20.0 * l_.step);
  }

  bool runs_away(State& s, const Motion& m, bool pushed) const noexcept {
    if (!pushed || m.velocity * s.direction >= 0.0) {
      s.against = false;
      return false;
    }
    const double speed = abs(m.velocity);
    if (!s.against) {
      s.against = true;
      s.begin_speed = speed;
      s.begin_position = m.position;
      s.against_periods = 0;
    }
    const double least = 0.5 * l_.push / l_.mass;
    const double excess = speed - s.begin_speed + least * l_.period * s.against_periods++;
    const double travel = (s.begin_position - m.position) * s.direction;
    return excess > l_.rattle() + least * kReactionTime && travel > max_of(kLeastTravel, 10.0 * l_.step);
  }

  SupervisionLimits l_;
  OscillationGuard guard_;
};

}  // namespace stribeck::control
