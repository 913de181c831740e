#pragma once
/// Model D: conventional friction and terms periodic in position, from motion over many periods, or from a
/// record in which the axis is held at standstill (cogging).
///
///   f = m·a + η0·sgn v + η1·v + S·exp(−(v/v0)²)·sgn v + load + Σ η2·sin(2πx/λ − η3)·(1 or sgn v) + noise
///
/// m mass [kg], η0 [N], η1 [N·s/m] (one value or one for each direction), S Stribeck rise [N], v0 [m/s],
/// η2 [N], λ [m], η3 [rad]. Rows close to reversals, where friction is still in pre-sliding, are left out. The periods
/// are found in the residual (periodic.hpp), then everything is fitted together. All columns pass the window of motion.hpp and
/// pair f[k−1], f[k] with x[k], so that a phase has no half-sample error. The measured acceleration is replaced by its projection
/// on an instrument (two-stage least squares). Held-out passes decide which parts are needed: the simplest model within one
/// standard error of the best is taken.
///
/// At standstill only the force that holds each position is searched for periods: for a rotary axis, whole fractions of a turn.
/// A difference of Coulomb friction between the directions cannot be distinguished from the load; half the sum of both
/// directions is taken for the load.
///
/// Intervals: long-run covariance (uncertainty.hpp), periods and v0 included.
///
/// Source: thesis §2.5.3; two stages: Söderström, Stoica 1983, Instrumental Variable Methods.
/// Not modelled: bristles (bristle_fit.hpp), amplitudes that change with load or speed.
/// Real time: no.
/// Errors: Refused.

#include <optional>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/result.hpp>
#include <vector>

namespace stribeck::ident::methods {

struct PositionMapOptions {
  std::optional<double> mass;   ///< known mass [kg]; absent: estimated
  std::optional<bool> holding;  ///< the axis was held at standstill; absent: found from the data
  std::optional<double>
      turn;  ///< known period of one turn [m]; absent: 2π for an angle held at standstill, else none
  std::optional<int> most_terms;  ///< largest number of periodic terms; absent: four, at standstill ten
  int curve_points = 24;          ///< each direction
};

/// Whether the records show an axis that is held at many places one after the other. Equal steps without any jitter look like
/// a slow jog on a coarse encoder and are not recognised: set `holding` for them.
bool held_at_standstill(const std::vector<log::Record>& records);

Result identify_position_map(const std::vector<log::Record>& records, const PositionMapOptions& options = {});

}  // namespace stribeck::ident::methods
