#pragma once
/// LuGre friction on any steady-state curve.
///
///   ż = v − σ0·|v|/g(v)·z        F = σ0·z + σ1(v)·ż + viscous + additive
///   σ1(v) = σ1·exp(−(v/v_d)²)    fades with speed where v_d is given, so that damping stays in pre-sliding
///
///   z bristle deflection [m], σ0 stiffness [N/m], σ1 damping [N·s/m], v_d [m/s], g = level [N]
///
/// F opposes motion: positive for v > 0. advance() moves z exactly over one sample with v and the level held,
/// so that every dt is stable; rate() is for integrators. What every law offers: dynamics.hpp. Beyond
/// |v| = 6.3 v_d (a factor below 1e-17) σ1 counts as zero.
///
/// Source: Canudas de Wit et al. 1995, doi:10.1109/9.376053. Fading damping: Olsson 1996.
/// Not modelled: dependence of σ0 and σ1 on position and load. LuGre drifts under an oscillating force below
/// break-away; gms.hpp does not.
/// Real time: safe; step costs two exp and the map.

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <stribeck/core/fields.hpp>
#include <stribeck/friction/damping.hpp>
#include <stribeck/friction/steady.hpp>

namespace stribeck::friction {

/// (1 − exp(−y))/y for y ≥ 0, without cancellation near 0.
template <Real T>
T hold_gain(const T& y) noexcept {
  const auto small = y < T(1e-3);
  const T safe = select(small, T(1.0), y);
  const T series = T(1.0) - y * (T(0.5) - y * (T(1.0 / 6.0) - y * (T(1.0 / 24.0) - y * T(1.0 / 120.0))));
  return select(small, series, (T(1.0) - exp(-safe)) / safe);
}

template <Real T>
struct LuGre {
  static constexpr std::string_view kKind = "lugre";

  T sigma0{0.0};
  T sigma1{0.0};
  std::optional<T> damping_velocity;

  struct State {
    T z{0.0};
  };

  static constexpr auto fields() {
    return std::tuple{
        field("sigma0", &LuGre::sigma0, quantity("N/m", "N/mm").positive(), "bristle stiffness σ0"),
        field("sigma1", &LuGre::sigma1, quantity("N s/m", "N s/mm").not_negative(), "bristle damping σ1")
            .or_default(),
        field("damping_velocity", &LuGre::damping_velocity, quantity("m/s", "mm/s").positive(),
              "velocity v_d at which σ1 has faded to 1/e; left out: σ1 does not fade")
            .or_default()};
  }

  /// σ1 at velocity v [N·s/m].
  [[nodiscard]] T damping(const T& v) const noexcept { return fading_damping(sigma1, damping_velocity, v); }
  [[nodiscard]] T damping() const noexcept { return sigma1; }
  [[nodiscard]] T stiffness() const noexcept { return sigma0; }
  [[nodiscard]] T rate_bound(const T& speed, const T& level) const noexcept { return sigma0 * speed / level; }
  [[nodiscard]] LuGre stiffened(double factor) const noexcept {
    return {sigma0 * T(factor), sigma1 * T(std::sqrt(factor)), damping_velocity};
  }

  /// ż [m/s].
  [[nodiscard]] T rate(const T& z, const T& v, const SteadyParts<T>& p) const noexcept {
    return v - sigma0 * abs(v) * z / p.level;
  }
  using Numbers = std::span<const T, 1>;
  using Rates = std::array<T, 1>;
  static std::span<T, 1> continuous(State& s) noexcept { return std::span<T, 1>(&s.z, 1); }
  [[nodiscard]] Rates rate(Numbers z, const State&, const T& v, const SteadyParts<T>& p) const noexcept {
    return {rate(z[0], v, p)};
  }

  /// Friction force [N] at deflection z and its rate.
  [[nodiscard]] T force(const T& z, const T& z_rate, const T& v, const SteadyParts<T>& p) const noexcept {
    return sigma0 * z + damping(v) * z_rate + p.viscous + p.additive;
  }
  [[nodiscard]] T force(Numbers z, const Rates& z_rate, const T& v, const SteadyParts<T>& p) const noexcept {
    return force(z[0], z_rate[0], v, p);
  }

  /// Advances the bristle by dt [s] with v and the level held.
  void advance(State& s, const T& v, const T& level, double dt) const noexcept {
    const T y = sigma0 * abs(v) / level * T(dt);
    s.z = exp(-y) * s.z + v * T(dt) * hold_gain(y);
  }
  /// Force of the bristle [N] at velocity v, where its stiffness is `scale` times σ0.
  [[nodiscard]] T bristle(const State& s, const T& v, const T& level, const T& scale) const noexcept {
    return sigma0 * s.z + damping(v) * (rate(s.z, scale * v, {level, T(0.0), T(0.0)}) / scale);
  }
  /// Mean of that force [N] over a hold of dt [s] that led from one state to the other.
  [[nodiscard]] T mean_bristle(const State& before, const State& after, const T& v,
                               double dt) const noexcept {
    return T(0.5) * sigma0 * (before.z + after.z) + damping(v) * (after.z - before.z) / T(dt);
  }

  void slide(State& s, const T& bristle_force) const noexcept { s.z = bristle_force / sigma0; }
  void carry(State& s, const T& bristle_force) const noexcept { s.z = bristle_force / sigma0; }
  [[nodiscard]] T shift(State& s, const T& by, const T& level) const noexcept {
    const T now = sigma0 * s.z;
    const T then = clamp_to(now + by, -level, level);
    s.z = then / sigma0;
    return then - now;
  }

  /// Advances the bristle by dt [s] with v and x held; returns the friction force [N] at the end.
  template <SteadyMap<T> M>
  T step(const M& map, State& state, const T& v, const T& x, double dt) const noexcept {
    const SteadyParts<T> p = map.parts(v, x);
    advance(state, v, p.level, dt);
    return force(state.z, rate(state.z, v, p), v, p);
  }
};

}  // namespace stribeck::friction
