#pragma once
/// Stretches of constant speed in a record (steady_runs.hpp): the speed in blocks, neighbours that differ least joined
/// until those left differ by more than 4 % and by more than their noise.
///
/// Inside ident only. Real time: no.

#include <cstddef>
#include <optional>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/map/steady_runs.hpp>
#include <vector>

namespace stribeck::ident::map {

/// A stretch, nothing left out at its beginning yet.
struct ConstantSpeed {
  SteadyRun run;
  bool from_change = true;              ///< a change of speed precedes
  std::optional<std::size_t> reversal;  ///< row of the reversal before it
};

/// At the scale that shows most: a rippling speed is constant only to longer blocks.
std::vector<ConstantSpeed> find_constant_speeds(const log::Record& rec, std::size_t number);

/// Mean of values [first, end).
double mean_over(const std::vector<double>& values, std::size_t first, std::size_t end);

}  // namespace stribeck::ident::map
