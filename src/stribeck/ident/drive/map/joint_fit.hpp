#pragma once
/// A steady map fitted together with the linear terms (mass, periodic terms, shift), on the sums of the bins.
///
/// The width of a Stribeck part is scanned, because with it given everything else is linear; Gauss–Newton from the best width
/// then ends the fit, where it makes the residual smaller. Gauss–Newton from the start alone competes: a width outside the scan may
/// be the right one.
///
/// Inside ident only. Real time: no.

#include <cstddef>
#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/map/static_fit.hpp>

namespace stribeck::ident::drive {

/// A steady map with the linear terms that belong to it.
struct JointFit {
  map::StaticFit map;
  VectorXd linear;
  bool good = false;
};
/// Fit on the sums of all blocks but `without`; of all blocks where there is no block of that number.
JointFit fit_jointly(const map::StaticFit& start, const LinearFit& fit, std::size_t without);
/// Σ residual² of one block [N²].
double loss_of(const JointFit& joint, const Sums& sums, std::size_t block);

}  // namespace stribeck::ident::drive
