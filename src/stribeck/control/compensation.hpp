#pragma once
/// What a controller adds to its feedback on one axis: friction feed-forward, load, and the estimate of an
/// observer.
///
///   f_add = F_friction(ṙ, r) + load + d̂
///
/// Friction is evaluated at the reference, not at the measurement: a measured velocity that trembles around
/// zero would make the force chatter. Its sign is that of the force it opposes: positive for ṙ > 0. Not
/// modelled: pre-sliding (friction follows its steady state).
/// Real time: safe; the constructor configure
/// only.

#include <stribeck/control/adaptive_friction.hpp>
#include <stribeck/control/disturbance_observer.hpp>
#include <stribeck/control/kalman_observer.hpp>
#include <stribeck/core/status.hpp>
#include <stribeck/friction/axis_model.hpp>

namespace stribeck::control {

enum class Observer { kNone, kDisturbance, kKalman, kAdaptive };

struct CompensationParams {
  friction::AxisModel model;            ///< what was identified of the axis
  bool friction_feedforward = false;    ///< add the model's friction at the reference velocity
  Observer observer = Observer::kNone;  ///< add the estimate of this observer
  double observer_pole = 20.0;          ///< both poles of the disturbance observer [1/s]
  double adaptive_gain = 20.0;          ///< K_c of adaptive friction [1/s]
  double disturbance_density = 4e6;     ///< Kalman: random walk of the disturbance [N²/s]
  double encoder_resolution = 1e-7;     ///< Kalman: step of the encoder [m]
};

class Compensation {
 public:
  struct State {
    DisturbanceObserver::State disturbance;
    KalmanObserver::State kalman;
    AdaptiveFriction::State adaptive;
    double friction = 0.0;   ///< feed-forward of the last step [N]
    double estimate = 0.0;   ///< d̂ of the last step [N]
    double net_force = 0.0;  ///< force on the axis less the feed-forward, held since the last step [N]
  };

  Compensation() = default;
  Compensation(const CompensationParams& params, double period) noexcept
      : params_(params),
        observer_(params.observer_pole, params.model.mass, period),
        adaptive_(params.adaptive_gain, params.model.mass, period),
        kalman_(params.observer == Observer::kKalman
                    ? KalmanObserver(params.disturbance_density,
                                     params.encoder_resolution * params.encoder_resolution / 12.0,
                                     params.model.mass, period)
                    : KalmanObserver()) {}

  /// Force to add [N] for the reference position [m] and velocity [m/s], and what the encoder says now.
  double step(State& s, double reference, double reference_velocity, double position, double velocity,
              StatusCounter& status) const noexcept {
    if (params_.observer == Observer::kDisturbance) {
      s.estimate = observer_.step(s.disturbance, s.net_force, velocity);
    } else if (params_.observer == Observer::kKalman) {
      s.estimate = kalman_.step(s.kalman, s.net_force, position);
    } else if (params_.observer == Observer::kAdaptive) {
      s.estimate = adaptive_.step(s.adaptive, s.net_force, velocity);
    }
    s.friction = params_.model.load;
    if (params_.friction_feedforward) {
      const auto p = params_.model.friction.parts(reference_velocity, reference);
      s.friction += p.level * sign(reference_velocity) + p.viscous + p.additive;
      if (!params_.model.friction.covers(reference_velocity)) status.raise(Status::kOutsideVelocityRange);
    }
    return s.friction + s.estimate;
  }

  /// Tells the observer the force [N] that was really commanded, after limits.
  void applied(State& s, double force) const noexcept { s.net_force = force - s.friction; }

  [[nodiscard]] double mass() const noexcept { return params_.model.mass; }

 private:
  CompensationParams params_;
  DisturbanceObserver observer_;
  AdaptiveFriction adaptive_;
  KalmanObserver kalman_;
};

}  // namespace stribeck::control

template <>
struct stribeck::EnumNames<stribeck::control::Observer> {
  static constexpr std::array names{
      std::pair{stribeck::control::Observer::kNone, std::string_view{"none"}},
      std::pair{stribeck::control::Observer::kDisturbance, std::string_view{"disturbance"}},
      std::pair{stribeck::control::Observer::kKalman, std::string_view{"kalman"}},
      std::pair{stribeck::control::Observer::kAdaptive, std::string_view{"adaptive"}}};
};
