#pragma once
/// A complete friction model, as files and compensators hold it: one steady map, places, eccentric terms and a spring over it, and a
/// dynamic law (or none) whose steady state is their sum.
///
/// The spring is no friction. It stands here because it depends on the position, as the weight of an unbalanced rotary axis does
/// (unbalance.hpp): whoever evaluates a model at a position has both.
///
/// Variants hold the map and the law; which of them runs is decided once, when the model is read. Loops run on Composed<Map> and on
/// the law. A new one is a header and a name in SteadyVariant (steady.hpp lists what a map offers) or in DynamicsVariant
/// (dynamics.hpp).
/// Real time: safe.

#include <limits>
#include <optional>
#include <stribeck/friction/conventional.hpp>
#include <stribeck/friction/dynamics.hpp>
#include <stribeck/friction/eccentric.hpp>
#include <stribeck/friction/gaussian.hpp>
#include <stribeck/friction/gms.hpp>
#include <stribeck/friction/lugre.hpp>
#include <stribeck/friction/places.hpp>
#include <stribeck/friction/spring.hpp>
#include <stribeck/friction/static.hpp>
#include <variant>

namespace stribeck::friction {

inline constexpr std::size_t kMaxEccentricTerms = 4;

/// A map's own approximation around v where it has one, otherwise the map itself.
template <class Map, class T>
decltype(auto) near_or_itself(const Map& map, const T& v) noexcept {
  if constexpr (requires { map.near(v); }) {
    return map.near(v);
  } else {
    return (map);
  }
}

/// A base map with places, eccentric terms and a spring; the sum is again a steady map.
template <class Map, Real T = double>
struct Composed {
  Map base;
  FixedVector<Eccentric<T>, kMaxEccentricTerms> eccentric;
  Places places{};
  std::optional<Spring> spring{};

  [[nodiscard]] SteadyParts<T> parts(const T& v, const T& x) const noexcept {
    SteadyParts<T> p = base.parts(v, x);
    lay_over(p, x);
    return p;
  }
  void lay_over(SteadyParts<T>& p, const T& x) const noexcept {
    if (!places.empty()) p.level = p.level * T(shares_at(places, value_of(x)).level);
    for (const auto& term : eccentric) term.add_to(p, x);
    if (spring) p.additive = p.additive + spring->at(x);
  }

  /// The same around v, where the base has a cheaper form (table.hpp).
  struct Near {
    const Composed* whole;
    decltype(near_or_itself(std::declval<const Map&>(), std::declval<const T&>())) base;

    [[nodiscard]] SteadyParts<T> parts(const T& v, const T& x) const noexcept {
      SteadyParts<T> p = base.parts(v, x);
      whole->lay_over(p, x);
      return p;
    }
  };
  [[nodiscard]] Near near(const T& v) const noexcept { return {this, near_or_itself(base, v)}; }
};

using SteadyVariant = std::variant<Conventional<double>, Gaussian<double>>;
using DynamicsVariant = std::variant<Static, LuGre<double>, Gms<double>>;

// A law that lacks one of these functions does not compile; no other law takes its place.
static_assert(kAllSteadyLaws<SteadyVariant> && kAllDynamicLaws<DynamicsVariant>);

/// A model over any variant of dynamic laws: a test can run a law that is not built in.
template <class Dynamics>
struct BasicModel {
  SteadyVariant steady;
  FixedVector<Eccentric<double>, kMaxEccentricTerms> eccentric;
  Dynamics dynamics;
  Places places{};
  std::optional<Spring> spring{};

  static constexpr auto fields() {
    return std::tuple{
        field("steady", &BasicModel::steady, "steady-state map of velocity"),
        field("eccentric", &BasicModel::eccentric, "terms periodic in position, at most four").or_default(),
        field("dynamics", &BasicModel::dynamics, "pre-sliding behaviour; left out: none").or_default(),
        field(
            "places", &BasicModel::places,
            "friction that differs along the travel, at most thirteen places in ascending order; left out: everywhere the same")
            .or_default(),
        field("spring", &BasicModel::spring,
              "force that grows with the position: a cable chain, a hose, a gas spring; left out: none")
            .or_default()};
  }

  template <class Report>
  void validate(Report&& report) const {
    for (std::size_t i = 1; i < places.size(); ++i) {
      if (!(places[i].position > places[i - 1].position)) {
        report("places", "positions must ascend");
        return;
      }
    }
    double most = 0.0;
    for (const auto& term : eccentric)
      most += term.form == EccentricForm::kProportional ? term.amplitude : 0.0;
    if (most > 0.0 && least_level() <= most)
      report(
          "eccentric",
          "proportional terms must stay below the level of friction, at every place and at speeds up to 10 m/s (or those of "
          "the identification), or friction would drive the motion");
  }

  /// Parts of the steady state at velocity v [m/s] and position x [m].
  [[nodiscard]] SteadyParts<double> parts(double v, double x) const noexcept {
    SteadyParts<double> p = std::visit([&](const auto& map) noexcept { return map.parts(v, x); }, steady);
    if (!places.empty()) p.level *= shares_at(places, x).level;
    for (const auto& term : eccentric) term.add_to(p, x);
    if (spring) p.additive += spring->at(x);
    return p;
  }

  /// Velocities of the data behind the steady map [m/s]; absent where the map does not know them.
  [[nodiscard]] std::optional<std::array<double, 2>> identified_range() const noexcept {
    return std::visit([](const auto& map) noexcept { return map.identified_range(); }, steady);
  }
  /// Whether the model was identified at this velocity; a map without a range covers every velocity.
  [[nodiscard]] bool covers(double v) const noexcept {
    const auto range = identified_range();
    return !range || (v >= (*range)[0] && v <= (*range)[1]);
  }

 private:
  static constexpr int kChecked = 500;
  static constexpr double kCheckedSpeed =
      0.1;                                  ///< in equal steps up to here, beyond it in equal ratios [m/s]
  static constexpr double kFastest = 10.0;  ///< faster than feed drives go [m/s]

  /// The lowest level of friction without the eccentric terms, at any place and any speed at which the axis may be used [N].
  [[nodiscard]] double least_level() const noexcept {
    double least = std::numeric_limits<double>::infinity();
    const auto look = [&](double v) {
      least = min_of(least, std::visit([&](const auto& map) { return map.parts(v, 0.0).level; }, steady));
    };
    for (int i = -kChecked; i <= kChecked; ++i) look(kCheckedSpeed * (i + 0.5) / kChecked);
    const auto range = identified_range();
    for (int i = 1; i <= kChecked; ++i) {
      const double v = kCheckedSpeed * pow(kFastest / kCheckedSpeed, static_cast<double>(i) / kChecked);
      if (!range || v <= (*range)[1]) look(v);
      if (!range || -v >= (*range)[0]) look(-v);
    }
    double share = places.empty() ? 1.0 : std::numeric_limits<double>::infinity();
    for (const Place& p : places) share = min_of(share, p.level);
    return share * least;
  }
};

using Model = BasicModel<DynamicsVariant>;

/// A base map with all that the model lays over its own.
template <class Map, class Dynamics>
[[nodiscard]] Composed<Map> composed(const Map& base, const BasicModel<Dynamics>& model) noexcept {
  return {base, model.eccentric, model.places, model.spring};
}

}  // namespace stribeck::friction
