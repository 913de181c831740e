#pragma once
/// The term of an eccentric screw, laid over any steady map.
///
///   additive       F = F_base + η2·sin(2π·x/period − η3)         as printed: keeps its sign with direction
///   proportional   F = F_base + η2·sin(2π·x/period − η3)·sgn v   a normal force that varies over a turn
///
///   η2 amplitude [N], period [m] (usually the lead), η3 phase [rad]
///
/// Both forms occur; the data choose. The phase belongs to the homing position of the log it came from.
///
/// Source: thesis (2.35)–(2.37).
/// Not modelled: growth of the amplitude with load or speed.
/// Real time: safe; one sin.

#include <array>
#include <stribeck/core/fields.hpp>
#include <stribeck/friction/steady.hpp>
#include <utility>

namespace stribeck::friction {

enum class EccentricForm { kAdditive, kProportional };

template <Real T>
struct Eccentric {
  T amplitude{0.0};
  T period{1.0};
  T phase{0.0};
  EccentricForm form = EccentricForm::kAdditive;

  static constexpr auto fields() {
    return std::tuple{
        field("amplitude", &Eccentric::amplitude, quantity("N", "N").not_negative(), "amplitude η2"),
        field("period", &Eccentric::period, quantity("m", "mm").positive(),
              "period in position, usually the lead"),
        field("phase", &Eccentric::phase, quantity("rad", "rad"), "phase η3 from the homing position"),
        field("form", &Eccentric::form, "additive (as printed) or proportional to sgn v").or_default()};
  }

  /// Lays the term over the parts of a base map at position x.
  void add_to(SteadyParts<T>& p, const T& x) const noexcept {
    const T s = amplitude * sin(T(2.0 * kPi) * x / period - phase);
    if (form == EccentricForm::kAdditive) {
      p.additive = p.additive + s;
    } else {
      p.level = p.level + s;
    }
  }
};

}  // namespace stribeck::friction

template <>
struct stribeck::EnumNames<stribeck::friction::EccentricForm> {
  static constexpr std::array names{
      std::pair{stribeck::friction::EccentricForm::kAdditive, std::string_view{"additive"}},
      std::pair{stribeck::friction::EccentricForm::kProportional, std::string_view{"proportional"}}};
};
