#pragma once
/// Finds stretches of constant speed in a record (steady_runs.hpp). The speed is averaged over blocks; the neighbours that differ
/// least are joined until those left differ by more than 4 % and by more than their noise.
///
/// Inside ident only. Real time: no.

#include <cstddef>
#include <optional>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/map/steady_runs.hpp>
#include <vector>

namespace stribeck::ident::map {

/// A stretch, before its beginning is left out.
struct ConstantSpeed {
  SteadyRun run;
  bool from_change = true;              ///< a change of speed precedes
  std::optional<std::size_t> reversal;  ///< row of the reversal before it
};

/// Tries several lengths of blocks and takes the one that finds most: a rippling speed is constant only over longer blocks.
std::vector<ConstantSpeed> find_constant_speeds(const log::Record& rec, std::size_t number);

/// Mean of values [first, end).
double mean_over(const std::vector<double>& values, std::size_t first, std::size_t end);

}  // namespace stribeck::ident::map
