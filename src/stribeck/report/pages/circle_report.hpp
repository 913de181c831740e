#pragma once
/// Circles that were travelled under several controls, side by side: table, JSON, page.
///
///   json   {"schema": "stribeck.evaluate/1", "radius_mm", "logs": [{"label", "file", "beside": {head: value}, "circles":
///           [{"rows": the --where that chose them or null, "direction": "counter-clockwise" or "clockwise", "revolutions",
///           "max_contour_error_um", "quadrant_glitch_um", "rms_um", "circular_deviation_um"}]}]}
///
/// Real time: no. Errors: io::InputError of files and of gnuplot.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/sim/radial_error.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

struct CircleLog {
  std::string label;
  std::string file;
  std::vector<sim::CircleTest> circles;  ///< the same number for every log
  std::vector<std::string> beside = {};  ///< entries of further columns of its row
};

struct CircleReportInput {
  std::string title;
  double radius = 0.0;                   ///< [m]
  std::vector<std::string> rows = {};    ///< of each circle: COLUMN=VALUE; empty: all rows
  std::vector<std::string> beside = {};  ///< heads, with their unit in brackets
  std::vector<CircleLog> logs = {};
  std::vector<std::string> warnings = {};
  std::string command = {};
  std::string version = {};
};

std::string text_table(const CircleReportInput& input);
nlohmann::ordered_json to_json(const CircleReportInput& input);
std::string circle_report(const CircleReportInput& input);
/// Writes directory/index.html; makes the directory.
void write_circle_report(const std::string& directory, const CircleReportInput& input);

}  // namespace stribeck::report
