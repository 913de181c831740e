#pragma once
/// PD control of one axis with compensation.
///
///   f = m·(r̈ − k_v·ė − k_p·e) + F_friction + load + d̂         e = x − r
///
///   m mass of the model [kg], k_p [1/s²], k_v [1/s], f force on the axis [N]. Closed loop: ë + k_v ė + k_p e
///   = 0.
///
/// The force is limited to ±limit; the observer sees the limited force, so nothing winds up. An input that is
/// not finite is answered with the last force and Status::kNotFinite.
/// Source: thesis (2.25), (2.30). Real
/// time: safe; the constructor configure only.

#include <limits>
#include <stribeck/control/compensation/compensation.hpp>
#include <stribeck/control/gains.hpp>
#include <stribeck/control/tracking_error.hpp>

namespace stribeck::control {

class Pd {
 public:
  struct Params {
    Gains gains;
    CompensationParams compensation;
    double force_limit = std::numeric_limits<double>::infinity();  ///< [N]
    ErrorRate error_rate = ErrorRate::kDifferenceOfError;
  };
  struct State {
    TrackingError error;
    Compensation::State compensation;
    double force = 0.0;  ///< last output [N]
    StatusCounter status;
  };
  struct Input {
    double position = 0.0;      ///< r [m]
    double velocity = 0.0;      ///< ṙ [m/s]
    double acceleration = 0.0;  ///< r̈ [m/s²]
    double measured = 0.0;      ///< encoder [m]
  };

  Pd(const Params& params, double period) noexcept
      : params_(params), compensation_(params.compensation, period), period_(period) {}

  /// Force for the coming period [N].
  double step(State& s, const Input& in) const noexcept {
    if (!isfinite(in.measured) || !isfinite(in.position) || !isfinite(in.velocity) ||
        !isfinite(in.acceleration)) {
      s.status.raise(Status::kNotFinite);
      return s.force;
    }
    s.error.update(in.measured, in.position, in.velocity, period_, params_.error_rate);
    compensation_.observe(s.compensation, in.measured, s.error.velocity);
    if (params_.error_rate == ErrorRate::kObserved && compensation_.observes_velocity(s.compensation))
      s.error.rate = compensation_.velocity(s.compensation) - in.velocity;
    const double added =
        compensation_.step(s.compensation, in.position, in.velocity, in.acceleration, s.status);
    const double wanted = compensation_.mass() * (in.acceleration - params_.gains.kv * s.error.rate -
                                                  params_.gains.kp * s.error.e) +
                          added;
    s.force = clamp_to(wanted, -params_.force_limit, params_.force_limit);
    if (s.force != wanted) s.status.raise(Status::kOutputLimited);
    compensation_.applied(s.compensation, s.force, s.force != wanted, s.status);
    return s.force;
  }

 private:
  Params params_;
  Compensation compensation_;
  double period_;
};

}  // namespace stribeck::control
