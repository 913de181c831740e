#pragma once
/// Friction after a reversal: it depends on the distance slid, not on time.
///
///   dF/ds = σ0·(1 − F/g(v)),   relaxation length g/σ0
///
/// σ0 is the value that explains the force around reversals best (logarithmic grid, then golden section), with g from the map
/// without a model. It is used to leave out the rows in which friction has not settled, and to subtract the small lag that
/// remains. bristle_fit.hpp estimates the bristle itself.
///
/// Source: Dahl 1968; thesis §5.2.
/// Not modelled: damping of the bristle.
/// Inside ident only. Real time: no.

#include <limits>
#include <stribeck/ident/map/drive_rows.hpp>
#include <vector>

namespace stribeck::ident::drive {

struct Relaxation {
  double sigma0 = std::numeric_limits<double>::infinity();
  double length = 0.0;  ///< g/σ0 [m]; 0: no reversal found
};

/// Level of friction without a model: the curve of one direction less its viscous part.
struct Level {
  std::array<map::BinCurve, map::kSides> curve;  ///< without the load
  std::array<double, map::kSides> viscous{};     ///< [N·s/m]

  [[nodiscard]] double operator()(int side, double speed) const {
    const auto s = static_cast<std::size_t>(side);
    return std::max(curve[s](speed) - viscous[s] * speed, 0.05 * std::abs(curve[s].force.front()));
  }
};

/// mass, load: current estimates. `near`: distance after a reversal within which rows are used [m].
Relaxation find_relaxation(const std::vector<log::Motion>& motions, const Level& level, double mass,
                           double load, double near);

/// Fills rows.lag.
void find_lag(const std::vector<log::Motion>& motions, const Level& level, const Relaxation& relaxation,
              map::Rows& rows);

}  // namespace stribeck::ident::drive
