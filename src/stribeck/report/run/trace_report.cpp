#include <array>
#include <stribeck/report/html.hpp>
#include <stribeck/report/plot/plot.hpp>
#include <stribeck/report/plot/time_axis.hpp>
#include <stribeck/report/run/trace_report.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

constexpr std::array<const char*, 8> kColors{"#0072b2", "#d55e00", "#009e73", "#888888",
                                             "#cc79a7", "#e69f00", "#56b4e9", "#000000"};

}  // namespace

namespace {

Page trace_report_page(const TraceReportInput& input) {
  Page page(input.title, "stribeck " + input.version);
  page.lead(input.summary);
  page.warnings(input.warnings);
  for (const TraceFigure& f : input.figures) {
    page.section(f.heading);
    page.figures(f.plots, f.columns, f.caption);
  }
  page.section("Columns over time");
  const TimeAxis axis = time_axis(input.time);
  std::vector<double> time = input.time;
  for (double& t : time) t -= axis.origin;
  std::vector<Plot> plots;
  for (const TraceColumn& c : input.columns) {
    const std::string label = c.quantity + (c.quantity.empty() ? "" : " ") + "[" + printed_unit(c.unit) + "]";
    Plot* plot = nullptr;
    for (Plot& p : plots) {
      if (p.y_label == label) plot = &p;
    }
    if (plot == nullptr) {
      plot = &plots.emplace_back();
      plot->x_label = axis.label;
      plot->y_label = label;
    }
    plot->description += (plot->description.empty() ? "" : ", ") + c.name;
    Series series;
    series.label = c.name;
    series.x = time;
    series.y = c.values;
    series.color = kColors[plot->series.size() % kColors.size()];
    plot->series.push_back(std::move(series));
  }
  for (const Plot& p : plots) page.figure(p, "");
  page.made({input.command, input.version, input.inputs});
  return page;
}

}  // namespace

std::string trace_report(const TraceReportInput& input) { return trace_report_page(input).html(); }

void write_trace_report(const PageFolders& folders, const TraceReportInput& input) {
  write_page(trace_report_page(input), folders);
}

}  // namespace stribeck::report
