#pragma once
/// The rows of a record in which an axis moves. At rest its force lies anywhere within its friction, so that no model is judged there.
///
/// An axis is at rest where
///   - it is slower than a hundredth of its top speed; down to a thousandth it moves where the encoder shows it;
///   - it quivers: within a quarter of a second its speed stays below a twentieth of its top speed, and swings by a third as much as it is
///     in the mean. Wind, a loop that hunts, and noise do this;
///   - its reference stands still for as long.
///
/// Not modelled: stick-slip. Such an axis moves, but may be counted as standing. Inside ident only. Real time: no.

#include <cstddef>
#include <span>
#include <stribeck/ident/log/record.hpp>
#include <vector>

namespace stribeck::ident::replay {

/// Every `period` seconds one row of a record, and the velocity there.
struct RestRows {
  const log::Record& record;
  std::span<const std::size_t> row;  ///< of the record
  std::span<const double> velocity;  ///< [m/s], after the low-pass
  double noise = 0.0;                ///< deviation of it by the encoder [m/s]
  double period = 0.0;               ///< between these rows [s]
};

/// Indices of `used` at which the axis moves.
std::vector<std::size_t> moving_rows(const RestRows& rows, std::span<const std::size_t> used);

}  // namespace stribeck::ident::replay
