#pragma once
/// A friction law that is not built in, written as CONTRIBUTING asks for: Dahl's, with the bristle force itself as state.
///
///   Ḟ = σ·(v − |v|·F/g)      [N/s]      σ stiffness [N/m], g level of the steady map [N]
///
/// It is LuGre without damping in other coordinates (F = σ·z), so that every result has a reference, and shares no line
/// of code with it.
/// Source: Dahl 1968, A solid friction model.
/// Not modelled: damping of pre-sliding.
/// Real time: safe.

#include <cmath>
#include <stribeck/friction/dynamics.hpp>
#include <stribeck/friction/model.hpp>

namespace stribeck::test {

struct Dahl {
  static constexpr std::string_view kKind = "dahl";

  double sigma = 1.0;

  struct State {
    double force = 0.0;
  };

  static constexpr auto fields() {
    return std::tuple{field("sigma", &Dahl::sigma, quantity("N/m", "N/mm").positive(), "stiffness σ")};
  }

  using Numbers = std::span<const double, 1>;
  static std::span<double, 1> continuous(State& s) noexcept { return std::span<double, 1>(&s.force, 1); }
  [[nodiscard]] std::array<double, 1> rate(Numbers q, const State&, double v,
                                           const friction::SteadyParts<double>& p) const noexcept {
    return {sigma * (v - std::abs(v) * q[0] / p.level)};
  }
  [[nodiscard]] double force(Numbers q, const std::array<double, 1>&, double,
                             const friction::SteadyParts<double>& p) const noexcept {
    return q[0] + p.viscous + p.additive;
  }

  void advance(State& s, double v, double level, double dt) const noexcept {
    if (v == 0.0) return;
    const double end = std::copysign(level, v);
    s.force = end + (s.force - end) * std::exp(-sigma * std::abs(v) * dt / level);
  }
  [[nodiscard]] double bristle(const State& s, double, double, double) const noexcept { return s.force; }
  [[nodiscard]] double mean_bristle(const State& before, const State& after, double, double) const noexcept {
    return 0.5 * (before.force + after.force);
  }

  void slide(State& s, double bristle_force) const noexcept { s.force = bristle_force; }
  void carry(State& s, double bristle_force) const noexcept { s.force = bristle_force; }
  [[nodiscard]] double shift(State& s, double by, double level) const noexcept {
    const double before = s.force;
    s.force = clamp_to(before + by, -level, level);
    return s.force - before;
  }

  [[nodiscard]] Dahl stiffened(double factor) const noexcept { return {sigma * factor}; }
  [[nodiscard]] double stiffness() const noexcept { return sigma; }
  [[nodiscard]] double damping() const noexcept { return 0.0; }
  [[nodiscard]] double rate_bound(double speed, double level) const noexcept { return sigma * speed / level; }
};

/// The built-in laws and this one: the line of model.hpp.
using Laws = std::variant<friction::Static, friction::LuGre<double>, friction::Gms<double>, Dahl>;
using Model = friction::BasicModel<Laws>;

}  // namespace stribeck::test
