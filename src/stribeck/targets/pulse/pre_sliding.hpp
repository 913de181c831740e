#pragma once
/// How the friction of a table comes back after a reversal, from the bristles of an axis file, for code that runs in a control. State and
/// code are a few lines in any language: the targets write them out.
///
///   friction = h·F(v)                                              F > 0 table at the commanded speed [N], h in −1 … 1
///   at a reversal      h ← h·F_before/F                             the force stays, where the directions differ
///   elastic stops      h = Σ h_i,  h_i ← h_i + 2·α_i·Δr/(ρ_i·F), at most α_i forward, at least −α_i backward
///   one bristle        h ← s + (h − s)·exp(−|Δr|/(δ·F))            s = sgn Δr
///
///   Δr travel of the command in one period [m]; α_i weight and ρ_i reach of a stop, δ distance [m/N]: friction/dynamics.hpp
///
/// The level of the bristles is the whole friction of the table. A change of the position against the velocity, where the position wraps or is
/// set anew, and in the period of a reversal, counts as no travel.
/// Not modelled: damping of the bristles; attraction of slipping stops.
/// Real time: safe.

#include <algorithm>
#include <array>
#include <cmath>
#include <stribeck/friction/dynamics.hpp>

namespace stribeck::targets {

/// h along a commanded motion; 0 at its beginning.
class PreSliding {
 public:
  /// After a travel [m] at a friction [N] that is above zero; `direction` of the last motion, ±1.
  double step(const friction::BuildUp& law, double travel, double friction, double direction) noexcept {
    if (friction > 0.0) {
      if (direction == -direction_)
        for (double& h : h_) h *= friction_ / friction;
      direction_ = direction;
      friction_ = friction;
    }
    if (travel != 0.0 && friction > 0.0) {
      for (std::size_t i = 0; i < law.stops.size(); ++i) {
        const friction::Stop& stop = law.stops[i];
        const double moved = h_[i] + 2.0 * stop.weight * travel / (stop.reach * friction);
        h_[i] = travel > 0.0 ? std::min(moved, stop.weight) : std::max(moved, -stop.weight);
      }
      if (law.stops.empty()) {
        const double side = travel > 0.0 ? 1.0 : -1.0;
        h_[0] = side + (h_[0] - side) * std::exp(-std::abs(travel) / (law.distance * friction));
      }
    }
    double all = 0.0;
    for (const double h : h_) all += h;
    return all;
  }

 private:
  std::array<double, friction::kMostStops> h_{};
  double direction_ = 0.0;
  double friction_ = 0.0;  ///< of the last period [N]
};

}  // namespace stribeck::targets
