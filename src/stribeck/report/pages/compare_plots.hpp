#pragma once
/// Plots of a comparison. Internal to report.
/// Real time: no.

#include <array>
#include <functional>
#include <optional>
#include <stribeck/report/pages/compare_blocks.hpp>
#include <stribeck/report/plot/contour_plots.hpp>

namespace stribeck::report {

/// A closed curve in a plane, as the magnified drawing takes it.
struct PlanePath {
  std::function<std::array<Vec2, 2>(double)> at;  ///< place and derivative by φ
  double period = 0.0;                            ///< of φ
  double size = 0.0;                              ///< radius of the circle, or half width [m]
  Vec2 middle{};                                  ///< of the circle [m]
  bool circle = false;
};

/// The plane path of a travel of two axes; absent for other paths.
std::optional<PlanePath> plane_path(const sim::Travel& travel);

/// Mean speed along the path [m/s].
double speed_of(const sim::Travel& travel);

struct Magnified {
  std::vector<Plot> plots;
  std::string caption;
};

/// The path with magnified errors, for the controllers that share a scale.
Magnified contour_plots(const TravelBlock& block, const ScaleGroup& group, const PlanePath& path);

/// Errors where an axis, or several together, reverse; for the controllers of each scale.
ScaledPlots reversal_plots(const TravelBlock& block, const sim::CompareResult& result);

/// The controllers whose forces are shown: the two that the summary compares, or the one with the largest model.
Rows force_rows(const TravelBlock& block);
std::vector<Plot> force_plots(const TravelBlock& block, const CompareReportInput& input);

/// Bars of these rows of a block: of all rows or of those with the finer scales.
Plot bar_plot(const TravelBlock& block, const Rows& rows, const std::string& error, std::string_view head,
              sim::Figure::OfRun figure);

}  // namespace stribeck::report
