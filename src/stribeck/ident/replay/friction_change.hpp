#pragma once
/// By how much friction of a record differs from that of a model, at the slow and at the fast end of its motion, and in each direction:
///
///   f − f̂ = c·sgn v + b·v + δm·a + δl        least squares over the rows in which the axis moves
///   share(v) = (c + b·|v|)/F(v)              F: friction of the model there, against the motion
///   share forward  = (c + b·|v| + δl)/F      at the mean speed of the rows of that direction
///   share backward = (c + b·|v| − δl)/F
///
/// A load or an offset δl moves both directions by the same force: one friction looks as much larger as the other one looks smaller. A
/// compensation has it as an error all the same. A twentieth of the model's load does not count: a counterbalance
/// varies by that.
///
/// An error of the shift of the force is not in it: on one sine it is proportional to the speed, so f must be aligned well.
/// A motion of much acceleration hides this from the error of the force, though a compensation of friction lives on it.
/// Not modelled: what tells a load from friction that differs between the directions. Real time: no.

#include <cstddef>
#include <span>
#include <stribeck/core/numbers.hpp>
#include <vector>

namespace stribeck::ident::replay {

/// At one speed.
struct FrictionChange {
  double share =
      kNaN;  ///< [1]: 0.4, friction of the record is 40 % more than that of the model; NaN: not told
  double half_width = kNaN;  ///< of 95 %
  double speed = kNaN;       ///< [m/s]
  double varies = 0.0;       ///< share by which it may differ with a load that varies

  /// What is left of the share beyond its interval and what varies, without its sign; 0: none, or not told.
  [[nodiscard]] double certain() const noexcept;
};

struct FrictionChanges {
  FrictionChange slow;               ///< mean of the slowest fifth of the rows
  FrictionChange fast;               ///< mean of the fastest fifth of the rows
  FrictionChange forward, backward;  ///< mean of the rows of a direction; not told where one of both has few
  double load = kNaN;                ///< δl [N], positive against +x; NaN: not told
  double load_half_width = kNaN;     ///< of 95 % [N]
};

/// One value for each decimated row.
struct ForceRows {
  std::span<const double> measured, modelled;  ///< [N]
  std::span<const double> friction;      ///< of the model [N], without periodic terms, springs and weights
  std::span<const double> velocity;      ///< [m/s]
  std::span<const double> acceleration;  ///< [m/s²]
  double load = 0.0;                     ///< of the model [N]
};

/// `rows`: those that count.
FrictionChanges friction_changes(const ForceRows& of, const std::vector<std::size_t>& rows);

}  // namespace stribeck::ident::replay
