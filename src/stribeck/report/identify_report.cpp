#include <fmt/format.h>

#include <cmath>
#include <stribeck/io/file.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/identify_report.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

std::string summary(const ident::Result& r, std::string_view axis) {
  std::string text =
      fmt::format("{}: {} friction model, found by {} from {} rows",
                  axis.empty() ? "The axis" : fmt::format("Axis {}", axis), r.model, r.method, r.rows);
  if (r.velocity_range[0] < 0.0 && r.velocity_range[1] > 0.0) {
    text += fmt::format(", valid from {} to {} mm/s", significant(r.velocity_range[0] * 1e3, 3),
                        significant(r.velocity_range[1] * 1e3, 3));
  }
  const double low = r.mass_interval.low * 1e-3;
  const double high = r.mass_interval.high * 1e-3;
  text += fmt::format(". Mass {} N s2/mm", shown_number(r.mass * 1e-3, low, high));
  if (std::isfinite(low) && std::isfinite(high)) {
    text += fmt::format(" (95 %: {} … {})", shown_number(low, low, high), shown_number(high, low, high));
  }
  text += ".";
  if (std::isfinite(r.held_out_rms)) {
    text += fmt::format(" On motion that was not fitted, the model leaves {} N RMS.",
                        significant(r.held_out_rms, 3));
  }
  if (std::isfinite(r.break_away_distance)) {
    text += fmt::format(" After a reversal friction settles over {} µm of travel.",
                        significant(r.break_away_distance * 1e6, 2));
  }
  std::size_t loose = 0;
  for (const ident::Parameter& p : r.parameters) loose += p.identifiable ? 0 : 1;
  if (loose > 0) {
    text += fmt::format(
        " {} of {} parameters cannot be told from the data; the curve can be used, they mean nothing alone.",
        loose, r.parameters.size());
  }
  return text;
}

}  // namespace

std::string identify_report(const IdentifyReportInput& input) {
  std::vector<std::string> about;
  if (!input.source.empty()) about.push_back("from " + input.source);
  if (!input.version.empty()) about.push_back("stribeck " + input.version);
  Page page(input.axis.empty() ? "Friction of an axis" : "Friction of axis " + input.axis,
            joined(about, " · "));
  bool first = true;
  for (const ident::Result& r : input.results) {
    if (!first) page.section("Beside it: " + r.model + " model by " + r.method);
    page.lead(summary(r, input.axis));
    page.warnings(r.warnings);
    if (first) page.section("Friction map");
    FrictionMap map;
    map.axis = input.axis;
    map.fit = &r;
    map.speed = std::max(std::abs(r.velocity_range[0]), std::abs(r.velocity_range[1]));
    if (r.curve.size() < 2) map.model = r.friction.steady;
    map.model_label = "fit";
    for (const ident::Result& other : input.results) {
      if (&other != &r && other.model == "conventional") map.conventional = other.friction.steady;
    }
    page.figures(friction_plots(map), 2,
                 "Left: friction against velocity. Right: the same as difference from the fit, where its 95 "
                 "% band can be seen. "
                 "Measured points are thinned.");
    if (first) page.section("Parameters");
    page.table(parameter_table(r));
    if (!r.models.empty()) page.table(candidate_table(r));
    first = false;
  }
  if (!input.command.empty()) {
    page.section("How to make this page again");
    page.code(input.command);
  }
  return page.html();
}

void write_identify_report(const std::string& directory, const IdentifyReportInput& input) {
  const std::string page = identify_report(input);
  io::make_directory(directory);
  io::write_atomically(directory + "/index.html", page);
}

}  // namespace stribeck::report
