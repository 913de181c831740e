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

/// A model without pre-sliding beside the force of a record, both at every `row`.
struct SettlingRows {
  std::span<const double> x;         ///< of every row of the record [m]
  std::span<const std::size_t> row;  ///< of the record
  std::span<const double> measured;  ///< [N]
  std::span<const double> modelled;  ///< [N]
  std::span<const double> friction;  ///< of the model [N]
};

/// The rows of `moving` at which friction has built up after the last reversal: the distance in which it does so is the one that brings the
/// force of the model nearest to the measured one. All of them where no such distance explains much, or where few would be left.
std::vector<std::size_t> settled_rows(const SettlingRows& rows, std::vector<std::size_t> moving);

}  // namespace stribeck::ident::replay
