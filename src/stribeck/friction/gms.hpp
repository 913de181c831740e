#pragma once
/// Generalized Maxwell-slip friction on any steady-state curve.
///
///   N parallel elements, each sticking or slipping:
///     sticks   Ḟ_i = k_i·v                                until |F_i| reaches α_i·g(v)
///     slips    Ḟ_i = C·(α_i·sgn v − F_i/g(v))             until the velocity changes its sign
///   F = Σ F_i + σ(v)·v + viscous + additive
///
///   k_i stiffness [N/m], α_i share of the level [-], Σ α_i = 1, C attraction [N/s], σ damping [N·s/m],
///   fading as exp(−(v/v_d)²) where v_d is given; g = level of the steady map [N]
///
/// F opposes motion: positive for v > 0. advance() moves the elements exactly over one sample with v and the
/// level held, the change from stick to slip inside the sample included; rate() and settle() are for
/// integrators. What every law offers: dynamics.hpp.
///
/// Source: Al-Bender, Lampaert, Swevers 2005, doi:10.1109/TAC.2005.858676.
/// Not modelled: separate damping of every element (σ does not depend on which of them stick, so that the force never jumps);
/// memory of the lubricant beyond C.
/// Real time: safe; step costs one exp per slipping element
/// and the map.

#include <array>
#include <cmath>
#include <concepts>
#include <optional>
#include <span>
#include <stribeck/core/fields.hpp>
#include <stribeck/core/fixed_vector.hpp>
#include <stribeck/friction/damping.hpp>
#include <stribeck/friction/dynamics.hpp>
#include <stribeck/friction/steady.hpp>

namespace stribeck::friction {

template <Real T>
struct GmsElement {
  T stiffness{0.0};
  T share{0.0};

  static constexpr auto fields() {
    return std::tuple{
        field("stiffness", &GmsElement::stiffness, quantity("N/m", "N/mm").positive(),
              "stiffness k of the element"),
        field("share", &GmsElement::share, pure_number().positive().at_most(1.0), "share α of the level")};
  }
};

template <Real T>
struct Gms {
  static constexpr std::string_view kKind = "gms";
  static constexpr std::size_t kMaxElements = 8;

  FixedVector<GmsElement<T>, kMaxElements> elements;
  T attraction{0.0};
  T damping_coefficient{0.0};
  std::optional<T> damping_velocity;

  struct State {
    std::array<T, kMaxElements> force{};     ///< F_i [N]
    std::array<T, kMaxElements> slipping{};  ///< 1 slips, 0 sticks
  };

  static constexpr auto fields() {
    return std::tuple{
        field("elements", &Gms::elements, "elements, usually four or more"),
        field("attraction", &Gms::attraction, quantity("N/s", "N/s").positive(),
              "attraction C: how fast a slipping element returns to its share of the level"),
        field("damping", &Gms::damping_coefficient, quantity("N s/m", "N s/mm").not_negative(),
              "damping σ of pre-sliding")
            .or_default(),
        field("damping_velocity", &Gms::damping_velocity, quantity("m/s", "mm/s").positive(),
              "velocity v_d at which σ has faded to 1/e; left out: σ acts like viscous friction")
            .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    T sum{0.0};
    for (const auto& e : elements) sum = sum + e.share;
    if (elements.empty() || value_of(abs(sum - T(1.0))) > 1e-9)
      report("elements", "the shares must add up to 1");
  }

  /// Sum of the stiffnesses [N/m]: the slope of the first pre-sliding from rest.
  [[nodiscard]] T stiffness() const noexcept {
    T k{0.0};
    for (const auto& e : elements) k = k + e.stiffness;
    return k;
  }

  [[nodiscard]] T damping(const T& v) const noexcept {
    return fading_damping(damping_coefficient, damping_velocity, v);
  }
  [[nodiscard]] T damping() const noexcept { return damping_coefficient; }
  [[nodiscard]] T rate_bound(const T&, const T& level) const noexcept { return attraction / level; }
  [[nodiscard]] Gms stiffened(double factor) const noexcept {
    Gms law = *this;
    for (auto& e : law.elements) e.stiffness = e.stiffness * T(factor);
    law.damping_coefficient = law.damping_coefficient * T(std::sqrt(factor));
    return law;
  }
  /// Distance from one limit of an element to the other: 2·α_i·g/k_i.
  [[nodiscard]] FixedVector<Stop, kMostStops> stops() const noexcept requires std::same_as<T, double> {
    FixedVector<Stop, kMostStops> all;
    if constexpr (std::same_as<T, double>) {  // Clang 14 compiles the body for jets as well
      for (const auto& e : elements) all.push_back({e.share, 2.0 * e.share / e.stiffness});
    }
    return all;
  }

  /// Ḟ_i [N/s] with the present modes.
  [[nodiscard]] T rate(std::size_t i, const T& force_i, const T& slipping_i, const T& v,
                       const SteadyParts<T>& p) const noexcept {
    const T slip = attraction * (elements[i].share * sign(v) - force_i / p.level);
    // Once the velocity has turned against its force, an element sticks. This holds at once, not only after the next settle().
    return select(slipping_i > T(0.5) && force_i * v > T(0.0), slip, elements[i].stiffness * v);
  }

  using Numbers = std::span<const T, kMaxElements>;
  using Rates = std::array<T, kMaxElements>;
  static std::span<T, kMaxElements> continuous(State& s) noexcept { return s.force; }
  [[nodiscard]] Rates rate(Numbers q, const State& s, const T& v, const SteadyParts<T>& p) const noexcept {
    Rates all{};
    for (std::size_t i = 0; i < elements.size(); ++i) all[i] = rate(i, q[i], s.slipping[i], v, p);
    return all;
  }

  /// Friction force [N] of a state.
  [[nodiscard]] T force(const State& s, const T& v, const SteadyParts<T>& p) const noexcept {
    return elastic(s.force) + damping(v) * v + p.viscous + p.additive;
  }
  [[nodiscard]] T force(Numbers q, const Rates&, const T& v, const SteadyParts<T>& p) const noexcept {
    return elastic(q) + damping(v) * v + p.viscous + p.additive;
  }

  /// Changes between stick and slip after a small step that ended at velocity v and began at v_before.
  void settle(State& s, const T& v_before, const T& v, const SteadyParts<T>& p) const noexcept {
    const auto reversed = v_before * v <= T(0.0);
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const T limit = elements[i].share * p.level;
      const T slipping = select(reversed, T(0.0), s.slipping[i]);
      // A sticking element cannot carry more than its share; one that pushes the other way still sticks.
      const auto breaks = slipping < T(0.5) && s.force[i] * sign(v) >= limit;
      s.force[i] = select(breaks, limit * sign(v), s.force[i]);
      s.slipping[i] = select(breaks, T(1.0), slipping);
    }
  }

  /// Advances the elements by dt [s] with v and the level held.
  void advance(State& s, const T& v, const T& level, double dt) const noexcept {
    const T direction = sign(v);
    const auto moving = v > T(0.0) || v < T(0.0);
    const T speed = select(moving, abs(v), T(1.0));
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const T limit = elements[i].share * level;
      // An element that slipped in the other direction sticks again: its force still points that way.
      const auto slips = s.slipping[i] > T(0.5) && s.force[i] * direction > T(0.0);
      const T start = s.force[i];
      // Time to the limit while sticking; an element already there slips from the beginning.
      const T reach = max_of((limit - start * direction) / (elements[i].stiffness * speed), T(0.0));
      const T slip_from = select(slips, T(0.0), reach);
      const auto ends_slipping = moving && slip_from <= T(dt);
      const T stuck_end = start + elements[i].stiffness * v * T(dt);
      const T slip_start = select(slips, start, limit * direction);
      const T decay = exp(-(attraction / level) * max_of(T(dt) - slip_from, T(0.0)));
      const T slip_end = limit * direction + (slip_start - limit * direction) * decay;
      s.force[i] = select(ends_slipping, slip_end, stuck_end);
      s.slipping[i] = select(ends_slipping, T(1.0), select(moving, T(0.0), s.slipping[i]));
    }
  }
  /// Force of the elements and their damping [N] at velocity v. The scale of the stiffness is not needed: σ acts on v, not on a
  /// deflection.
  [[nodiscard]] T bristle(const State& s, const T& v, const T&, const T&) const noexcept {
    return elastic(s.force) + damping(v) * v;
  }
  /// Mean of that force [N] over a hold of dt [s] that led from one state to the other.
  [[nodiscard]] T mean_bristle(const State& before, const State& after, const T& v, double) const noexcept {
    return T(0.5) * (elastic(before.force) + elastic(after.force)) + damping(v) * v;
  }

  void slide(State& s, const T& bristle_force) const noexcept { share_out(s, bristle_force, T(1.0)); }
  void carry(State& s, const T& bristle_force) const noexcept { share_out(s, bristle_force, T(0.0)); }
  [[nodiscard]] T shift(State& s, const T& by, const T& level) const noexcept {
    T moved{0.0};
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const T& share = elements[i].share;
      const T then = clamp_to(s.force[i] + share * by, -share * level, share * level);
      moved = moved + (then - s.force[i]);
      s.force[i] = then;
      s.slipping[i] = T(0.0);
    }
    return moved;
  }

  /// Advances the elements by dt [s] with v and x held; returns the friction force [N] at the end.
  template <SteadyMap<T> M>
  T step(const M& map, State& s, const T& v, const T& x, double dt) const noexcept {
    const SteadyParts<T> p = map.parts(v, x);
    advance(s, v, p.level, dt);
    return force(s, v, p);
  }

 private:
  /// Σ F_i [N].
  [[nodiscard]] T elastic(Numbers force) const noexcept {
    T sum{0.0};
    for (std::size_t i = 0; i < elements.size(); ++i) sum = sum + force[i];
    return sum;
  }
  void share_out(State& s, const T& bristle_force, const T& slipping) const noexcept {
    for (std::size_t i = 0; i < elements.size(); ++i) {
      s.force[i] = bristle_force * elements[i].share;
      s.slipping[i] = slipping;
    }
  }
};

}  // namespace stribeck::friction
