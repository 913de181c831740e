#pragma once
/// What a fit leaves open of its model, as independent deviations (friction/uncertainty.hpp).
///
///   C = D·R·D      of y = (mass, friction of the curve): R correlations, of the form of covariance with the largest errors together with
///                  what is known of bias (intervals.hpp); D the standard errors that are printed, which hold more than the forms do,
///                  without that of a load, which only tells it from friction
///   C' = T·C·Tᵀ    T: level, viscous coefficient and rise of each direction by least squares over the curve and the friction at rest,
///                  weights 1/D; the rise fades as D does towards higher speeds
///
/// The figures of a direction are scaled so that its curve is as far off as D, in the mean over its speeds. The deviations are the
/// principal axes of C', each variable by its standard error. Stiffness and damping of pre-sliding are axes of their own, as wide as the
/// intervals of their logarithms, at most a factor of two for one standard deviation; a damping of zero has none.
///
/// Inside ident only. Real time: no.

#include <optional>
#include <stribeck/friction/uncertainty.hpp>
#include <stribeck/ident/drive/describe.hpp>

namespace stribeck::ident::drive {

/// `result` with its curve and pre-sliding; absent where it has no steady map in newtons and metres.
std::optional<friction::ModelUncertainty> open_model(const Found& found, const Result& result);

}  // namespace stribeck::ident::drive
