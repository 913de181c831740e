#pragma once
/// Linear-quadratic regulator of a mass under a held acceleration, whose two poles are given.
///
///   e⁺ = e + T·v + T²/2·u + w      v⁺ = v + T·u              u = −k_p·e − k_v·v
///   least of  Σ (q_e·e² + q_v·v² + u²),   value of what follows  p_ee·e² + 2p_ev·e·v + p_vv·v²
///
///   e [m], v [m/s], u [m/s²], w [m] known drift, T [s]. Double pole at z = 1 − ωT, so that k_p = ω² as of a PD; k_v → 2ω for
///   short periods. With p = 1 − ωT, d = ωT, β = d²/p the weights are q_e = β²/T⁴ → ω⁴, q_v = β(β + 8)/(4T²) → 2ω², and the
///   value solves the discrete Riccati equation with 1 + BᵀPB = 1/p² (test). Poles below 0.05 are taken as 0.05.
///
/// Source: spectral factorisation, Anderson, Moore, Optimal Control, 1990; derivation in docs/theory/predictive.md.
/// Real time: safe.

#include <stribeck/core/scalar.hpp>

namespace stribeck::control {

struct MassRegulator {
  double period = 1e-3;  ///< T [s]
  double kp = 0.0;       ///< [1/s²]
  double kv = 0.0;       ///< [1/s]
  double qe = 0.0;       ///< [1/s⁴]
  double qv = 0.0;       ///< [1/s²]
  double pee = 0.0;
  double pev = 0.0;
  double pvv = 0.0;
  double share = 0.0;  ///< 1/(1 + BᵀPB)

  MassRegulator() = default;
  MassRegulator(double omega, double t) noexcept : period(t) {
    constexpr double kLeastPole = 0.05;
    const double p = max_of(1.0 - omega * t, kLeastPole);
    const double d = 1.0 - p;
    const double beta = d * d / p;
    kp = d * d / (t * t);
    kv = d * (3.0 + p) / (2.0 * t);
    qe = beta * beta / (t * t * t * t);
    qv = beta * (beta + 8.0) / (4.0 * t * t);
    share = p * p;
    // BᵀPA = (1 + BᵀPB)·K, and the Riccati equation's second element.
    const double all = 1.0 / share;
    pee = all * kp * kv / t;
    pev = all * kp / t - 0.5 * t * pee;
    pvv = all * (kv / t - kp) - 0.5 * t * pev;
  }

  [[nodiscard]] double law(double e, double v) const noexcept { return -kp * e - kv * v; }
};

}  // namespace stribeck::control
