#include <array>
#include <utility>

#include <apps/cli/commands.hpp>
#include <apps/cli/trace_page.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/report/run/trace_report.hpp>

namespace stribeck::cli {
namespace {

/// Quantities of the columns of the program's own logs, by the first part of their names.
std::string quantity_of(const std::string& column) {
  static constexpr std::array kNames{std::pair{"contour_error", "contour error"},
                                     std::pair{"e", "tracking error"},
                                     std::pair{"r", "position"},
                                     std::pair{"x", "position"},
                                     std::pair{"table", "position"},
                                     std::pair{"u", "control input"},
                                     std::pair{"f", "force"},
                                     std::pair{"friction", "force"}};
  for (const auto& [name, quantity] : kNames) {
    if (column == name || column.rfind(std::string(name) + "_", 0) == 0) return quantity;
  }
  return {};
}

}  // namespace

void report_log(const Common& common, const report::Made& made, const io::Log& log, const std::string& title,
                const std::string& summary, std::vector<report::TraceFigure> figures,
                std::vector<std::string> warnings) {
  const report::PageFolders folders = folders_of(common);
  if (!folders.any()) return;
  report::TraceReportInput input{title, summary,    made.command, made.version, log.columns.front().values,
                                 {},    made.inputs};
  for (std::size_t i = 1; i < log.columns.size(); ++i) {
    const io::Column& c = log.columns[i];
    input.columns.push_back({c.name, c.unit_text, c.values, quantity_of(c.name)});
  }
  input.figures = std::move(figures);
  input.warnings = std::move(warnings);
  report::write_trace_report(folders, input);
}

}  // namespace stribeck::cli
