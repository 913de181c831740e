#pragma once
/// Tables of a comparison, and a comparison with printed figures in words. Internal to report.
/// Real time: no.

#include <optional>
#include <stribeck/report/pages/compare_blocks.hpp>
#include <stribeck/report/table.hpp>

namespace stribeck::report {

/// The comparison of a block with printed figures, in one sentence; empty where nothing was printed.
std::string against_print(const TravelBlock& block);

/// A column of figures of the runs, or of one axis.
struct FigureColumn {
  const sim::Figure* figure;
  std::string head;
  std::size_t axis = 0;

  [[nodiscard]] double of(const sim::Metrics& m) const {
    if (const auto* run = std::get_if<sim::Figure::OfRun>(&figure->member)) return m.**run;
    return (m.*std::get<sim::Figure::OfAxis>(figure->member))[axis];
  }
  [[nodiscard]] std::optional<double> printed(const PrintedRow& row) const {
    const auto* run = std::get_if<sim::Figure::OfRun>(&figure->member);
    return run != nullptr ? row.of(*run) : std::nullopt;
  }
};

/// The main figures.
std::vector<FigureColumn> main_figures(const sim::CompareResult& result);
/// Standard deviations and figures of single axes.
std::vector<FigureColumn> further_figures(const sim::CompareResult& result);

/// One row for each controller.
Table controllers_table(const TravelBlock& block, const std::vector<FigureColumn>& figures);

/// Changes that adaptation found, one row for each controller, travel and axis; no rows without adaptation.
Table drift_table(const sim::CompareResult& result);

}  // namespace stribeck::report
