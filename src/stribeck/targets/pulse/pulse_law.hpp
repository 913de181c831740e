#pragma once
/// A cascade with a pulse on its set-point of speed at each reversal, as controls add it against the quadrant error.
///
///   p ← p·exp(−T/τ) in every period, and p ← p ± A(|a|) where the set-point of speed changes its sign
///   q = ±B from then on until a time has passed, or while the reference is within a distance from there
///   v_c = K_v·(r − x) + c_v·ṙ + p + q
///
///   A, B amplitudes [m/s], a acceleration of the reference at that instant [m/s²], τ time constant [s], T period [s].
///   With τ = T_n the decaying part becomes a step of force m·K_p·A, because the integral of the velocity loop takes over what p
///   gives away.
///
/// A set-point changes its sign once for each change of sign of the reference: noise fires no pulse.
/// Real time: no.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <stribeck/targets/pulse/around_cascade.hpp>

namespace stribeck::targets {

struct Pulse {
  std::function<double(double)>
      amplitude;               ///< of the part that decays [m/s] at an acceleration [m/s²]; empty: none
  double time_constant = 0.0;  ///< [s]
  double block = 0.0;          ///< height of the part that is constant [m/s]
  double block_time = 0.0;     ///< how long it lasts [s]; 0: it acts over a distance
  std::array<double, 2> block_travel{};  ///< from and to this distance from the reversal [m]
};

class PulsedCascade final : public AroundCascade {
 public:
  /// `cascade` must be made of these params, with differences of set positions.
  PulsedCascade(const sim::AnyController<2>& cascade, const control::CascadeParams& params, double period,
                std::array<Pulse, 2> pulses)
      : AroundCascade(cascade),
        gain_(control::spread<2>(params.position_gain)),
        share_(params.velocity_feedforward),
        period_(period),
        pulses_(std::move(pulses)) {}

  [[nodiscard]] std::unique_ptr<LawRunner> copy() const override {
    return std::make_unique<PulsedCascade>(*this);
  }
  Vec<double, 2> step(const Point& now, const Vec<double, 2>& measured) override {
    Point shifted = now;
    for (std::size_t i = 0; i < 2; ++i) shifted.position[i] += shift(i, now, measured[i]);
    return cascade_step(shifted, measured);
  }

 private:
  struct Axis {
    double direction = 0.0;  ///< of the reference
    bool armed = false;      ///< the reference has reversed, the set-point of speed has not
    double pulse = 0.0;      ///< [m/s]
    double shift = 0.0;      ///< [m]
    double side = 0.0;       ///< direction of the constant part; 0: none yet
    double since = 0.0;      ///< its beginning, counted from now [s]
    double from = 0.0;       ///< set position there [m]
  };

  /// The constant part, in the mean over the period that begins now [m/s].
  double block(const Pulse& pulse, Axis& a, double position) const {
    double share = 0.0;
    if (pulse.block_time > 0.0) {
      share = std::clamp((pulse.block_time - a.since) / period_, 0.0, 1.0);
    } else {
      const double travel = std::abs(position - a.from);
      share = travel >= pulse.block_travel[0] && travel < pulse.block_travel[1] ? 1.0 : 0.0;
    }
    a.since += period_;
    return a.side * pulse.block * share;
  }

  /// Shift δ of the reference that adds the pulse to the set-point of speed: K_v·δ + c_v·Δδ/T = p.
  double shift(std::size_t i, const Point& now, double measured) {
    Axis& a = axes_[i];
    const Pulse& pulse = pulses_[i];
    if (pulse.amplitude) a.pulse *= std::exp(-period_ / pulse.time_constant);
    const double direction = sign(now.velocity[i]);
    if (direction != 0.0) {
      a.armed = a.armed || (a.direction != 0.0 && direction != a.direction);
      a.direction = direction;
    }
    const double set_point = gain_[i] * (now.position[i] - measured) + share_ * now.velocity[i];
    if (a.armed && set_point * a.direction > 0.0) {
      if (pulse.amplitude) a.pulse += a.direction * pulse.amplitude(std::abs(now.acceleration[i]));
      a.armed = false;
      a.side = a.direction;
      a.since = 0.0;
      a.from = now.position[i];
    }
    a.shift = (a.pulse + block(pulse, a, now.position[i]) + share_ / period_ * a.shift) /
              (gain_[i] + share_ / period_);
    return a.shift;
  }

  Vec<double, 2> gain_;  ///< K_v [1/s]
  double share_;         ///< c_v
  double period_;        ///< [s]
  std::array<Pulse, 2> pulses_;
  std::array<Axis, 2> axes_;
};

}  // namespace stribeck::targets
