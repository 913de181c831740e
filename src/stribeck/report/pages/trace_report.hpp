#pragma once
/// The page of a single recording or run: a summary in words, and its columns over time.
/// Real time: no.
/// Errors: io::InputError of files and of gnuplot.

#include <string>
#include <vector>

namespace stribeck::report {

struct TraceColumn {
  std::string name;
  std::string unit;
  std::vector<double> values;
  std::string quantity = {};  ///< "position"; empty: unknown
};

struct TraceReportInput {
  std::string title;
  std::string summary;  ///< in words
  std::string command;  ///< reproduces the page
  std::string version;
  std::vector<double> time;          ///< [s]
  std::vector<TraceColumn> columns;  ///< columns of one quantity and unit share a drawing
};

std::string trace_report(const TraceReportInput& input);

/// Writes directory/index.html; makes the directory.
void write_trace_report(const std::string& directory, const TraceReportInput& input);

}  // namespace stribeck::report
