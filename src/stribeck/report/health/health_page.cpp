#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/health/date.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/report/health/health_parts.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

namespace health = ident::health;
using health::Change;
using health::Channel;

/// About six dates along the axis of time.
std::vector<Tic> dates(double first, double last) {
  constexpr double kTics = 6.0;
  const double step = std::max(1.0, std::ceil((last - first) / kTics));
  std::vector<Tic> tics;
  for (double day = std::floor(first); day <= last; day += step) tics.push_back({day, health::date_of(day)});
  return tics;
}

Series level_line(double first, double last, double y, const char* color) {
  return {.x = {first, last}, .y = {y, y}, .color = color, .width = 1.0, .dashed = true};
}

/// A number over the days: tests, fit with its interval, limits, changes.
Plot trend_plot(const Channel& c, const std::vector<Change>& changes) {
  const double per_si = unit_of(c).per_si;
  Plot p;
  p.title = name_of(c);
  p.y_label = fmt::format("[{}]", printed_unit(unit_of(c).name));
  p.width = 460;
  p.height = 240;
  p.legend = Legend::kNone;
  const double first = c.readings.front().day, last = std::max(c.readings.back().day, first + 1.0);
  p.x_tics = dates(first, last);
  for (std::size_t i = 0; i < p.x_tics.size(); ++i) {
    if (i % 2 == 1) p.x_tics[i].label.clear();
  }
  Series points{.style = Style::kPoints, .color = "#444444", .width = 1.2};
  for (const health::Reading& r : c.readings) {
    points.x.push_back(r.day);
    points.y.push_back(r.value * per_si);
  }
  if (c.trend.known()) {
    Series band{.style = Style::kBand, .color = "#9ecae1"}, line{.color = "#0072b2"};
    for (const health::FittedPoint& f : c.trend.curve) {
      band.x.push_back(f.day);
      band.y_low.push_back((f.value - f.half_width) * per_si);
      band.y_high.push_back((f.value + f.half_width) * per_si);
      line.x.push_back(f.day);
      line.y.push_back(f.value * per_si);
    }
    p.series = {band, line, points};
    for (const double side : {-1.0, 1.0})
      p.series.push_back(level_line(
          first, last, (c.trend.reference + side * c.scale * c.trend.drift_limit) * per_si, "#d55e00"));
  } else {
    p.series = {points};
  }
  for (const Change& change : changes) {
    if (!change.slow) p.markers.push_back({change.day, ""});
  }
  return p;
}

/// Friction by speed in both directions, of the first and of the last test.
Plot speed_plot(const HealthAxis& axis) {
  const bool rotary = !axis.health.channels.empty() && axis.health.channels.front().rotary;
  const double per_si = rotary ? 180.0 / kPi : 1e3;
  Plot p;
  p.title = "Friction by speed, axis " + axis.name;
  p.x_label = rotary ? "velocity [deg/s]" : "velocity [mm/s]";
  p.y_label = rotary ? "torque [N m]" : "force [N]";
  for (const bool last : {false, true}) {
    const health::HealthTest& test = last ? axis.tests.back() : axis.tests.front();
    Series s{.label = health::date_of(test.day), .color = last ? "#d55e00" : "#0072b2"};
    for (auto it = test.axis->friction.rbegin(); it != test.axis->friction.rend(); ++it) {
      s.x.push_back(-per_si * it->speed);
      s.y.push_back(-it->backward.value);
    }
    s.x.push_back(0.0);
    s.y.push_back(std::nan(""));
    for (const health::AtSpeed& at : test.axis->friction) {
      s.x.push_back(per_si * at.speed);
      s.y.push_back(at.forward.value);
    }
    p.series.push_back(std::move(s));
  }
  return p;
}

Table numbers_of(const HealthAxis& axis) {
  Table table;
  table.columns = {{"number", "", false}, {"first", "", true},    {"now", "", true},
                   {"change", "%", true}, {"scatter", "%", true}, {"per degree", "%", true},
                   {"", "", false}};
  for (const Channel& c : axis.health.channels) {
    const HealthUnit unit = unit_of(c);
    const auto shown = [&](double si) {
      return significant(si * unit.per_si, 4) + " " + printed_unit(unit.name);
    };
    table.rows.push_back({{name_of(c)},
                          {shown(c.trend.known() ? c.trend.reference : c.readings.front().value)},
                          {shown(c.trend.known() ? c.trend.now : c.readings.back().value)},
                          {with_sign(100.0 * c.share(c.trend.now - c.trend.reference), 1),
                           "± " + decimals(100.0 * c.share(c.trend.drift_half_width), 1)},
                          {decimals(100.0 * c.share(c.trend.scatter), 1)},
                          {with_sign(100.0 * c.share(c.trend.per_degree), 2)},
                          {status_of(c)}});
  }
  return table;
}

void add_changes(Page& page, const HealthAxis& axis) {
  if (axis.health.changes.empty()) return;
  Table table;
  table.columns = {{"when", "", false},
                   {"what", "", false},
                   {"numbers", "", false},
                   {"likely cause", "", false},
                   {"next", "", false}};
  for (const Change& change : axis.health.changes) {
    bool first = true;
    for (const health::Cause& cause : change.causes) {
      table.rows.push_back({{first ? when(change) : ""},
                            {first ? kind_of(change) : ""},
                            {first ? effects_of(change, axis.health.channels) : ""},
                            {.text = cause.what, .note = cause.why},
                            {cause.next}});
      first = false;
    }
  }
  page.subsection("Changes");
  page.table(table);
}

Page health_report_page(const HealthReportInput& input) {
  Page page("Health: " + input.machine, "stribeck " + input.version);
  for (const HealthAxis& axis : input.axes)
    page.lead(fmt::format("{}: {}, {}.", axis.motion.empty() ? "Circle" : "Axis " + axis.name, tests_of(axis),
                          verdict_of(axis)));
  page.paragraph(fmt::format(
      "{} Tables and figures have the values themselves. A step counts from {} % on, a slow change from {} % on{}. "
      "A step needs three tests before it is believed.",
      shares_of(input), short_number(100.0 * input.limits.step), short_number(100.0 * input.limits.drift),
      further_limits(input)));
  for (const HealthAxis& axis : input.axes) {
    page.section(axis.motion.empty() ? "Circle" : "Axis " + axis.name);
    page.table(numbers_of(axis));
    if (const std::string pending = pending_of(axis); !pending.empty()) page.paragraph(pending + ".");
    add_changes(page, axis);
    std::vector<Plot> plots;
    for (const Channel& c : axis.health.channels) plots.push_back(trend_plot(c, axis.health.changes));
    page.figures(
        plots, 2,
        fmt::format(
            "Tests (points), fit with its 95 % interval, limits of a slow change (dashed, {} %{}). Vertical "
            "lines: days of steps of {} % and more, which may end within the dashed lines.",
            short_number(100.0 * input.limits.drift), further_limits(input),
            short_number(100.0 * input.limits.step)));
    if (axis.tests.front().axis) page.figure(speed_plot(axis), "First and last test.");
    if (!axis.motion.empty()) {
      page.subsection("Motion to repeat");
      page.code(joined(axis.motion, "\n"));
    }
  }
  page.warnings(input.remarks);
  page.made({input.command, input.version, input.inputs});
  return page;
}

}  // namespace

std::string health_report(const HealthReportInput& input) { return health_report_page(input).html(); }

void write_health_report(const PageFolders& folders, const HealthReportInput& input) {
  write_page(health_report_page(input), folders);
}

}  // namespace stribeck::report
