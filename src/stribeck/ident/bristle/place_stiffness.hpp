#pragma once
/// Stiffness of the bristles at the places of a model (friction/places.hpp), from the reversals near them.
///
///   f̄_k − m·D²x[k] − load = ∫ F(t; ρ(x))·w dt/T + e_k       paths, window and mean as in bristle_fit.hpp
///
/// ρ is linear between the places. Fitted with it are a factor on the level of each direction, the load and the viscous coefficient. Where
/// no reversal is near, ρ is smooth and close to one. It is taken where it predicts the reversals that were left out.
///
/// Not modelled: damping that differs from place to place.
/// Real time: no.
/// Errors: as fit_bristle().

#include <stribeck/friction/axis_model.hpp>
#include <stribeck/ident/log/record.hpp>
#include <vector>

namespace stribeck::ident::bristle {

struct PlaceStiffness {
  std::vector<double>
      share;                 ///< at each place of the model; empty: the reversals do not tell that it differs
  std::vector<double> half;  ///< 95 % half width of the logarithm
};

/// `known` has places and a law with pre-sliding; `shift` of the force as in MotionOptions [rows].
PlaceStiffness fit_place_stiffness(const std::vector<log::Record>& records, const friction::AxisModel& known,
                                   double break_away, double shift);

}  // namespace stribeck::ident::bristle
