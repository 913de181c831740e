#pragma once
/// The reference that excite wrote: positions for the closed loop, or forces for the open loop, row by row.
/// Real time: no.
/// Errors: InputError naming the file and the column.

#include <cstddef>
#include <optional>
#include <stribeck/io/log/log.hpp>
#include <stribeck/sim/recording.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct ReferenceFile {
  std::vector<double> r;      ///< [m]; empty: open loop
  std::vector<double> force;  ///< [N]; for the open loop
};

/// Refuses rows whose period differs from the machine's control period, and places outside the travel of the axis.
ReferenceFile reference_of(const io::Log& table, const sim::Machine& machine, std::size_t axis);

/// The axis ran into an end of its travel.
struct EndStop {
  double time = 0.0;      ///< [s]
  double position = 0.0;  ///< the end [m]
  double speed = 0.0;     ///< of the impact [m/s]
};

/// Ends the recording where the axis leaves its travel, if it does.
std::optional<EndStop> cut_at_end_stop(sim::Recording& recording, const sim::AxisLimits& limits);

}  // namespace stribeck::workflow
