#pragma once
/// Plots as data. gnuplot draws them as SVG that can be part of an HTML page.
///
///   Plot plot{.title = …, .x_label = "velocity [mm/s]", .series = {…}};
///   std::vector<std::string> svg = render({plot, …});      one process draws them all
///
/// Series are thinned to the width of the drawing; the smallest and the largest value of every slice remain.
/// A value that is not finite is a gap. Text is drawn literally. An SVG has its own ids
/// (plot-1-…, counted within a call), a title for screen readers, the width of its place, and no script, link or font file.
/// The same plots give the same bytes.
///
/// Members have empty initialisers so that a caller may name only those it needs.
///
/// Not done: dates, surfaces, two vertical axes.
/// Real time: no.
/// Errors: io::InputError when gnuplot is missing or refuses, with what to install.

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::report {

enum class Style {
  kLines,
  kPoints,
  kBand,   ///< area between y_low and y_high
  kSteps,  ///< value held until the next x
  kBars,   ///< from zero to y; whiskers where y_low and y_high are given
};

/// A line of a drawing's scale, from which no value is read; how it follows a change of the magnification.
enum class ScaleLine {
  kNone,
  kRing,   ///< a certain error: moves as the curves do
  kBar,    ///< a length from its first point on: grows with the magnification
  kFixed,  ///< an axis or a mark: stays
};

struct Series {
  std::string label = {};  ///< in the legend; empty: no entry
  std::vector<double> x = {};
  std::vector<double> y = {};  ///< as long as x; unused by a band
  std::vector<double> y_low = {};
  std::vector<double> y_high = {};
  Style style = Style::kLines;
  std::string color = "#444444";  ///< #rrggbb
  double width = 1.6;             ///< of a line [px]; of a bar [units of x]; of a point, its size
  bool dashed = false;
  ScaleLine scale = ScaleLine::kNone;
};

/// Vertical line at x, its label at the top.
struct Marker {
  double x = 0.0;
  std::string label = {};
};

/// Text at a place of the plane, in the colour of the curve that it explains.
struct Note {
  double x = 0.0;
  double y = 0.0;
  std::string text = {};
  std::string color = "#444444";
};

struct Tic {
  double at = 0.0;
  std::string label = {};
};

struct Range {
  double low = 0.0;
  double high = 1.0;
};

enum class Legend { kNone, kAbove, kTopLeft, kTopRight, kBottomLeft, kBottomRight };

/// The circle around which a drawing shows errors magnified; a page lets its reader change the magnification.
struct Ring {
  double x = 0.0;
  double y = 0.0;
  double radius = 1.0;
  double error_per_unit = 1.0;  ///< error [µm] for one unit of the drawing
};

struct Plot {
  std::string title = {};
  std::string description = {};  ///< for screen readers; empty: described() finds words
  std::string x_label = {};      ///< with its unit
  std::string y_label = {};
  std::optional<Range> x_range = {};  ///< absent: from the data
  std::optional<Range> y_range = {};
  double x_step = std::numeric_limits<double>::quiet_NaN();  ///< between tics; NaN: chosen
  std::vector<Tic> x_tics = {};                              ///< not empty: only these
  bool log_x = false;
  bool log_y = false;
  bool equal_aspect = false;  ///< one unit of x is drawn as long as one of y
  bool axes = true;           ///< false: only the curves
  std::vector<Marker> markers = {};
  std::vector<Note> notes = {};
  Legend legend = Legend::kAbove;
  int width = 920;  ///< [px]
  int height = 320;
  double detail = 1.0;  ///< slices of a line per pixel; fewer make a smaller page
  std::vector<Series> series = {};
  std::optional<Ring> ring = {};
};

/// What a screen reader says of the drawing: its description, else its title, else its axes and curves.
std::string described(const Plot& plot);

enum class Format { kSvg, kPdf, kPng };

/// One drawing for each plot, in order. An SVG is an element for a page; PDF and PNG are files, the same bytes for the same plot.
std::vector<std::string> render(const std::vector<Plot>& plots, Format format = Format::kSvg);

/// The input of gnuplot; for tests.
std::string gnuplot_script(const std::vector<Plot>& plots, Format format = Format::kSvg);

/// Keeps the smallest and the largest value of each of `columns` slices of x, in order, and the ends of a stretch. A
/// point that is not finite ends a stretch and is kept. For ascending x; other data are returned unchanged.
void thin(std::vector<double>& x, std::vector<double>& y, int columns);

/// Fixed colour of a controller "a" … "p", distinguishable with colour blindness; other controllers get one by their
/// position.
/// Source: Okabe, Ito 2008, Color Universal Design.
std::string controller_color(std::string_view id, std::size_t position = 0);

}  // namespace stribeck::report
