#pragma once
/// Mechanics for the friction law, drive, axial mode and lost motion in the parameters; the choice is made once.
///
/// A variant of laws gives six kinds of mechanics for each law with pre-sliding; a new law needs no line here.
/// Real time: no (make_mechanics may throw; the mechanics themselves are safe).
/// Errors: std::invalid_argument for a law without pre-sliding, whose step of friction at rest cannot be integrated;
/// AxisParams::validate() refuses such a law earlier.

#include <stdexcept>
#include <stribeck/plant/mechanics.hpp>
#include <tuple>
#include <variant>

namespace stribeck::plant {

/// The six kinds of mechanics for one law; none for a law without pre-sliding.
template <class Map, class Law>
struct MechanicsOver {
  using Type = std::tuple<>;
};
template <class Map, friction::PreSlidingLaw Law>
struct MechanicsOver<Map, Law> {
  using Type = std::tuple<Mechanics<Map, Law, false, false>, Mechanics<Map, Law, false, true>,
                          Mechanics<Map, Law, true, false>, Mechanics<Map, Law, true, true>,
                          Mechanics<Map, Law, false, true, true>, Mechanics<Map, Law, true, true, true>>;
};

template <class Kinds>
struct OneOf;
template <class... Kind>
struct OneOf<std::tuple<Kind...>> {
  using Type = std::variant<Kind...>;
};

template <class Map, class Laws>
struct AnyMechanicsOver;
template <class Map, class... Law>
struct AnyMechanicsOver<Map, std::variant<Law...>> {
  using Type = typename OneOf<decltype(std::tuple_cat(
      std::declval<typename MechanicsOver<Map, Law>::Type>()...))>::Type;
};
template <class Map, class Laws = friction::DynamicsVariant>
using AnyMechanics = typename AnyMechanicsOver<Map, Laws>::Type;

/// p without its friction, which is passed separately as map and law.
template <class Map, class Laws>
AnyMechanics<Map, Laws> make_mechanics(const AxisParams& p, const Map& map, const Laws& laws) {
  using Any = AnyMechanics<Map, Laws>;
  return std::visit(
      [&]<class Law>(const Law& law) -> Any {
        if constexpr (friction::PreSlidingLaw<Law>) {
          const bool voltage = std::holds_alternative<VoltageDrive>(p.drive);
          if (p.lost_motion) {
            if (voltage) return Mechanics<Map, Law, true, true, true>(p, map, law);
            return Mechanics<Map, Law, false, true, true>(p, map, law);
          }
          if (p.axial_mode) {
            if (voltage) return Mechanics<Map, Law, true, true>(p, map, law);
            return Mechanics<Map, Law, false, true>(p, map, law);
          }
          if (voltage) return Mechanics<Map, Law, true, false>(p, map, law);
          return Mechanics<Map, Law, false, false>(p, map, law);
        } else {
          throw std::invalid_argument(
              "friction without pre-sliding cannot be integrated: a virtual axis needs dynamics");
        }
      },
      laws);
}

}  // namespace stribeck::plant
