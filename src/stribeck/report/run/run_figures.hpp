#pragma once
/// Drawings of a single run along a path, for its page: the path with the error magnified, and the error along the path.
/// Real time: no.

#include <stribeck/report/run/trace_report.hpp>
#include <stribeck/sim/compare.hpp>
#include <vector>

namespace stribeck::report {

/// Of the first row of a result with one travel.
std::vector<TraceFigure> run_figures(const sim::CompareResult& result);

}  // namespace stribeck::report
