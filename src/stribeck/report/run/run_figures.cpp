#include <stribeck/report/pages/compare_plots.hpp>
#include <stribeck/report/run/run_figures.hpp>
#include <utility>

namespace stribeck::report {

std::vector<TraceFigure> run_figures(const sim::CompareResult& result) {
  std::vector<TraceFigure> figures;
  TravelBlock block;
  block.travel = &result.spec.travels.front();
  block.text = block.travel->pace_in_words();
  block.rows = rows_of(result, 0);
  if (block.rows.empty() || !block.rows.front()->refused.empty()) return figures;
  if (const std::optional<PlanePath> path = plane_path(*block.travel)) {
    for (const ScaleGroup& group : scale_groups(block.rows)) {
      Magnified m = contour_plots(block, group, *path);
      for (Plot& p : m.plots) p.width = 560, p.height = 584;
      figures.push_back({"Contour, error magnified", std::move(m.plots), 1, std::move(m.caption)});
    }
  }
  ScaledPlots along = path_plots(result, 0, {});
  const std::string caption = along.caption(
      "Last scored lap" +
      std::string(result.axes.size() == 2 ? "; positive to the left of the direction of travel" : "") +
      ". Vertical lines: an axis reverses. Good: no peaks behind them.");
  figures.push_back(
      {result.axes.size() == 1 ? "Tracking error along the path" : "Contour error along the path",
       std::move(along.plots), 1, caption});
  return figures;
}

}  // namespace stribeck::report
