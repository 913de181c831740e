#pragma once
/// Tables for a terminal: plain text, at most 100 columns, one block for each speed, printed values beside
/// the result. Real time: no.

#include <span>
#include <stribeck/ident/result.hpp>
#include <stribeck/report/printed.hpp>
#include <stribeck/sim/compare.hpp>
#include <string>
#include <string_view>

namespace stribeck::report {

inline constexpr std::size_t kTableWidth = 100;

std::string text_table(const sim::CompareResult& result, std::span<const PrintedTable> printed = {});

/// Mass, parameters with intervals, models that were tried, warnings.
std::string text_table(const ident::Result& result, std::string_view axis);

}  // namespace stribeck::report
