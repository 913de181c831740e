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

#include <cmath>
#include <limits>
#include <stribeck/control/gains.hpp>
#include <stribeck/control/sampled_loop.hpp>
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

  /// Why no loop works with these parameters, a text of the program; null: nothing is wrong with them. step() does not check:
  /// with a mass below zero or gains beyond the period it pushes with all its force. `period` [s].
  [[nodiscard]] static const char* problem(const Params& params, double period) noexcept;

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

inline const char* Pd::problem(const Params& params, double period) noexcept {
  const friction::AxisModel& model = params.compensation.model;
  if (!(period > 0.0 && std::isfinite(period))) return "period: expected above 0 s";
  if (!(model.mass > 0.0 && std::isfinite(model.mass))) return "mass: expected above 0 kg";
  if (!std::isfinite(model.load)) return "load: expected a number of newtons";
  if (!(params.force_limit > 0.0)) return "force_limit: expected above 0 N";
  if (!(params.gains.kp > 0.0 && params.gains.kv > 0.0)) return "gains: expected kp and kv above 0";
  if (!sampled_loop_stable(params.gains.kp, params.gains.kv, 0.0, period))
    return "gains: the loop is unstable at this period, expected slower ones";
  for (const double v : {-1.0, -1e-3, 1e-3, 1.0}) {
    const auto friction = model.friction.parts(v, 0.0);
    if (!(friction.level >= 0.0 && friction.viscous * v >= 0.0 &&
          std::isfinite(friction.level + friction.viscous)))
      return "friction: expected forces against the motion, at 1 mm/s and at 1 m/s in both directions";
  }
  return nullptr;
}

}  // namespace stribeck::control
