#pragma once
/// Where a page and its parts are written, and what made them.
///
///   write_page(page, {"report", "plots"})   report/index.html, and in plots/ every figure and table of the page as files:
///                                           figure-01-TITLE.svg, .pdf, .png and .csv (its data), table-01-CAPTION.md, .csv and .tex
///
/// Real time: no. Errors: io::InputError of files and of gnuplot.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/report/html.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::report {

/// Folders of a verb's outputs; an empty one is not written.
struct PageFolders {
  std::string page;
  std::string plots;

  PageFolders(std::string page_folder, std::string plots_folder = {})
      : page(std::move(page_folder)), plots(std::move(plots_folder)) {}
  [[nodiscard]] bool any() const { return !page.empty() || !plots.empty(); }
};

/// Makes the folders.
void write_page(const Page& page, const PageFolders& folders);

/// {"command", "version", "inputs": [{"file", "sha256"}]}
nlohmann::ordered_json to_json(const Made& made);

/// The data of a drawing, a row for each point: curve, x, y, and the ends of bands and whiskers. Where errors are drawn magnified around
/// a circle, x and y are those of the drawing, and angle and radial error follow.
std::string data_csv(const Plot& plot);

/// A table for other documents; spreads and notes stand in the cell.
std::string markdown(const Table& table);
std::string csv(const Table& table);
std::string latex(const Table& table);

}  // namespace stribeck::report
