#pragma once
/// Plots of a comparison. Internal to report.
/// Real time: no.

#include <stribeck/report/pages/compare_blocks.hpp>
#include <stribeck/report/plot/contour_plots.hpp>

namespace stribeck::report {

/// The plane curve of a travel, or null.
const path::Curve* plane_curve(const sim::Travel& travel);

/// Mean speed along the path [m/s].
double speed_of(const sim::Travel& travel);

struct Magnified {
  std::vector<Plot> plots;
  std::string caption;
};

/// The path with magnified errors, for the controllers that share a scale.
Magnified contour_plots(const TravelBlock& block, const ScaleGroup& group, const path::Curve& curve);

/// Errors where an axis, or several together, reverse; for the controllers of each scale.
ScaledPlots reversal_plots(const TravelBlock& block, const sim::CompareResult& result);

/// The controllers whose forces are shown: the two that the summary compares, or the one with the largest model.
Rows force_rows(const TravelBlock& block);
std::vector<Plot> force_plots(const TravelBlock& block, const CompareReportInput& input);

/// Bars of these rows of a block: of all rows or of those with the finer scales.
Plot bar_plot(const TravelBlock& block, const Rows& rows, const std::string& error, std::string_view head,
              sim::Figure::OfRun figure);

}  // namespace stribeck::report
