#pragma once
/// Rows of a comparison by travel, as the parts of its page need them. Internal to report.
/// Real time: no.

#include <stribeck/report/factors.hpp>
#include <stribeck/report/pages/compare_report.hpp>
#include <stribeck/report/pages/verdict.hpp>
#include <stribeck/report/text.hpp>
#include <string>
#include <vector>

namespace stribeck::report {

/// The results of one travel.
struct TravelBlock {
  std::size_t index = 0;  ///< of the travel
  const sim::Travel* travel = nullptr;
  std::string text;  ///< "9.5 mm/s"
  Rows rows;
  const PrintedTable* printed = nullptr;
};

/// Blocks in the order of the result.
std::vector<TravelBlock> blocks_of(const CompareReportInput& input);

}  // namespace stribeck::report
