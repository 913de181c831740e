#pragma once
/// Cutting-force observer: subtracts the identified friction from the force of a drive and splits the rest into a slow part and
/// oscillations of known frequencies (once per turn of the spindle, once per tooth …).
///
///   ẋ = v,   v̇ = (f − F_friction(ṙ, r) − load − d)/m,   d = d₀ + Σ c_k,   ċ_k = −ω_k s_k,   ṡ_k = ω_k c_k,   y = x
///
///   Stationary Kalman filter, exact over a period with f held. d₀, c_k, s_k are random walks; the ratios of their densities to
///   the encoder's r are  q₀ = m²ω₀⁶ r,  q_k = 2σ²ω_k⁴ m² r:  slow poles on Butterworth's circle of radius ω₀, poles of the
///   oscillations near −σ ± jω_k. Only ω₀ [rad/s] and σ [1/s] must be chosen: d₀ follows with a lag of 2/ω₀, an oscillation
///   with 1/σ. f force on the axis [N], m mass [kg], ω_k [rad/s]. d > 0 brakes a motion in +x; a controller may add it.
///
/// It cannot separate slow errors of the friction model from the mean cutting force (10 % of Coulomb friction adds 10 % of it
/// to d₀, exactly), nor a periodic friction term from an oscillation if speed/period meets ω_k within σ. After a reversal the
/// error of the friction model is a step, which shows for about 1/ω₀ in d₀ and 1/σ in the oscillations.
/// Source: Johnson 1971 (waveform models of disturbances); Anderson, Moore, Optimal Filtering, 1979.
/// Not modelled: frequencies above half the sampling rate (they alias), changing spindle speed, delay, flexible axes.
/// Real time: safe; the constructor (iterates the Riccati equation) configure only.

#include <array>
#include <stribeck/core/vec.hpp>
#include <stribeck/friction/axis_model.hpp>

namespace stribeck::control {

template <std::size_t Waves>
class CuttingForceObserver {
 public:
  /// x, v, d₀, then (c, s) of each oscillation.
  static constexpr std::size_t kStates = 3 + 2 * Waves;

  struct Params {
    friction::AxisModel model;              ///< identified model of the axis
    std::array<double, Waves> frequency{};  ///< ω_k [rad/s]
    double slow_bandwidth = 100.0;          ///< ω₀ [rad/s]
    double wave_bandwidth = 5.0;            ///< σ [1/s]
    double period = 1e-3;                   ///< T [s]

    /// Whether the oscillations can be seen and separated: ω₀ < ω_k < π/T − ω₀, neighbours at least 4σ apart.
    [[nodiscard]] bool determinable() const noexcept {
      if (!(slow_bandwidth > 0.0 && wave_bandwidth > 0.0 && period > 0.0 && model.mass > 0.0)) return false;
      if (!(slow_bandwidth * period < 1.0)) return false;
      for (std::size_t i = 0; i < Waves; ++i) {
        if (!(frequency[i] > slow_bandwidth && frequency[i] < kPi / period - slow_bandwidth)) return false;
        for (std::size_t k = 0; k < i; ++k) {
          if (!(abs(frequency[i] - frequency[k]) > 4.0 * wave_bandwidth)) return false;
        }
      }
      return true;
    }
  };
  struct State {
    Vec<double, kStates> estimate;  ///< x, v·T, then forces times T²/m; all [m]
    bool started = false;
  };

  CuttingForceObserver() = default;
  explicit CuttingForceObserver(const Params& p) noexcept
      : model_(p.model), period_(p.period), force_(p.model.mass / (p.period * p.period)) {
    a_[0][0] = a_[0][1] = a_[1][1] = a_[2][2] = 1.0;
    a_[0][2] = -0.5;
    a_[1][2] = -1.0;
    for (std::size_t k = 0; k < Waves; ++k) {
      const std::size_t c = 3 + 2 * k;
      const double turn = p.frequency[k] * p.period;
      const double cosine = cos(turn);
      const double sine = sin(turn);
      a_[c][c] = a_[c + 1][c + 1] = cosine;
      a_[c][c + 1] = -sine;
      a_[c + 1][c] = sine;
      // An oscillation integrated once and twice over the period.
      mean_[k] = {{sine / turn, -(1.0 - cosine) / turn}};
      a_[1][c] = -mean_[k][0];
      a_[1][c + 1] = -mean_[k][1];
      a_[0][c] = -(1.0 - cosine) / (turn * turn);
      a_[0][c + 1] = (1.0 - sine / turn) / turn;
    }
    Vec<double, kStates> walk;
    walk[2] = pow(p.slow_bandwidth * p.period, 6);
    for (std::size_t k = 0; k < Waves; ++k)
      walk[3 + 2 * k] = walk[4 + 2 * k] =
          2.0 * pow(p.wave_bandwidth * p.period, 2) * pow(p.frequency[k] * p.period, 4);
    solve(walk);
  }

  /// One period: force f [N] held since the last call for the reference r [m], ṙ [m/s] of that time; encoder position [m] now.
  void step(State& s, double force, double reference, double reference_velocity,
            double position) const noexcept {
    if (!s.started) {
      s.estimate[0] = position;
      s.estimate[1] = reference_velocity * period_;
      s.started = true;
      return;
    }
    const auto friction = model_.friction.parts(reference_velocity, reference);
    const double net = force - friction.level * sign(reference_velocity) - friction.viscous -
                       friction.additive - model_.load;
    Vec<double, kStates> next = a_ * s.estimate;
    next[0] += 0.5 * net / force_;
    next[1] += net / force_;
    s.estimate = next + (position - next[0]) * gain_;
  }

  /// Mean of d over the coming period: the force to add [N].
  [[nodiscard]] double coming(const State& s) const noexcept {
    double d = s.estimate[2];
    for (std::size_t k = 0; k < Waves; ++k)
      d += mean_[k][0] * s.estimate[3 + 2 * k] + mean_[k][1] * s.estimate[4 + 2 * k];
    return force_ * d;
  }
  [[nodiscard]] double slow(const State& s) const noexcept { return force_ * s.estimate[2]; }  ///< d₀ [N]
  /// Amplitude of oscillation k [N].
  [[nodiscard]] double amplitude(const State& s, std::size_t k) const noexcept {
    return force_ * norm(Vec<double, 2>{{s.estimate[3 + 2 * k], s.estimate[4 + 2 * k]}});
  }
  [[nodiscard]] const Vec<double, kStates>& gain() const noexcept { return gain_; }

 private:
  /// Gain for encoder noise of variance 1, and for the variances that the random walks add per period.
  void solve(const Vec<double, kStates>& walk) noexcept {
    constexpr int kIterations = 200000;
    Mat<double, kStates> p;
    for (std::size_t i = 0; i < kStates; ++i) p[i][i] = 1.0;
    for (int n = 0; n < kIterations; ++n) {
      const double s = p[0][0] + 1.0;
      const Vec<double, kStates> k = (1.0 / s) * p[0];
      const double change = norm(k - gain_);
      gain_ = k;
      if (change < 1e-14 * norm(k)) break;
      Mat<double, kStates> updated;
      for (std::size_t i = 0; i < kStates; ++i) updated[i] = p[i] - k[i] * p[0];
      Mat<double, kStates> half;  // updated·Aᵀ, transposed
      for (std::size_t i = 0; i < kStates; ++i) half[i] = a_ * updated[i];
      half = transpose(half);
      for (std::size_t i = 0; i < kStates; ++i) updated[i] = a_ * half[i];
      for (std::size_t i = 0; i < kStates; ++i) {
        for (std::size_t j = 0; j < kStates; ++j) p[i][j] = 0.5 * (updated[i][j] + updated[j][i]);
        p[i][i] += walk[i];
      }
    }
  }

  friction::AxisModel model_;
  double period_ = 1.0;
  double force_ = 1.0;  ///< m/T² [N/m]
  Mat<double, kStates> a_{};
  std::array<Vec<double, 2>, Waves> mean_{};
  Vec<double, kStates> gain_{};
};

}  // namespace stribeck::control
