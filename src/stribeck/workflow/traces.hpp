#pragma once
/// The trace of a run along a path as a log.
/// Real time: no.

#include <stribeck/io/log/log.hpp>
#include <stribeck/sim/contour_run.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// All samples: references, encoders, tables, inputs and forces of the axes, and the contour error.
io::Log as_log(const std::vector<std::string>& axes, const std::vector<sim::ContourSample>& trace);

/// The same for a page, with errors first, because errors cannot be seen in a drawing of positions.
io::Log errors_first(const io::Log& log, const std::vector<std::string>& axes);

}  // namespace stribeck::workflow
