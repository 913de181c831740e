#pragma once
/// The two concentric circles of least distance that hold all points of a circle between them: circular deviation after ISO 230-4.
///
///   width = min over c of (max |pᵢ − c| − min |pᵢ − c|)
///
/// |pᵢ − c − δ| is taken as |pᵢ − c| − uᵢ·δ, u the direction from c to the point. The width is then convex and piecewise linear in δ,
/// and its smallest value is found exactly: the line search in y is inside that in x, each goes to where its two tangents meet.
/// c is moved by δ until that no longer lowers the true width; δ shrinks quadratically, so that the result is exact to rounding.
///
/// Source: after ISO 230-4 and ISO 12181-1 (minimum zone); cutting planes: Kelley 1960, doi:10.1137/0108053.
/// Valid for circles: points all round whose distances from the first centre differ by less than a fifth.
/// Real time: no. Errors: none; without points the width is 0.

#include <span>

namespace stribeck::ident::circle {

struct Centre {
  double x = 0.0;
  double y = 0.0;
};

struct MinimumZone {
  Centre centre;
  double inner = 0.0;  ///< radius [m]
  double outer = 0.0;
  double width = 0.0;
};

/// `near` is where the search begins: the least-squares centre.
MinimumZone minimum_zone(std::span<const double> x, std::span<const double> y, const Centre& near);

}  // namespace stribeck::ident::circle
