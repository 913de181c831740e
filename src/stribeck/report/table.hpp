#pragma once
/// Tables for a terminal: plain text, at most 100 columns, one block for each speed, printed values beside
/// the result.
/// Real time: no.

#include <span>
#include <stribeck/ident/result.hpp>
#include <stribeck/report/printed.hpp>
#include <stribeck/sim/compare.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::report {

inline constexpr std::size_t kTableWidth = 100;

/// Facts about the paths, one sentence each, without full stop.
std::vector<std::string> travel_warnings(const sim::CompareSpec& spec);

/// The same, then what controllers reported during the runs (limits, models used outside their range), one sentence for each row.
std::vector<std::string> status_warnings(const sim::CompareResult& result);

struct ModelOfAxis {
  std::string axis;
  const ident::Result* result = nullptr;
};
/// What the identification of the compensators warned of; text that several models share is said once.
std::vector<std::string> identification_warnings(const std::vector<ModelOfAxis>& models);

/// Whether adaptation determines a change with this standard deviation, a share. Above 0.5 the estimate is still its start value.
constexpr bool change_is_known(double deviation) { return deviation <= 0.5; }
/// Changes since identification that on-line adaptation found, one sentence for each row and axis.
std::vector<std::string> drift_words(const sim::CompareResult& result);

/// "23 moves, 314.2 mm in 45.1 s, 3 stops on the way, 12 corners rounded by at most 9.8 um".
std::string in_words(const sim::PartSummary& part);

std::string text_table(const sim::CompareResult& result, std::span<const PrintedTable> printed = {});

/// Mass, parameters with intervals, models that were tried, warnings.
std::string text_table(const ident::Result& result, std::string_view axis);

}  // namespace stribeck::report
