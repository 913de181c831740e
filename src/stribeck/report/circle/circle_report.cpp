#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/circle/circle_change.hpp>
#include <stribeck/report/circle/circle_parts.hpp>
#include <stribeck/report/circle/circle_report.hpp>
#include <stribeck/report/columns.hpp>
#include <stribeck/report/factors.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
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

std::string text_table(const CircleReportInput& input) {
  std::string out;
  TextColumn label{"control", "", {}, false};
  std::vector<TextColumn> columns;
  for (const CircleLog& log : input.logs) label.entries.push_back(clean_text(log.label));
  columns.push_back(label);
  if (std::any_of(input.logs.begin(), input.logs.end(),
                  [](const CircleLog& log) { return std::isfinite(log.feed); })) {
    TextColumn feed{"feed", "mm/min", {}};
    for (const CircleLog& log : input.logs)
      feed.entries.push_back(std::isfinite(log.feed) ? significant(log.feed * 60e3, 4) : "–");
    columns.push_back(feed);
  }
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
  std::string text = fmt::format("Circles of radius {} mm.\n", short_number(input.radius * 1e3)) +
                     lay_out(columns) + "\n" + circular_test_text(input);
  text += "\n";
  if (input.together) text += causes_text("all logs together", *input.together);
  for (const CircleLog& log : input.logs) {
    if (log.diagnosis)
      text +=
          input.logs.size() > 1 ? causes_line(log.label, *log.diagnosis) : causes_text("", *log.diagnosis);
  }
  for (const std::string& warning : input.warnings) text += clean_text("Note: " + warning) + ".\n";
  if (input.logs.size() > 1) text += "\n" + changes_text(input);
  return text + limits_text(input);
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
    one["feed_mm_per_s"] = io::number_or_null(log.feed * 1e3);
    one["notes"] = log.notes;
    one["circular_test"] = log.test ? circular_test_json(*log.test) : Json(nullptr);
    one["diagnosis"] = log.diagnosis ? causes_json(*log.diagnosis, input.radius) : Json(nullptr);
    out["logs"].push_back(std::move(one));
  }
  out["diagnosis"] = input.together ? causes_json(*input.together, input.radius) : Json(nullptr);
  out["changes"] = changes_json(input);
  out["limits"] = limits_json(input);
  return out;
}

}  // namespace stribeck::report
