#pragma once
/// The steady map that is chosen for what the linear terms leave, alone and together with periodic terms.
///
/// On a sine every speed has two positions only: bins of speed would take the even part of a periodic term for
/// friction; a map of few parameters does not. Such maps are therefore fitted together with the linear terms by
/// Gauss–Newton on the sums of the bins, each block left out in turn, and compared with what the bins chose.
///
/// Inside ident only. Real time: no.

#include <cstddef>
#include <optional>
#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/map/static_fit.hpp>

namespace stribeck::ident::drive {

struct MapChoice {
  map::StaticChoice map;
  std::optional<VectorXd> joint;  ///< linear terms of a map that was fitted together with them
};

/// Families fitted to the bins and the choice among them (static_fit.hpp).
MapChoice choose_map(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                     const DriveFitOptions& options);

/// A steady map with the linear terms that belong to it.
struct JointFit {
  map::StaticFit map;
  VectorXd linear;
  bool good = false;
};
/// On the sums of all blocks but `without`; of all where there is no such block.
JointFit fit_jointly(const map::StaticFit& start, const LinearFit& fit, std::size_t without);
/// Σ residual² of one block [N²].
double loss_of(const JointFit& joint, const Sums& sums, std::size_t block);

/// Enters the maps of few parameters, fitted together with the periodic terms, into the choice.
MapChoice with_joint_fits(MapChoice choice, const LinearFit& fit);

}  // namespace stribeck::ident::drive
