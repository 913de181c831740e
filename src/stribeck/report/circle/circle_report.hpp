#pragma once
/// Circles that were travelled under several controls, side by side: table, JSON, page.
///
///   json   {"schema": "stribeck.evaluate/1", "radius_mm", "logs": [{"label", "file", "beside": {head: value}, "circles":
///           [{"rows": the --where that chose them or null, "direction": "counter-clockwise" or "clockwise", "revolutions",
///           "max_contour_error_um", "quadrant_glitch_um", "rms_um", "circular_deviation_um"}], "notes", "circular_test": {"directions",
///           "mean_radial_deviation_um", "bidirectional_circular_deviation_um", "hysteresis_um", …}, "diagnosis": null or {"causes", "peaks",
///           "remarks", …}}], "diagnosis": the same of all logs with --together, else null}
///
/// "changes" compares every log with the first, "limits" every log with the limits; see circle_change.hpp.
///
/// Real time: no. Errors: io::InputError of files and of gnuplot.

#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stribeck/ident/circle/causes.hpp>
#include <stribeck/ident/circle/circularity.hpp>
#include <stribeck/ident/circle/radial_error.hpp>
#include <stribeck/report/page/output.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

struct CircleLog {
  std::string label;
  std::string file;
  ident::circle::AxisNames axes{"x", "y"};
  std::vector<ident::circle::CircleTest> circles;        ///< the same number for every log
  std::optional<ident::circle::CircularTest> test = {};  ///< of all of them; absent: at different places
  std::optional<ident::circle::Diagnosis> diagnosis =
      {};  ///< absent: not enough rows, or of all logs together
  double feed =
      std::numeric_limits<double>::quiet_NaN();  ///< mean over its circles [m/s]; NaN: the log has no times
  std::vector<std::string> beside = {};          ///< entries of further columns of its row
  std::vector<std::string> notes = {};
};

/// Largest allowed value of a figure of circle_change.hpp.
struct CircleLimit {
  std::string figure;
  double most = 0.0;  ///< [m]
};

struct CircleReportInput {
  std::string title;
  double radius = 0.0;                   ///< [m]
  std::vector<std::string> rows = {};    ///< of each circle: COLUMN=VALUE; "": all rows
  std::vector<std::string> beside = {};  ///< heads, with their unit in brackets
  std::vector<CircleLog> logs = {};
  std::optional<ident::circle::Diagnosis> together = {};  ///< of all logs, as measurements of one machine
  std::vector<std::string> warnings = {};
  std::string command = {};
  std::string version = {};
  std::vector<InputFile> inputs = {};  ///< that the result came from
  std::vector<CircleLimit> limits = {};
};

std::string text_table(const CircleReportInput& input);
nlohmann::ordered_json to_json(const CircleReportInput& input);
std::string circle_report(const CircleReportInput& input);
/// Writes index.html, and the parts of the page where a folder for them is given.
void write_circle_report(const PageFolders& folders, const CircleReportInput& input);

}  // namespace stribeck::report
