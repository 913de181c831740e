#pragma once
/// Kalman observer of position, velocity and disturbance from the encoder.
///
///   ẋ = v     v̇ = (f − f_ff − d)/m     ḋ = white noise of density q_d     y = x + noise of variance r
///
///   Steady gain of the filter discretised with f held over a period; q_d [N²·s⁻¹], r = resolution²/12 [m²].
///
/// d̂ > 0 brakes a motion in +x; a controller adds it to its force. The encoder measures the position, so the
/// position is a state too: the noise of a differenced encoder would not be white.
/// Source: Erkorkmaz, Altintas 2001, as the thesis cites for its observer; Anderson, Moore, Optimal Filtering, 1979.
/// Not modelled: coloured force noise.
/// Real time: safe; the constructor (iterates the Riccati equation) configure only.

#include <stribeck/core/vec.hpp>

namespace stribeck::control {

class KalmanObserver {
 public:
  struct State {
    Vec<double, 3> estimate;  ///< x̂ [m], v̂ [m/s], d̂ [N]
    bool started = false;
  };

  KalmanObserver() = default;
  /// Density of the disturbance's random walk [N²/s], encoder variance [m²], mass [kg], period [s]; all > 0.
  KalmanObserver(double disturbance_density, double encoder_variance, double mass, double period) noexcept
      : t_(period), m_(mass) {
    // Computed in units in which the numbers are near 1: d/m replaces d.
    const double q = disturbance_density / (mass * mass);
    const double t = period;
    using M3 = Mat<double, 3>;
    const M3 phi{{{{{1.0, t, -0.5 * t * t}}, {{0.0, 1.0, -t}}, {{0.0, 0.0, 1.0}}}}};
    const double t2 = t * t;
    const M3 noise{{{{{q * t2 * t2 * t / 20, q * t2 * t2 / 8, -q * t2 * t / 6}},
                     {{q * t2 * t2 / 8, q * t2 * t / 3, -q * t2 / 2}},
                     {{-q * t2 * t / 6, -q * t2 / 2, q * t}}}}};
    M3 p = noise;
    p[0][0] = p[0][0] + encoder_variance;
    for (int i = 0; i < kIterations; ++i) {
      const double s = p[0][0] + encoder_variance;
      const Vec<double, 3> k{{p[0][0] / s, p[1][0] / s, p[2][0] / s}};
      const Vec<double, 3> top = p[0];
      M3 updated;
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t b = 0; b < 3; ++b) updated[a][b] = p[a][b] - k[a] * top[b];
      }
      p = phi * updated * transpose(phi);
      for (std::size_t a = 0; a < 3; ++a) p[a] = p[a] + noise[a];
      const double change = norm(k - gain_);
      gain_ = k;
      if (change < 1e-13 * norm(k)) break;
    }
  }

  /// One period: force f − f_ff [N] held since the last call, encoder position [m] now. Returns d̂ [N].
  double step(State& s, double force, double position) const noexcept {
    if (!s.started) {
      s.estimate = {{position, 0.0, 0.0}};
      s.started = true;
      return 0.0;
    }
    const double acceleration = (force - s.estimate[2]) / m_;
    const double x = s.estimate[0] + t_ * s.estimate[1] + 0.5 * t_ * t_ * acceleration;
    const double v = s.estimate[1] + t_ * acceleration;
    const double innovation = position - x;
    s.estimate = {
        {x + gain_[0] * innovation, v + gain_[1] * innovation, s.estimate[2] + m_ * gain_[2] * innovation}};
    return s.estimate[2];
  }

  /// The same without a measurement: the state follows the model, the disturbance stays.
  void predict(State& s, double force) const noexcept {
    if (!s.started) return;
    const double acceleration = (force - s.estimate[2]) / m_;
    s.estimate[0] += t_ * s.estimate[1] + 0.5 * t_ * t_ * acceleration;
    s.estimate[1] += t_ * acceleration;
  }

  /// Density of the random walk [N²/s] that puts the observer's poles at about `bandwidth` [1/s], for an encoder of this
  /// resolution [m]: (q_d/(m²r))^(1/6).
  static constexpr double density(double bandwidth, double resolution, double mass) noexcept {
    const double cube = bandwidth * bandwidth * bandwidth;
    return cube * cube * mass * mass * resolution * resolution / 12.0;
  }

  /// The bandwidth [1/s] of that density.
  static double bandwidth(double density, double resolution, double mass) noexcept {
    return pow(sqrt(12.0 * density) / (mass * resolution), 1.0 / 3.0);
  }

  /// Response of d̂ to a disturbance that acted over the last period [N], that is, the observer's own lag for one signal. `error` is
  /// the state of that response, zero at the start.
  double answer(Vec<double, 3>& error, double disturbance) const noexcept {
    // Errors of x̂ and v̂, and d̂ itself: the disturbance drives the axis, d̂ the estimate.
    const double acceleration = (error[2] - disturbance) / m_;
    const double x = error[0] + t_ * error[1] + 0.5 * t_ * t_ * acceleration;
    const double v = error[1] + t_ * acceleration;
    error = {{x - gain_[0] * x, v - gain_[1] * x, error[2] + m_ * gain_[2] * x}};
    return error[2];
  }
  /// The same over a period without a measurement, consistent with predict().
  double predicted_answer(Vec<double, 3>& error, double disturbance) const noexcept {
    const double acceleration = (error[2] - disturbance) / m_;
    error[0] += t_ * error[1] + 0.5 * t_ * t_ * acceleration;
    error[1] += t_ * acceleration;
    return error[2];
  }

 private:
  static constexpr int kIterations = 100000;

  Vec<double, 3> gain_{};
  double t_ = 1.0;
  double m_ = 1.0;
};

}  // namespace stribeck::control
