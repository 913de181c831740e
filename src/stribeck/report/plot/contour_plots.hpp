#pragma once
/// Drawings of the contour error for the pages of compare and reproduce: over the path and over time.
///
/// Controllers whose largest errors differ by more than a factor of four are drawn separately: each group has a scale on which its
/// largest error fills the height, and the title of a finer one tells the factor. Within a group, each drawing shows three
/// controllers, all on one scale.
///
/// All drawings show the first trial. On one axis the contour error is the tracking error, and is labelled so.
/// Real time: no.

#include <stribeck/report/plot/plot.hpp>
#include <stribeck/sim/compare.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

using Rows = std::vector<const sim::CompareRow*>;

/// "(f)"
std::string name_of(const sim::CompareRow& row);
/// "(f) observer + Gaussian model"
std::string full_name(const sim::CompareRow& row);
/// "(a) to (c)" where they follow each other in `all`, else "(a) and (d)".
std::string names_of(const Rows& some, const Rows& all);

/// Rows of one travel, in order.
Rows rows_of(const sim::CompareResult& result, std::size_t travel);

/// "contour error"; "tracking error" on one axis.
std::string error_name(const sim::CompareResult& result);

/// Colour of a controller among the rows of its travel.
std::string color_of(const sim::CompareRow& row, const Rows& all);

/// Controllers that share a scale.
struct ScaleGroup {
  Rows rows;             ///< in the order of the travel
  double largest = 0.0;  ///< largest |ε| of the scored part [m]
};

/// The coarsest first. A group ends where the next controller's largest error is below a quarter of the group's.
std::vector<ScaleGroup> scale_groups(const Rows& rows);

/// For figures without groups: all but the first group, all but the first two, and so on.
std::vector<Rows> finer_rows(const Rows& rows);

/// Drawings, and a sentence on their scales for the caption; it may be empty.
struct ScaledPlots {
  std::vector<Plot> plots;
  std::string scales;

  [[nodiscard]] std::string caption(const std::string& text) const {
    return scales.empty() ? text : text + " " + scales;
  }
};

/// The scales of groups as a sentence; limits [µm] of the drawings, one for each group. Empty for a single drawing.
std::string scales_in_words(const std::vector<ScaleGroup>& groups, const Rows& all,
                            const std::vector<double>& limits, bool signed_error, std::size_t drawings);
/// ", scale 25 times finer", or empty for the first group.
std::string finer(const std::vector<double>& limits, std::size_t group);

/// The last scored lap over the parameter of the path, from a twelfth of a lap before zero, so that no reversal of a circle lies at
/// the border.
struct Lap {
  std::vector<const sim::ContourSample*> samples;  ///< null: a gap in the samples
  std::vector<double> angle;                       ///< [°], ascending; NaN with a null sample
};
Lap last_lap(const std::vector<sim::ContourSample>& trace, const sim::Travel& travel);

/// Whether a sum of harmonics is a circle whose parameter is the angle.
bool is_circle(const path::Fourier<2>& path);

/// Parameter of one lap, and where the drawings begin [rad].
double lap_of(const sim::Travel& travel);
double first_angle(const sim::Travel& travel);
/// Factor from the parameter to the axis of a drawing: degrees, or millimetres along a part.
double shown_scale(const sim::Travel& travel);
std::string angle_label(const sim::Travel& travel);

struct TraceLook {
  int width = 920;  ///< [px]
  int height = 310;
  double detail = 1.0;      ///< of plot.hpp
  bool full_names = true;   ///< in the legend
  bool scored_only = true;  ///< over time: leaves out run-in and run-out
};

/// Contour error over the last scored lap; reversals of the axes are marked.
ScaledPlots path_plots(const sim::CompareResult& result, std::size_t travel, const TraceLook& look);
ScaledPlots time_plots(const sim::CompareResult& result, std::size_t travel, const TraceLook& look);

}  // namespace stribeck::report
