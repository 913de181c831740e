#include <cmath>
#include <nlohmann/json.hpp>
#include <stribeck/report/board/board_report.hpp>

namespace stribeck::report {
namespace {

using Json = nlohmann::ordered_json;

Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json confident(const sim::Confident& c) {
  return {{"value", number(c.value)}, {"ci95", {number(c.low), number(c.high)}}};
}

Json figure(const BoardFigure& f) {
  Json values = Json::array();
  for (const double x : f.values) values.push_back(number(x));
  return {{"median", confident(f.median)}, {"p99", confident(f.p99)}, {"values", values}};
}

Json entrant(const BoardEntrant& e) {
  return {{"id", e.id},
          {"label", e.label},
          {"source", e.source.empty() ? Json(nullptr) : Json(e.source)},
          {"outside", e.outside}};
}

Json failures(const std::vector<std::string>& all, const std::vector<std::string>& cases) {
  Json list = Json::array();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].empty()) list.push_back({{"on", cases[i]}, {"reason", all[i]}});
  }
  return list;
}

}  // namespace

Json to_json(const BoardResult& r) {
  Json json{{"schema", "stribeck.bench/1"},
            {"protocol", 1},
            {"seed", r.seed},
            {"machines", r.machines},
            {"axes", r.axes}};
  json["identification"] = Json::array();
  for (const IdentificationRow& row : r.identification) {
    Json one = entrant(row.entrant);
    one["failed"] = row.failed();
    one["curve_error_percent"] = figure(row.curve_error);
    one["mass_error_percent"] = figure(row.mass_error);
    one["held_out_error_percent"] = figure(row.held_out_error);
    one["covered_percent"] = confident(row.covered);
    one["half_width_percent"] = number(row.half_width);
    one["mass_covered_percent"] = number(row.covered_mass);
    one["failures"] = failures(row.failures, r.axes);
    json["identification"].push_back(std::move(one));
  }
  json["control"] = Json::array();
  for (const ControlRow& row : r.control) {
    Json one = entrant(row.entrant);
    one["motion"] = row.motion;
    one["failed"] = row.failed();
    one["lost"] = row.lost;
    one["max_contour_error_um"] = figure(row.max_error);
    one["rms_um"] = figure(row.rms);
    one["input_variation_mV"] = figure(row.input_variation);
    one["failures"] = failures(row.failures, r.machines);
    json["control"].push_back(std::move(one));
  }
  json["warnings"] = r.warnings;
  json["costs"] = nullptr;
  if (!r.costs.empty()) {
    json["costs"] = Json::array();
    for (const BoardCost& c : r.costs)
      json["costs"].push_back(
          {{"id", c.id}, {"step_ns", number(1e9 * c.seconds)}, {"over_a_pipe", c.over_a_pipe}});
  }
  return json;
}

}  // namespace stribeck::report
