#pragma once
/// A cascade with a pulse on its set-point of speed at each reversal, as controls add it against the quadrant error.
///
///   p ← p·exp(−T/τ) in every period, and p ← p ± A(|a|) where the set-point of speed changes its sign;   v_c = K_v·(r − x) + c_v·ṙ + p
///
///   A amplitude [m/s], a acceleration of the reference at that instant [m/s²], τ time constant [s], T period [s].
///   With τ = T_n the pulse becomes a step of force m·K_p·A, because the integral of the velocity loop takes over what p gives away.
///
/// A set-point changes its sign once for each change of sign of the reference: noise fires no pulse.
/// Real time: no.

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <stribeck/sim/law/law_runner.hpp>

namespace stribeck::targets {

struct Pulse {
  std::function<double(double)> amplitude;  ///< [m/s] at an acceleration [m/s²]
  double time_constant = 0.0;               ///< [s]
};

class PulsedCascade final : public sim::LawRunner<2> {
 public:
  /// `cascade` must be made of these params, with differences of set positions.
  PulsedCascade(const sim::AnyController<2>& cascade, const control::CascadeParams& params, double period,
                std::array<Pulse, 2> pulses)
      : cascade_(cascade->copy()),
        gain_(control::spread<2>(params.position_gain, 0.0)),
        share_(params.velocity_feedforward),
        period_(period),
        pulses_(std::move(pulses)) {}
  PulsedCascade(const PulsedCascade& other)
      : LawRunner(other),
        cascade_(other.cascade_->copy()),
        gain_(other.gain_),
        share_(other.share_),
        period_(other.period_),
        pulses_(other.pulses_),
        axes_(other.axes_) {}

  [[nodiscard]] std::unique_ptr<LawRunner> copy() const override {
    return std::make_unique<PulsedCascade>(*this);
  }
  Vec<double, 2> step(const Point& now, const Vec<double, 2>& measured) override {
    Point shifted = now;
    for (std::size_t i = 0; i < 2; ++i) shifted.position[i] += shift(i, now, measured[i]);
    return cascade_->step(shifted, measured);
  }
  Vec<double, 2> step_ahead(std::span<const Point> points, const Vec<double, 2>& measured) override {
    return step(points.front(), measured);
  }
  [[nodiscard]] double lag() const override { return cascade_->lag(); }
  [[nodiscard]] const StatusCounter& status() const override { return cascade_->status(); }
  [[nodiscard]] std::vector<control::Drift> drift(double period) const override {
    return cascade_->drift(period);
  }

 private:
  struct Axis {
    double direction = 0.0;  ///< of the reference
    bool armed = false;      ///< the reference has reversed, the set-point of speed has not
    double pulse = 0.0;      ///< [m/s]
    double shift = 0.0;      ///< [m]
  };

  /// Shift δ of the reference that adds the pulse to the set-point of speed: K_v·δ + c_v·Δδ/T = p.
  double shift(std::size_t i, const Point& now, double measured) {
    Axis& a = axes_[i];
    a.pulse *= std::exp(-period_ / pulses_[i].time_constant);
    const double direction = sign(now.velocity[i]);
    if (direction != 0.0) {
      a.armed = a.armed || (a.direction != 0.0 && direction != a.direction);
      a.direction = direction;
    }
    const double set_point = gain_[i] * (now.position[i] - measured) + share_ * now.velocity[i];
    if (a.armed && set_point * a.direction > 0.0) {
      a.pulse += a.direction * pulses_[i].amplitude(std::abs(now.acceleration[i]));
      a.armed = false;
    }
    a.shift = (a.pulse + share_ / period_ * a.shift) / (gain_[i] + share_ / period_);
    return a.shift;
  }

  std::unique_ptr<LawRunner> cascade_;
  Vec<double, 2> gain_;  ///< K_v [1/s]
  double share_;         ///< c_v
  double period_;        ///< [s]
  std::array<Pulse, 2> pulses_;
  std::array<Axis, 2> axes_;
};

}  // namespace stribeck::targets
