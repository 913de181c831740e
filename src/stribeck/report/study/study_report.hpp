#pragma once
/// A study of many machines: tables, JSON, page.
///
/// Values stand in the unit of the figure's key. A lost run counts as infinite: a quantile that is lost is null in the JSON, and
/// "lost" in a table. Runs that could not be simulated are counted apart. With Sobol' indices, means and quantiles are those of the runs of
/// the matrices A and B, which are independent of each other.
/// Real time: no. Errors: io::InputError of files.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <stribeck/report/page/output.hpp>
#include <stribeck/sim/metrics.hpp>
#include <stribeck/sim/uncertainty/design.hpp>
#include <stribeck/sim/uncertainty/sensitivity.hpp>
#include <stribeck/sim/uncertainty/spread.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

struct StudiedFactor {
  std::string key;
  std::string distribution;  ///< in words
};

/// A figure of merit, or that of one axis.
struct StudiedColumn {
  std::string key;     ///< "max_contour_error_um", "mean_abs_tracking_um.x"
  std::string name;    ///< heads a column of a table
  std::string unit;    ///< shown
  double shown = 1.0;  ///< factor from the unit of the key to it
};

struct StudiedFigure {
  double nominal = 0.0;  ///< on the machine as its file says it; NaN: unknown
  sim::Spread spread;
  std::vector<sim::SobolIndex> indices;  ///< one for each factor, or empty
  std::uint64_t index_samples = 0;       ///< samples behind the indices
};

/// One controller on one motion.
struct StudiedRow {
  std::string controller;
  std::string label;
  std::string motion;
  std::uint64_t lost = 0;
  std::uint64_t refused = 0;
  bool nominal_lost = false;
  std::vector<StudiedFigure> figures;  ///< one for each column
};

struct StudyResult {
  std::string machine;
  sim::Sampling sampling = sim::Sampling::kRandom;
  std::uint64_t samples = 0;
  std::uint64_t runs = 0;  ///< machines that were run, each with every controller on every motion
  std::uint64_t seed = 0;
  std::string parameters;  ///< origin of the compensators' parameters
  bool has_band =
      false;  ///< the machines are what the logs of the axes leave open: the figures have a band of 95 %
  std::vector<StudiedFactor> factors;
  std::vector<StudiedColumn> columns;
  std::vector<StudiedRow> rows;  ///< motion by motion
  std::vector<std::string> warnings;
};

/// Probabilities of the quantiles that are reported.
inline constexpr double kStudyQuantiles[] = {0.05, 0.5, 0.95, 0.99};

std::string text_table(const StudyResult& result);

nlohmann::ordered_json to_json(const StudyResult& result);

struct StudyReportInput {
  StudyResult result;
  std::string command;
  std::string version;
  std::vector<InputFile> inputs = {};  ///< study file and machine
};

std::string study_report(const StudyReportInput& input);

/// Writes DIR/index.html.
void write_study_report(const PageFolders& folders, const StudyReportInput& input);

}  // namespace stribeck::report
