#pragma once
/// Friction that differs along the travel: a share of the level at places, from the rows of sliding motion.
///
///   residual_i = s(x_i)·level(|v_i|)·sgn v_i + e_i       s: linear between places, their number and distance from the travel
///
/// Only deviations from the mean of each bin of speed are used, as for the other linear terms: what all rows of one speed share belongs
/// to the map. On a sine, where a speed occurs at two places, that leaves too little, and nothing is found. Each record may have a level of
/// its own that drifts, because a machine that warms up must not look like a place. Where the data say nothing, s is small and smooth
/// (ridge). Places are taken where they predict the blocks of motion that were left out.
///
/// Source: ridge as a prior of s and of its second difference: Hastie, Tibshirani, Friedman, The Elements of Statistical Learning, 5.5.
/// Not modelled: a share that depends on direction or speed; a force along the travel that does not reverse.
/// Inside ident only. Real time: no.

#include <stribeck/friction/places.hpp>
#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/drive/relaxation.hpp>
#include <stribeck/ident/result.hpp>
#include <vector>

namespace stribeck::ident::drive {

struct PlaceShares {
  friction::Places places;   ///< empty: none was found
  std::vector<double> half;  ///< 95 % half width of each level
  double before = 0.0;       ///< residual of the motion left out, without places [N]
  double after = 0.0;        ///< and with them [N]
};

/// What the rows hold beside the linear terms.
struct PlaceRows {
  const AlignedLog& log;
  const Rows& rows;
  const Level& level;
  const std::vector<double>& residual;  ///< of each row, with the map and the linear terms taken out [N]
};

PlaceShares find_places(const PlaceRows& data);

/// Adds to rows.lag what the places add to friction.
void lay_places(const AlignedLog& log, Rows& rows, const Level& level, const friction::Places& places);

/// The shares of both; the places of the first, or of the second where the first has none.
friction::Places together(const friction::Places& a, const friction::Places& b);

}  // namespace stribeck::ident::drive
