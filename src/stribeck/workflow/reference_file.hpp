#pragma once
/// Reads a reference that excite wrote: positions for the closed loop, or forces for the open loop, row by row.
/// Real time: no.
/// Errors: InputError naming the file and the column.

#include <cstddef>
#include <stribeck/sim/machine.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct ReferenceFile {
  std::vector<double> r;      ///< [m]; empty: open loop
  std::vector<double> force;  ///< [N]; for the open loop
};

/// Refuses rows whose period differs from the machine's control period, and places outside the travel of the axis.
ReferenceFile read_reference(const std::string& file, const sim::Machine& machine, std::size_t axis);

}  // namespace stribeck::workflow
