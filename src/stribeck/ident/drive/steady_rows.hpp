#pragma once
/// Rows of motion whose speed stays the same over the travel in which friction settles, however slow it is.
///
/// The travel between two reversals is cut into pieces as long as `exclude`. A piece is steady when the speed of none of its rows
/// differs from its mean by more than half. Steady pieces in a row whose means differ by at most 30 % are a run; the rows of a run
/// are steady when it has four pieces and is at least a quarter of the travel between the two reversals. So a jog at one speed
/// counts. An axis that sticks and slips does not, because it stops or nearly stops in between.
///
/// Inside ident only. Real time: no.
/// Not modelled: stick-slip so fast that the window of the motion (motion.hpp) hides it.

#include <cstdint>
#include <span>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/log/record.hpp>
#include <vector>

namespace stribeck::ident::drive {

/// One for each row: 1 where it is steady. `exclude` [m], above 0; at least 20 times the noise of the position is used.
std::vector<std::uint8_t> steady_rows(const log::Motion& m, double exclude);

/// Whether a reference asks for constant speeds below `speed` [m/s] for a second and more, in a direction (+1 or -1).
bool asked_slower(std::span<const log::Record> records, double direction, double speed);

}  // namespace stribeck::ident::drive
