#pragma once
/// Lost motion from readings of a dial indicator at the table, written down by hand: positions approached from both sides, with or
/// without a load on the table.
///
///   y = o_p + d·i − (sgn(s)·b/2 + s/k),   s = ς·F + L          ς = ±1 direction of the approach
///
///   y reading [m], o_p offset of the position p, d drift from row i to row, b backlash [m], k stiffness [N/m], F friction of
///   the table, L load against +x [N]
///
/// Without loads only the sum b + 2F/k is known. Loads tell k. Loads larger than F hold the table to one side of the play, whatever the
/// direction: only then backlash and wind-up are told apart. F is scanned; the rest is linear.
/// Intervals: 95 %, from the scatter of the readings, at least that of their steps; for b, k and F together with what F may be.
/// Sign: readings in the direction of the axis; a series over several positions tells it, and is turned if necessary.
/// Source: Stribeck's own; ISO 230-2 approaches positions in the same way. Theory: docs/theory/lost-motion.md.
/// A lost motion that differs along the travel is said in `words` (F test of one for each place, and of a slope, against one for all); the numbers
/// then stand for the mean.
/// Not modelled: creep under load.
/// Real time: no. Errors: none; what cannot be found is absent, and `words` says why.

#include <stribeck/ident/lost_motion/lost_motion.hpp>

namespace stribeck::ident::lost_motion {

struct Reading {
  double position = 0.0;  ///< commanded [m]
  int direction = 1;      ///< of the approach: +1 or -1
  double value = 0.0;     ///< of the indicator [m]
  double load = 0.0;      ///< against +x [N]
};

/// `reversals` counts the readings of the direction that has fewer.
LostMotion identify(const std::vector<Reading>& series);

}  // namespace stribeck::ident::lost_motion
