#pragma once
/// The board: identification and controllers of anybody on machines drawn by a seed. Tables, JSON, page.
///
/// Percentages and micrometres are those of the keys. A failed or lost case counts as infinite: a quantile that it reaches is null in
/// the JSON and "failed" or "lost" in a table. Confidence, 95 %: by bootstrap over the machines; the 99th percentile has no
/// upper end below 368 machines, because the worst of n lies below it with probability 0.99ⁿ.
/// Real time: no.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/report/page/output.hpp>
#include <stribeck/sim/uncertainty/spread.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

/// Median and 99th percentile over the cases; NaN: not known, infinite: failed or lost.
struct BoardFigure {
  sim::Confident median;
  sim::Confident p99;
  std::vector<double> values{};  ///< case by case
};

/// Who took part.
struct BoardEntrant {
  std::string id;
  std::string label;
  std::string source;  ///< empty: not said
  bool outside = false;
};

/// One identification; cases are the axes of all machines.
struct IdentificationRow {
  BoardEntrant entrant;
  BoardFigure curve_error;     ///< [%]
  BoardFigure mass_error;      ///< [%]
  BoardFigure held_out_error;  ///< [%]
  /// Share of the true values within the stated intervals of 95 %, and half of their width; NaN: no intervals were stated [%].
  sim::Confident covered{};
  double half_width = 0.0;
  double covered_mass = 0.0;
  std::vector<std::string> failures{};  ///< case by case; empty texts: none

  [[nodiscard]] std::size_t failed() const;
};

/// One controller on one motion; cases are the machines.
struct ControlRow {
  BoardEntrant entrant;
  std::string motion;
  BoardFigure max_error;        ///< [µm]
  BoardFigure rms;              ///< [µm]
  BoardFigure input_variation;  ///< [mV]
  std::size_t lost = 0;
  std::vector<std::string> failures{};

  [[nodiscard]] std::size_t failed() const;
};

/// Time of a step, which differs from run to run.
struct BoardCost {
  std::string id;
  double seconds = 0.0;      ///< NaN: not measured
  bool over_a_pipe = false;  ///< with the way to the program and back
};

struct BoardResult {
  std::uint64_t seed = 1;
  std::vector<std::string> machines;
  std::vector<std::string> axes;                  ///< of all machines: "biaxial-table-1 x"
  std::vector<IdentificationRow> identification;  ///< the best median first
  std::vector<ControlRow> control;                ///< motion by motion, the best median first
  std::vector<BoardCost> costs;                   ///< empty: not asked for
  std::vector<std::string> warnings;
};

std::string text_table(const BoardResult& result);

/// Everything but the costs, which stand under "costs" alone.
nlohmann::ordered_json to_json(const BoardResult& result);

struct BoardReportInput {
  BoardResult result;
  std::string command;
  std::string version;
};

std::string board_report(const BoardReportInput& input);
void write_board_report(const PageFolders& folders, const BoardReportInput& input);

}  // namespace stribeck::report
