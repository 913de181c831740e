#pragma once
/// How the friction of a table comes back after a reversal, from the bristles of an axis file, for code that runs in a control. State and
/// code are a few lines in any language: the targets write them out.
///
///   elastic stops      F = Σ f_i,  f_i ← f_i + 2·α_i·Δr/ρ_i, at most α_i·F(v) forward, at least −α_i·F(v) backward
///   one bristle        f ← s·F(v) + (f − s·F(v))·exp(−|Δr|/(δ·F(v)))            s = sgn Δr
///
///   F(v) > 0 table at the commanded speed, in the direction of the motion [N]; f force of a stop [N]; Δr travel of the command in one
///   period [m]; α_i weight and ρ_i reach of a stop, δ distance [m/N]: friction/dynamics.hpp
///
/// The state is a force, so that it stays at a reversal where the directions have other friction.
/// The level of the bristles is the whole friction of the table. A change of the position against the velocity, where the position wraps or is
/// set anew, and in the period of a reversal, counts as no travel.
/// Not modelled: damping of the bristles; attraction of slipping stops.
/// Real time: safe.

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/friction/dynamics.hpp>

namespace stribeck::targets {

/// The friction along a commanded motion; 0 at its beginning.
class PreSliding {
 public:
  /// The friction [N] after a travel [m]; `level`: that of the table, above zero [N].
  double step(const friction::BuildUp& law, double travel, double level) noexcept {
    if (travel != 0.0 && level > 0.0) {
      for (std::size_t i = 0; i < law.stops.size(); ++i) {
        const friction::Stop& stop = law.stops[i];
        const double moved = f_[i] + 2.0 * stop.weight * travel / stop.reach;
        f_[i] = travel > 0.0 ? std::min(moved, stop.weight * level) : std::max(moved, -stop.weight * level);
      }
      if (law.stops.empty()) {
        const double sliding = travel > 0.0 ? level : -level;
        f_[0] = sliding + (f_[0] - sliding) * std::exp(-std::abs(travel) / (law.distance * level));
      }
    }
    double all = 0.0;
    for (const double f : f_) all += f;
    return all;
  }

 private:
  std::array<double, friction::kMostStops> f_{};  ///< [N]
};

}  // namespace stribeck::targets
