#pragma once
/// Whether an axis moves where it is told, from the first hundredths of a millimetre.
///
///   d = mean x over the last rows at the largest command − mean x before the command moved
///
/// d > 0 for a command in the positive direction: the signs of force and encoder agree. |d| must be more than kSteps steps of the encoder,
/// kLeast and five times the scatter of x before. Also an axis that friction holds moves in its bristles, by force/σ0.
///
/// Not modelled: an axis that a spring or a load moves meanwhile; it is held by the loop before.
/// Real time: no. Errors: none.

#include <stribeck/workflow/commissioning/records.hpp>

namespace stribeck::workflow::commissioning {

enum class Sign { kNotSeen, kRight, kWrong };

struct SignTest {
  Sign sign = Sign::kNotSeen;
  double moved = 0.0;     ///< d [m]
  double farthest = 0.0;  ///< largest distance of the encoder from where it was [m]
  double force = 0.0;     ///< largest change of the force [N]
  double needed = 0.0;    ///< |d| from which on it counts [m]
};

/// Of a move in the positive direction, from rest. `resolution`: step of the encoder [m]; 0: the smallest step of the rows.
SignTest judge_sign(const AxisRows& rows, double resolution);

}  // namespace stribeck::workflow::commissioning
