#pragma once
/// Parts that table and page of the board share.

#include <stribeck/report/board/board_report.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::report {

/// What was run, as a sentence.
std::string board_in_words(const BoardResult& result);
/// Motions in their order.
std::vector<std::string> board_motions(const BoardResult& result);
/// A value; where it is infinite what that means, "failed" or "lost"; a dash where it is not known.
std::string board_number(double value, std::string_view infinite = "failed");
/// "2.1–3.4"; empty where neither end is known. An end that is not known is a question mark.
std::string board_interval(const sim::Confident& c, std::string_view infinite = "failed");
/// Share of the true values that the intervals hold; "none" where none are stated.
std::string covered_in_words(const IdentificationRow& row);
/// Failures with their reasons, a sentence for each entry and reason.
std::vector<std::string> failures_in_words(const BoardResult& result);
/// "230 ns", "14 us over the pipe"
std::string cost_in_words(const BoardCost& cost);

}  // namespace stribeck::report
