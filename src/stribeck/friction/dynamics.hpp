#pragma once
/// What every dynamic friction law offers. Plant, feed-forward, replay, fit and variation run any such law.
///
///   F = bristle + viscous + additive      |bristle| tends to the level g(v) while sliding
///
/// A law is a parameter struct with a plain State: numbers that change continuously (deflections, forces) and
/// modes that switch (stick, slip).
///
///   integrators   continuous(s)             the numbers
///                 rate(q, s, v, p)          their rates; q the numbers as the integrator has them, s the modes
///                 force(q, rate, v, p)      F [N]
///                 settle(s, v_before, v, p) after each small step, where modes switch
///   one sample    advance(s, v, level, dt)  exact with v and level held
///                 bristle(s, v, level, ρ)   its force at the end [N]
///                 mean_bristle(before, after, v, dt)   and over the sample [N]
///   states        slide(s, force), carry(s, force)     sliding, or at rest, with this bristle force
///                 shift(s, force, level)    changes it within the level; returns the change [N]
///   parameters    stiffness() [N/m], damping() [N·s/m] before it fades, rate_bound(speed, level) [1/s]
///                 stiffened(factor)         stiffness × factor, damping × √factor
///   reversal      stops()                   where the law is a sum of elastic stops
///
/// ρ scales the stiffness: it is the same bristle in a motion ρ times as fast, which is why callers advance it with ρ·v.
/// A new law is one header and its name in model.hpp. A law without pre-sliding: static.hpp.
/// Real time: safe.

#include <array>
#include <concepts>
#include <optional>
#include <span>
#include <stribeck/core/fixed_vector.hpp>
#include <stribeck/friction/steady.hpp>
#include <type_traits>
#include <variant>

namespace stribeck::friction {

/// What feed-forward and variation need. Every alternative of model.hpp's variant has it, static friction too.
template <class L, class T = double>
concept DynamicLaw = Real<T> && std::copyable<L> && std::is_trivially_copyable_v<typename L::State> &&
    requires(const L& law, typename L::State& s, const typename L::State& at, const T& x, double dt) {
  law.advance(s, x, x, dt);
  { law.bristle(at, x, x, x) } -> std::convertible_to<T>;
  law.slide(s, x);
  law.carry(s, x);
  { law.shift(s, x, x) } -> std::convertible_to<T>;
  { law.stiffened(dt) } -> std::same_as<L>;
};

/// What integrators and fits need in addition: a force that follows from states.
template <class L, class T = double>
concept PreSlidingLaw = DynamicLaw<L, T> &&
    requires(const L& law, typename L::State& s, const typename L::State& at, typename L::Numbers q,
             const T& x, const SteadyParts<T>& p, double dt) {
  requires L::Numbers::extent != std::dynamic_extent;
  { L::continuous(s) } -> std::same_as<std::span<T, L::Numbers::extent>>;
  { law.rate(q, at, x, p) } -> std::same_as<std::array<T, L::Numbers::extent>>;
  { law.force(q, law.rate(q, at, x, p), x, p) } -> std::convertible_to<T>;
  { law.mean_bristle(at, at, x, dt) } -> std::convertible_to<T>;
  { law.stiffness() } -> std::convertible_to<T>;
  { law.damping() } -> std::convertible_to<T>;
  { law.rate_bound(x, x) } -> std::convertible_to<T>;
};

/// Every alternative of a variant satisfies one of the two concepts; only static friction has no pre-sliding.
template <class Laws>
inline constexpr bool kAllDynamicLaws = false;
template <class... Law>
inline constexpr bool kAllDynamicLaws<std::variant<Law...>> =
    ((PreSlidingLaw<Law> || (DynamicLaw<Law> && std::is_empty_v<typename Law::State>)) && ...);

/// A law whose states are part of an integrator's vector, from index q on; the modes are kept here.
template <PreSlidingLaw Law>
class Integrated {
 public:
  using State = typename Law::State;
  static constexpr std::size_t kCount = Law::Numbers::extent;

  explicit Integrated(const Law& law) noexcept : law_(law) {}

  [[nodiscard]] const Law& law() const noexcept { return law_; }
  /// Other parameters from now on; the state stays.
  void set_law(const Law& law) noexcept { law_ = law; }

  /// Starts from a state.
  void place(const State& state, double* q) noexcept {
    state_ = state;
    const auto from = Law::continuous(state_);
    for (std::size_t i = 0; i < kCount; ++i) q[i] = from[i];
  }

  /// Friction force [N] and the rates of the states.
  double evaluate(const double* q, double v, const SteadyParts<double>& p, double* rate) const noexcept {
    const typename Law::Numbers numbers(q, kCount);
    const std::array<double, kCount> r = law_.rate(numbers, state_, v, p);
    for (std::size_t i = 0; i < kCount; ++i) rate[i] = r[i];
    return law_.force(numbers, r, v, p);
  }

  static constexpr bool kSettles =
      requires(const Law& law, State& s, double v, const SteadyParts<double>& p) {
    law.settle(s, v, v, p);
  };
  /// Switches modes after a small step that ended at velocity v, having begun at v_before.
  void settle(double* q, double v_before, double v, const SteadyParts<double>& p) noexcept requires kSettles {
    const auto numbers = Law::continuous(state_);
    for (std::size_t i = 0; i < kCount; ++i) numbers[i] = q[i];
    law_.settle(state_, v_before, v, p);
    for (std::size_t i = 0; i < kCount; ++i) q[i] = numbers[i];
  }

 private:
  Law law_;
  State state_{};
};

/// One elastic stop: share of the level that it carries, and distance from −1 to 1 for each newton of level [m/N].
struct Stop {
  double weight = 0.0;
  double reach = 0.0;
};
inline constexpr std::size_t kMostStops = 8;

/// How friction builds up after a reversal: by elastic stops; without any, to 1 − 1/e within distance × level.
struct BuildUp {
  double distance = 0.0;  ///< [m/N]
  FixedVector<Stop, kMostStops> stops;
};

/// The build-up of the law in a variant; absent for a law without pre-sliding, whose force reverses at once.
template <DynamicLaw... Law>
constexpr std::optional<BuildUp> build_up_of(const std::variant<Law...>& laws) noexcept {
  return std::visit(
      []<class L>(const L& law) noexcept -> std::optional<BuildUp> {
        if constexpr (!PreSlidingLaw<L>) {
          return {};
        } else if constexpr (requires { law.stops(); }) {
          return BuildUp{.stops = law.stops()};
        } else {
          return BuildUp{1.0 / law.stiffness(), {}};
        }
      },
      laws);
}

template <DynamicLaw... Law>
constexpr bool has_pre_sliding(const std::variant<Law...>& laws) noexcept {
  return std::visit([]<class L>(const L&) noexcept { return PreSlidingLaw<L>; }, laws);
}

/// The states of all laws of a variant.
template <class Laws>
struct StateOf;
template <DynamicLaw... Law>
struct StateOf<std::variant<Law...>> {
  using Type = std::variant<typename Law::State...>;
};

/// Calls act(law, state) with the law in the variant and its state. A state of another law is replaced by one relaxed at rest.
template <class Laws, class Act>
decltype(auto) with_law(const Laws& laws, typename StateOf<Laws>::Type& state, Act&& act) noexcept {
  return std::visit(
      [&]<class Law>(const Law& law) noexcept -> decltype(auto) {
        auto* s = std::get_if<typename Law::State>(&state);
        if (s == nullptr) s = &state.template emplace<typename Law::State>();
        return act(law, *s);
      },
      laws);
}

}  // namespace stribeck::friction
