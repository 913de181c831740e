#pragma once
/// Friction that differs from place to place along the travel: a worn or tight stretch, a screw preload or guide that is not even.
///
///   level(v, x) = level(v)·l(x)      stiffness of the bristles(x) = stiffness·k(x)
///
///   l, k shares of the model's values, linear between places, constant before the first and after the last
///
/// Changes are slow against pre-sliding; terms periodic in position are in eccentric.hpp.
/// Not modelled: a viscous part that differs from place to place; shares that depend on the direction.
/// Real time: safe; one pass over at most kMostPlaces numbers.

#include <stribeck/core/fields.hpp>
#include <stribeck/core/fixed_vector.hpp>
#include <stribeck/core/scalar.hpp>

namespace stribeck::friction {

inline constexpr std::size_t kMostPlaces = 13;

struct Place {
  double position = 0.0;   ///< [m]
  double level = 1.0;      ///< l
  double stiffness = 1.0;  ///< k

  static constexpr auto fields() {
    return std::tuple{field("position", &Place::position, quantity("m", "mm"), "position on the axis"),
                      field("level", &Place::level, pure_number().at_least(0.05).at_most(20.0),
                            "level of friction there, as a share of that of the steady map"),
                      field("stiffness", &Place::stiffness, pure_number().at_least(0.05).at_most(20.0),
                            "stiffness of the bristles there, as a share of that of dynamics; left out: 1")
                          .or_default()};
  }
};

using Places = FixedVector<Place, kMostPlaces>;

/// The shares at position x; both 1 where there are no places.
struct Shares {
  double level = 1.0;
  double stiffness = 1.0;
};
[[nodiscard]] constexpr Shares shares_at(const Places& places, double x) noexcept {
  if (places.empty()) return {};
  std::size_t i = 0;
  while (i < places.size() && places[i].position < x) ++i;
  if (i == 0) return {places[0].level, places[0].stiffness};
  const Place& a = places[i - 1];
  if (i == places.size()) return {a.level, a.stiffness};
  const Place& b = places[i];
  const double s = (x - a.position) / (b.position - a.position);
  return {a.level + s * (b.level - a.level), a.stiffness + s * (b.stiffness - a.stiffness)};
}

}  // namespace stribeck::friction
