#pragma once
/// Two-axis contouring control: feedback in the frame that moves along the path, so that the error along the
/// path and the error across it have gains of their own.
///
///   F = M·{ r̈ − R·(K_v ė_l + K_p e_l) − θ̈ I e_w + θ̇² e_w − 2θ̇ I ė_w } + F_friction + load + d̂
///   e_w = x − r,   e_l = Rᵀe_w,   ė_l = Ṙᵀe_w + Rᵀė_w,   R = [cosθ −sinθ; sinθ cosθ],   I = [0 1; −1 0]
///
///   K_p = diag(k_pt, k_pn) [1/s²], K_v [1/s] along (t) and across (n) the path; M = diag(m_x, m_y) [kg]; θ
///   inclination of the tangent [rad]. Closed loop: ë_l + K_v ė_l + K_p e_l = 0.
///
/// The term θ̇² e_w has no I, other than printed; docs/corrections-to-the-thesis.md derives it.
/// Limits, observers and inputs that are not finite: as in pd.hpp.
/// Source: thesis (3.6)–(3.8), corrected.
/// Real time: safe; the constructor configure only.

#include <array>
#include <stribeck/control/pd.hpp>
#include <stribeck/path/reference.hpp>

namespace stribeck::control {

class Contouring {
 public:
  struct Params {
    Gains tangential;
    Gains normal;
    std::array<CompensationParams, 2> compensation;
    std::array<double, 2> force_limit{std::numeric_limits<double>::infinity(),
                                      std::numeric_limits<double>::infinity()};
    ErrorRate error_rate = ErrorRate::kDifferenceOfError;
  };
  struct State {
    std::array<TrackingError, 2> error;
    std::array<Compensation::State, 2> compensation;
    Vec2 force;  ///< last output [N]
    StatusCounter status;
  };

  Contouring(const Params& params, double period) noexcept
      : params_(params),
        compensation_{Compensation(params.compensation[0], period),
                      Compensation(params.compensation[1], period)},
        period_(period) {}

  /// Forces for the coming period [N], for the reference point and the encoders' positions [m].
  Vec2 step(State& s, const path::PathPoint& r, const Vec2& measured) const noexcept {
    if (!isfinite(measured[0] + measured[1] + dot(r.position, r.position) + dot(r.velocity, r.velocity) +
                  dot(r.acceleration, r.acceleration) + dot(r.tangent, r.tangent) + r.theta_rate +
                  r.theta_acceleration)) {
      s.status.raise(Status::kNotFinite);
      return s.force;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      s.error[i].update(measured[i], r.position[i], r.velocity[i], period_, params_.error_rate);
    }
    const Vec2 e{{s.error[0].e, s.error[1].e}};
    const Vec2 rate{{s.error[0].rate, s.error[1].rate}};
    const double c = r.tangent[0];
    const double n = r.tangent[1];
    const double turn = r.theta_rate;
    // Into the moving frame: ė_l = Rᵀė_w + Ṙᵀe_w = Rᵀ(ė_w + θ̇ I e_w).
    const Vec2 seen{{rate[0] + turn * e[1], rate[1] - turn * e[0]}};
    const double along =
        params_.tangential.kv * (c * seen[0] + n * seen[1]) + params_.tangential.kp * (c * e[0] + n * e[1]);
    const double across =
        params_.normal.kv * (c * seen[1] - n * seen[0]) + params_.normal.kp * (c * e[1] - n * e[0]);
    const Vec2 acceleration{{r.acceleration[0] - (c * along - n * across) - r.theta_acceleration * e[1] +
                                 turn * turn * e[0] - 2.0 * turn * rate[1],
                             r.acceleration[1] - (n * along + c * across) + r.theta_acceleration * e[0] +
                                 turn * turn * e[1] + 2.0 * turn * rate[0]}};
    for (std::size_t i = 0; i < 2; ++i) {
      const double added = compensation_[i].step(s.compensation[i], r.position[i], r.velocity[i], measured[i],
                                                 s.error[i].velocity, s.status);
      const double wanted = compensation_[i].mass() * acceleration[i] + added;
      s.force[i] = clamp_to(wanted, -params_.force_limit[i], params_.force_limit[i]);
      if (s.force[i] != wanted) s.status.raise(Status::kOutputLimited);
      compensation_[i].applied(s.compensation[i], s.force[i]);
    }
    return s.force;
  }

 private:
  Params params_;
  std::array<Compensation, 2> compensation_;
  double period_;
};

}  // namespace stribeck::control
