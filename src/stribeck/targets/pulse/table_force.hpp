#pragma once
/// A table of friction as a control applies it around a reversal; table_law.hpp has the law.
/// Real time: no.

#include <functional>
#include <optional>
#include <stribeck/friction/dynamics.hpp>

namespace stribeck::targets {

struct TableForce {
  std::function<double(double)> force;          ///< [N] at a velocity [m/s]
  double build_up = 0.0;                        ///< distance after a reversal over which the force comes [m]
  double look_ahead = 0.0;                      ///< time before a reversal over which it goes [s]
  std::optional<friction::BuildUp> bristles{};  ///< in place of both: the code of the target has them
};

}  // namespace stribeck::targets
