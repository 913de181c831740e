#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/circle/circle_parts.hpp>
#include <stribeck/report/circle/circle_report.hpp>
#include <stribeck/report/columns.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

using Json = io::Json;

std::string direction(const ident::circle::CircleTest& t) {
  return t.counter_clockwise ? "counter-clockwise" : "clockwise";
}

/// "circle 2, clockwise (line=9)"; parts that do not distinguish circles are left out.
std::string circle_name(const CircleReportInput& input, std::size_t c) {
  std::string name = direction(input.logs.front().circles[c]);
  if (c < input.rows.size() && !input.rows[c].empty()) name += ", rows " + input.rows[c];
  return name;
}

/// Head and unit of "servo time [clocks]".
Column column_of(const std::string& head) {
  const auto open = head.rfind('[');
  if (open == std::string::npos || head.back() != ']') return {head, "", true};
  return {clean_text(head.substr(0, head.find_last_not_of(' ', open - 1) + 1)),
          clean_text(head.substr(open + 1, head.size() - open - 2)), true};
}

/// Radius at which errors up to `most` are drawn magnified: the circle is the unit circle.
struct Magnifier {
  double per_metre = 0.0;
  double ring = 0.0;  ///< [m]

  explicit Magnifier(double most) {
    ring = std::pow(10.0, std::floor(std::log10(std::max(most, 1e-9))));
    for (const double digit : {5.0, 2.0}) {
      if (digit * ring <= most) {
        ring *= digit;
        break;
      }
    }
    per_metre = 0.5 / std::max(most, 1e-9);
  }

  [[nodiscard]] Series around(const std::vector<double>& angle, const std::vector<double>& error,
                              std::string label, std::string color, double width) const {
    Series s{.label = std::move(label), .color = std::move(color), .width = width};
    for (std::size_t i = 0; i < angle.size(); ++i) {
      const double r = 1.0 + per_metre * error[i];
      s.x.push_back(r * std::cos(angle[i]));
      s.y.push_back(r * std::sin(angle[i]));
    }
    return s;
  }
  void grid(Plot& plot) const {
    std::vector<double> angle;
    for (int i = 0; i <= 240; ++i) angle.push_back(2.0 * kPi * i / 240);
    for (const double e : {-ring, 0.0, ring}) {
      Series s = around(angle, std::vector<double>(angle.size(), e), "", e == 0.0 ? "#9aa0a6" : "#b6bbc0",
                        e == 0.0 ? 1.0 : 0.8);
      s.dashed = e != 0.0;
      s.scale = true;
      plot.series.push_back(std::move(s));
    }
    plot.axes = false;
    plot.ring = Ring{0.0, 0.0, 1.0, kMicro / per_metre};
    plot.equal_aspect = true;
    plot.x_range = Range{-1.6, 1.6};
    plot.y_range = Range{-1.6, 1.6};
  }
};

/// The samples in order of time, thinned for a drawing; the angle goes on from revolution to revolution [rad].
struct Drawn {
  std::vector<double> angle;
  std::vector<double> error;
};

Drawn drawn(const ident::circle::CircleTest& t) {
  constexpr int kPerRevolution = 500;
  const double way = t.counter_clockwise ? 1.0 : -1.0;
  Drawn d;
  double turned = 0.0;    // against the direction of travel it may step back by noise
  double farthest = 0.0;  // for a drawing it must not
  for (std::size_t i = 0; i < t.angle.size(); ++i) {
    turned =
        i == 0 ? way * t.angle[0] : turned + way * std::remainder(t.angle[i] - t.angle[i - 1], 2.0 * kPi);
    farthest = i == 0 ? turned : std::fmax(farthest, turned);
    d.angle.push_back(farthest);
    d.error.push_back(t.error[i]);
  }
  thin(d.angle, d.error, static_cast<int>(kPerRevolution * std::fmax(std::ceil(t.revolutions), 1.0)));
  for (double& angle : d.angle) angle *= way;
  return d;
}

/// Over the angle from 0 to 360 degrees, with a gap where a revolution ends.
void fill_along(Series& s, const Drawn& d) {
  double before = 0.0;
  for (std::size_t k = 0; k < d.angle.size(); ++k) {
    const double degrees = d.angle[k] * 180.0 / kPi;
    const double within = degrees - 360.0 * std::floor(degrees / 360.0);
    if (k > 0 && std::abs(within - before) > 180.0) {
      s.x.push_back(std::numeric_limits<double>::quiet_NaN());
      s.y.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    s.x.push_back(within);
    s.y.push_back(d.error[k] * kMicro);
    before = within;
  }
}

void add_circle(Page& page, const CircleReportInput& input, std::size_t c) {
  page.section(circle_name(input, c));
  double most = 0.0;
  for (const CircleLog& log : input.logs) most = std::max(most, log.circles[c].max_error);
  const Magnifier common(most);
  Plot over{.title = "All on one scale", .legend = Legend::kAbove, .width = 620, .height = 660};
  common.grid(over);
  Plot along{
      .x_label = "angle [deg]", .y_label = "radial error [µm]", .x_range = Range{0.0, 360.0}, .x_step = 45.0};
  std::vector<Plot> own;
  for (std::size_t i = 0; i < input.logs.size(); ++i) {
    const CircleLog& log = input.logs[i];
    const ident::circle::CircleTest& t = log.circles[c];
    // The first log is the reference for the others, drawn in grey.
    const std::string color = controller_color("", i);
    const Drawn d = drawn(t);
    over.series.push_back(common.around(d.angle, d.error, log.label, color, 1.5));
    Series s{.label = log.label, .color = color, .width = 1.4};
    fill_along(s, d);
    along.series.push_back(std::move(s));
    const Magnifier magnifier(t.max_error);
    Plot p{.title = log.label, .legend = Legend::kNone, .width = 300, .height = 315};
    magnifier.grid(p);
    p.notes = {{0.0, 0.12, "max " + micrometres(t.max_error) + " µm", color},
               {0.0, -0.12, "ring " + short_number(magnifier.ring * kMicro) + " µm", "#444444"}};
    p.series.push_back(magnifier.around(d.angle, d.error, "", color, 1.4));
    own.push_back(std::move(p));
  }
  page.figure(over,
              fmt::format("Radial error over the circle, all on one scale. Dashed: {} µm to both sides.",
                          short_number(common.ring * kMicro)));
  page.figures(own, own.size() > 3 ? 4 : 3,
               "Each on its own scale; the dashed rings mark the error given in the middle.");
  page.figure(along, "The same over the angle.");
}

}  // namespace

std::string text_table(const CircleReportInput& input) {
  std::string out;
  TextColumn label{"control", "", {}, false};
  std::vector<TextColumn> columns;
  for (const CircleLog& log : input.logs) label.entries.push_back(clean_text(log.label));
  columns.push_back(label);
  for (std::size_t c = 0; c < input.logs.front().circles.size(); ++c) {
    const std::string group = direction(input.logs.front().circles[c]);
    TextColumn max{"max", "µm", {}, true, group};
    TextColumn rms{"RMS", "µm", {}};
    TextColumn glitch{"glitch", "µm", {}};
    for (const CircleLog& log : input.logs) {
      max.entries.push_back(micrometres(log.circles[c].max_error));
      rms.entries.push_back(micrometres(log.circles[c].rms));
      glitch.entries.push_back(micrometres(log.circles[c].quadrant_glitch));
    }
    columns.insert(columns.end(), {max, rms, glitch});
  }
  for (std::size_t b = 0; b < input.beside.size(); ++b) {
    const Column head = column_of(input.beside[b]);
    TextColumn column{head.head, head.unit, {}};
    for (const CircleLog& log : input.logs) column.entries.push_back(clean_text(log.beside[b]));
    columns.push_back(column);
  }
  std::string text = lay_out(columns) + "\n" + circular_test_text(input);
  text += "\n";
  if (input.together) text += causes_text("all logs together", *input.together);
  for (const CircleLog& log : input.logs) {
    if (log.diagnosis)
      text +=
          input.logs.size() > 1 ? causes_line(log.label, *log.diagnosis) : causes_text("", *log.diagnosis);
  }
  return text;
}

nlohmann::ordered_json to_json(const CircleReportInput& input) {
  Json out;
  out["schema"] = "stribeck.evaluate/1";
  out["radius_mm"] = io::number_or_null(input.radius * 1e3);
  out["logs"] = Json::array();
  for (const CircleLog& log : input.logs) {
    Json one{
        {"label", log.label}, {"file", log.file}, {"beside", Json::object()}, {"circles", Json::array()}};
    for (std::size_t b = 0; b < input.beside.size(); ++b) one["beside"][input.beside[b]] = log.beside[b];
    for (std::size_t c = 0; c < log.circles.size(); ++c) {
      const ident::circle::CircleTest& t = log.circles[c];
      one["circles"].push_back(
          {{"rows", c < input.rows.size() && !input.rows[c].empty() ? Json(input.rows[c]) : Json(nullptr)},
           {"direction", direction(t)},
           {"revolutions", io::number_or_null(t.revolutions)},
           {"max_contour_error_um", io::number_or_null(t.max_error * kMicro)},
           {"quadrant_glitch_um", io::number_or_null(t.quadrant_glitch * kMicro)},
           {"rms_um", io::number_or_null(t.rms * kMicro)},
           {"circular_deviation_um", io::number_or_null(t.circular_deviation * kMicro)}});
    }
    one["circular_test"] = log.test ? circular_test_json(*log.test) : Json(nullptr);
    one["diagnosis"] = log.diagnosis ? causes_json(*log.diagnosis, input.radius) : Json(nullptr);
    out["logs"].push_back(std::move(one));
  }
  out["diagnosis"] = input.together ? causes_json(*input.together, input.radius) : Json(nullptr);
  return out;
}

namespace {

Page circle_report_page(const CircleReportInput& input) {
  Page page(input.title, "stribeck " + input.version);
  const CircleLog* best = &input.logs.front();
  const CircleLog* worst = best;
  const auto most = [](const CircleLog& log) {
    double e = 0.0;
    for (const ident::circle::CircleTest& t : log.circles) e = std::max(e, t.max_error);
    return e;
  };
  for (const CircleLog& log : input.logs) {
    if (most(log) < most(*best)) best = &log;
    if (most(log) > most(*worst)) worst = &log;
  }
  if (input.logs.size() > 1) {
    page.lead(fmt::format("Radial error on a circle of {} mm: {} µm with {}, {} µm with {}.",
                          short_number(input.radius * 1e3), micrometres(most(*worst)), worst->label,
                          micrometres(most(*best)), best->label));
  } else {
    page.lead(fmt::format("Radial error on a circle of {} mm: at most {} µm.",
                          short_number(input.radius * 1e3), micrometres(most(*best))));
  }
  page.warnings(input.warnings);
  Table table;
  table.columns = {{"control", "", false}};
  for (std::size_t c = 0; c < best->circles.size(); ++c) {
    const std::string which = best->circles[c].counter_clockwise ? "ccw" : "cw";
    for (const char* head : {"max", "RMS", "glitch", "G"})
      table.columns.push_back({std::string(head), "µm, " + which, true});
  }
  for (const std::string& head : input.beside) table.columns.push_back(column_of(head));
  for (std::size_t i = 0; i < input.logs.size(); ++i) {
    const CircleLog& log = input.logs[i];
    std::vector<Cell> row{Cell{.text = log.label, .color = controller_color("", i)}};
    for (std::size_t c = 0; c < log.circles.size(); ++c) {
      const auto cell = [&](double ident::circle::CircleTest::*figure) {
        const double own = log.circles[c].*figure;
        bool least = input.logs.size() > 1;
        for (const CircleLog& other : input.logs) least = least && own <= other.circles[c].*figure;
        row.push_back(Cell{.text = micrometres(own), .best = least});
      };
      cell(&ident::circle::CircleTest::max_error);
      cell(&ident::circle::CircleTest::rms);
      cell(&ident::circle::CircleTest::quadrant_glitch);
      cell(&ident::circle::CircleTest::circular_deviation);
    }
    for (const std::string& text : log.beside) row.push_back(Cell{.text = text});
    table.rows.push_back(std::move(row));
  }
  page.table(table);
  page.remark(
      "ccw, cw: counter-clockwise, clockwise. max: largest |radial error|. glitch: the same within the "
      "first 0.15 mm after an axis turned round. G: circular deviation, the width of the minimum zone, after "
      "ISO 230-4. Bold: the smallest.");
  add_circular_test(page, input);
  if (input.together) add_causes(page, "all logs together", *input.together, input.radius);
  for (const CircleLog& log : input.logs) {
    if (log.diagnosis) add_causes(page, input.logs.size() > 1 ? log.label : "", *log.diagnosis, input.radius);
  }
  for (std::size_t c = 0; c < best->circles.size(); ++c) add_circle(page, input, c);
  page.made({input.command, input.version, input.inputs});
  return page;
}

}  // namespace

std::string circle_report(const CircleReportInput& input) { return circle_report_page(input).html(); }

void write_circle_report(const PageFolders& folders, const CircleReportInput& input) {
  write_page(circle_report_page(input), folders);
}

}  // namespace stribeck::report
