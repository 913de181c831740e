#pragma once
/// The page of a run that a verb has made: its columns over time.
/// Real time: no.

#include <string>
#include <vector>

#include <apps/cli/shared.hpp>
#include <stribeck/report/run/trace_report.hpp>

namespace stribeck::io {
struct Log;
}

namespace stribeck::cli {

/// Writes a page with a log's columns over time, where one is wanted.
void report_log(const Common& common, const report::Made& made, const io::Log& log, const std::string& title,
                const std::string& summary, std::vector<report::TraceFigure> figures = {},
                std::vector<std::string> warnings = {});

}  // namespace stribeck::cli
