#pragma once
/// Model D: conventional friction and terms periodic in position, from motion over many periods or from a
/// record of holding at standstill (cogging).
///
///   f = m·a + η0·sgn v + η1·v + S·exp(−(v/v0)²)·sgn v + load + Σ η2·sin(2πx/λ − η3)·(1 or sgn v) + noise
///
/// m mass [kg], η0 [N], η1 [N·s/m] (one value or one for each direction), S Stribeck rise [N], v0 [m/s],
/// η2 [N], λ [m], η3 [rad]. Rows close to reversals, where friction is still in pre-sliding, are left out. The
/// periods are found in the residual (periodic.hpp), then everything is fitted together. All columns
/// pass the window of motion.hpp and pair f[k−1], f[k] with x[k], so that a phase has no half-sample error.
/// The measured acceleration is replaced by its projection on an instrument (two-stage least squares).
/// Which parts are needed is decided on held-out passes: the simplest within one standard error of the best.
///
/// At standstill the force that holds each position is searched alone: a rotary axis for whole parts of a turn.
/// A difference of Coulomb friction between the directions cannot be told from the load; half the sum of both
/// directions is the load.
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
  std::optional<bool> holding;  ///< record of holding at standstill; absent: seen from the data
  std::optional<double>
      turn;  ///< known period of a turn [m]; absent: 2π for an angle held at standstill, else none
  std::optional<int> most_terms;  ///< periodic terms; absent: four, at standstill ten
  int curve_points = 24;          ///< each direction
};

/// Whether the records show an axis that is held at many places one after the other. Equal steps without any
/// jitter look like a slow jog on a coarse encoder and are not taken for one: say so with `holding`.
bool held_at_standstill(const std::vector<log::Record>& records);

Result identify_position_map(const std::vector<log::Record>& records, const PositionMapOptions& options = {});

}  // namespace stribeck::ident::methods
