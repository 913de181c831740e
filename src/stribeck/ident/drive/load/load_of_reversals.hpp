#pragma once
/// The load that the reversals of a log tell, where friction differs by direction.
///
/// While an axis slides, a load c cannot be told from friction that differs between the directions:
///
///   f = c + F⁺  forward,   f = c − F⁻  backward        c + b, F⁺ − b, F⁻ + b: the same forces
///
/// After a reversal it can. A bristle of stiffness σ0 needs the distance F⁺/σ0 forward and F⁻/σ0 backward, so that both distances
/// are in proportion only for one c. The bristle is fitted again and again, each time with the load that the fit before asks
/// for, until it asks for no more. F⁺ and F⁻ are those of the map at rest: their intervals are part of that of the load.
///
/// Sign: positive c pushes against forward motion, as in AxisModel. Assumed: pre-sliding is as stiff forward as backward. Source: LuGre,
/// bristle_fit.hpp. Not believed where friction would differ by more than two to one, or where one bristle does not describe the
/// reversals. Not modelled: friction that differs by direction together with a stiffness that does.
/// Inside ident only. Real time: no.

#include <optional>
#include <stribeck/ident/drive/describe.hpp>

namespace stribeck::ident::drive {

/// Absent where the map is not one by direction, the directions hardly differ, the reversals do not tell, or the load is as it is taken.
std::optional<ToldLoad> load_of_reversals(const Result& result, const Found& found);

/// The map with another load and the same forces.
MapChoice with_load(MapChoice choice, double load);

}  // namespace stribeck::ident::drive
