#pragma once
/// The experiments of the thesis: printed values beside computed ones.
///
/// A section is one table or figure of the thesis in one setting (machine, parameters, gains). It holds figures, each with the
/// printed value, the computed one and its spread; drawings like the thesis's; and remarks on assumptions and on figures that are
/// not reached. The page, the Markdown table and the JSON are made from the same sections.
///
///   JSON  {"schema": "stribeck.reproduce/1", "seed", "trials", "sections": [{"id", "title", "source", "setting", "machine",
///         "parameters", "figures": [{"what", "of", "against", "unit", "printed", "ours", "spread", "ratio", "source"}],
///         "table": {"columns", "rows"}, "remarks"}]}
///
/// Real time: no.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/page/output.hpp>
#include <stribeck/sim/experiments.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::report {

/// One printed number and the computed one.
struct ReproducedFigure {
  std::string what;      ///< "mean contour error"
  std::string of;        ///< controller, axis or parameter: "(c)", "x"
  std::string against;   ///< another controller, when the number is a change relative to it; else empty
  std::string unit;      ///< "µm", "N", "%"
  double printed = 0.0;  ///< NaN: not printed
  double ours = 0.0;
  double low =
      0.0;  ///< of the computed value: 95 % interval, or mean ± standard deviation over the trials; NaN: none
  double high = 0.0;
  std::string source;  ///< "Table 3.2"
  int digits = 2;

  [[nodiscard]] double ratio() const { return ours / printed; }
};

struct ReproducedSection {
  std::string id;  ///< of the experiment: "smc-free", "ident-A"
  std::string title;
  std::string source;   ///< in the thesis
  std::string setting;  ///< "1 ms, printed parameters"; may be empty
  std::string machine;
  std::string parameters;  ///< where the compensators' parameters come from, in words; may be empty
  std::vector<ReproducedFigure> figures;
  Table table;  ///< all measured values; columns may be empty
  std::vector<std::pair<std::vector<Plot>, std::string>> plots;  ///< drawings side by side, and their caption
  std::vector<std::string> remarks;
};

/// All sections of one setting of an experiment: claims with their ratios, the table of controllers, contour error over time and
/// over the path, maxima and means of the trials as bars.
ReproducedSection reproduced(const sim::Experiment& experiment, const sim::Setting& setting,
                             const sim::CompareResult& result, std::string parameters);

struct ReproductionInput {
  std::vector<ReproducedSection> sections;
  std::uint64_t seed = 1;
  std::uint32_t trials = 10;  ///< 0: none of the sections has trials
  std::string command;
  std::string version;
  std::vector<InputFile> inputs = {};  ///< that the result came from
};

/// Writes index.html, and the parts of the page where a folder for them is given.
void write_reproduction(const PageFolders& folders, const ReproductionInput& input);
std::string reproduction_html(const ReproductionInput& input);
std::string reproduction_markdown(const ReproductionInput& input);
nlohmann::ordered_json reproduction_json(const ReproductionInput& input);
/// One block for each section, at most 100 columns.
std::string reproduction_text(const ReproductionInput& input);

}  // namespace stribeck::report
