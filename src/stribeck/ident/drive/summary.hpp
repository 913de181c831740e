#pragma once
/// What a person asks of a friction curve, as functions of the map: numbers with their derivatives.
///
///   Coulomb, viscous   intercept and slope of the straight line of the map, where it is one with a Stribeck part or none; else of the
///                      straight line through the curve above a fifth of the top speed
///   static             the curve at rest
///   Stribeck speed     where the rise above that line has fallen to 1/e of what it is at rest
///   friction           at nine speeds from the slowest to the fastest that was measured, closer towards rest
///
/// They mean the same for every family, while η0 or a height of a Gaussian depends on what the other terms take.
///
/// Inside ident only. Real time: no.

#include <array>
#include <cstddef>
#include <optional>
#include <stribeck/ident/map/static_fit.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/ident/shown.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::ident::drive {

/// φ(map) without the load, and ∂φ/∂(parameters of map.span(side)). The derivative by the load stays: what is load and what is friction
/// of one direction cannot be distinguished, and the sum of both is what has to be right.
struct Figure {
  double value = 0.0;
  Eigen::VectorXd slope;
};

struct Summary {
  Figure coulomb;                        ///< [N]
  Figure viscous;                        ///< [N·s/m]
  Figure at_rest;                        ///< [N]
  Figure rise;                           ///< of the friction at rest above the line [N]
  std::optional<Figure> stribeck_speed;  ///< [m/s]; absent where nothing rises towards rest
  bool line_seen =
      true;  ///< false: the speeds end within the Stribeck part, where no line is viscous friction
};

/// Friction against the motion at a speed [N].
Figure friction_at(const map::StaticFit& map, int side, double speed);

Summary summary_of(const map::StaticFit& map, int side, const map::Grid& grid);

/// Nine speeds of the grid [m/s], ascending, of three digits.
std::vector<double> shown_speeds(const map::Grid& grid);

/// `points` speeds from the slowest to the fastest, ever closer towards rest [m/s].
std::vector<double> curve_speeds(const map::Grid& grid, int points);

/// The part of a curve in ascending speed that the data tell, from the first to behind the last of its points: at its ends the half width
/// is at most a fifth of the friction. The whole curve where fewer than ten points are left.
std::pair<std::size_t, std::size_t> told_part(const std::vector<CurvePoint>& points);

/// A sentence where friction rises towards rest by most of itself in one direction and in the other one does not: a force of the
/// process during slow feed looks like that.
std::optional<std::string> one_sided_rise(const map::StaticFit& map,
                                          const std::array<map::Grid, map::kSides>& grid, const Shown& shown);

}  // namespace stribeck::ident::drive
