#pragma once
/// The page of a single recording or run: a summary in words, and its columns over time.
/// Real time: no.
/// Errors: io::InputError of files and of gnuplot.

#include <stribeck/report/page/output.hpp>
#include <stribeck/report/plot/plot.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

struct TraceColumn {
  std::string name;
  std::string unit;
  std::vector<double> values;
  std::string quantity = {};  ///< "position"; empty: unknown
};

/// Drawings under a heading of their own, above the columns.
struct TraceFigure {
  std::string heading;
  std::vector<Plot> plots;
  int columns = 1;
  std::string caption;
};

struct TraceReportInput {
  std::string title;
  std::string summary;  ///< in words
  std::string command;  ///< reproduces the page
  std::string version;
  std::vector<double> time;            ///< [s]
  std::vector<TraceColumn> columns;    ///< columns of one quantity and unit share a drawing
  std::vector<InputFile> inputs = {};  ///< that the result came from
  std::vector<TraceFigure> figures = {};
  std::vector<std::string> warnings = {};  ///< stand below the summary
};

std::string trace_report(const TraceReportInput& input);

/// Writes index.html, and the parts of the page where a folder for them is given.
void write_trace_report(const PageFolders& folders, const TraceReportInput& input);

}  // namespace stribeck::report
