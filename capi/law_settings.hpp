#pragma once
/// The laws that a controller of the C interface may have, and their parameters. A law declares them itself (fields() of its
/// Params); this file tells which of them are per axis, and the values of those that are not set.
///
///   per axis   lists of the law: along the path, then across it, or of the axis (mass_bound, force_bound, speed_limit)
///   shared     all others; they must be equal on all axes
///   not here   kp, kv, omega and error_rate, which every axis has under these names for any law
///
/// Real time: configure only.

#include <array>
#include <optional>
#include <stribeck/control/laws/contouring.hpp>
#include <stribeck/control/laws/learning.hpp>
#include <stribeck/control/laws/predictive.hpp>
#include <stribeck/control/laws/sliding_mode.hpp>
#include <string_view>
#include <tuple>
#include <variant>

#include "parameters.hpp"

namespace stribeck::capi {

/// The permitted range of a law's parameter of this name.
template <class Params>
constexpr Quantity quantity_of(std::string_view name) {
  Quantity found;
  std::apply([&](const auto&... each) { ((each.name == name ? void(found = each.quantity) : void()), ...); },
             Params::fields());
  return found;
}

template <class Params, std::size_t I>
constexpr auto shared_field() {
  constexpr auto kField = std::get<I>(Params::fields());
  using Member = typename std::decay_t<decltype(kField)>::member_type;
  if constexpr (std::is_same_v<Member, control::PerAxis> || std::is_same_v<Member, control::ErrorRate> ||
                kField.name == "omega") {
    return std::tuple{};
  } else {
    return std::tuple{kField};
  }
}

/// The parameters of a law that are not per axis.
template <class Params>
constexpr auto shared_fields() {
  return []<std::size_t... I>(std::index_sequence<I...>) {
    return std::tuple_cat(shared_field<Params, I>()...);
  }
  (std::make_index_sequence<std::tuple_size_v<decltype(Params::fields())>>());
}

/// The parameters of a law that are the same on all axes.
template <class Params>
struct Shared : Params {
  static constexpr auto fields() { return shared_fields<Params>(); }
};

struct ContouringLaw {
  using Params = control::ContouringParams;
  static constexpr std::string_view kKind = Params::kKind;
  static constexpr auto fields() { return std::tuple{}; }
};

struct SlidingModeLaw {
  using Params = control::SlidingModeParams;
  static constexpr std::string_view kKind = Params::kKind;

  Shared<Params> shared;
  std::optional<double> lambda, a;                ///< [1/s]
  std::optional<double> gamma;                    ///< [m/s²]
  std::optional<double> mass_bound, force_bound;  ///< [kg], [N]
  std::optional<double> gamma_least, gamma_most;  ///< [m/s²]

  static constexpr auto fields() {
    using L = SlidingModeLaw;
    return std::tuple{
        embedded(&L::shared),
        field("lambda", &L::lambda, quantity_of<Params>("lambda"),
              "slope of the surface; axis 0: along the path, others: across it; left out: omega"),
        field("a", &L::a, quantity_of<Params>("a"),
              "gain towards the surface, in the same order; left out: omega"),
        field("gamma", &L::gamma, quantity_of<Params>("gamma"),
              "constant part of the switching gain; left out: 10 mm/s2, across the path 20"),
        field("mass_bound", &L::mass_bound, quantity_of<Params>("mass_bound"),
              "bound of the error of the axis's mass; left out: a tenth of it"),
        field("force_bound", &L::force_bound, quantity_of<Params>("force_bound"),
              "bound of the error of its friction and load; left out: 0"),
        field("gamma_least", &L::gamma_least, quantity_of<Params>("gamma_least"),
              "adaptive: least switching gain; left out: 1 mm/s2"),
        field("gamma_most", &L::gamma_most, quantity_of<Params>("gamma_most"),
              "adaptive: greatest switching gain; left out: 100 mm/s2")};
  }
};

struct PredictiveLaw {
  using Params = control::PredictiveParams;
  static constexpr std::string_view kKind = Params::kKind;

  Shared<Params> shared;
  std::optional<double> speed_limit;  ///< [m/s]

  static constexpr auto fields() {
    using L = PredictiveLaw;
    return std::tuple{embedded(&L::shared),
                      field("speed_limit", &L::speed_limit, quantity_of<Params>("speed_limit"),
                            "largest speed of the axis; left out: none")};
  }
};

struct LearningLaw {
  using Params = control::LearningParams;
  static constexpr std::string_view kKind = Params::kKind;

  Shared<Params> shared;
  std::optional<double> lap;

  static constexpr auto fields() {
    using L = LearningLaw;
    return std::tuple{
        embedded(&L::shared),
        field("lap", &L::lap, pure_number().positive(),
              "range of the phase after which the path repeats; must be set, the same on all axes")};
  }
};

using LawSettings = std::variant<ContouringLaw, SlidingModeLaw, PredictiveLaw, LearningLaw>;

/// The laws of N axes, in the same order.
template <std::size_t N>
using Laws =
    std::tuple<control::Contouring<N>, control::SlidingMode<N>, control::Predictive<N>, control::Learning<N>>;

inline constexpr std::size_t kLaws = std::variant_size_v<LawSettings>;

template <std::size_t N, std::size_t I>
using LawAt = std::tuple_element_t<I, Laws<N>>;

}  // namespace stribeck::capi
