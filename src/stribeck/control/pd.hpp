#pragma once
/// PD control of one axis with compensation.
///
///   f = m·(r̈ − k_v·ė − k_p·e) + F_friction + load + d̂         e = x − r
///
///   closed loop: ë + k_v·ė + k_p·e = 0
///
///   m mass of the model [kg], k_p [1/s²], k_v [1/s], f force on the axis [N].
///
/// The force is limited to ±limit; the observer sees the limited force, so nothing winds up. Errors, compensation, limits and
/// the treatment of bad input are those of every law, Common<1> in setup.hpp. Input and a single number as output let a caller
/// with one axis do without vectors.
/// Source: thesis (2.25), (2.30).
/// Real time: safe; the constructor configure only.

#include <limits>
#include <stribeck/control/gains.hpp>
#include <stribeck/control/setup.hpp>

namespace stribeck::control {

class Pd {
 public:
  struct Params {
    Gains gains;
    CompensationParams compensation;
    double force_limit = std::numeric_limits<double>::infinity();  ///< [N]
    ErrorRate error_rate = ErrorRate::kDifferenceOfError;
  };
  using State = Common<1>::State;
  struct Input {
    double position = 0.0;      ///< r [m]
    double velocity = 0.0;      ///< ṙ [m/s]
    double acceleration = 0.0;  ///< r̈ [m/s²]
    double measured = 0.0;      ///< encoder [m]
  };

  Pd(const Params& params, double period) noexcept
      : gains_(params.gains),
        common_(
            {.period = period, .compensation = {params.compensation}, .force_limit = {{params.force_limit}}},
            params.error_rate) {}

  /// Force for the coming period [N].
  double step(State& s, const Input& in) const noexcept {
    const path::PathPoint<1> r{
        .position = {{in.position}}, .velocity = {{in.velocity}}, .acceleration = {{in.acceleration}}};
    if (!common_.begin(s, r, {{in.measured}})) return s.force[0];
    const TrackingError& e = s.error[0];
    return common_.finish(s, r, {{in.acceleration - gains_.kv * e.rate - gains_.kp * e.e}})[0];
  }

 private:
  Gains gains_;
  Common<1> common_;
};

}  // namespace stribeck::control
