#pragma once
/// Where a plot puts its frame, legend and labels, in pixels; shared by the drawing and by what a page's script is told.
///
/// Inside report only. Real time: no. Errors: none.

#include <stribeck/report/plot/plot.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::report {

inline constexpr double kTitleLine = 21;  ///< height of the line of the title [px]
inline constexpr double kLegendLine = 18;
inline constexpr double kMarkerLine = 14;

struct Frame {
  Range x;
  Range y;
  double left, right, top, bottom;  ///< margins [px]

  [[nodiscard]] double width(const Plot& p) const { return std::max(1.0, p.width - left - right); }
  [[nodiscard]] double height(const Plot& p) const { return std::max(1.0, p.height - top - bottom); }
};

/// The frame with its ranges, from the plot's own or from its data.
Frame frame_of(const Plot& plot);

bool has_legend(const Plot& plot);

/// Place of an entry of the legend above a plot.
struct LegendEntry {
  const Series* series;
  double x;  ///< from the left border of the plot [px]
  int row;
};

/// gnuplot's own legend overestimates widths and then wraps into the plot; here the rows are computed in advance.
std::vector<LegendEntry> legend_entries(const Plot& plot, double width);
/// Top of the legend [px].
double legend_top(const Plot& plot);

/// Line of the label of each marker, 0 the lowest; −1 without a label. A label that would cover the one before it moves up by one
/// line. Uses the frame's x and its left and right margins.
std::vector<int> marker_rows(const Plot& plot, const Frame& frame);

/// Whether a series has a point that can be drawn.
bool drawable(const Series& series);
/// Whether bars have whiskers, which gnuplot draws as a group of its own.
bool has_whiskers(const Series& series);

/// gnuplot's words for the dashes of a curve.
std::string_view dash_of(const Plot& plot, const Series& series);

/// #rrggbb
bool is_color(std::string_view text);

/// What a script needs to read values from the drawing and to change it, as JSON: frame, ranges, labels, and for each series its
/// label, its groups in the drawing and its place in the legend.
std::string plot_facts(const Plot& plot);

}  // namespace stribeck::report
