#pragma once
/// Chooses the steady map for the force less the linear terms, alone and together with periodic terms.
///
/// On a sine every speed occurs at two positions only. Bins of speed would then take the even part of a periodic term for
/// friction; a map of few parameters does not. Such maps are therefore fitted together with the linear terms, by Gauss–Newton on
/// the sums of the bins, each block left out in turn, and compared with the map that the bins alone gave.
///
/// Inside ident only. Real time: no.

#include <optional>
#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/linear_fit.hpp>
#include <stribeck/ident/drive/map/joint_fit.hpp>
#include <stribeck/ident/map/static_fit.hpp>

namespace stribeck::ident::drive {

struct MapChoice {
  map::StaticChoice map;
  std::optional<VectorXd>
      joint;  ///< linear terms of a map that was fitted together with them; absent: fitted to the bins alone
};

/// Families fitted to the bins and the choice among them (static_fit.hpp).
MapChoice choose_map(const AlignedLog& log, const Rows& rows, const Terms& terms, const LinearFit& fit,
                     const DriveFitOptions& options);

/// Adds the maps of few parameters, fitted together with the periodic terms, to the choice.
MapChoice with_joint_fits(MapChoice choice, const LinearFit& fit);
/// The best of them, where the map of the bins leaves the periodic terms open; absent where none is plausible. `choice` comes from
/// with_joint_fits().
std::optional<MapChoice> only_joint_fits(MapChoice choice, const LinearFit& fit);

/// What the models differ in that the data cannot tell apart, which is part of the uncertainty (Buckland et al. 1997): standard
/// deviation of the friction at a speed [N], and of the Stribeck speed of a symmetric map [m/s].
double spread_of_friction(const MapChoice& choice, int side, double speed);
double spread_of_v0(const MapChoice& choice);
/// The same of Coulomb and viscous friction of one direction, where the chosen map is symmetric: a log of few rows in one direction
/// hardly tells that it is. The load counts with Coulomb friction, as the rows tell their sum.
struct LineSpread {
  double coulomb = 0.0;  ///< [N]
  double viscous = 0.0;  ///< [N·s/m]
};
LineSpread spread_of_line(const MapChoice& choice, int side, const map::Grid& grid);
/// The same for the load of a symmetric map [N].
double spread_of_load(const MapChoice& choice, const std::array<map::Grid, map::kSides>& grid);

}  // namespace stribeck::ident::drive
